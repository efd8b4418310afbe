//! `lunula prompt`: a person prompted through a protocol, in the browser of this machine, or a simulated one.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::Context;
use clap::Args;
use lunula::job::{Given, Watch};
use lunula::live::{StreamOptions, View};
use lunula::prompt::{
    Nobody, PromptFiles, PromptReport, Prompter, Show, is_alone, prompt_steps, subject, write_protocol,
};
use lunula_ui::{Latest, Prompting};

use crate::jobs::live::session::tell;
use crate::jobs::{JobArgs, Plan, outcome, show};
use crate::ui::PageArgs;
use crate::{Common, Outcome};

/// Prompt a person through a protocol of forces and bending, and record it for `lunula train` (5.2, Fig. 87)
///
/// Prints one line, the address of the page with a secret; the page shows the ring to follow, the disc of the measured
/// force, the bar, the finger that bends, and how the cone of forces fills. The recording has the measured forces, and
/// what was prompted in columns of its own. Beside it: <out>.frames.csv with every frame that was shown,
/// <out>.run.json, <out>.stream.json, <out>.clock.toml for a marker file, and <out>.extra.toml, a short protocol
/// through what is missing. The page's keys are Space, R, N, E, Esc and ?.
#[derive(Debug, Args)]
#[command(mut_arg("source", |source| source.required(false)))]
pub(crate) struct PromptArgs {
    /// The protocol [default: that of 5.2.4]
    #[arg(value_name = "PROTOCOL.toml")]
    protocol: Option<PathBuf>,
    #[command(flatten)]
    given: Given<StreamOptions>,
    /// The recording (.csv)
    #[arg(long, value_name = "RECORDING.csv", required_unless_present = "write_protocol")]
    out: Option<PathBuf>,
    /// A recording that exists is replaced
    #[arg(long, requires = "out")]
    replace: bool,
    /// Nobody is there: a generated finger follows, as fast as it can be computed; the same as --source
    /// phantom:subject?rate=max (rate=1 with a page, in real time)
    #[arg(long, conflicts_with = "source")]
    simulate: bool,
    /// Write the protocol of 5.2.4 to this file, to be changed, and do nothing else
    #[arg(long, value_name = "PROTOCOL.toml", conflicts_with_all = ["source", "out", "simulate", "protocol"])]
    write_protocol: Option<PathBuf>,
    #[command(flatten)]
    page: PageArgs,
    #[command(flatten)]
    job: JobArgs,
}

pub(crate) fn run(args: &PromptArgs) -> anyhow::Result<Outcome> {
    let common = &args.job.common;
    let stop = common.start()?;
    if let Some(path) = &args.write_protocol {
        write_protocol(path)?;
        common.say(&format!("the protocol of 5.2.4 is in {}", path.display()));
        return Ok(Outcome::Done);
    }
    let mut options = args.given.options.clone();
    if args.simulate {
        options.source = vec![subject().map_err(anyhow::Error::msg)?];
    }
    let out = args.out.clone().context("--out is needed: the recording")?;
    let files = PromptFiles { protocol: args.protocol.clone(), out, replace: args.replace };
    if args.job.plan {
        return show(common, "prompt", &Plan::from(prompt_steps(&options, &files)));
    }
    let said = |what: &str| tell(common, what);
    let watch = Watch { said: &args.given.said, stop: &stop, tick: &|_, _| {} };
    let report = if is_alone(&options) {
        Prompter::new(&options, &files, Arc::new(Nobody))?.run(None, &said, &watch)?
    } else {
        with_page(args, &options, &files, &said, &watch)?
    };
    common.print_json(&report)?;
    Ok(ended(common, &report))
}

/// The session in this thread, its page in another.
fn with_page(
    args: &PromptArgs,
    options: &StreamOptions,
    files: &PromptFiles,
    said: &dyn Fn(&str),
    watch: &Watch<'_>,
) -> anyhow::Result<PromptReport> {
    let news = Arc::new(News { state: Latest::new("null"), force: Latest::new("[]") });
    let prompter = Arc::new(Prompter::new(options, files, Arc::clone(&news) as Arc<dyn Show>)?);
    let page = Page(Arc::clone(&prompter));
    let pictures = Latest::new("{}");
    let sites = vec![lunula_ui::prompt(Arc::new(page), &news.state, &news.force), lunula_ui::live(&pictures)];
    let server = args.page.bind(sites)?;
    let opened = args.page.listening.announce(&server, &args.job.common)?;
    let (view, window) = View::new();
    let over = AtomicBool::new(false);
    let report = std::thread::scope(|scope| {
        scope.spawn(|| window.run(|picture| pictures.leave(picture)));
        let serving = scope.spawn(|| server.run(&over));
        let report = prompter.run(Some(view), said, watch);
        over.store(true, Ordering::Relaxed);
        let served = serving.join().unwrap_or(Ok(()));
        served.map(|()| report)
    })?;
    drop(opened);
    Ok(report?)
}

/// What pages hear.
struct News {
    state: Latest,
    force: Latest,
}

impl Show for News {
    fn state(&self, json: &str) {
        self.state.leave(json);
    }

    fn force(&self, json: &str) {
        self.force.leave(json);
    }
}

struct Page(Arc<Prompter>);

impl Prompting for Page {
    fn now_s(&self) -> f64 {
        self.0.now_s()
    }

    fn key(&self, json: &[u8]) -> bool {
        self.0.key(json)
    }

    fn frames(&self, json: &[u8]) -> bool {
        self.0.frames(json)
    }
}

fn ended(common: &Common, report: &PromptReport) -> Outcome {
    let outcome = outcome(&report.failed);
    let covered = &report.coverage.cylindrical;
    if report.rows > 0 {
        common.say(&format!("{} rows in {}", report.rows, report.out.display()));
    }
    for step in &report.followed {
        let off = step.rms_n.map_or("-".to_owned(), |rms_n| format!("{rms_n:.2}"));
        common.say(&format!("{}: {off} N off the prompt (RMS), a person's lag included", step.step));
    }
    common.say(&format!("{:.0} % of the cone's {} cells", (100.0 * covered.visited).floor(), covered.cells));
    if let (Some(extra), Some(file)) = (&report.extra, &report.extra_file) {
        let [before, after] = [extra.before, extra.after].map(|share| (100.0 * share).floor());
        let file = file.display();
        common.say(&format!("{:.0} s more would fill {before:.0} % -> {after:.0} %: {file}", extra.seconds));
    }
    if let Some(frames) = &report.frames {
        let off = frames.off_px_max.map_or("-".to_owned(), |off| format!("{off:.2}"));
        common.say(&format!("{} frames shown, {} dropped, at most {off} px off", frames.shown, frames.dropped));
    }
    outcome
}
