//! A fitted model with all that is needed to use it on another day: names, units, ranges, what it was trained on, how
//! sure it is.

pub(crate) mod file;
pub(crate) mod recipe;

use std::borrow::Cow;

use ndarray::{Array2, Axis};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::contact::friction::FrictionCone;
use crate::data::lags::Lags;
use crate::evaluate::{Intervals, hex, recording_hashes};
use crate::model::sizes;
use crate::{Dataset, Eigennails, Kind, Model, ModelFault, Recording};
use recipe::{Recipe, RecipeFault, Report, predict, with_lags};

/// An input or target column of a model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Channel {
    /// Its column, such as `P1` or `Fz_N`.
    pub name: String,
    /// Its unit: V, N, deg, or empty where the name does not tell.
    pub unit: String,
    /// The lowest value of the training rows.
    pub low: f64,
    /// The highest value of the training rows.
    pub high: f64,
}

/// A recording that a model has seen.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrainedOn {
    /// Of the recording, as the dataset has it.
    pub name: String,
    /// Of which session.
    pub session: String,
    /// Of whom.
    pub subject: String,
    /// Rows.
    pub rows: usize,
    /// SHA-256 of the rows.
    pub sha256: String,
}

impl TrainedOn {
    /// All recordings of a dataset.
    fn all(data: &Dataset) -> Vec<Self> {
        let recordings = data.recordings().iter().zip(recording_hashes(data));
        let of = |(one, sha256): (&Recording, String)| Self {
            name: one.name.clone(),
            session: one.session.clone(),
            subject: one.subject.clone(),
            rows: one.rows.len(),
            sha256,
        };
        recordings.map(of).collect()
    }
}

/// What a model was trained on, and how it went.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Training {
    /// Rows.
    pub rows: usize,
    /// SHA-256 of the recordings' hashes, one after the other.
    pub sha256: String,
    /// Whence they come.
    pub recordings: Vec<TrainedOn>,
    /// Recordings that chose when a network's training stopped, and which start was kept.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub stopped_on: Vec<TrainedOn>,
    /// Recordings whose errors the prediction intervals were read from.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub calibrated_on: Vec<TrainedOn>,
    /// Recordings that were to be trained on and could not be read, by name.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub failed: Vec<String>,
    /// What was fitted, and how.
    pub recipe: Recipe,
    /// How it went.
    pub report: Report,
}

/// A model that can be saved and used.
#[derive(Debug, Clone, PartialEq)]
pub struct Predictor {
    pub(crate) model: Model,
    pub(crate) inputs: Vec<Channel>,
    pub(crate) targets: Vec<Channel>,
    pub(crate) training: Training,
    pub(crate) intervals: Option<Intervals>,
    pub(crate) lags: Option<Lags>,
    pub(crate) cone: Option<FrictionCone>,
}

impl Predictor {
    /// Fits a recipe to recordings; a network stops early on `stop`, or on a part of the rows.
    pub fn fit(data: &Dataset, stop: Option<&Dataset>, recipe: &Recipe) -> Result<Self, RecipeFault> {
        let cone = recipe.cone(data.targets())?;
        let lags = recipe.lags(data)?;
        let used = stop.filter(|_| matches!(recipe.kind, Kind::Network { .. }));
        let stopped_on = used.map(TrainedOn::all).unwrap_or_default();
        let stop = stop.map(|stop| with_lags(stop, lags.as_ref())).transpose()?;
        let seen = with_lags(data, lags.as_ref())?;
        let fitted = recipe.fit_with(&seen, stop.as_deref(), true)?;
        let recordings = TrainedOn::all(data);
        let training = Training {
            rows: data.rows(),
            sha256: hash_of(&recordings),
            recordings,
            stopped_on,
            calibrated_on: Vec::new(),
            failed: Vec::new(),
            recipe: recipe.clone(),
            report: fitted.report,
        };
        Ok(Self {
            model: fitted.model,
            inputs: channels(data.inputs(), data.x()),
            targets: channels(data.targets(), data.y()),
            training,
            intervals: None,
            lags,
            cone,
        })
    }

    /// Without what it was trained on.
    #[must_use]
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// What it reads, before lags.
    #[must_use]
    pub fn inputs(&self) -> &[Channel] {
        &self.inputs
    }

    /// In the order of the model's outputs.
    #[must_use]
    pub fn targets(&self) -> &[Channel] {
        &self.targets
    }

    /// Names of what it reads.
    #[must_use]
    pub fn input_names(&self) -> Vec<String> {
        self.inputs.iter().map(|channel| channel.name.clone()).collect()
    }

    /// Names of the targets.
    #[must_use]
    pub fn target_names(&self) -> Vec<String> {
        self.targets.iter().map(|channel| channel.name.clone()).collect()
    }

    /// What it was trained on.
    #[must_use]
    pub fn training(&self) -> &Training {
        &self.training
    }

    /// How far off it is on recordings that it was not trained on.
    #[must_use]
    pub fn intervals(&self) -> Option<&Intervals> {
        self.intervals.as_ref()
    }

    /// The same with intervals that were read from its errors on `data`.
    #[must_use]
    pub fn with_intervals(mut self, intervals: Option<Intervals>, data: &Dataset) -> Self {
        self.training.calibrated_on = if intervals.is_some() { TrainedOn::all(data) } else { Vec::new() };
        Self { intervals, ..self }
    }

    /// The same, trained without recordings that could not be read, by name.
    #[must_use]
    pub fn without(mut self, failed: Vec<String>) -> Self {
        self.training.failed = failed;
        self
    }

    /// Voltages of the past that it reads as well.
    #[must_use]
    pub fn lags(&self) -> Option<&Lags> {
        self.lags.as_ref()
    }

    /// The cone that its forces are brought into.
    #[must_use]
    pub fn cone(&self) -> Option<&FrictionCone> {
        self.cone.as_ref()
    }

    /// Names of what the model sees: what it reads, then each lag's.
    #[must_use]
    pub fn seen_names(&self) -> Vec<String> {
        let names = self.input_names();
        self.lags.as_ref().map_or(names.clone(), |lags| lags.names(&names))
    }

    /// The rows of recordings as the model sees them (with lags, without rows that lack the history), and what is
    /// predicted for them.
    ///
    /// # Errors
    /// No row with enough history.
    pub fn predict<'a>(&self, data: &'a Dataset) -> Result<(Cow<'a, Dataset>, Array2<f64>), RecipeFault> {
        let seen = with_lags(data, self.lags.as_ref())?;
        let predicted = predict(&self.model, self.cone.as_ref(), seen.x().view());
        Ok((seen, predicted))
    }

    /// One row as the model sees it (lags included), without allocation.
    ///
    /// # Panics
    /// Where the lengths are not the model's.
    pub fn predict_row(&self, x: &[f64], out: &mut [f64]) {
        self.model.predict_row(x, out);
        if let (Some(cone), &mut [fx, fy, fz]) = (&self.cone, &mut *out) {
            out.copy_from_slice(&cone.nearest([fx, fy, fz]));
        }
    }

    /// Whether a row may lack inputs: cells that are hidden.
    #[must_use]
    pub fn reads_hidden(&self) -> bool {
        matches!(self.model, Model::Eigennails(_))
    }

    /// Its eigennails, if that is what it is.
    #[must_use]
    pub fn eigennails(&self) -> Option<&Eigennails> {
        if let Model::Eigennails(model) = &self.model { Some(model) } else { None }
    }

    /// Whether a row of voltages (before lags) lies outside of what was trained on.
    #[must_use]
    pub fn is_outside(&self, x: &[f64]) -> bool {
        match &self.model {
            // Noise takes some cell of nearly every picture out of its range.
            Model::Eigennails(model) => model.is_outside(x),
            _ => self.is_beyond(x, 0.0),
        }
    }

    /// Whether it lies so far outside that nothing is to be done by the answer, as where a cable is loose: a voltage
    /// more than a tenth of its range beyond.
    #[must_use]
    pub fn is_far_outside(&self, x: &[f64]) -> bool {
        match &self.model {
            Model::Eigennails(model) => model.is_outside(x),
            _ => self.is_beyond(x, 0.1),
        }
    }

    fn is_beyond(&self, x: &[f64], share: f64) -> bool {
        self.inputs.iter().zip(x).any(|(channel, x)| {
            let most = share * (channel.high - channel.low);
            *x < channel.low - most || *x > channel.high + most
        })
    }
}

/// SHA-256 of recordings' hashes, one after the other.
fn hash_of(recordings: &[TrainedOn]) -> String {
    let hashes: String = recordings.iter().map(|one| one.sha256.as_str()).collect();
    hex(Sha256::new_with_prefix(hashes))
}

fn channels(names: &[String], values: &Array2<f64>) -> Vec<Channel> {
    let channel = |(name, column): (&String, ndarray::ArrayView1<'_, f64>)| Channel {
        name: name.clone(),
        unit: unit_of(name).to_owned(),
        low: column.iter().copied().fold(f64::INFINITY, f64::min),
        high: column.iter().copied().fold(f64::NEG_INFINITY, f64::max),
    };
    names.iter().zip(values.axis_iter(Axis(1))).map(channel).collect()
}

/// The unit in a column's name.
#[must_use]
pub fn unit_of(name: &str) -> &'static str {
    const ENDINGS: [(&str, &str); 4] = [("_N", "N"), ("_deg", "deg"), ("_V", "V"), ("_rad", "rad")];
    let photodiode = name.strip_prefix('P').is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_digit()));
    let unit = ENDINGS.into_iter().find(|(ending, _)| name.ends_with(ending)).map(|(_, unit)| unit);
    unit.unwrap_or(if photodiode { "V" } else { "" })
}

/// Whether a model of a size can stand with these columns.
pub(crate) fn fits(model: &Model, inputs: usize, targets: usize) -> Result<(), ModelFault> {
    sizes(&[("inputs of the model", model.inputs(), inputs), ("targets of the model", model.targets(), targets)])
}
