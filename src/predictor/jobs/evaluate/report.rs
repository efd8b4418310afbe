//! How far off a model is, as reported.

use std::path::PathBuf;

use lunula_predictor::{By, CrossCoverage, Dataset, Leak, Split};
use ndarray::Array2;
use serde::Serialize;

use crate::job::Report;
use crate::predictor::data::FileRows;
use crate::predictor::merit::figures::{BinMerit, ByTarget, Merit};

/// A recording's errors.
#[derive(Debug, Clone, Serialize)]
pub struct RecordingMerit {
    /// Its name.
    pub recording: String,
    /// Its session.
    pub session: String,
    /// Its subject.
    pub subject: String,
    /// Its errors.
    #[serde(flatten)]
    pub merit: Merit,
}

/// Errors by size.
#[derive(Debug, Clone, Serialize)]
pub struct Magnitudes {
    /// Of what: the pressing, or the target.
    pub of: String,
    /// From small to large.
    pub bins: Vec<BinMerit>,
}

/// What was found with parts held out.
#[derive(Debug, Clone, Serialize)]
pub struct HeldOut {
    /// What was held out.
    pub by: By,
    /// All held-out rows together.
    pub pooled: Merit,
    /// Part by part; what could not be fitted says why.
    pub parts: Vec<Part>,
    /// Shuffled rows flatter: the error of whole trajectories over theirs, a target each.
    pub flattery: Option<ByTarget<Option<f64>>>,
    /// Whole trajectories held out, where rows were shuffled.
    pub by_trajectory: Option<Merit>,
    /// Prediction intervals from other parts, and how many rows they held.
    pub coverage: Option<CrossCoverage>,
    /// Why there are no intervals.
    pub no_coverage: Option<String>,
}

/// A part that was held out.
#[derive(Debug, Clone, Serialize)]
pub struct Part {
    /// Its name.
    pub name: String,
    /// Its errors.
    pub merit: Option<Merit>,
    /// Why it has none.
    pub fault: Option<String>,
}

/// How far off a model is.
pub type EvaluateReport = Report<EvaluateFigures>;

/// The figures of a run.
#[derive(Debug, Clone, Serialize)]
pub struct EvaluateFigures {
    /// The model file.
    pub model: PathBuf,
    /// The recordings.
    pub data: Vec<FileRows>,
    /// The model's errors on all rows.
    #[serde(flatten)]
    pub merit: Merit,
    /// Recording by recording.
    pub recordings: Vec<RecordingMerit>,
    /// By size.
    pub by_magnitude: Option<Magnitudes>,
    /// The share of rows within the model's prediction intervals.
    pub coverage: Option<ByTarget<Option<f64>>>,
    /// The share of rows within 1.96 of the model's own SDs, which are to hold 95 %; of eigennails.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub within_own: Option<ByTarget<Option<f64>>>,
    /// The same model without its cone of friction.
    pub without_friction: Option<Merit>,
    /// Its recipe with parts held out.
    pub held_out: Option<HeldOut>,
    /// Its recipe by several ways to hold out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub splits: Option<Splits>,
}

/// A recipe by several ways to hold out, beside what it has to beat.
#[derive(Debug, Clone, Serialize)]
pub struct Splits {
    /// Way by way.
    pub ways: Vec<Split>,
    /// What shuffled rows make look good, and is no better than the mean with whole paths held out.
    pub leaks: Vec<Leak>,
}

/// Rows with what was measured and predicted, for tables and pictures.
#[derive(Debug, Clone)]
pub(super) struct Predicted {
    /// What pictures call the model.
    pub(super) title: String,
    pub(super) data: Dataset,
    pub(super) values: Array2<f64>,
    /// Half the width of the prediction intervals, and the share of rows that they are to hold.
    pub(super) half_width: Option<(Vec<f64>, f64)>,
}
