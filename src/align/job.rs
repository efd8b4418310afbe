//! The alignment job: a table of joint angles and a log in, a labelled set with its certificate out; the one entry that command
//! line, pipelines and trade-offs call.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use thiserror::Error;

use super::certificate::Certificate;
use super::export::{BidsNames, ExportError};
use super::label::label;
use super::plan::steps;
use super::posture::Posture;
use super::report::{AlignReport, LabelReport};
use super::results::Results;
use super::tie::{self, LagTie, Tie};
use crate::files::{WriteError, is_same_file};
use crate::log::{AmbientError, AmbientOptions, Columns, Log, LogError, Samples, samples};
use crate::stages::{Stages, left_out};
use crate::table::{TableError, TableFormat};

/// What is aligned.
#[derive(Debug, Clone)]
pub struct AlignInputs {
    /// The table of joint angles, as `lunula posture` writes it.
    pub joints: PathBuf,
    /// The log of photodiodes and forces.
    pub log: PathBuf,
    /// The table of markers; only [`AlignOutputs::dlc`] needs it.
    pub tracks: Option<PathBuf>,
}

/// How the clocks are tied.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Sync {
    /// By the clock in the picture.
    Clock,
    /// By an offset that the user knows.
    Offset {
        /// The log's time at the video's first frame, seconds.
        offset_s: f64,
        /// Its standard error, seconds; none: not known.
        sd_s: Option<f64>,
    },
    /// By the lag at which the photodiodes best explain the angles.
    Correlate,
}

impl Sync {
    /// Reads `clock`, `offset=SECONDS`, `offset=SECONDS+-ERROR` or `correlate`.
    ///
    /// # Errors
    /// What to write instead.
    pub fn parse(text: &str) -> Result<Self, String> {
        let number = |text: &str| text.trim().parse().ok().filter(|number: &f64| number.is_finite());
        let offset = |text: &str| {
            let (offset, sd) = text.split_once("+-").map_or((text, None), |(offset, sd)| (offset, Some(sd)));
            let sd_s = sd.map(number);
            (sd_s != Some(None)).then_some(())?;
            Some(Self::Offset { offset_s: number(offset)?, sd_s: sd_s.flatten() })
        };
        let sync = match text {
            "clock" => Some(Self::Clock),
            "correlate" => Some(Self::Correlate),
            other => other.strip_prefix("offset=").and_then(offset),
        };
        sync.ok_or_else(|| {
            "choose clock, offset=SECONDS (offset=60.25, or with its standard error offset=60.25+-0.01) or correlate"
                .to_owned()
        })
    }
}

/// How to work.
#[derive(Debug, Clone, Default)]
pub struct AlignOptions {
    /// How the clocks are tied; none: by the clock where the table of angles has it.
    pub sync: Option<Sync>,
    /// What the log's columns are called.
    pub columns: Columns,
    /// How the ambient light is taken away and what counts as saturated.
    pub ambient: AmbientOptions,
    /// The longest time between two frames that were seen over which labels are interpolated, seconds; none: two frames.
    pub max_gap_s: Option<f64>,
    /// The log's time when the clock in the picture shows zero, seconds; none: told from the overlap.
    pub clock_zero_s: Option<f64>,
    /// Where the lag is looked for, and the sensor's own.
    pub lag: LagTie,
    /// Whose finger.
    pub subject: Option<String>,
    /// Which session.
    pub session: Option<String>,
    /// What the finger does, for the names of a BIDS dataset.
    pub task: Option<String>,
}

/// Where results go.
#[derive(Debug, Clone)]
pub struct AlignOutputs {
    /// The labelled set; certificate, report and pictures stand beside it, named after it.
    pub training: PathBuf,
    /// The angles as an OpenSim motion file, on the log's clock.
    pub mot: Option<PathBuf>,
    /// The angles as a BIDS Motion folder.
    pub bids: Option<PathBuf>,
    /// The markers as a DeepLabCut table.
    pub dlc: Option<PathBuf>,
    /// Whether pictures are drawn.
    pub figures: bool,
}

/// Why there is no labelled set.
#[derive(Debug, Error)]
pub enum AlignError {
    /// A table can't be read or written.
    #[error(transparent)]
    Table(#[from] TableError),
    /// The log can't be read.
    #[error(transparent)]
    Log(#[from] LogError),
    /// The log has no lit rows, or its range is none.
    #[error(transparent)]
    Ambient(#[from] AmbientError),
    /// An export can't be written, or not so.
    #[error(transparent)]
    Export(#[from] ExportError),
    /// The clocks can't be tied with confidence.
    #[error("{}: {why}", path.display())]
    NotTied {
        /// The table of angles.
        path: PathBuf,
        /// Why, and what to do.
        why: String,
    },
    /// No row gets a label.
    #[error("{}: {why}", path.display())]
    NothingLabelled {
        /// The log.
        path: PathBuf,
        /// Why, and what to do.
        why: String,
    },
    /// A result would go where an input stands.
    #[error("{}: is an input itself; choose another name for the result", .0.display())]
    Itself(PathBuf),
    /// A result can't be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// Stopped from outside.
    #[error("interrupted; nothing was written")]
    Interrupted,
}

/// Runs the job; every result is in its place when it returns.
///
/// # Errors
/// [`AlignError`] where there are no results.
pub fn run(
    inputs: &AlignInputs,
    options: &AlignOptions,
    outputs: &AlignOutputs,
    stop: &AtomicBool,
) -> Result<AlignReport, AlignError> {
    let start = Instant::now();
    let stages = Stages::default();
    let go_on = || if stop.load(Ordering::Relaxed) { Err(AlignError::Interrupted) } else { Ok(()) };
    // What can't be named so is told before the work begins.
    TableFormat::of(&outputs.training)?;
    is_no_input(inputs, outputs)?;
    let names = outputs.bids.as_ref().map(|_| {
        let task = options.task.as_deref().unwrap_or("bending");
        BidsNames::new(options.subject.as_deref(), options.session.as_deref(), task, "lunula")
    });
    let names = names.transpose()?;
    let (posture, log) = rayon::join(
        || stages.time("read angles", || Posture::read(&inputs.joints)),
        || stages.time("read log", || Log::read(&inputs.log, &options.columns)),
    );
    let (posture, log) = (posture?, log?);
    go_on()?;
    let samples = stages.time("ambient light", || samples(&log, &options.ambient))?;
    go_on()?;
    let tie = stages
        .time("tie", || tie(&posture, &log, &samples, options))
        .map_err(|why| AlignError::NotTied { path: inputs.joints.clone(), why })?;
    go_on()?;
    let labels = stages.time("label", || label(&posture, &samples, &tie, options.max_gap_s));
    if labels.angles_deg.iter().flatten().all(|angle| angle.is_nan()) {
        let why = nothing_labelled(&posture, &samples, &tie);
        return Err(AlignError::NothingLabelled { path: inputs.log.clone(), why });
    }
    let notes = [&log.notes[..], &samples.notes, &tie.notes].concat();
    let certificate = Certificate::new(&tie, &labels, notes.clone());
    let mut results = Results::default();
    stages.time("write", || results.training(&samples, &posture, &labels, &certificate, options, outputs))?;
    let exported = stages.time("export", || results.exports(&posture, &tie, names.as_ref(), inputs, outputs))?;
    let pictures = stages.time("figures", || results.pictures(&posture, &samples, &labels, &tie, outputs))?;
    go_on()?;
    let left_out = left_out(steps(&posture, &log, options, Some(outputs)));
    let draft = AlignReport {
        job: "align",
        joints: inputs.joints.clone(),
        log: inputs.log.clone(),
        rows_read: log.time_s.len() as u64,
        rows: samples.time_s.len() as u64,
        rows_with_faults: samples.faults.iter().filter(|fault| !fault.is_empty()).count() as u64,
        certificate,
        labels: LabelReport::of(&labels),
        left_out,
        warnings: [notes, exported].concat(),
        failed: Vec::new(),
        pictures,
        stages: Vec::new(),
        wall_s: 0.0,
    };
    results.finish(draft, outputs, &stages, start)
}

/// Ties the clocks as asked; the error is words for the user.
fn tie(posture: &Posture, log: &Log, samples: &Samples, options: &AlignOptions) -> Result<Tie, String> {
    const NO_CLOCK: &str = "has no clock_s, so nothing ties it to the log; read the clock in the picture (a [clock] in the marker \
                            file), or name --sync offset=SECONDS (the log's time at the first frame) or --sync correlate";
    let sync = options.sync.or_else(|| posture.has_clock().then_some(Sync::Clock)).ok_or(NO_CLOCK)?;
    match sync {
        Sync::Offset { offset_s, sd_s } => tie::by_offset(offset_s, sd_s),
        Sync::Correlate => tie::by_correlation(posture, samples, options.lag),
        Sync::Clock => tie::by_clock(posture, &log.time_s, log.midnight_s, options.clock_zero_s),
    }
}

/// Why no row has a label.
fn nothing_labelled(posture: &Posture, samples: &Samples, tie: &Tie) -> String {
    let span = |times: &[f64]| Some([*times.first()?, *times.last()?]);
    let (Some(rows), Some(frames)) = (span(&samples.time_s), span(&posture.time_s)) else {
        return "holds no row to label".to_owned();
    };
    let video = frames.map(|t| tie.timebase.other_s(t));
    if rows[1] < video[0] || rows[0] > video[1] {
        format!(
            "does not overlap with the video: its rows are at {:.3} to {:.3} s, and the video is at {:.3} to {:.3} s of the \
             log's clock; check that they belong together, and the offset",
            rows[0], rows[1], video[0], video[1]
        )
    } else {
        "no row lies between two frames with an angle; see `status` in the table of angles, or allow a longer --max-gap"
            .to_owned()
    }
}

/// Refuses to write over an input.
fn is_no_input(inputs: &AlignInputs, outputs: &AlignOutputs) -> Result<(), AlignError> {
    let given = [Some(&inputs.joints), Some(&inputs.log), inputs.tracks.as_ref()];
    let is_given = |path: &Path| given.into_iter().flatten().any(|input| is_same_file(input, path));
    let written = [Some(&outputs.training), outputs.mot.as_ref(), outputs.dlc.as_ref()];
    match written.into_iter().flatten().find(|path| is_given(path)) {
        Some(path) => Err(AlignError::Itself(path.clone())),
        None => Ok(()),
    }
}
