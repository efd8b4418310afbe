//! Cells of a line, and the numbers in them.

use crate::wire::cell::{bare, is_missing, plain, with_decimal_comma};

/// What is between cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Separator {
    /// One of tab, `;` and `,`.
    Byte(u8),
    /// Any number of spaces and tabs.
    Space,
}

impl Separator {
    /// The one that makes most cells of a line of names; of equals tab, then `;`, then `,`; space where none occurs.
    pub(super) fn of_names(line: &[u8]) -> Self {
        let most = [b',', b';', b'\t'].map(Self::Byte).into_iter().max_by_key(|one| Cells::new(line, *one).count());
        match most {
            Some(one) if Cells::new(line, one).count() > 1 => one,
            _ if Cells::new(line, Self::Space).count() > 1 => Self::Space,
            _ => Self::Byte(b','),
        }
    }

    /// The one that makes so many cells of a line.
    pub(super) fn making(line: &[u8], cells: usize) -> Option<Self> {
        let all = [Self::Byte(b'\t'), Self::Byte(b';'), Self::Byte(b','), Self::Space];
        all.into_iter().find(|one| Cells::new(line, *one).count() == cells)
    }

    /// Whether numbers may have a decimal comma.
    pub(super) fn allows_comma(self) -> bool {
        self != Self::Byte(b',')
    }
}

/// The cells of a line, without space and double quotes around them.
pub(super) struct Cells<'a> {
    rest: Option<&'a [u8]>,
    separator: Separator,
    quotes: bool,
}

impl<'a> Cells<'a> {
    pub(super) fn new(line: &'a [u8], separator: Separator) -> Self {
        let line = if separator == Separator::Space { line.trim_ascii() } else { line };
        Self { rest: Some(line), separator, quotes: memchr::memchr(b'"', line).is_some() }
    }

    /// Where the next separator is that is not within double quotes.
    fn end(&self, rest: &[u8]) -> Option<usize> {
        if !self.quotes {
            return match self.separator {
                Separator::Byte(byte) => rest.iter().position(|&b| b == byte),
                Separator::Space => memchr::memchr2(b' ', b'\t', rest),
            };
        }
        let mut quoted = false;
        rest.iter().position(|&b| {
            quoted ^= b == b'"';
            !quoted
                && match self.separator {
                    Separator::Byte(byte) => b == byte,
                    Separator::Space => b == b' ' || b == b'\t',
                }
        })
    }
}

impl<'a> Iterator for Cells<'a> {
    type Item = &'a [u8];

    #[inline]
    fn next(&mut self) -> Option<&'a [u8]> {
        let rest = self.rest?;
        let Some(end) = self.end(rest) else {
            self.rest = None;
            return Some(bare(rest));
        };
        let after = &rest[end + 1..];
        self.rest = Some(if self.separator == Separator::Space { after.trim_ascii_start() } else { after });
        Some(bare(&rest[..end]))
    }
}

pub(super) fn names_of(line: &[u8], separator: Separator) -> Vec<String> {
    Cells::new(line, separator).map(|cell| String::from_utf8_lossy(cell).replace("\"\"", "\"")).collect()
}

/// Whether these are the same names in another order.
pub(super) fn is_other_order(names: &[String], before: &[String]) -> bool {
    let sorted = |names: &[String]| {
        let mut sorted = names.to_vec();
        sorted.sort_unstable();
        sorted
    };
    names != before && names.len() == before.len() && sorted(names) == sorted(before)
}

/// Reads cells as numbers, to the same bits as logs are read: a decimal point or, where commas separate no cells, a
/// decimal comma; not both in one stream.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Numbers {
    pub(super) comma_allowed: bool,
    point: bool,
    comma: bool,
}

impl Numbers {
    /// The number in a cell; NaN where it is missing, none where it is no finite number.
    #[inline]
    pub(super) fn read(&mut self, cell: &[u8]) -> Option<f64> {
        if let Some(number) = plain(cell) {
            if self.comma_allowed && cell.contains(&b'.') {
                if self.comma {
                    return None;
                }
                self.point = true;
            }
            return (!number.is_infinite()).then_some(number);
        }
        if is_missing(cell) {
            return Some(f64::NAN);
        }
        if !self.comma_allowed || self.point {
            return None;
        }
        let number = with_decimal_comma(cell)?;
        self.comma = true;
        Some(number)
    }
}

/// The count in a cell: `Some(None)` where it is missing, none where it is no whole number.
#[inline]
pub(super) fn count(cell: &[u8], numbers: &mut Numbers) -> Option<Option<u64>> {
    if let Some(count) = std::str::from_utf8(cell).ok().and_then(|text| text.parse().ok()) {
        return Some(Some(count));
    }
    let number = numbers.read(cell)?;
    // 2^53, up to which every whole number has its double.
    const MOST: f64 = 9_007_199_254_740_992.0;
    if number.is_nan() {
        return Some(None);
    }
    ((0.0..=MOST).contains(&number) && number.fract() == 0.0).then_some(Some(number as u64))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cells(line: &str, separator: Separator) -> Vec<&str> {
        Cells::new(line.as_bytes(), separator).map(|cell| std::str::from_utf8(cell).unwrap()).collect()
    }

    #[test]
    fn lines_are_cut_at_separators_outside_of_quotes() {
        assert_eq!(cells("1, 2 ,,\"4\"", Separator::Byte(b',')), ["1", "2", "", "4"]);
        assert_eq!(cells("a;\"b;c\";", Separator::Byte(b';')), ["a", "b;c", ""]);
        assert_eq!(cells("  1   2\t3 ", Separator::Space), ["1", "2", "3"]);
        assert_eq!(cells("", Separator::Space), [""]);
    }

    #[test]
    fn separators_are_found_in_the_first_line() {
        for (line, separator) in [
            ("time_s,P1 (V)", Separator::Byte(b',')),
            ("time_s\tP1\tP2", Separator::Byte(b'\t')),
            ("time_s;P1", Separator::Byte(b';')),
            ("time_s P1  P2", Separator::Space),
            ("P1", Separator::Byte(b',')),
        ] {
            assert_eq!(Separator::of_names(line.as_bytes()), separator, "{line}");
        }
        assert_eq!(Separator::making(b"1,5;2", 2), Some(Separator::Byte(b';')));
        assert_eq!(Separator::making(b"1 2", 3), None);
    }

    #[test]
    fn numbers_are_read_missing_or_refused() {
        let mut numbers = Numbers::default();
        for (text, number) in [("1", 1.0), ("-2.5e-3", -2.5e-3), ("+.5", 0.5), ("-0", 0.0)] {
            assert_eq!(numbers.read(text.as_bytes()), Some(number), "{text}");
        }
        for text in ["", "nan", "N/A", "NULL"] {
            assert!(numbers.read(text.as_bytes()).unwrap().is_nan(), "{text}");
        }
        for text in ["x", "inf", "1e999", "1,5", "0x1f", "\u{fffd}"] {
            assert_eq!(numbers.read(text.as_bytes()), None, "{text}");
        }
        let mut numbers = Numbers { comma_allowed: true, ..Numbers::default() };
        assert_eq!(numbers.read(b"-1,25e2"), Some(-125.0));
        assert_eq!((numbers.read(b"1.5"), numbers.read(b"3")), (None, Some(3.0)));
    }

    #[test]
    fn counts_are_whole() {
        let mut numbers = Numbers::default();
        for (text, read) in [("7", Some(Some(7))), ("7.0", Some(Some(7))), ("", Some(None))] {
            assert_eq!(count(text.as_bytes(), &mut numbers), read, "{text}");
        }
        for text in ["-1", "1.5", "1e300", "x"] {
            assert_eq!(count(text.as_bytes(), &mut numbers), None, "{text}");
        }
        assert_eq!(count(b"18446744073709551615", &mut numbers), Some(Some(u64::MAX)));
    }
}
