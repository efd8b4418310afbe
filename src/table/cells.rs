//! The cells of a CSV file: one text, and where in it each cell ends.
//!
//! Cells are separated by what separates the names: commas, semicolons, tabs or bars ([`delimiter_of`]). Where that is
//! no comma, numbers may have a decimal comma, all or none of them.
//!
//! A file without a quotation mark is its own text: cells are cut out of it, nothing is copied. One with quotation
//! marks goes through the CSV reader, row by row into a text of the same shape. Lines are those of the file, counted
//! from 1; empty ones are no rows, nor are those at the end that have cells and nothing in them, as spreadsheets write
//! them.

use std::ops::Range;

use crate::input;
use memchr::{memchr, memchr_iter, memchr2_iter};

/// What may separate cells, the likeliest last.
pub(crate) const DELIMITERS: [u8; 4] = [b'|', b'\t', b';', b','];

/// What separates the names in the first line of a text: what stands there most often, in no quotes.
pub(crate) fn delimiter_of(text: &str) -> u8 {
    let names = text.split(['\n', '\r']).find(|line| !line.is_empty()).unwrap_or_default();
    let bare: String = names.split('"').step_by(2).collect();
    DELIMITERS.into_iter().max_by_key(|&mark| bare.matches(char::from(mark)).count()).unwrap_or(b',')
}

/// The line of the row that the CSV reader finds from `position` of `text` on. The reader's own line is that of what is
/// left of the row before, as the second half of its `\r\n`; empty lines may follow.
pub(crate) fn line_of_row(text: &[u8], position: &csv::Position) -> u64 {
    let skipped = text[position.byte() as usize..].iter().take_while(|b| matches!(b, b'\n' | b'\r'));
    position.line() + skipped.filter(|&&b| b == b'\n').count() as u64
}

/// The rows of a CSV file, each with as many cells as there are names.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct CsvCells {
    text: String,
    /// Cells of a row.
    columns: usize,
    /// Where each row begins, and its line.
    rows: Vec<(usize, u64)>,
    /// Where each cell ends, row by row; one byte lies between the cells of a row.
    ends: Vec<usize>,
}

impl CsvCells {
    /// The names and the rows in the bytes of a file; no names where it has no line.
    ///
    /// # Errors
    /// Text that is not UTF-8, and rows of unequal length, with the line.
    pub(super) fn read(mut bytes: Vec<u8>) -> Result<(Vec<String>, Self), String> {
        if bytes.starts_with(b"\xef\xbb\xbf") {
            bytes.drain(..3);
        }
        input::end_lines(&mut bytes);
        let text = String::from_utf8(bytes).map_err(|why| {
            let line = 1 + memchr_iter(b'\n', &why.as_bytes()[..why.utf8_error().valid_up_to()]).count();
            format!("line {line} is not UTF-8 text; save the file as UTF-8")
        })?;
        let delimiter = delimiter_of(&text);
        let is_plain = is_plain(text.as_bytes());
        let mut all = if is_plain { Self::of_plain(text, delimiter) } else { Self::of_quoted(&text, delimiter) }?;
        all.drop_empty_end();
        if delimiter != b',' {
            all.read_decimal_commas()?;
        }
        Ok(all.with_names())
    }

    pub(super) fn rows(&self) -> usize {
        self.rows.len()
    }

    pub(super) fn line(&self, row: usize) -> u64 {
        self.rows[row].1
    }

    /// A cell without the space around it.
    pub(super) fn cell(&self, row: usize, column: usize) -> &str {
        self.text[self.place(row, column)].trim()
    }

    fn place(&self, row: usize, column: usize) -> Range<usize> {
        let at = row * self.columns + column;
        let start = if column == 0 { self.rows[row].0 } else { self.ends[at - 1] + 1 };
        start..self.ends[at]
    }

    fn drop_empty_end(&mut self) {
        while let Some(last) = self.rows().checked_sub(1).filter(|last| *last > 0)
            && (0..self.columns).all(|column| self.cell(last, column).is_empty())
        {
            self.rows.pop();
            self.ends.truncate(last * self.columns);
        }
    }

    /// Writes numbers with a decimal comma with a point.
    fn read_decimal_commas(&mut self) -> Result<(), String> {
        let (mut commas, mut points) = (Vec::new(), None);
        for row in 1..self.rows() {
            for column in 0..self.columns {
                let cell = self.cell(row, column);
                let is_number = |text: &str| text.parse::<f64>().is_ok();
                let Some(at) = cell.find([',', '.']) else { continue };
                if cell.as_bytes()[at] == b'.' {
                    points = points.or_else(|| is_number(cell).then_some(row));
                } else if is_number(&cell.replacen(',', ".", 1)) {
                    let place = self.place(row, column);
                    let space = self.text[place.clone()].len() - self.text[place.clone()].trim_start().len();
                    commas.push((row, place.start + space + at));
                }
            }
        }
        if let (Some((comma, _)), Some(point)) = (commas.first(), points) {
            return Err(format!(
                "numbers have decimal commas (line {}) and decimal points (line {}); use one",
                self.line(*comma),
                self.line(point)
            ));
        }
        let mut bytes = std::mem::take(&mut self.text).into_bytes();
        commas.into_iter().for_each(|(_, at)| bytes[at] = b'.');
        self.text = String::from_utf8(bytes).expect("a comma's byte is no part of another character");
        Ok(())
    }

    /// Takes the first row for the names.
    fn with_names(mut self) -> (Vec<String>, Self) {
        if self.rows.is_empty() {
            return (Vec::new(), self);
        }
        let names = (0..self.columns).map(|column| self.cell(0, column).to_owned()).collect();
        self.rows.remove(0);
        self.ends.drain(..self.columns);
        (names, self)
    }

    /// Of a text without quotation marks.
    fn of_plain(text: String, delimiter: u8) -> Result<Self, String> {
        let bytes = text.as_bytes();
        let mut cells = Self { text: String::new(), columns: 0, rows: Vec::new(), ends: Vec::new() };
        let (mut start, mut line) = (0, 1);
        for at in memchr2_iter(delimiter, b'\n', bytes).chain((!bytes.ends_with(b"\n")).then_some(bytes.len())) {
            if bytes.get(at) == Some(&delimiter) {
                cells.ends.push(at);
                continue;
            }
            let end = if at > start && bytes[at - 1] == b'\r' { at - 1 } else { at };
            // An empty line has no cell before its end.
            if end > start {
                cells.ends.push(end);
                cells.end_row(start, line)?;
            }
            start = at + 1;
            line += 1;
        }
        cells.text = text;
        Ok(cells)
    }

    /// Of any text.
    fn of_quoted(text: &str, delimiter: u8) -> Result<Self, String> {
        let bytes = text.as_bytes();
        let mut builder = csv::ReaderBuilder::new();
        let mut reader = builder.delimiter(delimiter).has_headers(false).flexible(true).from_reader(bytes);
        let mut cells =
            Self { text: String::with_capacity(text.len()), columns: 0, rows: Vec::new(), ends: Vec::new() };
        let mut record = csv::StringRecord::new();
        loop {
            let line = line_of_row(bytes, reader.position());
            if !reader.read_record(&mut record).map_err(|why| format!("line {line} can't be read ({why})"))? {
                return Ok(cells);
            }
            let start = cells.text.len();
            for cell in &record {
                cells.text.push_str(cell);
                cells.ends.push(cells.text.len());
                cells.text.push('\n');
            }
            cells.end_row(start, line)?;
        }
    }

    /// Notes a row whose cells' ends were just added.
    fn end_row(&mut self, start: usize, line: u64) -> Result<(), String> {
        let len = self.ends.len() - self.rows.len() * self.columns;
        if self.rows.is_empty() {
            self.columns = len;
        } else if len != self.columns {
            return Err(format!("line {line} has {len} cells and the first line {}; correct it", self.columns));
        }
        self.rows.push((start, line));
        Ok(())
    }
}

/// Whether delimiters and ends of lines are all that there is to cells.
fn is_plain(bytes: &[u8]) -> bool {
    memchr(b'"', bytes).is_none() && memchr_iter(b'\r', bytes).all(|at| bytes.get(at + 1) == Some(&b'\n'))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn lines_are_the_files_own() {
        for (text, lines) in [
            ("a,b\n1,2\n\n\n3,4", vec![2, 5]),
            ("\r\n\r\na,b\r\n1,2\r\n\r\n3,4\r\n", vec![4, 6]),
            ("\na,\"b\"\n1,\"2\n2\"\n\n3,4\n", vec![3, 6]),
            ("a,\"b\"\r\n1,2\r\n\r\n3,4\r\n", vec![2, 4]),
        ] {
            let (names, cells) = CsvCells::read(text.as_bytes().to_vec()).unwrap();
            assert_eq!(names, ["a", "b"], "{text:?}");
            assert_eq!((0..cells.rows()).map(|row| cells.line(row)).collect::<Vec<_>>(), lines, "{text:?}");
            assert_eq!((cells.cell(0, 0), cells.cell(1, 1)), ("1", "4"), "{text:?}");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(256))]

        /// Cutting a plain text gives what the CSV reader gives.
        #[test]
        fn the_fast_way_is_the_long_way(text in "([a1, ä.-]{0,6}[,\n]|\r\n){0,40}[a1,]{0,3}") {
            prop_assert!(is_plain(text.as_bytes()));
            let seen = |cells: Result<CsvCells, String>| cells.map(|cells| {
                let lines: Vec<u64> = cells.rows.iter().map(|row| row.1).collect();
                let all: Vec<String> = (0..cells.rows())
                    .flat_map(|row| (0..cells.columns).map(move |column| (row, column)))
                    .map(|(row, column)| cells.cell(row, column).to_owned())
                    .collect();
                (lines, all)
            });
            prop_assert_eq!(seen(CsvCells::of_plain(text.clone(), b',')), seen(CsvCells::of_quoted(&text, b',')));
        }
    }
}
