//! What a model is made of, as reported.

use std::path::PathBuf;

use serde::Serialize;

use crate::job::Report;
use crate::predictor::merit::figures::ByTarget;

/// A mode of a model.
#[derive(Debug, Clone, Serialize)]
pub struct ModelMode {
    /// sigma, targets' unit a volt.
    pub singular_value: f64,
    /// What each target has of it; the largest is positive.
    pub targets: ByTarget<f64>,
    /// What each photodiode has of it.
    pub inputs: ByTarget<f64>,
}

/// The modes of a model.
#[derive(Debug, Clone, Serialize)]
pub struct ModelModes {
    /// Strongest first.
    pub modes: Vec<ModelMode>,
    /// The strongest singular value over the weakest; none where that is 0.
    pub condition: Option<f64>,
}

/// The model as the thesis prints it: what each target has of each term of voltages as they are, and the offset.
#[derive(Debug, Clone, Serialize)]
pub struct Printed {
    /// P1, .., and for equation 16 P1^2, P1 P2, ..
    pub terms: Vec<String>,
    /// J, a row a target.
    pub jacobian: ByTarget<Vec<f64>>,
    /// F_0 of equation 9: the prediction where all voltages are 0.
    pub offset: ByTarget<f64>,
}

/// What a model is made of.
pub type AnalyseReport = Report<AnalyseFigures>;

/// The figures of a run.
#[derive(Debug, Clone, Serialize)]
pub struct AnalyseFigures {
    /// The model file.
    pub model: PathBuf,
    /// What it reads.
    pub inputs: Vec<String>,
    /// What it reports.
    pub targets: Vec<String>,
    /// Where the Jacobian was taken, volts; none for a linear model, whose Jacobian is the same everywhere.
    pub at_v: Option<Vec<f64>>,
    /// The Jacobian, a row a target.
    pub jacobian: ByTarget<Vec<f64>>,
    /// Its modes.
    #[serde(flatten)]
    pub modes: ModelModes,
    /// As the thesis prints it; a network has no such form.
    pub printed: Option<Printed>,
}
