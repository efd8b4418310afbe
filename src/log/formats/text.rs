//! A log as text: opened, unpacked, its header and its delimiter found.
//!
//! Gzip is known by its first bytes, UTF-16 by its byte-order mark; a byte-order mark of UTF-8 is taken off. Lines that
//! begin with `#` before the header, and empty ones, are passed over; where there is no header but a line of names
//! behind the last `#` (as NumPy writes it), that is the header. Where the first line does not fit the next, the header
//! is looked for below what other programs write before it ([`preamble`]). The delimiter is the one of
//! [`DELIMITERS`] that the header and the first rows agree on.

use std::path::Path;

use lunula_live::wire::is_name;

use super::preamble::{self, Found, row_cells};
use super::split::{Line, cells_of, line_at, lines_in_use, split};
use crate::input;
use crate::log::LogError;
use crate::log::naming::guess::role_of;
use crate::log::naming::role::Role;
use crate::table::DELIMITERS;

/// Where the parts of a text file are.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::log) struct Layout {
    pub(in crate::log) delimiter: u8,
    pub(in crate::log) names: Vec<String>,
    /// Where the rows begin: the byte, and the lines before it.
    pub(in crate::log) body: usize,
    pub(in crate::log) lines_before: u64,
    /// Other lines stand before the header, or between it and the rows.
    pub(in crate::log) holds_others: bool,
    /// What is unusual.
    pub(in crate::log) notes: Vec<String>,
}

/// The bytes of a file, unpacked where it is gzipped.
pub(in crate::log) fn unpacked(path: &Path) -> Result<Vec<u8>, LogError> {
    let failed = |what: String| LogError::File { path: path.to_owned(), what };
    let bytes = input::read(path).map_err(|why| failed(why.to_string()))?;
    input::unpack(bytes).map_err(failed)
}

/// The text of a file, unpacked, as UTF-8 where it was UTF-16, without byte-order mark.
pub(in crate::log) fn open(path: &Path) -> Result<Vec<u8>, LogError> {
    let failed = |what: String| LogError::File { path: path.to_owned(), what };
    let mut bytes = unpacked(path)?;
    let utf16 = |big: bool| {
        let units = bytes[2..].chunks_exact(2);
        let units =
            units.map(|b| if big { u16::from_be_bytes([b[0], b[1]]) } else { u16::from_le_bytes([b[0], b[1]]) });
        char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER)).collect::<String>().into_bytes()
    };
    match bytes[..] {
        [] => return Err(failed("is empty; a log begins with the names of its columns".to_owned())),
        [0xff, 0xfe, ..] => bytes = utf16(false),
        [0xfe, 0xff, ..] => bytes = utf16(true),
        [0xef, 0xbb, 0xbf, ..] => drop(bytes.drain(..3)),
        _ => {}
    }
    input::end_lines(&mut bytes);
    for (magic, words) in [
        (&b"PK\x03\x04"[..], "is a spreadsheet or an archive; save it as CSV"),
        (b"PAR1", "is a Parquet file; let its name end in .parquet"),
        (b"XDF:", "is a recording of the Lab Streaming Layer; let its name end in .xdf"),
        (b"\x89HDF", "is an HDF5 file; write its signals as CSV or Parquet"),
        (b"MATLAB ", "is a MATLAB file; write its signals as CSV there (writetable)"),
        (b"TDSm", "is a LabVIEW recording; export it as CSV"),
    ] {
        if bytes.starts_with(magic) {
            return Err(failed(words.to_owned()));
        }
    }
    if bytes.iter().take(4096).any(|&b| b == 0) {
        return Err(failed("is no text; a log is CSV, Parquet or XDF".to_owned()));
    }
    Ok(bytes)
}

impl Layout {
    /// Finds the header.
    pub(in crate::log) fn find(text: &[u8]) -> Result<Self, String> {
        let (mut at, mut line) = (0, 0);
        let (mut comment, mut declared) = (None, None);
        while at < text.len() {
            let (row, next) = line_at(text, at);
            line += 1;
            let bared = row.trim_ascii();
            match bared {
                [] => {}
                [b'#', rest @ ..] => comment = Some(rest),
                // Excel's own line.
                [b's', b'e', b'p', b'=', mark] if DELIMITERS.contains(mark) => declared = Some(*mark),
                _ => {
                    let first = Self::of(text, row, comment, declared, (at, next, line));
                    if first.as_ref().is_ok_and(|layout| layout.fits(text)) {
                        return first;
                    }
                    let (names, is_timed) = first.as_ref().map_or((0, false), |layout| {
                        let is_timed = layout.names.iter().any(|name| role_of(name) == Some(Role::Time));
                        (layout.names.len(), is_timed)
                    });
                    // A name and its value are two cells.
                    let is_header = |found: &Found| is_timed || names > 2 && names == found.names.len();
                    return match preamble::find(text, declared) {
                        // What does not fit is a row, and what is wrong with it is said as of any other.
                        Some(Ok(found)) if is_header(&found) && !found.fits_line(line) => first,
                        Some(Err(_)) if names > 1 => first,
                        Some(Ok(found)) => Ok(Self::below(found, line)),
                        Some(Err(line)) => Err(format!(
                            "has no line of names above its rows, which begin in line {line}; write one such as \
                             time_s,P1,P2 there"
                        )),
                        None => first,
                    };
                }
            }
            at = next;
        }
        Err("has no line of names; a log begins with the names of its columns".to_owned())
    }

    /// Whether the first line below the names is a row with as many cells.
    fn fits(&self, text: &[u8]) -> bool {
        lines_in_use(&text[self.body..]).next().is_none_or(|Line { bytes, .. }| {
            let cells = split(bytes, self.delimiter).count();
            self.names.len() > 1 && cells == self.names.len() && row_cells(bytes, self.delimiter).is_some()
        })
    }

    fn below(found: Found, first: u64) -> Self {
        let Found { delimiter, names, body, lines_before, names_line, units_line } = found;
        let mut notes = Vec::new();
        notes.extend(separated(delimiter));
        if names_line > first {
            notes.push(format!("the columns' names are taken from line {names_line}; what is above it is not read"));
        }
        if let Some(line) = units_line {
            notes.push(format!("the columns' units are taken from line {line}"));
        }
        Self { delimiter, names, body, lines_before, holds_others: names_line > first || units_line.is_some(), notes }
    }

    fn of(
        text: &[u8],
        row: &[u8],
        comment: Option<&[u8]>,
        declared: Option<u8>,
        (at, next, line): (usize, usize, u64),
    ) -> Result<Self, String> {
        let delimiter = declared.unwrap_or_else(|| delimiter_of(row, &text[next..]));
        let mut notes: Vec<String> = separated(delimiter).into_iter().collect();
        let cells = cells_of(row, delimiter);
        let holds_others = false;
        if cells.iter().any(|cell| is_name(cell)) {
            return Ok(Self { delimiter, names: cells, body: next, lines_before: line, holds_others, notes });
        }
        let names = comment.map(|comment| cells_of(comment.trim_ascii(), delimiter));
        match names.filter(|names| names.len() == cells.len() && names.iter().any(|cell| is_name(cell))) {
            Some(names) => {
                notes.push("the columns' names are taken from the last line of the comment at the top".to_owned());
                Ok(Self { delimiter, names, body: at, lines_before: line - 1, holds_others, notes })
            }
            None => Err(format!(
                "line {line} holds numbers where the columns' names should be; begin the file with a line such as \
                 time_s,P1,P2"
            )),
        }
    }
}

/// What is said of a delimiter other than a comma.
fn separated(delimiter: u8) -> Option<String> {
    let mark = if delimiter == b'\t' { "tabs".to_owned() } else { format!("`{}`", char::from(delimiter)) };
    (delimiter != b',').then(|| format!("cells are separated by {mark}"))
}

/// The line that a row stands in that may begin behind empty lines and comments: how many to go on from `at`.
pub(in crate::log) fn lines_to_row(text: &[u8], mut at: usize) -> u64 {
    let mut lines = 0;
    while at < text.len() && matches!(text[at], b'\n' | b'\r' | b'#') {
        at = line_at(text, at).1;
        lines += 1;
    }
    lines
}

/// What separates cells: what the header has and the first rows as often; of several the one that makes most columns.
fn delimiter_of(header: &[u8], rows: &[u8]) -> u8 {
    const ROWS: usize = 20;
    let agreement = |delimiter: u8| {
        let columns = split(header, delimiter).count();
        let (mut at, mut seen, mut alike) = (0, 0, 0);
        while at < rows.len() && seen < ROWS {
            let (row, next) = line_at(rows, at);
            at = next;
            if row.trim_ascii().is_empty() || row.starts_with(b"#") {
                continue;
            }
            seen += 1;
            alike += usize::from(split(row, delimiter).count() == columns);
        }
        (columns > 1, alike == seen, columns)
    };
    // The last of equals wins.
    DELIMITERS.into_iter().max_by_key(|&d| agreement(d)).unwrap_or(b',')
}
