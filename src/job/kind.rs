//! What a job says of itself, once: what it takes and makes, its options, its plan, its run.
//!
//! A job implements [`Job`]; the planner knows it through [`Kind`] and [`Prepared`], the runner through [`Maker`].

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::Args;

use super::work::{Made, Work};
use super::{Given, Keys, OptionFault, Said, keys, read};
use crate::stages::Step;
use crate::video::Header;

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

impl Role {
    /// A role by its key, how many files it takes, and what it is.
    #[must_use]
    pub const fn new(name: &'static str, takes: Takes, about: &'static str) -> Self {
        Self { name, takes, about }
    }
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
}

impl Part {
    /// The part that the pictures are.
    pub const PICTURES: &str = "pictures";

    /// A part that is always made, by name and file.
    #[must_use]
    pub const fn new(name: &'static str, file: &'static str) -> Self {
        Self { name, file, only_if_wanted: false }
    }

    /// One that is made only where it is wanted.
    #[must_use]
    pub const fn if_wanted(name: &'static str, file: &'static str) -> Self {
        Self { name, file, only_if_wanted: true }
    }

    /// The pictures.
    #[must_use]
    pub const fn pictures(file: &'static str) -> Self {
        Self::if_wanted(Self::PICTURES, file)
    }
}

/// A kind of job.
pub struct Kind {
    /// Its name in pipeline files: `posture`.
    pub name: &'static str,
    /// What it works on.
    pub roles: &'static [Role],
    /// What it makes.
    pub parts: &'static [Part],
    /// Counted up where the same inputs and options give other bytes than before.
    pub revision: u32,
    /// Its keys in pipeline files besides the roles, `job`, `each` and `where`.
    pub keys: fn() -> Vec<String>,
    /// Checks a stage's keys (without roles, `job`, `each`, `where`).
    pub prepare: fn(&toml::Table) -> Result<Arc<dyn Prepared>, OptionFault>,
}

impl Kind {
    /// That of a job, in its first revision.
    #[must_use]
    pub const fn of<J: Job + Args>(name: &'static str, roles: &'static [Role], parts: &'static [Part]) -> Self {
        Self { name, roles, parts, revision: 1, keys: keys::<J>, prepare: prepare::<J> }
    }

    /// The same in a later revision.
    #[must_use]
    pub const fn revision(mut self, revision: u32) -> Self {
        self.revision = revision;
        self
    }
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

impl Demand {
    /// Whether a part is needed.
    #[must_use]
    pub fn wants(&self, part: &str) -> bool {
        self.parts.contains(part)
    }

    /// Whether pictures are needed.
    #[must_use]
    pub fn draws(&self) -> bool {
        self.wants(Part::PICTURES)
    }
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
    /// Whether it exists already; else another task makes it.
    pub exists: bool,
    /// What is known of it where it does not.
    pub facts: Facts,
}

impl Foreseen {
    /// Its size in bytes; `guess` while it does not exist.
    #[must_use]
    pub fn bytes(&self, guess: u64) -> u64 {
        std::fs::metadata(&self.path).map_or(guess, |file| file.len())
    }

    /// The input of a role, if there is one.
    #[must_use]
    pub fn of<'a>(inputs: &'a [Self], role: &str) -> Option<&'a Self> {
        inputs.iter().find(|input| input.role == role)
    }

    /// How many frames the video of a role has, and of how many pixels each: guessed where its header does not say.
    pub(crate) fn of_video(inputs: &[Self], role: &str) -> (f64, f64) {
        let known = Self::of(inputs, role).filter(|video| video.exists);
        let header = known.and_then(|video| Header::read(&video.path).ok());
        let (width, height) = header.as_ref().map_or((1280, 720), |header| (header.width, header.height));
        let frames = header.and_then(|header| header.declared_frames).unwrap_or(TYPICAL_FRAMES);
        (frames as f64, (width * height) as f64)
    }
}

/// Frames of a video whose header does not say how many it has.
const TYPICAL_FRAMES: u64 = 1800;

/// What of a job's results is wanted, and for whom.
#[derive(Clone, Copy)]
pub struct Order<'a> {
    /// Whose recordings they are.
    pub keys: &'a Keys,
    /// What later stages and the wanted results need.
    pub demand: &'a Demand,
    /// The stage's options as the file writes them.
    pub said: &'a Said,
}

/// A job as pipelines know it: the options of one stage, checked. They are the command's options too (`clap::Args`); a
/// job without options is a struct without fields.
pub trait Job: Send + Sync + Sized + 'static {
    /// What the planner has to know of it.
    const KIND: Kind;

    /// Checks the options of a stage, each of which is valid by itself.
    ///
    /// # Errors
    /// [`OptionFault`], the first thing that is wrong.
    fn checked(self) -> Result<Self, OptionFault> {
        Ok(self)
    }

    /// What it needs of whoever makes the input of `role`, where `own` is needed of it.
    fn demand(&self, _role: &str, _own: &Demand) -> Demand {
        Demand::default()
    }

    /// What its results depend on besides the inputs: the options as written, and which parts are made only if wanted.
    fn depends_on(&self, said: &Said, demand: &Demand) -> serde_json::Value {
        let optional = Self::KIND.parts.iter().filter(|part| part.only_if_wanted).map(|part| part.name);
        let made: Vec<&str> = optional.filter(|part| demand.parts.contains(part)).collect();
        serde_json::json!({ "options": said, "made": made })
    }

    /// What the task would do and leave out.
    ///
    /// # Errors
    /// An input that exists and can't be read: its words name file, what is wrong and what to do.
    fn steps(&self, inputs: &[Foreseen], demand: &Demand) -> Result<Vec<Step>, String>;

    /// What will be known of its results.
    fn facts(&self, _inputs: &[Foreseen], _demand: &Demand) -> Facts {
        Facts::default()
    }

    /// About how much memory a task takes, bytes, and how long on one thread, seconds.
    fn cost(&self, inputs: &[Foreseen]) -> (u64, f64);

    /// Files that are read with an input of `role`, with the role that each has, if they exist (or will be generated):
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

    /// Makes the results in `work.folder`.
    ///
    /// # Errors
    /// Where there is no result; the words name file and place, and say what to do.
    fn run(&self, order: &Order<'_>, work: &Work<'_>) -> anyhow::Result<Made>;
}

/// Any job's checked stage, as the planner holds it: [`Job`] without its types.
pub trait Prepared: Send + Sync {
    /// [`Job::demand`].
    fn demand(&self, role: &str, own: &Demand) -> Demand;
    /// [`Job::depends_on`].
    fn depends_on(&self, demand: &Demand) -> serde_json::Value;
    /// What does one task.
    fn maker(self: Arc<Self>, keys: &Keys, demand: &Demand) -> Arc<dyn Maker>;
    /// [`Job::steps`].
    ///
    /// # Errors
    /// An input that exists and can't be read.
    fn steps(&self, inputs: &[Foreseen], demand: &Demand) -> Result<Vec<Step>, String>;
    /// [`Job::facts`].
    fn facts(&self, inputs: &[Foreseen], demand: &Demand) -> Facts;
    /// [`Job::cost`].
    fn cost(&self, inputs: &[Foreseen]) -> (u64, f64);
    /// [`Job::beside`].
    fn beside(&self, role: &str, path: &Path) -> Vec<(&'static str, PathBuf)>;
    /// [`Job::each`].
    fn each(&self) -> &'static [&'static str];
    /// [`Job::file`].
    fn file(&self, part: &Part) -> &'static str;
}

/// Does one task.
pub trait Maker: Send + Sync {
    /// Makes the results in `work.folder`.
    ///
    /// # Errors
    /// Where there is no result; the words name file and place, and say what to do.
    fn run(&self, work: &Work<'_>) -> anyhow::Result<Made>;
}

impl<F: Fn(&Work<'_>) -> anyhow::Result<Made> + Send + Sync> Maker for F {
    fn run(&self, work: &Work<'_>) -> anyhow::Result<Made> {
        self(work)
    }
}

/// Reads a stage's keys and checks them.
///
/// # Errors
/// [`OptionFault`], the first thing that is wrong.
pub fn prepare<J: Job + Args>(table: &toml::Table) -> Result<Arc<dyn Prepared>, OptionFault> {
    let Given { options, said } = read::<J>(table, &format!("the job {}", J::KIND.name))?;
    prepared(options, said)
}

/// Checks a stage's options; `said` as the file writes them.
///
/// # Errors
/// [`OptionFault`], the first thing that is wrong.
pub fn prepared<J: Job>(options: J, said: Said) -> Result<Arc<dyn Prepared>, OptionFault> {
    Ok(Arc::new(Stage { job: options.checked()?, said }))
}

struct Stage<J> {
    job: J,
    said: Said,
}

impl<J: Job> Prepared for Stage<J> {
    fn demand(&self, role: &str, own: &Demand) -> Demand {
        self.job.demand(role, own)
    }

    fn depends_on(&self, demand: &Demand) -> serde_json::Value {
        self.job.depends_on(&self.said, demand)
    }

    fn maker(self: Arc<Self>, keys: &Keys, demand: &Demand) -> Arc<dyn Maker> {
        let (keys, demand) = (keys.clone(), demand.clone());
        Arc::new(move |work: &Work<'_>| self.job.run(&Order { keys: &keys, demand: &demand, said: &self.said }, work))
    }

    fn steps(&self, inputs: &[Foreseen], demand: &Demand) -> Result<Vec<Step>, String> {
        self.job.steps(inputs, demand)
    }

    fn facts(&self, inputs: &[Foreseen], demand: &Demand) -> Facts {
        self.job.facts(inputs, demand)
    }

    fn cost(&self, inputs: &[Foreseen]) -> (u64, f64) {
        self.job.cost(inputs)
    }

    fn beside(&self, role: &str, path: &Path) -> Vec<(&'static str, PathBuf)> {
        self.job.beside(role, path)
    }

    fn each(&self) -> &'static [&'static str] {
        self.job.each()
    }

    fn file(&self, part: &Part) -> &'static str {
        self.job.file(part)
    }
}
