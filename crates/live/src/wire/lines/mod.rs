//! Lines of text to rows.
//!
//! In: bytes in pieces of any size. Out: the names of the columns, then a row for each line. Cells are separated by
//! tabs, `;`, `,` or space, found from the first line, and may be in double quotes; lines end in LF, CR LF or CR; empty
//! ones and those that begin with `#` are passed over. Only columns in use are read. Once a line had a [`Checksum`],
//! each row has to have one. Nothing is allocated for a row.

mod cells;
mod opening;
#[cfg(test)]
mod tests;

use crate::wire::cell::{is_name, led};
use crate::wire::checksum::{Checksum, Unsealed, unseal};
use crate::wire::fault::WireFault;
use crate::wire::row::{Decoded, Naming, Sample, Step, Use};
use crate::wire::spoilt::{Spoil, shown};
use cells::{Cells, Numbers, Separator, count, is_other_order, names_of};
use opening::Opening;

/// The longest line, bytes: more than any logger writes, little enough to hold.
const MOST_LINE: usize = 1 << 20;

/// The room for half a line at first, bytes; a row of nine numbers has about 70.
const ROOM: usize = 4096;

/// How lines are read.
#[derive(Debug, Clone, Default)]
pub struct LineOptions {
    /// The columns' names; none where the first line holds them.
    pub columns: Option<Vec<String>>,
    /// Whether they are a file's, whose names come before its numbers.
    pub is_file: bool,
    /// The volts of a count of the columns that are scaled.
    pub volts_per_count: Option<f64>,
}

/// Decodes lines.
pub struct Lines {
    /// Until the columns have names.
    opening: Option<Opening>,
    given: bool,
    pub(crate) decoded: Decoded,
    separator: Separator,
    numbers: Numbers,
    /// How rows are protected; none where they are not.
    pub(crate) checksum: Option<Checksum>,
    volts_per_count: Option<f64>,
    /// The beginning of a line whose end has not come.
    carry: Vec<u8>,
    /// `carry` is a whole line.
    whole: bool,
    /// The rest of a line that is too long is passed over.
    skipping: bool,
    /// The next line may be the end of one.
    seam: bool,
    /// The last line ended in CR, to which an LF may belong.
    after_cr: bool,
    line: u64,
}

/// What a line is.
enum Found {
    Nothing,
    Step(Step),
    /// The names are known now, and the line is a row.
    NamesBefore,
}

impl Lines {
    /// Lines whose columns mean what `naming` says.
    #[must_use]
    pub fn new(naming: Naming, options: LineOptions) -> Self {
        let LineOptions { columns, is_file, volts_per_count } = options;
        Self {
            given: columns.is_some(),
            opening: Some(Opening::new(naming, columns, is_file)),
            decoded: Decoded::default(),
            separator: Separator::Byte(b','),
            numbers: Numbers::default(),
            checksum: None,
            volts_per_count,
            carry: Vec::with_capacity(ROOM),
            whole: false,
            skipping: false,
            seam: false,
            after_cr: false,
            line: 0,
        }
    }

    /// Decodes up to the next step and takes what it used off `bytes`, which came at `host_ns`; none where no line is
    /// whole any more.
    ///
    /// # Errors
    /// The names mean nothing to the caller, there are none, other ones come later, or what comes is no text.
    pub fn next(&mut self, bytes: &mut &[u8], host_ns: u64) -> Result<Option<Step>, WireFault> {
        loop {
            if self.whole {
                if let Some(step) = self.carried(host_ns)? {
                    return Ok(Some(step));
                }
                continue;
            }
            if !bytes.is_empty() && std::mem::take(&mut self.after_cr) {
                *bytes = bytes.strip_prefix(b"\n").unwrap_or(bytes);
            }
            let Some(end) = memchr::memchr2(b'\n', b'\r', bytes) else {
                let piece = std::mem::take(bytes);
                self.look(piece)?;
                return Ok(self.carry_on(piece));
            };
            let piece = &bytes[..end];
            self.after_cr = bytes[end] == b'\r';
            *bytes = &bytes[end + 1..];
            self.look(piece)?;
            if std::mem::take(&mut self.skipping) {
                continue;
            }
            if self.carry.is_empty() && piece.len() <= MOST_LINE {
                match self.line(piece, host_ns)? {
                    Found::Nothing => {}
                    Found::Step(step) => return Ok(Some(step)),
                    Found::NamesBefore => {
                        self.carry.extend_from_slice(piece);
                        self.whole = true;
                        return Ok(Some(Step::Columns { again: false }));
                    }
                }
                continue;
            }
            let too_long = self.carry_on(piece);
            if std::mem::take(&mut self.skipping) {
                return Ok(too_long);
            }
            self.whole = true;
        }
    }

    /// The end of the stream: its last line need not have an end.
    ///
    /// # Errors
    /// As of [`next`](Self::next), or the stream ended before its names.
    pub fn finish(&mut self, host_ns: u64) -> Result<Option<Step>, WireFault> {
        self.whole |= !self.carry.is_empty();
        while self.whole {
            if let Some(step) = self.carried(host_ns)? {
                return Ok(Some(step));
            }
        }
        match &mut self.opening {
            Some(opening) => Err(opening.fault()),
            None => Ok(None),
        }
    }

    /// Whether what came so far is no text, rather than messages before the names.
    #[must_use]
    pub fn garbled(&self) -> Option<WireFault> {
        self.opening.as_ref().and_then(Opening::garbled)
    }

    /// Forgets half a line: what comes next comes from another connection, `within` a line where its beginning may be
    /// lost.
    pub fn cut(&mut self, within: bool) {
        self.carry.clear();
        (self.whole, self.skipping, self.seam, self.after_cr) = (false, false, within, false);
    }

    fn look(&mut self, piece: &[u8]) -> Result<(), WireFault> {
        self.opening.as_mut().map_or(Ok(()), |opening| opening.look(piece))
    }

    /// Keeps a piece of a line; spoilt where the line becomes too long.
    fn carry_on(&mut self, piece: &[u8]) -> Option<Step> {
        if self.skipping {
            return None;
        }
        if self.carry.len() + piece.len() <= MOST_LINE {
            self.carry.extend_from_slice(piece);
            return None;
        }
        self.skipping = true;
        self.line += 1;
        let head: Vec<u8> = self.carry.iter().chain(piece).take(256).copied().collect();
        self.carry.clear();
        self.decoded.tally.add(Spoil::TooLong, self.line, || shown(&head));
        Some(Step::Spoilt(Spoil::TooLong))
    }

    /// The line in `carry`.
    fn carried(&mut self, host_ns: u64) -> Result<Option<Step>, WireFault> {
        let line = std::mem::take(&mut self.carry);
        let found = self.line(&line, host_ns);
        self.carry = line;
        match found? {
            Found::NamesBefore => Ok(Some(Step::Columns { again: false })),
            found => {
                self.carry.clear();
                self.whole = false;
                Ok(if let Found::Step(step) = found { Some(step) } else { None })
            }
        }
    }

    fn line(&mut self, line: &[u8], host_ns: u64) -> Result<Found, WireFault> {
        self.line += 1;
        let line = line.strip_prefix(b"\xef\xbb\xbf").filter(|_| self.line == 1).unwrap_or(line);
        // A tab at an end separates a cell.
        let bare = line.trim_ascii();
        if bare.is_empty() {
            return Ok(Found::Nothing);
        }
        if let [b'#', comment @ ..] = bare {
            if let Some(opening) = &mut self.opening {
                opening.comment(comment);
            }
            return Ok(Found::Nothing);
        }
        let Unsealed { body, checksum, fits } = unseal(bare);
        let body = if checksum.is_some() { body } else { line };
        if self.opening.is_some() {
            return self.opened(body, checksum, fits, host_ns);
        }
        let seam = std::mem::take(&mut self.seam);
        let row = match (checksum, self.checksum) {
            (Some(_), _) if !fits => Err(Spoil::Checksum),
            (None, Some(_)) => Err(Spoil::Unchecked),
            (Some(one), Some(other)) if one != other => Err(Spoil::Checksum),
            // Half a row may look like a row where nothing says that it is whole.
            (None, None) if seam => Err(Spoil::Cells),
            _ => self.row(body),
        };
        let spoil = match row {
            Ok(sample) => {
                self.checksum = checksum;
                return Ok(Found::Step(Step::Sample(sample)));
            }
            Err(spoil) => spoil,
        };
        if fits
            && (checksum.is_some() || self.checksum.is_none())
            && let Some(fault) = self.other_names(body, seam)
        {
            return Err(fault);
        }
        if fits && self.are_names(body) {
            return Ok(Found::Step(Step::Columns { again: true }));
        }
        if seam {
            return Ok(Found::Nothing);
        }
        self.decoded.tally.add(spoil, self.line, || shown(line));
        Ok(Found::Step(Step::Spoilt(spoil)))
    }

    /// A line before the columns have names.
    fn opened(
        &mut self,
        body: &[u8],
        checksum: Option<Checksum>,
        fits: bool,
        host_ns: u64,
    ) -> Result<Found, WireFault> {
        let header = match &mut self.opening {
            Some(opening) if fits => opening.header(body, self.line, host_ns)?,
            _ => None,
        };
        let Some(header) = header else {
            self.decoded.tally.add(Spoil::BeforeNames, self.line, || shown(body));
            return Ok(Found::Step(Step::Spoilt(Spoil::BeforeNames)));
        };
        self.opening = None;
        self.numbers.comma_allowed = header.separator.allows_comma();
        self.separator = header.separator;
        self.decoded.begin(header.names, header.meaning);
        if header.is_row {
            // It is counted when it is read.
            self.line -= 1;
            return Ok(Found::NamesBefore);
        }
        (self.checksum, self.seam) = (checksum, false);
        Ok(Found::Step(Step::Columns { again: false }))
    }

    /// Whether a line holds the names of the columns.
    fn are_names(&self, body: &[u8]) -> bool {
        let mut cells = Cells::new(body, self.separator);
        if self.given {
            let name = |cell: &[u8]| std::str::from_utf8(cell).is_ok_and(is_name);
            return Cells::new(body, self.separator).count() == self.decoded.names.len() && cells.all(name);
        }
        self.decoded.names.iter().all(|name| cells.next().is_some_and(|cell| cell == name.as_bytes()))
            && cells.next().is_none()
    }

    /// That a line names other columns, or the columns in another order; none where it does not. Rows with more or
    /// fewer cells than before are spoilt each by itself. What follows a `seam` may lack its beginning.
    fn other_names(&self, body: &[u8], seam: bool) -> Option<WireFault> {
        let before = &self.decoded.names;
        if Cells::new(body, self.separator).count() != before.len() {
            return None;
        }
        let names = names_of(body, self.separator);
        let given = self.given;
        if is_other_order(&names, before) {
            let (line, names, before) = (self.line, names.join(","), before.join(","));
            return Some(match given {
                true => WireFault::OtherOrder { line, names, given: before },
                false => WireFault::OtherNames { line, names, before },
            });
        }
        // Other words than names that were given may be the device's own for the same columns.
        if given || seam || names == *before || !names.iter().all(|name| name.is_empty() || is_name(name)) {
            return None;
        }
        // Bytes that no text has are damage.
        let is_control = |c: char| c.is_control() && c != '\t';
        if !std::str::from_utf8(body).is_ok_and(|text| !text.contains(is_control)) {
            return None;
        }
        let known = names.iter().filter(|name| !name.is_empty() && before.contains(name)).count();
        let is_header = 2 * known >= names.iter().filter(|name| !name.is_empty()).count().max(1);
        is_header.then(|| WireFault::OtherNames { line: self.line, names: names.join(","), before: before.join(",") })
    }

    fn row(&mut self, body: &[u8]) -> Result<Sample, Spoil> {
        let mut sample = Sample { time: f64::NAN, counter: None, lit: None };
        let mut cells = Cells::new(body, self.separator);
        let mut good = true;
        for (at, purpose) in self.decoded.meaning.uses.iter().enumerate() {
            let Some(cell) = cells.next() else {
                let nameless = |k: usize| self.decoded.names[k].is_empty() && self.decoded.meaning.uses[k] == Use::None;
                if (at..self.decoded.names.len()).all(nameless) {
                    break;
                }
                return Err(Spoil::Cells);
            };
            let read = match *purpose {
                Use::None => continue,
                Use::Text(at) => {
                    self.decoded.texts[at].clear();
                    self.decoded.texts[at].extend_from_slice(cell);
                    continue;
                }
                Use::Time { .. } => self.numbers.read(cell).map(|time| sample.time = time),
                Use::Counter => count(cell, &mut self.numbers).map(|counter| sample.counter = counter),
                Use::Led => led(cell).ok().map(|lit| sample.lit = lit),
                Use::Value { at, scaled } => self.numbers.read(cell).map(|number| {
                    let scale = self.volts_per_count.filter(|_| scaled);
                    self.decoded.values[at] = scale.map_or(number, |volts| number * volts);
                }),
            };
            good &= read.is_some();
        }
        // Cells beyond the last column may be there where they are empty.
        if !cells.all(<[u8]>::is_empty) {
            return Err(Spoil::Cells);
        }
        if good { Ok(sample) } else { Err(Spoil::Unreadable) }
    }

    /// The columns, the last row, and what was spoilt.
    #[must_use]
    pub fn decoded(&self) -> &Decoded {
        &self.decoded
    }
}
