//! Tying the clocks over its settings: in how many frames the clock in the picture is read, and no clock at all; and
//! labelling over longer and longer gaps.

mod labels;

use std::path::{Path, PathBuf};

use anyhow::{Context, ensure};

use crate::align::{AlignInputs, AlignOptions, AlignOutputs, LagSearch, LagTie, Sync, run as run_align};
use crate::job::Watch;
use crate::posture::{Layout, Outputs, PostureOptions, PostureReport, run as run_posture};
use crate::table::Table;
use crate::tradeoff::measure::rows::{Measured, Row};
use crate::tradeoff::measure::timing::{Effort, Run, in_turns};

pub(super) use labels::bridging_default;
pub use labels::{BRIDGING, LABEL_ERROR, Labels};

/// What is measured.
#[derive(Debug, Clone)]
pub struct Settings {
    /// The video, with a clock in the picture.
    pub video: PathBuf,
    /// Its marker file.
    pub markers: PathBuf,
    /// The log that belongs to it.
    pub log: PathBuf,
    /// The video's truth, as `lunula phantom video` writes it; where the log's stands with it, labels are measured too.
    pub truth: PathBuf,
    /// How much.
    pub effort: Effort,
}

/// How the clocks are tied.
pub(super) const TYING: (&str, &str) = ("align", "tying");
/// The error's name and unit.
pub(super) const TIE_ERROR: &str = "largest error of the log's time over the video, seconds";
const CORRELATE: &str = "no clock, lag within 3 s";
/// Every so many frames the clock is read.
const EVERY: [u64; 5] = [1, 2, 5, 20, 50];
/// Where the lag is looked for without a clock: whoever pressed two buttons knows it to some seconds.
const KNOWN_S: f64 = 3.0;

/// What `lunula posture` and `lunula align` do.
pub(super) fn tying_default() -> String {
    every(PostureOptions::default().clock_every)
}

fn every(frames: u64) -> String {
    match frames {
        1 => "clock in every frame".to_owned(),
        _ => format!("clock in 1 of {frames} frames"),
    }
}

/// Measures every setting.
///
/// # Errors
/// A video, marker file, log or truth that can't be read, with its file; [`Interrupted`](crate::job::Interrupted).
pub fn measure(settings: &Settings) -> anyhow::Result<Measured> {
    let layout = Layout::read(&settings.markers)?;
    ensure!(layout.clock.is_some(), "{}: has no [clock], and a clock is what is measured", settings.markers.display());
    let truth = column(&settings.truth.join("clock.csv"), "clock_s")?;
    let folder = tempfile::tempdir()?;
    let joints = |frames: u64| folder.path().join(format!("{frames}.csv"));
    let mut measured = Measured::default();
    let found = in_turns(&EVERY, &settings.effort, |&frames, first| {
        let report = follow(&layout, frames, &joints(frames), settings)?;
        let seconds = report.stages.iter().filter(|s| s.stage == "clock").map(|s| s.thread_s).sum();
        let clock = report.figures.clock.context("the clock was not read")?;
        ensure!(clock.tie.is_some(), "{}", report.failed.join("; "));
        let error = || {
            anyhow::Ok((worst(&column(&joints(frames), "clock_s")?, &truth)?, clock.frames_read + clock.frames_refused))
        };
        Ok((seconds, first.then(error).transpose()?))
    })?;
    for (frames, found) in EVERY.into_iter().zip(found) {
        measured.add(TYING, &every(frames), TIE_ERROR, found);
    }
    let lag = in_turns(&[()], &settings.effort, |(), first| correlated(&joints(EVERY[0]), &truth, first, settings))?;
    for found in lag {
        match found {
            Ok((time, (error, work))) => measured.rows.push(Row::own(TYING, CORRELATE, (error, TIE_ERROR), time, work)),
            // The temporary folder's name would mean nothing to a reader.
            Err(why) => measured
                .refused
                .push(format!("{CORRELATE}: {why:#}").replace(&format!("{}: ", joints(EVERY[0]).display()), "")),
        }
    }
    labels::measure(&layout, &joints(EVERY[0]), settings, &mut measured)?;
    Ok(measured)
}

/// Angles with frames taken out, in `folder`, and the log's exact ones: what another program labels the log from.
///
/// # Errors
/// A video, marker file, log or truth that can't be read, with its file.
pub fn labels(settings: &Settings, folder: &Path) -> anyhow::Result<Labels> {
    let layout = Layout::read(&settings.markers)?;
    let joints = folder.join("all.csv");
    follow(&layout, EVERY[0], &joints, settings)?;
    Labels::new(&layout, &joints, settings, folder)
}

fn follow(layout: &Layout, clock_every: u64, joints: &Path, settings: &Settings) -> anyhow::Result<PostureReport> {
    let options = PostureOptions { threads: settings.effort.threads, clock_every, ..PostureOptions::default() };
    let outputs = Outputs { joints: joints.to_owned(), tracks: None, overlay: None, figures: false, report: false };
    let watch = Watch::stopped_by(&settings.effort.stop);
    Ok(run_posture(&settings.video, layout, &options, &outputs, &watch)?)
}

/// The lag at which the photodiodes best explain the angles, for whoever filmed no clock.
fn correlated(joints: &Path, truth: &[f64], first: bool, settings: &Settings) -> Run<(f64, u64)> {
    let folder = tempfile::tempdir()?;
    let inputs = AlignInputs { joints: joints.to_owned(), log: settings.log.clone(), tracks: None };
    let about_s = truth.first().copied();
    let lag =
        LagTie { search: LagSearch { about_s, most_s: Some(KNOWN_S), ..LagSearch::default() }, sensor_lag_s: None };
    let options = AlignOptions { sync: Some(Sync::Correlate), lag, ..AlignOptions::default() };
    let outputs = AlignOutputs::only(folder.path().join("training.csv"));
    let report = run_align(&inputs, &options, &outputs, &Watch::nobody())?;
    let seconds = report.stages.iter().filter(|s| s.stage == "tie").map(|s| s.thread_s).sum();
    if !first {
        return Ok((seconds, None));
    }
    let times_s = column(joints, "time_s")?;
    let tie = report.figures.certificate;
    let found: Vec<f64> = times_s.iter().map(|t| tie.offset_s + (1.0 + 1e-6 * tie.drift_ppm) * t).collect();
    Ok((seconds, Some((worst(&found, truth)?, times_s.len() as u64))))
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
