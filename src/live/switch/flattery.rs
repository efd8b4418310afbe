//! Recordings that flatter a switch: given twice, or such as a model was trained on.

use std::slice;

use lunula_predictor::Predictor;

use super::options::ContactOptions;
use super::traces::SwitchInputs;
use crate::live::error::LiveError;
use crate::log::{AmbientRule, Columns, LogReading};
use crate::predictor::{DataFile, RowOptions, Wanted, again, open_models, read_files};
use crate::table::copies;

/// The target of a model of contact itself.
const CONTACT: &str = "contact";

/// What to say of them.
pub(super) fn flattery(inputs: &SwitchInputs, options: &ContactOptions) -> Result<Vec<String>, LiveError> {
    let SwitchInputs { recordings, models } = inputs;
    let mut said = copies(recordings.iter().map(|one| (one.name.clone(), one.path.as_path())).collect());
    for model in open_models(models)?.predictors {
        let seen: Vec<&str> =
            recordings.iter().filter(|one| is_seen(one, &model, options)).map(|one| one.name.as_str()).collect();
        if !seen.is_empty() {
            said.push(format!(
                "{}: the model was trained on this; the switch's figures flatter. Name recordings that it has not seen",
                seen.join(", ")
            ));
        }
    }
    Ok(said)
}

/// Whether a model was trained on a recording of a file, or its training stopped by one.
fn is_seen(recording: &DataFile, model: &Predictor, options: &ContactOptions) -> bool {
    let training = model.training();
    let is_log = options.log.is_log(&recording.path).unwrap_or_default();
    let of_contact = contact_as_target(options).filter(|_| is_log && model.target_names().iter().any(|t| t == CONTACT));
    let log = of_contact.unwrap_or_else(|| options.log.clone());
    // A switch has rows under one rule, and training may have had them under either.
    let rules = [AmbientRule::Interpolated, AmbientRule::Preceding];
    rules.into_iter().take(if is_log { 2 } else { 1 }).any(|rule| {
        let mut rows = RowOptions { keep_faults: options.keep_faults, log: log.clone(), ..RowOptions::default() };
        rows.log.ambient.rule = rule;
        let (inputs, targets) = (Some(model.input_names()), model.target_names());
        let wanted = Wanted { inputs, targets, rows, ..Wanted::default() };
        // What lacks a target was not trained on.
        let Ok(read) = read_files(slice::from_ref(recording), &wanted) else { return false };
        again(training.recordings.iter().chain(&training.stopped_on), &read.data).is_some()
    })
}

/// How logs are read whose columns nobody names: of these a model of contact learns only from a column that is named.
fn contact_as_target(options: &ContactOptions) -> Option<LogReading> {
    let ContactOptions { contact, log, .. } = options;
    let is_flag = contact.to_string() == contact.column;
    let column = if is_flag { contact.column.as_str() } else { CONTACT };
    let (mut named, mut unnamed) = (Columns::parse(&format!("{CONTACT}={column}")).ok()?, Columns::default());
    for columns in [&mut named, &mut unnamed] {
        columns.time_unit = log.columns.time_unit;
        columns.piece = log.columns.piece;
        columns.stream.clone_from(&log.columns.stream);
    }
    (log.columns == unnamed).then_some(LogReading { columns: named, ambient: log.ambient })
}
