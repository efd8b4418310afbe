//! A Gaussian process on the scores of a nail: k(a, b) = amplitude^2 exp(-|a - b|^2 / (2 length^2)) on whitened scores
//! (each over its SD, so lengths are in SDs), with noise of variance amplitude^2 noise on every row (Rasmussen and
//! Williams, Gaussian Processes for Machine Learning, 2006, algorithm 2.1).
//!
//! It keeps few rows, those that lie farthest from each other, and is exact on them; the others of the training set
//! say nothing beyond choosing them. Far from all rows kept, the prediction falls back to the mean and the SD to the
//! amplitude: it says that it is lost.

use ndarray::{Array2, Axis};
use serde::{Deserialize, Serialize};

use super::super::{ModelFault, finite, finite_matrix, sizes};
use super::basis::Projection;
use crate::algebra::cholesky::Cholesky;

/// What a target's process is like.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Covariance {
    /// SD of the target about its mean, its unit; 0 of a target that does not change.
    pub amplitude: f64,
    /// How far scores have to be apart to say little of each other, SDs of the scores.
    pub length: f64,
    /// Variance of the noise over `amplitude`^2.
    pub noise: f64,
    /// By how much the SD is widened, for what rows of recordings left out have shown.
    pub widened: f64,
}

/// A Gaussian process on scores, a target each.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Process {
    /// Rows x modes, whitened.
    #[serde(serialize_with = "crate::model::rows")]
    pub(super) rows: Array2<f64>,
    /// Rows x targets.
    #[serde(serialize_with = "crate::model::rows")]
    targets: Array2<f64>,
    pub(super) covariances: Vec<Covariance>,
    #[serde(skip)]
    spread: Vec<f64>,
    #[serde(skip)]
    mean: Vec<f64>,
    #[serde(skip)]
    factors: Vec<Cholesky>,
    /// Of each target (K + noise)^-1 (y - mean), over amplitude^2 both.
    #[serde(skip)]
    weights: Vec<Vec<f64>>,
}

impl Process {
    /// `rows`: rows x modes, whitened by `spread`, the SD of the scores; `targets`: rows x targets.
    pub fn new(
        rows: Array2<f64>,
        targets: Array2<f64>,
        covariances: Vec<Covariance>,
        spread: &[f64],
    ) -> Result<Self, ModelFault> {
        sizes(&[
            ("rows of targets", targets.nrows(), rows.nrows()),
            ("modes of the rows", rows.ncols(), spread.len()),
            ("covariances", covariances.len(), targets.ncols()),
        ])?;
        finite_matrix("rows", &rows)?;
        finite_matrix("targets", &targets)?;
        for one in &covariances {
            finite(&[("covariance", &[one.amplitude, one.length, one.noise, one.widened])])?;
            if one.amplitude < 0.0 || one.length <= 0.0 || one.noise <= 0.0 || one.widened <= 0.0 {
                return Err(ModelFault::Number("covariance"));
            }
        }
        let mean = targets.mean_axis(Axis(0)).ok_or(ModelFault::Number("rows"))?.to_vec();
        let apart = squared_distances(&rows);
        let (mut factors, mut weights) = (Vec::new(), Vec::new());
        for (target, one) in covariances.iter().enumerate() {
            let factor = Cholesky::of(kernel(&apart, one.length), rows.nrows(), one.noise);
            let factor = factor.ok_or(ModelFault::Number("covariance"))?;
            let mut weight: Vec<f64> = targets.column(target).iter().map(|value| value - mean[target]).collect();
            factor.solve(&mut weight);
            factors.push(factor);
            weights.push(weight);
        }
        let rows = rows.as_standard_layout().into_owned();
        Ok(Self { rows, targets, covariances, spread: spread.to_vec(), mean, factors, weights })
    }

    /// What the process of each target is like.
    #[must_use]
    pub fn covariances(&self) -> &[Covariance] {
        &self.covariances
    }

    /// How alike the row is to each row kept, in the eyes of a target.
    fn alike(&self, whitened: &[f64], target: usize) -> Vec<f64> {
        let by = -0.5 / self.covariances[target].length.powi(2);
        self.rows.rows().into_iter().map(|row| (by * apart(row.iter(), whitened)).exp()).collect()
    }

    /// Targets at whitened scores, and the SDs of what would be measured about them.
    pub(crate) fn at(&self, whitened: &[f64]) -> (Vec<f64>, Vec<f64>) {
        (0..self.mean.len())
            .map(|target| {
                let mut alike = self.alike(whitened, target);
                let mean = self.mean[target] + alike.iter().zip(&self.weights[target]).map(|(a, w)| a * w).sum::<f64>();
                (mean, self.known_variance(&mut alike, target).sqrt())
            })
            .unzip()
    }

    /// Variance of a target's measured value, not widened, where all cells are known; `alike` is used up.
    fn known_variance(&self, alike: &mut [f64], target: usize) -> f64 {
        let one = self.covariances[target];
        one.amplitude.powi(2) * (1.0 + one.noise - self.factors[target].square(alike)).max(one.noise)
    }

    fn whitened(&self, scores: &[f64]) -> Vec<f64> {
        scores.iter().zip(&self.spread).map(|(score, spread)| score / spread).collect()
    }

    /// Targets at scores.
    pub(super) fn predict(&self, scores: &[f64], out: &mut [f64]) {
        let whitened = self.whitened(scores);
        for (target, out) in out.iter_mut().enumerate() {
            let alike = self.alike(&whitened, target);
            *out = self.mean[target] + alike.iter().zip(&self.weights[target]).map(|(a, w)| a * w).sum::<f64>();
        }
    }

    /// SD of a measured value about its prediction. Where cells are hidden, the mean variance and the variance of the
    /// mean over scores that spread as the covariance says (unscented: two points along each root of it).
    pub(super) fn sd(&self, at: &Projection, out: &mut [f64]) {
        let points = at.hidden.as_ref().map_or_else(Vec::new, |hidden| spread_points(&at.scores, hidden));
        let points = if points.is_empty() { vec![at.scores.clone()] } else { points };
        let all: Vec<(Vec<f64>, Vec<f64>)> = points.iter().map(|scores| self.at(&self.whitened(scores))).collect();
        let count = all.len() as f64;
        for (target, out) in out.iter_mut().enumerate() {
            let mean = all.iter().map(|(mean, _)| mean[target]).sum::<f64>() / count;
            let variance = all.iter().map(|(at, sd)| sd[target].powi(2) + (at[target] - mean).powi(2)).sum::<f64>();
            *out = self.covariances[target].widened * (variance / count).sqrt();
        }
    }

    /// d target / d score at scores, targets x modes.
    pub(super) fn slopes(&self, scores: &[f64]) -> Array2<f64> {
        let whitened = self.whitened(scores);
        let mut slopes = Array2::zeros((self.mean.len(), scores.len()));
        for target in 0..self.mean.len() {
            let by = 1.0 / self.covariances[target].length.powi(2);
            let alike = self.alike(&whitened, target);
            for ((row, alike), weight) in self.rows.rows().into_iter().zip(alike).zip(&self.weights[target]) {
                for (k, kept) in row.iter().enumerate() {
                    slopes[[target, k]] += weight * alike * by * (kept - whitened[k]) / self.spread[k];
                }
            }
        }
        slopes
    }
}

/// Points about scores that have a covariance, two along each of its roots; none where it has no root.
fn spread_points(scores: &[f64], covariance: &Array2<f64>) -> Vec<Vec<f64>> {
    let count = scores.len();
    let values: Vec<f64> = covariance.iter().copied().collect();
    let Some(root) = Cholesky::of(values, count, 0.0) else { return Vec::new() };
    let far = (count as f64).sqrt();
    let point = |k: usize, sign: f64| -> Vec<f64> {
        scores.iter().zip(root.row(k)).map(|(score, root)| score + sign * far * root).collect()
    };
    (0..count).flat_map(|k| [point(k, 1.0), point(k, -1.0)]).collect()
}

fn apart<'a>(a: impl Iterator<Item = &'a f64>, b: &[f64]) -> f64 {
    a.zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
}

/// Squared distances of all rows from each other, rows x rows.
pub(crate) fn squared_distances(rows: &Array2<f64>) -> Vec<f64> {
    let all: Vec<Vec<f64>> = rows.outer_iter().map(|row| row.to_vec()).collect();
    all.iter().flat_map(|a| all.iter().map(move |b| apart(a.iter(), b))).collect()
}

/// exp(-d^2 / (2 length^2)) of squared distances.
pub(crate) fn kernel(squared: &[f64], length: f64) -> Vec<f64> {
    let by = -0.5 / (length * length);
    squared.iter().map(|squared| (by * squared).exp()).collect()
}
