//! One thing to be made: a job on its inputs, with its options, and the files that it promises.
//!
//! The planner makes tasks from a pipeline file; the runner makes of them what does not stand yet. A runner knows no
//! job, and a job knows neither pipeline nor store: between them stand [`Work`] and [`Made`].

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use serde::{Deserialize, Serialize};

use super::keys::Keys;
use crate::stages::Stage;

/// A task's name: the stage's, then the values of its keys, as `angles/S01/bending`. Unlike any other's, and no other's
/// beginning up to a `/`:
/// it is also the folder, under the folder of results, that holds what the task makes and nothing else.
pub type TaskId = String;

/// Where an input comes from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Source {
    /// A file (or a folder, all that is in it) of the user's.
    Given {
        /// Where it stands.
        path: PathBuf,
        /// As the pipeline file names it, with `/`: the same from whatever folder the pipeline is run, for results may
        /// hold it.
        name: String,
    },
    /// A result.
    Result {
        /// Which task makes it.
        task: TaskId,
        /// Its name in the task's folder, with `/`; empty: the whole folder.
        name: String,
    },
}

/// What a job works on.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Input {
    /// What it is to the job: `video`, `markers`, `log`.
    pub role: &'static str,
    /// Whose it is.
    pub keys: Keys,
    /// Where it comes from.
    pub source: Source,
    /// The task is done without it where it failed.
    pub may_fail: bool,
}

/// Who makes it where a run is cut into parts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Share {
    /// One part; tasks of the same number go together, which part is number modulo parts.
    Part(usize),
    /// Every part for itself: cheap, and others stand on it.
    Each,
    /// None: it gathers what the parts made, and is made when they are merged.
    Whole,
}

/// One thing to be made.
#[derive(Clone)]
pub struct Task {
    /// Its name.
    pub id: TaskId,
    /// The stage of the pipeline file.
    pub stage: String,
    /// Whose it is.
    pub keys: Keys,
    /// What it works on.
    pub inputs: Vec<Input>,
    /// All that its result hangs on besides the inputs' contents: the job's name, its version and its options, as they
    /// change bytes.
    pub options: serde_json::Value,
    /// Who makes it in a run cut into parts.
    pub share: Share,
    /// About how much memory it takes, bytes.
    pub memory: u64,
    /// About how long it takes on one thread, seconds: long ones begin first.
    pub cost_s: f64,
    /// Does it.
    pub job: Arc<dyn Job>,
}

/// An input where it stands.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct At {
    /// What it is to the job.
    pub role: &'static str,
    /// Whose it is.
    pub keys: Keys,
    /// The file or folder.
    pub path: PathBuf,
    /// What results may call it: as the pipeline file names it, or `<task>/<name>`; the same in whatever folder results
    /// go to.
    pub name: String,
}

/// What a job is given to do.
pub struct Work<'a> {
    /// Its inputs in the task's order, without those that failed and may.
    pub inputs: Vec<At>,
    /// An empty folder for what it makes; what is in it when the job returns are its results, under the same names.
    pub folder: &'a Path,
    /// What this task made before from other inputs, if it stands: for jobs that go on from there.
    pub before: Option<&'a Path>,
    /// Threads that it may have to itself; the bytes don't hang on it.
    pub threads: usize,
    /// Becomes true where it is to stop.
    pub stop: &'a AtomicBool,
}

impl Work<'_> {
    /// The inputs of a role.
    pub fn of<'w>(&'w self, role: &'w str) -> impl Iterator<Item = &'w At> {
        self.inputs.iter().filter(move |input| input.role == role)
    }

    /// The only input of a role, if there is one.
    #[must_use]
    pub fn one(&self, role: &str) -> Option<&At> {
        self.inputs.iter().find(|input| input.role == role)
    }
}

/// How good a result is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Quality {
    /// What is wrong by so much: `J2`, `Fz_N`, `mean map`.
    pub what: String,
    /// By how much.
    pub value: f64,
    /// Its unit, and what figure it is: `degrees RMS`.
    pub unit: String,
    /// Against what is true (a phantom's truth, what was measured), or as the job itself states it.
    pub against_truth: bool,
}

/// What a job tells of what it made.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Made {
    /// The job's own report, as its `--json` prints it.
    pub report: serde_json::Value,
    /// What of it the scene did not need, and why.
    pub left_out: Vec<String>,
    /// What a user should know.
    pub warnings: Vec<String>,
    /// What of its inputs gave nothing, where the rest was done.
    pub failed: Vec<String>,
    /// Time by stage within the job.
    pub stages: Vec<Stage>,
    /// How good it is.
    pub quality: Vec<Quality>,
}

/// Does a task. It holds its checked options; [`Task::options`] are the same for the hash.
pub trait Job: Send + Sync {
    /// Makes the results in `work.folder`.
    ///
    /// # Errors
    /// Where there is no result; the words name file and place, and say what to do.
    fn run(&self, work: &Work) -> anyhow::Result<Made>;
}
