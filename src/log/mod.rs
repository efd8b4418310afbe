//! Reads any lab's log: photodiodes and forces with time stamps, and whether the LED was on.
//!
//! In: a CSV file (of any of the usual dialects, also gzipped), a Parquet file or, with the cargo feature `xdf`, a
//! recording of the Lab Streaming Layer; and [`Columns`], which says what the file calls its columns where that is not
//! what the contract calls them. Out: a [`Log`], its rows in the order of time; and [`samples`] of it, the light that
//! is not the LED's taken away. [`LogReading`] is both together: the road of every job that works on logs.
//!
//! The walk: `text` opens the file and finds its header, `columns` (and `guess`) choose columns by their names, `rows`
//! (or `parquet`, `xdf`) read cells, `cell` and `stamps` say what one cell means, `order` looks at time as a whole;
//! then `ambient`.
//!
//! Conventions. Time is in seconds: since 1970-01-01T00:00Z for date-time stamps with a zone, since 1970-01-01T00:00 of
//! the log's own wall clock for those without, since midnight for times of day; numbers as they are, in the unit that
//! the user or the column's name gives, else seconds. 64-bit floating point holds seconds since 1970 to 0.24
//! microseconds. What is missing (an empty cell, `NaN`, `NA`, `n/a`, `null`) is NaN; any other text and infinity are
//! errors that name line and column. A row without time, or without `led` where the log has it, is left out and
//! counted. Rows that stand in the wrong place by little are sorted. A clock that is reset (time falls back and goes on
//! from there, or leaps by more than a day) is an error that says where; [`Columns::piece`] chooses the stretch between
//! two resets.

mod ambient;
pub(crate) mod doubts;
mod foreseen;
mod formats;
mod leaps;
mod lines;
mod naming;
mod reading;
mod request;
pub(crate) mod rest;
#[cfg(test)]
mod tests;

use std::path::{Path, PathBuf};

pub use ambient::{AmbientError, AmbientOptions, AmbientRule, Samples, samples};
pub(crate) use ambient::{PRECEDING_RULE, Preceding, Standing, Still, piles};
pub use foreseen::{ReadingCost, ambient_step, ambient_step_of, foreseen_bytes};
pub use lines::stamps::TimeUnit;
pub(crate) use lines::status::{Statuses, Unknown, Verdict, is_filmed, lacks_label, without_faults};
pub use naming::columns::Columns;
pub(crate) use naming::groups::{Groups, groups};
pub(crate) use naming::guess::is_force_in_another_unit;
pub use naming::header::LogHeader;
pub(crate) use naming::header::{GROUPS, time_not_read};
pub use reading::{LitRows, LogReading, UnlitLoads};

/// A column of a log.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// Its name: `P1`, `Fz_N`.
    pub name: String,
    /// A value a row; NaN where it is missing.
    pub values: Vec<f64>,
}

/// What a lab's file holds, in the order of time.
///
/// ```
/// use std::path::Path;
///
/// use lunula::log::{Columns, Log};
///
/// let log = Log::read(Path::new("fixtures/touch/log.csv"), &Columns::default())?;
/// let names: Vec<&str> = log.forces.iter().map(|force| force.name.as_str()).collect();
/// assert_eq!(names, ["Fx_N", "Fy_N", "Fz_N"]);
/// assert_eq!(log.photodiodes.len(), 8);
/// // Every second sample was taken with the LED off.
/// let lit = log.led.as_ref().map(|led| led.iter().filter(|lit| **lit).count());
/// assert_eq!(lit, Some(log.time_s.len() / 2));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Log {
    /// The file.
    pub path: PathBuf,
    /// The log's time of each row, seconds, ascending; a stamp may stand several times.
    pub time_s: Vec<f64>,
    /// The log's time at the midnight before its first stamp, of the wall clock as the stamps write it, seconds; where
    /// stamps are dates with times of day, or times of day.
    pub midnight_s: Option<f64>,
    /// For each row, whether the LED was on; none where the log does not tell: all rows are lit.
    pub led: Option<Vec<bool>>,
    /// Photodiodes (`P1`.., `VP1`..), in the file's order.
    pub photodiodes: Vec<Channel>,
    /// `Fx_N`, `Fy_N`, `Fz_N`, and pressures (`pf1_Pa`, `pf2_Pa`, `ph_Pa`, `pl_Pa`), as far as the file has them.
    pub forces: Vec<Channel>,
    /// What is no fault but worth saying, each with its place.
    pub notes: Vec<String>,
}

/// Why a log can't be read.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum LogError {
    #[error("{}: {what}", path.display())]
    File { path: PathBuf, what: String },
    #[error("{}: {what}", path.display())]
    Columns { path: PathBuf, what: String },
    #[error("{place}: {what}")]
    Cell {
        /// File, line (CSV), row (Parquet) or sample (XDF), column.
        place: String,
        what: String,
    },
    #[error("{place}: {what}")]
    Time {
        /// File, line (CSV), row (Parquet) or sample (XDF) at which it does not.
        place: String,
        what: String,
    },
    #[error(transparent)]
    Ambient(#[from] AmbientError),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Format {
    Text,
    Parquet,
    Xdf,
}

impl Log {
    /// Reads a log.
    ///
    /// # Errors
    /// A file that can't be read, columns that are missing or ambiguous, a cell that is neither number nor missing, a
    /// clock that was reset, no rows: each with its place and what to do.
    pub fn read(path: &Path, columns: &Columns) -> Result<Self, LogError> {
        let format = Format::of(path);
        let mut raw = match format {
            Format::Text => lines::rows::read(path, columns)?,
            Format::Parquet => formats::parquet::read(path, columns)?,
            #[cfg(feature = "xdf")]
            Format::Xdf => formats::xdf::read(path, columns)?,
            #[cfg(not(feature = "xdf"))]
            Format::Xdf => return Err(without_xdf(path)),
        };
        if columns.stream.is_some() && !matches!(format, Format::Xdf) {
            raw.notes
                .push("--stream is of no use here: only recordings of the Lab Streaming Layer have streams".into());
        }
        lines::order::settle(raw, columns.piece)
    }
}

/// The columns of a recording of the Lab Streaming Layer as they are, in the order of their names; nothing is read
/// into them.
#[cfg_attr(not(feature = "xdf"), allow(unused_variables))]
pub(crate) fn recorded_stream(path: &Path, columns: &Columns) -> Result<(Vec<String>, Vec<Vec<f64>>), LogError> {
    #[cfg(feature = "xdf")]
    {
        let (stream, names, _) = formats::xdf::stream(path, columns)?;
        let values = std::iter::once(stream.time_s).chain(stream.channels).collect();
        Ok((names, values))
    }
    #[cfg(not(feature = "xdf"))]
    Err(without_xdf(path))
}

#[cfg(not(feature = "xdf"))]
fn without_xdf(path: &Path) -> LogError {
    let what = "is a recording of the Lab Streaming Layer, which this lunula was built without; build it with `cargo \
                build --release --features xdf`";
    LogError::File { path: path.to_owned(), what: what.to_owned() }
}

impl Format {
    /// By the name's end; whatever is not known is text.
    fn of(path: &Path) -> Self {
        let name = path.file_name().map(|name| name.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
        match name.strip_suffix(".gz").unwrap_or(&name) {
            plain if plain.ends_with(".xdf") || plain.ends_with(".xdfz") => Self::Xdf,
            _ if name.ends_with(".parquet") => Self::Parquet,
            _ => Self::Text,
        }
    }
}
