//! A log as a Parquet table.

use std::path::Path;

use crate::log::LogError;
use crate::log::formats::raw::{Raw, RowWord, place};
use crate::log::lines::cell::{self, Numbers};
use crate::log::lines::stamps::Stamps;
use crate::log::naming::columns::Columns;
use crate::log::naming::role::Role;
use crate::table::{Table, TableError};

/// Reads a Parquet file.
pub(in crate::log) fn read(path: &Path, columns: &Columns) -> Result<Raw, LogError> {
    let table = Table::read(path).map_err(|why| failed(path, why))?;
    let choice =
        columns.choose(table.names(), &[]).map_err(|what| LogError::Columns { path: path.to_owned(), what })?;
    let mut raw = Raw::new(path.to_owned(), RowWord::Row, &choice);
    raw.places = (1..=table.rows() as u64).collect();
    for &(role, column) in &choice.columns {
        let name = &table.names()[column];
        let wrong = |row: usize, what: String| LogError::Cell {
            place: format!("{}, column `{name}`", place(path, RowWord::Row, row as u64 + 1)),
            what,
        };
        match role {
            Role::Time => {
                let stamps = if table.is_text(name) == Some(true) {
                    let (mut stamps, mut numbers) = (Stamps::default(), Numbers::of(b','));
                    let texts = table.texts(name).map_err(|why| failed(path, why))?;
                    for (row, text) in texts.iter().enumerate() {
                        let text = text.as_deref().unwrap_or("").trim();
                        stamps.push(text.as_bytes(), &mut numbers).map_err(|what| wrong(row, what))?;
                    }
                    stamps
                } else {
                    Stamps::of_numbers(numbers_of(path, &table, name)?)
                };
                (raw.time_s, raw.midnight_s) = stamps.finish(choice.time_unit, &mut raw.notes);
            }
            Role::Led => {
                // Numbers and truth values become text that reads as in a text file.
                let texts = table.texts(name).map_err(|why| failed(path, why))?;
                let led = texts.iter().enumerate().map(|(row, text)| {
                    let text = text.as_deref().unwrap_or("").trim();
                    cell::led(text.as_bytes()).map_err(|what| wrong(row, what))
                });
                raw.led = Some(led.collect::<Result<_, _>>()?);
            }
            Role::Photodiode(_) | Role::Output(_) | Role::Force(_) | Role::Pressure(_) | Role::Contact => {
                let values = numbers_of(path, &table, name)?;
                if let Some(channel) = raw.channel(role) {
                    *channel = values;
                }
            }
        }
    }
    Ok(raw)
}

/// A column of numbers; NaN where it is missing.
fn numbers_of(path: &Path, table: &Table, name: &str) -> Result<Vec<f64>, LogError> {
    table.values(name).map_err(|why| failed(path, why))
}

fn failed(path: &Path, why: TableError) -> LogError {
    match why {
        TableError::Cell { place, what } => LogError::Cell { place, what },
        TableError::Read { path, what } => LogError::File { path, what },
        other => LogError::File { path: path.to_owned(), what: other.to_string() },
    }
}
