//! Why a video can't be read or written.

use std::path::{Path, PathBuf};

/// Why a file gives no frames, or takes none.
#[derive(Debug, thiserror::Error)]
pub enum VideoError {
    /// The file can't be opened or is no video.
    #[error("{}: {what}", path.display())]
    Open {
        /// The file that was to be read.
        path: PathBuf,
        /// What is wrong and what to do.
        what: String,
    },
    /// The picture's size or samples change in mid stream.
    #[error("{}: {what}", path.display())]
    Changed {
        /// The file that was read.
        path: PathBuf,
        /// What is wrong and what to do.
        what: String,
    },
    /// A frame can't be written.
    #[error("{}: {what}", path.display())]
    Write {
        /// The file that was to be written.
        path: PathBuf,
        /// What is wrong and what to do.
        what: String,
    },
}

impl VideoError {
    pub(super) fn open(path: &Path, what: impl Into<String>) -> Self {
        Self::Open { path: path.to_owned(), what: what.into() }
    }

    pub(super) fn write(path: &Path, what: impl Into<String>) -> Self {
        Self::Write { path: path.to_owned(), what: what.into() }
    }
}
