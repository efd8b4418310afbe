//! What to fit and how, in one value that a model file keeps: the same recipe is fitted again where rows are held out.
//!
//! In: a [`Dataset`] and a [`Recipe`]. Out: a [`Model`] with the report of its fit ([`Fitted`]). Networks stop early on
//! rows that they are not trained on; where none are given, [`stopping_rows`] sets aside a part of every recording.
//! Those rows are training rows all the same: what is reported has to come from others.

use std::borrow::Cow;
use std::fmt;

use ndarray::{Array2, ArrayView2};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::contact::friction::{FrictionCone, FrictionFault};
use crate::data::lags::{LagFault, Lags};
use crate::fit::{EigennailsReport, FitFault, FitReport, OnScores, fit_eigennails, fit_linear, fit_quadratic};
use crate::least_squares::{Deficient, LeastSquaresOptions};
use crate::network::{TrainFault, TrainOptions, TrainReport, train_network};
use crate::{Dataset, Model};

/// Which model (5.1.3 to 5.1.5, and from pictures).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// Equation 9.
    Linear,
    /// Equation 16.
    Quadratic,
    /// Equations 17 and 18 with so many hidden nodes.
    Network {
        /// N.
        hidden: usize,
    },
    /// Modes of the cells of a nail's picture.
    Eigennails {
        /// What is fitted to the scores.
        on_scores: OnScores,
        /// How many modes; none: as many as do best on rows left out.
        modes: Option<usize>,
    },
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Linear => f.write_str("linear"),
            Self::Quadratic => f.write_str("quadratic"),
            Self::Network { hidden } => write!(f, "network of {hidden}"),
            Self::Eigennails { .. } => f.write_str("eigennails"),
        }
    }
}

/// What to fit and how.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recipe {
    /// Linear, quadratic, a network or eigennails.
    pub kind: Kind,
    /// What to do where rows do not determine the linear or quadratic model.
    pub deficient: Deficient,
    /// Where a network's first weights come from.
    pub seed: u64,
    /// How many networks are trained, of which the best is taken.
    pub restarts: usize,
    /// How long a network is trained at most.
    pub max_epochs: usize,
    /// Voltages so many seconds ago are inputs as well.
    pub lags_s: Vec<f64>,
    /// Forces are brought into the cone of this coefficient of friction.
    pub friction_mu: Option<f64>,
}

/// What a fit gives.
#[derive(Debug, Clone)]
pub struct Fitted {
    /// Without the names of its columns.
    pub model: Model,
    /// How the fit went.
    pub report: Report,
}

/// How a fit went.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Report {
    /// Of the linear and the quadratic model.
    LeastSquares(FitReport),
    /// Of the network.
    Network(TrainReport),
    /// Of eigennails.
    Eigennails(EigennailsReport),
}

/// Why nothing was fitted.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum RecipeFault {
    #[error(transparent)]
    Fit(#[from] FitFault),
    #[error(transparent)]
    Train(#[from] TrainFault),
    #[error(transparent)]
    Lags(#[from] LagFault),
    #[error("a cone of friction needs the targets Fx_N, Fy_N, Fz_N; the targets are {0}")]
    NoForces(String),
    #[error("eigennails read one picture at a time: leave out the lags")]
    NoLags,
    #[error(transparent)]
    Friction(#[from] FrictionFault),
}

/// The forces, in the order that everything here has them.
pub const FORCES: [&str; 3] = ["Fx_N", "Fy_N", "Fz_N"];

impl Recipe {
    /// The thesis' own way to fit a model of a kind.
    #[must_use]
    pub fn new(kind: Kind) -> Self {
        let training = TrainOptions::default();
        Self {
            kind,
            deficient: Deficient::Refuse,
            seed: training.seed,
            restarts: training.restarts,
            max_epochs: training.max_epochs,
            lags_s: Vec::new(),
            friction_mu: None,
        }
    }

    /// The lags of rows as these; none where none are asked for.
    ///
    /// # Errors
    /// Lags that can't be, or rows without times.
    pub fn lags(&self, data: &Dataset) -> Result<Option<Lags>, RecipeFault> {
        if matches!(self.kind, Kind::Eigennails { .. }) && !self.lags_s.is_empty() {
            return Err(RecipeFault::NoLags);
        }
        Ok((!self.lags_s.is_empty()).then(|| Lags::of(self.lags_s.clone(), data)).transpose()?)
    }

    /// The cone that predictions are brought into.
    ///
    /// # Errors
    /// Other targets than the three forces, or a coefficient that can't be.
    pub fn cone(&self, targets: &[String]) -> Result<Option<FrictionCone>, RecipeFault> {
        let Some(mu) = self.friction_mu else { return Ok(None) };
        if targets.iter().ne(FORCES) {
            return Err(RecipeFault::NoForces(targets.join(", ")));
        }
        Ok(Some(FrictionCone::new(mu)?))
    }

    /// Fits to rows that have their lags already ([`with_lags`]); a network stops early on `stop`, or on a part of the
    /// rows. Without standard errors.
    pub fn fit(&self, data: &Dataset, stop: Option<&Dataset>) -> Result<Fitted, RecipeFault> {
        self.fit_with(data, stop, false)
    }

    /// The same, with standard errors of the linear and the quadratic model where asked for.
    pub(super) fn fit_with(
        &self,
        data: &Dataset,
        stop: Option<&Dataset>,
        standard_errors: bool,
    ) -> Result<Fitted, RecipeFault> {
        let options =
            LeastSquaresOptions { deficient: self.deficient, standard_errors, ..LeastSquaresOptions::default() };
        Ok(match self.kind {
            Kind::Linear => {
                let (model, report) = fit_linear(data, &options)?;
                Fitted { model: Model::Linear(model), report: Report::LeastSquares(report) }
            }
            Kind::Quadratic => {
                let (model, report) = fit_quadratic(data, &options)?;
                Fitted { model: Model::Quadratic(model), report: Report::LeastSquares(report) }
            }
            Kind::Network { hidden } => {
                let training = TrainOptions {
                    hidden,
                    seed: self.seed,
                    restarts: self.restarts,
                    max_epochs: self.max_epochs,
                    ..TrainOptions::default()
                };
                let (model, report) = match (stop, stopping_rows(data)) {
                    (Some(stop), _) => train_network(data, Some(stop), &training)?,
                    (None, Some((train, stop))) => train_network(&train, Some(&stop), &training)?,
                    (None, None) => train_network(data, None, &training)?,
                };
                Fitted { model: Model::Network(model), report: Report::Network(report) }
            }
            Kind::Eigennails { on_scores, modes } => {
                let (model, report) = fit_eigennails(data, on_scores, modes)?;
                Fitted { model: Model::Eigennails(model), report: Report::Eigennails(report) }
            }
        })
    }
}

/// Rows as a model sees them: with lags as additional inputs, without the rows that lack the history for them.
///
/// # Errors
/// Rows of which none has enough history.
pub fn with_lags<'a>(data: &'a Dataset, lags: Option<&Lags>) -> Result<Cow<'a, Dataset>, RecipeFault> {
    Ok(match lags {
        Some(lags) => Cow::Owned(lags.expand(data)?.data),
        None => Cow::Borrowed(data),
    })
}

/// Blocks that a recording is cut into, and which of five that follow each other is set aside.
const BLOCKS: usize = 20;
const OF_FIVE: usize = 2;

/// Parts rows into those that a network is trained on and those that it stops on: every recording is cut into 20 blocks
/// of time, every fifth of which is set aside, so that both parts hold small and large forces. None where recordings
/// are too short for that.
#[must_use]
pub fn stopping_rows(data: &Dataset) -> Option<(Dataset, Dataset)> {
    let (mut train, mut stop) = (Vec::new(), Vec::new());
    for one in data.recordings() {
        let rows = one.rows.len();
        for row in one.rows.clone() {
            let block = (row - one.rows.start) * BLOCKS / rows;
            if block % 5 == OF_FIVE { &mut stop } else { &mut train }.push(row);
        }
    }
    (!stop.is_empty() && !train.is_empty()).then(|| (data.only_rows(&train), data.only_rows(&stop)))
}

/// Predicts rows that have their lags already, bringing forces (in [`FORCES`]' order, as [`Recipe::cone`] has it) into
/// a cone where there is one.
#[must_use]
pub fn predict(model: &Model, cone: Option<&FrictionCone>, x: ArrayView2<'_, f64>) -> Array2<f64> {
    let mut predicted = model.predict(x);
    if let Some(cone) = cone {
        for mut row in predicted.rows_mut() {
            let nearest = cone.nearest([row[0], row[1], row[2]]);
            row.iter_mut().zip(nearest).for_each(|(value, nearest)| *value = nearest);
        }
    }
    predicted
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Array2;

    #[test]
    fn a_fifth_of_the_time_of_every_recording_is_set_aside() {
        let rows = 200;
        let x = Array2::from_shape_fn((rows, 1), |(row, _)| row as f64);
        let data = Dataset::plain(vec!["P1".into()], vec!["J2_deg".into()], x.clone(), x, 0.04).unwrap();
        let (train, stop) = stopping_rows(&data).unwrap();
        assert_eq!((train.rows(), stop.rows()), (160, 40));
        assert_eq!(stop.x().column(0).to_vec()[..11].last(), Some(&70.0));
        assert!(stopping_rows(&data.only_rows(&[3])).is_none());
    }
}
