//! A log's rows one after the other, as a device would send them: for a stream that may go on without end.

use super::doing::Prompting;
use super::lines::{cells, columns};
use super::samples::Samples;
use super::{Faults, LogOptions, Row, Stamps};
use crate::phantom::sensor::CHANNELS;
use crate::table::{Column, Value, number_text};

/// A log that is being taken. Its rows are those of [`LogScene`](super::LogScene) with the same options, its lines
/// those of `log.csv`.
///
/// ```
/// use lunula::phantom::log::{LiveLog, LogOptions, Protocol};
///
/// let log = LiveLog::new(&LogOptions::of(Protocol::Contacts, 1), true, None)?;
/// assert_eq!(log.names()[..3], ["time_s", "led", "P1"]);
/// for sent in log.take(3) {
///     assert_eq!(sent.line.split(',').count(), sent.values.len());
/// }
/// # Ok::<(), lunula::phantom::Faults>(())
/// ```
pub struct LiveLog {
    options: LogOptions,
    columns: Vec<Column>,
    samples: Samples,
}

/// A row as it is sent.
#[derive(Debug, Clone, PartialEq)]
pub struct LiveRow {
    /// With its truth; [`Row::log_s`] says when it is due.
    pub row: Row,
    /// The columns' values, rounded as `log.csv` has them.
    pub values: Vec<f64>,
    /// The line of `log.csv`, without its end.
    pub line: String,
}

impl LiveLog {
    /// Begins a log; `endless`: it goes on after its seconds, with more contacts. Its finger may be one that somebody
    /// prompts, in place of what the options say of its movement; it follows as [`LogOptions::follow`] says. What it is
    /// prompted to is asked for some milliseconds apart and once a row ahead.
    ///
    /// # Errors
    /// [`Faults`]: all that is wrong with the options, and what needs the whole log or is no number.
    pub fn new(options: &LogOptions, endless: bool, prompting: Option<Prompting>) -> Result<Self, Faults> {
        let mut faults = options.check().err().unwrap_or_default();
        faults.need(!options.saturate, || {
            "--saturate: needs the whole log before its first row; leave it out".to_owned()
        });
        faults.need(options.stamps != Stamps::Datetime, || {
            "--stamps datetime: rows are sent as numbers; choose seconds or epoch".to_owned()
        });
        faults.none()?;
        let samples = Samples::new(options, [1.0; CHANNELS], endless, prompting);
        Ok(Self { options: options.clone(), columns: columns(options), samples })
    }

    /// The names of the columns, in their order.
    #[must_use]
    pub fn names(&self) -> Vec<&str> {
        self.columns.iter().map(|column| column.name.as_str()).collect()
    }
}

impl Iterator for LiveLog {
    type Item = LiveRow;

    fn next(&mut self) -> Option<LiveRow> {
        let row = self.samples.next()?;
        let mut date = String::new();
        let cells = cells(&self.options, &row, &mut date);
        let texts: Vec<String> = cells.iter().zip(&self.columns).map(|(cell, column)| text(cell, column)).collect();
        let values = texts.iter().map(|text| text.parse().unwrap_or(f64::NAN)).collect();
        Some(LiveRow { row, values, line: texts.join(",") })
    }
}

/// A cell as the table writes it.
fn text(cell: &Value<'_>, column: &Column) -> String {
    match cell {
        Value::Missing => String::new(),
        Value::Integer(whole) => whole.to_string(),
        Value::Number(number) => number_text(*number, column.decimals()).unwrap_or_default(),
        Value::Text(text) => (*text).to_owned(),
    }
}
