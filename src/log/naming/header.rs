//! What the names of a log's columns tell: the rows stay unread.

use std::io::Read;
use std::path::Path;

use crate::log::formats::text::{self, Layout};
use crate::log::lines::rows::{choose, dated};
use crate::log::naming::columns::{Choice, Columns};
use crate::log::naming::guess::role_of;
use crate::log::naming::role::Role;
use crate::log::{Format, Log, LogError};
use crate::{input, table};

/// A log's columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LogHeader {
    /// It says when the LED was on.
    pub led: bool,
    /// Photodiodes.
    pub photodiodes: usize,
    /// Forces.
    pub forces: usize,
}

/// Columns that say where one recording ends and the next begins.
pub(crate) const GROUPS: [&str; 3] = ["session", "subject", "trajectory"];

/// As much of a file of text as holds its header.
const HEAD: u64 = 1 << 16;

impl LogHeader {
    /// Reads a log's header.
    ///
    /// # Errors
    /// As [`Log::read`], as far as the header says.
    pub fn read(path: &Path, columns: &Columns) -> Result<Self, LogError> {
        let choice = match Format::of(path) {
            Format::Text => choose(path, &head(path)?, columns)?.1,
            Format::Parquet => {
                let names = table::column_names(path)
                    .map_err(|why| LogError::File { path: path.to_owned(), what: why.to_string() })?;
                columns.choose(&names, &[]).map_err(|what| LogError::Columns { path: path.to_owned(), what })?
            }
            // Its streams stand in no header of the file.
            Format::Xdf => {
                let log = Log::read(path, columns)?;
                let (photodiodes, forces) = (log.photodiodes.len(), log.forces.len());
                return Ok(Self { led: log.led.is_some(), photodiodes, forces });
            }
        };
        Ok(Self::of(&choice))
    }

    fn of(choice: &Choice) -> Self {
        let count = |wanted: fn(Role) -> bool| choice.columns.iter().filter(|(role, _)| wanted(*role)).count();
        Self {
            led: count(|role| role == Role::Led) > 0,
            photodiodes: count(|role| matches!(role, Role::Photodiode(_))),
            forces: count(|role| matches!(role, Role::Force(_))),
        }
    }
}

/// Whether a CSV or Parquet file has photodiodes or pressures as other programs write them, so that only a log's reader
/// understands it: lines beside names and rows, another delimiter or encoding, comments, columns without a name, a time
/// that is not called `time_s`, or dates. `as_table`: the names that a table's reader finds, if it does. Not one that
/// has what no log has: an angle, a status, a session.
pub(in crate::log) fn is_foreign(path: &Path, as_table: Option<&[String]>) -> bool {
    let text = || {
        let text = head(path).ok()?;
        let layout = Layout::find(&text).ok()?;
        let is_time = |name: &str| name.is_empty() || name == "time_s";
        let is_dated = dated(&text, &layout).into_iter().any(|k| is_time(&layout.names[k]));
        Some((layout.names, layout.holds_others, is_dated))
    };
    let read =
        if Format::of(path) == Format::Text { text() } else { as_table.map(|names| (names.to_vec(), false, false)) };
    let Some((names, holds_others, is_dated)) = read else { return false };
    let is_labelled =
        |name: &String| name.ends_with("_deg") || name == "sensor_status" || GROUPS.contains(&name.as_str());
    let has = |wanted: fn(Role) -> bool| names.iter().filter_map(|name| role_of(name)).any(wanted);
    let reads_otherwise = || {
        is_dated
            || as_table != Some(&names[..])
            || names.iter().filter(|name| name.is_empty()).count() > 1
            || time_not_read(&names).is_some()
    };
    let has_light = || has(|role| role.is_light() || matches!(role, Role::Pressure(_)));
    holds_others || !names.iter().any(is_labelled) && has_light() && reads_otherwise()
}

/// The first of these columns that a log's reader would take for the time, where none is called `time_s`.
pub(crate) fn time_not_read(names: &[String]) -> Option<&str> {
    let is_time = |name: &&String| role_of(name) == Some(Role::Time);
    let other = || names.iter().find(is_time).map(String::as_str);
    if names.iter().any(|name| name == "time_s") { None } else { other() }
}

/// The names of the columns of a log that no table's reader takes; none where they are not known.
pub(in crate::log) fn names(path: &Path) -> Vec<String> {
    head(path).ok().and_then(|text| Some(Layout::find(&text).ok()?.names)).unwrap_or_default()
}

/// The first lines of a file of text; all of one that is packed or whose header is further down.
fn head(path: &Path) -> Result<Vec<u8>, LogError> {
    let mut bytes = Vec::new();
    let opened = input::open(path).and_then(|file| file.take(HEAD).read_to_end(&mut bytes));
    let plain = opened.is_ok() && !bytes.starts_with(&[0x1f, 0x8b]) && !bytes.contains(&0);
    let whole_lines = bytes.iter().rposition(|&b| b == b'\n').map(|end| &bytes[..=end]);
    match whole_lines.filter(|lines| plain && std::str::from_utf8(lines).is_ok() && Layout::find(lines).is_ok()) {
        Some(lines) => Ok(lines.to_vec()),
        None => text::open(path),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_header_alone_tells_the_columns() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("log.csv");
        let rows = "0.1,1,0.5,0.6,-1\n".repeat(10_000);
        std::fs::write(&path, format!("time_s,led,P1,P2,Fz_N\n{rows}0.2,broken")).unwrap();
        let header = LogHeader::read(&path, &Columns::default()).unwrap();
        assert_eq!(header, LogHeader { led: true, photodiodes: 2, forces: 1 });
        std::fs::write(&path, "time_s,P1\n0,1").unwrap();
        let header = LogHeader::read(&path, &Columns::default()).unwrap();
        assert_eq!(header, LogHeader { led: false, photodiodes: 1, forces: 0 });
        std::fs::write(&path, "stamp,ch_3\n0,1\n").unwrap();
        let mapped = Columns::parse("time_s=stamp,P1=ch_3").unwrap();
        assert_eq!(LogHeader::read(&path, &mapped).unwrap().photodiodes, 1);
        std::fs::write(&path, "time_s,P1\n").unwrap();
        let lost = LogHeader::read(&dir.path().join("none.csv"), &Columns::default()).unwrap_err().to_string();
        assert!(lost.contains("none.csv"), "{lost}");
    }
}
