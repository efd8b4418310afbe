//! Opening what is no bytes: Parquet tables and XDF recordings as rows of a stream, generated fingers.

use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

use lunula_live::source::{Place, Rows, Stream, StreamOptions as WireOptions};
use lunula_live::wire::{Meaning, Naming, Use};

use crate::live::error::LiveError;
use crate::live::options::StreamOptions;
use crate::live::session::run::source_fault;
use crate::predictor::GROUPS;
use crate::table::Table;

/// Opens a session's source at `now_ns` of its clock.
///
/// # Errors
/// A source that can't be opened.
pub(super) fn open_stream(options: &StreamOptions, naming: Naming, now_ns: u64) -> Result<Stream, LiveError> {
    let mut source = options.source.clone();
    source.volts_per_count = options.volts_per_count.or(source.volts_per_count);
    let since_1970 = SystemTime::now().duration_since(UNIX_EPOCH).ok();
    let wire = WireOptions {
        columns: options.names.clone(),
        host_start_unix_s: since_1970.map(|since| since.as_secs_f64() - 1e-9 * now_ns as f64),
    };
    match &source.place {
        Place::File { path, pace, looped } if is_parquet(path) => {
            let rows = Box::new(TableRows::read(path)?);
            let name = source.to_string();
            Ok(Stream::of_rows(name, rows, (*pace, *looped), source.volts_per_count, &wire, naming))
        }
        Place::File { path, .. } if is_xdf(path) => Err(LiveError::Source {
            place: source.to_string(),
            what: "XDF recordings are not played back yet; `lunula align` and `lunula train` read them".to_owned(),
        }),
        _ => Stream::open(&source, wire, naming, now_ns).map_err(|why| source_fault(&source, why)),
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

    fn rewind(&mut self) -> Result<(), String> {
        self.row = 0;
        Ok(())
    }
}
