//! Opening what is no bytes: Parquet tables and XDF recordings as rows of a stream, generated fingers.

use std::path::Path;

use lunula_live::source::{HostClock, Place, Rows, Stream, StreamOptions as WireOptions};
use lunula_live::wire::{Meaning, Use};

use crate::live::error::LiveError;
use crate::live::options::StreamOptions;
use crate::predictor::GROUPS;
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

/// A table's columns: numbers, and texts of those that say what a row is.
struct TableRows {
    names: Vec<String>,
    numbers: Vec<Vec<f64>>,
    texts: Vec<Vec<String>>,
    /// Which texts a row gives.
    kept: Vec<usize>,
    row: usize,
    rows: usize,
}

impl TableRows {
    fn read(path: &Path) -> Result<Self, LiveError> {
        let table = Table::read(path)?;
        let mut rows = Self {
            names: table.names().to_vec(),
            numbers: Vec::new(),
            texts: Vec::new(),
            kept: Vec::new(),
            row: 0,
            rows: table.rows(),
        };
        for name in table.names() {
            let (mut numbers, mut texts) = (Vec::new(), Vec::new());
            if name == "sensor_status" || GROUPS.contains(&name.as_str()) {
                table.each_text(name, |_, text| texts.push(text.to_owned()))?;
            } else if let Ok(values) = table.numbers_or_nan(name) {
                numbers = values.into_iter().map(|value| value.unwrap_or(f64::NAN)).collect();
            }
            rows.numbers.push(numbers);
            rows.texts.push(texts);
        }
        Ok(rows)
    }
}

impl Rows for TableRows {
    fn names(&self) -> &[String] {
        &self.names
    }

    fn keep(&mut self, meaning: &Meaning) {
        let texts = meaning.uses.iter().enumerate().filter(|(_, what)| matches!(what, Use::Text(_)));
        self.kept = texts.map(|(k, _)| k).collect();
    }

    fn next(&mut self, cells: &mut [f64], texts: &mut [Vec<u8>]) -> Result<bool, String> {
        if self.row == self.rows {
            return Ok(false);
        }
        for (cell, column) in cells.iter_mut().zip(&self.numbers) {
            // A column of text that a number is asked of has none.
            *cell = column.get(self.row).copied().unwrap_or(f64::NAN);
        }
        for (text, &column) in texts.iter_mut().zip(&self.kept) {
            text.clear();
            text.extend(self.texts[column].get(self.row).into_iter().flat_map(|text| text.bytes()));
        }
        self.row += 1;
        Ok(true)
    }
}
