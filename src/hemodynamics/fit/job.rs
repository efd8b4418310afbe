//! The fit: options in, its result, parameter files, a table and a picture out.

use std::path::{Path, PathBuf};

use lunula_hemodynamics::{
    Beside, BesidePart, Calibrated, Calibration, Delay, Estimate, FitOptions as Settings, FitResult, Free, Parameters,
    Recording, Symbol, fit as search,
};

use super::recording::{ReadRecording, photodiodes, read, signs};
use super::report::{FitFigures, FitReport, FittedPhotodiode, RecordingReport, noises, result_text, stopped};
use super::results::parameter_files::{parameter_files, parameter_paths};
use super::results::{estimates, figure};
use super::{FitInputs, FitOptions, alone, fitted, noise};
use crate::files::{Places, beside, pictures_beside};
use crate::hemodynamics::{HemodynamicsError, named};
use crate::job::{Outputs, Report, Watch};
use crate::log::{ambient_step_of, doubts::alternating};
use crate::stages::{Stages, Step, left_out};
use crate::table::{Column, TableWriter, Value, copies};
use crate::words::in_order;

/// The stage that fits parts of the recordings.
const ALONE: &str = "each by itself";
/// An offset or scaling that goes so many times as far as two standard errors is noted. Measured on proximal steps with
/// noise of 0.05 mV: in none of 20; with 0.2 mV: in 40 of 40, and two standard errors of V_0 and V_1 were short in 6 of
/// 80, intervals in 2.
const FAR_BEYOND: f64 = 3.0;

/// What a fit needs, read and checked.
struct Ready {
    start: Parameters,
    free: Vec<Free>,
    recordings: Vec<ReadRecording>,
}

impl Ready {
    fn samples(&self) -> usize {
        self.recordings.iter().map(|one| one.recording.samples()).sum()
    }
}

/// Plans a fit; `outputs` may have no place yet.
///
/// # Errors
/// What is wrong with the options or the recordings.
pub fn plan(inputs: &FitInputs, options: &FitOptions, outputs: &Outputs) -> Result<Vec<Step>, HemodynamicsError> {
    let ready = ready(inputs, options)?;
    if !outputs.out.as_os_str().is_empty() {
        places(inputs, options, outputs)?;
    }
    Ok(steps(inputs, options, outputs, ambient(inputs, options), Some(ready.samples())))
}

fn ready(inputs: &FitInputs, options: &FitOptions) -> Result<Ready, HemodynamicsError> {
    let start = options.model.parameters(inputs.params.as_deref())?;
    let free = options.groups(inputs, &start)?;
    let units = start.units().len();
    let named = &options.columns.photodiodes;
    photodiodes::none_twice(named)?;
    let one = |(k, path): (usize, &PathBuf)| -> Result<ReadRecording, HemodynamicsError> {
        let mut found = read(path, &options.columns, units)?;
        found.recording.subject = Some(inputs.subject(k).to_owned());
        if let Some(name) = inputs.names.get(k) {
            found.name.clone_from(name);
        }
        Ok(found)
    };
    let recordings = inputs.recordings.iter().enumerate().map(one).collect::<Result<_, _>>()?;
    let mut recordings: Vec<ReadRecording> = recordings;
    photodiodes::all_there(named, &recordings)?;
    photodiodes::note_lacking(&mut recordings);
    let has = |read: &ReadRecording, name: &String| {
        read.photodiodes.contains(name) || read.constant.iter().any(|one| one.name == *name)
    };
    let known = |name: &String| recordings.iter().any(|read| has(read, name));
    if let Some((name, _)) = options.noise.iter().find(|(name, _)| !known(name)) {
        return Err(HemodynamicsError::Options(vec![format!("--noise {name}: no recording has this photodiode")]));
    }
    Ok(Ready { start, free, recordings })
}

fn ambient(inputs: &FitInputs, options: &FitOptions) -> Step {
    ambient_step_of(inputs.recordings.iter().map(PathBuf::as_path), &options.columns.log)
}

/// The one table of steps; `ambient`: whether ambient light is taken away; `samples` are known once the recordings are
/// read.
pub(super) fn steps(
    inputs: &FitInputs,
    options: &FitOptions,
    outputs: &Outputs,
    ambient: Step,
    samples: Option<usize>,
) -> Vec<Step> {
    let pictures = outputs.figures;
    let samples = samples.map_or(String::new(), |samples| format!(", {samples} samples"));
    let (free, recordings) = (options.free().len(), inputs.recordings.len());
    let held = options.calibrate == Calibration::Fixed;
    vec![
        ambient,
        Step::new("fit", true, format!("{free} free groups, {recordings} recordings{samples}")),
        Step::new(
            "offset and scaling",
            !held,
            match options.calibrate {
                Calibration::Fixed => "--calibrate held",
                Calibration::Shared => "of each photodiode",
                Calibration::PerSubject => "of each photodiode and subject",
                Calibration::PerRecording => "of each photodiode and recording",
            }
            .to_owned(),
        ),
        match alone::count(inputs) {
            0 => Step::new(ALONE, false, "one recording".to_owned()),
            parts => Step::new(ALONE, true, format!("{parts} fits, to see whether one value for all holds")),
        },
        Step::figures(pictures, "measured and fitted"),
    ]
}

/// Runs the job; every result is in its place when it returns.
///
/// # Errors
/// [`HemodynamicsError`] where there are no results.
pub fn fit(
    inputs: &FitInputs,
    options: &FitOptions,
    outputs: &Outputs,
    watch: &Watch<'_>,
) -> Result<FitReport, HemodynamicsError> {
    let stages = Stages::default();
    let mut ready = stages.time("read", || ready(inputs, options))?;
    let mut places = places(inputs, options, outputs)?;
    watch.go_on()?;
    let model = &options.model;
    let optics = model.optics.optics(&ready.start)?;
    let settings = Settings {
        optics: optics.clone(),
        calibration: options.calibrate,
        collapse: model.collapse,
        starts: usize::from(options.starts),
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
        watch.go_on()?;
        let curves = stages.time("fitted curves", || {
            let of = |(k, read): (usize, &ReadRecording)| {
                let own = fitted::own_parameters(&result.parameters, &result.photodiodes, k);
                fitted::voltages(&own, &read.recording, model.collapse, &optics)
            };
            ready.recordings.iter().enumerate().map(of).collect::<Result<Vec<_>, _>>()
        })?;
        watch.go_on()?;
        round += 1;
        let noises = noise::estimated(inputs, options, &ready.recordings, &curves);
        if !noise::set(&mut ready.recordings, &noises) || round > noise::MOST_ROUNDS {
            break (result, curves);
        }
    };
    let alone = stages.time(ALONE, || alone::each(inputs, &ready.recordings, &ready.start, &ready.free, &settings));
    watch.go_on()?;
    let parameter_files = parameter_files(inputs, options, &result, outputs, &mut places)?;
    let estimates = beside(&outputs.out, "-estimates.csv");
    estimates::write(&result, &ready.start, &places.place(&estimates)?, &estimates)?;
    let table = beside(&outputs.out, "-fitted.csv");
    let at = places.place(&table)?;
    stages.time("table", || write_table(&ready.recordings, &curves, &at, &table))?;
    let mut pictures = Vec::new();
    if outputs.figures {
        pictures.push(places.draw(&outputs.out, "fitted", |png, svg| {
            stages.time("figures", || figure::draw_fit(&ready.recordings, &curves, png, svg))
        })?);
    }
    watch.go_on()?;
    let (words, converged) = stopped(result.stop);
    let names_of = |own: &[usize]| own.iter().map(|&k| ready.recordings[k].name.clone()).collect::<Vec<_>>();
    let figures = FitFigures {
        recordings: recording_reports(inputs, &ready.recordings, &curves, &result),
        stopped: words,
        converged,
        free: result.groups.clone(),
        alone,
        photodiodes: result
            .photodiodes
            .iter()
            .map(|one| FittedPhotodiode {
                unit: one.unit + 1,
                recordings: names_of(&one.recordings),
                subjects: subjects_of(inputs, &one.recordings),
                offset_v: one.offset.value,
                offset_standard_error_v: one.offset.standard_error,
                scaling_v: one.scaling.value,
                scaling_standard_error_v: one.scaling.standard_error,
                residual_rms_v: one.residual_rms_v,
            })
            .collect(),
        names: result.names.clone(),
        correlations: result.correlations.clone(),
        residual_sd_v: result.residual_sd_v,
        r2: result.r2,
        values: result.values,
        freedom: result.freedom,
        not_identifiable: result.undetermined.clone(),
        beside: result.beside,
        rivals: result.rivals.clone(),
        points: result.statistics.points,
        points_refused: result.statistics.refused,
        parameters: named(&result.parameters),
        parameter_files,
        table,
    };
    let left_out = left_out(steps(inputs, options, outputs, ambient(inputs, options), Some(ready.samples())));
    let warnings = warnings(&result, &ready.recordings, alone::warnings(&figures.alone, options));
    let notes = notes(&result, inputs, &ready.recordings, outputs.figures);
    let report = Report { left_out, warnings, notes, pictures, ..Report::new("fit", watch, figures) };
    if outputs.report {
        places.write(&outputs.out, &result_text(&report))?;
    }
    let at = outputs.report.then(|| beside(&outputs.out, ".run.json"));
    Ok(report.timed(&stages).commit(places, at.as_deref())?)
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

/// What has to be known before the values are used.
fn warnings(result: &FitResult, recordings: &[ReadRecording], of_parts: Vec<String>) -> Vec<String> {
    let differ = !of_parts.is_empty();
    let mut warnings = of_parts;
    let (words, converged) = stopped(result.stop);
    if !converged {
        warnings.push(format!(
            "the fit has not converged: {words}; free less, or start nearer (--params, --set, --starts)"
        ));
    }
    for one in &result.undetermined {
        let weights = one.weights.iter().filter(|(_, weight)| weight.is_finite());
        let weights: Vec<String> = weights.map(|(name, weight)| format!("{weight:+.2} {name}")).collect();
        warnings.push(format!("the recordings don't determine {}; hold one of these", weights.join(" ")));
    }
    for group in result.groups.iter().filter(|group| group.at_bound.is_some()) {
        let names: Vec<String> = group.symbols.iter().map(ToString::to_string).collect();
        warnings.push(format!(
            "{} ended at its bound; --bounds widens it, and the other errors hold for this bound only",
            names.join(" = ")
        ));
    }
    if let Some(rival) = result.rivals.first() {
        let both = rival.values.iter().flatten().map(|value| format!("{value:.3e}")).collect::<Vec<_>>().join(", ");
        warnings.push(format!(
            "other values fit nearly as well ({both}); the standard errors do not include them: hold a parameter, or \
             record more"
        ));
    }
    warnings.extend(signs::of_scalings(result, recordings));
    warnings.extend(recordings.iter().zip(&result.delays).filter_map(|(read, delay)| delayed((*delay)?, &read.name)));
    // What explains it is named already.
    if !differ && !result.delays.iter().flatten().any(Delay::is_clear) {
        warnings.extend(result.beside.and_then(part_beside));
    }
    let files = recordings.iter().map(|read| (read.path.display().to_string(), read.path.as_path()));
    warnings.extend(copies(files.collect()));
    for read in recordings {
        warnings.extend(read.warnings.iter().map(|warning| format!("{}: {warning}", read.name)));
        let traces = read.photodiodes.iter().zip(&read.recording.photodiodes);
        let voltages = traces.map(|(name, trace)| (name.as_str(), &trace.voltages_v[..]));
        let by_turns = read.times_s.is_some().then(|| alternating(voltages)).flatten();
        warnings.extend(by_turns.map(|doubt| format!("{}: {doubt}", read.name)));
        warnings.extend(
            read.constant
                .iter()
                .map(|one| format!("{}: {} is constant: it determines nothing, and is left out", read.name, one.name)),
        );
    }
    warnings
}

/// What to say of offsets and scalings that go much farther within the parameters' intervals than their standard errors
/// say: they turn round near the best.
fn turning(photodiodes: &[Calibrated]) -> Option<String> {
    let both = |one: &Calibrated| [(Symbol::Offset(one.unit), one.offset), (Symbol::Scaling(one.unit), one.scaling)];
    let far = |(_, estimate): &(Symbol, Estimate)| estimate.beyond_linear().is_some_and(|times| times > FAR_BEYOND);
    let say = |(symbol, estimate): (Symbol, Estimate)| {
        let [low, high] = estimate.interval.map(Option::unwrap_or_default);
        format!("{symbol} ({low:.3} to {high:.3})")
    };
    let far: Vec<String> = photodiodes.iter().flat_map(both).filter(far).map(say).collect();
    (!far.is_empty()).then(|| {
        format!(
            "the standard errors of {} hold near their values only: within the parameters' two standard errors they go \
             as far as the numbers in brackets; go by low and high of the table of estimates, hold a parameter, or \
             record more",
            far.join(", ")
        )
    })
}

/// What to say of a recording whose loads are on another clock than its photodiodes.
fn delayed(delay: Delay, name: &str) -> Option<String> {
    let order = if delay.by_s < 0.0 { "before" } else { "after" };
    delay.is_clear().then(|| {
        format!(
            "{name}: photodiodes answer {:.0} +- {:.0} ms {order} what the loads would make of them: are both on one \
             clock? 40 ms change a stiffness several times over, and no standard error includes it; give the loads the \
             times at which they were taken. (Or does this finger differ from others whose parameters it shares, or is \
             a column another's?)",
            1e3 * delay.by_s.abs(),
            1e3 * delay.standard_error_s
        )
    })
}

/// What to say of voltages that hold more than the model.
fn part_beside(beside: Beside) -> Option<String> {
    let (with, why) = match beside.part {
        BesidePart::Load => ("the load itself", "does the light change as the nail bends under the sensor"),
        BesidePart::Square => ("the square of their signal", "are the photodiodes or their amplifiers not linear"),
    };
    beside.is_clear().then(|| {
        format!(
            "the photodiodes hold a part of about {:.0} % of their range that goes with {with}, and that the model \
             has not ({:.0} standard deviations of the noise): {why}, or is a parameter that is held another \
             finger's? The free ones take it up, and neither their standard errors nor their intervals include it",
            100.0 * beside.share,
            beside.sds
        )
    })
}

/// How recordings were read, and what the picture leaves out.
fn notes(result: &FitResult, inputs: &FitInputs, recordings: &[ReadRecording], figures: bool) -> Vec<String> {
    let mut notes = Vec::new();
    let subjects = subjects_of(inputs, &(0..recordings.len()).collect::<Vec<_>>());
    let shared: Vec<String> = result.groups.iter().flat_map(|group| &group.symbols).map(ToString::to_string).collect();
    if subjects.len() > 1 && !shared.is_empty() {
        notes.push(format!(
            "{} have one value of {}; only offsets and scalings are each person's own (`alone` has what each person's \
             recordings give by themselves)",
            subjects.join(", "),
            shared.join(", ")
        ));
    }
    for read in recordings {
        notes.extend(read.notes.iter().map(|note| format!("{}: {note}", read.name)));
        if read.faults > 0 {
            notes.push(format!(
                "{}: {} voltages of rows with a fault of the sensor (saturated, or without ambient light) are left out",
                read.name, read.faults
            ));
        }
    }
    notes.extend(turning(&result.photodiodes));
    let panels: usize = recordings.iter().map(|read| read.photodiodes.len()).sum();
    if figures && panels > figure::MOST_PANELS {
        notes.push(format!("the picture shows {} of {panels} panels; the table has all", figure::MOST_PANELS));
    }
    notes
}

fn recording_reports(
    inputs: &FitInputs,
    recordings: &[ReadRecording],
    curves: &[Vec<Vec<f64>>],
    result: &FitResult,
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
        subject: inputs.subject(k).to_owned(),
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
        noise: noises(&result.noises[k]),
        delay_s: result.delays[k].map(|delay| [delay.by_s, delay.standard_error_s]),
    };
    recordings.iter().zip(curves).enumerate().map(one).collect()
}

/// Where results go; refuses to replace an input.
fn places(inputs: &FitInputs, options: &FitOptions, outputs: &Outputs) -> Result<Places, HemodynamicsError> {
    let mut results = vec![outputs.out.clone()];
    results.extend(["-estimates.csv", "-fitted.csv", ".toml", ".run.json"].map(|ending| beside(&outputs.out, ending)));
    results.extend(parameter_paths(inputs, options, outputs).into_iter().map(|one| one.0));
    if outputs.figures {
        results.extend(pictures_beside(&outputs.out, "fitted"));
    }
    let places = Places::not_over(inputs.recordings.iter().chain(&inputs.params));
    places.check(&results)?;
    Ok(places)
}

/// The subjects of recordings, where any are named.
fn subjects_of(inputs: &FitInputs, recordings: &[usize]) -> Vec<String> {
    in_order(recordings.iter().filter_map(|&k| inputs.subjects.get(k)).cloned())
}

/// Writes measured and fitted voltages, one row per sample.
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
