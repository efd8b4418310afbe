//! Why a session with a sensor, or what is made of its recordings, has no result.

use std::io;
use std::path::PathBuf;

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
    #[error("{}: can't be written ({why}); what was recorded until then is kept", path.display())]
    Write { path: PathBuf, why: io::Error },
    #[error("standard output: cannot be written ({0}); make room, or send it elsewhere")]
    Rows(io::Error),
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
