//! Why a job of the hemodynamic model has no results.

use std::fmt::Display;
use std::path::{Path, PathBuf};

use lunula_hemodynamics::{ParameterFault, StateFault};
use thiserror::Error;

use crate::files::WriteError;
use crate::job::Interrupted;
use crate::log::LogError;
use crate::table::TableError;

/// Why there are no results; nothing that existed before was touched.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum HemodynamicsError {
    #[error("{}", .0.join("; "))]
    Options(Vec<String>),
    #[error("{}: {why}", path.display())]
    Open { path: PathBuf, why: std::io::Error },
    #[error("{}: {why}", path.display())]
    ParameterFile { path: PathBuf, why: ParameterFault },
    #[error(transparent)]
    Parameters(#[from] ParameterFault),
    /// A table of loads, recordings or states can't be used; a fault a line, each with its place.
    #[error("{}", .0.join("\n"))]
    Rows(Vec<String>),
    #[error("{}: {why}", path.display())]
    Start { path: PathBuf, why: StateFault },
    #[error("{0}")]
    Model(String),
    #[error(transparent)]
    Table(#[from] TableError),
    #[error(transparent)]
    Log(#[from] LogError),
    #[error(transparent)]
    Write(#[from] WriteError),
    #[error("stopped")]
    Interrupted(#[from] Interrupted),
}

impl HemodynamicsError {
    pub(super) fn model(why: impl Display) -> Self {
        Self::Model(why.to_string())
    }

    /// What is wrong with a table as a whole.
    pub(super) fn table(path: &Path, what: impl Display) -> Self {
        Self::Rows(vec![format!("{}: {what}", path.display())])
    }
}
