//! Why there are no angles.

use std::path::PathBuf;

use thiserror::Error;

use crate::files::WriteError;
use crate::job::Interrupted;
use crate::table::TableError;
use crate::video::VideoError;

/// Why there are no results.
#[derive(Debug, Error)]
pub enum PostureError {
    /// The video can't be read or the overlay not written.
    #[error(transparent)]
    Video(#[from] VideoError),
    /// The markers can't be found or distinguished.
    #[error("{}: {why}", path.display())]
    Markers {
        /// The video.
        path: PathBuf,
        /// What is wrong and what to do.
        why: String,
    },
    /// The lens of the marker file is not the video's.
    #[error("{}: {why}", path.display())]
    Camera {
        /// The video.
        path: PathBuf,
        /// What is wrong and what to do.
        why: String,
    },
    /// The clock can't be where the marker file says.
    #[error("{}: [clock]: {why}", path.display())]
    Clock {
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
