//! What a comparison found, as reported.

use std::path::PathBuf;

use serde::Serialize;

use super::comparison::Comparison;
use crate::stages::Stage;

/// What was found.
#[derive(Debug, Clone, Serialize)]
pub struct CompareReport {
    /// Which job.
    pub job: &'static str,
    /// The people, in the order of each [`Spread`](super::Spread)'s values.
    pub people: Vec<String>,
    /// Figure by figure.
    pub comparisons: Vec<Comparison>,
    /// What whoever reads this should know.
    pub warnings: Vec<String>,
    /// The pictures.
    pub pictures: Vec<PathBuf>,
    /// Time by stage.
    pub stages: Vec<Stage>,
    /// Seconds from start to end.
    pub wall_s: f64,
}
