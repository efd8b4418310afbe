//! The alignment job: a table of joint angles and a log in, a labelled set with its certificate out; the one entry that
//! command line, pipelines and trade-offs call.

use crate::align::certificate::Certificate;
use crate::align::error::AlignError;
use crate::align::export::BidsNames;
use crate::align::label::label;
use crate::align::label::stamps::scatter_s;
use crate::align::options::{AlignInputs, AlignOptions, AlignOutputs, Sync};
use crate::align::posture::Posture;
use crate::align::run::plan::{Foreknown, steps};
use crate::align::run::report::{AlignFigures, AlignReport, LabelReport};
use crate::align::run::results::Results;
use crate::align::tie::{self, Agreement, Tie, TieMethod};
use crate::job::{Report, Watch};
use crate::log::{Log, Samples, samples};
use crate::stages::{Stages, left_out};
use crate::table::TableFormat;

/// Scatter of stamps from which on it is noted: beyond what a log of milliseconds rounds, 0.3 ms.
const NOTED_S: f64 = 1e-3;

/// Runs the job; every result is in its place when it returns.
///
/// # Errors
/// [`AlignError`] where there are no results.
pub fn run(
    inputs: &AlignInputs,
    options: &AlignOptions,
    outputs: &AlignOutputs,
    watch: &Watch<'_>,
) -> Result<AlignReport, AlignError> {
    let stages = Stages::default();
    // A name that no table can have, or an input's, is refused before the work begins.
    TableFormat::of(&outputs.training)?;
    let mut results = Results::start(inputs, outputs)?;
    let names = outputs.bids.as_ref().map(|_| {
        let task = options.task.as_deref().unwrap_or("bending");
        BidsNames::new(options.subject.as_deref(), options.session.as_deref(), task, "lunula", options.run)
    });
    let names = names.transpose()?;
    let (posture, log) = rayon::join(
        || stages.time("read angles", || Posture::read(&inputs.joints)),
        || stages.time("read log", || Log::read(&inputs.log, &options.log.columns)),
    );
    let (posture, log) = (posture?, log?);
    watch.go_on()?;
    let samples = stages.time("ambient light", || samples(&log, &options.log.ambient))?;
    watch.go_on()?;
    // What is doubted of the log's times may be why.
    let doubted = |why: String| [&[why][..], &samples.warnings].concat().join("; ");
    let tie = stages
        .time("tie", || tie(&posture, &log, &samples, options))
        .map_err(|why| AlignError::NotTied { path: inputs.joints.clone(), why: doubted(why) })?;
    watch.go_on()?;
    // Rows in which the LED is on may come in blocks.
    let stamp_sd_s = scatter_s(&log.time_s).min(scatter_s(&samples.time_s));
    let labels = stages.time("label", || label(&posture, &samples, &tie, options.max_gap_s, stamp_sd_s));
    if labels.angles_deg.iter().flatten().all(|angle| angle.is_nan()) {
        let why = doubted(nothing_labelled(&posture, &samples, &tie));
        return Err(AlignError::NothingLabelled { path: inputs.log.clone(), why });
    }
    let agreement = match tie.method {
        TieMethod::Correlate => Agreement::default(),
        TieMethod::Clock | TieMethod::Offset => stages.time("compare", || tie::compare(&posture, &samples, &tie)),
    };
    watch.go_on()?;
    let warnings = [&posture.warnings[..], &tie.warnings, &agreement.warnings, &samples.warnings].concat();
    let scatter = (stamp_sd_s > NOTED_S).then(|| {
        format!(
            "the log's time stamps lie {:.1} ms off even steps (SD), and labels' standard errors count that as late \
             stamps; how late all of them are isn't seen",
            1e3 * stamp_sd_s
        )
    });
    let notes = [&log.notes[..], &samples.notes, &tie.notes, &agreement.notes, scatter.as_slice()].concat();
    let certificate = Certificate::new(&tie, &labels, [&warnings[..], &notes].concat());
    stages.time("write", || results.training(&samples, &posture, &labels, &certificate, options, outputs))?;
    let exported = stages.time("export", || results.exports(&posture, &tie, names.as_ref(), inputs, outputs))?;
    let pictures = stages.time("figures", || results.pictures(&posture, &samples, &labels, &tie, outputs))?;
    watch.go_on()?;
    let figures = AlignFigures {
        joints: inputs.joints.clone(),
        log: inputs.log.clone(),
        rows_read: log.time_s.len() as u64,
        rows: samples.time_s.len() as u64,
        rows_with_faults: samples.faults.iter().filter(|fault| !fault.is_empty()).count() as u64,
        certificate,
        labels: LabelReport::of(&labels),
    };
    let left_out = left_out(steps(&Foreknown::of(&posture, &log), options, outputs));
    let notes = [notes, exported].concat();
    let mut report = Report { left_out, warnings, notes, pictures, ..Report::new("align", watch, figures) };
    if tie.method != TieMethod::Correlate {
        report.unused(&["lag_about", "max_lag", "sensor_lag"], "only --sync correlate looks for a lag");
    }
    if log.led.is_none() {
        report.unused(&["ambient"], "the log has no column `led`");
    }
    if tie.method != TieMethod::Clock {
        report.unused(&["clock_zero"], "no clock in the picture ties the two");
    }
    results.finish(report.timed(&stages), outputs)
}

/// Ties the clocks as asked; the error is words for the user.
fn tie(posture: &Posture, log: &Log, samples: &Samples, options: &AlignOptions) -> Result<Tie, String> {
    const NO_CLOCK: &str = "has no clock_s, so nothing ties it to the log; read the clock in the picture (a [clock] in \
                            the marker file), or name --sync offset=SECONDS (the log's time at the first frame) or \
                            --sync correlate";
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
            "does not overlap with the video: its rows are at {:.3} to {:.3} s, and the video is at {:.3} to {:.3} s \
             of the log's clock; check that they belong together, and the offset",
            rows[0], rows[1], video[0], video[1]
        )
    } else {
        "no row lies between two frames with an angle; see `status` in the table of angles, or allow a longer --max-gap"
            .to_owned()
    }
}
