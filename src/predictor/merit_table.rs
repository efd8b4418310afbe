//! `merit.csv`: how far off a model is, a row a target and whatever it was told on.
//!
//! Columns: `of` (`all`, `recording`, `size`, `without friction`, `held out`, `part held out`, `training`, `validation`), `name`, `session`, `subject`,
//! `target`, `rows`, then `rmse`, `bias`, `r2`, `mae` in the target's unit, and `within`, the share of rows within the prediction intervals.

use std::path::Path;

use super::evaluate::{EvaluateReport, Magnitudes};
use super::figures_of_merit::{ByTarget, Merit};
use crate::table::{Column, TableError, TableWriter, Value};

/// Its name in a folder.
pub(super) const MERIT: &str = "merit.csv";

/// Rows of one merit.
#[derive(Debug)]
pub(super) struct Told<'a> {
    of: &'static str,
    name: String,
    session: &'a str,
    subject: &'a str,
    merit: &'a Merit,
    within: Option<&'a ByTarget<Option<f64>>>,
}

impl<'a> Told<'a> {
    /// Of all recordings.
    pub(super) fn new(of: &'static str, merit: &'a Merit) -> Self {
        Self { of, name: String::new(), session: "", subject: "", merit, within: None }
    }
}

/// All that an evaluation tells.
pub(super) fn evaluated(report: &EvaluateReport) -> Vec<Told<'_>> {
    let mut all = vec![Told { within: report.coverage.as_ref(), ..Told::new("all", &report.merit) }];
    all.extend(report.recordings.iter().map(|one| Told {
        name: one.recording.clone(),
        session: &one.session,
        subject: &one.subject,
        ..Told::new("recording", &one.merit)
    }));
    if let Some(Magnitudes { of, bins }) = &report.by_magnitude {
        let name = |from: f64, to: f64| format!("{of} {from}..{to}");
        all.extend(bins.iter().map(|bin| Told { name: name(bin.from, bin.to), ..Told::new("size", &bin.merit) }));
    }
    all.extend(report.without_friction.iter().map(|merit| Told::new("without friction", merit)));
    if let Some(found) = &report.held_out {
        all.push(Told::new("held out", &found.pooled));
        let parts = found.parts.iter().filter_map(|part| Some((part, part.merit.as_ref()?)));
        all.extend(parts.map(|(part, merit)| Told { name: part.name.clone(), ..Told::new("part held out", merit) }));
    }
    all
}

/// Writes the table that is to stand at `path` to `at`.
pub(super) fn merit_table(at: &Path, path: &Path, all: &[Told<'_>]) -> Result<(), TableError> {
    let mut columns = ["of", "name", "session", "subject", "target"].map(Column::text).to_vec();
    columns.push(Column::integer("rows"));
    columns.extend(["rmse", "bias", "r2", "mae", "within"].map(Column::number));
    let mut table = TableWriter::create(at, path, columns, &[])?;
    for told in all {
        let merit = told.merit;
        for (k, (target, rmse)) in merit.rmse.0.iter().enumerate() {
            let [of, name, session, subject, target] =
                [told.of, &told.name, told.session, told.subject, target].map(Value::Text);
            table.write(&[
                of,
                name,
                session,
                subject,
                target,
                Value::Integer(merit.rows as i64),
                Value::Number(*rmse),
                Value::Number(merit.bias.0[k].1),
                Value::from(merit.r2.0[k].1),
                Value::Number(merit.mae.0[k].1),
                Value::from(told.within.and_then(|by| by.0[k].1)),
            ])?;
        }
    }
    table.finish()
}
