//! What a pipeline hands to a job, and what it keeps of the job's report.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use serde::{Deserialize, Serialize};

use super::{Job, Keys, Report, Said, Watch};
use crate::stages::{Stage, Stages};

/// An input where it exists.
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
    /// What this task made before from other inputs, if that still exists: for jobs that go on from there.
    pub before: Option<&'a Path>,
    /// Threads that it may have to itself; the bytes do not depend on their number.
    pub threads: usize,
    /// Becomes true when it is to stop.
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

    /// The file of a role that has to be there.
    ///
    /// # Errors
    /// It is not.
    pub fn needed(&self, role: &str) -> anyhow::Result<&At> {
        self.one(role).ok_or_else(|| anyhow::anyhow!("no `{role}` is given"))
    }

    /// Runs `work` on the task's own threads, watched by the pipeline.
    ///
    /// # Errors
    /// The job's, or that the system has no threads left.
    pub fn run<T: Send, E>(
        &self,
        said: &Said,
        work: impl FnOnce(&Watch<'_>) -> Result<T, E> + Send,
    ) -> anyhow::Result<T>
    where
        E: Into<anyhow::Error> + Send,
    {
        let watch = Watch { said, stop: self.stop, tick: &|_, _| {} };
        if self.threads == rayon::current_num_threads() {
            return work(&watch).map_err(Into::into);
        }
        let pool = rayon::ThreadPoolBuilder::new().num_threads(self.threads.max(1)).build()?;
        pool.install(|| work(&watch)).map_err(Into::into)
    }

    /// Reports the figures of a job whose work is one stage.
    ///
    /// # Errors
    /// As [`Work::run`].
    pub fn report<J: Job, F: Serialize + Send>(
        &self,
        said: &Said,
        stage: &'static str,
        figures: impl FnOnce() -> anyhow::Result<F> + Send,
    ) -> anyhow::Result<Report<F>> {
        let stages = Stages::default();
        self.run(said, |watch| -> anyhow::Result<_> {
            let figures = stages.time(stage, figures)?;
            Ok(Report::new(J::KIND.name, watch, figures).timed(&stages))
        })
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
    /// Against ground truth (a phantom's, or what was measured), or as the job itself states it.
    pub against_truth: bool,
}

impl Quality {
    /// As the job itself states it.
    #[must_use]
    pub fn stated(what: &str, value: f64, unit: &str) -> Self {
        Self { what: what.to_owned(), value, unit: unit.to_owned(), against_truth: false }
    }
}

/// What a pipeline keeps of a job's report.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Made {
    /// The job's own report, as its `--json` prints it.
    pub report: serde_json::Value,
    /// What the input did not need, and why.
    pub left_out: Vec<String>,
    /// What a person has to know before using the results.
    pub warnings: Vec<String>,
    /// What was chosen, guessed or counted on the way, and needs no action.
    #[serde(default)]
    pub notes: Vec<String>,
    /// What of its inputs gave nothing, where the rest was done.
    pub failed: Vec<String>,
    /// Time by stage within the job.
    pub stages: Vec<Stage>,
    /// How good it is.
    pub quality: Vec<Quality>,
}
