//! `lunula predict`: voltages to forces and angle, of a recording; of a stream, `live` does it.

use std::path::{Path, PathBuf};

use lunula_predictor::{Contact, Gate};
use serde::Serialize;

use crate::files::Places;
use crate::job::{Report, Watch};
use crate::log::{GROUPS, ambient_step_of};
use crate::predictor::data::{Inputs, RowOptions, read_inputs};
use crate::predictor::error::PredictorError;
use crate::predictor::jobs::answer::{Answering, contact_word, interval_cells};
use crate::predictor::merit::doubts::extrapolated;
use crate::predictor::open_models;
use crate::stages::{Stages, Step, left_out};
use crate::table::{Column, TableFormat, TableWriter, Value, column_names};

/// How to predict.
#[derive(Debug, Clone)]
pub struct PredictOptions {
    /// Equation 9's threshold and angle while touching.
    pub gate: Gate,
    /// Each prediction's interval as well.
    pub intervals: bool,
    /// Which rows are answered.
    pub rows: RowOptions,
}

/// Columns that say of which part of the data a row is.
const TRIAL: &str = "trial";
const PARTS: [&str; 4] = [TRIAL, GROUPS[0], GROUPS[1], GROUPS[2]];

/// What was predicted.
pub type PredictReport = Report<PredictFigures>;

/// The figures of a run.
#[derive(Debug, Clone, Serialize)]
pub struct PredictFigures {
    /// The recording.
    pub data: PathBuf,
    /// The table of predictions.
    pub out: PathBuf,
    /// What is predicted.
    pub columns: Vec<String>,
    /// Rows.
    pub rows: u64,
    /// Rows of which something is not known.
    pub rows_not_known: u64,
    /// Rows outside of what a model was trained on: the prediction is an extrapolation.
    pub rows_outside: u64,
    /// Rows in touch and bending, where the two are gated.
    pub touch: u64,
    /// See `touch`.
    pub bending: u64,
}

#[derive(Debug, Clone, Copy, Default)]
struct Counts {
    rows: u64,
    not_known: u64,
    touch: u64,
    bending: u64,
}

impl Counts {
    fn count(&mut self, contact: Option<Contact>, answer: &[f64]) {
        self.rows += 1;
        self.not_known += u64::from(!answer.iter().all(|value| value.is_finite()));
        self.touch += u64::from(contact == Some(Contact::Touch));
        self.bending += u64::from(contact == Some(Contact::Bending));
    }
}

/// Predicts a table's rows into another table.
///
/// # Errors
/// [`PredictorError`] where there is no table of predictions.
pub fn predict(
    models: &[PathBuf],
    data: &Path,
    options: &PredictOptions,
    out: &Path,
    watch: &Watch<'_>,
) -> Result<PredictReport, PredictorError> {
    let stages = Stages::default();
    TableFormat::of(out)?;
    let mut places = Places::not_over(models.iter().map(PathBuf::as_path).chain([data]));
    places.check([out])?;
    let opened = open_models(models)?;
    let mut warnings = opened.warnings;
    let mut answering = Answering::new(opened.predictors, options.gate, options.intervals)?;
    let inputs = answering.inputs().to_vec();
    let read = stages.time("read", || read_inputs(data, &inputs, &options.rows))?;
    warnings.extend(read.warnings.iter().cloned());
    watch.go_on()?;
    if answering.needs_time() && !read.time_s.is_empty() && read.time_s.iter().all(|time| time.is_nan()) {
        let what = "has no time_s, and a model reads voltages of the past (it was trained with --lags); give it the \
                    time in seconds";
        return Err(PredictorError::Request(format!("{}: {what}", data.display())));
    }
    let (answers, sds, contacts, counts) =
        stages.time("predict", || all_rows(&mut answering, &read, options.rows.keep_faults));
    watch.go_on()?;
    let at = places.place(out)?;
    stages.time("write", || {
        let mut columns = vec![Column::number("time_s")];
        columns.extend(answering.output_columns().into_iter().map(Column::number));
        let with_sd = answering.with_sd();
        columns.extend(with_sd.iter().map(|&at| Column::number(format!("{}_sd", answering.columns()[at]))));
        if answering.is_gated() {
            columns.push(Column::text("contact"));
        }
        let mut table = TableWriter::create(&at, out, columns, &facts())?;
        let half_widths = answering.half_widths();
        let width = answering.columns().len();
        table.write_rows(read.time_s.len(), &|row, write| {
            let answer = &answers[row * width..(row + 1) * width];
            let mut cells = vec![Value::Number(read.time_s[row])];
            cells.extend(answer.iter().map(|value| Value::Number(*value)));
            let ruled = answering.ruled(contacts.get(row).copied());
            cells.extend(interval_cells(answer, half_widths.as_deref(), ruled).map(Value::Number));
            cells.extend(with_sd.iter().map(|&at| Value::Number(sds[row * width + at])));
            if let Some(contact) = contacts.get(row) {
                cells.push(Value::Text(contact_word(*contact)));
            }
            write(&cells);
        })?;
        table.finish()
    })?;
    places.commit()?;
    warnings.extend(extrapolated(answering.outside(), counts.rows));
    if counts.rows > 0 && counts.not_known == counts.rows {
        warnings.push(format!(
            "none of {} rows has a prediction: a reading is missing in each, or the reading of the past that a model \
             with lags needs",
            counts.rows
        ));
    }
    let ambient = ambient_step_of([data], &options.rows.log);
    let left_out = left_out(predict_plan(models.len(), ambient, options));
    let figures = PredictFigures {
        data: data.to_owned(),
        out: out.to_owned(),
        columns: answering.output_columns(),
        rows: counts.rows,
        rows_not_known: counts.not_known,
        rows_outside: answering.outside(),
        touch: counts.touch,
        bending: counts.bending,
    };
    let several = read.recordings.len() > 1;
    let names = column_names(data).unwrap_or_default();
    let left: Vec<&str> = PARTS.into_iter().filter(|part| names.iter().any(|name| name == part)).collect();
    let mut notes = read.notes;
    if left.contains(&TRIAL) || several && !left.is_empty() {
        notes.push(format!(
            "predictions have no column {}: where trials, days or persons have to stay apart, as for `skill`, predict \
             each by itself",
            left.join(", ")
        ));
    }
    let mut report = Report { left_out, warnings, notes, ..Report::new("predict", watch, figures) };
    if !answering.is_gated() {
        report.unused(&Answering::GATES, Answering::NO_GATE);
    }
    Ok(report.timed(&stages))
}

/// What would be done and what not, with so many models; `ambient`: the step of the recording's ambient light.
#[must_use]
pub fn predict_plan(models: usize, ambient: Step, options: &PredictOptions) -> Vec<Step> {
    let gated = models > 1;
    let why = if gated { "where one model predicts forces and one posture" } else { "one model" };
    let intervals = if options.intervals { "of each prediction" } else { "without --intervals" };
    vec![
        Step::new("read", true, "a recording".to_owned()),
        ambient,
        Step::new("predict", true, format!("{models} models")),
        Step::new("gate", gated, why.to_owned()),
        Step::new("intervals", options.intervals, intervals.to_owned()),
    ]
}

/// Answers, their SDs (empty where no model gives any), contacts.
fn all_rows(answering: &mut Answering, read: &Inputs, keep_faults: bool) -> (Vec<f64>, Vec<f64>, Vec<Contact>, Counts) {
    let width = answering.columns().len();
    let mut answers = vec![f64::NAN; read.time_s.len() * width];
    let mut sds = Vec::new();
    let own_sds = !answering.with_sd().is_empty();
    let mut contacts = Vec::new();
    let mut counts = Counts::default();
    let unknown = vec![f64::NAN; read.x.ncols()];
    for recording in &read.recordings {
        for row in recording.rows.clone() {
            let volts = read.x.row(row).to_slice().expect("rows lie one after the other");
            let volts = if read.faulty[row] && !keep_faults { &unknown } else { volts };
            let out = &mut answers[row * width..(row + 1) * width];
            let contact = answering.answer(read.time_s[row], row == recording.rows.start, volts, out);
            counts.count(contact, out);
            if own_sds {
                sds.extend_from_slice(answering.sds());
            }
            contacts.extend(contact);
        }
    }
    (answers, sds, contacts, counts)
}

/// What Parquet keeps beside the cells.
fn facts() -> Vec<(String, String)> {
    [
        ("lunula", env!("CARGO_PKG_VERSION")),
        ("forces", "newtons, of the finger on the surface: pressing down is negative Fz_N"),
        ("angles", "degrees, positive in flexion"),
        (
            "contact",
            "touch where the predicted -Fz_N is at the threshold or above; the angle is the touching one's then",
        ),
    ]
    .map(|(key, value)| (key.to_owned(), value.to_owned()))
    .to_vec()
}
