//! A table in memory, its columns asked for by name.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::cells::CsvCells;
use super::{TableError, TableFormat, csv, parquet};
use crate::words::decimal_comma;

/// A table that was read.
///
/// ```
/// use std::path::Path;
///
/// use lunula::table::Table;
///
/// let table = Table::read(Path::new("fixtures/finger/truth/joints.csv"))?;
/// let j2 = table.numbers("J2_deg")?;
/// // An empty cell is missing, not zero.
/// assert!(j2.len() == 60 && j2.iter().all(Option::is_some));
/// assert!(table.numbers("J4_deg").is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Table {
    path: PathBuf,
    names: Vec<String>,
    /// Where each column is.
    places: HashMap<String, usize>,
    rows: usize,
    cells: Cells,
    facts: Vec<(String, String)>,
}

#[derive(Debug, Clone)]
enum Cells {
    Csv(CsvCells),
    Parquet(Vec<parquet::Read>),
}

/// A cell as it stands in a table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Cell<'a> {
    /// Empty.
    Missing,
    /// A number; it need not be finite.
    Number(f64),
    /// Text that is no number.
    Text(&'a str),
}

impl<'a> Cell<'a> {
    fn of(text: &'a str) -> Self {
        if text.is_empty() { Self::Missing } else { text.parse().map_or(Self::Text(text), Self::Number) }
    }
}

/// The names of a table's columns, the rows unread.
///
/// # Errors
/// An unknown extension, a file that is missing or damaged.
pub fn column_names(path: &Path) -> Result<Vec<String>, TableError> {
    match TableFormat::of(path)? {
        TableFormat::Csv => csv::names(path),
        TableFormat::Parquet => parquet::names(path),
    }
    .map_err(|what| TableError::Read { path: path.to_owned(), what })
}

impl Table {
    /// Reads a CSV or Parquet file.
    ///
    /// # Errors
    /// An unknown extension, a file that is missing or damaged, rows of unequal length, two columns of one name.
    pub fn read(path: &Path) -> Result<Self, TableError> {
        let failed = |what: String| TableError::Read { path: path.to_owned(), what };
        let (names, cells, facts) = match TableFormat::of(path)? {
            TableFormat::Csv => {
                let (names, rows) = csv::read(path).map_err(failed)?;
                (names, Cells::Csv(rows), Vec::new())
            }
            TableFormat::Parquet => {
                let read = parquet::read(path).map_err(failed)?;
                (read.names, Cells::Parquet(read.columns), read.facts)
            }
        };
        Self::checked(path, names, cells, facts)
    }

    /// Reads the text of a CSV file that is to stand at `path`.
    ///
    /// # Errors
    /// Rows of unequal length, two columns of one name.
    pub(crate) fn of_csv(path: &Path, text: &str) -> Result<Self, TableError> {
        let failed = |what: String| TableError::Read { path: path.to_owned(), what };
        let (names, rows) = CsvCells::read(text.as_bytes().to_vec()).map_err(failed)?;
        Self::checked(path, names, Cells::Csv(rows), Vec::new())
    }

    fn checked(
        path: &Path,
        names: Vec<String>,
        cells: Cells,
        facts: Vec<(String, String)>,
    ) -> Result<Self, TableError> {
        let failed = |what: String| TableError::Read { path: path.to_owned(), what };
        if names.is_empty() {
            return Err(failed("is empty; a table begins with the names of its columns".to_owned()));
        }
        let mut places = HashMap::with_capacity(names.len());
        for (k, name) in names.iter().enumerate() {
            // Spreadsheets leave columns without a name behind.
            if *places.entry(name.clone()).or_insert(k) != k && !name.is_empty() {
                return Err(failed(format!("two columns are named `{name}`; rename one")));
            }
        }
        let rows = match &cells {
            Cells::Csv(rows) => rows.rows(),
            Cells::Parquet(columns) => columns[0].rows(),
        };
        Ok(Self { path: path.to_owned(), names, places, rows, cells, facts })
    }

    /// The columns' names, in order.
    #[must_use]
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Whether there is a column of this name.
    #[must_use]
    pub fn has(&self, name: &str) -> bool {
        self.places.contains_key(name)
    }

    /// The number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Facts on the whole table; only Parquet keeps them.
    #[must_use]
    pub fn facts(&self) -> &[(String, String)] {
        &self.facts
    }

    /// Whether a column holds text; of a CSV file every column does. None where there is no such column.
    #[must_use]
    pub fn is_text(&self, name: &str) -> Option<bool> {
        let column = *self.places.get(name)?;
        Some(match &self.cells {
            Cells::Csv(_) => true,
            Cells::Parquet(columns) => matches!(columns[column], parquet::Read::Texts(_)),
        })
    }

    /// A column of numbers; none where a cell is empty.
    ///
    /// # Errors
    /// No such column, or a cell that is no finite number.
    pub fn numbers(&self, name: &str) -> Result<Vec<Option<f64>>, TableError> {
        self.numbers_where(name, f64::is_finite)
    }

    /// A column of numbers as other programs write them; none where a cell is empty, NaN where it says so.
    ///
    /// # Errors
    /// No such column, or a cell that is no number or infinite.
    pub fn numbers_or_nan(&self, name: &str) -> Result<Vec<Option<f64>>, TableError> {
        self.numbers_where(name, |number| !number.is_infinite())
    }

    /// The same, NaN where a cell is empty as well.
    ///
    /// # Errors
    /// No such column, or a cell that is no number or infinite.
    pub fn values(&self, name: &str) -> Result<Vec<f64>, TableError> {
        Ok(self.numbers_or_nan(name)?.into_iter().map(|number| number.unwrap_or(f64::NAN)).collect())
    }

    fn numbers_where(&self, name: &str, allowed: fn(f64) -> bool) -> Result<Vec<Option<f64>>, TableError> {
        let bad = |row: usize, shown: String| {
            let what = format!("`{shown}` is no finite number{}; correct it or leave it empty", decimal_comma(&shown));
            Err(self.cell(row, name, what))
        };
        let mut numbers = Vec::with_capacity(self.rows);
        self.each_cell(name, |row, cell| {
            numbers.push(match cell {
                Cell::Missing => None,
                Cell::Number(number) if allowed(number) => Some(number),
                Cell::Number(number) => return bad(row, number.to_string()),
                Cell::Text(text) => return bad(row, text.to_owned()),
            });
            Ok(())
        })?;
        Ok(numbers)
    }

    /// Hands on a column cell by cell, with its row.
    ///
    /// # Errors
    /// No such column, or the first error that `take` returns.
    pub fn each_cell<'a>(
        &'a self,
        name: &str,
        mut take: impl FnMut(usize, Cell<'a>) -> Result<(), TableError>,
    ) -> Result<(), TableError> {
        let column = self.place(name)?;
        match &self.cells {
            Cells::Csv(rows) => (0..rows.rows()).try_for_each(|row| take(row, Cell::of(rows.cell(row, column)))),
            Cells::Parquet(columns) => match &columns[column] {
                parquet::Read::Integers(known) => known
                    .iter()
                    .enumerate()
                    .try_for_each(|(row, v)| take(row, v.map_or(Cell::Missing, |v| Cell::Number(v as f64)))),
                parquet::Read::Numbers(known) => {
                    known.iter().enumerate().try_for_each(|(row, v)| take(row, v.map_or(Cell::Missing, Cell::Number)))
                }
                parquet::Read::Texts(known) => known.iter().enumerate().try_for_each(|(row, v)| {
                    take(row, v.as_deref().filter(|t| !t.is_empty()).map_or(Cell::Missing, Cell::Text))
                }),
            },
        }
    }

    /// Hands on a column of text cell by cell, with its row; an empty cell is an empty text. Numbers are written out.
    ///
    /// # Errors
    /// No such column.
    pub fn each_text(&self, name: &str, mut take: impl FnMut(usize, &str)) -> Result<(), TableError> {
        let column = self.place(name)?;
        match &self.cells {
            Cells::Csv(rows) => (0..rows.rows()).for_each(|row| take(row, rows.cell(row, column))),
            Cells::Parquet(_) => {
                let texts = self.texts(name)?;
                texts.iter().enumerate().for_each(|(row, v)| take(row, v.as_deref().unwrap_or("")));
            }
        }
        Ok(())
    }

    /// A column of whole numbers; none where a cell is empty.
    ///
    /// # Errors
    /// No such column, or a cell that is no whole number.
    pub fn integers(&self, name: &str) -> Result<Vec<Option<i64>>, TableError> {
        const WHAT: &str = "is no whole number; correct it or leave it empty";
        let bad = |row: usize, shown: String| self.cell(row, name, format!("`{shown}` {WHAT}"));
        let column = self.place(name)?;
        match &self.cells {
            Cells::Csv(rows) => {
                each(known(rows, column), |row, text| text.parse().map_err(|_| bad(row, text.to_owned())))
            }
            Cells::Parquet(columns) => match &columns[column] {
                parquet::Read::Integers(known) => Ok(known.clone()),
                parquet::Read::Numbers(known) => each(known.iter().copied(), |row, number: f64| {
                    // Whole numbers up to 2^53 are exact.
                    let whole = number.fract() == 0.0 && number.abs() <= 9_007_199_254_740_992.0;
                    if whole { Ok(number as i64) } else { Err(bad(row, number.to_string())) }
                }),
                parquet::Read::Texts(known) => {
                    each(known.iter().map(Option::as_ref), |row, text| Err(bad(row, text.clone())))
                }
            },
        }
    }

    /// A column as text; none where a cell is empty.
    ///
    /// # Errors
    /// No such column.
    pub fn texts(&self, name: &str) -> Result<Vec<Option<String>>, TableError> {
        let column = self.place(name)?;
        Ok(match &self.cells {
            Cells::Csv(rows) => known(rows, column).map(|text| text.map(str::to_owned)).collect(),
            Cells::Parquet(columns) => match &columns[column] {
                parquet::Read::Integers(known) => known.iter().map(|v| v.map(|v| v.to_string())).collect(),
                parquet::Read::Numbers(known) => known.iter().map(|v| v.map(|v| v.to_string())).collect(),
                parquet::Read::Texts(known) => known.iter().map(|v| v.clone().filter(|t| !t.is_empty())).collect(),
            },
        })
    }

    /// Where a column stands.
    fn place(&self, name: &str) -> Result<usize, TableError> {
        self.places.get(name).copied().ok_or_else(|| {
            let what = format!("has no column `{name}`; its columns are {}", self.names.join(", "));
            TableError::Read { path: self.path.clone(), what }
        })
    }

    /// Where a row stands: its line of a CSV file, else its number, from 1.
    #[must_use]
    pub fn row_place(&self, row: usize) -> String {
        match &self.cells {
            Cells::Csv(rows) => format!("line {}", rows.line(row)),
            Cells::Parquet(_) => format!("row {}", row + 1),
        }
    }

    /// The error of a cell, or of a row at one of its cells, that is wrong.
    pub(crate) fn cell(&self, row: usize, name: &str, what: String) -> TableError {
        let path = self.path.display();
        let place = match &self.cells {
            Cells::Csv(rows) => format!("{path}:{}: column `{name}`", rows.line(row)),
            Cells::Parquet(_) => format!("{path}: row {}, column `{name}`", row + 1),
        };
        TableError::Cell { place, what }
    }
}

/// A column's cells; none where one is empty.
fn known(rows: &CsvCells, column: usize) -> impl Iterator<Item = Option<&str>> {
    (0..rows.rows()).map(move |row| Some(rows.cell(row, column)).filter(|text| !text.is_empty()))
}

/// Converts the known cells.
fn each<T, V>(
    cells: impl Iterator<Item = Option<T>>,
    convert: impl Fn(usize, T) -> Result<V, TableError>,
) -> Result<Vec<Option<V>>, TableError> {
    cells.enumerate().map(|(row, cell)| cell.map(|cell| convert(row, cell)).transpose()).collect()
}
