//! Choices by a word, the same on the command line and in pipeline files.
//!
//! A choice lists its words once ([`Words::WORDS`]).

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

use lunula_live::wire::with_decimal_comma;
use unicode_normalization::UnicodeNormalization;

/// Each of `all` once, in the order in which they first appear.
pub fn in_order<T: PartialEq>(all: impl IntoIterator<Item = T>) -> Vec<T> {
    grouped(all.into_iter().map(|one| (one, ()))).into_iter().map(|(one, _)| one).collect()
}

/// What has the same key together, in the order in which keys first appear.
pub(crate) fn grouped<K: PartialEq, V>(all: impl IntoIterator<Item = (K, V)>) -> Vec<(K, Vec<V>)> {
    let mut groups: Vec<(K, Vec<V>)> = Vec::new();
    for (key, one) in all {
        match groups.iter_mut().find(|(known, _)| *known == key) {
            Some((_, group)) => group.push(one),
            None => groups.push((key, vec![one])),
        }
    }
    groups
}

/// A choice of few, each with a word.
pub trait Words: Copy + PartialEq + Send + Sync + 'static {
    /// Each choice, its word and what it means; the meaning may be empty.
    const WORDS: &'static [(Self, &'static str, &'static str)];

    /// All, in the order of their words.
    fn all() -> impl Iterator<Item = Self> {
        Self::WORDS.iter().map(|one| one.0)
    }

    /// As the command line and pipeline files have it.
    #[must_use]
    fn word(self) -> &'static str {
        Self::WORDS.iter().find(|one| one.0 == self).map_or("", |one| one.1)
    }

    /// The choice of a word.
    ///
    /// # Errors
    /// Another word, with those that there are.
    fn by_word(text: &str) -> Result<Self, String> {
        Self::WORDS.iter().find(|one| one.1 == text).map(|one| one.0).ok_or_else(|| {
            let words: Vec<&str> = Self::WORDS.iter().map(|one| one.1).collect();
            let (last, before) = words.split_last().map_or(("", &[][..]), |(last, before)| (*last, before));
            format!("`{text}`: choose {} or {last}", before.join(", "))
        })
    }
}

/// A number with so many decimals; what rounds to zero has no sign.
#[must_use]
pub fn fixed(value: f64, places: usize) -> String {
    let text = format!("{value:.places$}");
    match text.strip_prefix('-') {
        Some(rest) if rest.bytes().all(|b| b == b'0' || b == b'.') => rest.to_owned(),
        _ => text,
    }
}

/// What to add to the refusal of a number that has a decimal comma: one that stands in quotes, between commas.
#[must_use]
pub(crate) fn decimal_comma(text: &str) -> &'static str {
    if with_decimal_comma(text.as_bytes()).is_some() {
        " (where commas part the cells, a decimal has a point)"
    } else {
        ""
    }
}

/// The known name from which `name` differs by a slip of the finger: a letter, or one in three.
#[must_use]
pub fn nearest<'a>(name: &str, known: &[&'a str]) -> Option<&'a str> {
    let lower = name.to_lowercase();
    let slips = 1.max(name.chars().count() / 3);
    let nearest = known.iter().map(|k| (strsim::osa_distance(&lower, &k.to_lowercase()), *k));
    nearest.min_by_key(|(distance, _)| *distance).filter(|(distance, _)| *distance <= slips).map(|(_, known)| known)
}

/// A name with its accents as they are typed: each with its letter one character.
pub(crate) fn composed(name: &str) -> String {
    name.nfc().collect()
}

/// What makes names alike of which some have their accents apart.
pub(crate) const COMPOSE: &str = "`convmv -f utf8 -t utf8 --nfc -r --notest FOLDER` encodes all in one way";

/// A name without what a slip of the finger changes first, case and spaces, and its accents as they are typed.
pub(crate) fn plain(name: &str) -> String {
    composed(name).chars().filter(|c| !c.is_whitespace()).flat_map(char::to_lowercase).collect()
}

/// As [`plain`], without the zeros in front of numbers, which spreadsheets take away: `s01` and `S1` are one, `s1` and
/// `s10`, `0.05` and `0.5` are not.
fn unpadded(name: &str) -> String {
    let name = plain(name);
    let mut left = String::with_capacity(name.len());
    let mut rest = name.chars().peekable();
    while let Some(c) = rest.next() {
        let mut before = left.chars().rev();
        let is_within = match before.next() {
            Some('.' | ',') => before.next().is_some_and(|c| c.is_ascii_digit()),
            last => last.is_some_and(|c| c.is_ascii_digit()),
        };
        let is_in_front = c == '0' && !is_within && rest.peek().is_some_and(char::is_ascii_digit);
        if !is_in_front {
            left.push(c);
        }
    }
    left
}

/// Digits of numbers that are compared as numbers: of more, which only names have, some numbers are one to the machine.
const DIGITS: usize = 15;

/// Whether two values of `key` say the same, written otherwise: but for case, spaces and zeros in front of numbers, as
/// numbers (`1` and `1.0`), or where one of them is a number and the other has the key before it (`1` and `Rep1`,
/// `rep. 01` of `repetition`).
pub(crate) fn say_the_same(key: &str, one: &str, other: &str) -> bool {
    let key = plain(key);
    let [one, other] = [one, other].map(unpadded);
    one == other || [(&one, &other), (&other, &one)].iter().any(|(number, other)| is_number(number, other, &key))
}

/// The number that a text is.
fn number(text: &str) -> Option<f64> {
    text.parse::<f64>().ok().filter(|number| number.is_finite() && text.len() <= DIGITS)
}

/// Whether a text is the same number as another, before which the key or its beginning may be written.
fn is_number(text: &str, other: &str, key: &str) -> bool {
    let Some(value) = number(text) else { return false };
    let word = other.trim_start_matches(char::is_alphabetic);
    let (before, rest) = other.split_at(other.len() - word.len());
    let is_of_key = !before.is_empty() && key.starts_with(before);
    let after = if is_of_key { unpadded(rest.trim_start_matches(['_', '-', '.', ':', '#'])) } else { other.to_owned() };
    number(&after) == Some(value)
}

/// A warning where two names of what there is one of, `Anna` and `anna`, `1`, `01` and `1.0`, differ in case, spaces,
/// how a number is written or the encoding of accents only.
pub(crate) fn twins<'a>(what: &str, names: impl IntoIterator<Item = &'a str>) -> Option<String> {
    let mut seen: BTreeMap<String, BTreeSet<&str>> = BTreeMap::new();
    for name in names {
        let key = unpadded(name);
        let key = number(&key).filter(|_| key.contains('.')).map_or(key, |number| number.to_string());
        seen.entry(key).or_default().insert(name);
    }
    let twins: Vec<BTreeSet<&str>> = seen.into_values().filter(|alike| alike.len() > 1).collect();
    let has_accents_apart = twins.iter().flatten().any(|name| composed(name) != *name);
    let is_padded = |alike: &BTreeSet<&str>| alike.iter().map(|name| plain(name)).collect::<BTreeSet<_>>().len() > 1;
    let has_zeros = twins.iter().any(is_padded);
    let names = |alike: &BTreeSet<&str>| {
        alike.iter().map(|name| format!("`{}`", shown(name))).collect::<Vec<_>>().join(" and ")
    };
    let names: Vec<String> = twins.iter().map(names).collect();
    let by = match (has_zeros, has_accents_apart) {
        (false, false) => "case or spaces",
        (true, false) => "case, spaces or how numbers are written",
        (false, true) => "case, spaces or the encoding of accents",
        (true, true) => "case, spaces, how numbers are written or the encoding of accents",
    };
    let compose = if has_accents_apart { format!(" {COMPOSE}") } else { String::new() };
    (!twins.is_empty()).then(|| {
        format!("{what} {} differ in {by} only, and count apart: are they the same?{compose}", names.join(", "))
    })
}

/// What to write instead of an unknown `name`: the nearest, or the choice.
#[must_use]
pub fn instead(name: &str, known: &[&str]) -> String {
    match nearest(name, known) {
        Some(known) => format!("did you mean `{known}`?"),
        None if known.is_empty() => "none is defined".to_owned(),
        None => format!("known: {}", known.join(", ")),
    }
}

/// A name from outside as a terminal may show it: control characters, which could move its cursor or hide what it
/// shows, are escaped as in Rust (`\\u{1b}`). Line breaks are too; [`shown_lines`] keeps them.
#[must_use]
pub fn shown(name: &str) -> Cow<'_, str> {
    escaped(name, |c| c.is_control())
}

/// As [`shown`], of a message that may have several lines.
#[must_use]
pub fn shown_lines(message: &str) -> Cow<'_, str> {
    escaped(message, |c| c.is_control() && c != '\n')
}

fn escaped(text: &str, hidden: impl Fn(char) -> bool) -> Cow<'_, str> {
    if !text.contains(&hidden) {
        return Cow::Borrowed(text);
    }
    let mut clear = String::with_capacity(text.len() + 8);
    for c in text.chars() {
        if hidden(c) { clear.extend(c.escape_default()) } else { clear.push(c) }
    }
    Cow::Owned(clear)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, Clone, Copy, PartialEq)]
    enum Side {
        Left,
        Right,
    }

    impl Words for Side {
        const WORDS: &'static [(Self, &'static str, &'static str)] =
            &[(Self::Left, "left", ""), (Self::Right, "right", "the other")];
    }

    #[test]
    fn control_characters_are_shown_not_obeyed() {
        assert_eq!(shown("a\u{1b}[2Jb\n\u{9b}é 指"), "a\\u{1b}[2Jb\\n\\u{9b}é 指");
        assert_eq!(shown_lines("one\n  two\r"), "one\n  two\\r");
        assert!(matches!(shown("plain"), Cow::Borrowed("plain")));
    }

    #[test]
    fn accents_are_put_together_with_their_letters() {
        assert_eq!(composed("Zoe\u{308} S\u{30c}imu\u{30a}nek, \u{308}"), "Zoë Šimůnek, \u{308}");
        let said = twins("subjects", ["Zoe\u{308}", "Zo\u{eb}", "Zoe"]).unwrap_or_default();
        assert!(
            said.starts_with("subjects `Zoe\u{308}` and `Zo\u{eb}` differ in case, spaces or the encoding"),
            "{said}"
        );
        assert_eq!(twins("subjects", ["Zoe", "Zo\u{eb}", "Zoa\u{308}"]), None);
    }

    #[test]
    fn zeros_in_front_of_numbers_make_no_other_name() {
        let said = |names: &[&str]| twins("subjects", names.iter().copied()).unwrap_or_default();
        let zeros = "differ in case, spaces or how numbers are written only, and count apart: are they the same?";
        let alike = [["01", "1"], ["S1", "s01"], ["0", "00"], ["p003_b", "p3_b"], ["s 007", "s07"], ["1", "1.0"]];
        for [one, other] in alike {
            assert_eq!(said(&[one, other, "s11", "10"]), format!("subjects `{one}` and `{other}` {zeros}"));
        }
        assert_eq!(said(&["s1", "s10", "s11", "s100", "s101", "1", "10", "0.05", "0.5", "1,05", "1,5", "0", "s0"]), "");
        assert_eq!(
            said(&["S1", "s1"]),
            "subjects `S1` and `s1` differ in case or spaces only, and count apart: are they the same?"
        );
    }

    #[test]
    fn values_that_are_one_number_say_the_same() {
        let same = |one: &str, other: &str| {
            let both = [(one, other), (other, one)].map(|(one, other)| say_the_same("Repetition", one, other));
            assert_eq!(both[0], both[1], "{one} {other}");
            both[0]
        };
        for other in ["1", "01", "1.0", " 1", "001.00", "Rep1", "rep_01", "Rep. 1", "repetition 1", "R1.0"] {
            assert!(same("1", other), "{other}");
        }
        for (one, other) in [("S01", "s1"), ("S1", "S 001"), ("Anna", "anna"), ("0.50", "0.5"), ("-1", "-1.0")] {
            assert!(same(one, other), "{one} {other}");
        }
        for (one, other) in [
            ("S01", "S02"),
            ("day_a", "day_b"),
            ("1", "10"),
            ("1", "-1"),
            ("1", "cal1"),
            ("1", "Rep1b"),
            ("1", "Rep"),
            ("Rep1", "S1"),
            ("0.05", "0.5"),
            ("", "Rep"),
            ("inf", "infinity"),
            ("12345678901234567890", "12345678901234567891"),
        ] {
            assert!(!same(one, other), "{one} {other}");
        }
    }

    #[test]
    fn what_rounds_to_zero_has_no_sign() {
        assert_eq!([-0.0, -4e-5, -6e-5].map(|value| fixed(value, 4)), ["0.0000", "0.0000", "-0.0001"]);
        assert_eq!((fixed(-0.4, 0), fixed(f64::NEG_INFINITY, 1)), ("0".to_owned(), "-inf".to_owned()));
    }

    #[test]
    fn words_name_choices_and_unknown_ones_list_them() {
        assert_eq!((Side::by_word("right"), Side::Right.word()), (Ok(Side::Right), "right"));
        assert_eq!(Side::by_word("up").unwrap_err(), "`up`: choose left or right");
    }
}
