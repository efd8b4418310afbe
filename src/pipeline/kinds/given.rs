//! The keys that a stage was given, taken one by one: each of the right type and within its range, and none left over.

use std::fmt::Display;
use std::ops::RangeInclusive;

use toml::Value;

use crate::pipeline::KeyFault;

/// What is left of a stage's keys.
pub(super) struct Given {
    table: toml::Table,
}

impl Given {
    /// A stage's keys, of which all are `known`.
    pub(super) fn new(table: toml::Table, known: &[&str]) -> Result<Self, KeyFault> {
        match table.keys().find(|key| !known.contains(&key.as_str())) {
            None => Ok(Self { table }),
            Some(key) if known.is_empty() => Err(fault(key, "is no key of this job, which has no options")),
            Some(key) => Err(fault(key, format!("is no key of this job; it knows {}", known.join(", ")))),
        }
    }

    /// `true` or `false`; `false` where it is not given.
    pub(super) fn flag(&mut self, key: &str) -> Result<bool, KeyFault> {
        match self.table.remove(key) {
            None => Ok(false),
            Some(Value::Boolean(flag)) => Ok(flag),
            Some(other) => Err(fault(key, format!("is {}; write true or false", shown(&other)))),
        }
    }

    /// A number, whole or not, within a range.
    pub(super) fn number(&mut self, key: &str, range: RangeInclusive<f64>) -> Result<Option<f64>, KeyFault> {
        let Some(value) = self.table.remove(key) else { return Ok(None) };
        let number = match value {
            Value::Integer(number) => Some(number as f64),
            Value::Float(number) => Some(number),
            _ => None,
        };
        match number.filter(|number| number.is_finite() && range.contains(number)) {
            Some(number) => Ok(Some(number)),
            None if range.contains(&f64::MAX) && range.contains(&f64::MIN) => {
                Err(fault(key, format!("is {}; write a number, such as 0.5", shown(&value))))
            }
            None => {
                let (low, high) = (range.start(), range.end());
                let within =
                    if *high == f64::MAX { format!("of at least {low}") } else { format!("of {low} to {high}") };
                Err(fault(key, format!("is {}; write a number {within}", shown(&value))))
            }
        }
    }

    /// A whole number within a range.
    pub(super) fn whole(&mut self, key: &str, range: RangeInclusive<u64>) -> Result<Option<u64>, KeyFault> {
        let Some(value) = self.table.remove(key) else { return Ok(None) };
        let number = value.as_integer().and_then(|number| u64::try_from(number).ok());
        match number.filter(|number| range.contains(number)) {
            Some(number) => Ok(Some(number)),
            None => {
                let (low, high) = (range.start(), range.end());
                Err(fault(key, format!("is {}; write a whole number of {low} to {high}", shown(&value))))
            }
        }
    }

    /// A text.
    pub(super) fn text(&mut self, key: &str) -> Result<Option<String>, KeyFault> {
        match self.table.remove(key) {
            None => Ok(None),
            Some(Value::String(text)) if !text.is_empty() => Ok(Some(text)),
            Some(other) => Err(fault(key, format!("is {}; write a text in quotes", shown(&other)))),
        }
    }

    /// A text that says something, as the command line takes it.
    pub(super) fn parsed<T>(
        &mut self,
        key: &str,
        parse: impl FnOnce(&str) -> Result<T, String>,
    ) -> Result<Option<T>, KeyFault> {
        let Some(text) = self.text(key)? else { return Ok(None) };
        parse(&text).map(Some).map_err(|what| fault(key, format!("`{text}`: {what}")))
    }

    /// Names, or one.
    pub(super) fn names(&mut self, key: &str) -> Result<Vec<String>, KeyFault> {
        let wrong = |value: &Value| fault(key, format!("is {}; write names, as [\"J2\", \"J3\"]", shown(value)));
        match self.table.remove(key) {
            None => Ok(Vec::new()),
            Some(Value::String(name)) if !name.is_empty() => Ok(vec![name]),
            Some(Value::Array(names)) => {
                let name = |value: &Value| match value {
                    Value::String(name) if !name.is_empty() => Ok(name.clone()),
                    other => Err(wrong(other)),
                };
                names.iter().map(name).collect()
            }
            Some(other) => Err(wrong(&other)),
        }
    }

    /// One of a few words.
    pub(super) fn choice<T: Copy>(&mut self, key: &str, choices: &[(&str, T)]) -> Result<Option<T>, KeyFault> {
        let Some(value) = self.table.remove(key) else { return Ok(None) };
        let chosen = value.as_str().and_then(|word| choices.iter().find(|(known, _)| *known == word));
        match chosen {
            Some((_, choice)) => Ok(Some(*choice)),
            None => {
                let words: Vec<&str> = choices.iter().map(|(word, _)| *word).collect();
                Err(fault(key, format!("is {}; choose {}", shown(&value), words.join(", "))))
            }
        }
    }
}

/// A fault of a key.
pub(super) fn fault(key: &str, what: impl Display) -> KeyFault {
    KeyFault { key: key.to_owned(), what: what.to_string() }
}

/// A value as it stands in the file.
fn shown(value: &Value) -> String {
    match value {
        Value::Table(_) => "a table".to_owned(),
        other => format!("`{other}`"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn given(text: &str) -> Given {
        Given::new(text.parse().unwrap(), &["a"]).unwrap()
    }

    #[test]
    fn values_are_taken_as_they_stand() {
        assert_eq!(given("a = 3").number("a", 0.0..=5.0).unwrap(), Some(3.0));
        assert_eq!(given("").number("a", 0.0..=5.0).unwrap(), None);
        assert_eq!(given("a = 3").whole("a", 0..=5).unwrap(), Some(3));
        assert!(given("a = true").flag("a").unwrap() && !given("").flag("a").unwrap());
        assert_eq!(given("a = 'J2'").names("a").unwrap(), ["J2"]);
        assert_eq!(given("a = ['J2', 'J3']").names("a").unwrap(), ["J2", "J3"]);
        assert_eq!(given("a = 'up'").choice("a", &[("up", 1), ("down", 2)]).unwrap(), Some(1));
    }

    #[test]
    fn what_is_wrong_names_the_key_and_what_to_write() {
        let told = |fault: KeyFault| {
            assert_eq!(fault.key, "a");
            fault.what
        };
        assert_eq!(told(given("a = 9").number("a", 0.0..=5.0).unwrap_err()), "is `9`; write a number of 0 to 5");
        assert!(told(given("a = nan").number("a", f64::MIN..=f64::MAX).unwrap_err()).contains("such as 0.5"));
        assert!(told(given("a = -1").whole("a", 0..=5).unwrap_err()).contains("whole number of 0 to 5"));
        assert!(told(given("a = 'yes'").flag("a").unwrap_err()).contains("true or false"));
        assert!(told(given("a = [1]").names("a").unwrap_err()).contains("`1`"));
        assert!(told(given("a = 'left'").choice("a", &[("up", 1), ("down", 2)]).unwrap_err()).contains("up, down"));
        let unknown = Given::new("b = 1".parse().unwrap(), &["a"]).err().unwrap();
        assert_eq!((unknown.key.as_str(), unknown.what.as_str()), ("b", "is no key of this job; it knows a"));
    }
}
