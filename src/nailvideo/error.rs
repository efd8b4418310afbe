//! Why there are no results.

use std::path::PathBuf;

use thiserror::Error;

use crate::files::WriteError;
use crate::job::Interrupted;
use crate::table::TableError;
use crate::video::VideoError;

/// Why there are no results.
#[derive(Debug, Error)]
pub enum NailVideoError {
    /// The video can't be read.
    #[error(transparent)]
    Video(#[from] VideoError),
    /// The nail is not known in the first frames, or can't be followed.
    #[error("{}: {why}", path.display())]
    Nail {
        /// The video, or the file with the outline.
        path: PathBuf,
        /// What is wrong and what to do.
        why: String,
    },
    /// The photodiodes' places.
    #[error("{}: {why}", path.display())]
    Positions {
        /// The file.
        path: PathBuf,
        /// What is wrong and what to do.
        why: String,
    },
    /// An option does not suit the video.
    #[error("{}: {why}", path.display())]
    Option {
        /// The video.
        path: PathBuf,
        /// What is wrong and what to do.
        why: String,
    },
    /// A result can't be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// A table can't be written.
    #[error(transparent)]
    Table(#[from] TableError),
    /// Stopped from outside.
    #[error("stopped")]
    Interrupted(#[from] Interrupted),
}
