//! Ridge regression of targets on the scores of a nail: the coefficients shrink where the rows say little.
//!
//! y = offset + B s, with B of least sum of squares plus lambda |B|^2; scores s in the cells' unit, centred over the
//! training rows by their making.

use ndarray::Array2;
use serde::Serialize;

use super::super::{ModelFault, finite, finite_matrix, sizes};
use super::basis::Projection;

/// Ridge on scores.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Ridge {
    #[serde(serialize_with = "crate::model::rows")]
    pub(super) coefficients: Array2<f64>,
    pub(super) offset: Vec<f64>,
    lambda: Vec<f64>,
    residual_sd: Vec<f64>,
    /// Trained on.
    rows: usize,
    /// Rows trained on less 1, times the variance of each score.
    #[serde(skip)]
    squares: Vec<f64>,
}

impl Ridge {
    /// `coefficients`: targets x modes, a target's unit for each unit of the cells; `offset`: the targets' means;
    /// `lambda`: a target each, the cells' unit squared; `residual_sd`: of rows not trained on, a target each; `rows`:
    /// trained on; `spread`: SD of the scores.
    pub fn new(
        coefficients: Array2<f64>,
        offset: Vec<f64>,
        lambda: Vec<f64>,
        residual_sd: Vec<f64>,
        rows: usize,
        spread: &[f64],
    ) -> Result<Self, ModelFault> {
        let targets = coefficients.nrows();
        sizes(&[
            ("offsets", offset.len(), targets),
            ("lambdas", lambda.len(), targets),
            ("residual SDs", residual_sd.len(), targets),
            ("coefficients of a target", coefficients.ncols(), spread.len()),
        ])?;
        finite(&[("offset", &offset), ("lambda", &lambda), ("residual_sd", &residual_sd)])?;
        finite_matrix("coefficients", &coefficients)?;
        if lambda.iter().chain(&residual_sd).any(|value| *value < 0.0) || rows == 0 {
            return Err(ModelFault::Number("lambda, residual_sd or rows"));
        }
        let squares = spread.iter().map(|spread| (rows as f64 - 1.0) * spread * spread).collect();
        let coefficients = coefficients.as_standard_layout().into_owned();
        Ok(Self { coefficients, offset, lambda, residual_sd, rows, squares })
    }

    /// Targets at scores.
    pub(super) fn predict(&self, scores: &[f64], out: &mut [f64]) {
        for ((out, row), offset) in out.iter_mut().zip(self.coefficients.rows()).zip(&self.offset) {
            *out = offset + row.iter().zip(scores).map(|(b, s)| b * s).sum::<f64>();
        }
    }

    /// SD of a measured value about its prediction.
    pub(super) fn sd(&self, at: &Projection, out: &mut [f64]) {
        for (target, out) in out.iter_mut().enumerate() {
            let far = at.scores.iter().zip(&self.squares).map(|(s, squares)| s * s / (squares + self.lambda[target]));
            let known = self.residual_sd[target].powi(2) * (1.0 + 1.0 / self.rows as f64 + far.sum::<f64>());
            let slopes = self.coefficients.row(target);
            let slopes = slopes.as_slice().expect("standard layout");
            *out = (known + super::spread_along(slopes, at.hidden.as_ref())).sqrt();
        }
    }
}
