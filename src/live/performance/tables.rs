//! The tables beside the figures: means by method and trial, and the time per decision of each row.

use std::path::Path;

use super::read::Trials;
use super::report::PerformanceFigures;
use crate::files::Places;
use crate::live::error::LiveError;
use crate::table::{Column, TableWriter, Value};

pub(super) const MEANS: &str = "table.csv";
/// The table of rows.
pub(super) const ROWS: &str = "rows.csv";

/// Writes the means, with the better curve and the comparison with the baseline.
pub(super) fn write_means(figures: &PerformanceFigures, folder: &Path, places: &mut Places) -> Result<(), LiveError> {
    let path = folder.join(MEANS);
    let mut columns = vec![Column::text("method"), Column::integer("trial"), Column::integer("n")];
    columns.extend(
        ["mean_s", "sd_s", "curve_s", "difference_s", "difference_low_s", "difference_high_s", "ratio"]
            .map(Column::number),
    );
    let mut table = TableWriter::create(&places.place(&path)?, &path, columns, &[])?;
    for method in &figures.methods {
        let curve = method.fitted.better_curve();
        let compared = figures.comparisons.iter().find(|one| one.method == method.method);
        for of in &method.trials {
            let pair = compared.and_then(|one| one.trials.iter().find(|pair| pair.trial == of.trial));
            let interval = pair.and_then(|pair| pair.paired.difference_interval);
            table.write(&[
                Value::Text(&method.method),
                Value::Integer(i64::from(of.trial)),
                Value::Integer(of.over_operators.n as i64),
                Value::Number(of.over_operators.mean),
                of.over_operators.sd.into(),
                curve.map(|curve| curve.at(f64::from(of.trial))).into(),
                pair.map(|pair| pair.paired.difference).into(),
                interval.map(|[low, _]| low).into(),
                interval.map(|[_, high]| high).into(),
                pair.and_then(|pair| pair.paired.ratio_of_means).into(),
            ])?;
        }
    }
    Ok(table.finish()?)
}

/// Writes the time per decision of each row that is counted.
pub(super) fn write_rows(trials: &Trials, folder: &Path, places: &mut Places) -> Result<(), LiveError> {
    let path = folder.join(ROWS);
    let columns = vec![
        Column::text("operator"),
        Column::text("method"),
        Column::integer("trial"),
        Column::number("time_s"),
        Column::number("decision_s"),
    ];
    let mut table = TableWriter::create(&places.place(&path)?, &path, columns, &[])?;
    for row in &trials.rows {
        table.write(&[
            Value::Text(&trials.operators[row.operator]),
            Value::Text(&trials.methods[row.method]),
            Value::Integer(i64::from(row.trial)),
            Value::Number(row.time_s),
            Value::Number(row.decision_s),
        ])?;
    }
    Ok(table.finish()?)
}
