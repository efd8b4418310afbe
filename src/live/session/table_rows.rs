//! Opening what is no bytes: Parquet tables and XDF recordings as rows of a stream, generated fingers.

use std::path::Path;

use lunula_live::source::{HostClock, Place, Rows, Stream, StreamOptions as WireOptions};

use crate::live::error::LiveError;
use crate::live::options::StreamOptions;
use crate::table::Table;

/// Opens a session's source.
///
/// # Errors
/// A source that can't be opened.
pub(super) fn open_stream(options: &StreamOptions, clock: HostClock) -> Result<Stream, LiveError> {
    let source = &options.source;
    let refused = |what: String| LiveError::Source { place: source.to_string(), what };
    let wire = WireOptions { names: options.names.clone(), volts_per_count: options.volts_per_count };
    match &source.place {
        Place::File { path, .. } if is_parquet(path) => {
            let rows = TableRows::read(path)?;
            Ok(Stream::of_rows(source, wire, clock, Box::new(rows)))
        }
        Place::File { path, .. } if is_xdf(path) => Err(refused(
            "XDF recordings are not played back yet; `lunula align` and `lunula train` read them".to_owned(),
        )),
        _ => {
            let opened = Stream::open(source, wire, clock);
            opened.map_err(|why| LiveError::Source { place: why.place, what: why.what })
        }
    }
}

fn ends_with(path: &Path, ending: &str) -> bool {
    path.to_string_lossy().to_ascii_lowercase().ends_with(ending)
}

fn is_parquet(path: &Path) -> bool {
    ends_with(path, ".parquet")
}

fn is_xdf(path: &Path) -> bool {
    ends_with(path, ".xdf") || ends_with(path, ".xdfz")
}

/// A table's columns of numbers.
struct TableRows {
    names: Vec<String>,
    columns: Vec<Vec<f64>>,
    row: usize,
}

impl TableRows {
    fn read(path: &Path) -> Result<Self, LiveError> {
        let table = Table::read(path)?;
        let mut rows = Self { names: Vec::new(), columns: Vec::new(), row: 0 };
        for name in table.names() {
            // Columns of text hold nothing that a stream reads.
            if let Ok(values) = table.numbers_or_nan(name) {
                rows.names.push(name.clone());
                rows.columns.push(values.into_iter().map(|value| value.unwrap_or(f64::NAN)).collect());
            }
        }
        Ok(rows)
    }
}

impl Rows for TableRows {
    fn names(&self) -> &[String] {
        &self.names
    }

    fn next(&mut self, cells: &mut [f64]) -> Result<bool, String> {
        let known = self.columns.first().is_some_and(|column| self.row < column.len());
        if known {
            for (cell, column) in cells.iter_mut().zip(&self.columns) {
                *cell = column[self.row];
            }
            self.row += 1;
        }
        Ok(known)
    }
}
