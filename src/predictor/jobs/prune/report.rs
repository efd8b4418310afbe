//! Which photodiodes could be removed, as reported.

use serde::Serialize;

use crate::job::Report;
use crate::predictor::data::FileRows;
use crate::predictor::merit::figures::ByTarget;

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

/// Which photodiodes could be removed.
pub type PruneReport = Report<PruneFigures>;

/// The figures of a run.
#[derive(Debug, Clone, Default, Serialize)]
pub struct PruneFigures {
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
}
