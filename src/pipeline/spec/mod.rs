//! A pipeline file: what there is, what is to be done with it, and which results are wanted.
//!
//! In: TOML; out: a [`Spec`] whose names are all known, whose options each job has accepted, and in which no stage
//! works on itself. All faults that show without looking at inputs are reported at once, each with line and column.
//!
//! ```toml
//! wanted = ["sets"]                     # stages, or STAGE.PART; without it: the stages that no other works on
//!
//! [inputs.bending]                      # rows of a table: columns that stages name hold files, the others are keys
//! table = "sessions.csv"
//! where = { kind = "bending" }
//! keys = ["subject", "session"]         # optional: only these columns are keys
//!
//! [inputs.photos]                       # files: places in braces are keys
//! files = "photos/{pose}/{subject}.png"
//!
//! [stage.angles]
//! job = "posture"
//! video = "bending.video"               # INPUT, INPUT.COLUMN, STAGE, STAGE.PART, or
//!                                       # { from = "..", where = { subject = ["S01", "S02"] } }
//! joints = ["J2"]                       # options, as the command's, with _ for -
//! ```

mod cycle;
mod read;
mod reference;
pub(super) mod said;
mod stages;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::input;
use crate::job::{Kind, OptionFault, Part, Prepared};
use crate::pipeline::items::catalogue::Catalogue;
use crate::pipeline::parts::shard::PipelineMark;
use crate::toml_file::{self, Fault, place};

/// Why a pipeline can't be planned.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum PipelineError {
    #[error("{}: {why} (a pipeline file is TOML; `lunula init` writes one to start from)", path.display())]
    Unreadable { path: PathBuf, why: std::io::Error },
    #[error(
        "{}",
        faults
            .iter()
            .map(|f| format!("{}:{}:{}: {}", path.display(), f.line, f.column, f.what))
            .collect::<Vec<_>>()
            .join("\n")
    )]
    Faults {
        path: PathBuf,
        /// In the order of lines, at least one.
        faults: Vec<Fault>,
    },
}

/// A place in the file: a number of bytes from its beginning.
pub(super) type Place = usize;

/// Only items with one of these values of a key.
pub(super) type Filter = Vec<(String, Vec<String>, Place)>;

/// A pipeline file, checked as far as it can be without its inputs.
pub struct Spec {
    pub(super) path: PathBuf,
    pub(super) text: String,
    /// What it calls itself; else the file's name.
    pub name: String,
    /// What it is for.
    pub about: String,
    pub(super) wanted: Vec<Wanted>,
    pub(super) phantom: Option<Generated>,
    pub(super) inputs: Vec<InputSpec>,
    /// In an order in which each stands after those that it works on.
    pub(super) stages: Vec<StageSpec>,
}

/// A result that is wanted.
pub(super) struct Wanted {
    pub(super) stage: usize,
    /// None: all that are not made only where they are wanted.
    pub(super) part: Option<&'static Part>,
    pub(super) at: Place,
}

/// The recordings to generate.
pub(super) struct Generated {
    pub(super) options: toml::Table,
    /// Its keys, and those of its blocks, as `study.seed`.
    pub(super) keys: BTreeMap<String, Place>,
    pub(super) at: Place,
}

/// Where an input's items come from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum InputSource {
    /// The rows of a table.
    Table(String),
    /// Files by a pattern.
    Files(String),
}

pub(super) struct InputSpec {
    pub(super) name: String,
    pub(super) source: InputSource,
    pub(super) source_at: Place,
    /// Which columns are keys, if said.
    pub(super) keys: Option<Vec<(String, Place)>>,
    pub(super) filter: Filter,
    /// The columns that stages name, which hold files.
    pub(super) columns: Vec<(String, Place)>,
}

/// What a role names.
#[derive(Debug, Clone)]
pub(super) struct Reference {
    pub(super) from: From,
    pub(super) filter: Filter,
    pub(super) at: Place,
    /// As it is written.
    pub(super) said: String,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum From {
    /// An input, and which of its columns, by position.
    Input(usize, Option<usize>),
    /// A stage, and which of its kind's parts, by position; none: the whole folder.
    Stage(usize, Option<usize>),
}

/// A stage's name and job, before its references can be read.
struct Header {
    name: String,
    at: Place,
    kind: Option<&'static Kind>,
}

pub(super) struct StageSpec {
    pub(super) name: String,
    pub(super) at: Place,
    pub(super) kind: &'static Kind,
    /// The keys that it is done for each of, if said.
    pub(super) each: Option<(Vec<String>, Place)>,
    /// Only tasks and inputs with these values.
    pub(super) filter: Filter,
    /// What each of the kind's roles is given, in its order.
    pub(super) roles: Vec<Vec<Reference>>,
    pub(super) prepared: Arc<dyn Prepared>,
}

impl Spec {
    /// Reads a pipeline file whose jobs are of these `kinds`.
    ///
    /// # Errors
    /// Where it can't be read, or with all its faults.
    pub fn read(path: &Path, kinds: &[&'static Kind]) -> Result<Self, PipelineError> {
        let text = text_of(path)?;
        Self::parse(&text, path, kinds)
    }

    /// Checks the text of a pipeline file that stands at `path`.
    ///
    /// # Errors
    /// With all its faults.
    pub fn parse(text: &str, path: &Path, kinds: &[&'static Kind]) -> Result<Self, PipelineError> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        read::spec(text, path, kinds).map_err(|faults| PipelineError::Faults { path: path.to_owned(), faults })
    }

    /// The folder that its paths are relative to.
    #[must_use]
    pub fn folder(&self) -> &Path {
        self.path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
    }

    /// What decides what it makes, which parts of one run must agree on.
    #[must_use]
    pub fn mark(&self) -> PipelineMark {
        PipelineMark::new(&self.path, &self.text)
    }

    /// What it generates, as `catalogues` reads the options of `[phantom]`; none where there is no such table.
    ///
    /// # Errors
    /// Where its options are wrong.
    pub fn catalogue(
        &self,
        catalogues: impl Fn(&toml::Table) -> Result<Catalogue, OptionFault>,
    ) -> Result<Option<Catalogue>, PipelineError> {
        let Some(generated) = &self.phantom else { return Ok(None) };
        catalogues(&generated.options).map(Some).map_err(|fault| {
            let outer = fault.key.split('.').next().unwrap_or_default();
            let at = generated.keys.get(&fault.key).or_else(|| generated.keys.get(outer));
            let at = at.copied().unwrap_or(generated.at);
            PipelineError::Faults { path: self.path.clone(), faults: vec![self.fault(at, fault.what)] }
        })
    }

    pub(super) fn line(&self, at: Place) -> usize {
        place(&self.text, at).0
    }

    pub(super) fn fault(&self, at: Place, what: impl Into<String>) -> Fault {
        let (line, column) = place(&self.text, at);
        Fault { line, column, what: what.into() }
    }
}

/// Bytes of a pipeline file (assumed: the study's has 5 000, and one with a stage for each of a thousand recordings 200
/// 000).
const LARGEST: usize = 1 << 20;

fn text_of(path: &Path) -> Result<String, PipelineError> {
    let unreadable = |why| PipelineError::Unreadable { path: path.to_owned(), why };
    let bytes = input::read(path).map_err(unreadable)?;
    if bytes.len() > LARGEST {
        let what = format!("it has {} bytes; a pipeline file has {LARGEST} at most", bytes.len());
        return Err(unreadable(std::io::Error::new(std::io::ErrorKind::FileTooLarge, what)));
    }
    toml_file::text(bytes).map_err(|fault| PipelineError::Faults { path: path.to_owned(), faults: vec![fault] })
}
