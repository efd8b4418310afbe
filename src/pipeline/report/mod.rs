//! What a run did, stage by stage: `OUT/report.html` for people, `OUT/run.json` for scripts.
//!
//! Of every stage: its tasks, its time and its share of the whole (of what stood: the time that it took when it was
//! made), the error where truth is known and the jobs' own uncertainty where it is not, what was left out and why,
//! failures and warnings. Both hold times, so they are no part of what is the same bytes in every run.

mod page;
#[cfg(test)]
mod tests;

use std::path::{Path, PathBuf};

use serde::Serialize;

use super::plan::Plan;
use super::run::{Outcome, RunReport, TaskFailure, TaskReport};
use crate::files::{Places, WriteError};
use crate::pipeline::store::{PAGE, REPORT};
use crate::pipeline::tasks::TaskId;
use crate::words::grouped;

/// A run, summed up.
#[derive(Debug, Clone, Serialize)]
pub struct RunSummary<'a> {
    /// The pipeline's name.
    pub pipeline: &'a str,
    /// What it is for.
    pub about: &'a str,
    /// How many tasks were done.
    pub done: usize,
    /// How many stood.
    pub kept: usize,
    /// How many failed.
    pub failed: usize,
    /// How many were not done because of others, or because the run was stopped.
    pub not_done: usize,
    /// How many another part does.
    pub elsewhere: usize,
    /// It was stopped from outside.
    pub stopped: bool,
    /// How long it took, seconds.
    pub wall_s: f64,
    /// Threads that it worked with.
    pub threads: usize,
    /// Every stage, in the plan's order.
    pub stages: Vec<StageSummary>,
    /// What failed, and what was not done because of it.
    pub failures: &'a [TaskFailure],
    /// What a user should know.
    pub warnings: Vec<String>,
    /// Tasks that an earlier pipeline had and this one has not; their results were left.
    pub strays: &'a [TaskId],
    /// Every task.
    pub tasks: Vec<TaskSummary<'a>>,
}

/// A stage of a run.
#[derive(Debug, Clone, Default, Serialize)]
pub struct StageSummary {
    /// Its name.
    pub stage: String,
    /// Its job.
    pub job: String,
    /// How many of its tasks were done.
    pub done: usize,
    /// How many stood.
    pub kept: usize,
    /// How many failed or were not done.
    pub failed: usize,
    /// Time of all its tasks that stand, seconds, as it was when they were done.
    pub task_s: f64,
    /// Of the time of all stages, from 0 to 1.
    pub share: f64,
    /// How good its results are.
    pub quality: Vec<QualitySummary>,
    /// What was left out, and how often.
    pub left_out: Vec<Count>,
    /// What its jobs warn of, and how often.
    pub warnings: Vec<Count>,
    /// What of its inputs gave nothing, and how often.
    pub failed_inputs: Vec<Count>,
}

/// Something said, and how often.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Count {
    /// What.
    pub what: String,
    /// How often.
    pub count: usize,
}

/// How good results are, over a stage's tasks.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct QualitySummary {
    /// What is wrong by so much.
    pub what: String,
    /// The unit, and what figure it is.
    pub unit: String,
    /// Against what is true, or as the job itself states it.
    pub against_truth: bool,
    /// Of how many tasks.
    pub tasks: usize,
    /// The least of them.
    pub least: f64,
    /// The middle one of them.
    pub median: f64,
    /// The greatest of them.
    pub greatest: f64,
}

/// A task of a run, without its job's own report.
#[derive(Debug, Clone, Serialize)]
pub struct TaskSummary<'a> {
    /// Its name.
    pub task: &'a str,
    /// Its stage.
    pub stage: &'a str,
    /// Whose it is.
    pub keys: &'a crate::job::Keys,
    /// How it went.
    #[serde(flatten)]
    pub outcome: &'a Outcome,
    /// Why it was not kept.
    pub why: Option<&'a str>,
    /// How long it took, seconds.
    pub wall_s: Option<f64>,
    /// Its files.
    pub files: Vec<&'a str>,
    /// Its inputs that failed, without which it was done.
    pub without: &'a [String],
}

/// Sums a run up.
#[must_use]
pub fn summary<'a>(plan: &'a Plan, report: &'a RunReport) -> RunSummary<'a> {
    let mut stages: Vec<StageSummary> = plan.stages.iter().map(|stage| stage_summary(stage, report)).collect();
    let all: f64 = stages.iter().map(|stage| stage.task_s).sum();
    for stage in &mut stages {
        stage.share = if all > 0.0 { stage.task_s / all } else { 0.0 };
    }
    RunSummary {
        pipeline: &plan.name,
        about: &plan.about,
        done: report.done,
        kept: report.kept,
        failed: report.failed,
        not_done: report.not_done,
        elsewhere: report.elsewhere,
        stopped: report.stopped,
        wall_s: report.wall_s,
        threads: report.threads,
        stages,
        failures: &report.failures,
        warnings: plan.warnings.iter().chain(&report.warnings).cloned().collect(),
        strays: &report.strays,
        tasks: report.tasks.iter().map(task_summary).collect(),
    }
}

fn task_summary(task: &TaskReport) -> TaskSummary<'_> {
    TaskSummary {
        task: &task.task,
        stage: &task.stage,
        keys: &task.keys,
        outcome: &task.outcome,
        why: task.why.as_deref(),
        wall_s: task.wall_s,
        files: task.outputs.iter().map(|output| output.name.as_str()).collect(),
        without: &task.without,
    }
}

fn stage_summary(stage: &super::plan::Laid, report: &RunReport) -> StageSummary {
    let mut summary = StageSummary { stage: stage.name.clone(), job: stage.job.to_owned(), ..StageSummary::default() };
    let mut quality = Vec::new();
    for missing in &stage.left_out {
        count(&mut summary.left_out, &missing.reason, missing.count);
    }
    for task in stage.tasks.iter().filter_map(|&at| report.tasks.get(at)) {
        match &task.outcome {
            Outcome::Done => summary.done += 1,
            Outcome::Kept => summary.kept += 1,
            Outcome::Failed(_) | Outcome::NotDone(_) => summary.failed += 1,
            Outcome::Elsewhere => continue,
        }
        if matches!(task.outcome, Outcome::Done | Outcome::Kept) {
            summary.task_s += task.wall_s.unwrap_or(0.0);
        }
        let Some(made) = &task.made else { continue };
        made.left_out.iter().for_each(|what| count(&mut summary.left_out, what, 1));
        made.warnings.iter().for_each(|what| count(&mut summary.warnings, what, 1));
        made.failed.iter().chain(&task.without).for_each(|what| count(&mut summary.failed_inputs, what, 1));
        let known = made.quality.iter().filter(|one| one.value.is_finite());
        quality.extend(known.map(|one| ((&one.what, &one.unit, one.against_truth), one.value)));
    }
    summary.quality = grouped(quality).into_iter().map(over_tasks).collect();
    summary
}

fn over_tasks(((what, unit, against_truth), mut values): ((&String, &String, bool), Vec<f64>)) -> QualitySummary {
    values.sort_by(f64::total_cmp);
    QualitySummary {
        what: what.clone(),
        unit: unit.clone(),
        against_truth,
        tasks: values.len(),
        least: values[0],
        median: (values[(values.len() - 1) / 2] + values[values.len() / 2]) / 2.0,
        greatest: values[values.len() - 1],
    }
}

fn count(counts: &mut Vec<Count>, what: &str, more: usize) {
    match counts.iter_mut().find(|known| known.what == what) {
        Some(known) => known.count += more,
        None => counts.push(Count { what: what.to_owned(), count: more }),
    }
}

/// Writes `report.html` and `run.json` into the folder of results; returns where the page is.
///
/// # Errors
/// Where one of them can't be written.
pub fn write_reports(plan: &Plan, report: &RunReport, out: &Path) -> Result<PathBuf, WriteError> {
    let summary = summary(plan, report);
    let page = out.join(PAGE);
    let json = out.join(REPORT);
    let refused = |why: serde_json::Error| WriteError::File { path: json.clone(), why: why.to_string() };
    let mut places = Places::default();
    places.write(&page, &page::page(&summary))?;
    places.write(&json, &serde_json::to_string_pretty(&summary).map_err(refused)?)?;
    places.commit()?;
    Ok(page)
}
