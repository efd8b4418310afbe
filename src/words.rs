//! Choices by a word, the same on the command line and in pipeline files.
//!
//! A choice lists its words once ([`Words::WORDS`]); serde reads and writes it with `#[serde(with = "crate::words")]`.

use std::borrow::Cow;

use serde::{Deserialize, Deserializer, Serializer};

/// A choice of few, each with a word.
pub trait Words: Copy + PartialEq + Send + Sync + 'static {
    /// Each choice, its word and what it means; the meaning may be empty.
    const WORDS: &'static [(Self, &'static str, &'static str)];

    /// Its word.
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

/// The known name from which `name` differs by a slip of the finger: a letter, or one in three.
#[must_use]
pub fn nearest<'a>(name: &str, known: &[&'a str]) -> Option<&'a str> {
    let lower = name.to_lowercase();
    let slips = 1.max(name.chars().count() / 3);
    let nearest = known.iter().map(|k| (strsim::osa_distance(&lower, &k.to_lowercase()), *k));
    nearest.min_by_key(|(distance, _)| *distance).filter(|(distance, _)| *distance <= slips).map(|(_, known)| known)
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

/// Writes the word.
///
/// # Errors
/// The serializer's.
pub fn serialize<T: Words, S: Serializer>(choice: &T, to: S) -> Result<S::Ok, S::Error> {
    to.serialize_str(choice.word())
}

/// Reads a word.
///
/// # Errors
/// No text, or a word that there is not.
pub fn deserialize<'de, T: Words, D: Deserializer<'de>>(from: D) -> Result<T, D::Error> {
    T::by_word(&String::deserialize(from)?).map_err(serde::de::Error::custom)
}

/// A choice that need not be made: `#[serde(with = "crate::words::optional")]`.
pub mod optional {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    use super::Words;

    /// Writes the word.
    ///
    /// # Errors
    /// The serializer's.
    pub fn serialize<T: Words, S: Serializer>(choice: &Option<T>, to: S) -> Result<S::Ok, S::Error> {
        choice.map(T::word).serialize(to)
    }

    /// Reads a word.
    ///
    /// # Errors
    /// No text, or a word that there is not.
    pub fn deserialize<'de, T: Words, D: Deserializer<'de>>(from: D) -> Result<Option<T>, D::Error> {
        let word = Option::<String>::deserialize(from)?;
        word.map(|word| T::by_word(&word)).transpose().map_err(serde::de::Error::custom)
    }
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

    #[derive(Debug, serde::Serialize, Deserialize)]
    struct Turn {
        #[serde(with = "crate::words")]
        to: Side,
    }

    #[test]
    fn words_name_choices_and_unknown_ones_list_them() {
        let read: Turn = toml::from_str("to = \"right\"").unwrap();
        assert_eq!((read.to, serde_json::to_string(&read).unwrap().as_str()), (Side::Right, "{\"to\":\"right\"}"));
        assert_eq!(Side::by_word("up").unwrap_err(), "`up`: choose left or right");
        assert!(toml::from_str::<Turn>("to = \"up\"").unwrap_err().to_string().contains("choose left or right"));
    }
}
