//! Why a job of the predictors has no results.

use std::path::PathBuf;

use lunula_predictor::{CrossFault, FileFault, ForceSpaceFault, GateFault, LearningFault, RecipeFault, SubsetFault};
use thiserror::Error;

use super::data::DataError;
use crate::files::WriteError;
use crate::job::Interrupted;
use crate::table::TableError;

/// Why there are no results; nothing that stood before was touched.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum PredictorError {
    #[error(transparent)]
    Data(#[from] DataError),
    #[error("{}: {why}", path.display())]
    Open { path: PathBuf, why: std::io::Error },
    #[error("{}: {why}", path.display())]
    Model { path: PathBuf, why: FileFault },
    #[error(transparent)]
    Recipe(#[from] RecipeFault),
    #[error(transparent)]
    Cross(#[from] CrossFault),
    #[error(transparent)]
    Learning(#[from] LearningFault),
    #[error(transparent)]
    Subset(#[from] SubsetFault),
    #[error(transparent)]
    Gate(#[from] GateFault),
    #[error(transparent)]
    Space(#[from] ForceSpaceFault),
    #[error("{0}")]
    Request(String),
    #[error(transparent)]
    Write(#[from] WriteError),
    #[error(transparent)]
    Table(#[from] TableError),
    #[error("stopped")]
    Interrupted(#[from] Interrupted),
}
