//! The keys that a stage was given, taken one by one: each of the right type and within its range, and none left over.

use std::fmt::Display;

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
        assert!(told(given("a = 'yes'").flag("a").unwrap_err()).contains("true or false"));
        assert!(told(given("a = [1]").names("a").unwrap_err()).contains("`1`"));
        assert!(told(given("a = 'left'").choice("a", &[("up", 1), ("down", 2)]).unwrap_err()).contains("up, down"));
        let unknown = Given::new("b = 1".parse().unwrap(), &["a"]).err().unwrap();
        assert_eq!((unknown.key.as_str(), unknown.what.as_str()), ("b", "is no key of this job; it knows a"));
    }
}
