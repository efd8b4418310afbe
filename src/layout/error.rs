//! Why there is no layout.

use std::path::{Path, PathBuf};

use lunula_predictor::LayoutFault;
use thiserror::Error;

use crate::files::WriteError;
use crate::job::Interrupted;
use crate::log::LogError;
use crate::table::TableError;

/// Why there are no results; nothing that existed before was touched.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum LayoutError {
    #[error("{}: {what}", path.display())]
    Input { path: PathBuf, what: String },
    #[error("{0}")]
    Request(String),
    #[error("{person}: {what}")]
    Person { person: String, what: String },
    #[error(transparent)]
    Problem(#[from] LayoutFault),
    #[error(transparent)]
    Table(#[from] TableError),
    #[error(transparent)]
    Log(#[from] LogError),
    #[error(transparent)]
    Write(#[from] WriteError),
    #[error("stopped")]
    Interrupted(#[from] Interrupted),
}

impl LayoutError {
    /// What is wrong with an input.
    pub(super) fn input(path: &Path, what: impl Into<String>) -> Self {
        Self::Input { path: path.to_owned(), what: what.into() }
    }
}
