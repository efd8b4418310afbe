//! Tying the clocks over its settings: in how many frames the clock in the picture is read, and no clock at all.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use anyhow::{Context, ensure};

use super::{Row, median};
use crate::align::{AlignInputs, AlignOptions, AlignOutputs, LagSearch, LagTie, Sync, run as run_align};
use crate::posture::{Layout, Outputs, PostureOptions, PostureReport, Watch, run as run_posture};
use crate::table::Table;

/// What is measured, and how often.
#[derive(Debug, Clone)]
pub struct Settings {
    /// The video, with a clock in the picture.
    pub video: PathBuf,
    /// Its marker file.
    pub markers: PathBuf,
    /// The log that belongs to it.
    pub log: PathBuf,
    /// The video's truth, as `lunula phantom video` writes it.
    pub truth: PathBuf,
    /// Runs of each setting; the median time counts.
    pub repeats: usize,
    /// Threads that decode (0: all cores).
    pub threads: usize,
}

/// The error's name and unit.
const ERROR: &str = "largest error of the log's time over the video, seconds";
const CORRELATE: &str = "no clock, lag within 3 s";
/// Every so many frames the clock is read.
const EVERY: [(&str, u64); 5] = [
    ("clock in every frame", 1),
    ("clock in 1 of 2 frames", 2),
    ("clock in 1 of 5 frames", 5),
    ("clock in 1 of 20 frames", 20),
    ("clock in 1 of 50 frames", 50),
];

/// Where the lag is looked for without a clock: whoever pressed two buttons knows it to some seconds.
const KNOWN_S: f64 = 3.0;

/// Measures every setting; the words say which tied nothing, and why.
///
/// # Errors
/// A video, marker file, log or truth that can't be read, with its file.
pub fn measure(settings: &Settings) -> anyhow::Result<(Vec<Row>, Vec<String>)> {
    let layout = Layout::read(&settings.markers)?;
    ensure!(layout.clock.is_some(), "{}: has no [clock], and a clock is what is measured", settings.markers.display());
    let truth = column(&settings.truth.join("clock.csv"), "clock_s")?;
    let folder = tempfile::tempdir()?;
    let joints = folder.path().join("joints.csv");
    let (mut rows, mut refused) = (Vec::new(), Vec::new());
    for (name, clock_every) in EVERY {
        let options = PostureOptions { threads: settings.threads, clock_every, ..PostureOptions::default() };
        let mut seconds = Vec::new();
        let mut work = 0;
        for _ in 0..settings.repeats {
            let report = follow(&layout, &options, &joints, settings)?;
            seconds.push(report.stages.iter().filter(|s| s.stage == "clock").map(|s| s.thread_s).sum());
            let clock = report.clock.context("the clock was not read")?;
            work = clock.frames_read + clock.frames_refused;
            if clock.tie.is_none() {
                refused.push(format!("{name}: {}", report.failed.join("; ")));
            }
        }
        if let Ok(found) = column(&joints, "clock_s") {
            rows.push(row(name, worst(&found, &truth)?, median(seconds), work));
        }
    }
    match correlated(&layout, &joints, &truth, settings) {
        Ok(row) => rows.push(row),
        Err(why) => refused.push(format!("{CORRELATE}: {why:#}")),
    }
    refused.dedup();
    Ok((rows, refused))
}

fn follow(
    layout: &Layout,
    options: &PostureOptions,
    joints: &Path,
    settings: &Settings,
) -> anyhow::Result<PostureReport> {
    let outputs = Outputs { joints: joints.to_owned(), tracks: None, overlay: None, figures: false };
    let watch = Watch { stop: &AtomicBool::new(false), tick: &|_, _| {} };
    Ok(run_posture(&settings.video, layout, options, &outputs, &watch)?)
}

/// The lag at which the photodiodes best explain the angles, for whoever filmed no clock.
fn correlated(layout: &Layout, joints: &Path, truth: &[f64], settings: &Settings) -> anyhow::Result<Row> {
    let options = PostureOptions { threads: settings.threads, clock_every: 0, ..PostureOptions::default() };
    follow(layout, &options, joints, settings)?;
    let folder = tempfile::tempdir()?;
    let inputs = AlignInputs { joints: joints.to_owned(), log: settings.log.clone(), tracks: None };
    let about_s = truth.first().copied();
    let lag =
        LagTie { search: LagSearch { about_s, most_s: Some(KNOWN_S), ..LagSearch::default() }, sensor_lag_s: None };
    let options = AlignOptions { sync: Some(Sync::Correlate), lag, ..AlignOptions::default() };
    let outputs =
        AlignOutputs { training: folder.path().join("training.csv"), mot: None, bids: None, dlc: None, figures: false };
    let times_s = column(joints, "time_s")?;
    let mut seconds = Vec::new();
    let mut found = Vec::new();
    for _ in 0..settings.repeats {
        let report = run_align(&inputs, &options, &outputs, &AtomicBool::new(false))?;
        seconds.push(report.stages.iter().filter(|s| s.stage == "tie").map(|s| s.thread_s).sum());
        let tie = report.certificate;
        found = times_s.iter().map(|t| tie.offset_s + (1.0 + 1e-6 * tie.drift_ppm) * t).collect();
    }
    Ok(row(CORRELATE, worst(&found, truth)?, median(seconds), times_s.len() as u64))
}

fn row(setting: &str, error: f64, run_s: f64, work: u64) -> Row {
    Row { job: "align", setting: setting.to_owned(), error, error_unit: ERROR.to_owned(), run_s, work }
}

fn column(path: &Path, name: &str) -> anyhow::Result<Vec<f64>> {
    let cells = Table::read(path)?.numbers(name)?;
    let known: Option<Vec<f64>> = cells.into_iter().collect();
    known.with_context(|| format!("{}: `{name}` has empty cells", path.display()))
}

fn worst(found: &[f64], truth: &[f64]) -> anyhow::Result<f64> {
    ensure!(found.len() == truth.len(), "{} frames in the video, {} in its truth", found.len(), truth.len());
    Ok(found.iter().zip(truth).map(|(found, truth)| (found - truth).abs()).fold(0.0, f64::max))
}
