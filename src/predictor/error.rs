//! Why a job of the predictors has no results.

use std::path::PathBuf;

use lunula_predictor::{CrossFault, FileFault, GateFault, LearningFault, RecipeFault, SubsetFault};
use thiserror::Error;

use super::data::DataError;
use crate::files::WriteError;
use crate::job::Interrupted;
use crate::table::TableError;

/// Why there are no results; nothing that stood before was touched.
#[derive(Debug, Error)]
pub enum PredictorError {
    /// The recordings can't be read, or hold nothing to work on.
    #[error(transparent)]
    Data(#[from] DataError),
    /// A model file can't be read.
    #[error("{}: cannot be read: {why}", path.display())]
    Open {
        /// The file.
        path: PathBuf,
        /// The system's words.
        why: std::io::Error,
    },
    /// Not a model file.
    #[error("{}: {why}", path.display())]
    Model {
        /// The file.
        path: PathBuf,
        /// What is wrong and what to do.
        why: FileFault,
    },
    /// The rows can't be fitted.
    #[error(transparent)]
    Recipe(#[from] RecipeFault),
    /// The rows can't be parted as asked, or no part can be fitted.
    #[error(transparent)]
    Cross(#[from] CrossFault),
    /// There is no learning curve.
    #[error(transparent)]
    Learning(#[from] LearningFault),
    /// The subsets of the photodiodes can't be compared.
    #[error(transparent)]
    Subset(#[from] SubsetFault),
    /// A threshold that can't be.
    #[error(transparent)]
    Gate(#[from] GateFault),
    /// Models that do not go together, or with what is asked.
    #[error("{0}")]
    Request(String),
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
