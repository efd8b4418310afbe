//! The fitted parameters as files: one for all whose photodiodes have the same offset and scaling.

use std::path::{Path, PathBuf};

use lunula_hemodynamics::{Calibration, FitResult, Parameters};

use crate::files::{Places, beside};
use crate::hemodynamics::HemodynamicsError;
use crate::hemodynamics::fit::{FitInputs, FitOptions, fitted};
use crate::job::Outputs;
use crate::words::grouped;

/// Parameter files and whose recordings each is for: one for all whose photodiodes have the same offset and scaling.
pub(in crate::hemodynamics::fit) fn parameter_paths(
    inputs: &FitInputs,
    options: &FitOptions,
    outputs: &Outputs,
) -> Vec<(PathBuf, Vec<usize>)> {
    let label = |k: usize| match options.calibrate {
        Calibration::Fixed | Calibration::Shared => String::new(),
        Calibration::PerSubject => inputs.subject(k).to_owned(),
        Calibration::PerRecording => {
            let path = inputs.recordings[k].as_path();
            let named = inputs.names.get(k).map(|name| Path::new(name).with_extension("").into_os_string());
            named.unwrap_or_else(|| path.file_stem().unwrap_or_default().to_owned()).to_string_lossy().into_owned()
        }
    };
    // Recordings of one label are apart where each has its own.
    let apart = |k: usize| (options.calibrate == Calibration::PerRecording).then_some(k);
    let labels = grouped((0..inputs.recordings.len()).map(|k| ((label(k), apart(k)), k)));
    let plain = |c: char| if c.is_alphanumeric() || "-_.".contains(c) { c } else { '_' };
    let names: Vec<String> = labels.iter().map(|((label, _), _)| label.chars().map(plain).collect()).collect();
    let all = labels.len();
    let one = |(k, (_, own)): (usize, (_, Vec<usize>))| {
        // Recordings of several folders may have one name.
        let name = &names[k];
        let ending = match (all, names[..k].iter().filter(|before| *before == name).count()) {
            (1, _) => ".toml".to_owned(),
            (_, 0) => format!("-{name}.toml"),
            (_, before) => format!("-{name}-{}.toml", before + 1),
        };
        (beside(&outputs.out, &ending), own)
    };
    labels.into_iter().enumerate().map(one).collect()
}

/// Writes the fitted parameters; returns their places. Where there are several files, one more, under the
/// result's own name, has offset and scaling as they were at the start.
pub(in crate::hemodynamics::fit) fn parameter_files(
    inputs: &FitInputs,
    options: &FitOptions,
    result: &FitResult,
    outputs: &Outputs,
    places: &mut Places,
) -> Result<Vec<PathBuf>, HemodynamicsError> {
    let mut files = Vec::new();
    for (path, own) in parameter_paths(inputs, options, outputs) {
        // One subject's recordings may hold different photodiodes.
        let with = |all: Parameters, &k: &usize| fitted::own_parameters(&all, &result.photodiodes, k);
        let parameters = own.iter().fold(result.parameters.clone(), with);
        places.write(&path, &parameters.to_toml())?;
        files.push(path);
    }
    let shared = beside(&outputs.out, ".toml");
    if !files.contains(&shared) {
        places.write(&shared, &result.parameters.to_toml())?;
    }
    Ok(files)
}
