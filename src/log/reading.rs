//! The road from a file to rows of the LED's own light, for every job that works on logs.
//!
//! In: a file, and what the user says about it. Out: whether it is a log ([`LogReading::is_log`]) or a table of rows
//! that are ready to be used (as `lunula align` and `lunula simulate` write them); of a log its lit rows, faults
//! flagged ([`LogReading::lit_rows`]), and the loads of its unlit ones.

use std::path::Path;

use super::{AmbientOptions, Channel, Columns, Log, LogError, LogHeader, Samples, TimeUnit, samples};
use crate::log::naming::columns::is_led;
use crate::log::naming::groups;
use crate::log::naming::header::is_foreign;
use crate::table::{TableError, column_names};

/// What the user says about a log; the default says nothing.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LogReading {
    /// What its columns are called.
    pub columns: Columns,
    /// How the ambient light is taken away and what counts as saturated.
    pub ambient: AmbientOptions,
}

/// The lit rows of a log.
#[derive(Debug, Clone, PartialEq)]
pub struct LitRows {
    /// The rows, less the ambient light, and what is worth saying on that.
    pub samples: Samples,
    /// The loads between the lit rows, before the first and after the last.
    pub unlit: UnlitLoads,
    /// The first row of each session, subject and trajectory, where the file has such columns.
    pub groups: Vec<(usize, [String; 3])>,
    /// What is worth saying on the file.
    pub notes: Vec<String>,
}

/// The columns of a stream of rows.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Renamed {
    /// Their names, the contract's where they are a log's.
    pub(crate) names: Vec<String>,
    /// Whether they are a log's.
    pub(crate) known: Vec<bool>,
    /// How many units of the time make a second.
    pub(crate) per_second: f64,
    /// What was guessed.
    pub(crate) notes: Vec<String>,
}

/// The loads of a log's unlit rows: forces and pressures do not depend on the LED.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct UnlitLoads {
    /// The log's time, seconds, ascending.
    pub time_s: Vec<f64>,
    /// The same channels as [`Samples::forces`]; NaN where missing.
    pub forces: Vec<Channel>,
}

impl UnlitLoads {
    fn of(log: &Log) -> Self {
        let Some(led) = &log.led else { return Self::default() };
        let unlit =
            |values: &[f64]| values.iter().zip(led).filter(|(_, lit)| !**lit).map(|(value, _)| *value).collect();
        let channel = |channel: &Channel| Channel { name: channel.name.clone(), values: unlit(&channel.values) };
        Self { time_s: unlit(&log.time_s), forces: log.forces.iter().map(channel).collect() }
    }
}

impl LogReading {
    /// Whether a file is read as a log: it has a column that says when the LED was on, is no CSV or Parquet table by
    /// its name, is written as other programs write logs, or the user says something about logs.
    ///
    /// # Errors
    /// A table that is missing or damaged.
    pub fn is_log(&self, path: &Path) -> Result<bool, TableError> {
        if self.says_log() {
            return Ok(true);
        }
        let names = match column_names(path) {
            Err(TableError::Extension(_)) => return Ok(true),
            names => names,
        };
        if names.as_ref().is_ok_and(|names| self.has_led(names)) || is_foreign(path, names.as_deref().ok()) {
            return Ok(true);
        }
        names.map(|_| false)
    }

    /// Whether something is said that only logs have; which unlit light is taken away is said of those that are logs.
    pub(crate) fn says_log(&self) -> bool {
        let rule = self.ambient.rule;
        *self != Self { ambient: AmbientOptions { rule, ..AmbientOptions::default() }, ..Self::default() }
    }

    /// Whether one of these columns says when the LED was on.
    pub(crate) fn has_led(&self, names: &[String]) -> bool {
        names.iter().any(|name| is_led(name))
    }

    /// The columns of a stream of rows under the contract's names.
    ///
    /// # Errors
    /// A column that is named and not there, or could be several, in words.
    pub(crate) fn renamed(&self, names: &[String]) -> Result<Renamed, String> {
        let choice = self.columns.found(names, &[])?;
        let per_second = choice.time_unit.map_or(1.0, TimeUnit::a_second);
        let mut renamed =
            Renamed { names: names.to_vec(), known: vec![false; names.len()], per_second, notes: choice.notes };
        for &(role, at) in &choice.columns {
            renamed.names[at] = role.name();
            renamed.known[at] = true;
        }
        Ok(renamed)
    }

    /// Whether a file's LED goes on and off; `None` where that is not known.
    pub(crate) fn led_of(&self, path: &Path) -> Option<bool> {
        match self.is_log(path) {
            Ok(true) => LogHeader::read(path, &self.columns).ok().map(|header| header.led),
            Ok(false) => Some(false),
            Err(_) => None,
        }
    }

    /// Reads a log and takes the ambient light away.
    pub fn lit_rows(&self, path: &Path) -> Result<LitRows, LogError> {
        let log = Log::read(path, &self.columns)?;
        let mut samples = samples(&log, &self.ambient)?;
        let groups = groups::of_log(path, &log.time_s, &samples.time_s).unwrap_or_else(|why| {
            samples.warnings.push(why);
            Vec::new()
        });
        Ok(LitRows { unlit: UnlitLoads::of(&log), notes: log.notes, groups, samples })
    }
}
