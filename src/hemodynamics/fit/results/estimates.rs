//! What was fitted as a table: a row a free parameter, then offset and scaling of each photodiode.
//!
//! Columns: `name`, `recordings` (of a photodiode, counted from 1 in the order given), `start`, `value`,
//! `standard_error`, `low`, `high` (the interval of two standard errors where it is known), `at_bound`; each in the
//! unit that its name holds.

use std::path::Path;

use lunula_hemodynamics::{Bound, Calibrated, Estimate, FitResult, Group, Parameters, Symbol};

use crate::hemodynamics::HemodynamicsError;
use crate::table::{Column, TableError, TableWriter, Value};

/// Writes the table that is to stand at `path` to `at`.
pub(in crate::hemodynamics::fit) fn write(
    result: &FitResult,
    start: &Parameters,
    at: &Path,
    path: &Path,
) -> Result<(), HemodynamicsError> {
    let mut columns = ["name", "recordings"].map(Column::text).to_vec();
    columns.extend(["start", "value", "standard_error", "low", "high"].map(Column::number));
    columns.push(Column::text("at_bound"));
    let mut table = TableWriter::create(at, path, columns, &[])?;
    for group in &result.groups {
        for k in 0..group.symbols.len() {
            write_free(group, k, start, &mut table)?;
        }
    }
    for one in &result.photodiodes {
        write_calibrated(one, Symbol::Offset(one.unit), &one.offset, start, &mut table)?;
        write_calibrated(one, Symbol::Scaling(one.unit), &one.scaling, start, &mut table)?;
    }
    Ok(table.finish()?)
}

fn write_free(group: &Group, k: usize, start: &Parameters, table: &mut TableWriter) -> Result<(), TableError> {
    let symbol = group.symbols[k];
    let of = |values: &Option<Vec<f64>>| Value::from(values.as_ref().map(|values| values[k]));
    table.write(&[
        Value::Text(&symbol.to_string()),
        Value::Missing,
        Value::from(start.get(symbol)),
        Value::Number(group.values[k]),
        of(&group.standard_errors),
        of(&group.interval[0]),
        of(&group.interval[1]),
        Value::Text(group.at_bound.map_or("", Bound::word)),
    ])
}

fn write_calibrated(
    one: &Calibrated,
    symbol: Symbol,
    found: &Estimate,
    start: &Parameters,
    table: &mut TableWriter,
) -> Result<(), TableError> {
    let recordings: Vec<String> = one.recordings.iter().map(|k| (k + 1).to_string()).collect();
    table.write(&[
        Value::Text(&symbol.to_string()),
        Value::Text(&recordings.join(" ")),
        Value::from(start.get(symbol)),
        Value::Number(found.value),
        Value::from(found.standard_error),
        Value::from(found.interval[0]),
        Value::from(found.interval[1]),
        Value::Missing,
    ])
}
