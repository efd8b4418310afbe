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
pub enum HemodynamicsError {
    /// All that is wrong with the options.
    #[error("{}", .0.join("; "))]
    Options(Vec<String>),
    /// A file can't be read.
    #[error("{}: cannot be read: {why}", path.display())]
    Open {
        /// The file.
        path: PathBuf,
        /// The system's words.
        why: std::io::Error,
    },
    /// A file that is not one of parameters.
    #[error("{}: {why}", path.display())]
    ParameterFile {
        /// The file.
        path: PathBuf,
        /// Every fault.
        why: ParameterFault,
    },
    /// Parameters that can't be.
    #[error(transparent)]
    Parameters(#[from] ParameterFault),
    /// A table of loads, recordings or states can't be used; a fault a line, each with its place.
    #[error("{}", .0.join("\n"))]
    Rows(Vec<String>),
    /// The state to start from is not one of this model.
    #[error("{}: {why}", path.display())]
    Start {
        /// The table.
        path: PathBuf,
        /// What is wrong.
        why: StateFault,
    },
    /// The model can't go on, or has no answer.
    #[error("{0}")]
    Model(String),
    /// A table can't be read or written.
    #[error(transparent)]
    Table(#[from] TableError),
    /// A log can't be read.
    #[error(transparent)]
    Log(#[from] LogError),
    /// A result can't be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// Stopped from outside.
    #[error("stopped")]
    Interrupted(#[from] Interrupted),
}

impl HemodynamicsError {
    /// What is wrong with a table as a whole.
    pub(super) fn table(path: &Path, what: impl Display) -> Self {
        Self::Rows(vec![format!("{}: {what}", path.display())])
    }
}
