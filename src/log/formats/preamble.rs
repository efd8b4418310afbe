//! Lines before a log's own: what LabVIEW, LabChart and oscilloscopes write about a recording before its columns.
//!
//! The rows begin where three lines running (or the last two) hold equally many cells, half of them numbers. The names
//! are the nearest line above with as many, or LabChart's `ChannelTitle=`; a line of units between them and the rows
//! goes to the names.

use lunula_live::wire::{bare, is_name};

use super::split::{Line, cells_of, is_comment, is_comments, lines_in_use, split};
use crate::log::lines::cell::Numbers;
use crate::table::DELIMITERS;

/// Lines that are looked at.
const MOST_LINES: usize = 1000;
/// Rows running that are no accident.
const ROWS: usize = 3;
/// Units that stand without brackets.
const UNITS: [&str; 18] =
    ["s", "sec", "ms", "us", "µs", "ns", "V", "mV", "N", "mN", "A", "mA", "Pa", "kPa", "°", "deg", "°C", "Hz"];

/// Where the parts of a file are that begins with other lines.
pub(super) struct Found {
    pub(super) delimiter: u8,
    pub(super) names: Vec<String>,
    /// The byte at which the rows begin, and the lines before it.
    pub(super) body: usize,
    pub(super) lines_before: u64,
    pub(super) names_line: u64,
    pub(super) units_line: Option<u64>,
}

impl Found {
    /// Whether the names stand in this line, or units below them.
    pub(super) fn fits_line(&self, line: u64) -> bool {
        self.names_line == line || self.units_line.is_some()
    }
}

/// Looks for rows below other lines; `declared` is the only delimiter there may be. The error is the line of rows that
/// have no names above them.
pub(super) fn find(text: &[u8], declared: Option<u8>) -> Option<Result<Found, u64>> {
    let mut all = lines_in_use(text);
    let lines: Vec<Line<'_>> = all.by_ref().take(MOST_LINES).collect();
    let whole = all.next().is_none();
    let delimiters = declared.map_or(DELIMITERS.to_vec(), |declared| vec![declared]);
    let found = delimiters.into_iter().filter_map(|delimiter| of_delimiter(&lines, delimiter, whole));
    found.max_by_key(|found| found.as_ref().map_or(0, |found| found.names.len()))
}

fn of_delimiter(lines: &[Line<'_>], delimiter: u8, whole: bool) -> Option<Result<Found, u64>> {
    let counts: Vec<Option<usize>> = lines.iter().map(|line| row_cells(line.bytes, delimiter)).collect();
    // A row with a comment in a column of comments has a cell more than those without.
    let rows_from = |k: usize| {
        let running: Option<Vec<usize>> = counts[k..].iter().take(ROWS).copied().collect();
        let running = running.filter(|rows| rows.len() == ROWS || rows.len() == 2 && whole)?;
        let least = *running.iter().min()?;
        running.iter().all(|count| count - least <= 1).then_some((k, least))
    };
    let (first, count) = (0..lines.len()).find_map(rows_from)?;
    let (mut names, mut names_line, mut units) = (None, 0, None);
    for line in lines[..first].iter().rev() {
        let mut cells = cells_of(line.bytes, delimiter);
        if let [title, ..] = &mut cells[..]
            && title.ends_with('=')
        {
            if title != "ChannelTitle=" || cells.len() > count {
                continue;
            }
            cells[0] = "Time".to_owned();
            cells.resize(count, String::new());
        }
        let is_longer =
            cells.len() == count + 1 && cells.last().is_some_and(|last| last.is_empty() || is_comments(last));
        if cells.len() != count && !is_longer || !cells.iter().any(|cell| is_name(cell)) {
            break;
        }
        if units.is_none() && cells.iter().all(|cell| cell.is_empty() || unit(cell).is_some()) {
            units = Some((cells, line.number));
            continue;
        }
        (names, names_line) = (Some(cells), line.number);
        break;
    }
    // A line of units without names above it was one of names.
    let (mut names, names_line, units) = match (names, units) {
        (Some(names), units) => (names, names_line, units),
        (None, Some((names, line))) => (names, line, None),
        (None, None) => return (first > 0).then(|| Err(lines[first].number)),
    };
    if let Some((units, _)) = &units {
        for (name, cell) in names.iter_mut().zip(units) {
            let unit = unit(cell).unwrap_or_default();
            let has_it = name.rsplit(|c: char| !c.is_alphanumeric()).find(|word| !word.is_empty()) == Some(unit);
            if !unit.is_empty() && !has_it {
                *name = format!("{name} ({unit})");
            }
        }
    }
    let Line { number, at, .. } = lines[first];
    let units_line = units.map(|(_, line)| line);
    Some(Ok(Found { delimiter, names, body: at, lines_before: number - 1, names_line, units_line }))
}

/// How many cells a line has that may be a row: two or more, the first not a word, half of them numbers.
pub(super) fn row_cells(line: &[u8], delimiter: u8) -> Option<usize> {
    let mut numbers = Numbers::of(delimiter);
    let cells: Vec<&[u8]> = split(line, delimiter).map(bare).collect();
    // A delimiter at the end makes no cell, nor does a comment.
    let count = cells.len() - usize::from(cells.last().is_some_and(|cell| cell.is_empty() || is_comment(cell)));
    let [first, ..] = cells[..] else { return None };
    let known = cells[..count].iter().filter(|cell| numbers.read(cell).is_ok_and(f64::is_finite)).count();
    let stands = first.is_empty() || first[0].is_ascii_digit() || b"+-.".contains(&first[0]);
    (count >= 2 && stands && 2 * known >= count).then_some(count)
}

/// The unit that a cell is, without its brackets.
fn unit(cell: &str) -> Option<&str> {
    let within = |open: char, close: char| cell.strip_prefix(open)?.strip_suffix(close);
    within('(', ')').or_else(|| within('[', ']')).or_else(|| UNITS.contains(&cell).then_some(cell)).map(str::trim)
}
