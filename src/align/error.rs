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
#[allow(missing_docs, reason = "the messages say it")]
pub enum AlignError {
    #[error(transparent)]
    Table(#[from] TableError),
    #[error(transparent)]
    Log(#[from] LogError),
    #[error(transparent)]
    Ambient(#[from] AmbientError),
    #[error(transparent)]
    Export(#[from] ExportError),
    #[error("{}: {why}", path.display())]
    NotTied { path: PathBuf, why: String },
    #[error("{}: {why}", path.display())]
    NothingLabelled { path: PathBuf, why: String },
    #[error(transparent)]
    Write(#[from] WriteError),
    #[error("stopped")]
    Interrupted(#[from] Interrupted),
}
