//! Why a session with a sensor, or what is made of its recordings, has no result.

use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::files::WriteError;
use crate::log::LogError;
use crate::predictor::PredictorError;
use crate::table::TableError;

/// Why there is none.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum LiveError {
    #[error("{0}")]
    Request(String),
    #[error(
        "{}: exists already, and what was recorded can't be made again; choose another name, or say --replace",
        .0.display()
    )]
    Exists(PathBuf),
    #[error(
        "{}: another program is recording into it; end that one first, or choose another name",
        .0.display()
    )]
    Taken(PathBuf),
    #[error("{}: can't be written ({why}); what was recorded until then is kept", path.display())]
    Write { path: PathBuf, why: io::Error },
    #[error("standard output: cannot be written ({0}); make room, or send it elsewhere")]
    Rows(io::Error),
    /// Several faults, a line each, with their places.
    #[error("{}", .0.join("\n"))]
    Faults(Vec<String>),
    #[error("{place}: {what}")]
    Source { place: String, what: String },
    #[error("{}: {what}", path.display())]
    Config { path: PathBuf, what: String },
    #[error(transparent)]
    Models(#[from] PredictorError),
    #[error(transparent)]
    Table(#[from] TableError),
    #[error(transparent)]
    Log(#[from] LogError),
    #[error(transparent)]
    Results(#[from] WriteError),
    #[error("stopped")]
    Interrupted(#[from] crate::job::Interrupted),
}

impl LiveError {
    /// What is wrong with a recording as a whole.
    pub(super) fn recording(path: &Path, what: &str) -> Self {
        Self::Faults(vec![format!("{}: {what}", path.display())])
    }
}
