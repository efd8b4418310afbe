//! How far off predictions are, by the targets' names, as reports tell it.

use lunula_predictor::{Dataset, Predictor, Scores, TargetScore, predict, score};
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

/// A value for each target, in the targets' order; an object in JSON.
#[derive(Debug, Clone, PartialEq)]
pub struct ByTarget<T>(pub Vec<(String, T)>);

impl<T> ByTarget<T> {
    /// One value after the other.
    pub(in crate::predictor) fn new(names: &[String], values: impl IntoIterator<Item = T>) -> Self {
        Self(names.iter().cloned().zip(values).collect())
    }
}

impl<T: Serialize> Serialize for ByTarget<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for (name, value) in &self.0 {
            map.serialize_entry(name, value)?;
        }
        map.end()
    }
}

/// How far off predictions are; NaN (null in JSON) of no rows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Merit {
    /// Rows with a prediction.
    pub rows: usize,
    /// Rows whose prediction is beyond what a number can hold; they are not scored.
    pub not_finite: usize,
    /// Root of the mean squared error, the target's unit.
    pub rmse: ByTarget<f64>,
    /// Mean of predicted less measured, the target's unit.
    pub bias: ByTarget<f64>,
    /// Share of the variance explained; none where the target is constant.
    pub r2: ByTarget<Option<f64>>,
    /// Mean absolute error, the target's unit.
    pub mae: ByTarget<f64>,
}

/// Errors of rows of a size.
#[derive(Debug, Clone, Serialize)]
pub struct BinMerit {
    /// From here on.
    pub from: f64,
    /// Up to here.
    pub to: f64,
    /// Their errors.
    #[serde(flatten)]
    pub merit: Merit,
}

impl Merit {
    /// What to say of rows that are not scored.
    pub(in crate::predictor) fn warning(&self) -> Option<String> {
        let (lost, all) = (self.not_finite, self.rows + self.not_finite);
        (lost > 0).then(|| format!("{lost} of {all} rows have no finite prediction; errors are those of the others"))
    }
}

/// A model that explains a smaller share of what it was trained on follows nothing (assumed).
const HARDLY: f64 = 0.1;
/// Of fewer rows it may by chance.
const ROWS: usize = 10;

impl Merit {
    /// What to say of a model of which these are the figures on what it was trained on.
    pub(in crate::predictor) fn of_nothing(&self) -> Option<String> {
        let explained = self.r2.0.iter().filter_map(|(_, r2)| *r2).reduce(f64::max)?;
        (self.rows >= ROWS && explained < HARDLY).then(|| {
            format!(
                "the model explains hardly anything of what it was trained on (R2 {explained:.2} at most): does the \
                 finger press or bend in these recordings, and are the photodiodes on it?"
            )
        })
    }
}

impl From<&Scores> for Merit {
    fn from(scores: &Scores) -> Self {
        fn by<T>(scores: &Scores, value: fn(&TargetScore) -> T) -> ByTarget<T> {
            ByTarget(scores.targets.iter().map(|one| (one.name.clone(), value(one))).collect())
        }
        Self {
            rows: scores.rows,
            not_finite: scores.invalid,
            rmse: by(scores, |one| one.rmse),
            bias: by(scores, |one| one.bias),
            r2: by(scores, |one| one.r2),
            mae: by(scores, |one| one.mae),
        }
    }
}

/// How far off it is on recordings without its cone of friction: the model is the same.
pub(in crate::predictor) fn merit_without_cone(predictor: &Predictor, seen: &Dataset) -> Merit {
    let plain = predict(predictor.model(), None, seen.x().view());
    Merit::from(&score(seen.y().view(), plain.view(), seen.targets()))
}
