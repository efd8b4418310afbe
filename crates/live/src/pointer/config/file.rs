//! The text of `mouse.toml` to a [`Config`], and what is wrong with it, by line.

use std::fmt;
use std::str::FromStr;

use serde::Deserialize;
use toml::de::{DeTable, DeValue};

use super::Config;
use crate::words::instead;

/// Faults that are named of one file (assumed: who corrects so many looks again).
const MOST: usize = 100;

/// What is wrong with one key.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ConfigFault {
    /// The key; none where the text is not TOML.
    pub key: Option<String>,
    /// Its line in the file, from 1; none where the key is not in the file or there is no file.
    pub line: Option<usize>,
    /// What is wrong, and what to do.
    pub what: String,
}

/// All that is wrong with a `mouse.toml`.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub struct ConfigFaults(pub Vec<ConfigFault>);

impl ConfigFault {
    pub(super) fn of(key: &str, what: String) -> Self {
        Self { key: Some(key.to_owned()), line: None, what }
    }
}

impl fmt::Display for ConfigFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(line) = self.line {
            write!(f, "line {line}: ")?;
        }
        f.write_str(&self.what)
    }
}

impl fmt::Display for ConfigFaults {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, fault) in self.0.iter().enumerate() {
            write!(f, "{}{fault}", if index > 0 { "\n" } else { "" })?;
        }
        Ok(())
    }
}

impl Config {
    /// Reads a file's text.
    ///
    /// # Errors
    /// Text that is not TOML; unknown keys with the nearest known one; values of another type; values that can't be:
    /// all of them, in the order of lines.
    pub fn from_toml(text: &str) -> Result<Self, ConfigFaults> {
        let table = DeTable::parse(text).map_err(|why| {
            let line = why.span().map(|span| line_of(text, span.start));
            let what = format!("not TOML: {}; correct this line", why.message());
            ConfigFaults(vec![ConfigFault { key: None, line, what }])
        })?;
        let keys = keys();
        let known: Vec<&str> = keys.iter().map(String::as_str).collect();
        let mut faults = Vec::new();
        let mut config = Self::default();
        for (name, value) in table.get_ref() {
            let (key, line) = (name.get_ref().as_ref(), Some(line_of(text, name.span().start)));
            let what = if known.contains(&key) {
                set(&mut config, key, value.get_ref())
            } else {
                Err(format!("unknown key `{}`; {}", key.escape_debug(), instead(key, &known)))
            };
            faults.extend(what.err().map(|what| ConfigFault { key: Some(key.to_owned()), line, what }));
        }
        if let Err(ConfigFaults(more)) = config.check() {
            let line = |key: &str| {
                let name = table.get_ref().keys().find(|name| name.get_ref().as_ref() == key)?;
                Some(line_of(text, name.span().start))
            };
            faults.extend(
                more.into_iter().map(|fault| ConfigFault { line: fault.key.as_deref().and_then(line), ..fault }),
            );
        }
        if faults.is_empty() {
            return Ok(config);
        }
        faults.sort_by_key(|fault| fault.line);
        let more = faults.len().saturating_sub(MOST);
        faults.truncate(MOST);
        if more > 0 {
            let what = format!("{more} more faults are not named; correct these first");
            faults.push(ConfigFault { key: None, line: None, what });
        }
        Err(ConfigFaults(faults))
    }
}

/// The keys of a `mouse.toml`, in the order of the alphabet.
fn keys() -> Vec<String> {
    toml::Table::try_from(Config::default())
        .map(|table| table.into_iter().map(|(key, _)| key).collect())
        .unwrap_or_default()
}

/// Sets one key as if the file had no other.
fn set(config: &mut Config, key: &str, value: &DeValue<'_>) -> Result<(), String> {
    let wrong = |what: String| format!("`{key}`: {what}");
    let mut table = toml::Table::try_from(*config).map_err(|why| wrong(why.to_string()))?;
    let value = match value {
        DeValue::String(text) => toml::Value::String(text.clone().into_owned()),
        DeValue::Boolean(is) => toml::Value::Boolean(*is),
        DeValue::Integer(integer) => number(integer.as_str(), toml::Value::Integer).map_err(wrong)?,
        DeValue::Float(float) => number(float.as_str(), toml::Value::Float).map_err(wrong)?,
        other => return Err(wrong(format!("{} where a number or a word is expected", other.type_str()))),
    };
    table.insert(key.to_owned(), value);
    *config = Config::deserialize(table).map_err(|why| wrong(why.message().trim().to_owned()))?;
    Ok(())
}

fn number<T: FromStr>(text: &str, value: fn(T) -> toml::Value) -> Result<toml::Value, String> {
    text.parse().map(value).map_err(|_| format!("{text} is not a number that can be used here"))
}

/// The line of a place (a number of bytes) of a text, from 1.
fn line_of(text: &str, at: usize) -> usize {
    1 + text.as_bytes().iter().take(at).filter(|&&byte| byte == b'\n').count()
}
