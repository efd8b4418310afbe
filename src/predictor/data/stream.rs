//! Rows of a stream, each as soon as its line is complete: for answers with one row's latency.
//!
//! In: lines of CSV, the names of the columns first; columns in any order, those that are not needed are passed over
//! unread. Out: one row's voltages into the caller's buffer. Nothing is allocated for a row once the longest line has
//! been seen.
//!
//! A cell may stand in double quotes and then hold commas, but no line break: whoever waits for a row can't wait for
//! its next line. Empty lines are passed over. A last line without its end is a row.
//!
//! Of a log, with a column that says when the LED was on, each lit row is one, less the unlit row before it
//! ([`Preceding`]): what comes after, between which a file's ambient light is interpolated, is not known yet.

use std::collections::{HashMap, HashSet};
use std::io::{BufRead, Read};

use super::RowOptions;
use super::columns::{listed, missing};
use super::{DataError, source::GROUPS};
use crate::log::{LogError, PRECEDING_RULE, Preceding, Statuses, Verdict, led_state};

/// No line of a sensor is longer, bytes; without an end to it, a stream of something else would fill the memory.
const LONGEST: u64 = 1 << 20;

/// What a column of the stream is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Use {
    Time,
    Led,
    Input(usize),
    Status,
    Group(usize),
    None,
}

/// One row of a stream.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// Its line, from 1.
    pub line: u64,
    /// Seconds; NaN where not known.
    pub time_s: f64,
    /// Whether a photodiode in use is saturated or without ambient light, as `sensor_status` says or the range that can
    /// be recorded.
    pub faulty: bool,
    /// Whether a cell is no finite number, or cells are too many or too few; only with `drop_invalid`.
    pub invalid: bool,
    /// Whether a recording begins: the first row, another session, subject or trajectory, or a time that goes back.
    pub begins: bool,
}

/// Reads voltages row by row.
#[derive(Debug)]
pub struct RowStream<'a, R> {
    from: R,
    name: String,
    names: Vec<String>,
    uses: Vec<Use>,
    inputs: &'a [String],
    statuses: Statuses<'a>,
    drop_invalid: bool,
    line: u64,
    text: Vec<u8>,
    /// Session, subject, trajectory of the row before; none before the first.
    groups: Option<[Vec<u8>; 3]>,
    last_s: f64,
    /// How many units of the stream's time make a second.
    a_second: f64,
    /// The unlit rows of a log.
    dark: Option<Dark>,
    notes: Vec<String>,
}

/// What is remembered of a log's unlit rows.
#[derive(Debug)]
struct Dark {
    preceding: Preceding,
    /// A recording has begun, and no lit row of it has come yet.
    begins: bool,
    /// Rows so far: their time where the stream has none.
    rows: f64,
    /// Rows that don't say whether the LED was on.
    unknown: u64,
}

/// Whether a row's LED was on; none where it does not say.
type Lit = Option<bool>;

impl<'a, R: BufRead> RowStream<'a, R> {
    /// Reads the line of names; `name` is the stream's in messages. With `drop_invalid`, a cell that is no finite
    /// number is NaN rather than an error. `rows.log` says how a log is read.
    ///
    /// # Errors
    /// No line of names, a photodiode that is not among them, two columns of one name; a stretch or stream of a file
    /// asked for.
    pub fn new(from: R, name: &str, inputs: &'a [String], rows: &RowOptions) -> Result<Self, DataError> {
        let mut stream = Self {
            from,
            name: name.to_owned(),
            names: Vec::new(),
            uses: Vec::new(),
            inputs,
            statuses: Statuses::new(inputs),
            drop_invalid: rows.drop_invalid,
            line: 0,
            text: Vec::new(),
            groups: None,
            last_s: f64::NAN,
            a_second: 1.0,
            dark: None,
            notes: Vec::new(),
        };
        let refused = |what: String| DataError::Columns { path: name.into(), what };
        if !stream.next_line()? {
            return Err(refused("is empty; a stream begins with the names of its columns".to_owned()));
        }
        let text = stream.text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&stream.text);
        let text = std::str::from_utf8(text).map_err(|_| refused("line 1 is not UTF-8 text; send UTF-8".to_owned()))?;
        let mut names: Vec<String> = Cells { rest: Some(text.as_bytes()) }
            .map(|cell| String::from_utf8_lossy(cell).replace("\"\"", "\""))
            .collect();
        if text.contains('\r') {
            return Err(refused("ends its lines with carriage returns alone; end them with line feeds".to_owned()));
        }
        if rows.log.columns.piece.is_some() || rows.log.columns.stream.is_some() {
            let what = "--piece and --stream choose a part of a file, and this is a stream of rows; leave them out";
            return Err(DataError::Request(what.to_owned()));
        }
        let is_log = rows.log.says_log() || rows.log.has_led(&names);
        if is_log {
            let renamed = rows.log.renamed(&names).map_err(&refused)?;
            (names, stream.a_second, stream.notes) = (renamed.names, renamed.per_second, renamed.notes);
        }
        let mut seen = HashSet::new();
        if let Some(double) = names.iter().find(|name| !seen.insert(name.as_str())) {
            return Err(refused(format!("two columns are named `{double}`; rename one")));
        }
        if inputs.is_empty() {
            return Err(DataError::Request("no photodiode is given".to_owned()));
        }
        if let Some(lacking) = inputs.iter().find(|input| !seen.contains(input.as_str())) {
            let all_numbers = names.iter().all(|name| name.parse::<f64>().is_ok());
            let what = if all_numbers {
                format!("line 1 holds numbers where the names of the columns should be. {}", listed(&names, 8))
            } else {
                missing(lacking, &names)
            };
            return Err(refused(what));
        }
        let place_of: HashMap<&str, usize> = inputs.iter().enumerate().map(|(k, input)| (input.as_str(), k)).collect();
        let use_of = |name: &String| {
            if let Some(&k) = place_of.get(name.as_str()) {
                return Use::Input(k);
            }
            match name.as_str() {
                "time_s" => Use::Time,
                "led" if is_log => Use::Led,
                "sensor_status" => Use::Status,
                _ => GROUPS.iter().position(|group| group == name).map_or(Use::None, Use::Group),
            }
        };
        stream.uses = names.iter().map(use_of).collect();
        if is_log {
            let preceding = Preceding::new(inputs.len(), rows.log.ambient.full_scale_v).map_err(LogError::from)?;
            // Without a column that says so, every row is lit.
            let led = stream.uses.contains(&Use::Led);
            stream.dark = led.then_some(Dark { preceding, begins: false, rows: 0.0, unknown: 0 });
            if led {
                stream.notes.push(PRECEDING_RULE.to_owned());
            }
        }
        stream.names = names;
        Ok(stream)
    }

    /// Whether rows have a time.
    #[must_use]
    pub fn has_time(&self) -> bool {
        self.uses.contains(&Use::Time)
    }

    /// What is worth saying so far; what was said is not said again.
    pub fn notes(&mut self) -> Vec<String> {
        let mut notes = std::mem::take(&mut self.notes);
        if let Some(dark) = self.dark.as_mut().filter(|dark| dark.unknown > 0) {
            notes.push(format!("{} rows do not say whether the LED was on and are left out", dark.unknown));
            dark.unknown = 0;
        }
        notes
    }

    /// Reads the next row's voltages into `x`, in the order of the photodiodes; NaN where a cell is empty. None at the
    /// stream's end.
    ///
    /// # Errors
    /// A cell that is no finite number, or too many or too few cells (unless invalid ones are dropped); a stream that
    /// breaks.
    ///
    /// # Panics
    /// If `x` does not hold one value for each photodiode.
    pub fn next_row(&mut self, x: &mut [f64]) -> Result<Option<Row>, DataError> {
        loop {
            let Some((mut row, lit)) = self.read_row(x)? else { return Ok(None) };
            let has_time = self.has_time();
            let Some(Dark { preceding, begins, rows, unknown }) = &mut self.dark else { return Ok(Some(row)) };
            if row.begins {
                preceding.forget();
                *begins = true;
            }
            *rows += 1.0;
            let at = if has_time { row.time_s } else { *rows };
            match lit {
                Some(true) => {
                    row.faulty |= preceding.lit(at, x);
                    row.begins = std::mem::take(begins);
                    return Ok(Some(row));
                }
                Some(false) => preceding.unlit(at, x),
                None => *unknown += 1,
            }
        }
    }

    /// The next row, lit or not.
    fn read_row(&mut self, x: &mut [f64]) -> Result<Option<(Row, Lit)>, DataError> {
        assert_eq!(x.len(), self.inputs.len(), "a value for each photodiode");
        if !self.next_line()? {
            return Ok(None);
        }
        let mut row =
            Row { line: self.line, time_s: f64::NAN, faulty: false, invalid: false, begins: self.groups.is_none() };
        x.fill(f64::NAN);
        let groups = self.groups.get_or_insert_default();
        let mut wrong: Option<(usize, String)> = None;
        let mut lit = None;
        let mut cells = 0;
        for cell in (Cells { rest: Some(&self.text) }) {
            let column = cells;
            cells += 1;
            match self.uses.get(column) {
                None | Some(Use::None) => {}
                Some(&Use::Group(k)) => {
                    if groups[k] != cell {
                        groups[k].clear();
                        groups[k].extend_from_slice(cell);
                        row.begins = true;
                    }
                }
                Some(Use::Led) => match led_state(cell) {
                    Ok(state) => lit = state,
                    Err(_) if self.drop_invalid => row.invalid = true,
                    Err(what) => {
                        wrong.get_or_insert((column, what));
                    }
                },
                Some(Use::Status) => {
                    let status = std::str::from_utf8(cell).unwrap_or_default();
                    row.faulty = self.statuses.read(status) == Verdict::Fault;
                }
                Some(&what @ (Use::Time | Use::Input(_))) if !cell.is_empty() => {
                    let number = std::str::from_utf8(cell).ok().and_then(|text| text.parse::<f64>().ok());
                    let place = if let Use::Input(k) = what { &mut x[k] } else { &mut row.time_s };
                    match number.filter(|number| number.is_finite()) {
                        Some(number) => *place = number,
                        None if self.drop_invalid => row.invalid = true,
                        None => {
                            let text: String = String::from_utf8_lossy(cell).chars().take(40).collect();
                            let what = format!(
                                "`{text}` is no finite number; correct it, leave it empty, or pass over such rows \
                                 with --drop-invalid"
                            );
                            wrong.get_or_insert((column, what));
                        }
                    }
                }
                Some(Use::Time | Use::Input(_)) => {}
            }
        }
        if cells != self.names.len() {
            if !self.drop_invalid {
                let what = format!("{cells} cells for {} columns; correct it", self.names.len());
                return Err(DataError::Cell { place: format!("{}:{}", self.name, self.line), what });
            }
            x.fill(f64::NAN);
            (row.time_s, row.invalid, lit) = (f64::NAN, true, None);
        }
        if let Some((column, what)) = wrong {
            let place = format!("{}:{}: column `{}`", self.name, self.line, self.names[column]);
            return Err(DataError::Cell { place, what });
        }
        row.time_s /= self.a_second;
        row.begins |= row.time_s < self.last_s;
        // As in a table, a new recording knows nothing of the times before.
        if !row.time_s.is_nan() || row.begins {
            self.last_s = row.time_s;
        }
        Ok(Some((row, lit)))
    }

    /// The next line that is not empty, without its end.
    fn next_line(&mut self) -> Result<bool, DataError> {
        loop {
            self.text.clear();
            let read = self.from.by_ref().take(LONGEST + 1).read_until(b'\n', &mut self.text);
            if self.text.len() as u64 > LONGEST {
                let place = format!("{}:{}", self.name, self.line + 1);
                let what = format!(
                    "the line is longer than {LONGEST} bytes; a stream is lines of CSV, each ended by a line feed"
                );
                return Err(DataError::Cell { place, what });
            }
            if read.map_err(|why| DataError::Stream { name: self.name.clone(), why })? == 0 {
                return Ok(false);
            }
            self.line += 1;
            while self.text.last().is_some_and(|b| matches!(b, b'\n' | b'\r')) {
                self.text.pop();
            }
            if !self.text.is_empty() {
                return Ok(true);
            }
        }
    }
}

/// The cells of a line, without the space and the quotes around them.
struct Cells<'a> {
    rest: Option<&'a [u8]>,
}

impl<'a> Iterator for Cells<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        let rest = self.rest?;
        let mut quoted = false;
        let end = rest.iter().position(|&b| {
            quoted ^= b == b'"';
            b == b',' && !quoted
        });
        self.rest = end.map(|end| &rest[end + 1..]);
        let cell = rest[..end.unwrap_or(rest.len())].trim_ascii();
        Some(match cell {
            [b'"', inside @ .., b'"'] => inside.trim_ascii(),
            _ => cell,
        })
    }
}
