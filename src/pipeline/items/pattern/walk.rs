//! What a pattern finds, on the disk or among files that will be generated.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use super::{Part, Pattern};
use crate::input::is_special;
use crate::job::Keys;
use crate::words::instead;

/// What stands in place of what is not UTF-8.
const REPLACED: char = char::REPLACEMENT_CHARACTER;

/// Where files are looked for; paths are relative to its top, with `/`.
pub(in crate::pipeline) trait Tree {
    /// The names in a folder, sorted, and whether each is a folder. Empty where there is no such folder. What is not
    /// UTF-8 of a name is replaced ([`REPLACED`]): nothing stands under that name.
    fn list(&self, folder: &str) -> Vec<(String, bool)>;
    /// Whether a folder stands there.
    fn is_folder(&self, path: &str) -> bool;
    /// Whether a file stands there.
    fn is_file(&self, path: &str) -> bool;
    /// Whether it is a link to what stands elsewhere.
    fn is_link(&self, path: &str) -> bool;
}

/// Folders of the disk.
pub(in crate::pipeline) struct Disk {
    /// What paths are relative to.
    pub(in crate::pipeline) base: PathBuf,
    /// The folder of results, in full, which is never looked into.
    pub(in crate::pipeline) out: Option<PathBuf>,
}

impl Disk {
    fn at(&self, path: &str) -> PathBuf {
        if path.is_empty() { self.base.clone() } else { self.base.join(path) }
    }

    fn is_out(&self, path: &Path) -> bool {
        self.out.as_ref().is_some_and(|out| path.canonicalize().is_ok_and(|path| path == *out))
    }
}

impl Tree for Disk {
    fn list(&self, folder: &str) -> Vec<(String, bool)> {
        let entries = std::fs::read_dir(self.at(folder)).into_iter().flatten().flatten();
        let mut names: Vec<(String, bool)> = entries
            .filter_map(|entry| {
                let path = entry.path();
                let folder = path.is_dir();
                let name = entry.file_name().to_string_lossy().into_owned();
                let is_own = folder && self.is_out(&path);
                (!is_own && !is_special(&path)).then_some((name, folder))
            })
            .collect();
        names.sort();
        names
    }

    fn is_folder(&self, path: &str) -> bool {
        let at = self.at(path);
        at.is_dir() && !self.is_out(&at)
    }

    fn is_file(&self, path: &str) -> bool {
        self.at(path).is_file()
    }

    fn is_link(&self, path: &str) -> bool {
        self.at(path).is_symlink()
    }
}

/// Files that are known by name.
#[derive(Debug, Default)]
pub(in crate::pipeline) struct Listed {
    folders: BTreeMap<String, BTreeSet<(String, bool)>>,
}

impl Listed {
    pub(in crate::pipeline) fn new<'a>(paths: impl IntoIterator<Item = &'a str>) -> Self {
        let mut folders: BTreeMap<String, BTreeSet<(String, bool)>> = BTreeMap::new();
        folders.insert(String::new(), BTreeSet::new());
        for path in paths {
            let mut folder = String::new();
            let mut names = path.split('/').peekable();
            while let Some(name) = names.next() {
                let is_folder = names.peek().is_some();
                folders.entry(folder.clone()).or_default().insert((name.to_owned(), is_folder));
                folder = joined(&folder, name);
            }
        }
        Self { folders }
    }
}

impl Tree for Listed {
    fn list(&self, folder: &str) -> Vec<(String, bool)> {
        self.folders.get(folder).into_iter().flatten().cloned().collect()
    }

    fn is_folder(&self, path: &str) -> bool {
        self.folders.contains_key(path)
    }

    fn is_file(&self, path: &str) -> bool {
        let (folder, name) = path.rsplit_once('/').unwrap_or(("", path));
        self.folders.get(folder).is_some_and(|names| names.contains(&(name.to_owned(), false)))
    }

    fn is_link(&self, _path: &str) -> bool {
        false
    }
}

/// A file that a pattern found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::pipeline) struct Match {
    pub(in crate::pipeline) path: String,
    pub(in crate::pipeline) keys: Keys,
}

/// What a pattern found.
#[derive(Debug, Default, PartialEq, Eq)]
pub(in crate::pipeline) struct Matches {
    /// By path.
    pub(in crate::pipeline) matches: Vec<Match>,
    /// Names that can be read in two ways.
    pub(in crate::pipeline) ambiguous: Vec<String>,
    /// What fits but for a name that is not UTF-8, which can't be a key, nor stand in a table.
    pub(in crate::pipeline) not_utf8: Vec<String>,
    /// Why nothing was found.
    pub(in crate::pipeline) nothing: Option<String>,
}

struct Walk<'a> {
    pattern: &'a Pattern,
    tree: &'a dyn Tree,
    found: BTreeMap<String, Vec<Keys>>,
    not_utf8: BTreeSet<String>,
    /// How many parts were followed where the walk got deepest, and the folder there.
    deepest: (usize, String),
}

impl Pattern {
    /// Finds files (or folders).
    pub(in crate::pipeline) fn find(&self, tree: &dyn Tree) -> Matches {
        let (found, not_utf8) = (BTreeMap::new(), BTreeSet::new());
        let mut walk = Walk { pattern: self, tree, found, not_utf8, deepest: (0, String::new()) };
        walk.step(0, String::new(), &Keys::default());
        let nothing = walk.found.is_empty().then(|| walk.why_nothing());
        let not_utf8 = walk.not_utf8.into_iter().collect();
        let mut found = Matches { nothing, not_utf8, ..Matches::default() };
        for (path, mut keys) in walk.found {
            keys.sort();
            keys.dedup();
            if let [one, other, ..] = &keys[..] {
                found.ambiguous.push(format!("`{path}` can be read as {one} or as {other}"));
            } else if let Some(keys) = keys.pop() {
                found.matches.push(Match { path, keys });
            }
        }
        found
    }
}

impl Walk<'_> {
    fn step(&mut self, part: usize, at: String, keys: &Keys) {
        if part > self.deepest.0 {
            self.deepest = (part, at.clone());
        }
        let last = part + 1 == self.pattern.parts.len();
        match self.pattern.parts.get(part) {
            None => {}
            Some(Part::Plain(name)) => {
                let path = if part == 0 && name.is_empty() { "/".to_owned() } else { joined(&at, name) };
                self.follow(part, path, last, keys, None);
            }
            Some(Part::Wild(wild)) => {
                for (name, is_folder) in self.tree.list(&at) {
                    for new in wild.keys(&name) {
                        if keys.agree(&new) {
                            self.follow(part, joined(&at, &name), last, &keys.and(&new), Some(is_folder));
                        }
                    }
                }
            }
            Some(Part::Folders) => {
                self.step(part + 1, at.clone(), keys);
                for (name, is_folder) in self.tree.list(&at) {
                    let path = joined(&at, &name);
                    // Links may lead back, and what other runs made is no input unless it is named.
                    let passed = || self.tree.is_link(&path) || self.tree.is_folder(&joined(&path, ".lunula"));
                    if is_folder && !name.starts_with('.') && !passed() && self.is_named(&path) {
                        self.step(part, path, keys);
                    }
                }
            }
        }
    }

    fn follow(&mut self, part: usize, path: String, last: bool, keys: &Keys, is_folder: Option<bool>) {
        let plain = is_folder.is_none() && !self.pattern.folders;
        let is_folder = is_folder.unwrap_or_else(|| self.tree.is_folder(&path));
        let fits = if last { is_folder == self.pattern.folders || plain } else { is_folder };
        if !fits || !self.is_named(&path) {
            return;
        }
        if !last {
            self.step(part + 1, path, keys);
        } else if is_folder || self.tree.is_file(&path) {
            self.found.entry(path).or_default().push(keys.clone());
        }
    }

    /// Whether all of a path's name is UTF-8; it is kept in mind where not.
    fn is_named(&mut self, path: &str) -> bool {
        let replaced = path.contains(REPLACED) && !self.tree.is_file(path) && !self.tree.is_folder(path);
        if replaced {
            self.not_utf8.insert(path.to_owned());
        }
        !replaced
    }

    fn why_nothing(&self) -> String {
        let (part, at) = &self.deepest;
        let shown = if at.is_empty() { "." } else { at };
        let listed = self.tree.list(at);
        let names: Vec<&str> = listed.iter().map(|(name, _)| name.as_str()).filter(|n| !n.starts_with('.')).collect();
        let holds = match names.len() {
            0 => "which is empty".to_owned(),
            1..=5 => format!("which holds {}", names.join(", ")),
            more => format!("which holds {}, .. ({more} names)", names[..3].join(", ")),
        };
        match self.pattern.parts.get(*part) {
            Some(Part::Plain(name)) if names.iter().any(|n| n == name) => {
                format!("`{name}` in {shown} is a file, and the pattern looks for a folder")
            }
            Some(Part::Plain(name)) => {
                let near = instead(name, &names);
                let near = if near.starts_with("did you mean") { near } else { holds };
                format!("there is no `{name}` in the folder {shown}, {near}")
            }
            Some(Part::Wild(wild)) => {
                let last = part + 1 == self.pattern.parts.len();
                let folders = listed.iter().any(|(name, is_folder)| *is_folder && !wild.keys(name).is_empty());
                let hint = if last && folders { "; for whole folders, end the pattern in /" } else { "" };
                format!("nothing like `{}` is in the folder {shown}, {holds}{hint}", wild.said)
            }
            Some(Part::Folders) | None => format!("the nearest folder that stands is {shown}, {holds}"),
        }
    }
}

fn joined(folder: &str, name: &str) -> String {
    match folder {
        "" => name.to_owned(),
        folder if folder.ends_with('/') => format!("{folder}{name}"),
        folder => format!("{folder}/{name}"),
    }
}
