//! The fit: options in, its result, parameter files, a table and a picture out.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use lunula_hemodynamics::{Calibration, FitOptions as Settings, FitResult, Free, Parameters, Recording, fit as search};

use super::parameter_files::{parameter_files, parameter_paths};
use super::recording::{ReadRecording, read};
use super::report::{
    FitReport, FittedCombination, FittedPhotodiode, FittedRival, RecordingReport, correlations, groups, stopped,
};
use super::{FitOptions, estimates, figure, fitted, noise};
use crate::files::{Places, beside, pictures_beside};
use crate::hemodynamics::error::go_on;
use crate::hemodynamics::given::keep_inputs;
use crate::hemodynamics::{HemodynamicsError, named};
use crate::stages::{Stages, Step, left_out};
use crate::table::{Column, TableWriter, Value};

/// Where results go.
#[derive(Debug, Clone)]
pub struct FitOutputs {
    /// The result; parameter files, table and picture stand beside it, named after it.
    pub result: PathBuf,
    /// Whether a picture is drawn.
    pub figures: bool,
}

/// What a fit needs, read and checked.
struct Ready {
    start: Parameters,
    free: Vec<Free>,
    recordings: Vec<ReadRecording>,
}

/// Plans a fit; `outputs` may be open yet.
///
/// # Errors
/// What is wrong with the options or the recordings.
pub fn plan(options: &FitOptions, outputs: Option<&FitOutputs>) -> Result<Vec<Step>, HemodynamicsError> {
    let ready = ready(options)?;
    if let Some(outputs) = outputs {
        is_no_input(options, outputs)?;
    }
    Ok(steps(options, outputs, Some(&ready)))
}

/// Plans a fit whose recordings do not stand yet.
#[must_use]
pub fn outline(options: &FitOptions, outputs: Option<&FitOutputs>) -> Vec<Step> {
    steps(options, outputs, None)
}

fn ready(options: &FitOptions) -> Result<Ready, HemodynamicsError> {
    let start = options.parameters.read()?;
    let free = options.groups(&start)?;
    let units = start.units().len();
    let one = |(k, path): (usize, &PathBuf)| -> Result<ReadRecording, HemodynamicsError> {
        let mut found = read(path, &options.columns, units)?;
        found.recording.subject = Some(options.subject(k).to_owned());
        if let Some(name) = options.names.get(k) {
            found.name.clone_from(name);
        }
        Ok(found)
    };
    let recordings = options.recordings.iter().enumerate().map(one).collect::<Result<_, _>>()?;
    let recordings: Vec<ReadRecording> = recordings;
    let known = |name: &String| recordings.iter().any(|read| read.photodiodes.contains(name));
    if let Some((name, _)) = options.noise.iter().find(|(name, _)| !known(name)) {
        return Err(HemodynamicsError::Options(vec![format!("--noise {name}: no recording has this photodiode")]));
    }
    Ok(Ready { start, free, recordings })
}

fn steps(options: &FitOptions, outputs: Option<&FitOutputs>, ready: Option<&Ready>) -> Vec<Step> {
    let pictures = outputs.is_none_or(|outputs| outputs.figures);
    let samples = ready.map_or(String::new(), |ready| {
        let samples: usize = ready.recordings.iter().map(|one| one.recording.samples()).sum();
        format!(", {samples} samples")
    });
    let (free, recordings) = (options.free.len(), options.recordings.len());
    let held = options.calibration == Calibration::Fixed;
    vec![
        Step::new("fit", true, format!("{free} free groups, {recordings} recordings{samples}")),
        Step::new(
            "offset and scaling",
            !held,
            match options.calibration {
                Calibration::Fixed => "--calibrate held",
                Calibration::Shared => "of each photodiode",
                Calibration::PerSubject => "of each photodiode and subject",
                Calibration::PerRecording => "of each photodiode and recording",
            }
            .to_owned(),
        ),
        Step::new("figures", pictures, if pictures { "measured and fitted" } else { "--no-figures" }.to_owned()),
    ]
}

/// Runs the job; every result is in its place when it returns.
///
/// # Errors
/// [`HemodynamicsError`] where there are no results.
pub fn fit(options: &FitOptions, outputs: &FitOutputs, stop: &AtomicBool) -> Result<FitReport, HemodynamicsError> {
    let begin = Instant::now();
    let stages = Stages::default();
    let mut ready = stages.time("read", || ready(options))?;
    is_no_input(options, outputs)?;
    go_on(stop)?;
    let optics = options.optics.optics(&ready.start)?;
    let settings = Settings {
        optics: optics.clone(),
        calibration: options.calibration,
        collapse: options.collapse,
        starts: options.starts,
        intervals: true,
        ..Settings::default()
    };
    noise::begin(options, &mut ready.recordings);
    let mut round = 0;
    let (result, curves) = loop {
        let recordings: Vec<Recording> = ready.recordings.iter().map(|one| one.recording.clone()).collect();
        let result = stages
            .time("fit", || search(&recordings, &ready.start, &ready.free, &settings))
            .map_err(|why| HemodynamicsError::Model(in_words(&why.to_string(), &ready.recordings)))?;
        go_on(stop)?;
        let curves = stages.time("fitted curves", || {
            let of = |(k, read): (usize, &ReadRecording)| {
                let own = fitted::own_parameters(&result.parameters, &result.photodiodes, k);
                fitted::voltages(&own, &read.recording, options.collapse, &optics)
            };
            ready.recordings.iter().enumerate().map(of).collect::<Result<Vec<_>, _>>()
        })?;
        go_on(stop)?;
        round += 1;
        let noises = noise::estimated(options, &ready.recordings, &curves);
        if !noise::set(&mut ready.recordings, &noises) || round > noise::MOST_ROUNDS {
            break (result, curves);
        }
    };
    let mut places = Places::default();
    let parameter_files = parameter_files(options, &result, outputs, &mut places)?;
    let estimates = beside(&outputs.result, "-estimates.csv");
    estimates::write(&result, &ready.start, &places.place(&estimates)?, &estimates)?;
    let table = beside(&outputs.result, "-fitted.csv");
    let at = places.place(&table)?;
    stages.time("table", || write_table(&ready.recordings, &curves, &at, &table))?;
    let mut pictures = Vec::new();
    if outputs.figures {
        pictures.push(places.draw(&outputs.result, "fitted", |png, svg| {
            stages.time("figures", || figure::draw_fit(&ready.recordings, &curves, png, svg))
        })?);
    }
    go_on(stop)?;
    let (words, converged) = stopped(result.stop);
    let names_of = |own: &[usize]| own.iter().map(|&k| ready.recordings[k].name.clone()).collect::<Vec<_>>();
    let report = FitReport {
        job: "fit",
        version: env!("CARGO_PKG_VERSION"),
        recordings: recording_reports(options, &ready.recordings, &curves),
        stopped: words,
        converged,
        free: groups(&result, &ready.start),
        photodiodes: result
            .photodiodes
            .iter()
            .map(|one| FittedPhotodiode {
                unit: one.unit + 1,
                recordings: names_of(&one.recordings),
                subjects: subjects_of(options, &one.recordings),
                offset_v: one.offset.value,
                offset_standard_error_v: one.offset.standard_error,
                scaling_v: one.scaling.value,
                scaling_standard_error_v: one.scaling.standard_error,
                residual_rms_v: one.residual_rms_v,
            })
            .collect(),
        names: result.names.clone(),
        correlations: correlations(&result),
        residual_sd_v: result.residual_sd_v,
        r2: result.r2,
        values: result.values,
        freedom: result.freedom,
        not_identifiable: result
            .undetermined
            .iter()
            .map(|one| FittedCombination { weights: one.weights.clone(), sd: one.sd })
            .collect(),
        rivals: result.rivals.iter().map(|one| FittedRival { values: one.values.clone(), rise: one.rise }).collect(),
        points: result.statistics.points,
        points_refused: result.statistics.refused,
        parameters: named(&result.parameters),
        parameter_files,
        table,
        left_out: left_out(steps(options, Some(outputs), Some(&ready))),
        warnings: warnings(&result, &ready.recordings, outputs.figures),
        failed: Vec::new(),
        pictures,
        stages: stages.list(),
        wall_s: begin.elapsed().as_secs_f64(),
    };
    let text = serde_json::to_string_pretty(&report).expect("plain data") + "\n";
    places.write(&outputs.result, &report.result_text())?;
    places.write(&beside(&outputs.result, ".run.json"), &text)?;
    places.commit()?;
    Ok(report)
}

/// The crate counts recordings; people name them.
fn in_words(why: &str, recordings: &[ReadRecording]) -> String {
    let mut parts = why.split("recording ");
    let mut words = parts.next().unwrap_or_default().to_owned();
    // Once each, from left to right: a file may be called `recording 2.csv` itself.
    for part in parts {
        let digits = part.bytes().take_while(u8::is_ascii_digit).count();
        let read = part[..digits].parse::<usize>().ok().and_then(|number| recordings.get(number.checked_sub(1)?));
        match read {
            Some(read) => words += &format!("{}{}", read.path.display(), &part[digits..]),
            None => words += &format!("recording {part}"),
        }
    }
    words
}

fn warnings(result: &FitResult, recordings: &[ReadRecording], figures: bool) -> Vec<String> {
    let mut warnings = Vec::new();
    let (words, converged) = stopped(result.stop);
    if !converged {
        warnings.push(format!(
            "the fit has not converged: {words}; free less, or start nearer (--params, --set, --starts)"
        ));
    }
    for one in &result.undetermined {
        let weights: Vec<String> = one.weights.iter().map(|(name, weight)| format!("{weight:+.2} {name}")).collect();
        warnings.push(format!("the recordings don't determine {}; hold one of these", weights.join(" ")));
    }
    for group in result.groups.iter().filter(|group| group.at_bound.is_some()) {
        let names: Vec<String> = group.symbols.iter().map(ToString::to_string).collect();
        warnings.push(format!("{} ended at its bound; --bounds widens it", names.join(" = ")));
    }
    if let Some(rival) = result.rivals.first() {
        let both = rival.values.iter().flatten().map(|value| format!("{value:.3e}")).collect::<Vec<_>>().join(", ");
        warnings.push(format!(
            "other values fit nearly as well ({both}); the standard errors know nothing of them: hold a parameter, or \
             record more"
        ));
    }
    for read in recordings {
        warnings.extend(read.notes.iter().map(|note| format!("{}: {note}", read.name)));
        if read.faults > 0 {
            warnings.push(format!(
                "{}: {} voltages of rows with a fault of the sensor (saturated, or without ambient light) are left out",
                read.name, read.faults
            ));
        }
        for (name, trace) in read.photodiodes.iter().zip(&read.recording.photodiodes) {
            let mut known = trace.voltages_v.iter().filter(|value| value.is_finite());
            if known.next().is_some_and(|first| known.all(|value| value == first)) {
                warnings.push(format!("{}: {name} is constant: nothing can be learnt from it", read.name));
            }
        }
    }
    let panels: usize = recordings.iter().map(|read| read.photodiodes.len()).sum();
    if figures && panels > figure::MOST_PANELS {
        warnings.push(format!("the picture shows {} of {panels} panels; the table has all", figure::MOST_PANELS));
    }
    warnings
}

fn recording_reports(
    options: &FitOptions,
    recordings: &[ReadRecording],
    curves: &[Vec<Vec<f64>>],
) -> Vec<RecordingReport> {
    let rms = |measured: &[f64], fitted: &[f64]| {
        let misses: Vec<f64> =
            measured.iter().zip(fitted).map(|(a, b)| a - b).filter(|miss| miss.is_finite()).collect();
        let mean = misses.iter().map(|miss| miss * miss).sum::<f64>() / misses.len() as f64;
        Some(mean.sqrt()).filter(|rms| rms.is_finite())
    };
    let one = |(k, (read, curves)): (usize, (&ReadRecording, &Vec<Vec<f64>>))| RecordingReport {
        name: read.name.clone(),
        file: read.path.clone(),
        subject: options.subject(k).to_owned(),
        kind: if read.times_s.is_some() { "over time" } else { "static" },
        samples: read.recording.samples(),
        photodiodes: read.photodiodes.clone(),
        missing: read.missing,
        faults: read.faults,
        notes: read.notes.clone(),
        residual_rms_v: read
            .recording
            .photodiodes
            .iter()
            .zip(curves)
            .map(|(trace, fitted)| rms(&trace.voltages_v, fitted))
            .collect(),
        noise_v: read.recording.photodiodes.iter().map(|trace| trace.noise_v).collect(),
    };
    recordings.iter().zip(curves).enumerate().map(one).collect()
}

/// Refuses to write over an input.
fn is_no_input(options: &FitOptions, outputs: &FitOutputs) -> Result<(), HemodynamicsError> {
    let mut results = vec![outputs.result.clone()];
    results
        .extend(["-estimates.csv", "-fitted.csv", ".toml", ".run.json"].map(|ending| beside(&outputs.result, ending)));
    results.extend(parameter_paths(options, outputs).into_iter().map(|one| one.0));
    if outputs.figures {
        results.extend(pictures_beside(&outputs.result, "fitted"));
    }
    keep_inputs(options.recordings.iter().chain(&options.parameters.file), &results)
}

/// The subjects of recordings, where any are named.
fn subjects_of(options: &FitOptions, recordings: &[usize]) -> Vec<String> {
    let mut subjects: Vec<String> = Vec::new();
    for subject in recordings.iter().filter_map(|&k| options.subjects.get(k)) {
        if !subjects.contains(subject) {
            subjects.push(subject.clone());
        }
    }
    subjects
}

/// Writes measured and fitted voltages, a row a sample.
fn write_table(
    recordings: &[ReadRecording],
    curves: &[Vec<Vec<f64>>],
    at: &Path,
    path: &Path,
) -> Result<(), HemodynamicsError> {
    let mut columns = vec![Column::text("recording"), Column::text("photodiode"), Column::integer("unit")];
    columns.extend(["time_s", "pf1_Pa", "pf2_Pa", "measured_V", "fitted_V"].map(Column::number));
    let mut table = TableWriter::create(at, path, columns, &[])?;
    for (read, curves) in recordings.iter().zip(curves) {
        for ((name, trace), fitted) in read.photodiodes.iter().zip(&read.recording.photodiodes).zip(curves) {
            for (row, (measured, fitted)) in trace.voltages_v.iter().zip(fitted).enumerate() {
                let [proximal, distal] = read.pressed_pa[row].map(Value::Number);
                let time_s = Value::from(read.times_s.as_ref().map(|times_s| times_s[row]));
                let unit = Value::Integer(trace.unit as i64 + 1);
                let [measured, fitted] = [*measured, *fitted].map(Value::Number);
                table.write(&[
                    Value::Text(&read.name),
                    Value::Text(name),
                    unit,
                    time_s,
                    proximal,
                    distal,
                    measured,
                    fitted,
                ])?;
            }
        }
    }
    Ok(table.finish()?)
}
