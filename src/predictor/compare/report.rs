//! What a comparison found, as reported.

use serde::Serialize;

use super::comparison::Comparison;
use crate::job::Report;

/// How models and sets of recordings compare.
pub type CompareReport = Report<CompareFigures>;

/// The figures of a run.
#[derive(Debug, Clone, Serialize)]
pub struct CompareFigures {
    /// The people, in the order of each [`Spread`](super::Spread)'s values.
    pub people: Vec<String>,
    /// Figure by figure.
    pub comparisons: Vec<Comparison>,
}
