//! `lunula switch evaluate`: false switches an hour, misses and delays of a switch on recordings.
//!
//! In: `switch.toml`, recordings with what is true of contact, the models. Out, in a folder: `switch.json`
//! ([`EvaluateSwitchFigures`]), `presses.csv` (a row per press and per missed contact, to look at the false ones), the
//! delays drawn, and `run.json`, the [`EvaluateSwitchReport`] with warnings and times.

use std::path::Path;

use lunula_live::switch::{Evaluation, Fate, Match, SwitchConfig, matches};
use serde::Serialize;

use super::doubts::{elsewhere, heaped};
use super::figures::{WIDTH, delays_chart};
use super::flattery::flattery;
use super::options::ContactOptions;
use super::report::{note, of_another_model};
use super::traces::{SwitchInputs, Traces, read_traces};
use crate::figure::draw_charts;
use crate::files::{Staging, json_text};
use crate::job::{Outputs, Report, Watch};
use crate::live::error::LiveError;
use crate::stages::{Stages, Step, left_out};
use crate::table::{Column, TableWriter, Value};

/// The report, with warnings and times.
const REPORT: &str = "run.json";

/// How a switch did.
pub type EvaluateSwitchReport = Report<EvaluateSwitchFigures>;

/// The figures of an evaluation.
#[derive(Debug, Clone, Serialize)]
pub struct EvaluateSwitchFigures {
    /// The recordings.
    pub recordings: Vec<String>,
    /// What is true contact.
    pub contact: String,
    /// The switch.
    pub switch: SwitchConfig,
    /// Over all recordings.
    #[serde(flatten)]
    pub all: Evaluation,
}

/// Judges a switch.
///
/// # Errors
/// [`LiveError`] where there is nothing to judge it on: nothing is written.
pub fn evaluate_switch(
    switch: &Path,
    inputs: &SwitchInputs,
    options: &ContactOptions,
    outputs: &Outputs,
    watch: &Watch<'_>,
) -> Result<EvaluateSwitchReport, LiveError> {
    let stages = Stages::default();
    let config = read_switch(switch)?;
    let Outputs { out, figures, report: with_report, .. } = outputs;
    let staging = Staging::new(out)?;
    let Traces { recordings: read, traces, led, model_sha256, mut warnings, notes, failed } =
        stages.time("predict", || read_traces(inputs, config.column.as_deref(), options, watch))?;
    warnings.extend(of_another_model(&config, model_sha256.as_deref()));
    warnings.extend(stages.time("compare with training", || flattery(inputs, options))?);
    let all = stages.time("switch", || Evaluation::of(&config, &traces));
    watch.go_on()?;
    let mut report = Report {
        warnings,
        notes,
        failed,
        left_out: left_out(evaluate_plan(inputs.recordings.len(), outputs)),
        ..Report::new(
            "switch evaluate",
            watch,
            EvaluateSwitchFigures {
                recordings: read.clone(),
                contact: options.contact.to_string(),
                switch: config.clone(),
                all: all.clone(),
            },
        )
    };
    note(&mut report, &all, inputs, options, led);
    let found: Vec<Vec<Match>> = traces.iter().map(|trace| matches(&config, trace)).collect();
    report.warnings.extend(elsewhere(&read, &traces, &found));
    report.warnings.extend(heaped(&read, &traces, &found));
    write_presses(&staging, &read, &found)?;
    if *figures {
        let draw = |png: &Path, svg: &Path| draw_charts(&[delays_chart(&found)], WIDTH, png, svg);
        report.pictures.push(stages.time("figures", || staging.draw("delays", draw))?);
    }
    report.warn_of_earlier(&out.join(REPORT));
    let report = report.timed(&stages);
    if *with_report {
        staging.write("switch.json", json_text(&report.figures).as_bytes())?;
        staging.write(REPORT, report.text().as_bytes())?;
    }
    staging.commit()?;
    Ok(report)
}

/// A row for each press that is judged and each missed contact.
fn write_presses(staging: &Staging, recordings: &[String], found: &[Vec<Match>]) -> Result<(), LiveError> {
    let name = "presses.csv";
    let columns = vec![
        Column::text("recording"),
        Column::text("kind"),
        Column::number("press_s"),
        Column::number("release_s"),
        Column::number("contact_start_s"),
        Column::number("contact_end_s"),
    ];
    let mut table = TableWriter::create(&staging.place(name)?, &staging.target().join(name), columns, &[])?;
    for (recording, matches) in recordings.iter().zip(found) {
        for one in matches {
            let kind = match one.fate {
                Fate::True => "true",
                Fate::False => "false",
                Fate::Repeated => "repeated",
                Fate::Missed => "missed",
            };
            let contact = one.contact.map_or([f64::NAN; 2], |contact| [contact.start_s, contact.end_s]);
            table.write(&[
                Value::Text(recording),
                Value::Text(kind),
                Value::Number(one.press_s),
                Value::Number(one.release_s),
                Value::Number(contact[0]),
                Value::Number(contact[1]),
            ])?;
        }
    }
    Ok(table.finish()?)
}

/// What would be done and what not.
#[must_use]
pub fn evaluate_plan(recordings: usize, outputs: &Outputs) -> Vec<Step> {
    vec![
        Step::new("predict", true, format!("{recordings} recordings, row by row as live")),
        Step::new("switch", true, "against true contact".to_owned()),
        Step::new("presses", true, "one row each".to_owned()),
        Step::figures(outputs.figures, "delays"),
    ]
}

/// Reads a switch.
///
/// # Errors
/// A file that can't be read, or is no switch, with the keys that are wrong.
pub fn read_switch(path: &Path) -> Result<SwitchConfig, LiveError> {
    let refused = |what: String| LiveError::Config { path: path.to_owned(), what };
    let text = crate::input::read_text(path)
        .map_err(|why| refused(format!("{why} (`lunula switch tune` writes one from recordings)")))?;
    SwitchConfig::from_toml(&text).map_err(|why| refused(why.to_string()))
}
