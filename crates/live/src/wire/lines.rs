//! Lines that describe themselves to rows.
//!
//! In: bytes in pieces of any size. The first line names the columns, unless they are named beforehand; cells are
//! separated by commas, tabs, semicolons or spaces, as that line has them. `#` begins a comment; empty lines are passed
//! over; a line may end in `*HH`, the exclusive or of all bytes before the `*` (NMEA 0183's checksum), and once one did
//! every line has to. A device that starts again and names its columns once more begins a new recording.
//!
//! Out: a [`Line`] at a time, the same however the bytes were cut. A line that is spoilt costs itself: it is counted by
//! what is wrong with it, the first of each kind is kept. Nothing is allocated for a line once the longest has been seen.

use super::cell::{is_missing, led};
use super::row::{Meaning, Use};
use super::spoilt::{Spoilt, SpoiltKind};

/// No line of a sensor is longer, bytes; without an end to it, a stream of something else would fill the memory.
const LONGEST: usize = 1 << 20;
/// Lines of another kind that a device may send before it names its columns (boot messages), and bytes without any end
/// of a line: assumed.
const PATIENCE: u64 = 50;
const FIRST_BYTES: usize = 4096;

/// What the caller makes of the names of columns: their meaning, or why they can't be used.
pub type Naming<'a> = dyn FnMut(&[String]) -> Result<Meaning, String> + 'a;

/// What a line says.
#[derive(Debug, PartialEq)]
pub enum Line<'a> {
    /// It names the columns; `again` where they were known.
    Names {
        /// Whether they were known before.
        again: bool,
    },
    /// It is a row.
    Cells(Cells<'a>),
    /// It is spoilt.
    Spoilt(SpoiltKind),
}

/// The cells of a row, as the wire has them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cells<'a> {
    /// In the device's units; NaN where missing or where there is no such column.
    pub time: f64,
    /// The counter, where there is one.
    pub counter: Option<u64>,
    /// Whether the LED was on.
    pub lit: Option<bool>,
    /// The numbers that are read.
    pub values: &'a [f64],
    /// The texts that are kept.
    pub texts: &'a [Vec<u8>],
}

/// Why a stream can't be read at all.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct WireFault(pub String);

/// How lines are read.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LineOptions {
    /// The columns' names, where the stream does not name them.
    pub names: Option<Vec<String>>,
    /// Volts of a step, where the device sends counts: photodiodes are multiplied by it.
    pub volts_per_count: Option<f64>,
    /// Whether the bytes are a file's: its first line has to name the columns.
    pub file: bool,
}

/// Reads lines.
#[derive(Debug)]
pub struct Lines {
    options: LineOptions,
    partial: Vec<u8>,
    /// A line that is too long is being passed over.
    passing_over: bool,
    line: u64,
    names: Vec<String>,
    /// The line that named them.
    header: Vec<u8>,
    delimiter: u8,
    meaning: Option<Meaning>,
    values: Vec<f64>,
    texts: Vec<Vec<u8>>,
    checked: bool,
    /// Lines before the names that are no text.
    garbage: u64,
    refused: Option<String>,
    spoilt: Spoilt,
}

impl Lines {
    /// At a stream's beginning.
    #[must_use]
    pub fn new(options: LineOptions) -> Self {
        Self {
            names: options.names.clone().unwrap_or_default(),
            options,
            partial: Vec::with_capacity(1024),
            passing_over: false,
            line: 0,
            header: Vec::new(),
            delimiter: b',',
            meaning: None,
            values: Vec::new(),
            texts: Vec::new(),
            checked: false,
            garbage: 0,
            refused: None,
            spoilt: Spoilt::default(),
        }
    }

    /// The names of the columns, once they are known.
    #[must_use]
    pub fn names(&self) -> Option<&[String]> {
        self.meaning.is_some().then_some(&self.names[..])
    }

    /// What their columns mean.
    #[must_use]
    pub fn meaning(&self) -> Option<&Meaning> {
        self.meaning.as_ref()
    }

    /// The numbers of the last row.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The texts of the last row.
    #[must_use]
    pub fn texts(&self) -> &[Vec<u8>] {
        &self.texts
    }

    /// What was spoilt so far.
    #[must_use]
    pub fn spoilt(&self) -> &Spoilt {
        &self.spoilt
    }

    /// Takes from `bytes` up to the end of the next line that says something; none where they are used up.
    ///
    /// # Errors
    /// The stream can't be read at all.
    pub fn next(&mut self, bytes: &mut &[u8], naming: &mut Naming<'_>) -> Result<Option<Line<'_>>, WireFault> {
        loop {
            let Some(end) = bytes.iter().position(|&b| b == b'\n') else {
                self.keep(bytes)?;
                *bytes = &[];
                return Ok(None);
            };
            let (line, rest) = (&bytes[..end], &bytes[end + 1..]);
            *bytes = rest;
            self.line += 1;
            if std::mem::take(&mut self.passing_over) || self.partial.len() + line.len() > LONGEST {
                self.partial.clear();
                self.spoilt.count(SpoiltKind::TooLong, self.line, b"..");
                return Ok(Some(Line::Spoilt(SpoiltKind::TooLong)));
            }
            // A whole line within the bytes is not copied.
            let mut own = std::mem::take(&mut self.partial);
            let said = if own.is_empty() {
                self.read(line, naming)
            } else {
                own.extend_from_slice(line);
                self.read(&own, naming)
            };
            own.clear();
            self.partial = own;
            match said? {
                Said::Nothing => {}
                Said::Names { again } => return Ok(Some(Line::Names { again })),
                Said::Spoilt(kind) => return Ok(Some(Line::Spoilt(kind))),
                Said::Row { time, counter, lit } => {
                    return Ok(Some(Line::Cells(Cells {
                        time,
                        counter,
                        lit,
                        values: &self.values,
                        texts: &self.texts,
                    })));
                }
            }
        }
    }

    /// The stream ends: a last line without its end is a line.
    ///
    /// # Errors
    /// As [`next`](Self::next); a stream that ended before it named its columns.
    pub fn end(&mut self, naming: &mut Naming<'_>) -> Result<Option<Line<'_>>, WireFault> {
        if !self.partial.is_empty() || self.passing_over {
            let mut end: &[u8] = b"\n";
            // Borrowed anew by the caller: what this gives is all that is left.
            return self.next(&mut end, naming);
        }
        Ok(None)
    }

    /// Why nothing came, where no line named the columns.
    #[must_use]
    pub fn nothing(&self) -> String {
        match &self.refused {
            Some(refused) => refused.clone(),
            None if self.garbage > 0 => BAUD.to_owned(),
            None => "is empty; a stream begins with the names of its columns".to_owned(),
        }
    }

    /// The source was lost: what was begun of a line is no line; names that were known stay.
    pub fn cut(&mut self) {
        self.partial.clear();
        self.passing_over = false;
    }

    fn keep(&mut self, bytes: &[u8]) -> Result<(), WireFault> {
        if self.passing_over {
            return Ok(());
        }
        if self.partial.len() + bytes.len() > LONGEST {
            self.partial.clear();
            self.passing_over = true;
            return Ok(());
        }
        self.partial.extend_from_slice(bytes);
        let is_garbage = || self.partial.iter().filter(|b| !is_text(**b)).count() * 10 > self.partial.len();
        if self.meaning.is_none() && self.partial.len() > FIRST_BYTES && is_garbage() {
            return Err(WireFault(BAUD.to_owned()));
        }
        Ok(())
    }

    fn read(&mut self, line: &[u8], naming: &mut Naming<'_>) -> Result<Said, WireFault> {
        let line = if self.line == 1 { line.strip_prefix(b"\xef\xbb\xbf").unwrap_or(line) } else { line };
        let line = line.trim_ascii();
        if line.is_empty() || line[0] == b'#' {
            return Ok(Said::Nothing);
        }
        let (line, sum) = without_checksum(line);
        match sum {
            Some(true) => self.checked = true,
            Some(false) => return Ok(self.spoil(SpoiltKind::Checksum, line)),
            None if self.checked => return Ok(self.spoil(SpoiltKind::Checksum, line)),
            None => {}
        }
        if self.meaning.is_none() {
            return self.first(line, naming);
        }
        if line == self.header {
            return Ok(Said::Names { again: true });
        }
        Ok(match self.cells(line) {
            Ok(row) => row,
            Err(kind) => self.spoil(kind, line),
        })
    }

    fn know(&mut self, meaning: Meaning) {
        self.values = vec![f64::NAN; meaning.values];
        self.texts = vec![Vec::new(); meaning.texts];
        self.meaning = Some(meaning);
    }

    fn spoil(&mut self, kind: SpoiltKind, line: &[u8]) -> Said {
        self.spoilt.count(kind, self.line, line);
        Said::Spoilt(kind)
    }

    /// A line before the columns are known.
    fn first(&mut self, line: &[u8], naming: &mut Naming<'_>) -> Result<Said, WireFault> {
        let text = std::str::from_utf8(line).ok().filter(|text| text.bytes().all(is_text));
        let Some(text) = text else {
            self.garbage += 1;
            if self.options.file {
                return Err(WireFault(format!("line {} is not text; send lines of UTF-8 text", self.line)));
            }
            return if self.garbage >= 3 {
                Err(WireFault(BAUD.to_owned()))
            } else {
                Ok(self.spoil(SpoiltKind::NotText, line))
            };
        };
        let delimiter = delimiter_of(line);
        if self.options.names.is_some() {
            self.delimiter = delimiter;
            let meaning = naming(&self.names).map_err(WireFault)?;
            self.know(meaning);
            // The names may come all the same.
            let same = split(line, delimiter).eq(self.names.iter().map(|name| name.as_bytes()));
            if same {
                self.header = line.to_vec();
                return Ok(Said::Names { again: false });
            }
            // The row itself is read next time round: it is the first after the names.
            return Ok(match self.cells(line) {
                Ok(row) => row,
                Err(kind) => self.spoil(kind, line),
            });
        }
        let names: Vec<String> =
            split(line, delimiter).map(|cell| String::from_utf8_lossy(cell).replace("\"\"", "\"")).collect();
        let numbers = names.iter().all(|name| name.parse::<f64>().is_ok());
        let refused = if numbers {
            let what = format!(
                "line {} holds numbers where the names of the columns should be (`{}`); give them, as in --names time_ms,P1,P2",
                self.line,
                text.chars().take(60).collect::<String>()
            );
            Err(what)
        } else {
            naming(&names)
        };
        match refused {
            Ok(meaning) => {
                self.know(meaning);
                self.header = line.to_vec();
                (self.delimiter, self.names) = (delimiter, names);
                Ok(Said::Names { again: false })
            }
            // A device that starts says this and that before; numbers may be those of before it was started again.
            Err(what) if self.options.file || self.line > PATIENCE => Err(WireFault(what)),
            Err(what) => {
                self.refused.get_or_insert(what);
                Ok(self.spoil(SpoiltKind::Message, line))
            }
        }
    }

    /// A row's cells.
    fn cells(&mut self, line: &[u8]) -> Result<Said, SpoiltKind> {
        let Self { meaning: Some(meaning), values, texts, delimiter, options, .. } = self else {
            return Ok(Said::Nothing);
        };
        let (mut time, mut counter, mut lit) = (f64::NAN, None, None);
        values.fill(f64::NAN);
        let mut count = 0;
        for cell in split(line, *delimiter) {
            let Some(what) = meaning.uses.get(count) else {
                // A separator at a row's end makes an empty cell.
                if cell.is_empty() {
                    continue;
                }
                return Err(SpoiltKind::Cells);
            };
            count += 1;
            match *what {
                Use::None => {}
                Use::Text(at) => {
                    texts[at].clear();
                    texts[at].extend_from_slice(cell);
                }
                Use::Time { .. } => time = number(cell, *delimiter)?,
                Use::Counter => {
                    let value = number(cell, *delimiter)?;
                    if !(value.is_nan() || (0.0..=9e15).contains(&value) && value.fract() == 0.0) {
                        return Err(SpoiltKind::Number);
                    }
                    counter = (!value.is_nan()).then_some(value as u64);
                }
                Use::Led => lit = led(cell).map_err(|_| SpoiltKind::Led)?,
                Use::Value(at) => values[at] = number(cell, *delimiter)?,
                Use::Counts(at) => {
                    values[at] = number(cell, *delimiter)? * options.volts_per_count.unwrap_or(1.0);
                }
            }
        }
        if count < meaning.uses.len() { Err(SpoiltKind::Cells) } else { Ok(Said::Row { time, counter, lit }) }
    }
}

/// What a line says, without its values.
enum Said {
    Nothing,
    Names { again: bool },
    Spoilt(SpoiltKind),
    Row { time: f64, counter: Option<u64>, lit: Option<bool> },
}

const BAUD: &str = "what comes is no text: it looks like a wrong baud rate (or frames: say form=frames); set the rate \
                    that the device's program sets, as in serial:/dev/ttyACM0?baud=115200";

/// Whether a byte belongs to text of one line.
fn is_text(byte: u8) -> bool {
    byte >= b' ' && byte != 0x7f || matches!(byte, b'\t' | b'\r' | b'\n')
}

/// A line less its checksum, and whether that is right; none where it has none.
fn without_checksum(line: &[u8]) -> (&[u8], Option<bool>) {
    let [before @ .., b'*', high, low] = line else { return (line, None) };
    let digit = |byte: u8| char::from(byte).to_digit(16);
    let (Some(high), Some(low)) = (digit(*high), digit(*low)) else { return (line, None) };
    let before = before.strip_prefix(b"$").unwrap_or(before);
    let sum = before.iter().fold(0u8, |sum, byte| sum ^ byte);
    (before, Some(u32::from(sum) == 16 * high + low))
}

/// What separates cells: the first of these that the line has outside of quotes.
fn delimiter_of(line: &[u8]) -> u8 {
    let mut quoted = false;
    let bare: Vec<u8> = line
        .iter()
        .copied()
        .filter(|&byte| {
            quoted ^= byte == b'"';
            !quoted
        })
        .collect();
    [b'\t', b';', b','].into_iter().find(|one| bare.contains(one)).unwrap_or(b' ')
}

/// The cells of a line, without the space and the quotes around them; separators that are spaces may be many.
fn split(line: &[u8], delimiter: u8) -> Split<'_> {
    Split { rest: Some(line), delimiter }
}

struct Split<'a> {
    rest: Option<&'a [u8]>,
    delimiter: u8,
}

impl<'a> Iterator for Split<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        let mut rest = self.rest?;
        if self.delimiter == b' ' {
            rest = rest.trim_ascii_start();
        }
        let mut quoted = false;
        let end = rest.iter().position(|&b| {
            quoted ^= b == b'"';
            b == self.delimiter && !quoted
        });
        self.rest = end.map(|end| &rest[end + 1..]);
        let cell = rest[..end.unwrap_or(rest.len())].trim_ascii();
        Some(match cell {
            [b'"', inside @ .., b'"'] => inside.trim_ascii(),
            _ => cell,
        })
    }
}

/// A cell's number; NaN where it is missing. A decimal comma counts where commas separate nothing.
fn number(cell: &[u8], delimiter: u8) -> Result<f64, SpoiltKind> {
    if cell.is_empty() {
        return Ok(f64::NAN);
    }
    let text = std::str::from_utf8(cell).map_err(|_| SpoiltKind::NotText)?;
    if let Ok(number) = text.parse::<f64>() {
        return if number.is_infinite() { Err(SpoiltKind::Number) } else { Ok(number) };
    }
    if is_missing(cell) {
        return Ok(f64::NAN);
    }
    let mut buffer = [0; 40];
    if delimiter != b','
        && let Some(buffer) = buffer.get_mut(..cell.len())
        && let Some(comma) = cell.iter().position(|&b| b == b',')
    {
        buffer.copy_from_slice(cell);
        buffer[comma] = b'.';
        let number = std::str::from_utf8(buffer).ok().and_then(|text| text.parse::<f64>().ok());
        return number.filter(|number| number.is_finite()).ok_or(SpoiltKind::Number);
    }
    Err(SpoiltKind::Number)
}
