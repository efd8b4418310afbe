//! The marker file's tables as TOML gives them, with the place of every key and value.

use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::LayoutFault;

/// A key, its value and both places.
#[derive(Debug, Clone, Copy)]
pub(super) struct Entry<'a> {
    pub(super) key: &'a str,
    pub(super) key_at: usize,
    pub(super) value: &'a DeValue<'a>,
    pub(super) at: usize,
}

/// A table's entries in the file's order.
pub(super) fn entries<'a>(table: &'a DeTable<'a>) -> Vec<Entry<'a>> {
    let mut entries: Vec<Entry<'a>> = table
        .iter()
        .map(|(key, value)| Entry {
            key: key.get_ref(),
            key_at: key.span().start,
            value: value.get_ref(),
            at: value.span().start,
        })
        .collect();
    entries.sort_by_key(|e| e.key_at);
    entries
}

/// Faults and notes as they are found.
#[derive(Debug)]
pub(super) struct Findings<'a> {
    text: &'a str,
    faults: Vec<LayoutFault>,
}

impl<'a> Findings<'a> {
    pub(super) fn new(text: &'a str) -> Self {
        Self { text, faults: Vec::new() }
    }

    /// The line of a place, from 1.
    pub(super) fn line(&self, at: usize) -> usize {
        1 + self.text.bytes().take(at).filter(|&b| b == b'\n').count()
    }

    pub(super) fn fault(&mut self, at: usize, what: impl Into<String>) {
        let fault = LayoutFault { line: self.line(at), what: what.into() };
        if !self.faults.contains(&fault) {
            self.faults.push(fault);
        }
    }

    /// Parses the text. A file with one wrong line is no TOML: nothing more can be said of it then, but a doubled key is told
    /// along with all else.
    pub(super) fn parse(&mut self) -> Option<Spanned<DeTable<'a>>> {
        let (table, errors) = DeTable::parse_recoverable(self.text);
        let mut sound = true;
        for error in &errors {
            let Range { start, end } = error.span().unwrap_or(self.text.len()..self.text.len());
            let doubled = error.message().starts_with("duplicate key");
            sound &= doubled;
            let what = if doubled {
                let name = self.text.get(start..end).unwrap_or_default();
                format!("`{name}` stands here a second time; give each its own name")
            } else {
                format!("not TOML: {}; correct this line", error.message())
            };
            self.fault(start, what);
        }
        sound.then_some(table)
    }

    /// The faults in the order of lines, if there are any.
    pub(super) fn finish(mut self) -> Result<(), Vec<LayoutFault>> {
        self.faults.sort_by_key(|f| f.line);
        if self.faults.is_empty() { Ok(()) } else { Err(self.faults) }
    }

    /// The table `key` of the file's `entries`; none with a fault where it is something else.
    pub(super) fn table<'t>(&mut self, entries: &[Entry<'t>], key: &str) -> Option<Vec<Entry<'t>>> {
        let entry = *entries.iter().find(|e| e.key == key)?;
        match entry.value {
            DeValue::Table(table) => Some(self::entries(table)),
            other => {
                self.fault(
                    entry.key_at,
                    format!("`{key}` is no table but {}; write [{key}] and its lines below", other.type_str()),
                );
                None
            }
        }
    }

    /// Tells of keys that are not `known`.
    pub(super) fn unknown_keys(&mut self, entries: &[Entry<'_>], known: &[&str], within: &str) {
        for entry in entries.iter().filter(|e| !known.contains(&e.key)) {
            self.fault(entry.key_at, format!("unknown {within} `{}`; {}", entry.key, instead(entry.key, known)));
        }
    }

    pub(super) fn number(&mut self, entry: Entry<'_>) -> Option<f64> {
        let number = finite(entry.value);
        if number.is_none() {
            self.fault(entry.at, format!("`{}` has to be a finite number", entry.key));
        }
        number
    }

    /// A list of numbers; none with a fault where one is none.
    pub(super) fn numbers(&mut self, entry: Entry<'_>, shape: &str) -> Option<Vec<f64>> {
        let numbers = entry.value.as_array().and_then(|list| list.iter().map(|v| finite(v.get_ref())).collect());
        if numbers.is_none() {
            self.fault(entry.at, format!("`{}` has to be finite numbers; write {shape}", entry.key));
        }
        numbers
    }

    /// Two different names out of `known`, as indices.
    pub(super) fn pair(&mut self, entry: Entry<'_>, kind: &str, known: &[&str]) -> Option<[usize; 2]> {
        let shape = format!("two {kind}s, proximal first, such as {} = [\"a\", \"b\"]", entry.key);
        let Some(list) = entry.value.as_array() else {
            self.fault(entry.at, format!("`{}` is no list; name {shape}", entry.key));
            return None;
        };
        let mut found = Vec::new();
        for value in list.iter() {
            let at = value.span().start;
            match value.get_ref().as_str() {
                None => self.fault(at, format!("a {kind} of `{}` is no name; name {shape}", entry.key)),
                Some(name) => match known.iter().position(|&k| k == name) {
                    None => self.fault(
                        at,
                        format!("`{}` names the unknown {kind} `{name}`; {}", entry.key, instead(name, known)),
                    ),
                    Some(index) => found.push(index),
                },
            }
        }
        if list.len() != 2 {
            self.fault(entry.at, format!("`{}` has {} {kind}(s) and needs two; name {shape}", entry.key, list.len()));
            return None;
        }
        let pair = <[usize; 2]>::try_from(found).ok()?;
        if pair[0] == pair[1] {
            let name = known[pair[0]];
            self.fault(entry.at, format!("`{}` names the {kind} `{name}` twice; name two different ones", entry.key));
            return None;
        }
        Some(pair)
    }
}

fn finite(value: &DeValue<'_>) -> Option<f64> {
    number(value).filter(|number| number.is_finite())
}

/// A number, which in TOML may be infinite or none.
pub(super) fn number(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Integer(i) => Some(i64::from_str_radix(i.as_str(), i.radix()).ok()? as f64),
        DeValue::Float(f) => f.as_str().parse().ok(),
        _ => None,
    }
}

/// What to write instead of an unknown `name`: one that differs by a slip of the finger, or the choice.
pub(super) fn instead(name: &str, known: &[&str]) -> String {
    let lower = name.to_lowercase();
    let slips = 1.max(name.chars().count() / 3);
    let nearest = known
        .iter()
        .map(|k| (strsim::osa_distance(&lower, &k.to_lowercase()), k))
        .min_by_key(|(distance, _)| *distance)
        .filter(|(distance, _)| *distance <= slips);
    match nearest {
        Some((_, known)) => format!("did you mean `{known}`?"),
        None if known.is_empty() => "none is defined".to_owned(),
        None => format!("known: {}", known.join(", ")),
    }
}
