//! A file of recordings, and what results call it.

use std::path::PathBuf;

use clap::builder::{PathBufValueParser, TypedValueParser};

use super::RowOptions;
use crate::job::At;
use crate::log::ambient_step_of;
use crate::stages::Step;

/// A table or log, what it is called and whose it is where it does not say so itself.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DataFile {
    /// The file.
    pub path: PathBuf,
    /// What tables, pictures and models call it.
    pub name: String,
    /// The session where it has no such column; none: the file stands for it.
    pub session: Option<String>,
    /// The subject where it has no such column; none: the file stands for them.
    pub subject: Option<String>,
}

impl From<PathBuf> for DataFile {
    /// Called as its path is written.
    fn from(path: PathBuf) -> Self {
        Self { name: path.display().to_string(), path, session: None, subject: None }
    }
}

impl From<&At> for DataFile {
    /// Called as the pipeline calls it; session and subject by its keys.
    fn from(at: &At) -> Self {
        let own = |key: &str| at.keys.get(key).map(str::to_owned);
        Self { path: at.path.clone(), name: at.name.clone(), session: own("session"), subject: own("subject") }
    }
}

impl DataFile {
    /// Reads an argument of the command line. It says `value_hint = AnyPath`, which only paths say by themselves.
    #[must_use]
    pub fn parser() -> impl TypedValueParser<Value = Self> {
        PathBufValueParser::new().map(Self::from)
    }

    /// Files, each called as its path is written.
    #[must_use]
    pub fn of(paths: &[PathBuf]) -> Vec<Self> {
        paths.iter().cloned().map(Self::from).collect()
    }

    /// Who its rows are of, where it has no column that says it.
    #[must_use]
    pub fn person(&self) -> &str {
        self.subject.as_ref().unwrap_or(&self.name)
    }

    /// The step of plans that says whether their ambient light is taken away.
    #[must_use]
    pub fn ambient_step<'a>(files: impl IntoIterator<Item = &'a Self>, rows: &RowOptions) -> Step {
        ambient_step_of(files.into_iter().map(|file| file.path.as_path()), &rows.log)
    }
}
