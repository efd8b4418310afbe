//! The rows of a file as they stand in it, before time is looked at as a whole.

use std::collections::HashMap;
use std::path::PathBuf;

use crate::log::naming::columns::Choice;
use crate::log::naming::role::Role;
use crate::log::{Channel, LogError};

/// What a row of the file is called.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::log) enum RowWord {
    /// A line of a text file.
    Line,
    /// A row of a Parquet file.
    Row,
    /// A sample of a stream.
    #[cfg(feature = "xdf")]
    Sample,
}

impl RowWord {
    /// `line 17`
    pub(in crate::log) fn at(self, place: u64) -> String {
        match self {
            Self::Line => format!("line {place}"),
            Self::Row => format!("row {place}"),
            #[cfg(feature = "xdf")]
            Self::Sample => format!("sample {place}"),
        }
    }
}

/// Rows in the file's order.
#[derive(Debug, Clone)]
pub(in crate::log) struct Raw {
    pub(in crate::log) path: PathBuf,
    pub(in crate::log) word: RowWord,
    /// Each row's line, row or sample in the file, from 1.
    pub(in crate::log) places: Vec<u64>,
    /// Seconds; NaN where missing.
    pub(in crate::log) time_s: Vec<f64>,
    pub(in crate::log) midnight_s: Option<f64>,
    pub(in crate::log) led: Option<Vec<Option<bool>>>,
    pub(in crate::log) photodiodes: Vec<Channel>,
    pub(in crate::log) forces: Vec<Channel>,
    pub(in crate::log) notes: Vec<String>,
    /// Where each channel is: among the photodiodes, then among the forces behind them.
    channels: HashMap<Role, usize>,
}

impl Raw {
    /// No rows yet, with a channel for each number column of the choice.
    pub(in crate::log) fn new(path: PathBuf, word: RowWord, choice: &Choice) -> Self {
        let channels = |wanted: fn(Role) -> bool| -> Vec<(Role, Channel)> {
            let roles = choice.columns.iter().map(|&(role, _)| role).filter(|&role| wanted(role));
            roles.map(|role| (role, Channel { name: role.name(), values: Vec::new() })).collect()
        };
        let photodiodes = channels(Role::is_light);
        let forces = channels(Role::is_load);
        let all = photodiodes.iter().chain(&forces).enumerate();
        Self {
            channels: all.map(|(k, (role, _))| (*role, k)).collect(),
            path,
            word,
            places: Vec::new(),
            time_s: Vec::new(),
            midnight_s: None,
            led: choice.columns.iter().any(|(role, _)| *role == Role::Led).then(Vec::new),
            photodiodes: photodiodes.into_iter().map(|(_, channel)| channel).collect(),
            forces: forces.into_iter().map(|(_, channel)| channel).collect(),
            notes: choice.notes.clone(),
        }
    }

    /// The values of a photodiode or force.
    pub(in crate::log) fn channel(&mut self, role: Role) -> Option<&mut Vec<f64>> {
        let at = *self.channels.get(&role)?;
        let lights = self.photodiodes.len();
        let channel = if at < lights { self.photodiodes.get_mut(at) } else { self.forces.get_mut(at - lights) };
        channel.map(|channel| &mut channel.values)
    }

    pub(in crate::log) fn place(&self, row: usize) -> String {
        place(&self.path, self.word, self.places[row])
    }

    /// The error of a file without rows.
    pub(in crate::log) fn no_rows(&self) -> LogError {
        let what = "has no rows that could be used; a log has one for each sample".to_owned();
        LogError::File { path: self.path.clone(), what }
    }
}

/// The place of a row, with the file: `log.csv:17` or `log.parquet: row 17`.
pub(in crate::log) fn place(path: &std::path::Path, word: RowWord, place: u64) -> String {
    match word {
        RowWord::Line => format!("{}:{place}", path.display()),
        _ => format!("{}: {}", path.display(), word.at(place)),
    }
}
