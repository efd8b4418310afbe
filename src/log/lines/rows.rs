//! The rows of a text file: cells to numbers, stamps and LED states, each fault with its line and column.
//!
//! Rows have as many cells as the header; empty ones and comments (`#* pressed harder`, as LabChart writes them) at a
//! row's end may be too many, a column of comments may be missing. The last row, if it is cut off (a logger that was
//! stopped), is left out and reported; so is the header where it comes again, as in files put one behind the other.

use std::path::Path;

use lunula_live::wire::bare;

use crate::log::LogError;
use crate::log::formats::raw::{Raw, RowWord, place};
use crate::log::formats::split::{is_comment, is_comments};
use crate::log::formats::text::{self, Layout};
use crate::log::lines::cell::{self, Numbers, shown};
use crate::log::lines::stamps::Stamps;
use crate::log::naming::columns::{Choice, Columns};
use crate::log::naming::role::Role;

/// Reads a text file.
pub(in crate::log) fn read(path: &Path, columns: &Columns) -> Result<Raw, LogError> {
    let text = text::open(path)?;
    let (layout, choice) = choose(path, &text, columns)?;
    Rows { path, text: &text, layout: &layout, choice: &choice }.read()
}

/// Finds the header and chooses among its columns.
pub(in crate::log) fn choose(path: &Path, text: &[u8], columns: &Columns) -> Result<(Layout, Choice), LogError> {
    let layout = Layout::find(text).map_err(|what| LogError::File { path: path.to_owned(), what })?;
    let nameless: Vec<usize> = dated(text, &layout).into_iter().filter(|&k| layout.names[k].is_empty()).collect();
    let choice =
        columns.choose(&layout.names, &nameless).map_err(|what| LogError::Columns { path: path.to_owned(), what })?;
    Ok((layout, choice))
}

/// Columns whose first cell is a date with a time, or a time of day.
pub(in crate::log) fn dated(text: &[u8], layout: &Layout) -> Vec<usize> {
    let mut row = csv::ByteRecord::new();
    if !matches!(reader(text, layout).read_byte_record(&mut row), Ok(true)) {
        return Vec::new();
    }
    let is_stamp = |cell: &[u8]| Stamps::default().push(bare(cell), &mut Numbers::of(layout.delimiter)).is_ok();
    let is_dated = |k: &usize| row.get(*k).is_some_and(|cell| cell.contains(&b':') && is_stamp(cell));
    (0..layout.names.len()).filter(is_dated).collect()
}

fn reader<'a>(text: &'a [u8], layout: &Layout) -> csv::Reader<&'a [u8]> {
    csv::ReaderBuilder::new()
        .delimiter(layout.delimiter)
        .has_headers(false)
        .flexible(true)
        .comment(Some(b'#'))
        .from_reader(&text[layout.body..])
}

struct Rows<'a> {
    path: &'a Path,
    text: &'a [u8],
    layout: &'a Layout,
    choice: &'a Choice,
}

impl Rows<'_> {
    fn read(&self) -> Result<Raw, LogError> {
        let mut raw = Raw::new(self.path.to_owned(), RowWord::Line, self.choice);
        raw.notes.splice(0..0, self.layout.notes.iter().cloned());
        let mut numbers = Numbers::of(self.layout.delimiter);
        let mut stamps = Stamps::default();
        let mut channels: Vec<Vec<f64>> = vec![Vec::new(); self.choice.columns.len()];
        let mut rows = reader(self.text, self.layout);
        let mut row = csv::ByteRecord::new();
        let mut headers = Vec::new();
        loop {
            let line = self.line_of_next(&rows);
            let more = rows.read_byte_record(&mut row).map_err(|why| LogError::File {
                path: self.path.to_owned(),
                what: format!("line {line} can't be read ({why})"),
            })?;
            if !more {
                break;
            }
            match self.length(&row, line, self.at(&rows) == self.text.len() && !self.text.ends_with(b"\n"))? {
                Length::Right => {}
                Length::Blank => continue,
                Length::CutOff => {
                    raw.notes.push(format!("line {line}, the last, is cut off and left out"));
                    break;
                }
            }
            if self.is_header(&row) {
                headers.push(line);
                continue;
            }
            for (&(role, column), values) in self.choice.columns.iter().zip(&mut channels) {
                let cell = bare(&row[column]);
                match role {
                    Role::Time => stamps.push(cell, &mut numbers),
                    Role::Led => cell::led(cell).map(|on| raw.led.get_or_insert_default().push(on)),
                    Role::Photodiode(_) | Role::Output(_) | Role::Force(_) | Role::Pressure(_) | Role::Contact => {
                        numbers.read(cell).map(|number| values.push(number))
                    }
                }
                .map_err(|what| {
                    let place = place(self.path, RowWord::Line, line);
                    LogError::Cell { place: format!("{place}: column `{}`", self.layout.names[column]), what }
                })?;
            }
            raw.places.push(line);
        }
        if let Some(first) = headers.first() {
            let more = if headers.len() > 1 { format!(" and {} more", headers.len() - 1) } else { String::new() };
            raw.notes.push(format!("line {first}{more} repeats the names of the columns and is left out"));
        }
        if numbers.comma {
            raw.notes.push("numbers have decimal commas".to_owned());
        }
        for (&(role, _), values) in self.choice.columns.iter().zip(channels) {
            if let Some(channel) = raw.channel(role) {
                *channel = values;
            }
        }
        (raw.time_s, raw.midnight_s) = stamps.finish(self.choice.time_unit, &mut raw.notes);
        Ok(raw)
    }

    /// Whether a row is the header again.
    fn is_header(&self, row: &csv::ByteRecord) -> bool {
        row.iter().zip(&self.layout.names).all(|(cell, name)| bare(cell) == name.as_bytes())
    }

    fn line_of_next(&self, rows: &csv::Reader<&[u8]>) -> u64 {
        self.layout.lines_before + rows.position().line() + text::lines_to_row(self.text, self.at(rows))
    }

    /// The byte that is read next.
    fn at(&self, rows: &csv::Reader<&[u8]>) -> usize {
        self.layout.body + rows.position().byte() as usize
    }

    fn length(&self, row: &csv::ByteRecord, line: u64, last: bool) -> Result<Length, LogError> {
        let names = &self.layout.names;
        if row.len() == names.len() {
            return Ok(Length::Right);
        }
        let blank = |k: usize| bare(&row[k]).is_empty();
        if (0..row.len()).all(blank) && row.len() <= 1 {
            return Ok(Length::Blank);
        }
        // A last row without a line's end may be cut off within a number.
        let may_miss = |name: &String| name.is_empty() || is_comments(name) && !last;
        let missing_may_be = row.len() < names.len() && names[row.len()..].iter().all(may_miss);
        let used = self.choice.columns.iter().all(|&(_, column)| column < row.len());
        let beyond = (names.len()..row.len()).find(|&k| !blank(k));
        let may_be_beyond = row.len() > names.len() && beyond.is_none_or(|k| is_comment(bare(&row[k])));
        if may_be_beyond || missing_may_be && used {
            return Ok(Length::Right);
        }
        if row.len() < names.len() && last {
            return Ok(Length::CutOff);
        }
        let comma = if self.layout.delimiter == b',' && row.len() > names.len() {
            "; if numbers have decimal commas, separate cells by `;` or tabs"
        } else {
            ""
        };
        let what = format!(
            "has {} cells and the header {}; correct it{comma} (it begins with `{}`)",
            row.len(),
            names.len(),
            shown(&row[0])
        );
        Err(LogError::Cell { place: place(self.path, RowWord::Line, line), what })
    }
}

/// Whether a row has as many cells as it should.
enum Length {
    Right,
    /// Nothing but space.
    Blank,
    /// The end of the file was never written.
    CutOff,
}
