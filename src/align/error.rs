//! Why there is no labelled set.

use std::path::PathBuf;

use thiserror::Error;

use super::export::ExportError;
use crate::files::WriteError;
use crate::job::Interrupted;
use crate::log::{AmbientError, LogError};
use crate::table::TableError;

/// Why there is no labelled set.
#[derive(Debug, Error)]
pub enum AlignError {
    /// A table can't be read or written.
    #[error(transparent)]
    Table(#[from] TableError),
    /// The log can't be read.
    #[error(transparent)]
    Log(#[from] LogError),
    /// The log has no lit rows, or its range is none.
    #[error(transparent)]
    Ambient(#[from] AmbientError),
    /// An export can't be written, or not so.
    #[error(transparent)]
    Export(#[from] ExportError),
    /// The clocks can't be tied with confidence.
    #[error("{}: {why}", path.display())]
    NotTied {
        /// The table of angles.
        path: PathBuf,
        /// Why, and what to do.
        why: String,
    },
    /// No row gets a label.
    #[error("{}: {why}", path.display())]
    NothingLabelled {
        /// The log.
        path: PathBuf,
        /// Why, and what to do.
        why: String,
    },
    /// A result can't be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// Stopped from outside.
    #[error("stopped")]
    Interrupted(#[from] Interrupted),
}
