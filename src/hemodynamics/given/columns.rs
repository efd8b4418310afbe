//! Columns of numbers of a table, every fault told with its row and column.

use std::path::{Path, PathBuf};

use crate::hemodynamics::HemodynamicsError;
use crate::table::{Cell, Table};

/// Seconds.
pub(in crate::hemodynamics) const TIME: &str = "time_s";
/// `P_F1` and `P_F2`.
pub(in crate::hemodynamics) const PRESSED: [&str; 2] = ["pf1_Pa", "pf2_Pa"];
/// `P_H` and `P_L`.
pub(in crate::hemodynamics) const BLOOD: [&str; 2] = ["ph_Pa", "pl_Pa"];

/// So many faults of a table are told.
const MOST_FAULTS: usize = 10;

/// Named columns of a table, whole.
#[derive(Debug, Clone)]
pub(in crate::hemodynamics) struct Columns {
    /// The table.
    pub(in crate::hemodynamics) path: PathBuf,
    names: Vec<String>,
    values: Vec<Vec<f64>>,
}

impl Columns {
    /// A column's values; `None` where it was not there.
    pub(in crate::hemodynamics) fn get(&self, name: &str) -> Option<&[f64]> {
        let at = self.names.iter().position(|one| one == name)?;
        Some(&self.values[at])
    }
}

/// Reads the columns that are `needed` and those `wanted` that are there. Every cell has to be a finite number.
///
/// # Errors
/// A table that can't be read; columns that are missing, all of them; cells that are empty or no finite number, with row and column; no
/// rows; where `time` is one of the columns, times that do not ascend.
pub(in crate::hemodynamics) fn numbers(
    path: &Path,
    needed: &[&str],
    wanted: &[&str],
    time: &str,
) -> Result<Columns, HemodynamicsError> {
    let table = Table::read(path)?;
    let has = |name: &&&str| table.names().iter().any(|own| own == **name);
    let missing: Vec<String> = needed.iter().filter(|name| !has(name)).map(|name| format!("`{name}`")).collect();
    if !missing.is_empty() {
        let mut what = format!(
            "has no column {}; its columns are {}: rename or add what is missing",
            missing.join(", "),
            table.names().join(", ")
        );
        if table.names().iter().any(|name| name.contains([';', '\t'])) {
            what += "; columns are separated by commas";
        }
        return Err(HemodynamicsError::table(path, what));
    }
    if table.rows() == 0 {
        return Err(HemodynamicsError::table(path, "has no rows"));
    }
    let mut faults: Vec<(usize, String)> = Vec::new();
    let mut fault = |row: usize, name: &str, what: String| faults.push((row, table.cell(row, name, what).to_string()));
    let mut columns = Columns { path: path.to_owned(), names: Vec::new(), values: Vec::new() };
    for name in needed.iter().chain(wanted.iter().filter(|name| has(name))) {
        let mut values = Vec::with_capacity(table.rows());
        table.each_cell(name, |row, cell| {
            let shown = match cell {
                Cell::Number(value) if value.is_finite() => {
                    values.push(value);
                    return Ok(());
                }
                Cell::Number(value) => format!("`{value}` is no finite number"),
                Cell::Text(text) => format!("`{text}` is no number"),
                Cell::Missing => "is empty".to_owned(),
            };
            values.push(f64::NAN);
            fault(
                row,
                name,
                format!("{shown}; a load or response has to be known in every row: correct it or leave the row out"),
            );
            Ok(())
        })?;
        if *name == time {
            for (row, pair) in values.windows(2).enumerate() {
                if pair[1] <= pair[0] {
                    let what = format!("{} s comes after {} s; times have to grow from row to row", pair[1], pair[0]);
                    fault(row + 1, name, what);
                }
            }
        }
        columns.names.push((*name).to_owned());
        columns.values.push(values);
    }
    if faults.is_empty() {
        return Ok(columns);
    }
    faults.sort_by_key(|(row, _)| *row);
    let more = faults.len().saturating_sub(MOST_FAULTS);
    let mut told: Vec<String> = faults.into_iter().take(MOST_FAULTS).map(|(_, what)| what).collect();
    if more > 0 {
        told.push(format!("and {more} more"));
    }
    Err(HemodynamicsError::Rows(told))
}
