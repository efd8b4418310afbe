//! Model files: versioned JSON, readable, exact. Out: text; in: a [`Predictor`], or why the text is none.
//!
//! Every number is written with as many digits as bring back the same `f64`. A file holds names, units, coefficients,
//! the training rows' hash and ranges, and a checksum of all that: a file that was edited by hand and still fits is
//! used, and says so ([`Opened::edited`]); one that does not fit (sizes, names, numbers, another version, unknown keys)
//! is refused.

use ndarray::Array2;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use thiserror::Error;

use super::recipe::Kind;
use super::{Channel, Predictor, Training, fits};
use crate::data::lags::Lags;
use crate::evaluate::{Intervals, hex};
use crate::{
    Basis, Covariance, Eigennails, Linear, Model, ModelFault, Network, OnScores, Process, Quadratic, Regression, Ridge,
};

/// What a model file calls itself.
const FORMAT: &str = "lunula predictor";
/// The version that is written and read.
const VERSION: u64 = 1;
/// The most rows that a process of a file keeps: reading it takes the square of them in memory, the cube in time.
const MOST_KEPT: usize = 2000;

/// Why a text is no model.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum FileFault {
    #[error("is not a model file: {0}; train the model again")]
    Json(#[from] serde_json::Error),
    #[error("is no model of lunula (its \"format\" is {0}); name a file that `lunula train` wrote")]
    Format(String),
    #[error(
        "is a model file of version {found}, and this program reads version {VERSION}; train the model again or use \
         the program that wrote it"
    )]
    Version { found: String },
    #[error("does not fit together: {0}; it was edited or damaged: train the model again")]
    Model(#[from] ModelFault),
    #[error("does not fit together: {0}; it was edited or damaged: train the model again")]
    Other(String),
}

/// A model file, read.
#[derive(Debug, Clone, PartialEq)]
pub struct Opened {
    /// What the file holds.
    pub predictor: Predictor,
    /// The file was edited after it was written: what it says of its training need not be true of its numbers.
    pub edited: bool,
    /// The checksum of what it holds, hexadecimal; in a file that was not edited its `sha256`.
    pub sha256: String,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct File<M> {
    format: String,
    version: u64,
    made_by: String,
    inputs: Vec<Channel>,
    targets: Vec<Channel>,
    lags: Option<Lags>,
    model: M,
    intervals: Option<Intervals>,
    training: Training,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    sha256: Option<String>,
}

/// A model's numbers, read: what the parts of a [`Model`] are written as.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase", deny_unknown_fields)]
enum Numbers {
    Linear {
        centre: Vec<f64>,
        offset: Vec<f64>,
        jacobian: Vec<Vec<f64>>,
    },
    Quadratic {
        centre: Vec<f64>,
        scale: Vec<f64>,
        offset: Vec<f64>,
        jacobian: Vec<Vec<f64>>,
    },
    Network {
        centre: Vec<f64>,
        scale: Vec<f64>,
        hidden_weights: Vec<Vec<f64>>,
        hidden_biases: Vec<f64>,
        output_weights: Vec<Vec<f64>>,
        output_biases: Vec<f64>,
        target_centre: Vec<f64>,
        target_scale: Vec<f64>,
    },
    Eigennails {
        mean: Vec<f64>,
        modes: Vec<Vec<f64>>,
        spread: Vec<f64>,
        noise: f64,
        ranges: Vec<[f64; 2]>,
        on_scores: Scored,
    },
}

/// What eigennails have on their scores.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(rename_all = "lowercase", deny_unknown_fields)]
enum Scored {
    Ridge { coefficients: Vec<Vec<f64>>, offset: Vec<f64>, lambda: Vec<f64>, residual_sd: Vec<f64>, rows: usize },
    Process { rows: Vec<Vec<f64>>, targets: Vec<Vec<f64>>, covariances: Vec<Covariance> },
}

impl Predictor {
    /// The text of a model file, with a line feed at its end.
    #[must_use]
    pub fn to_json(&self) -> String {
        let mut file = File {
            format: FORMAT.to_owned(),
            version: VERSION,
            made_by: concat!("lunula-predictor ", env!("CARGO_PKG_VERSION")).to_owned(),
            inputs: self.inputs.clone(),
            targets: self.targets.clone(),
            lags: self.lags.clone(),
            model: &self.model,
            intervals: self.intervals.clone(),
            training: self.training.clone(),
            sha256: None,
        };
        file.sha256 = Some(checksum(&file));
        serde_json::to_string_pretty(&file).expect("plain data with names as keys") + "\n"
    }

    /// Reads the text of a model file.
    pub fn from_json(text: &str) -> Result<Opened, FileFault> {
        if !text.trim_start().starts_with('{') {
            // A table, say: what is wrong with it as JSON helps nobody.
            return Err(FileFault::Format("missing".to_owned()));
        }
        let any: serde_json::Value = serde_json::from_str(text)?;
        let format = any.get("format").map_or("missing".to_owned(), ToString::to_string);
        if any.get("format").and_then(|format| format.as_str()) != Some(FORMAT) {
            return Err(FileFault::Format(format));
        }
        if any.get("version").and_then(serde_json::Value::as_u64) != Some(VERSION) {
            let found = any.get("version").map_or("missing".to_owned(), ToString::to_string);
            return Err(FileFault::Version { found });
        }
        // From the text, not from the value: the place of a fault stays known.
        let mut file: File<Numbers> = serde_json::from_str(text)?;
        let stated = file.sha256.take();
        let sha256 = checksum(&file);
        let edited = stated.is_none_or(|stated| stated != sha256);
        let model = file.model.clone().model()?;
        check(&model, &file)?;
        let names: Vec<String> = file.targets.iter().map(|channel| channel.name.clone()).collect();
        let cone = file.training.recipe.cone(&names).map_err(|fault| FileFault::Other(fault.to_string()))?;
        let File { inputs, targets, training, intervals, lags, .. } = file;
        Ok(Opened { predictor: Predictor { model, inputs, targets, training, intervals, lags, cone }, edited, sha256 })
    }
}

/// Of all but itself, in the order and spelling that is written.
fn checksum<M: Serialize>(file: &File<M>) -> String {
    let text = serde_json::to_string(file).expect("plain data with names as keys");
    hex(Sha256::new_with_prefix(text))
}

/// Whether the parts of a file belong together.
fn check(model: &Model, file: &File<Numbers>) -> Result<(), FileFault> {
    let File { inputs, targets, training, intervals, lags, .. } = file;
    let other = |what: String| Err(FileFault::Other(what));
    let lags_s = lags.as_ref().map_or(&[][..], Lags::lags_s);
    if lags_s != training.recipe.lags_s {
        return other("the lags are not the recipe's".to_owned());
    }
    fits(model, inputs.len() * (1 + lags_s.len()), targets.len())?;
    let all: Vec<&Channel> = inputs.iter().chain(targets).collect();
    for (k, channel) in all.iter().enumerate() {
        if channel.name.is_empty() {
            return other("a column has no name".to_owned());
        }
        if all[..k].iter().any(|before| before.name == channel.name) {
            return other(format!("two columns are named {}", channel.name));
        }
        if channel.low > channel.high {
            return other(format!("the range of {} is upside down", channel.name));
        }
    }
    let same = matches!(
        (training.recipe.kind, model),
        (Kind::Linear, Model::Linear(_))
            | (Kind::Quadratic, Model::Quadratic(_))
            | (Kind::Network { .. }, Model::Network(_))
    ) || matches!(
        (training.recipe.kind, model),
        (Kind::Eigennails { on_scores, .. }, Model::Eigennails(model))
            if matches!(
                (on_scores, model.regression()),
                (OnScores::Ridge, Regression::Ridge(_)) | (OnScores::Process, Regression::Process(_))
            )
    );
    if !same {
        return other("the recipe is of another kind than the model".to_owned());
    }
    if let (Kind::Network { hidden }, Model::Network(network)) = (training.recipe.kind, model)
        && hidden != network.hidden()
    {
        return other(format!("the recipe has {hidden} hidden nodes, the model {}", network.hidden()));
    }
    let Some(Intervals { level, half_width, .. }) = intervals else { return Ok(()) };
    if half_width.len() != targets.len() {
        return other(format!("{} intervals for {} targets", half_width.len(), targets.len()));
    }
    if let Some(half) = half_width.iter().find(|half| **half < 0.0) {
        return other(format!("an interval's half width is {half}"));
    }
    if !(0.0..=1.0).contains(level) {
        return other(format!("intervals for a share of {level} of the rows"));
    }
    Ok(())
}

impl Numbers {
    fn model(self) -> Result<Model, ModelFault> {
        Ok(match self {
            Self::Linear { centre, offset, jacobian } => {
                let jacobian = matrix("jacobian", &jacobian, centre.len())?;
                Model::Linear(Linear::new(centre, offset, jacobian)?)
            }
            Self::Quadratic { centre, scale, offset, jacobian } => {
                let terms = centre.len() + centre.len() * (centre.len() + 1) / 2;
                let jacobian = matrix("jacobian", &jacobian, terms)?;
                Model::Quadratic(Quadratic::new(centre, scale, offset, jacobian)?)
            }
            Self::Network {
                centre,
                scale,
                hidden_weights,
                hidden_biases,
                output_weights,
                output_biases,
                target_centre,
                target_scale,
            } => {
                let hidden_weights = matrix("hidden_weights", &hidden_weights, centre.len())?;
                let output_weights = matrix("output_weights", &output_weights, hidden_biases.len())?;
                Model::Network(Network::new(
                    centre,
                    scale,
                    hidden_weights,
                    hidden_biases,
                    output_weights,
                    output_biases,
                    target_centre,
                    target_scale,
                )?)
            }
            Self::Eigennails { mean, modes, spread, noise, ranges, on_scores } => {
                let modes = matrix("modes", &modes, mean.len())?;
                let on_scores = on_scores.regression(&spread)?;
                Model::Eigennails(Eigennails::new(Basis::new(mean, modes, spread, noise)?, on_scores, ranges)?)
            }
        })
    }
}

impl Scored {
    fn regression(self, spread: &[f64]) -> Result<Regression, ModelFault> {
        Ok(match self {
            Self::Ridge { coefficients, offset, lambda, residual_sd, rows } => {
                let coefficients = matrix("coefficients", &coefficients, spread.len())?;
                Regression::Ridge(Ridge::new(coefficients, offset, lambda, residual_sd, rows, spread)?)
            }
            Self::Process { rows, targets, covariances } => {
                if rows.len() > MOST_KEPT {
                    return Err(ModelFault::Shape { what: "rows of a process", found: rows.len(), wanted: MOST_KEPT });
                }
                let targets = matrix("targets", &targets, covariances.len())?;
                Regression::Process(Process::new(matrix("rows", &rows, spread.len())?, targets, covariances, spread)?)
            }
        })
    }
}

fn matrix(what: &'static str, rows: &[Vec<f64>], columns: usize) -> Result<Array2<f64>, ModelFault> {
    if let Some(row) = rows.iter().find(|row| row.len() != columns) {
        return Err(ModelFault::Shape { what, found: row.len(), wanted: columns });
    }
    Ok(Array2::from_shape_fn((rows.len(), columns), |(row, column)| rows[row][column]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Dataset, Recipe};

    #[test]
    fn intervals_that_can_not_be_are_refused() {
        let x = Array2::from_shape_fn((9, 1), |(row, _)| row as f64);
        let data = Dataset::plain(vec!["P1".into()], vec!["J2_deg".into()], x.clone(), x, 0.04).unwrap();
        let model = Predictor::fit(&data, None, &Recipe::new(Kind::Linear)).unwrap();
        let read = |level, half: f64| {
            let intervals = Some(Intervals { level, half_width: vec![half], rows: 9 });
            Predictor::from_json(&model.clone().with_intervals(intervals, &data).to_json())
        };
        assert!(!read(0.9, 1.5).unwrap().edited);
        for (level, half, what) in [(0.9, -1.0, "half width is -1"), (7.0, 1.0, "a share of 7 of the rows")] {
            let said = read(level, half).unwrap_err().to_string();
            assert!(said.contains(what), "{said}");
        }
    }
}
