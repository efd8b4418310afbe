//! Why there are no angles.

use std::path::PathBuf;

use thiserror::Error;

use crate::files::WriteError;
use crate::job::Interrupted;
use crate::table::TableError;
use crate::video::VideoError;

/// Why there are no results.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum PostureError {
    #[error(transparent)]
    Video(#[from] VideoError),
    #[error("{}: {why}", path.display())]
    Markers { path: PathBuf, why: String },
    #[error("{}: {why}", path.display())]
    Camera { path: PathBuf, why: String },
    #[error("{}: [clock]: {why}", path.display())]
    Clock { path: PathBuf, why: String },
    #[error(transparent)]
    Write(#[from] WriteError),
    #[error(transparent)]
    Table(#[from] TableError),
    #[error("stopped")]
    Interrupted(#[from] Interrupted),
}
