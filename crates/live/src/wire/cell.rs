//! Cells of text: bare of quotes, missing, names, with a decimal comma, and whether an LED was on.

/// The words that say that a number is missing, without regard to case.
const MISSING: [&str; 7] = ["nan", "na", "n/a", "null", "#n/a", "#nv", "#n/d"];
/// What Windows' C library writes for it, as `-1.#IND` and `nan(ind)`.
const NO_NUMBER: [&str; 4] = ["#ind", "#qnan", "#snan", "nan(ind)"];

/// A cell without space and double quotes around it.
#[must_use]
pub fn bare(cell: &[u8]) -> &[u8] {
    let cell = cell.trim_ascii();
    match cell {
        [b'"', inside @ .., b'"'] => inside.trim_ascii(),
        _ => cell,
    }
}

/// Whether a cell may be a name: it does not look like a number, nor like something cut off from one.
#[must_use]
pub fn is_name(cell: &str) -> bool {
    !cell.is_empty()
        && cell.replace(',', ".").parse::<f64>().is_err()
        && !cell.starts_with(|c: char| c.is_ascii_digit())
}

/// Whether a cell is empty or says that nothing is known.
#[must_use]
pub fn is_missing(cell: &[u8]) -> bool {
    let is = |word: &&str, of: &[u8]| of.eq_ignore_ascii_case(word.as_bytes());
    let is_no_number = |word: &&str| cell.windows(word.len()).any(|part| is(word, part));
    cell.is_empty()
        || MISSING.iter().any(|word| is(word, cell))
        // A spreadsheet's error, in any language: `#VALUE!`, `#BEZUG!`, `#NOM?`.
        || cell.starts_with(b"#") && cell.ends_with(b"!")
        || cell.starts_with(b"#") && cell.ends_with(b"?")
        || NO_NUMBER.iter().any(is_no_number)
}

/// Whether the LED was on; none where it is missing.
///
/// # Errors
/// The cell is neither on nor off.
pub fn led(cell: &[u8]) -> Result<Option<bool>, NeitherOnNorOff> {
    const ON: [&[u8]; 4] = [b"1", b"1.0", b"true", b"on"];
    const OFF: [&[u8]; 4] = [b"0", b"0.0", b"false", b"off"];
    if ON.iter().any(|word| cell.eq_ignore_ascii_case(word)) {
        return Ok(Some(true));
    }
    if OFF.iter().any(|word| cell.eq_ignore_ascii_case(word)) {
        return Ok(Some(false));
    }
    if is_missing(cell) {
        return Ok(None);
    }
    // `1.000` of programs that write all columns alike.
    plain(cell)
        .or_else(|| with_decimal_comma(cell))
        .filter(|number| !number.is_nan())
        .map_or(Err(NeitherOnNorOff), led_of)
}

/// Whether the LED was on by a number; none where it is NaN.
///
/// # Errors
/// The number is neither 1 nor 0.
pub fn led_of(number: f64) -> Result<Option<bool>, NeitherOnNorOff> {
    match number {
        1.0 => Ok(Some(true)),
        0.0 => Ok(Some(false)),
        number if number.is_nan() => Ok(None),
        _ => Err(NeitherOnNorOff),
    }
}

/// The number that Rust reads in a cell.
pub(in crate::wire) fn plain(cell: &[u8]) -> Option<f64> {
    std::str::from_utf8(cell).ok()?.parse().ok()
}

/// The finite number in a cell with a decimal comma.
#[must_use]
pub fn with_decimal_comma(cell: &[u8]) -> Option<f64> {
    // Longer than any number that a program writes.
    let mut text = [0; 64];
    let text = text.get_mut(..cell.len())?;
    text.copy_from_slice(cell);
    let comma = text.iter().position(|&b| b == b',')?;
    text[comma] = b'.';
    plain(text).filter(|number| number.is_finite())
}

/// A cell of `led` that is neither 1 (on) nor 0 (off).
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("neither 1 (on) nor 0 (off)")]
pub struct NeitherOnNorOff;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_led_is_on_or_off() {
        for (text, on) in [("1", true), ("0", false), ("True", true), ("OFF", false), ("1.000", true), ("0,0", false)] {
            assert_eq!(led(text.as_bytes()), Ok(Some(on)), "{text}");
        }
        assert_eq!(led(b""), Ok(None));
        for text in ["2", "0.5", "-1", "yes", "x"] {
            assert_eq!(led(text.as_bytes()), Err(NeitherOnNorOff), "{text}");
        }
    }
}
