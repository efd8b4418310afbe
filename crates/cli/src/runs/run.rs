//! `lunula run`: a pipeline file, as far as its wanted results need it.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use anyhow::Context;
use clap::Args;
use lunula::pipeline::{
    Event, Outcome as Ended, Plan, Progress, RunOptions, RunReport, RunWatch, Shard, Spec, Standing, plan_text,
    run as run_tasks, summary, survey, write_reports,
};
use lunula::words::{shown, shown_lines};
use serde_json::json;

use crate::runs::{generated, kinds, memory};
use crate::{Common, Outcome, Stopped, print_line};

/// Run a pipeline file: make the results it asks for, only what they need, and nothing that is up to date
///
/// A pipeline file (TOML) names inputs (files by a pattern, or rows of a table), stages (jobs with their options) and
/// the results wanted. A stage runs only where a wanted result needs it and its inputs have what it works on; --plan
/// says why, or why not. Each result is kept with a hash of its inputs' contents, options and version: what is up to
/// date is not made again, what changed is, and an interrupted run goes on. A failing input fails what needs it; all
/// else is done, and a table at the end says what failed. Results: OUT/<stage>/<keys>/.., OUT/report.html (time, share
/// and error of every stage) and OUT/run.json.
#[derive(Debug, Args)]
pub(crate) struct RunArgs {
    /// The pipeline file (TOML); `lunula init` writes one for the current folder
    #[arg(value_name = "PIPELINE.toml")]
    pipeline: PathBuf,
    /// The results folder, created if it is missing
    #[arg(long, value_name = "DIR", required_unless_present = "plan")]
    out: Option<PathBuf>,
    /// Show what would run, what is up to date and what is left out, and why; do nothing
    #[arg(long)]
    plan: bool,
    /// Memory that tasks may take together, as 4GB or 500MB [default: three quarters of what is free]
    #[arg(long, value_name = "SIZE", value_parser = memory::parse)]
    memory: Option<u64>,
    /// Only part I of N, from 1/N to N/N, each into its own folder; `lunula merge` brings them together
    #[arg(long, value_name = "I/N", conflicts_with = "plan")]
    shard: Option<Shard>,
    #[command(flatten)]
    common: Common,
}

pub(crate) fn run(args: &RunArgs) -> anyhow::Result<Outcome> {
    let spec = Spec::read(&args.pipeline, &kinds())?;
    let generated = generated(&spec)?;
    // A plan needs no folder; without one nothing is there yet.
    let plan = Plan::new(&spec, args.out.as_deref().unwrap_or(Path::new("OUT")), generated.as_ref())?;
    if args.plan {
        return show(args, &plan);
    }
    let out = args.out.as_deref().context("--out is needed")?;
    let stop = args.common.start()?;
    args.common.warn(&plan.warnings);
    let options = RunOptions {
        threads: args.common.threads.map_or_else(memory::threads, usize::from),
        memory: args.memory.unwrap_or_else(memory::free),
        shard: args.shard,
        pipeline: spec.mark(),
    };
    let report = watched(&args.common, &stop, plan.tasks.len(), |watch| run_tasks(&plan.tasks, out, &options, watch))?;
    finish(&args.common, &plan, &report, out)
}

/// Runs tasks with a bar on a terminal, and with `--verbose` a line each.
pub(crate) fn watched<E>(
    common: &Common,
    stop: &AtomicBool,
    tasks: usize,
    run: impl FnOnce(&RunWatch) -> Result<RunReport, E>,
) -> Result<RunReport, E> {
    let bar = common.progress(tasks, "tasks");
    let tick = |progress: Progress| {
        bar.set_length(progress.of as u64);
        bar.set_position(progress.settled as u64);
        if let (true, Event::Settled(task, Ended::Done | Ended::Failed(_))) = (common.verbose, progress.event) {
            bar.suspend(|| common.say(&task.id));
        }
    };
    let report = run(&RunWatch { stop, tick: &tick });
    bar.finish_and_clear();
    report
}

fn show(args: &RunArgs, plan: &Plan) -> anyhow::Result<Outcome> {
    let standing: Vec<Standing> = match &args.out {
        Some(out) => survey(&plan.tasks, out)?,
        None => Vec::new(),
    };
    let stages = plan.stage_plans(&standing);
    let (run, done) = stages.iter().fold((0, 0), |(run, done), stage| (run + stage.run, done + stage.done));
    if args.common.json {
        args.common.print_json(&json!({
            "job": "run",
            "pipeline": plan.name,
            "about": plan.about,
            "run": run,
            "done": done,
            "parts": plan.parts(),
            "stages": stages,
            "warnings": plan.warnings,
            "failed": [],
        }))?;
        return Ok(Outcome::Done);
    }
    args.common.warn(&plan.warnings);
    print_line(plan_text(&stages).trim_end());
    print_line(&format!("{run} task(s) to run, {done} stand"));
    Ok(Outcome::Done)
}

/// How a run ended: reports, failures, a last line.
pub(crate) fn finish(common: &Common, plan: &Plan, report: &RunReport, out: &Path) -> anyhow::Result<Outcome> {
    let page = write_reports(plan, report, out);
    common.warn(&report.warnings);
    if !report.strays.is_empty() && !common.quiet {
        let (count, first) = (report.strays.len(), &report.strays[0]);
        eprintln!(
            "note: {count} result(s) that this pipeline does not make (any more) stand in {} and were left: {first}{}",
            out.display(),
            if count > 1 { ", .." } else { "" }
        );
    }
    failures(report);
    if common.json {
        common.print_json(&summary(plan, report))?;
    }
    let page = page.context("what was done is in its place, but not the report of it")?;
    let elsewhere = if report.elsewhere > 0 { format!(", {} in other parts", report.elsewhere) } else { String::new() };
    let inputs = match report.failed_inputs().count() {
        0 => String::new(),
        count => format!(", {count} input(s) gave nothing"),
    };
    let warned: usize = report.tasks.iter().filter_map(|task| task.made.as_ref()).map(|made| made.warnings.len()).sum();
    let warned = if warned > 0 { format!(" ({warned} warning(s) there)") } else { String::new() };
    common.say(&format!(
        "{} done, {} up to date, {} failed, {} not done{inputs}{elsewhere}; {:.2} s; look at {}{warned}",
        report.done,
        report.kept,
        report.failed,
        report.not_done,
        report.wall_s,
        page.display()
    ));
    if report.stopped {
        return Err(Stopped.into());
    }
    Ok(if report.is_whole() && inputs.is_empty() { Outcome::Done } else { Outcome::SomeFailed })
}

/// What failed, a row each: task, why; then the inputs that gave nothing in tasks that were done without them.
fn failures(report: &RunReport) {
    let tasks = report.failures.iter().map(|failure| (&failure.task, failure.what.as_str()));
    let rows: Vec<_> = tasks.chain(report.failed_inputs()).collect();
    let width = rows.iter().map(|(task, _)| task.chars().count()).max().unwrap_or(0).min(60);
    for (task, what) in rows {
        // Of several lines the further ones stand under the first.
        let what = shown_lines(what).replace('\n', &format!("\n{:1$}", "", width + 10));
        eprintln!("failed: {:<width$}  {what}", shown(task));
    }
}
