//! What was corrected.

use std::path::PathBuf;

use crate::job::Report;

/// What was done to the outlines of a set.
pub type EditReport = Report<EditFigures>;

/// The figures of it.
#[derive(Debug, Clone, serde::Serialize)]
pub struct EditFigures {
    /// Photographs of the set.
    pub photographs: usize,
    /// Nails that were known or drawn.
    pub nails: usize,
    /// Nails that a person accepted.
    pub accepted: usize,
    /// Nails that a person said are none.
    pub rejected: usize,
    /// Photographs that were not looked at before it ended.
    pub unseen_photographs: usize,
    /// Keys for the accepted and rejected ones.
    pub keys: u64,
    /// Files of outlines that were written.
    pub saved: Vec<PathBuf>,
}
