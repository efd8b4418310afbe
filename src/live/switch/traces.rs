//! Recordings to traces: what a live session would have compared at each row, and what was true.

use std::cell::RefCell;
use std::iter;
use std::path::PathBuf;

use clap::{Args, ValueHint};
use lunula_live::switch::{LONGEST_GAP_S, Trace, compared};
use lunula_predictor::{Gate, Predictor};

use super::doubts::{held, on_another_clock};
use super::options::ContactOptions;
use crate::job::Watch;
use crate::live::error::LiveError;
use crate::live::session::{Sensor, StreamColumns, each_row};
use crate::log::{Log, LogError, doubts};
use crate::predictor::{Answering, DataFile, extrapolated, open_models};

/// Rows of a recording, at most: 30 h at 1 kHz.
const MOST_ROWS: usize = 100_000_000;

/// The share of rows without a prediction that is nothing to be said of: those that wait for lags (one row of each of
/// five recordings).
const MOST_UNANSWERED: f64 = 0.01;

/// What a switch is chosen or judged on.
#[derive(Debug, Clone, Args)]
pub struct SwitchInputs {
    /// Recordings: tables or logs with photodiodes and what is true of contact
    #[arg(required = true, value_name = "RECORDING", value_parser = DataFile::parser())]
    #[arg(value_hint = ValueHint::AnyPath)]
    pub recordings: Vec<DataFile>,
    /// Models that `lunula train` wrote
    #[arg(long = "model", required = true, value_name = "MODEL.json", num_args = 1..)]
    pub models: Vec<PathBuf>,
}

/// What recordings hold.
#[derive(Debug, Default)]
pub(crate) struct Traces {
    /// What those that could be read are called.
    pub(crate) recordings: Vec<String>,
    pub(crate) traces: Vec<Trace>,
    /// Whether one of them says when the LED was on.
    pub(crate) led: bool,
    /// The checksum of the model that predicts what the switch compares.
    pub(crate) model_sha256: Option<String>,
    pub(crate) warnings: Vec<String>,
    pub(crate) notes: Vec<String>,
    /// Recordings that could not be read, each with why.
    pub(crate) failed: Vec<String>,
}

/// Reads the recordings; `column` is the predicted one that the switch compares, pressing where none is named.
///
/// # Errors
/// Models that can't be used, or not one recording that can be.
pub(crate) fn read_traces(
    inputs: &SwitchInputs,
    column: Option<&str>,
    options: &ContactOptions,
    watch: &Watch<'_>,
) -> Result<Traces, LiveError> {
    let SwitchInputs { recordings, models } = inputs;
    let opened = open_models(models)?.of_samples()?;
    let model_sha256 = opened.sha256_of(compared(column).0).map(str::to_owned);
    let mut all = Traces { model_sha256, warnings: opened.warnings, ..Traces::default() };
    for (k, recording) in recordings.iter().enumerate() {
        watch.go_on()?;
        (watch.tick)(k as u64, Some(recordings.len() as u64));
        let mut said = Remarks::default();
        match read_trace(recording, &opened.predictors, column, options, watch, &mut said) {
            Ok(trace) => {
                all.traces.push(trace);
                all.recordings.push(recording.name.clone());
            }
            Err(LiveError::Interrupted(why)) => return Err(why.into()),
            Err(why) => all.failed.push(why.to_string()),
        }
        all.led |= said.led;
        for (to, from) in [(&mut all.warnings, said.warnings), (&mut all.notes, said.notes)] {
            to.extend(from.into_iter().map(|what| format!("{}: {what}", recording.name)));
        }
    }
    if all.traces.is_empty() {
        return Err(LiveError::Request(all.failed.join("; ")));
    }
    Ok(all)
}

/// What is worth saying of a recording.
#[derive(Default)]
struct Remarks {
    led: bool,
    warnings: Vec<String>,
    notes: Vec<String>,
}

fn read_trace(
    recording: &DataFile,
    models: &[Predictor],
    column: Option<&str>,
    options: &ContactOptions,
    watch: &Watch<'_>,
    said: &mut Remarks,
) -> Result<Trace, LiveError> {
    let refused = |what: String| LiveError::Source { place: recording.name.clone(), what };
    // The gate only says what is touching, which is not asked for here.
    let gate = Gate::new(1.0, 0.0, 0.0).map_err(|why| refused(why.to_string()))?;
    let answering = Answering::new(models.to_vec(), gate, false)?;
    let (name, sign) = compared(column);
    let at = answering.columns().iter().position(|one| one == name).ok_or_else(|| {
        refused(format!("the models predict {}, not {name}; name a model of it", answering.columns().join(", ")))
    })?;
    let truth = &options.contact;
    let mut answering = Some(answering);
    let sensor: RefCell<Option<(Sensor, usize)>> = RefCell::new(None);
    let mut trace = Trace::default();
    let extra = [truth.column.clone()];
    // Of a recording that begins with an unlit row, the first lit one.
    let mut begins = false;
    // Of all rows, lit or not.
    let (mut times, mut truths, mut flags, mut known) = (Vec::new(), Vec::new(), Vec::new(), 0);
    let (mut begun, mut grouped) = (0, false);
    let path = &recording.path;
    let piece =
        options.log.columns.piece.map(|piece| Ok::<_, LogError>((piece, Log::read(path, &options.log.columns)?)));
    let piece = piece.transpose()?;
    let notes = each_row(
        path,
        &options.log,
        &extra,
        |columns: &StreamColumns| {
            let place = columns.place(&truth.column).ok_or_else(|| {
                format!("has no column `{}`; its numbers are {}", truth.column, columns.values.join(", "))
            })?;
            (said.led, grouped) = (columns.led, !columns.groups.is_empty());
            let answering = answering.take().ok_or("names its columns twice")?;
            sensor.replace(Some((Sensor::new(answering, columns, &options.log, options.keep_faults)?, place)));
            Ok(())
        },
        |row| {
            let mut sensor = sensor.borrow_mut();
            let Some((sensor, place)) = &mut *sensor else { return Ok(()) };
            begun += usize::from(row.begins);
            let mut row = *row;
            if let Some((piece, log)) = &piece {
                let is_of_log = row.time_s.is_finite() && (row.lit.is_some() || log.led.is_none());
                if begun != piece.get() || !is_of_log {
                    return Ok(());
                }
                // Where its clock was set back a stream's time goes on.
                row.time_s = log.time_s.get(times.len()).copied().unwrap_or(f64::NAN);
                row.begins = times.is_empty();
            }
            let touches = truth.of(row.values[*place]).map_err(|value| {
                format!("column `{}` is {value} at {} s; contact is 0 or 1, or say Fz_N<-0.2", truth.column, row.time_s)
            })?;
            trace.contacts.push(row.time_s, touches, row.begins);
            times.push(row.time_s);
            truths.push(row.values[*place]);
            flags.push(touches.map_or(f64::NAN, |touches| f64::from(u8::from(touches))));
            known += usize::from(touches.is_some());
            begins |= row.begins;
            let Some(answer) = sensor.row(&row) else { return Ok(()) };
            if std::mem::take(&mut begins) {
                trace.begins.push(trace.time_s.len());
            }
            if trace.time_s.len() >= MOST_ROWS {
                return Err(format!("has more than {MOST_ROWS} rows; cut it into parts"));
            }
            trace.time_s.push(row.time_s);
            trace.value.push(sign * sensor.answer[at]);
            trace.outside.push(answer.outside);
            Ok(())
        },
        watch,
    )?;
    said.notes.extend(notes);
    said.warnings.extend(sensor.into_inner().into_iter().flat_map(|(sensor, _)| sensor.doubts()));
    match piece {
        Some((piece, log)) if log.time_s.len() != times.len() => {
            return Err(refused(format!(
                "piece {piece} has {} rows, and {} come in the order of time and counter; cut it out of the file",
                log.time_s.len(),
                times.len()
            )));
        }
        Some((_, log)) => said.notes.extend(log.notes.into_iter().filter(|note| note.starts_with("piece "))),
        None if begun > 1 => {
            // A log is refused, with its line.
            if options.log.is_log(path)? {
                Log::read(path, &options.log.columns)?;
            }
            if !grouped {
                let back = begun - 1;
                said.warnings.push(format!("its clock or counter goes back {back} time(s); a recording begins there"));
            }
        }
        None => {}
    }
    said.warnings.extend(doubts::time(&times));
    said.warnings.extend(doubts::forces(iter::once((truth.column.as_str(), &truths[..]))));
    said.warnings.extend(held(&times, &flags).or_else(|| doubts::held(&truth.column, &times, &truths)));
    let (rows, outside) = (trace.time_s.len(), trace.outside.iter().filter(|outside| **outside).count());
    said.warnings.extend(extrapolated(outside as u64, rows as u64));
    if rows == 0 {
        return Err(refused("has no rows with the LED on".to_owned()));
    }
    let unanswered = trace.value.iter().filter(|value| !value.is_finite()).count();
    let lacks = if models.iter().any(|model| model.lags().is_some()) {
        "photodiodes that a model reads, the unlit rows that its values need, or readings of the past, as far back as \
         its --lags, are missing"
    } else {
        "photodiodes that a model reads, or the unlit rows that its values need, are missing"
    };
    if unanswered == rows {
        let time = doubts::time(&times).map_or(String::new(), |doubt| format!("; {doubt}"));
        return Err(refused(format!("none of its {rows} rows has a prediction: {lacks}{time}")));
    }
    if unanswered as f64 > MOST_UNANSWERED * rows as f64 {
        said.warnings.push(format!(
            "{unanswered} of {rows} rows have no prediction, as {lacks}; there the switch lets go, and the hours of \
             false switches count that time"
        ));
    }
    if trace.contacts.seconds == 0.0 {
        let (rows, lit) = (times.len(), &trace.time_s);
        let apart_s = (lit[lit.len() - 1] - lit[0]) / (lit.len() - 1) as f64;
        return Err(refused(if known == 0 {
            format!("no row says whether the finger touches (`{truth}`); name another column")
        } else if apart_s > LONGEST_GAP_S {
            format!(
                "its rows are {apart_s:.1} s apart, and contact is known between rows up to {LONGEST_GAP_S} s apart; \
                 call a time in milliseconds time_ms"
            )
        } else {
            format!(
                "{known} of {rows} rows say whether the finger touches (`{truth}`), but no two neighbours do, between \
                 which it is known; fill it in in every row"
            )
        }));
    }
    said.warnings.extend(on_another_clock(&trace));
    Ok(trace)
}
