//! What comes before the columns have names.
//!
//! What a device sends, and what a terminal wrote to a file of it, may begin with the end of a line, with messages of
//! its start, or with bytes of another baud rate; the first line that may be one of names, and whose names mean
//! something to the caller, is it. One whose names mean nothing is one all the same where numbers follow in as many
//! cells. A file's names come before its numbers, and some may be no words (`50 %`).

use crate::wire::cell::is_name;
use crate::wire::fault::WireFault;
use crate::wire::lines::cells::{Cells, Separator, is_other_order, names_of};
use crate::wire::row::{Meaning, Naming};
use crate::wire::spoilt::shown;

/// So many lines of numbers without a name before them, for so long, are a stream without names: a device that starts
/// again when its port is opened has done so by then (*assumed*).
const LINES_WITHOUT_NAMES: u32 = 20;
const LINES_WITHOUT_NAMES_NS: u64 = 3_000_000_000;

/// So many bytes, almost a third of which no text has, are another baud rate; fewer may be the first messages of a
/// chip's own loader (an ESP8266 sends about 400 bytes at 74 880 baud).
const GARBLED_BYTES: u64 = 2048;

/// So many do where nothing else comes.
const GARBLED_BYTES_AT_END: u64 = 8;

/// The longest comment that may hold names.
const MOST_COMMENT: usize = 4096;

/// Names, their separator and their meaning.
pub(super) struct Header {
    pub(super) names: Vec<String>,
    pub(super) separator: Separator,
    pub(super) meaning: Meaning,
    /// Whether the line itself is one of numbers, and the names were known before it.
    pub(super) is_row: bool,
}

/// A line of names that mean nothing.
struct Refused {
    cells: usize,
    separator: Separator,
    fault: WireFault,
}

/// Looks for the names of the columns.
pub(super) struct Opening {
    naming: Naming,
    given: Option<Vec<String>>,
    is_file: bool,
    declared: Option<Separator>,
    comment: Vec<u8>,
    refused: Option<Refused>,
    /// The last line that has not as many cells as names were given.
    other_cells: Option<WireFault>,
    /// Lines of numbers, when the first came, and the last.
    numbers: u32,
    since_ns: Option<u64>,
    sample: (u64, String),
    bytes: u64,
    garbled: u64,
    first: Vec<u8>,
}

impl Opening {
    pub(super) fn new(naming: Naming, given: Option<Vec<String>>, is_file: bool) -> Self {
        Self {
            naming,
            given,
            is_file,
            declared: None,
            comment: Vec::new(),
            refused: None,
            other_cells: None,
            numbers: 0,
            since_ns: None,
            sample: (0, String::new()),
            bytes: 0,
            garbled: 0,
            first: Vec::new(),
        }
    }

    /// Looks at bytes as they come.
    ///
    /// # Errors
    /// They are no text.
    pub(super) fn look(&mut self, bytes: &[u8]) -> Result<(), WireFault> {
        const KEPT: usize = 64;
        let kept = bytes.len().min(KEPT - self.first.len());
        self.first.extend_from_slice(&bytes[..kept]);
        self.bytes += bytes.len() as u64;
        let control = |b: u8| b == 0x7f || b < 0x20 && !matches!(b, b'\t' | b'\n' | b'\r' | 0x1b);
        let odd: usize = bytes
            .utf8_chunks()
            .map(|chunk| chunk.invalid().len() + chunk.valid().bytes().filter(|&b| control(b)).count())
            .sum();
        self.garbled += odd as u64;
        if self.is_garbled(GARBLED_BYTES) { Err(self.garbled_fault()) } else { Ok(()) }
    }

    fn is_garbled(&self, least: u64) -> bool {
        self.bytes >= least && 10 * self.garbled > 3 * self.bytes
    }

    fn garbled_fault(&self) -> WireFault {
        WireFault::Garbled { text: shown(&self.first) }
    }

    /// That what came is no text, where nothing more comes.
    pub(super) fn garbled(&self) -> Option<WireFault> {
        self.is_garbled(GARBLED_BYTES_AT_END).then(|| self.garbled_fault())
    }

    /// Why there are no names at the end of the stream.
    pub(super) fn fault(&mut self) -> WireFault {
        if let Some(fault) = self.garbled() {
            return fault;
        }
        if let Some(refused) = self.refused.take() {
            return refused.fault;
        }
        if let Some(fault) = self.other_cells.take() {
            return fault;
        }
        if self.numbers > 0 {
            return WireFault::NoNames { line: self.sample.0, text: self.sample.1.clone() };
        }
        WireFault::Empty
    }

    /// A comment, without its `#`.
    pub(super) fn comment(&mut self, comment: &[u8]) {
        self.comment.clear();
        self.comment.extend_from_slice(&comment[..comment.len().min(MOST_COMMENT)]);
    }

    /// The names, where `line` is that of names or the first after it; none where it is a message.
    ///
    /// # Errors
    /// The names mean nothing to the caller, or there are none.
    pub(super) fn header(&mut self, line: &[u8], number: u64, host_ns: u64) -> Result<Option<Header>, WireFault> {
        // Excel's own line.
        if let [b's', b'e', b'p', b'=', mark @ (b',' | b';' | b'\t')] = line {
            self.declared = Some(Separator::Byte(*mark));
            return Ok(None);
        }
        if let Some(names) = self.given.take() {
            return self.given(names, line, number, host_ns);
        }
        let separator = self.declared.unwrap_or_else(|| Separator::of_names(line));
        let text = std::str::from_utf8(line).ok().filter(|text| !text.contains(|c: char| c.is_control() && c != '\t'));
        let names = text.map(|_| names_of(line, separator)).unwrap_or_default();
        let cut_off = |name: &String| name.starts_with(['+', '-', '.']);
        let name = |name: &String| is_name(name) && (self.is_file || !cut_off(name));
        let (any, all) = (names.iter().any(name), names.iter().all(|one| name(one) || one.is_empty()));
        if any && (all || self.is_file) {
            return Ok(self.choose(names, separator, number, all));
        }
        self.no_names(line, number, host_ns)
    }

    /// The names that were given beforehand, at the first line that has as many cells.
    fn given(
        &mut self,
        names: Vec<String>,
        line: &[u8],
        number: u64,
        host_ns: u64,
    ) -> Result<Option<Header>, WireFault> {
        let separator = match self.declared {
            Some(declared) => Some(declared).filter(|one| Cells::new(line, *one).count() == names.len()),
            None => Separator::making(line, names.len()),
        };
        let Some(separator) = separator else {
            let cells = Cells::new(line, self.declared.unwrap_or_else(|| Separator::of_names(line))).count();
            let fault = WireFault::OtherCells { line: number, cells, names: names.len() };
            self.given = Some(names);
            self.numbers += 1;
            let since_ns = *self.since_ns.get_or_insert(host_ns);
            if self.numbers >= LINES_WITHOUT_NAMES && host_ns >= since_ns + LINES_WITHOUT_NAMES_NS {
                return Err(fault);
            }
            self.other_cells = Some(fault);
            return Ok(None);
        };
        let is_row = !Cells::new(line, separator).all(|cell| is_name(&String::from_utf8_lossy(cell)));
        let own = if is_row { Vec::new() } else { names_of(line, separator) };
        if is_other_order(&own, &names) {
            let (names, given) = (own.join(","), names.join(","));
            return Err(WireFault::OtherOrder { line: number, names, given });
        }
        let meaning = Meaning::of(&names, 0, &mut self.naming)?;
        Ok(Some(Header { names, separator, meaning, is_row }))
    }

    fn choose(&mut self, names: Vec<String>, separator: Separator, number: u64, are_all_names: bool) -> Option<Header> {
        match Meaning::of(&names, number, &mut self.naming) {
            Ok(meaning) => Some(Header { names, separator, meaning, is_row: false }),
            Err(fault) => {
                if are_all_names || self.refused.is_none() {
                    self.refused = Some(Refused { cells: names.len(), separator, fault });
                }
                None
            }
        }
    }

    /// A line that holds no names.
    fn no_names(&mut self, line: &[u8], number: u64, host_ns: u64) -> Result<Option<Header>, WireFault> {
        let numeric = |separator: Separator| {
            let cell = |cell: &[u8]| {
                let text = String::from_utf8_lossy(cell);
                cell.is_empty() || text.replace(',', ".").parse::<f64>().is_ok()
            };
            Cells::new(line, separator).all(cell) && Cells::new(line, separator).any(|cell| !cell.is_empty())
        };
        if let Some(refused) = self.refused.take() {
            let cells = Cells::new(line, refused.separator).count();
            if cells == refused.cells && numeric(refused.separator) {
                return Err(refused.fault);
            }
            self.refused = Some(refused);
        }
        let separator = self.declared.unwrap_or_else(|| Separator::of_names(line));
        if numeric(separator) {
            let cells = Cells::new(line, separator).count();
            let names = names_of(self.comment.trim_ascii(), separator);
            if names.len() == cells && names.iter().any(|name| is_name(name)) {
                let header = self.choose(names, separator, number - 1, true);
                return Ok(header.map(|header| Header { is_row: true, ..header }));
            }
            self.numbers += 1;
            self.sample = (number, shown(line));
            let since_ns = *self.since_ns.get_or_insert(host_ns);
            if self.is_file || self.numbers >= LINES_WITHOUT_NAMES && host_ns >= since_ns + LINES_WITHOUT_NAMES_NS {
                // A single word is no line of names.
                let refused = self.refused.take().filter(|refused| self.is_file && refused.cells > 1);
                let none = || WireFault::NoNames { line: number, text: self.sample.1.clone() };
                return Err(refused.map_or_else(none, |refused| refused.fault));
            }
        }
        Ok(None)
    }
}
