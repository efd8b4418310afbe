//! What a fit found, and how sure it is.

use std::path::PathBuf;

use lunula_hemodynamics::noise::Slow;
use lunula_hemodynamics::{Beside, Combination, Group, Rival, Stop};
use serde::Serialize;

use super::alone::Alone;
use crate::files::json_text;
use crate::job::Report;

/// A photodiode's offset and scaling.
#[derive(Debug, Clone, Serialize)]
pub struct FittedPhotodiode {
    /// The unit below it, counted from 1.
    pub unit: usize,
    /// The recordings that share it.
    pub recordings: Vec<String>,
    /// Their subjects; none where no subjects were named.
    pub subjects: Vec<String>,
    /// `V_0`, V.
    pub offset_v: f64,
    /// Its standard error.
    pub offset_standard_error_v: Option<f64>,
    /// `V_1`, V.
    pub scaling_v: f64,
    /// Its standard error.
    pub scaling_standard_error_v: Option<f64>,
    /// RMS of its residuals, V.
    pub residual_rms_v: f64,
}

/// A recording as it was read.
#[derive(Debug, Clone, Serialize)]
pub struct RecordingReport {
    /// What tables and pictures call it.
    pub name: String,
    /// The file.
    pub file: PathBuf,
    /// Whose.
    pub subject: String,
    /// `over time` or `static`.
    pub kind: &'static str,
    /// Its rows.
    pub samples: usize,
    /// Its photodiodes.
    pub photodiodes: Vec<String>,
    /// Photodiodes' cells that are empty.
    pub missing: usize,
    /// Photodiodes' cells that are left out, as the sensor had a fault there: saturated, or without ambient light.
    pub faults: usize,
    /// How a log was read, and its ambient light subtracted.
    pub notes: Vec<String>,
    /// RMS of measured less fitted, V, a photodiode each.
    pub residual_rms_v: Vec<Option<f64>>,
    /// SD of the noise by which the fit weighs it, V, a photodiode each: as given, or estimated from the residuals.
    pub noise_v: Vec<f64>,
    /// What that noise is, a photodiode each: white, or slow or a pulse too, their SDs in that of the white.
    pub noise: Vec<String>,
    /// By how much its photodiodes come after its loads, s, and the standard error; none where nothing shows it.
    pub delay_s: Option<[f64; 2]>,
}

/// What a fit found.
pub type FitReport = Report<FitFigures>;

/// The figures of a fit.
#[derive(Debug, Clone, Serialize)]
pub struct FitFigures {
    /// The recordings.
    pub recordings: Vec<RecordingReport>,
    /// Why the fit stopped.
    pub stopped: &'static str,
    /// Whether it stopped because there was nothing left to gain.
    pub converged: bool,
    /// The free groups.
    pub free: Vec<Group>,
    /// What each person's recordings give by themselves, and each of several recordings of a person; none of one.
    pub alone: Vec<Alone>,
    /// Offsets and scalings.
    pub photodiodes: Vec<FittedPhotodiode>,
    /// What the rows and columns of the correlations are.
    pub names: Vec<String>,
    /// Correlations of the estimates; NaN, in JSON null, where one has no standard error.
    pub correlations: Vec<Vec<f64>>,
    /// SD of the residuals, V; where photodiodes differ in noise, that of the quietest.
    pub residual_sd_v: f64,
    /// Share of the variance that is explained.
    pub r2: Option<f64>,
    /// Voltages that were fitted.
    pub values: usize,
    /// Voltages less unknowns that they determine.
    pub freedom: usize,
    /// What the recordings don't determine.
    pub not_identifiable: Vec<Combination>,
    /// What the voltages may hold beside the model: part, its share of a photodiode's range, and how many standard
    /// deviations of the noise it is; none where nothing is free.
    pub beside: Option<Beside>,
    /// Other minima, found from other starts, that the recordings can't distinguish from this one.
    pub rivals: Vec<Rival>,
    /// Points in the space of parameters that were tried.
    pub points: u64,
    /// Those of them at which the model has no response.
    pub points_refused: u64,
    /// All parameters, those that were held among them, by their names in files.
    #[serde(serialize_with = "crate::hemodynamics::as_map")]
    pub parameters: Vec<(String, f64)>,
    /// The fitted parameters as files for `--params`.
    pub parameter_files: Vec<PathBuf>,
    /// Measured and fitted voltages.
    pub table: PathBuf,
}

/// The result's file: what was found, the same from whatever folder and however fast. Where results are and how long
/// they took is in the report beside it.
pub(super) fn result_text(report: &FitReport) -> String {
    let mut found = serde_json::to_value(report).expect("plain data");
    let without = |of: &mut serde_json::Value, keys: &[&str]| {
        if let Some(object) = of.as_object_mut() {
            keys.iter().for_each(|key| drop(object.remove(*key)));
        }
    };
    without(&mut found, &["options", "parameter_files", "table", "pictures", "stages", "wall_s"]);
    for recording in found["recordings"].as_array_mut().into_iter().flatten() {
        without(recording, &["file"]);
    }
    json_text(&found)
}

/// Why a fit stopped, in words, and whether that is convergence.
pub(super) fn stopped(stop: Stop) -> (&'static str, bool) {
    match stop {
        Stop::Converged => ("nothing was left to gain", true),
        Stop::Exact => ("the residuals are rounding", true),
        Stop::Precision => ("no step that counts was left within the simulations' precision", true),
        Stop::Points => ("the points allowed were used", false),
    }
}

/// The noise of the photodiodes of a recording, in words.
pub(super) fn noises(slow: &[Option<Slow>]) -> Vec<String> {
    let one = |slow: &Option<Slow>| slow.map_or("taken as white".to_owned(), |slow| slow.to_string());
    slow.iter().map(one).collect()
}
