//! The kinds of jobs as pipeline files know them: what each takes, what it makes, what it needs of the stages before
//! it.
//!
//! The planner knows jobs only through [`Kind`] and [`Prepared`]; the runner only through [`Job`].

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::keys::Keys;
use super::task::Job;
use crate::stages::Step;

/// How many files a role takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Takes {
    /// One; it is what the task is made for.
    One,
    /// One or none.
    Optional,
    /// One or more: the task gathers them.
    Many,
    /// Any number.
    AnyNumber,
}

/// Something that a job works on.
#[derive(Debug, Clone, Copy)]
pub struct Role {
    /// Its key in the pipeline file: `video`.
    pub name: &'static str,
    /// How many.
    pub takes: Takes,
    /// What it is, in a few words.
    pub about: &'static str,
}

/// Something that a job makes and others may name.
#[derive(Debug, Clone, Copy)]
pub struct Part {
    /// Its name after the stage's: `tracks` of `angles.tracks`. A kind's first part is what the stage's bare name
    /// means.
    pub name: &'static str,
    /// The file in the task's folder; empty: the whole folder.
    pub file: &'static str,
    /// Made only where it is wanted or another stage works on it.
    pub only_if_wanted: bool,
    /// What it is, in a few words.
    pub about: &'static str,
}

/// A kind of job.
pub struct Kind {
    /// Its name in pipeline files: `posture`.
    pub name: &'static str,
    /// What it does, in a few words.
    pub about: &'static str,
    /// What it works on.
    pub roles: &'static [Role],
    /// What it makes.
    pub parts: &'static [Part],
    /// Counted up where the same inputs and options give other bytes than before.
    pub revision: u32,
    /// Its keys in pipeline files besides the roles, `job`, `each` and `where`.
    pub keys: &'static [&'static str],
    /// Checks a stage's keys (without roles, `job`, `each`, `where`).
    pub prepare: fn(toml::Table) -> Result<Arc<dyn Prepared>, KeyFault>,
}

/// What is wrong with a key of a stage; the planner knows its line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct KeyFault {
    /// The key; empty: the stage as a whole.
    pub key: String,
    /// What is wrong and what to write.
    pub what: String,
}

/// What later stages and the wanted results need of a task.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Demand {
    /// The parts, by name.
    pub parts: BTreeSet<&'static str>,
    /// The joints; `None`: all there are.
    pub joints: Option<BTreeSet<String>>,
    /// The time of the clock in the picture.
    pub clock: bool,
}

/// What is known of a scene without opening it; `None`: not known.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Facts {
    /// A photograph without colours.
    pub grey: Option<bool>,
    /// Somebody drew the nail's outline.
    pub outlined: Option<bool>,
    /// The lens bends lines.
    pub distorted: Option<bool>,
    /// A clock is in the picture.
    pub clock: Option<bool>,
    /// The log's LED goes on and off.
    pub led: Option<bool>,
    /// The log holds forces.
    pub forces: Option<bool>,
}

/// An input as the planner sees it.
#[derive(Debug, Clone)]
pub struct Foreseen {
    /// What it is to the job.
    pub role: &'static str,
    /// Whose it is.
    pub keys: Keys,
    /// The file or folder.
    pub path: PathBuf,
    /// Whether it stands already; else another task makes it.
    pub stands: bool,
    /// What is known of it where it does not.
    pub facts: Facts,
}

/// A stage's checked options.
pub trait Prepared: Send + Sync {
    /// What it needs of whoever makes the input of `role`, where `own` is needed of it.
    fn demand(&self, role: &str, own: &Demand) -> Demand;

    /// Its options as far as results hang on them; where less is demanded, less.
    fn options(&self, demand: &Demand) -> serde_json::Value;

    /// The job of one task.
    fn job(&self, keys: &Keys, demand: &Demand) -> Arc<dyn Job>;

    /// What the task would do and leave out.
    ///
    /// # Errors
    /// An input that stands and can't be read: its words name file, what is wrong and what to do.
    fn steps(&self, inputs: &[Foreseen], demand: &Demand) -> Result<Vec<Step>, String>;

    /// What will be known of its results.
    fn facts(&self, inputs: &[Foreseen], demand: &Demand) -> Facts;

    /// About how much memory a task takes, bytes, and how long on one thread, seconds.
    fn cost(&self, inputs: &[Foreseen]) -> (u64, f64);

    /// Files that are read with an input of `role`, with the role that each has, if they stand (or will be generated):
    /// an outline beside its photograph. Where one does, it is an input of the task, of the same keys, unless the stage
    /// names one of that role and these keys.
    fn beside(&self, _role: &str, _path: &Path) -> Vec<(&'static str, PathBuf)> {
        Vec::new()
    }

    /// The keys for each value of which a gathering job makes a task where the stage has no `each`; none: one task for
    /// all.
    fn each(&self) -> &'static [&'static str] {
        &[]
    }

    /// The file of a part in the task's folder, where options say which: a table as CSV or as Parquet.
    fn file(&self, part: &Part) -> &'static str {
        part.file
    }
}
