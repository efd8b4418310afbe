//! Targets from voltages: the linear (equation 9), quadratic (16) and network (17, 18) models; from the cells of a
//! nail's picture: eigennails.
//!
//! All answer a row or many, into the caller's memory and without allocating. A row and a batch give the same bits, on
//! every processor. A NaN among a row's voltages gives NaN for all its targets; an infinite one never gives a number.
//! Only eigennails take a NaN for a cell that is hidden, and allocate.

mod block;
mod eigennails;
mod linear;
mod network;
mod quadratic;
mod tansig;
#[cfg(test)]
mod tests;

use ndarray::{Array2, ArrayView2, ArrayViewMut2};
use serde::{Serialize, Serializer};
use thiserror::Error;

pub use eigennails::{Basis, Covariance, Eigennails, Process, Projection, Regression, Ridge};
pub(crate) use eigennails::{kernel, squared_distances};
pub use linear::Linear;
pub use network::Network;
pub use quadratic::{Quadratic, quadratic_terms};
pub(crate) use tansig::tansig;

/// A model, fitted. What is written of it is what a model file has: equations 9, 16, 17 and 18 with the centres that
/// they are kept with.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum Model {
    /// Equation 9.
    Linear(Linear),
    /// Equation 16.
    Quadratic(Quadratic),
    /// Equations 17 and 18.
    Network(Network),
    /// Modes of a nail's picture.
    Eigennails(Eigennails),
}

macro_rules! each {
    ($model:expr, $one:ident => $answer:expr) => {
        match $model {
            Model::Linear($one) => $answer,
            Model::Quadratic($one) => $answer,
            Model::Network($one) => $answer,
            Model::Eigennails($one) => $answer,
        }
    };
}

impl Model {
    /// How many photodiodes or cells it reads.
    #[must_use]
    pub fn inputs(&self) -> usize {
        each!(self, one => one.inputs())
    }

    /// Number of targets.
    #[must_use]
    pub fn targets(&self) -> usize {
        each!(self, one => one.targets())
    }

    /// m: the voltages that it was centred on, the means of the training rows.
    #[must_use]
    pub fn centre(&self) -> &[f64] {
        each!(self, one => one.centre())
    }

    /// One row: `x` volts of each input, `out` each target.
    ///
    /// # Panics
    /// Where the lengths are not the model's.
    pub fn predict_row(&self, x: &[f64], out: &mut [f64]) {
        each!(self, one => one.predict_row(x, out));
    }

    /// Many rows, of any layout (rows one after the other are fastest): `x` rows x inputs, volts; `out` rows x targets.
    ///
    /// # Panics
    /// Where the sizes are not the model's.
    pub fn predict_into(&self, x: ArrayView2<'_, f64>, out: ArrayViewMut2<'_, f64>) {
        each!(self, one => one.predict_into(x, out));
    }

    /// Many rows: rows x inputs, volts, to rows x targets.
    ///
    /// # Panics
    /// Where the sizes are not the model's.
    #[must_use]
    pub fn predict(&self, x: ArrayView2<'_, f64>) -> Array2<f64> {
        each!(self, one => one.predict(x))
    }

    /// d target / d volt at `x` volts, targets x inputs.
    ///
    /// # Panics
    /// Where the length is not the model's.
    #[must_use]
    pub fn jacobian_at(&self, x: &[f64]) -> Array2<f64> {
        each!(self, one => one.jacobian_at(x))
    }
}

/// The predictions of a model that has a [`block::Kernel`].
macro_rules! predicting {
    ($model:ident) => {
        impl $model {
            /// m, volts, an input each.
            #[must_use]
            pub fn centre(&self) -> &[f64] {
                &self.centre
            }

            /// How many photodiodes it reads.
            #[must_use]
            pub fn inputs(&self) -> usize {
                $crate::model::block::Kernel::inputs(self)
            }

            /// Number of targets.
            #[must_use]
            pub fn targets(&self) -> usize {
                $crate::model::block::Kernel::targets(self)
            }

            /// One row: `x` volts of each input, `out` each target.
            ///
            /// # Panics
            /// Where the lengths are not the model's.
            pub fn predict_row(&self, x: &[f64], out: &mut [f64]) {
                $crate::model::block::predict_row(self, x, out);
            }

            /// Many rows, of any layout (rows one after the other are fastest): `x` rows x inputs, volts; `out` rows x
            /// targets.
            ///
            /// # Panics
            /// Where the sizes are not the model's.
            pub fn predict_into(&self, x: ndarray::ArrayView2<'_, f64>, out: ndarray::ArrayViewMut2<'_, f64>) {
                $crate::model::block::predict_into(self, x, out);
            }

            /// Many rows: rows x inputs, volts, to rows x targets.
            ///
            /// # Panics
            /// Where the sizes are not the model's.
            #[must_use]
            pub fn predict(&self, x: ndarray::ArrayView2<'_, f64>) -> ndarray::Array2<f64> {
                let mut out = ndarray::Array2::zeros((x.nrows(), self.targets()));
                self.predict_into(x, out.view_mut());
                out
            }
        }
    };
}
use predicting;

fn rows<S: Serializer>(matrix: &Array2<f64>, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(matrix.outer_iter().map(|row| row.to_vec()))
}

/// Why numbers are no model.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum ModelFault {
    #[error("{what}: {found} where {wanted} are needed")]
    Shape { what: &'static str, found: usize, wanted: usize },
    #[error("{0} holds a number that can't be")]
    Number(&'static str),
}

/// Whether sizes agree: of what, found, wanted.
pub(crate) fn sizes(all: &[(&'static str, usize, usize)]) -> Result<(), ModelFault> {
    match all.iter().find(|(_, found, wanted)| found != wanted) {
        Some(&(what, found, wanted)) => Err(ModelFault::Shape { what, found, wanted }),
        None => Ok(()),
    }
}

fn finite(all: &[(&'static str, &[f64])]) -> Result<(), ModelFault> {
    match all.iter().find(|(_, values)| values.iter().any(|value| !value.is_finite())) {
        Some((what, _)) => Err(ModelFault::Number(what)),
        None => Ok(()),
    }
}

fn finite_matrix(what: &'static str, values: &Array2<f64>) -> Result<(), ModelFault> {
    if values.iter().all(|value| value.is_finite()) { Ok(()) } else { Err(ModelFault::Number(what)) }
}

/// 1 / scale, a positive finite number each (scales from 2^-1022 to 2^1022).
fn inverses(what: &'static str, scale: &[f64]) -> Result<Vec<f64>, ModelFault> {
    let inverse: Vec<f64> = scale.iter().map(|scale| 1.0 / scale).collect();
    let good = |value: &f64| value.is_normal() && *value > 0.0;
    if scale.iter().all(good) && inverse.iter().all(good) { Ok(inverse) } else { Err(ModelFault::Number(what)) }
}
