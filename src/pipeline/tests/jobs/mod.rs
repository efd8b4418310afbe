//! The jobs on small generated recordings, without a pipeline around them.

mod models;
mod photos;
mod recordings;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use tempfile::TempDir;

use crate::job::{At, Demand, Facts, Foreseen, Keys, Kind, Made, Prepared, Work};
use crate::pipeline::kinds;
use crate::pipeline::store::hashes::files_in;
use crate::stages::{Fate, Step};

fn keys(pairs: &[(&str, &str)]) -> Keys {
    Keys(pairs.iter().map(|(name, value)| ((*name).to_owned(), (*value).to_owned())).collect())
}

/// An input, named as it would be whatever folder it stands in.
fn at(role: &'static str, of: &[(&str, &str)], root: &Path, name: &str) -> At {
    At { role, keys: keys(of), path: root.join(name), name: name.to_owned() }
}

fn prepared(kind: &Kind, options: &str) -> Arc<dyn Prepared> {
    (kind.prepare)(&options.parse().expect("TOML")).map_err(|fault| format!("{fault:?}")).expect("sound options")
}

fn wanting(parts: &[&'static str]) -> Demand {
    Demand { parts: parts.iter().copied().collect(), joints: None, clock: true }
}

/// Every file below a folder.
fn bytes_below(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let names = files_in(folder).expect("a folder").into_iter();
    names.map(|name| (name.clone(), fs::read(folder.join(name)).expect("a file"))).collect()
}

/// A task's folder.
struct Folder(TempDir);

impl Folder {
    fn path(&self) -> &Path {
        self.0.path()
    }

    fn bytes(&self) -> BTreeMap<String, Vec<u8>> {
        bytes_below(self.path())
    }

    fn names(&self) -> Vec<String> {
        self.bytes().into_keys().collect()
    }

    fn text(&self, name: &str) -> String {
        fs::read_to_string(self.path().join(name)).expect("a text")
    }
}

struct Task<'a> {
    kind: &'a Kind,
    options: &'a str,
    demand: Demand,
    keys: Keys,
    inputs: Vec<At>,
}

impl Task<'_> {
    fn try_run(&self, threads: usize, before: Option<&Path>) -> anyhow::Result<(Folder, Made)> {
        let folder = Folder(tempfile::tempdir().expect("a folder"));
        let stop = AtomicBool::new(false);
        let inputs = self.inputs.clone();
        let work = Work { inputs, folder: folder.path(), before, threads, stop: &stop };
        let made = prepared(self.kind, self.options).maker(&self.keys, &self.demand).run(&work)?;
        Ok((folder, made))
    }

    fn run(&self, threads: usize, before: Option<&Path>) -> (Folder, Made) {
        self.try_run(threads, before).expect("a result")
    }

    /// The same with its inputs in another folder.
    fn elsewhere(&self, from: &Path, to: &Path) -> Self {
        let mut inputs = self.inputs.clone();
        for input in &mut inputs {
            let name = input.path.strip_prefix(from).expect("within").to_owned();
            input.path = to.join(name);
        }
        Self { inputs, demand: self.demand.clone(), keys: self.keys.clone(), ..*self }
    }
}

/// A whole folder.
fn copy(from: &Path, to: &Path) {
    for (name, bytes) in bytes_below(from) {
        let target = to.join(name);
        fs::create_dir_all(target.parent().expect("within it")).expect("a folder");
        fs::write(target, bytes).expect("a copy");
    }
}

/// Done in two folders, on one thread and on three: the same bytes, and none of them says where. (No job reads a wall
/// clock: `tests/house.rs` looks.)
#[track_caller]
fn is_the_same_anywhere(task: &Task, root: &Path) -> (Folder, Made) {
    let other = tempfile::tempdir().expect("a folder");
    let moved = other.path().join("some/where else");
    copy(root, &moved);
    let (first, made) = task.run(1, None);
    let (second, _) = task.elsewhere(root, &moved).run(3, None);
    let (first_bytes, second_bytes) = (first.bytes(), second.bytes());
    assert_eq!(first.names(), second.names());
    for (name, bytes) in &first_bytes {
        assert!(*bytes == second_bytes[name], "{name} differs");
        let places = [root, first.path()].map(|path| path.to_string_lossy().into_owned());
        let holds = |place: &String| bytes.windows(place.len()).any(|part| part == place.as_bytes());
        assert!(!places.iter().any(holds), "{name} says where it was made");
    }
    (first, made)
}

fn foreseen(input: &At, exists: bool, facts: Facts) -> Foreseen {
    Foreseen { role: input.role, keys: input.keys.clone(), path: input.path.clone(), exists, facts }
}

/// A step's fate and reason.
#[track_caller]
fn step<'a>(steps: &'a [Step], stage: &str) -> (bool, &'a str) {
    let step = steps.iter().find(|step| step.stage == stage);
    let step = step.unwrap_or_else(|| panic!("no step `{stage}` among {steps:?}"));
    (step.fate == Fate::Run, &step.reason)
}

#[test]
fn kinds_are_sorted_by_name() {
    assert!(kinds().is_sorted_by_key(|kind| kind.name));
}

#[test]
fn a_key_that_no_job_knows_is_named() {
    for kind in kinds() {
        // Which options a trajectory has depends on its kind.
        let which = if kind.name == "trajectory" { "\nkind = 'force'" } else { "" };
        let fault = (kind.prepare)(&format!("no_such_key = 1{which}").parse().unwrap()).err();
        let fault = fault.unwrap_or_else(|| panic!("{} takes any key", kind.name));
        assert_eq!(fault.key, "no_such_key", "{}", kind.name);
        for role in kind.roles {
            let keys = (kind.keys)();
            assert!(!keys.iter().any(|key| key == role.name), "{}: `{}` is a role and an option", kind.name, role.name);
        }
    }
}

/// Where a part's file is said to be, there it is.
#[track_caller]
fn has_its_parts(kind: &Kind, options: &str, demand: &Demand, folder: &Folder) {
    let prepared = prepared(kind, options);
    for part in kind.parts {
        let place: PathBuf = folder.path().join(prepared.file(part));
        let promised = !part.only_if_wanted || demand.parts.contains(part.name);
        assert_eq!(place.exists(), promised, "{}.{}: {}", kind.name, part.name, place.display());
    }
}
