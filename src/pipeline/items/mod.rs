//! What there is to work on: every input as a relation of keys and files, from a table's rows or from files found by a
//! pattern.
//!
//! A table's cell names a file relative to the table's folder; an empty one says that there is none. Columns that
//! stages name, and those whose cells all look like files' names, are no keys; of the others all are, or those that the
//! input lists. An empty cell of a key says nothing of it. `{phantom}` at the beginning of a path is the folder of the
//! generated recordings, whose catalogue answers for it, standing or not.

pub(super) mod catalogue;
pub(super) mod generated;
mod input;
mod join;
pub(super) mod pattern;
mod table;

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::spec::Filter;
use crate::job::{Facts, Keys};
use crate::words::in_order;
use catalogue::Catalogue;
use pattern::{Listed, Tree};

pub(super) use input::{InputItems, check_filter, input_items};
pub(super) use join::{Index, JoinedRows, Unjoined, join};

/// Where an item comes from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Origin {
    /// The user's file.
    Given { path: PathBuf, name: String },
    /// A generated recording, or a folder of them: its path in the catalogue.
    Generated(String),
    /// A result: which task of the plan, the file in its folder, and the part of what its job makes.
    Made { task: usize, file: String, part: Option<&'static str> },
}

/// One file and whose it is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Item {
    pub(super) keys: Keys,
    /// All that is known of it by name, for `where`.
    pub(super) columns: Keys,
    pub(super) origin: Origin,
    /// Where it is named, as messages tell.
    pub(super) place: String,
}

/// What was not taken, and why.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Missing {
    pub(super) reason: String,
    pub(super) count: usize,
}

/// A row of a table that names no file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Lacking {
    pub(super) keys: Keys,
    /// All that is known of it by name, for `where`.
    pub(super) columns: Keys,
    pub(super) reason: String,
}

/// Items with the names of their keys, in order.
#[derive(Debug, Clone, Default)]
pub(super) struct Relation {
    pub(super) names: Vec<String>,
    pub(super) items: Vec<Item>,
    pub(super) lacking: Vec<Lacking>,
}

/// Where inputs are looked for.
pub(super) struct World<'a> {
    /// What the pipeline file's paths are relative to.
    pub(super) base: PathBuf,
    /// The folder of results, in full where it stands.
    pub(super) out: PathBuf,
    pub(super) catalogue: Option<&'a Catalogue>,
    /// The catalogue's files.
    pub(super) listed: Listed,
    by_path: HashMap<&'a str, usize>,
    tasks: HashMap<&'a str, usize>,
}

impl<'a> World<'a> {
    pub(super) fn new(base: &Path, out: &Path, catalogue: Option<&'a Catalogue>) -> Self {
        let paths = || catalogue.into_iter().flat_map(|catalogue| &catalogue.files).map(|file| file.path.as_str());
        let by_path = paths().enumerate().map(|(at, path)| (path, at)).collect();
        let names = catalogue.into_iter().flat_map(|catalogue| &catalogue.tasks).map(|task| task.name.as_str());
        let tasks = names.enumerate().map(|(at, name)| (name, at)).collect();
        Self { base: base.to_owned(), out: out.to_owned(), catalogue, listed: Listed::new(paths()), by_path, tasks }
    }

    /// Where a file that the pipeline names stands; `.` before it says nothing.
    pub(super) fn at(&self, name: &str) -> PathBuf {
        if self.base == Path::new(".") { PathBuf::from(name) } else { self.base.join(name) }
    }

    /// Whether the catalogue has a file or a folder of this path.
    pub(super) fn generates(&self, path: &str) -> bool {
        self.listed.is_file(path) || self.listed.is_folder(path)
    }

    /// Which of the catalogue's tasks makes a file or a folder, its name in the task's folder, and what is known of it.
    pub(super) fn maker(&self, path: &str) -> Option<(usize, String, Facts)> {
        let above = std::iter::successors(Some(path.len()), |end| path[..*end].rfind('/'));
        let (end, &task) = above.into_iter().find_map(|end| Some((end, self.tasks.get(&path[..end])?)))?;
        let facts = self.by_path.get(path).and_then(|&at| Some(self.catalogue?.files[at].facts)).unwrap_or_default();
        Some((task, path[end..].trim_start_matches('/').to_owned(), facts))
    }
}

impl Relation {
    pub(super) fn only(mut self, filter: &Filter) -> Self {
        self.items.retain(|item| holds(filter, &item.columns));
        self.lacking.retain(|row| holds(filter, &row.columns));
        self
    }

    /// Puts another relation's items after these.
    pub(super) fn extend(&mut self, other: Self) {
        self.names = in_order(self.names.drain(..).chain(other.names));
        self.items.extend(other.items);
        self.lacking.extend(other.lacking);
    }
}

/// Whether what is known has one of the values, of every key of the filter.
pub(super) fn holds(filter: &Filter, known: &Keys) -> bool {
    filter.iter().all(|(key, values, _)| known.get(key).is_some_and(|value| values.iter().any(|v| v == value)))
}

/// Whether a filter leaves out what has these keys, as far as they say it.
pub(super) fn leaves_out(filter: &Filter, keys: &Keys) -> bool {
    filter.iter().any(|(key, values, _)| keys.get(key).is_some_and(|value| !values.iter().any(|v| v == value)))
}

/// A path without `.` and without `..` after a name.
pub(super) fn plain(path: &str) -> String {
    let absolute = path.starts_with('/');
    let mut names: Vec<&str> = Vec::new();
    for name in path.split('/') {
        match name {
            "" | "." => {}
            ".." if names.last().is_some_and(|last| *last != "..") => {
                names.pop();
            }
            ".." if absolute => {}
            name => names.push(name),
        }
    }
    format!("{}{}", if absolute { "/" } else { "" }, names.join("/"))
}
