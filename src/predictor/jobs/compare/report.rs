//! What a comparison found, as reported.

use serde::Serialize;

use crate::job::Report;
use crate::predictor::jobs::compare::comparison::Comparison;

/// How models and sets of recordings compare.
pub type CompareReport = Report<CompareFigures>;

/// The figures of a run.
#[derive(Debug, Clone, Serialize)]
pub struct CompareFigures {
    /// The people, in the order of each [`Spread`](crate::predictor::jobs::compare::Spread)'s values.
    pub people: Vec<String>,
    /// Figure by figure.
    pub comparisons: Vec<Comparison>,
}
