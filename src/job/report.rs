//! What a run did: the JSON beside its results, the object that `--json` prints, and a pipeline's record of a task.

use std::ops::{Deref, DerefMut};
use std::path::{Path, PathBuf};

use serde::de::IgnoredAny;
use serde::{Deserialize, Serialize};

use super::work::{Made, Quality};
use super::{Said, Watch};
use crate::files::{Places, WriteError, json_text};
use crate::stages::{Stage, Stages};

/// What a run did; `F` holds the figures of one kind of job.
#[derive(Debug, Clone, Serialize)]
pub struct Report<F> {
    /// The job's name.
    pub job: &'static str,
    /// The program's version.
    pub version: &'static str,
    /// The options as the caller wrote them, defaults included; empty where a program called.
    #[serde(skip_serializing_if = "Said::is_empty")]
    pub options: Said,
    /// The job's own figures.
    #[serde(flatten)]
    pub figures: F,
    /// What the input did not need, and why.
    pub left_out: Vec<String>,
    /// What a person has to know before using the results.
    pub warnings: Vec<String>,
    /// What was chosen, guessed or counted on the way, and needs no action.
    pub notes: Vec<String>,
    /// What of the input could not be used, each with what to do.
    pub failed: Vec<String>,
    /// The pictures to look at first.
    pub pictures: Vec<PathBuf>,
    /// Time by stage.
    pub stages: Vec<Stage>,
    /// Seconds from start to end, this report not counted.
    pub wall_s: f64,
}

/// What is asked of the report of an earlier run.
#[derive(Deserialize)]
struct Earlier {
    #[serde(default)]
    job: String,
    /// Of a run of a pipeline, which has no job's name.
    #[serde(default)]
    tasks: Option<IgnoredAny>,
    #[serde(default)]
    pictures: Vec<PathBuf>,
}

impl<F> Deref for Report<F> {
    type Target = F;

    fn deref(&self) -> &F {
        &self.figures
    }
}

impl<F> DerefMut for Report<F> {
    fn deref_mut(&mut self) -> &mut F {
        &mut self.figures
    }
}

impl<F: Serialize> Report<F> {
    /// A report of a job that has yet to end.
    #[must_use]
    pub fn new(job: &'static str, watch: &Watch<'_>, figures: F) -> Self {
        Self {
            job,
            version: env!("CARGO_PKG_VERSION"),
            options: watch.said.clone(),
            figures,
            left_out: Vec::new(),
            warnings: Vec::new(),
            notes: Vec::new(),
            failed: Vec::new(),
            pictures: Vec::new(),
            stages: Vec::new(),
            wall_s: 0.0,
        }
    }

    /// Notes which of the options `keys` were written though nothing here needs them, and why it doesn't.
    pub fn unused(&mut self, keys: &[&str], why: &str) {
        for key in keys {
            self.unused_input(key, self.options.was_written(key), why);
        }
    }

    /// .. of an input, which is no option: whether it was named is the caller's to say.
    pub fn unused_input(&mut self, key: &str, is_named: bool, why: &str) {
        if is_named {
            self.notes.push(format!("--{} is of no use here: {why}", key.replace('_', "-")));
        }
    }

    /// Adds the times.
    #[must_use]
    pub fn timed(mut self, stages: &Stages) -> Self {
        self.stages = stages.list();
        self.wall_s = stages.wall_s();
        self
    }

    /// The report as JSON text.
    ///
    /// # Panics
    /// Never: figures are plain data.
    #[must_use]
    pub fn text(&self) -> String {
        json_text(self)
    }

    /// Warns of another job's report in `at`, which this one's replaces, and of pictures that the run drew which was
    /// reported there, and this one doesn't.
    pub fn warn_of_earlier(&mut self, at: &Path) {
        let left = self.warn_of_another(at).map_or_else(Vec::new, |before| before.pictures).into_iter();
        // By name: a folder may be called otherwise than before.
        let is_drawn = |path: &PathBuf| self.pictures.iter().any(|own| own.file_name() == path.file_name());
        let left: Vec<PathBuf> = left.filter(|path| !is_drawn(path) && path.is_file()).collect();
        self.warn_of_left(&left);
    }

    /// Warns of another job's report in `at`, which this one's replaces.
    pub fn warn_of_replaced(&mut self, at: &Path) {
        self.warn_of_another(at);
    }

    fn warn_of_another(&mut self, at: &Path) -> Option<Earlier> {
        let before: Earlier = serde_json::from_slice(&std::fs::read(at).ok()?).ok()?;
        let job = if before.tasks.is_some() { "run" } else { &before.job };
        if !job.is_empty() && job != self.job {
            self.warnings.push(format!(
                "{}: the report of `lunula {job}` stood here, and is replaced by that of `lunula {}`; give each job a \
                 folder, or name, of its own",
                at.display(),
                self.job
            ));
        }
        Some(before)
    }

    /// Warns of results of an earlier run, which nobody should take for this one's.
    pub fn warn_of_left(&mut self, left: &[PathBuf]) {
        let Some(first) = left.first() else { return };
        let what = match left.len() - 1 {
            0 => " existed before and is not of this run".to_owned(),
            more => format!(" and {more} more existed before and are not of this run"),
        };
        self.warnings.push(format!("{}{what}", first.display()));
    }

    /// Writes the report to `at`, if it is to be written, and puts all results into their places.
    ///
    /// # Errors
    /// [`WriteError`]; then nothing has changed.
    pub fn commit(mut self, mut places: Places, at: Option<&Path>) -> Result<Self, WriteError> {
        if let Some(at) = at {
            self.warn_of_earlier(at);
            places.write(at, &self.text())?;
        }
        places.commit()?;
        Ok(self)
    }

    /// What a pipeline keeps of the run.
    ///
    /// # Panics
    /// Never: figures are plain data.
    #[must_use]
    pub fn made(self, quality: Vec<Quality>) -> Made {
        let report = serde_json::to_value(&self).expect("plain data with names as keys");
        let Self { left_out, warnings, notes, failed, stages, .. } = self;
        Made { report, left_out, warnings, notes, failed, stages, quality }
    }
}
