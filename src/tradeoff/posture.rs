//! The posture job over its settings: which planes give the centres, how they are refined, where markers are searched.

use std::path::{Path, PathBuf};

use anyhow::ensure;

use crate::job::Watch;
use crate::posture::{Layout, Method, Outputs, Planes, PostureOptions, Search, run as run_posture};
use crate::table::Table;
use crate::tradeoff::measure::rows::{Measured, Row};
use crate::tradeoff::measure::timing::{Effort, Run, in_turns};

/// What is measured, and how often.
#[derive(Debug, Clone)]
pub struct Settings {
    /// The one that all settings track.
    pub video: PathBuf,
    /// Its marker file.
    pub markers: PathBuf,
    /// Its truth, as `lunula phantom video` writes it.
    pub truth: PathBuf,
    /// How much.
    pub effort: Effort,
}

/// How centres are found: job and choice.
pub const TRACKING: (&str, &str) = ("posture", "tracking");
/// Of all angles together.
pub(super) const ALL_JOINTS: &str = "all joints, degrees RMS";
/// Name, planes, rounds of refinement, search.
const SETTINGS: [(&str, Planes, usize, Search); 7] = [
    ("fitted to a standstill", Planes::All, Method::ROUNDS, Search::Near),
    ("luma only", Planes::Luma, Method::ROUNDS, Search::Near),
    ("chroma only", Planes::Chroma, Method::ROUNDS, Search::Near),
    ("centroid", Planes::All, 0, Search::Near),
    ("one round", Planes::All, 1, Search::Near),
    ("two rounds", Planes::All, 2, Search::Near),
    ("whole frames searched", Planes::All, Method::ROUNDS, Search::Whole),
];

fn method((_, planes, rounds, search): (&str, Planes, usize, Search)) -> Method {
    Method { planes, rounds, search }
}

/// What `lunula posture` does.
pub(super) fn tracking_default() -> String {
    let default = SETTINGS.into_iter().find(|&setting| method(setting) == Method::default());
    default.map_or("none of those measured", |(name, ..)| name).to_owned()
}

/// Measures every setting.
///
/// # Errors
/// A video, marker file or truth that can't be read, with its file; [`Interrupted`](crate::job::Interrupted).
pub fn measure(settings: &Settings) -> anyhow::Result<Measured> {
    let layout = Layout::read(&settings.markers)?;
    let truth = Angles::read(&settings.truth.join("joints.csv"), &layout)?;
    let found = in_turns(&SETTINGS, &settings.effort, |setting, first| {
        run(method(*setting), first, &layout, &truth, settings)
    })?;
    let mut measured = Measured::default();
    for (found, (name, ..)) in found.into_iter().zip(SETTINGS) {
        let (time, (errors, work)) = found?;
        measured.rows.extend(errors.iter().map(|(unit, error)| Row::own(TRACKING, name, (*error, unit), time, work)));
    }
    Ok(measured)
}

/// Errors with their names, and samples looked at.
type Errors = (Vec<(String, f64)>, u64);

/// The job itself.
fn run(method: Method, first: bool, layout: &Layout, truth: &Angles, settings: &Settings) -> Run<Errors> {
    let options =
        PostureOptions { threads: settings.effort.threads, method, clock_every: 0, ..PostureOptions::default() };
    let folder = tempfile::tempdir()?;
    let joints = folder.path().join("joints.csv");
    let outputs = Outputs { joints: joints.clone(), tracks: None, overlay: None, figures: false, report: false };
    let watch = Watch::stopped_by(&settings.effort.stop);
    let report = run_posture(&settings.video, layout, &options, &outputs, &watch)?;
    let track: f64 = report.stages.iter().filter(|s| s.stage == "track").map(|s| s.thread_s).sum();
    let seconds = track / report.frames.all as f64;
    let samples = (report.video.shown_px[0] * report.video.shown_px[1]) as f64;
    let work = (samples * report.searches.share_of_samples).round() as u64;
    let errors = || anyhow::Ok((Angles::read(&joints, layout)?.errors(truth, layout)?, work));
    Ok((seconds, first.then(errors).transpose()?))
}

/// Each joint's angle in each frame, degrees.
#[derive(Debug)]
pub struct Angles(Vec<Vec<Option<f64>>>);

impl Angles {
    /// From a table with a row for each frame, as `lunula posture` and a scene's truth have it.
    ///
    /// # Errors
    /// A table that can't be read, or has not the layout's joints.
    pub fn read(path: &Path, layout: &Layout) -> anyhow::Result<Self> {
        let table = Table::read(path)?;
        let columns = layout.joints.iter().map(|joint| table.numbers(&format!("{}_deg", joint.name)));
        Ok(Self(columns.collect::<Result<_, _>>()?))
    }

    /// From angles of each joint in turn.
    #[must_use]
    pub fn new(by_joint: Vec<Vec<Option<f64>>>) -> Self {
        Self(by_joint)
    }

    /// Each joint's error over the frames in which all settings can have its angle: those that have it; with the
    /// error's name. At last that of all joints.
    ///
    /// # Errors
    /// Another number of frames than the truth has, or a joint without any angle.
    pub fn errors(&self, truth: &Self, layout: &Layout) -> anyhow::Result<Vec<(String, f64)>> {
        let (mut errors, mut squares) = (Vec::new(), 0.0);
        for ((joint, found), exact) in layout.joints.iter().zip(&self.0).zip(&truth.0) {
            ensure!(found.len() == exact.len(), "{} frames in the video, {} in its truth", found.len(), exact.len());
            let both = found.iter().zip(exact).filter_map(|(found, exact)| Some(((*found)? - (*exact)?).powi(2)));
            let (sum, count) = both.fold((0.0, 0), |(sum, count), square| (sum + square, count + 1));
            ensure!(count > 0, "{}: no frame has its angle", joint.name);
            let square = sum / f64::from(count);
            errors.push((format!("{}, degrees RMS", joint.name), square.sqrt()));
            squares += square;
        }
        errors.push((ALL_JOINTS.to_owned(), (squares / errors.len() as f64).sqrt()));
        Ok(errors)
    }
}
