//! A plan as users see it: every stage as run, done or left out, with counts and reasons, and below it the steps of its
//! job.
//!
//! Steps that say the same of several tasks are one line. Nothing is written, and no picture is decoded: jobs tell
//! their steps from what they are given and from files' headers.

use std::fmt::Write;

use serde::Serialize;

use super::Plan;
use crate::job::{Facts, Foreseen};
use crate::pipeline::spec::said::in_keys;
use crate::pipeline::store::standing::{Standing, Why};
use crate::stages::Fate;
use crate::words::grouped;

/// How many reasons of one kind stand in a plan that people read.
const SHOWN: usize = 3;

/// What becomes of a stage, or of a step of its job.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum PlanFate {
    /// It will run.
    Run,
    /// Its results stand.
    Done,
    /// It is not needed, or there is nothing for it.
    LeftOut,
}

/// Something of a stage, and why.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct PlanLine {
    /// The step of the job; empty: the stage's tasks themselves.
    pub step: String,
    /// What becomes of it.
    pub fate: PlanFate,
    /// For how many tasks; of what is left out before there are tasks, how many items.
    pub count: usize,
    /// On what, or why not.
    pub reason: String,
}

/// A stage of a plan.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct StagePlan {
    /// Its name.
    pub stage: String,
    /// Its job.
    pub job: String,
    /// The line of the pipeline file.
    pub line: usize,
    /// Whether its results are wanted, not only needed.
    pub wanted: bool,
    /// How many tasks are to run.
    pub run: usize,
    /// How many stand.
    pub done: usize,
    /// Its tasks, and what has none.
    pub tasks: Vec<PlanLine>,
    /// The steps of its job.
    pub steps: Vec<PlanLine>,
    /// Files that could not be looked at for the steps.
    pub cannot_tell: Vec<String>,
}

impl Plan {
    /// Every stage with its steps; `standing` says of each task whether it is up to date.
    #[must_use]
    pub fn stage_plans(&self, standing: &[Standing]) -> Vec<StagePlan> {
        let facts = self.facts();
        self.stages
            .iter()
            .map(|stage| {
                let mut plan = StagePlan {
                    stage: stage.name.clone(),
                    job: stage.job.to_owned(),
                    line: stage.line,
                    wanted: stage.wanted,
                    run: 0,
                    done: 0,
                    tasks: Vec::new(),
                    steps: Vec::new(),
                    cannot_tell: Vec::new(),
                };
                for &at in &stage.tasks {
                    let fate = match standing.get(at) {
                        Some(Standing::Done) => {
                            plan.done += 1;
                            add(&mut plan.tasks, "", PlanFate::Done, "its results stand".to_owned(), 1);
                            PlanFate::Done
                        }
                        other => {
                            plan.run += 1;
                            let why = match other {
                                Some(Standing::Run(why)) => said(why),
                                _ => "never made".to_owned(),
                            };
                            add(&mut plan.tasks, "", PlanFate::Run, why, 1);
                            PlanFate::Run
                        }
                    };
                    self.steps_of(at, fate, &facts, &mut plan);
                }
                for missing in &stage.left_out {
                    add(&mut plan.tasks, "", PlanFate::LeftOut, missing.reason.clone(), missing.count);
                }
                plan.tasks.sort_by_key(|line| line.fate);
                plan
            })
            .collect()
    }

    fn steps_of(&self, at: usize, fate: PlanFate, facts: &[Facts], plan: &mut StagePlan) {
        let planned = &self.planned[at];
        let Some(prepared) = &planned.prepared else { return };
        if let Some(lacks) = &planned.lacks {
            plan.cannot_tell.push(format!("{}: {lacks} does not stand", self.tasks[at].id));
            return;
        }
        match prepared.steps(&known(&planned.inputs, facts), &planned.demand) {
            Ok(steps) => {
                for step in steps {
                    let fate = if step.fate == Fate::LeftOut { PlanFate::LeftOut } else { fate };
                    add(&mut plan.steps, step.stage, fate, in_keys(&step.reason), 1);
                }
            }
            Err(why) => plan.cannot_tell.push(format!("{}: {}", self.tasks[at].id, in_keys(&why))),
        }
    }

    /// What will be known of every task's results.
    fn facts(&self) -> Vec<Facts> {
        let mut facts: Vec<Facts> = Vec::with_capacity(self.planned.len());
        for planned in &self.planned {
            let of_task = match &planned.prepared {
                // A file that is not there can't be looked at.
                Some(prepared) if planned.lacks.is_none() => {
                    prepared.facts(&known(&planned.inputs, &facts), &planned.demand)
                }
                _ => Facts::default(),
            };
            facts.push(of_task);
        }
        facts
    }
}

/// Inputs with what is known of them by now; of generated recordings it is known from the beginning.
fn known(inputs: &[(Foreseen, Option<usize>)], facts: &[Facts]) -> Vec<Foreseen> {
    let shown = |(input, task): &(Foreseen, Option<usize>)| {
        let facts = task.and_then(|task| facts.get(task)).copied().unwrap_or_default();
        let facts = if input.facts == Facts::default() { facts } else { input.facts };
        Foreseen { facts, ..input.clone() }
    };
    inputs.iter().map(shown).collect()
}

/// Why a task does not stand, without names that differ from task to task.
fn said(why: &Why) -> String {
    match why {
        Why::Follows(_) => "what it works on is made again".to_owned(),
        Why::InputChanged(_) => "an input changed".to_owned(),
        Why::InputAdded(_) => "an input is new".to_owned(),
        Why::InputGone(_) => "an input is gone".to_owned(),
        Why::InputMissing(_) => "an input is not there: it will fail".to_owned(),
        Why::Edited(_) => "a result was edited by hand".to_owned(),
        Why::Deleted(_) => "a result was deleted".to_owned(),
        other => other.to_string(),
    }
}

fn add(lines: &mut Vec<PlanLine>, step: &str, fate: PlanFate, reason: String, count: usize) {
    match lines.iter_mut().find(|line| line.step == step && line.fate == fate && line.reason == reason) {
        Some(line) => line.count += count,
        None => {
            // Steps stay together, in the order of the first task that has them.
            let at = lines.iter().rposition(|line| line.step == step).map_or(lines.len(), |at| at + 1);
            lines.insert(at, PlanLine { step: step.to_owned(), fate, count, reason });
        }
    }
}

/// A plan in words, a line for each stage and step: name, fate, count and reason.
#[must_use]
pub fn plan_text(stages: &[StagePlan]) -> String {
    let mut text = String::new();
    let width =
        stages.iter().flat_map(|s| s.steps.iter().map(|l| l.step.chars().count() + 2).chain([head(s).chars().count()]));
    let width = width.max().unwrap_or(0).clamp(20, 40);
    for stage in stages {
        let mut name = head(stage);
        for line in &stage.tasks {
            let count = match line.count {
                0 => String::new(),
                1 => "1: ".to_owned(),
                count => format!("{count}: "),
            };
            let _ = writeln!(text, "{name:<width$}  {:<9} {count}{}", fate_said(line.fate), line.reason);
            name.clear();
        }
        for ((step, fate), of) in grouped(stage.steps.iter().map(|line| ((line.step.as_str(), line.fate), line))) {
            let tasks: usize = of.iter().map(|line| line.count).sum();
            let reasons = if of.len() == 1 {
                of[0].reason.clone()
            } else {
                let shown: Vec<String> =
                    of.iter().take(SHOWN).map(|line| format!("{} ({})", line.reason, line.count)).collect();
                let more = of.len().saturating_sub(SHOWN);
                let more = if more > 0 { format!("; {more} more") } else { String::new() };
                format!("{}{more}", shown.join("; "))
            };
            let many = if stage.run + stage.done > 1 { format!("{tasks}: ") } else { String::new() };
            let indented = format!("  {step}");
            let _ = writeln!(text, "{indented:<width$}  {:<9} {many}{reasons}", fate_said(fate));
        }
        for what in stage.cannot_tell.iter().take(SHOWN) {
            let _ = writeln!(text, "  cannot be known beforehand of {what}");
        }
        if stage.cannot_tell.len() > SHOWN {
            let _ = writeln!(text, "  and of {} more", stage.cannot_tell.len() - SHOWN);
        }
    }
    text
}

fn head(stage: &StagePlan) -> String {
    if stage.stage == stage.job { stage.stage.clone() } else { format!("{} ({})", stage.stage, stage.job) }
}

fn fate_said(fate: PlanFate) -> &'static str {
    match fate {
        PlanFate::Run => "run",
        PlanFate::Done => "done",
        PlanFate::LeftOut => "left out",
    }
}
