//! TOML that people write: every key and value with its place; all faults of a file are reported together.
//!
//! In: a file's text; out: its tables as [`Entry`]s in the file's order, and [`Findings`], the faults with line and
//! column, both from 1.

use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::words::instead;

/// What is wrong at one place of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fault {
    /// The line, from 1.
    pub line: usize,
    /// The character in the line, from 1.
    pub column: usize,
    /// What is wrong; what to do.
    pub what: String,
}

/// A key, its value and both places.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Entry<'a> {
    pub(crate) key: &'a str,
    pub(crate) key_at: usize,
    pub(crate) value: &'a DeValue<'a>,
    pub(crate) at: usize,
}

/// A table's entries in the file's order.
pub(crate) fn entries<'a>(table: &'a DeTable<'a>) -> Vec<Entry<'a>> {
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

/// The line and the column of a place (a number of bytes) of a text, from 1.
pub(crate) fn place(text: &str, at: usize) -> (usize, usize) {
    let before = &text.as_bytes()[..at.min(text.len())];
    let line = 1 + before.iter().filter(|&&b| b == b'\n').count();
    let start = before.iter().rposition(|&b| b == b'\n').map_or(0, |newline| newline + 1);
    (line, 1 + String::from_utf8_lossy(&before[start..]).chars().count())
}

/// The text of a file; the fault is where it is no UTF-8.
pub(crate) fn text(bytes: Vec<u8>) -> Result<String, Fault> {
    String::from_utf8(bytes).map_err(|why| {
        let sound = &why.as_bytes()[..why.utf8_error().valid_up_to()];
        let (line, column) = place(&String::from_utf8_lossy(sound), sound.len());
        Fault { line, column, what: "not UTF-8 text; save the file as UTF-8".to_owned() }
    })
}

/// Faults that are named of one file; who corrects so many looks again (assumed).
const MOST: usize = 100;

/// Lines that are named of a file that is no TOML: after a few, it is another kind of file.
const MOST_BROKEN: usize = 3;

/// Faults as they are found, the first [`MOST`] of them.
#[derive(Debug)]
pub(crate) struct Findings<'a> {
    text: &'a str,
    faults: Vec<Fault>,
    more: usize,
}

impl<'a> Findings<'a> {
    pub(crate) fn new(text: &'a str) -> Self {
        Self { text, faults: Vec::new(), more: 0 }
    }

    /// The line of a place, from 1.
    pub(crate) fn line(&self, at: usize) -> usize {
        place(self.text, at).0
    }

    /// Whether faults are only counted from here on.
    pub(crate) fn is_full(&self) -> bool {
        self.faults.len() >= MOST
    }

    pub(crate) fn fault(&mut self, at: usize, what: impl Into<String>) {
        if self.is_full() {
            self.more += 1;
            return;
        }
        let (line, column) = place(self.text, at);
        let fault = Fault { line, column, what: what.into() };
        if !self.faults.contains(&fault) {
            self.faults.push(fault);
        }
    }

    /// Parses the text. A file with one wrong line is no TOML: nothing more can be said of it then, but a doubled key
    /// is reported along with the rest.
    pub(crate) fn parse(&mut self) -> Option<Spanned<DeTable<'a>>> {
        let (table, errors) = DeTable::parse_recoverable(self.text);
        let (mut sound, mut broken) = (true, 0);
        for error in &errors {
            let Range { start, end } = error.span().unwrap_or(self.text.len()..self.text.len());
            if self.is_full() || broken == MOST_BROKEN {
                // Whatever it says: there is a fault.
                sound = false;
                self.more += 1;
                continue;
            }
            let doubled = error.message().starts_with("duplicate key");
            sound &= doubled;
            broken += usize::from(!doubled);
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

    /// Whether nothing was found.
    pub(crate) fn is_empty(&self) -> bool {
        self.faults.is_empty()
    }

    /// The faults in the order of lines, if there are any.
    pub(crate) fn finish(mut self) -> Result<(), Vec<Fault>> {
        self.faults.sort_by_key(|f| (f.line, f.column));
        if let Some(&Fault { line, column, .. }) = self.faults.last().filter(|_| self.more > 0) {
            let what = format!("{} more faults are not named; correct these first", self.more);
            self.faults.push(Fault { line, column, what });
        }
        if self.faults.is_empty() { Ok(()) } else { Err(self.faults) }
    }

    /// The table `key` of the file's `entries`; none with a fault where it is something else.
    pub(crate) fn table<'t>(&mut self, entries: &[Entry<'t>], key: &str) -> Option<Vec<Entry<'t>>> {
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
    pub(crate) fn unknown_keys(&mut self, entries: &[Entry<'_>], known: &[&str], within: &str) {
        for entry in entries.iter().filter(|e| !known.contains(&e.key)) {
            if self.is_full() {
                self.more += 1;
                continue;
            }
            self.fault(entry.key_at, format!("unknown {within} `{}`; {}", entry.key, instead(entry.key, known)));
        }
    }

    pub(crate) fn number(&mut self, entry: Entry<'_>) -> Option<f64> {
        let number = finite(entry.value);
        if number.is_none() {
            self.fault(entry.at, format!("`{}` has to be a finite number", entry.key));
        }
        number
    }

    /// A list of numbers; none with a fault where one is none.
    pub(crate) fn numbers(&mut self, entry: Entry<'_>, shape: &str) -> Option<Vec<f64>> {
        let numbers = entry.value.as_array().and_then(|list| list.iter().map(|v| finite(v.get_ref())).collect());
        if numbers.is_none() {
            self.fault(entry.at, format!("`{}` has to be finite numbers; write {shape}", entry.key));
        }
        numbers
    }
}

fn finite(value: &DeValue<'_>) -> Option<f64> {
    number(value).filter(|number| number.is_finite())
}

/// A number, which in TOML may be infinite or none.
pub(crate) fn number(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Integer(i) => Some(i64::from_str_radix(i.as_str(), i.radix()).ok()? as f64),
        DeValue::Float(f) => f.as_str().parse().ok(),
        _ => None,
    }
}
