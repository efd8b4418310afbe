//! Numbers by name, as stages of a study tell them to the page: `P7.phase_deg`.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

/// Names and finite numbers, in the names' order. What is not known is not there.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Numbers(pub BTreeMap<String, f64>);

impl Numbers {
    /// Sets a number that is known and finite; otherwise nothing.
    pub fn set(&mut self, name: impl Into<String>, value: impl Into<Option<f64>>) {
        if let Some(value) = value.into().filter(|value| value.is_finite()) {
            self.0.insert(name.into(), value);
        }
    }

    /// A number.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<f64> {
        self.0.get(name).copied()
    }

    /// Takes all of `others`, their names after `prefix` and a point.
    pub fn take(&mut self, prefix: &str, others: &Self) {
        self.0.extend(others.0.iter().map(|(name, value)| (format!("{prefix}.{name}"), *value)));
    }

    /// As a JSON file's text.
    #[must_use]
    pub fn to_text(&self) -> String {
        serde_json::to_string_pretty(self).expect("names and finite numbers") + "\n"
    }

    /// Reads a JSON file.
    ///
    /// # Errors
    /// A file that can't be read or holds something else; the words name it.
    pub fn read(path: &Path) -> Result<Self, String> {
        let text =
            std::fs::read_to_string(path).map_err(|why| format!("{}: cannot be read ({why})", path.display()))?;
        serde_json::from_str(&text).map_err(|why| format!("{}: holds no numbers by name ({why})", path.display()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_known_is_not_there() {
        let mut numbers = Numbers::default();
        numbers.set("a", f64::NAN);
        numbers.set("b", None);
        numbers.set("c", 2.0);
        let mut all = Numbers::default();
        all.take("x", &numbers);
        assert_eq!(all.0.into_iter().collect::<Vec<_>>(), [("x.c".to_owned(), 2.0)]);
    }
}
