//! All that is wrong with a request.

use std::fmt;

/// All that is wrong with the options.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Faults(pub Vec<String>);

impl Faults {
    /// Notes what is wrong where something that is needed does not hold.
    pub(in crate::phantom) fn need(&mut self, holds: bool, what: impl FnOnce() -> String) {
        if !holds {
            self.0.push(what());
        }
    }

    /// Notes an option whose value is out of its range.
    pub(in crate::phantom) fn range(&mut self, option: &str, value: f64, low: f64, high: f64, unit: &str) {
        self.need((low..=high).contains(&value), || format!("{option} {value}: choose {low} to {high}{unit}"));
    }

    /// Nothing, where nothing is wrong.
    pub fn none(self) -> Result<(), Self> {
        if self.0.is_empty() { Ok(()) } else { Err(self) }
    }
}

impl fmt::Display for Faults {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0.join("; "))
    }
}

impl std::error::Error for Faults {}
