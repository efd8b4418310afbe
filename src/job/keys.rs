//! What a recording is of: `subject`, `session`, `pose` and whatever else a table's columns or a pattern's places say.

use std::collections::BTreeMap;
use std::fmt;

use serde::{Deserialize, Serialize};

/// Names and values, in the names' order: `session=2 subject=S01`.
#[derive(Debug, Clone, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct Keys(pub BTreeMap<String, String>);

impl Keys {
    /// The value of a name.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<&str> {
        self.0.get(name).map(String::as_str)
    }

    /// Only these names, those of them that it has.
    #[must_use]
    pub fn only<'a>(&self, names: impl IntoIterator<Item = &'a str>) -> Self {
        Self(names.into_iter().filter_map(|name| Some((name.to_owned(), self.0.get(name)?.clone()))).collect())
    }

    /// The values of all other names, joined by spaces; none where there are no others.
    #[must_use]
    pub fn others(&self, name: &str) -> Option<String> {
        let others: Vec<&str> =
            self.0.iter().filter(|(own, _)| *own != name).map(|(_, value)| value.as_str()).collect();
        (!others.is_empty()).then(|| others.join(" "))
    }

    /// Do both say the same where they speak of the same?
    #[must_use]
    pub fn agree(&self, other: &Self) -> bool {
        self.0.iter().all(|(name, value)| other.0.get(name).is_none_or(|theirs| theirs == value))
    }

    /// Both together; where both speak of a name they agree, or the other's value stands.
    #[must_use]
    pub fn and(&self, other: &Self) -> Self {
        Self(self.0.iter().chain(&other.0).map(|(name, value)| (name.clone(), value.clone())).collect())
    }
}

impl fmt::Display for Keys {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let said: Vec<String> = self.0.iter().map(|(name, value)| format!("{name}={value}")).collect();
        f.write_str(&said.join(" "))
    }
}
