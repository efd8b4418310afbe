//! One thing to be made: a job on its inputs, with its options, and the files that it promises.
//!
//! The planner makes tasks from a pipeline file; the runner makes of them what does not exist yet. A runner knows no
//! job, and a job knows neither pipeline nor store: they meet in `job::Work` and `job::Made`.

pub(super) mod graph;

use std::path::PathBuf;
use std::sync::Arc;

use crate::job::{Keys, Maker};

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
    /// All that its result depends on besides the inputs' contents: the job's name, version and options, as they
    /// change bytes.
    pub options: serde_json::Value,
    /// Who makes it in a run cut into parts.
    pub share: Share,
    /// About how much memory it takes, bytes.
    pub memory: u64,
    /// About how long it takes on one thread, seconds: long ones begin first.
    pub cost_s: f64,
    /// Does it.
    pub job: Arc<dyn Maker>,
}
