//! What every command of a job does: plan or run, then report in JSON and in words.

use std::path::Path;

use clap::Args;
use lunula::job::{Report, Said, Watch};
use lunula::stages::Step;
use serde::Serialize;

use super::{Common, Outcome};

/// What every job takes.
#[derive(Debug, Args)]
pub(super) struct JobArgs {
    /// Show what would be done and what left out, and do nothing
    #[arg(long)]
    plan: bool,
    #[command(flatten)]
    pub(super) common: Common,
}

/// A command that runs one job.
pub(super) trait Command {
    /// The figures of its report.
    type Figures: Serialize;

    /// What is counted while it runs: `frames`.
    const UNIT: &'static str = "steps";

    /// The job's name, as plans give it.
    fn name(&self) -> &'static str;

    fn job(&self) -> &JobArgs;

    /// The options as they were written.
    fn said(&self) -> &Said;

    fn plan(&self) -> anyhow::Result<Vec<Step>>;

    fn run(&self, watch: &Watch<'_>) -> anyhow::Result<Report<Self::Figures>>;

    /// The figures in words.
    fn say(&self, common: &Common, report: &Report<Self::Figures>);

    /// Where to look if there is no picture.
    fn result(&self) -> Option<&Path>;
}

/// Plans or runs a job, and prints its report.
pub(super) fn run<C: Command>(command: &C) -> anyhow::Result<Outcome> {
    let JobArgs { plan, common } = command.job();
    let stop = common.start()?;
    if *plan {
        return common.show_plan(command.name(), &command.plan()?);
    }
    let bar = common.progress(0, C::UNIT);
    let tick = |done: u64, all: Option<u64>| {
        bar.set_length(all.unwrap_or(done));
        bar.set_position(done);
    };
    let report = command.run(&Watch { said: command.said(), stop: &stop, tick: &tick });
    bar.finish_and_clear();
    let report = report?;
    report.failed.iter().for_each(|what| eprintln!("failed: {what}"));
    common.warn(&report.warnings);
    common.note(&report.notes);
    common.print_json(&report)?;
    command.say(common, &report);
    if common.verbose {
        common.say_stages(&report.stages);
        common.say_left_out(&report.left_out);
    }
    let look = report.pictures.first().map(AsRef::as_ref).or_else(|| command.result());
    let look = look.map_or(String::new(), |look| format!("; look at {}", look.display()));
    common.say(&format!("{:.2} s{look}", report.wall_s));
    Ok(if report.failed.is_empty() { Outcome::Done } else { Outcome::SomeFailed })
}
