//! What one cell of text means: a number, missing, or neither; and whether a cell of `led` says on or off.
//!
//! Numbers have a decimal point or, where cells are not separated by commas, a decimal comma; not both in one file, and
//! no marks between thousands.

use lunula_live::wire::{self, is_missing, with_decimal_comma};

use crate::words::decimal_comma;

#[derive(Debug, Clone, Default)]
pub(in crate::log) struct Numbers {
    comma_allowed: bool,
    /// Whether a decimal point has been seen.
    point: bool,
    /// Whether a decimal comma has been seen.
    pub(in crate::log) comma: bool,
}

impl Numbers {
    /// For a file whose cells are separated by `delimiter`.
    pub(in crate::log) fn of(delimiter: u8) -> Self {
        Self { comma_allowed: delimiter != b',', ..Self::default() }
    }

    /// The number in a cell without space around it; NaN where it is missing.
    pub(in crate::log) fn read(&mut self, cell: &[u8]) -> Result<f64, String> {
        if cell.is_empty() {
            return Ok(f64::NAN);
        }
        if let Some(number) = std::str::from_utf8(cell).ok().and_then(|text| text.parse::<f64>().ok()) {
            if self.comma_allowed && cell.contains(&b'.') {
                self.point = true;
                self.one_kind(cell)?;
            }
            return if number.is_infinite() {
                Err(format!("`{}` is no finite number; correct it or leave it empty", shown(cell)))
            } else {
                Ok(number)
            };
        }
        if is_missing(cell) {
            return Ok(f64::NAN);
        }
        if self.comma_allowed
            && let Some(number) = with_decimal_comma(cell)
        {
            self.comma = true;
            self.one_kind(cell)?;
            return Ok(number);
        }
        let shown = shown(cell);
        Err(format!("`{shown}` is no number{}; correct it or leave it empty", decimal_comma(&shown)))
    }

    fn one_kind(&self, cell: &[u8]) -> Result<(), String> {
        if self.point && self.comma {
            return Err(format!(
                "`{}`: numbers have decimal points here and decimal commas there; use one",
                shown(cell)
            ));
        }
        Ok(())
    }
}

/// Whether the LED was on; none where it is missing.
pub(crate) fn led(cell: &[u8]) -> Result<Option<bool>, String> {
    wire::led(cell).map_err(|why| format!("`{}` is {why}; correct it", shown(cell)))
}

/// The text of a cell for a message, not too long.
pub(in crate::log) fn shown(cell: &[u8]) -> String {
    const MOST: usize = 40;
    let text = String::from_utf8_lossy(cell);
    if text.chars().count() <= MOST {
        return text.into_owned();
    }
    text.chars().take(MOST).chain("..".chars()).collect()
}

#[cfg(test)]
mod tests {
    use lunula_live::wire::bare;

    use super::*;

    #[test]
    fn numbers_are_read_missing_or_refused() {
        let mut numbers = Numbers::of(b',');
        for (text, number) in [("1", 1.0), ("-2.5e-3", -2.5e-3), ("+.5", 0.5), ("5.", 5.0), ("-0", 0.0)] {
            assert_eq!(numbers.read(text.as_bytes()).unwrap(), number, "{text}");
        }
        for text in ["", "nan", "NaN", "-nan", "NA", "n/a", "NULL", "#NV", "#BEZUG!", "#NOM?", "1.#QNAN", "-1.#IND00"] {
            assert!(numbers.read(text.as_bytes()).unwrap().is_nan(), "{text}");
        }
        for text in ["x", "1 V", "1,5", "inf", "-Infinity", "1e999", "0x1f", "--", "1.2.3"] {
            assert!(numbers.read(text.as_bytes()).unwrap_err().contains(&format!("`{text}`")), "{text}");
        }
        assert!(numbers.read(b"\xff1").is_err());
    }

    #[test]
    fn decimal_commas_are_read_where_they_separate_nothing_else() {
        let mut numbers = Numbers::of(b';');
        assert_eq!(numbers.read(b"3").unwrap(), 3.0);
        assert_eq!(numbers.read(b"-1,25e2").unwrap(), -125.0);
        assert!(numbers.comma);
        assert!(numbers.read(b"1.234,5").is_err() && numbers.read(b"1,2,3").is_err());
        assert!(numbers.read(b"1.5").unwrap_err().contains("decimal points here"));
        assert!(numbers.read(&[b','; 100]).is_err());
    }

    #[test]
    fn cells_are_bared_and_shown_shortly() {
        assert_eq!(bare(b"  \" 1.5 \" "), b"1.5");
        assert_eq!(bare(b"\""), b"\"");
        assert_eq!(shown(&[b'a'; 100]).len(), 42);
    }
}
