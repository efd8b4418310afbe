//! What a comparison found, as reported.

use serde::Serialize;

use crate::compare::comparison::Comparison;
use lunula::job::Report;

/// How models and sets of recordings compare.
pub type CompareReport = Report<CompareFigures>;

/// The figures of a run.
#[derive(Debug, Clone, Serialize)]
pub struct CompareFigures {
    /// The people, in the order of each [`Spread`](crate::compare::Spread)'s values.
    pub people: Vec<String>,
    /// Figure by figure.
    pub comparisons: Vec<Comparison>,
}
