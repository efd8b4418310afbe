//! Which photodiodes could be removed, as reported.

use std::path::PathBuf;

use serde::Serialize;

use crate::predictor::data::FileRows;
use crate::predictor::figures_of_merit::ByTarget;
use crate::stages::Stage;

/// A subset's errors.
#[derive(Debug, Clone, Serialize)]
pub struct PruneRow {
    /// The photodiodes in it.
    pub inputs: Vec<String>,
    /// How many of them are independent on the training rows; where not all are, there is no one model and no error.
    pub rank: usize,
    /// On the rows trained on.
    pub train_rmse: Option<ByTarget<f64>>,
    /// On the rows validated on.
    pub validate_rmse: Option<ByTarget<f64>>,
    /// What subsets are compared by: the mean over targets of the validation RMSE over the target's SD on the training
    /// rows.
    pub score: Option<f64>,
}

/// What was found.
#[derive(Debug, Clone, Serialize)]
pub struct PruneReport {
    /// Which job.
    pub job: &'static str,
    /// The recordings trained on.
    pub data: Vec<FileRows>,
    /// The recordings validated on.
    pub validate: Vec<FileRows>,
    /// The photodiodes.
    pub inputs: Vec<String>,
    /// The targets.
    pub targets: Vec<String>,
    /// How many subsets were looked at.
    pub subsets: usize,
    /// The training mean, no photodiode at all, on the rows validated on.
    pub none: Option<ByTarget<f64>>,
    /// The best of each size.
    pub best_of_size: Vec<PruneRow>,
    /// All, then all but one each (Fig. 113).
    pub without_one: Vec<PruneRow>,
    /// Every subset; in the table `subsets.csv` rather than in JSON.
    #[serde(skip)]
    pub all: Vec<PruneRow>,
    /// What the job did not need.
    pub left_out: Vec<String>,
    /// What whoever reads this should know.
    pub warnings: Vec<String>,
    /// The pictures.
    pub pictures: Vec<PathBuf>,
    /// Time by stage.
    pub stages: Vec<Stage>,
    /// Seconds from start to end.
    pub wall_s: f64,
}
