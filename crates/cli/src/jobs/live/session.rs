//! `lunula live` and `lunula record`: a sensor at work.

use std::path::PathBuf;

use clap::Args;
use lunula::job::{Given, Report, Watch};
use lunula::live::{
    AnswerOptions, LiveOptions, MouseFiles, MouseOptions, Readers, SessionFigures, SessionFiles, SessionReport,
    StreamOptions, live, record,
};
use lunula::predictor::PredictChoices;
use lunula::stages::Step;
use lunula::words::shown_lines;
use serde_json::json;

use crate::jobs::{JobArgs, Plan, show};
use crate::{Common, Outcome, out};

/// Answer a sensor's samples as they come: forces, angle, switch (6.1)
///
/// Rows of CSV on standard output, the names of the columns first, one for each sample with the LED on, as soon as it
/// is there: time_s and what `lunula predict` writes for these models, to the byte (of a log with an LED under its
/// --ambient preceding). Messages, states (ok, slow, stalled, lost, reconnecting) and alarms are on standard error. A
/// row that is spoilt costs itself and is counted; an unplugged device is waited for. With --out the samples are
/// recorded, the rows in <out>.predicted.csv, the report with the stream's certificate and latencies in
/// <out>.stream.json.
#[derive(Debug, Args)]
pub(crate) struct LiveArgs {
    /// Models that `lunula train` wrote: of force, of posture, or both
    #[arg(long = "model", required = true, value_name = "MODEL.json", num_args = 1..)]
    models: Vec<PathBuf>,
    #[command(flatten)]
    given: Given<LiveOptions>,
    /// A virtual switch, as `lunula switch tune` writes it: a column `switch`, 1 while it is pressed
    #[arg(long, value_name = "SWITCH.toml")]
    switch: Option<PathBuf>,
    /// The switch's presses and releases, a line of JSON each
    #[arg(long, value_name = "EVENTS.jsonl", requires = "switch")]
    events: Option<PathBuf>,
    #[command(flatten)]
    out: OutArgs,
    #[command(flatten)]
    job: JobArgs,
}

/// Record a sensor's samples for `lunula align`, `train`, `fit` and `switch`
///
/// The recording is on disk while it grows: killed at any moment it lacks a second at most. Beside it is
/// <out>.stream.json: what was lost or spoilt, and how the device's clock runs against this computer's. A stream
/// without samples is an alarm within a second, and leaves no file.
#[derive(Debug, Args)]
pub(crate) struct RecordArgs {
    #[command(flatten)]
    given: Given<StreamOptions>,
    #[command(flatten)]
    out: OutArgs,
    #[command(flatten)]
    job: JobArgs,
}

/// Move and click with a sensor: shear to motion, pressing harder to clicks, bending to scrolling (6.2)
///
/// With --uinput it is a mouse of this computer; --events has a line of JSON for each move, button and line scrolled.
/// Needs a model of all three forces; with one of posture, bending the finger in the air scrolls. It begins once the
/// finger was seen lifted.
#[derive(Debug, Args)]
pub(crate) struct MouseArgs {
    /// Models that `lunula train` wrote: of force, and of posture for scrolling
    #[arg(long = "model", required = true, value_name = "MODEL.json", num_args = 1..)]
    models: Vec<PathBuf>,
    #[command(flatten)]
    given: Given<MouseOptions>,
    /// Dead zone, gains, thresholds, times [default: the defaults of each key]
    #[arg(long, value_name = "MOUSE.toml")]
    config: Option<PathBuf>,
    /// Moves, buttons and scrolling, a line of JSON each
    #[arg(long, value_name = "EVENTS.jsonl", required_unless_present_any = ["uinput", "plan"])]
    events: Option<PathBuf>,
    /// Move the pointer of this computer (Linux' uinput; `lunula doctor` says what it lacks)
    #[arg(long)]
    uinput: bool,
    #[command(flatten)]
    out: OutArgs,
    #[command(flatten)]
    job: JobArgs,
}

#[derive(Debug, Args)]
struct OutArgs {
    /// The recording (.csv or .parquet)
    #[arg(long, value_name = "RECORDING.csv")]
    out: Option<PathBuf>,
    /// A recording that exists is replaced
    #[arg(long, requires = "out")]
    replace: bool,
}

pub(crate) fn run_live(args: &LiveArgs) -> anyhow::Result<Outcome> {
    let (common, options) = (&args.job.common, &args.given.options);
    let stop = common.start()?;
    let files = SessionFiles {
        out: args.out.out.clone(),
        replace: args.out.replace,
        models: args.models.clone(),
        switch: args.switch.clone(),
        events: args.events.clone(),
        mouse: None,
    };
    if args.job.plan {
        return show(common, "live", &Plan::from(live_steps(options, &files)));
    }
    let tell = |what: &str| tell(common, what);
    let rows = out::descriptor()?;
    let watch = Watch { said: &args.given.said, stop: &stop, tick: &|_, _| {} };
    let report = live(options, &files, Readers { rows: Some(rows), tell: &tell }, &watch)?;
    if common.json {
        // Standard output has the rows.
        eprintln!("{}", serde_json::to_string(&report)?);
    }
    Ok(ended(common, &report))
}

pub(crate) fn run_mouse(args: &MouseArgs) -> anyhow::Result<Outcome> {
    let common = &args.job.common;
    let MouseOptions { stream, answer } = args.given.options.clone();
    let options = LiveOptions { stream, answer, tcp: None };
    let stop = common.start()?;
    let mouse = MouseFiles { config: args.config.clone(), events: args.events.clone(), uinput: args.uinput };
    let files = SessionFiles {
        out: args.out.out.clone(),
        replace: args.out.replace,
        models: args.models.clone(),
        mouse: Some(mouse),
        ..SessionFiles::default()
    };
    if args.job.plan {
        let mut steps = live_steps(&options, &files);
        let how = if args.uinput { "a mouse of this computer" } else { "events only" };
        steps.insert(3, Step::new("pointer", true, how.to_owned()));
        return show(common, "mouse", &Plan::from(steps));
    }
    let tell = |what: &str| tell(common, what);
    let watch = Watch { said: &args.given.said, stop: &stop, tick: &|_, _| {} };
    let report = live(&options, &files, Readers { rows: None, tell: &tell }, &watch)?;
    common.print_json(&report)?;
    if let Some(counts) = report.pointer {
        common.say(&format!("{} moves, {} clicks, {} lines scrolled", counts.moves, counts.clicks, counts.scrolled));
    }
    Ok(ended(common, &report))
}

/// `lunula predict MODEL.. -`: a stream on standard input.
pub(crate) fn run_stream(
    common: &Common,
    given: &Given<PredictChoices>,
    models: &[PathBuf],
) -> anyhow::Result<Outcome> {
    let PredictChoices { gate, intervals, rows } = given.options.clone();
    let stop = common.start()?;
    let options = LiveOptions {
        stream: StreamOptions {
            source: "-".parse()?,
            volts_per_count: None,
            names: None,
            keep: Vec::new(),
            seconds: None,
            log: rows.log,
        },
        answer: AnswerOptions { gate, intervals, keep_faults: rows.keep_faults },
        tcp: None,
    };
    let files = SessionFiles { models: models.to_vec(), ..SessionFiles::default() };
    let tell = |what: &str| tell(common, what);
    let rows = out::descriptor()?;
    let watch = Watch { said: &given.said, stop: &stop, tick: &|_, _| {} };
    let report = live(&options, &files, Readers { rows: Some(rows), tell: &tell }, &watch)?;
    report.failed.iter().for_each(|what| eprintln!("failed: {}", shown_lines(what)));
    common.warn(&report.warnings);
    Ok(if report.failed.is_empty() { Outcome::Done } else { Outcome::SomeFailed })
}

pub(crate) fn run_record(args: &RecordArgs) -> anyhow::Result<Outcome> {
    let (common, options) = (&args.job.common, &args.given.options);
    let stop = common.start()?;
    let files = SessionFiles { out: args.out.out.clone(), replace: args.out.replace, ..SessionFiles::default() };
    if args.job.plan {
        return show(common, "record", &Plan::from(record_steps(options, &files)));
    }
    let tell = |what: &str| tell(common, what);
    let watch = Watch { said: &args.given.said, stop: &stop, tick: &|_, _| {} };
    let report = record(options, &files, &tell, &watch)?;
    if !common.json {
        common.say(&format!("{} rows in {}", report.rows, files.out.unwrap_or_default().display()));
    }
    common.print_json(&report)?;
    Ok(ended(common, &report))
}

fn record_steps(options: &StreamOptions, files: &SessionFiles) -> Vec<Step> {
    let out = files.out.as_ref().map_or("no --out".to_owned(), |out| out.display().to_string());
    vec![
        Step::new("read", true, options.source.to_string()),
        Step::new("record", files.out.is_some(), out),
        Step::new("predict", false, "`lunula live` does".to_owned()),
    ]
}

fn live_steps(options: &LiveOptions, files: &SessionFiles) -> Vec<Step> {
    let [read, record, _] =
        <[Step; 3]>::try_from(record_steps(&options.stream, files)).unwrap_or_else(|_| unreachable!());
    let switch = files.switch.as_ref().map_or("no --switch".to_owned(), |switch| switch.display().to_string());
    let tcp = options.tcp.map_or("no --tcp".to_owned(), |address| address.to_string());
    vec![
        read,
        Step::new("predict", true, format!("{} models", files.models.len())),
        Step::new("gate", files.models.len() > 1, "where one model predicts forces and one posture".to_owned()),
        Step::new("switch", files.switch.is_some(), switch),
        record,
        Step::new("serve", options.tcp.is_some(), tcp),
    ]
}

/// A message as soon as it is known: in words, or a line of JSON.
fn tell(common: &Common, what: &str) {
    if common.json {
        eprintln!("{}", json!({ "message": what }));
    } else if !common.quiet || what.starts_with("alarm") {
        eprintln!("{}", shown_lines(what));
    }
}

fn ended(common: &Common, report: &SessionReport) -> Outcome {
    report.failed.iter().for_each(|what| eprintln!("failed: {}", shown_lines(what)));
    common.warn(&report.warnings);
    if !common.quiet && !common.json {
        eprintln!("{}", shown_lines(&words(report)));
    }
    if report.failed.is_empty() { Outcome::Done } else { Outcome::SomeFailed }
}

fn words(report: &Report<SessionFigures>) -> String {
    let SessionFigures { rows, answered, latency, .. } = &report.figures;
    let rate = report.stream.rate_hz.map_or(String::new(), |rate| format!(" at {rate:.1} Hz"));
    let work = latency.work.map_or(String::new(), |work| {
        format!("; work per row {:.0} us in median, 99 in 100 within {:.0} us", work.p50_us, work.p99_us)
    });
    format!("{rows} rows{rate}, {answered} answered{work}")
}
