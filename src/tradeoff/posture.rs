//! The posture job over its settings: which planes give the centres, how they are refined, where markers are searched; and
//! beside them what a user of OpenCV would write.

use std::f64::consts::{PI, TAU};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use anyhow::{Context, ensure};

use super::recipe::{self, Recipe, Wanted};
use super::{Row, median};
use crate::posture::{
    Joint, Layout, Marker, Method, Outputs, Planes, PostureOptions, Search, Watch, run as run_posture,
};
use crate::table::Table;
use crate::video::Video;

/// What is measured, and how often.
#[derive(Debug, Clone)]
pub struct Settings {
    /// The video.
    pub video: PathBuf,
    /// Its marker file.
    pub markers: PathBuf,
    /// Its truth, as `lunula phantom video` writes it.
    pub truth: PathBuf,
    /// Runs of each setting; the median time counts.
    pub repeats: usize,
    /// Threads that decode (0: all cores).
    pub threads: usize,
}

/// Name, planes, rounds of refinement, search; the first is what `lunula posture` does.
const SETTINGS: [(&str, Planes, usize, Search); 7] = [
    ("default", Planes::All, Method::ROUNDS, Search::Near),
    ("luma only", Planes::Luma, Method::ROUNDS, Search::Near),
    ("chroma only", Planes::Chroma, Method::ROUNDS, Search::Near),
    ("centroid", Planes::All, 0, Search::Near),
    ("one round", Planes::All, 1, Search::Near),
    ("two rounds", Planes::All, 2, Search::Near),
    ("whole frames searched", Planes::All, Method::ROUNDS, Search::Whole),
];

/// What users of OpenCV write.
const OPENCV: &str = "OpenCV: BGR, HSV, inRange, contours";

/// Measures every setting.
///
/// # Errors
/// A video, marker file or truth that can't be read, with its file.
pub fn measure(settings: &Settings) -> anyhow::Result<Vec<Row>> {
    let layout = Layout::read(&settings.markers)?;
    let truth = Angles::read(&settings.truth.join("joints.csv"), &layout)?;
    let mut rows = Vec::new();
    for (name, planes, rounds, search) in SETTINGS {
        let method = Method { planes, rounds, search };
        let options = PostureOptions { threads: settings.threads, method, ..PostureOptions::default() };
        rows.extend(ours(name, &options, &layout, &truth, settings)?);
    }
    rows.extend(theirs(&layout, &truth, settings)?);
    Ok(rows)
}

/// The job itself, with these options.
fn ours(
    name: &str,
    options: &PostureOptions,
    layout: &Layout,
    truth: &Angles,
    settings: &Settings,
) -> anyhow::Result<Vec<Row>> {
    let folder = tempfile::tempdir()?;
    let joints = folder.path().join("joints.csv");
    let outputs = Outputs { joints: joints.clone(), tracks: None, overlay: None, figures: false };
    let watch = Watch { stop: &AtomicBool::new(false), tick: &|_, _| {} };
    let mut seconds = Vec::new();
    let mut work = 0;
    for _ in 0..settings.repeats {
        let report = run_posture(&settings.video, layout, options, &outputs, &watch)?;
        let track: f64 = report.stages.iter().filter(|s| s.stage == "track").map(|s| s.thread_s).sum();
        seconds.push(track / report.frames.all as f64);
        let samples = (report.video.shown_px[0] * report.video.shown_px[1]) as f64;
        work = (samples * report.searches.share_of_samples).round() as u64;
    }
    let found = Angles::read(&joints, layout)?;
    Ok(rows(name, &found.errors(truth, layout)?, median(seconds), work))
}

/// The recipe of OpenCV's users on the same frames.
fn theirs(layout: &Layout, truth: &Angles, settings: &Settings) -> anyhow::Result<Vec<Row>> {
    let wanted = wanted(layout, &settings.truth)?;
    let mut seconds = Vec::new();
    let mut found = None;
    for _ in 0..settings.repeats {
        let recipe = recipe::run(&settings.video, settings.threads, &wanted)?;
        seconds.push((recipe.bgr_s + recipe.opencv_s) / recipe.frames.len() as f64);
        found = Some(Angles::of(&recipe, layout));
    }
    let found = found.context("no repeats")?;
    let format = Video::open(&settings.video, settings.threads)?.info().format;
    // Every sample of every plane is converted.
    let work = (format.width * format.height) as u64;
    Ok(rows(OPENCV, &found.errors(truth, layout)?, median(seconds), work))
}

/// The markers, with where they are at first.
fn wanted(layout: &Layout, truth: &Path) -> anyhow::Result<Vec<Wanted>> {
    let table = Table::read(&truth.join("tracks.csv"))?;
    let names = table.texts("marker")?;
    let (x_px, y_px) = (table.numbers("x_px")?, table.numbers("y_px")?);
    let first = |name: &str| {
        let row = names.iter().position(|other| other.as_deref() == Some(name))?;
        Some([x_px[row]?, y_px[row]?])
    };
    let wanted =
        |marker: &Marker| Wanted { name: marker.name.clone(), srgb: marker.colour, start_px: first(&marker.name) };
    Ok(layout.markers.iter().map(wanted).collect())
}

fn rows(setting: &str, errors: &[(String, f64)], run_s: f64, work: u64) -> Vec<Row> {
    let row = |(error_unit, error): &(String, f64)| Row {
        job: "posture",
        setting: setting.to_owned(),
        error: *error,
        error_unit: error_unit.clone(),
        run_s,
        work,
    };
    errors.iter().map(row).collect()
}

/// Each joint's angle in each frame, degrees.
struct Angles(Vec<Vec<Option<f64>>>);

impl Angles {
    fn read(path: &Path, layout: &Layout) -> anyhow::Result<Self> {
        let table = Table::read(path)?;
        let columns = layout.joints.iter().map(|joint| table.numbers(&format!("{}_deg", joint.name)));
        Ok(Self(columns.collect::<Result<_, _>>()?))
    }

    /// From the recipe's centroids, as somebody would who knows of no lens.
    fn of(recipe: &Recipe, layout: &Layout) -> Self {
        let angle = |places: &[Option<[f64; 2]>], joint: &Joint| {
            let [proximal, distal] = joint.segments.map(|segment| {
                let [a, b] = layout.segments[segment].markers.map(|marker| places[marker]);
                let (a, b) = (a?, b?);
                Some((b[1] - a[1]).atan2(b[0] - a[0]))
            });
            let turned = layout.flexion.sign() * (distal? - proximal?) - joint.zero_rad;
            Some((turned + PI).rem_euclid(TAU).to_degrees() - 180.0)
        };
        let column = |joint: &Joint| recipe.frames.iter().map(|frame| angle(&frame.at_px, joint)).collect();
        Self(layout.joints.iter().map(column).collect())
    }

    /// Each joint's error over the frames in which all settings can have its angle: those that have it; with the error's name.
    fn errors(&self, truth: &Self, layout: &Layout) -> anyhow::Result<Vec<(String, f64)>> {
        let mut errors = Vec::new();
        for ((joint, found), exact) in layout.joints.iter().zip(&self.0).zip(&truth.0) {
            ensure!(found.len() == exact.len(), "{} frames in the video, {} in its truth", found.len(), exact.len());
            let both = found.iter().zip(exact).filter_map(|(found, exact)| Some(((*found)? - (*exact)?).powi(2)));
            let (sum, count) = both.fold((0.0, 0), |(sum, count), square| (sum + square, count + 1));
            ensure!(count > 0, "{}: no frame has its angle", joint.name);
            errors.push((format!("{}, degrees RMS", joint.name), (sum / f64::from(count)).sqrt()));
        }
        Ok(errors)
    }
}
