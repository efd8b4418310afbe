//! Predictors of touch force and posture (chapter 5): recordings in, models, predictions, figures of merit and pictures
//! out.
//!
//! The models and their mathematics are the crate `lunula-predictor`'s; here are the files and the jobs of the command
//! line, an entry each:
//! [`train()`], [`evaluate()`], [`predict()`], [`analyse()`], [`prune()`],
//! [`trajectory::run`].

mod data;
mod error;
mod figures;
mod jobs;
mod merit;
mod options;
mod outputs;
#[cfg(test)]
pub(crate) mod tests;
pub mod trajectory;

use std::path::PathBuf;

/// The crate that does the mathematics.
pub use lunula_predictor as models;
use lunula_predictor::{Dataset, Predictor, TrainedOn, recording_hashes};

pub use data::{
    DataError, DataFile, FailedFile, FileRows, Inputs, Read, RowOptions, Wanted, read_data, read_files, read_inputs,
};
pub(crate) use data::{cell, contradictions, missing};
pub use error::PredictorError;
pub use figures::{BarSeries, Bars, draw_bars};
pub use jobs::analyse::{AnalyseFigures, AnalyseReport, ModelMode, ModelModes, Printed, analyse, analyse_plan};
pub use jobs::answer::Answering;
pub(crate) use jobs::answer::contact_word;
pub use jobs::evaluate::{
    EvaluateFigures, EvaluateOptions, EvaluateReport, HeldOut, Magnitudes, Part, RecordingMerit, Splits, evaluate,
    evaluate_plan, way,
};
pub use jobs::kinds::AnalyseJob;
pub use jobs::predict::{PredictFigures, PredictOptions, PredictReport, predict, predict_plan};
pub use jobs::prune::{PruneFigures, PruneReport, PruneRow, prune, prune_plan};
pub use jobs::train::{TrainFigures, TrainInputs, TrainOptions, TrainOutputs, TrainReport, Without, train, train_plan};
pub(crate) use merit::doubts::extrapolated;
pub use merit::figures::{BinMerit, ByTarget, Merit};
pub use options::choices::{ByChoice, F_MIN_N, FOLDS, HIDDEN, LEVEL, ModelChoice, share};
pub use options::commands::{EvaluateChoices, GateChoices, NetworkOptions, PredictChoices, PruneChoices, TrainChoices};
pub use options::target::{POSTURE, Target};
pub use outputs::end;

pub(crate) struct OpenedModels {
    pub(crate) predictors: Vec<Predictor>,
    /// Each one's checksum.
    sha256: Vec<String>,
    pub(crate) warnings: Vec<String>,
}

impl OpenedModels {
    /// Models of samples, which come one by one.
    ///
    /// # Errors
    /// One that reads pictures.
    pub(crate) fn of_samples(self) -> Result<Self, PredictorError> {
        match self.predictors.iter().find(|one| one.eigennails().is_some()) {
            None => Ok(self),
            Some(one) => Err(PredictorError::Request(format!(
                "the model of {} reads cells of a nail's picture, and samples of a sensor have none; use `lunula \
                 predict` on a table of cells",
                one.target_names().join(", ")
            ))),
        }
    }

    pub(crate) fn sha256_of(&self, column: &str) -> Option<&str> {
        let mut each = self.predictors.iter().zip(&self.sha256);
        each.find_map(|(one, sha256)| one.target_names().iter().any(|name| name == column).then_some(sha256.as_str()))
    }

    /// The only one.
    fn one(mut self) -> (Predictor, Vec<String>) {
        (self.predictors.remove(0), self.warnings)
    }
}

pub(crate) fn open_models(paths: &[PathBuf]) -> Result<OpenedModels, PredictorError> {
    let mut opened = OpenedModels { predictors: Vec::new(), sha256: Vec::new(), warnings: Vec::new() };
    for path in paths {
        let text = crate::input::read_text(path).map_err(|why| PredictorError::Open { path: path.clone(), why })?;
        let found = Predictor::from_json(&text).map_err(|why| PredictorError::Model { path: path.clone(), why })?;
        if found.edited {
            opened.warnings.push(format!(
                "{}: was edited after it was trained; what it says of its training need not be true of its numbers",
                path.display()
            ));
        }
        opened.predictors.push(found.predictor);
        opened.sha256.push(found.sha256);
    }
    Ok(opened)
}

/// What to say of recordings that a model has seen, whose errors flatter.
fn seen_in_training(predictor: &Predictor, data: &Dataset) -> Vec<String> {
    let training = predictor.training();
    let seen = [
        (
            &training.recordings,
            "the model was trained on this; its errors flatter. Name recordings that it has not seen",
        ),
        (&training.stopped_on, "training was stopped by the errors on this; they flatter. Name other recordings"),
    ];
    seen.into_iter().filter_map(|(of, what)| Some(format!("{}: {what}", again(of, data)?))).collect()
}

/// What to say of recordings that a model's intervals were made from.
fn seen_by_intervals(predictor: &Predictor, data: &Dataset) -> Option<String> {
    let names = again(&predictor.training().calibrated_on, data)?;
    Some(format!(
        "{names}: the prediction intervals were made from this, and hold the share of its rows that was asked for"
    ))
}

/// The names of whole recordings that are among others.
pub(crate) fn again<'a>(others: impl IntoIterator<Item = &'a TrainedOn>, data: &Dataset) -> Option<String> {
    let others: Vec<&TrainedOn> = others.into_iter().collect();
    let is_one = |hash: &String| others.iter().any(|one| one.sha256 == *hash);
    let recordings = data.recordings().iter().zip(recording_hashes(data));
    let names: Vec<&str> = recordings.filter(|(_, hash)| is_one(hash)).map(|(one, _)| one.name.as_str()).collect();
    (!names.is_empty()).then(|| names.join(", "))
}
