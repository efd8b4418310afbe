//! `lunula live` and `lunula record`: a sensor at work.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use clap::Args;
use lunula::job::{Given, Report, Said, Watch};
use lunula::live::streams::source::OfFinger;
use lunula::live::{
    AnswerOptions, LiveOptions, MouseFiles, MouseOptions, Readers, SessionFigures, SessionFiles, SessionReport,
    StreamOptions, View, live, live_steps, record, record_steps,
};
use lunula::predictor::PredictChoices;
use lunula::words::shown_lines;
use lunula_ui::Latest;
use serde_json::json;

use crate::jobs::{JobArgs, Plan, outcome, show};
use crate::ui::PageArgs;
use crate::{Common, Outcome, out};

/// Answer a sensor's samples as they come: forces, angle, switch (6.1)
///
/// Rows of CSV on standard output, the names of the columns first, one for each sample with the LED on, as soon as it
/// is there: time_s and what `lunula predict` writes for these models, to the byte (of a log with an LED under its
/// --ambient preceding). Messages, states (ok, slow, stalled, lost, reconnecting) and alarms are on standard error. A
/// row that is spoilt costs itself and is counted; an unplugged device is waited for. With --out the samples are
/// recorded, the rows in <out>.predicted.csv, the report with the streams' certificates and latencies in
/// <out>.stream.json. Of several fingers each row says whose it is (`finger`), all on one clock; samples are recorded
/// in <out>.FINGER.csv.
#[derive(Debug, Args)]
#[command(mut_arg("port", |one| one.requires("serve")), mut_arg("open", |one| one.requires("serve")))]
#[command(mut_arg("listen", |one| one.requires("serve")), mut_arg("results", |one| one.requires("serve")))]
#[command(mut_arg("json", |json| json.help("Messages and the report as JSON, an object a line, on standard error")))]
pub(crate) struct LiveArgs {
    /// Models that `lunula train` wrote: of force, of posture, or both; index=MODEL.json is one finger's
    #[arg(long = "model", required = true, value_name = "[FINGER=]MODEL.json", num_args = 1..)]
    models: Vec<OfFinger<PathBuf>>,
    #[command(flatten)]
    given: Given<LiveOptions>,
    /// A virtual switch, as `lunula switch tune` writes it: a column `switch`, 1 while it is pressed; once for each
    /// finger, which index=SWITCH.toml or the file's `finger` names
    #[arg(long, value_name = "[FINGER=]SWITCH.toml")]
    switch: Vec<OfFinger<PathBuf>>,
    /// The switches' presses and releases, a line of JSON each
    #[arg(long, value_name = "EVENTS.jsonl", requires = "switch")]
    events: Option<PathBuf>,
    #[command(flatten)]
    out: OutArgs,
    #[command(flatten)]
    page: PageArgs,
    #[command(flatten)]
    job: JobArgs,
}

/// Record a sensor's samples for `lunula align`, `train`, `fit` and `switch`
///
/// The recording is on disk while it grows: killed at any moment it lacks a second at most. Several fingers have
/// one each (<out>.index.csv) on one clock; a force transducer that is a device of its own is recorded with --force.
/// Beside it is <out>.stream.json: what was lost or spoilt, and how the device's clock runs against this computer's. A
/// stream without samples is an alarm within a second, and leaves no file.
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
    #[command(flatten)]
    mouse: MouseFiles,
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
    /// A recording, or events, that exist are replaced
    #[arg(long)]
    replace: bool,
}

impl OutArgs {
    fn files(&self) -> SessionFiles {
        SessionFiles { out: self.out.clone(), replace: self.replace, ..SessionFiles::default() }
    }
}

pub(crate) fn run_live(args: &LiveArgs) -> anyhow::Result<Outcome> {
    let (common, options) = (&args.job.common, &args.given.options);
    let stop = common.start()?;
    let files = SessionFiles {
        models: args.models.clone(),
        switches: args.switch.clone(),
        events: args.events.clone(),
        ..args.out.files()
    };
    if args.job.plan {
        return show(common, "live", &Plan::from(live_steps(options, &files)));
    }
    let session = |view| session(common, &args.given.said, &stop, options, &files, view);
    let report = if options.serve { served(&args.page, common, session)? } else { session(None)? };
    if common.json {
        // Standard output has the rows.
        eprintln!("{}", serde_json::to_string(&report)?);
    }
    Ok(ended(common, &report))
}

pub(crate) fn run_mouse(args: &MouseArgs) -> anyhow::Result<Outcome> {
    let common = &args.job.common;
    let MouseOptions { stream, answer } = args.given.options.clone();
    let options = LiveOptions { stream, answer, tcp: None, lsl: None, serve: false };
    let stop = common.start()?;
    let files = SessionFiles { models: all(&args.models), mouse: Some(args.mouse.clone()), ..args.out.files() };
    if args.job.plan {
        return show(common, "mouse", &Plan::from(live_steps(&options, &files)));
    }
    let report = session(common, &args.given.said, &stop, &options, &files, None)?;
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
        stream: StreamOptions { source: vec![OfFinger::any("-".parse()?)], log: rows.log, ..StreamOptions::default() },
        answer: AnswerOptions { gate, intervals, keep_faults: rows.keep_faults },
        tcp: None,
        lsl: None,
        serve: false,
    };
    let files = SessionFiles { models: all(models), ..SessionFiles::default() };
    let report = session(common, &given.said, &stop, &options, &files, None)?;
    Ok(outcome(&report.failed))
}

/// A session with models; its rows go to standard output, but for a mouse's.
fn session(
    common: &Common,
    said: &Said,
    stop: &AtomicBool,
    options: &LiveOptions,
    files: &SessionFiles,
    view: Option<View>,
) -> anyhow::Result<SessionReport> {
    let rows = if files.mouse.is_none() { Some(out::descriptor()?) } else { None };
    let readers = Readers { rows, tell: &|what: &str| tell(common, what), view };
    Ok(live(options, files, readers, &Watch { said, stop, tick: &|_, _| {} })?)
}

/// What a page takes to hear the last picture.
const LAST_WORD: Duration = Duration::from_millis(200);

/// A session that a page shows; the page ends with it.
fn served(
    page: &PageArgs,
    common: &Common,
    session: impl FnOnce(Option<View>) -> anyhow::Result<SessionReport>,
) -> anyhow::Result<SessionReport> {
    let pictures = Latest::new("{}");
    let server = page.bind(vec![lunula_ui::live(&pictures)])?;
    // Standard output has the rows.
    let url = server.url();
    eprintln!("{}", if common.json { json!({ "url": url }).to_string() } else { format!("page: {url}") });
    let _opened = page.listening.opened(&server)?;
    let (view, window) = View::new();
    let is_over = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let drawing = scope.spawn(|| window.run(|picture| pictures.leave(picture)));
        let serving = scope.spawn(|| server.run(&is_over));
        let report = session(Some(view));
        // Pages hear that it is over.
        drop(drawing.join());
        std::thread::sleep(LAST_WORD);
        is_over.store(true, Ordering::Relaxed);
        if let Ok(Err(why)) = serving.join() {
            eprintln!("warning: the page: {why}");
        }
        report
    })
}

pub(crate) fn run_record(args: &RecordArgs) -> anyhow::Result<Outcome> {
    let (common, options) = (&args.job.common, &args.given.options);
    let stop = common.start()?;
    let files = args.out.files();
    if args.job.plan {
        return show(common, "record", &Plan::from(record_steps(options, &files)));
    }
    let tell = |what: &str| tell(common, what);
    let watch = Watch { said: &args.given.said, stop: &stop, tick: &|_, _| {} };
    let report = record(options, &files, &tell, &watch)?;
    if !common.json {
        let recorded = report.rows - report.lost_by_disk;
        common.say(&format!("{recorded} rows in {}", files.out.unwrap_or_default().display()));
    }
    common.print_json(&report)?;
    Ok(ended(common, &report))
}

fn all(models: &[PathBuf]) -> Vec<OfFinger<PathBuf>> {
    models.iter().cloned().map(OfFinger::any).collect()
}

/// A message as soon as it is known: in words, or a line of JSON.
pub(super) fn tell(common: &Common, what: &str) {
    if common.json {
        eprintln!("{}", json!({ "message": what }));
    } else if !common.quiet || what.starts_with("alarm") {
        eprintln!("{}", shown_lines(what));
    }
}

/// Says figures and failures; warnings were said when they were known.
fn ended(common: &Common, report: &SessionReport) -> Outcome {
    if !common.quiet && !common.json {
        eprintln!("{}", shown_lines(&words(report)));
    }
    outcome(&report.failed)
}

fn words(report: &Report<SessionFigures>) -> String {
    let SessionFigures { rows, answered, latency, .. } = &report.figures;
    let shown = |rate: f64| if rate < 1.0 { format!("{rate:.4}") } else { format!("{rate:.1}") };
    let rates: Vec<String> = report.sources.iter().filter_map(|source| source.stream.rate_hz).map(shown).collect();
    let rate = if rates.is_empty() { String::new() } else { format!(" at {} Hz", rates.join(", ")) };
    let work = latency.work.map_or(String::new(), |work| {
        format!("; work per row {:.0} us in median, 99 in 100 within {:.0} us", work.p50_us, work.p99_us)
    });
    let answered = if report.columns.is_empty() { String::new() } else { format!(", {answered} answered") };
    format!("{rows} rows{rate}{answered}{work}")
}
