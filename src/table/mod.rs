//! Tables in CSV or Parquet by the file's extension, written and read alike.
//!
//! Out: rows one after the other through a [`TableWriter`], in memory that does not grow with their number. In: a
//! [`Table`] of named columns. A cell is an integer, a number, text or missing: empty in CSV, null in Parquet. A number
//! that is not finite and an empty text are missing too. Numbers of a column with fixed decimals are rounded to them in
//! both formats, so that the same table reads the same from either. Dates with times of day, which other programs write
//! into Parquet, are read as text: ISO 8601, with `Z` where they are in UTC.
//!
//! A writer writes to the given path; [`crate::files`] sees to it that results appear whole or not at all.

mod cells;
mod copies;
mod csv;
mod parquet;
mod plausible;
mod read;

use std::path::{Path, PathBuf};

use rayon::prelude::*;

use crate::words::{Words, fixed};

pub(crate) use cells::{DELIMITERS, delimiter_of, line_of_row};
pub(crate) use copies::copies;
pub use read::{Cell, Table, column_names};

/// Why a table can't be written or read.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum TableError {
    #[error("{}: a table ends in .csv or .parquet; name it so", .0.display())]
    Extension(PathBuf),
    #[error("{}: cannot be written ({why})", path.display())]
    Write { path: PathBuf, why: String },
    #[error("{}: {what}", path.display())]
    Read { path: PathBuf, what: String },
    #[error("{place}: {what}")]
    Cell {
        /// File, line (CSV) or row (Parquet), column.
        place: String,
        what: String,
    },
}

/// How a table is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TableFormat {
    /// Comma-separated values with a line of names, UTF-8; semicolons, tabs and bars are read as well.
    Csv,
    /// Apache Parquet, compressed with Snappy.
    Parquet,
}

impl Words for TableFormat {
    const WORDS: &'static [(Self, &'static str, &'static str)] =
        &[(Self::Csv, "csv", ""), (Self::Parquet, "parquet", "")];
}

impl TableFormat {
    /// The format that a file's extension names.
    ///
    /// # Errors
    /// [`TableError::Extension`] where it names neither.
    pub fn of(path: &Path) -> Result<Self, TableError> {
        match path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase).as_deref() {
            Some("csv") => Ok(Self::Csv),
            Some("parquet") => Ok(Self::Parquet),
            _ => Err(TableError::Extension(path.to_owned())),
        }
    }
}

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ColumnKind {
    /// Whole numbers.
    Integer,
    /// Numbers, with as many decimals as they need or with a fixed count.
    Number {
        /// The count, if fixed.
        decimals: Option<usize>,
    },
    /// Text.
    Text,
}

/// A column to write.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Column {
    /// Its name, with the unit.
    pub name: String,
    /// What it holds.
    pub kind: ColumnKind,
}

impl Column {
    /// A column of whole numbers.
    #[must_use]
    pub fn integer(name: impl Into<String>) -> Self {
        Self { name: name.into(), kind: ColumnKind::Integer }
    }

    /// A column of numbers with as many decimals as they need.
    #[must_use]
    pub fn number(name: impl Into<String>) -> Self {
        Self { name: name.into(), kind: ColumnKind::Number { decimals: None } }
    }

    /// A column of numbers that are rounded to `decimals`.
    #[must_use]
    pub fn rounded(name: impl Into<String>, decimals: usize) -> Self {
        Self { name: name.into(), kind: ColumnKind::Number { decimals: Some(decimals) } }
    }

    /// The fixed count of its decimals.
    pub(crate) fn decimals(&self) -> Option<usize> {
        if let ColumnKind::Number { decimals } = self.kind { decimals } else { None }
    }

    /// A column of text.
    #[must_use]
    pub fn text(name: impl Into<String>) -> Self {
        Self { name: name.into(), kind: ColumnKind::Text }
    }
}

/// A cell to write.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Value<'a> {
    /// Not known.
    Missing,
    /// A whole number.
    Integer(i64),
    /// A number; missing where it is not finite.
    Number(f64),
    /// Text; missing where it is empty.
    Text(&'a str),
}

impl From<Option<f64>> for Value<'_> {
    fn from(number: Option<f64>) -> Self {
        number.map_or(Self::Missing, Self::Number)
    }
}

impl<'a> From<&'a str> for Value<'a> {
    fn from(text: &'a str) -> Self {
        Self::Text(text)
    }
}

/// Makes a row's cells and hands them on.
pub type MakeRow<'a> = dyn Fn(usize, &mut dyn FnMut(&[Value<'_>])) + Sync + 'a;

/// Rows of CSV that are formatted at a time.
const CHUNK: usize = 2048;

/// Writes a table row by row.
#[derive(Debug)]
pub struct TableWriter {
    columns: Vec<Column>,
    /// For messages.
    path: PathBuf,
    rows: u64,
    sink: Sink,
}

#[derive(Debug)]
enum Sink {
    Csv(Box<csv::CsvWriter<std::fs::File>>),
    Parquet(Box<parquet::ParquetWriter>),
}

impl TableWriter {
    /// Starts the table that is to stand at `path` (its extension chooses the format) in the file `at`, with facts on
    /// the whole table (units, signs) that Parquet keeps and CSV has no place for.
    ///
    /// # Errors
    /// An unknown extension, two columns of one name, or a file that can't be written.
    pub fn create(
        at: &Path,
        path: &Path,
        columns: Vec<Column>,
        facts: &[(String, String)],
    ) -> Result<Self, TableError> {
        let refused = |why: String| TableError::Write { path: path.to_owned(), why };
        for (k, column) in columns.iter().enumerate() {
            if columns[..k].iter().any(|c| c.name == column.name) {
                return Err(refused(format!("two columns are named `{}`", column.name)));
            }
        }
        let sink = match TableFormat::of(path)? {
            TableFormat::Csv => Sink::Csv(Box::new(csv::CsvWriter::create(at, &columns).map_err(refused)?)),
            TableFormat::Parquet => {
                Sink::Parquet(Box::new(parquet::ParquetWriter::create(at, &columns, facts).map_err(refused)?))
            }
        };
        Ok(Self { columns, path: path.to_owned(), rows: 0, sink })
    }

    /// Writes a row, a cell a column.
    ///
    /// # Errors
    /// Cells that do not fit the columns, or a file that can't be written on.
    pub fn write(&mut self, cells: &[Value<'_>]) -> Result<(), TableError> {
        self.rows += 1;
        self.check(self.rows, cells)?;
        let written = match &mut self.sink {
            Sink::Csv(sink) => sink.write(cells, &self.columns),
            Sink::Parquet(sink) => sink.write(cells, &self.columns),
        };
        written.map_err(|why| TableError::Write { path: self.path.clone(), why })
    }

    /// Writes `rows` rows: `make` is asked for each, and hands its cells on. The same as row by row; CSV is formatted
    /// on all cores.
    ///
    /// # Errors
    /// As [`write`](Self::write).
    pub fn write_rows(&mut self, rows: usize, make: &MakeRow<'_>) -> Result<(), TableError> {
        let Sink::Csv(_) = &self.sink else {
            for row in 0..rows {
                let mut written = Ok(());
                make(row, &mut |cells| written = self.write(cells));
                written?;
            }
            return Ok(());
        };
        let chunks: Vec<usize> = (0..rows).step_by(CHUNK).collect();
        for batch in chunks.chunks(4 * rayon::current_num_threads()) {
            let text = |&from: &usize| self.text(from..(from + CHUNK).min(rows), make);
            let texts = batch.par_iter().map(text).collect::<Result<Vec<_>, _>>()?;
            let Sink::Csv(sink) = &mut self.sink else { unreachable!("it was CSV before") };
            for text in texts {
                sink.append(&text).map_err(|why| TableError::Write { path: self.path.clone(), why })?;
            }
        }
        self.rows += rows as u64;
        Ok(())
    }

    /// The CSV of these of the rows that are to come.
    fn text(&self, rows: std::ops::Range<usize>, make: &MakeRow<'_>) -> Result<Vec<u8>, TableError> {
        let refused = |why: String| TableError::Write { path: self.path.clone(), why };
        let mut text = csv::CsvWriter::new(Vec::new());
        for row in rows {
            let mut written = Ok(());
            make(row, &mut |cells| {
                written = self
                    .check(self.rows + row as u64 + 1, cells)
                    .and_then(|()| text.write(cells, &self.columns).map_err(refused));
            });
            written?;
        }
        text.finish().map_err(refused)
    }

    /// Whether cells fit the columns.
    fn check(&self, row: u64, cells: &[Value<'_>]) -> Result<(), TableError> {
        if cells.len() != self.columns.len() {
            let why = format!("row {row} has {} cells for {} columns", cells.len(), self.columns.len());
            return Err(TableError::Write { path: self.path.clone(), why });
        }
        for (cell, column) in cells.iter().zip(&self.columns) {
            let fits = match cell {
                Value::Missing => true,
                Value::Integer(_) => column.kind != ColumnKind::Text,
                Value::Number(_) => matches!(column.kind, ColumnKind::Number { .. }),
                Value::Text(_) => column.kind == ColumnKind::Text,
            };
            if !fits {
                let why = format!("{cell:?} in row {row} does not fit the column `{}`", column.name);
                return Err(TableError::Write { path: self.path.clone(), why });
            }
        }
        Ok(())
    }

    /// Ends the table; before, the file is not whole.
    ///
    /// # Errors
    /// A file that can't be written on.
    pub fn finish(self) -> Result<(), TableError> {
        match self.sink {
            Sink::Csv(sink) => sink.finish().map(drop),
            Sink::Parquet(sink) => sink.finish(),
        }
        .map_err(|why| TableError::Write { path: self.path, why })
    }
}

/// A column of a table that is made of rows `R`: its name, and its cell of a row.
pub(crate) type TextColumn<R> = (&'static str, fn(&R) -> String);

/// A small CSV table as bytes; what is wrong with it, in words.
pub(crate) fn csv_bytes<Row: IntoIterator<Item: AsRef<[u8]>>>(
    header: impl IntoIterator<Item: AsRef<[u8]>>,
    rows: impl IntoIterator<Item = Row>,
) -> Result<Vec<u8>, String> {
    let mut table = ::csv::Writer::from_writer(Vec::new());
    table.write_record(header).map_err(|why| why.to_string())?;
    rows.into_iter().try_for_each(|row| table.write_record(row)).map_err(|why| why.to_string())?;
    table.into_inner().map_err(|why| why.to_string())
}

/// The text of a number in a column of fixed or free decimals; none where it is missing.
pub(crate) fn number_text(number: f64, decimals: Option<usize>) -> Option<String> {
    if !number.is_finite() {
        return None;
    }
    let Some(decimals) = decimals else {
        let mut text = String::new();
        push_number(&mut text, number);
        return Some(text);
    };
    Some(fixed(number, decimals))
}

/// Writes a number of a column of free decimals at the end of a line; nothing where it is missing.
pub(crate) fn push_number(line: &mut String, number: f64) {
    use std::fmt::Write;
    if !number.is_finite() {
        return;
    }
    let before = line.len();
    // The shortest text that reads as the same number; it has an exponent where that is shorter. Zero has no sign.
    let _ = write!(line, "{:?}", number + 0.0);
    if line[before..].ends_with(".0") {
        line.truncate(line.len() - 2);
    }
}

/// The number that [`number_text`] writes.
fn number_value(number: f64, decimals: Option<usize>) -> Option<f64> {
    match decimals {
        None => number.is_finite().then_some(number + 0.0),
        Some(_) => number_text(number, decimals)?.parse().ok(),
    }
}

#[cfg(test)]
mod tests;
