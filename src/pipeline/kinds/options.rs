//! A stage's keys into a job's options: what is wrong is told of the key that it is wrong with.

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::job::{self, OptionFault};
use crate::pipeline::kind::{Demand, KeyFault};
use crate::words::instead;

/// A fault of a key.
pub(super) fn fault(key: &str, what: impl Into<String>) -> KeyFault {
    KeyFault { key: key.to_owned(), what: what.into() }
}

/// Reads a stage's keys as the options of a command.
///
/// # Errors
/// The first that is wrong, by name.
pub(super) fn request<R: clap::Args>(table: &toml::Table) -> Result<R, KeyFault> {
    job::read(table, "this job").map_err(|OptionFault { key, what }| KeyFault { key, what })
}

/// Reads a stage's keys; `T` has a value for each that is not there.
///
/// # Errors
/// A key that there is not, or a value that can't be: the first, by name.
pub(super) fn read<T: DeserializeOwned>(known: &[&str], table: toml::Table) -> Result<T, KeyFault> {
    for (key, value) in &table {
        if !known.contains(&key.as_str()) {
            return Err(unknown(known, key));
        }
        // Alone, so that what is wrong is wrong with it.
        let alone = toml::Table::from_iter([(key.clone(), value.clone())]);
        if let Err(why) = T::deserialize(alone) {
            return Err(fault(key, why.message()));
        }
    }
    T::deserialize(table).map_err(|why| fault("", why.message()))
}

fn unknown(known: &[&str], key: &str) -> KeyFault {
    let what = if known.is_empty() { "this job has none".to_owned() } else { instead(key, known) };
    fault(key, format!("there is no such option; {what}"))
}

/// Checks whole numbers: each with its key and the most that it may be.
///
/// # Errors
/// The first that is 0 or more than that.
pub(super) fn counts(all: &[(&str, u32, u32)]) -> Result<(), KeyFault> {
    match all.iter().find(|(_, value, most)| *value == 0 || value > most) {
        Some((key, value, most)) => Err(fault(key, format!("{value}: choose 1 to {most}"))),
        None => Ok(()),
    }
}

/// What results hang on: the keys, and those parts that are made only where they are wanted.
pub(super) fn told(keys: &impl Serialize, demand: &Demand, if_wanted: &[&str]) -> serde_json::Value {
    let mut told = serde_json::to_value(keys).expect("plain data with names as keys");
    for part in if_wanted {
        told[*part] = demand.parts.contains(*part).into();
    }
    told
}

#[cfg(test)]
mod tests {
    use serde::Deserialize;

    use super::*;

    #[derive(Debug, Default, Deserialize)]
    #[serde(default)]
    struct Two {
        first: u16,
        second: Vec<String>,
    }

    #[test]
    fn what_is_wrong_is_told_of_its_key() {
        let told = |text: &str| read::<Two>(&["first", "second"], toml::from_str(text).unwrap());
        let good = told("first = 3").unwrap();
        assert_eq!((good.first, good.second.len()), (3, 0));
        for (text, key, what) in [
            ("frist = 1", "frist", "did you mean `first`?"),
            ("other_thing = 1", "other_thing", "known: first, second"),
            ("first = -1\nsecond = []", "first", "-1"),
            ("first = 1\nsecond = 1", "second", "sequence"),
        ] {
            let fault = told(text).unwrap_err();
            assert!(fault.key == key && fault.what.contains(what), "{text}: {fault:?}");
        }
    }
}
