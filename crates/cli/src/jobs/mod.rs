//! The commands of jobs, one file each, and what they have in common: plan or run, then report in JSON and in words.

pub(crate) mod align;
pub(crate) mod camera;
pub(crate) mod hemodynamics;
pub(crate) mod layout;
pub(crate) mod live;
pub(crate) mod nailvideo;
pub(crate) mod phantom;
pub(crate) mod photos;
pub(crate) mod posture;
pub(crate) mod predictor;
pub(crate) mod trajectory;

use std::path::PathBuf;

use anyhow::Context;
use clap::Args;
use lunula::job::{Outputs, Report, Said, Watch};
use lunula::stages::{Fate, Step};
use lunula::words::shown_lines;
use serde::Serialize;
use serde_json::json;

use super::{Common, Outcome, print_line};

/// What every job takes.
#[derive(Debug, Args)]
pub(super) struct JobArgs {
    /// Show what would be done and what left out, and do nothing
    #[arg(long)]
    plan: bool,
    #[command(flatten)]
    pub(super) common: Common,
}

/// What every job takes that has results and draws pictures.
#[derive(Debug, Args)]
pub(super) struct ResultArgs {
    /// A folder for the results
    #[arg(long, value_name = "DIR", required_unless_present = "plan")]
    pub(super) out: Option<PathBuf>,
    /// Draw no pictures
    #[arg(long)]
    pub(super) no_figures: bool,
    #[command(flatten)]
    pub(super) job: JobArgs,
}

impl ResultArgs {
    /// What is asked of the job `name`, which counts `unit`; `said` are the options as they were written.
    pub(super) fn request<'a>(&'a self, name: &'static str, unit: &'static str, said: &'a Said) -> Request<'a> {
        Request { name, unit, job: &self.job, said, result: self.out.clone() }
    }

    /// Where results go; of a plan perhaps nowhere yet.
    pub(super) fn place(&self) -> PathBuf {
        self.out.clone().unwrap_or_default()
    }

    pub(super) fn outputs(&self) -> Outputs {
        Outputs { figures: !self.no_figures, ..Outputs::all(self.place()) }
    }

    /// Of a job that only prints where no place for results was said.
    pub(super) fn outputs_if_said(&self) -> Option<Outputs> {
        self.out.as_ref().map(|_| self.outputs())
    }
}

/// The place of what is run, not only planned.
pub(super) fn needed<T>(out: Option<T>) -> anyhow::Result<T> {
    out.context("--out is needed: where the results go")
}

/// What a command asks of its job.
pub(super) struct Request<'a> {
    /// The job's name, as plans give it.
    pub(super) name: &'static str,
    /// What is counted while it runs: `frames`.
    pub(super) unit: &'static str,
    pub(super) job: &'a JobArgs,
    /// The options as they were written.
    pub(super) said: &'a Said,
    /// Where to look if there is no picture.
    pub(super) result: Option<PathBuf>,
}

/// What a command would do and leave out.
pub(super) struct Plan {
    pub(super) steps: Vec<Step>,
    /// Inputs that can't be used, known before any work.
    pub(super) failed: Vec<String>,
}

impl From<Vec<Step>> for Plan {
    fn from(steps: Vec<Step>) -> Self {
        Self { steps, failed: Vec::new() }
    }
}

/// Plans a job, for which nothing need be said of where results go, or runs it, and prints its report; `say` says the
/// figures in words.
pub(super) fn run<P: Into<Plan>, F: Serialize>(
    request: &Request<'_>,
    plan: impl FnOnce() -> anyhow::Result<P>,
    run: impl FnOnce(&Watch<'_>) -> anyhow::Result<Report<F>>,
    say: impl FnOnce(&Common, &Report<F>),
) -> anyhow::Result<Outcome> {
    let common = &request.job.common;
    let stop = common.start()?;
    if request.job.plan {
        return show(common, request.name, &plan()?.into());
    }
    let bar = common.progress(0, request.unit);
    let tick = |done: u64, all: Option<u64>| {
        bar.set_length(all.unwrap_or(done));
        bar.set_position(done);
    };
    let report = run(&Watch { said: request.said, stop: &stop, tick: &tick });
    bar.finish_and_clear();
    let report = report?;
    let outcome = outcome(&report.failed);
    common.warn(&report.warnings);
    common.note(&report.notes);
    common.print_json(&report)?;
    say(common, &report);
    if common.verbose {
        common.say_stages(&report.stages);
        report.left_out.iter().for_each(|what| common.say(&format!("left out: {what}")));
    }
    let look = report.pictures.first().or(request.result.as_ref());
    let look = look.map_or(String::new(), |look| format!("; look at {}", look.display()));
    common.say(&format!("{:.2} s{look}", report.wall_s));
    Ok(outcome)
}

/// A plan, as words or, with `--json`, as an object.
fn show(common: &Common, job: &str, plan: &Plan) -> anyhow::Result<Outcome> {
    if common.json {
        common.print_json(&json!({ "job": job, "plan": plan.steps, "failed": plan.failed }))?;
    } else {
        for step in &plan.steps {
            let fate = match step.fate {
                Fate::Run => "run",
                Fate::LeftOut => "left out",
            };
            print_line(&shown_lines(&format!("{:<34} {fate:<9} {}", step.stage, step.reason)));
        }
    }
    Ok(outcome(&plan.failed))
}

/// Names what failed: how the job ended.
fn outcome(failed: &[String]) -> Outcome {
    failed.iter().for_each(|what| eprintln!("failed: {}", shown_lines(what)));
    if failed.is_empty() { Outcome::Done } else { Outcome::SomeFailed }
}
