//! What a run did, task by task.

use serde::{Deserialize, Serialize};

use crate::job::{Keys, Made};
use crate::pipeline::store::record::Output;
use crate::pipeline::tasks::TaskId;

/// How it went with a task.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "outcome", content = "what")]
pub enum Outcome {
    /// It was done.
    Done,
    /// Its results stood.
    Kept,
    /// There is no result; why.
    Failed(String),
    /// It was not begun, or not ended; why.
    NotDone(String),
    /// Another part of the run does it.
    Elsewhere,
}

/// One task.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct TaskReport {
    /// Its name.
    pub task: TaskId,
    /// The stage of the pipeline file.
    pub stage: String,
    /// Whose it is.
    pub keys: Keys,
    /// How it went.
    #[serde(flatten)]
    pub outcome: Outcome,
    /// Why it was not kept, in a few words.
    pub why: Option<String>,
    /// How long it took, seconds: now, or when it was done where it was kept.
    pub wall_s: Option<f64>,
    /// What the job reports of it.
    pub made: Option<Made>,
    /// Its files.
    pub outputs: Vec<Output>,
    /// Its inputs that failed, without which it was done.
    pub without: Vec<String>,
}

/// A task without result.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct TaskFailure {
    /// Which.
    pub task: TaskId,
    /// Why: its own words, or what it needs that failed.
    pub what: String,
}

/// Why a task was not done that the run did not come to.
pub(super) const STOPPED: &str = "the run was stopped";

/// What a run did.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct RunReport {
    /// Every task, in the order of the list.
    pub tasks: Vec<TaskReport>,
    /// How many were done.
    pub done: usize,
    /// How many stood.
    pub kept: usize,
    /// How many failed.
    pub failed: usize,
    /// How many were not done because of others, or because the run was stopped.
    pub not_done: usize,
    /// How many another part does.
    pub elsewhere: usize,
    /// What failed, and what was not done because of it, in the order of the list; not what a stopped run did not come
    /// to.
    pub failures: Vec<TaskFailure>,
    /// What a user should know, besides what jobs tell.
    pub warnings: Vec<String>,
    /// Tasks that a pipeline of before had and this one has not; their results were left.
    pub strays: Vec<TaskId>,
    /// It was stopped from outside.
    pub stopped: bool,
    /// How long it took, seconds.
    pub wall_s: f64,
    /// Threads that it worked with.
    pub threads: usize,
}

impl RunReport {
    /// Whether all that was asked for stands.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        self.failed == 0 && self.not_done == 0
    }

    /// Inputs that gave nothing in tasks that were done or stand, with the task and why.
    pub fn failed_inputs(&self) -> impl Iterator<Item = (&TaskId, &str)> {
        let stands = |task: &&TaskReport| matches!(task.outcome, Outcome::Done | Outcome::Kept);
        self.tasks.iter().filter(stands).flat_map(|task| {
            let failed = task.made.iter().flat_map(|made| &made.failed);
            failed.map(move |what| (&task.task, what.as_str()))
        })
    }

    pub(super) fn count(&mut self) {
        for task in &self.tasks {
            match &task.outcome {
                Outcome::Done => self.done += 1,
                Outcome::Kept => self.kept += 1,
                Outcome::Failed(_) => self.failed += 1,
                Outcome::NotDone(_) => self.not_done += 1,
                Outcome::Elsewhere => self.elsewhere += 1,
            }
            if let Outcome::Failed(what) | Outcome::NotDone(what) = &task.outcome
                && what != STOPPED
            {
                self.failures.push(TaskFailure { task: task.task.clone(), what: what.clone() });
            }
        }
    }
}
