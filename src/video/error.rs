//! Why a video can't be read or written.

use std::path::{Path, PathBuf};

/// Why a file gives no frames, or takes none.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum VideoError {
    #[error("{}: {what}", path.display())]
    Open { path: PathBuf, what: String },
    #[error("{}: {what}", path.display())]
    Changed { path: PathBuf, what: String },
    #[error("{}: {what}", path.display())]
    Write { path: PathBuf, what: String },
}

impl VideoError {
    pub(super) fn open(path: &Path, what: impl Into<String>) -> Self {
        Self::Open { path: path.to_owned(), what: what.into() }
    }

    pub(super) fn write(path: &Path, what: impl Into<String>) -> Self {
        Self::Write { path: path.to_owned(), what: what.into() }
    }
}
