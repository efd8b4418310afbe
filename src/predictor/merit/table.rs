//! `merit.csv`: how far off a model is, a row a target and for each set of recordings.
//!
//! Columns: `of` (`all`, `recording`, `size`, `without friction`, `held out`, `part held out`, `training`,
//! `validation`), `name`, `session`, `subject`, `target`, `rows`, then `rmse`, `bias`, `r2`, `mae` in the target's
//! unit, and `within`, the share of rows within the prediction intervals.

use std::path::Path;

use crate::predictor::merit::figures::{ByTarget, Merit};
use crate::table::{Column, TableError, TableWriter, Value};

/// Its name in a folder.
pub(in crate::predictor) const MERIT: &str = "merit.csv";

#[derive(Debug)]
pub(in crate::predictor) struct MeritRows<'a> {
    pub(in crate::predictor) of: &'static str,
    pub(in crate::predictor) name: String,
    pub(in crate::predictor) session: &'a str,
    pub(in crate::predictor) subject: &'a str,
    pub(in crate::predictor) merit: &'a Merit,
    pub(in crate::predictor) within: Option<&'a ByTarget<Option<f64>>>,
}

impl<'a> MeritRows<'a> {
    pub(in crate::predictor) fn new(of: &'static str, merit: &'a Merit) -> Self {
        Self { of, name: String::new(), session: "", subject: "", merit, within: None }
    }
}

/// Writes the table that is to stand at `path` to `at`.
pub(in crate::predictor) fn merit_table(at: &Path, path: &Path, all: &[MeritRows<'_>]) -> Result<(), TableError> {
    let mut columns = ["of", "name", "session", "subject", "target"].map(Column::text).to_vec();
    columns.push(Column::integer("rows"));
    columns.extend(["rmse", "bias", "r2", "mae", "within"].map(Column::number));
    let mut table = TableWriter::create(at, path, columns, &[])?;
    for rows in all {
        let merit = rows.merit;
        for (k, (target, rmse)) in merit.rmse.0.iter().enumerate() {
            let [of, name, session, subject, target] =
                [rows.of, &rows.name, rows.session, rows.subject, target].map(Value::Text);
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
                Value::from(rows.within.and_then(|by| by.0[k].1)),
            ])?;
        }
    }
    table.finish()
}
