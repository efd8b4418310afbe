//! Why there is no analysis of trials.

use thiserror::Error;

use crate::files::WriteError;
use crate::job::Interrupted;
use crate::table::TableError;

/// Why there are no results; nothing that existed before was touched.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum PerformanceError {
    #[error(transparent)]
    Table(#[from] TableError),
    /// Rows that can't be used together; a fault a line, each with its place.
    #[error("{}", .0.join("\n"))]
    Rows(Vec<String>),
    #[error(transparent)]
    Write(#[from] WriteError),
    #[error("stopped")]
    Interrupted(#[from] Interrupted),
}
