//! Force or posture from the whole picture of the nail: scores on its modes (eigennails), and a regression on them
//! (Sun, Hollerbach and Mascaro, EigenNail for finger force direction recognition, ICRA 2007).
//!
//! In: a row of cells, area averages of the normalized nail, in any one unit; NaN where hidden. Out: each target, and
//! the SD of what would be measured about it, which hidden cells widen. A row with fewer than half of its cells has
//! neither.

mod basis;
mod process;
mod ridge;

use ndarray::{Array2, ArrayView2, ArrayViewMut2};
use serde::Serialize;

use super::{ModelFault, finite, sizes};
pub use basis::{Basis, Projection};
pub use process::{Covariance, Process};
pub(crate) use process::{kernel, squared_distances};
pub use ridge::Ridge;

/// By how much of their range scores may lie beyond that of the training rows before a row is called outside: noise
/// alone takes some there; assumed.
const BEYOND: f64 = 0.1;

/// From scores to targets.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Regression {
    /// Linear, shrunk.
    Ridge(Ridge),
    /// A Gaussian process.
    Process(Process),
}

/// Modes of the nail and a regression on their scores.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Eigennails {
    #[serde(flatten)]
    basis: Basis,
    /// Lowest and highest score of the training rows, a mode each.
    ranges: Vec<[f64; 2]>,
    #[serde(rename = "on_scores")]
    regression: Regression,
}

impl Eigennails {
    /// `ranges`: the lowest and the highest score of the training rows, a mode each.
    pub fn new(basis: Basis, regression: Regression, ranges: Vec<[f64; 2]>) -> Result<Self, ModelFault> {
        let modes = match &regression {
            Regression::Ridge(ridge) => ridge.coefficients.ncols(),
            Regression::Process(process) => process.rows.ncols(),
        };
        sizes(&[("modes", modes, basis.spread().len()), ("ranges", ranges.len(), basis.spread().len())])?;
        finite(&[("ranges", ranges.as_flattened())])?;
        Ok(Self { basis, regression, ranges })
    }

    /// The modes.
    #[must_use]
    pub fn basis(&self) -> &Basis {
        &self.basis
    }

    /// From their scores to the targets.
    #[must_use]
    pub fn regression(&self) -> &Regression {
        &self.regression
    }

    /// How many cells it reads.
    #[must_use]
    pub fn inputs(&self) -> usize {
        self.basis.mean().len()
    }

    /// Number of targets.
    #[must_use]
    pub fn targets(&self) -> usize {
        match &self.regression {
            Regression::Ridge(ridge) => ridge.offset.len(),
            Regression::Process(process) => process.covariances.len(),
        }
    }

    /// The mean of each cell.
    #[must_use]
    pub fn centre(&self) -> &[f64] {
        self.basis.mean()
    }

    /// One row: `x` cells, NaN where hidden; `out` each target, NaN where too few cells are known.
    ///
    /// # Panics
    /// Where the lengths are not the model's.
    pub fn predict_row(&self, x: &[f64], out: &mut [f64]) {
        assert_eq!(out.len(), self.targets(), "a row of the model's size");
        match self.basis.project(x) {
            None => out.fill(f64::NAN),
            Some(at) => match &self.regression {
                Regression::Ridge(ridge) => ridge.predict(&at.scores, out),
                Regression::Process(process) => process.predict(&at.scores, out),
            },
        }
    }

    /// The SD of what would be measured about each prediction of a row, the targets' units.
    ///
    /// # Panics
    /// Where the lengths are not the model's.
    pub fn sd_row(&self, x: &[f64], out: &mut [f64]) {
        assert_eq!(out.len(), self.targets(), "a row of the model's size");
        match self.basis.project(x) {
            None => out.fill(f64::NAN),
            Some(at) => match &self.regression {
                Regression::Ridge(ridge) => ridge.sd(&at, out),
                Regression::Process(process) => process.sd(&at, out),
            },
        }
    }

    /// Many rows: `x` rows x cells, `out` rows x targets.
    ///
    /// # Panics
    /// Where the sizes are not the model's.
    pub fn predict_into(&self, x: ArrayView2<'_, f64>, out: ArrayViewMut2<'_, f64>) {
        each_row(x, out, |x, out| self.predict_row(x, out));
    }

    /// Many rows: rows x cells to rows x targets.
    ///
    /// # Panics
    /// Where the sizes are not the model's.
    #[must_use]
    pub fn predict(&self, x: ArrayView2<'_, f64>) -> Array2<f64> {
        let mut out = Array2::zeros((x.nrows(), self.targets()));
        self.predict_into(x, out.view_mut());
        out
    }

    /// The SD about each prediction of many rows, rows x targets.
    ///
    /// # Panics
    /// Where the sizes are not the model's.
    #[must_use]
    pub fn sd(&self, x: ArrayView2<'_, f64>) -> Array2<f64> {
        let mut out = Array2::zeros((x.nrows(), self.targets()));
        each_row(x, out.view_mut(), |x, out| self.sd_row(x, out));
        out
    }

    /// d target / d cell at a row of cells, targets x cells; NaN where too few cells are known.
    ///
    /// # Panics
    /// Where the length is not the model's.
    #[must_use]
    pub fn jacobian_at(&self, x: &[f64]) -> Array2<f64> {
        let Some(at) = self.basis.project(x) else {
            return Array2::from_elem((self.targets(), self.inputs()), f64::NAN);
        };
        let slopes = match &self.regression {
            Regression::Ridge(ridge) => ridge.coefficients.clone(),
            Regression::Process(process) => process.slopes(&at.scores),
        };
        slopes.dot(self.basis.modes())
    }

    /// Whether a row of cells lies outside of what was trained on: a score more than a tenth of its range beyond.
    #[must_use]
    pub fn is_outside(&self, x: &[f64]) -> bool {
        let far = |(score, [low, high]): (&f64, &[f64; 2])| {
            let room = BEYOND * (high - low);
            *score < low - room || *score > high + room
        };
        self.basis.project(x).is_some_and(|at| at.scores.iter().zip(&self.ranges).any(far))
    }
}

fn each_row(x: ArrayView2<'_, f64>, mut out: ArrayViewMut2<'_, f64>, mut answer: impl FnMut(&[f64], &mut [f64])) {
    assert_eq!(x.nrows(), out.nrows(), "as many rows out as in");
    let mut values = vec![0.0; out.ncols()];
    for (x, mut out) in x.rows().into_iter().zip(out.rows_mut()) {
        answer(&x.to_vec(), &mut values);
        out.iter_mut().zip(&values).for_each(|(out, value)| *out = *value);
    }
}

/// The variance that a covariance of the scores gives a target of these slopes; 0 without one.
fn spread_along(slopes: &[f64], covariance: Option<&Array2<f64>>) -> f64 {
    let Some(covariance) = covariance else { return 0.0 };
    let row = |(i, slope): (usize, &f64)| {
        slope * slopes.iter().enumerate().map(|(j, other)| other * covariance[[i, j]]).sum::<f64>()
    };
    slopes.iter().enumerate().map(row).sum::<f64>().max(0.0)
}
