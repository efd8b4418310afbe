//! Tables as comma-separated values.

use std::fs::File;
use std::io::{BufRead as _, BufReader, Read as _, Write};
use std::path::Path;

use super::cells::{CsvCells, delimiter_of};
use super::{Column, ColumnKind, Value, number_text};
use crate::input;

/// A CSV file in the making.
#[derive(Debug)]
pub(super) struct CsvWriter<W: Write> {
    rows: csv::Writer<W>,
}

impl CsvWriter<File> {
    pub(super) fn create(at: &Path, columns: &[Column]) -> Result<Self, String> {
        let mut rows = csv::Writer::from_path(at).map_err(|e| e.to_string())?;
        rows.write_record(columns.iter().map(|c| &c.name)).map_err(|e| e.to_string())?;
        Ok(Self { rows })
    }

    /// Adds rows that were formatted elsewhere.
    pub(super) fn append(&mut self, text: &[u8]) -> Result<(), String> {
        self.rows.flush().and_then(|()| self.rows.get_ref().write_all(text)).map_err(|e| e.to_string())
    }
}

impl<W: Write> CsvWriter<W> {
    /// Rows alone, without the columns' names.
    pub(super) fn new(into: W) -> Self {
        Self { rows: csv::Writer::from_writer(into) }
    }

    pub(super) fn write(&mut self, cells: &[Value<'_>], columns: &[Column]) -> Result<(), String> {
        for (cell, column) in cells.iter().zip(columns) {
            let decimals = column.decimals();
            let written = match (cell, column.kind) {
                (Value::Missing, _) => self.rows.write_field(""),
                (Value::Text(text), _) => self.rows.write_field(text),
                (Value::Integer(whole), ColumnKind::Number { .. }) => {
                    self.rows.write_field(number_text(*whole as f64, decimals).unwrap_or_default())
                }
                (Value::Integer(whole), _) => self.rows.write_field(whole.to_string()),
                (Value::Number(number), _) => self.rows.write_field(number_text(*number, decimals).unwrap_or_default()),
            };
            written.map_err(|e| e.to_string())?;
        }
        self.rows.write_record(None::<&[u8]>).map_err(|e| e.to_string())
    }

    /// What was written to.
    pub(super) fn finish(self) -> Result<W, String> {
        self.rows.into_inner().map_err(|e| e.to_string())
    }
}

/// The names and the rows of a CSV file.
pub(super) fn read(path: &Path) -> Result<(Vec<String>, CsvCells), String> {
    CsvCells::read(input::read(path).map_err(|e| e.to_string())?)
}

/// The names of a CSV file's columns, the rows unread.
pub(super) fn names(path: &Path) -> Result<Vec<String>, String> {
    let mut file = BufReader::new(input::open(path).map_err(|e| e.to_string())?);
    let mut first = Vec::new();
    while first.trim_ascii().is_empty() && file.read_until(b'\n', &mut first).map_err(|e| e.to_string())? > 0 {}
    let delimiter = delimiter_of(&String::from_utf8_lossy(&first));
    let rows = first.chain(file);
    let mut reader = csv::ReaderBuilder::new().delimiter(delimiter).trim(csv::Trim::All).from_reader(rows);
    let names = reader.headers().map_err(|why| match why.kind() {
        csv::ErrorKind::Utf8 { .. } => "the line of names is not UTF-8 text; save the file as UTF-8".to_owned(),
        _ => why.to_string(),
    })?;
    Ok(names.iter().map(str::to_owned).collect())
}
