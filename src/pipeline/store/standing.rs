//! What stands of what tasks have made, and why the rest does not.
//!
//! A task stands where its record's key is that of its inputs, options and version now, and every file that it made is
//! there and holds what it held. What needs a task that does not stand is said to follow from it; it may yet stand
//! where that comes out the same as before.

use std::collections::BTreeSet;
use std::fmt;
use std::path::Path;

use rayon::prelude::*;
use serde::Serialize;

use crate::pipeline::store::Store;
use crate::pipeline::store::hashes::{ContentHash, FileFault, Hashes};
use crate::pipeline::store::record::{Fingerprint, Known, Record};
use crate::pipeline::tasks::graph::{Graph, GraphFault};
use crate::pipeline::tasks::{Source, Task, TaskId};

/// Why a task is to be done.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case", tag = "why", content = "what")]
pub enum Why {
    /// It was not done before.
    NeverMade,
    /// It failed when it was tried last, so.
    Failed(String),
    /// An input holds something else.
    InputChanged(String),
    /// It was done without this input.
    InputAdded(String),
    /// It was done with an input that it has no more.
    InputGone(String),
    /// A given file is not there: it will fail.
    InputMissing(String),
    /// These options are others.
    OptionsChanged(Vec<String>),
    /// The job makes other bytes than it did.
    VersionChanged,
    /// A result was edited by hand.
    Edited(String),
    /// A result was deleted.
    Deleted(String),
    /// It works on the results of a task that is to be done.
    Follows(TaskId),
}

impl fmt::Display for Why {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NeverMade => f.write_str("never made"),
            Self::Failed(_) => f.write_str("failed when it was tried last"),
            Self::InputChanged(name) => write!(f, "input {name} changed"),
            Self::InputAdded(name) => write!(f, "input {name} is new"),
            Self::InputGone(name) => write!(f, "input {name} is gone"),
            Self::InputMissing(name) => write!(f, "input {name} is not there"),
            Self::OptionsChanged(names) if names.is_empty() => f.write_str("options changed"),
            Self::OptionsChanged(names) => write!(f, "options changed: {}", names.join(", ")),
            Self::VersionChanged => f.write_str("version changed"),
            Self::Edited(name) => write!(f, "{name} was edited by hand"),
            Self::Deleted(name) => write!(f, "{name} was deleted"),
            Self::Follows(task) => write!(f, "follows from {task}"),
        }
    }
}

/// Whether a task is to be done.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Standing {
    /// Its results stand.
    Done,
    /// It is to be done.
    Run(Why),
}

/// What stands of these tasks in `out`, in their order. Nothing is written, and nothing locked: a run at the same time
/// may change it.
///
/// # Errors
/// [`GraphFault`] where the tasks can't be worked through.
pub fn survey(tasks: &[Task], out: &Path) -> Result<Vec<Standing>, GraphFault> {
    let graph = Graph::new(tasks)?;
    let store = Store::new(out);
    let hashes = Hashes::look(&store.hashes());
    let looked: Vec<Looked> = tasks.par_iter().map(|task| Looked::at(task, &store, &hashes)).collect();
    let mut standing: Vec<Option<Standing>> = vec![None; tasks.len()];
    for &at in &graph.order {
        let follows = graph.needs[at].iter().find(|&&needed| standing[needed] != Some(Standing::Done));
        let own = looked[at].why(&tasks[at], |needed, name| {
            let at = graph.at(needed);
            let stands = standing[at] == Some(Standing::Done);
            looked[at].record.as_ref().filter(|_| stands)?.content(name)
        });
        standing[at] = Some(match (own, follows) {
            (Some(why), _) => Standing::Run(why),
            (None, Some(&needed)) => Standing::Run(Why::Follows(tasks[needed].id.clone())),
            (None, None) => Standing::Done,
        });
    }
    Ok(standing.into_iter().flatten().collect())
}

/// All of a task that files tell.
struct Looked {
    record: Option<Record>,
    failed: Option<String>,
    /// The given inputs', by position.
    given: Vec<Option<Result<ContentHash, FileFault>>>,
    spoilt: Option<Why>,
}

impl Looked {
    fn at(task: &Task, store: &Store, hashes: &Hashes) -> Self {
        let record = store.record(&task.id);
        let failed = if record.is_none() { store.failure(&task.id).map(|note| note.what) } else { None };
        let given = task.inputs.iter().map(|input| match &input.source {
            // Of a task that was never done only this is known: whether it can be done.
            Source::Given { path, .. } if record.is_some() => Some(hashes.of_given(path)),
            Source::Given { path, .. } if !path.exists() => Some(Err(FileFault::Missing(path.clone()))),
            _ => None,
        });
        let given = given.collect();
        let spoilt = record.as_ref().and_then(|record| spoilt(record, &store.folder(&task.id), hashes));
        Self { record, failed, given, spoilt }
    }

    /// Why it is to be done by itself, whatever it follows from.
    fn why(&self, task: &Task, content: impl Fn(&str, &str) -> Option<ContentHash>) -> Option<Why> {
        let mut inputs = Vec::new();
        let mut without = Vec::new();
        let mut open = false;
        for (input, given) in task.inputs.iter().zip(&self.given) {
            let hash = match (&input.source, given) {
                (_, Some(Ok(hash))) => Some(*hash),
                (_, Some(Err(_))) => return Some(Why::InputMissing(input.name())),
                (Source::Result { task, name }, _) => content(task, name),
                (Source::Given { .. }, None) => None,
            };
            match hash {
                Some(hash) => inputs.push(Known::new(input, hash)),
                None => open = true,
            }
        }
        let Some(record) = &self.record else {
            return Some(self.failed.clone().map_or(Why::NeverMade, Why::Failed));
        };
        // An input that failed and may is treated as one that is to be made: its task does not stand, so this one
        // follows from it.
        without.extend(record.without.iter().cloned());
        let now = Fingerprint::new(task, inputs, without);
        difference(record, task, &now, open).or_else(|| self.spoilt.clone())
    }
}

/// Why a record is not that of the task as it is now. Where inputs are `open`, those that are not among `now` may be
/// the same.
pub(in crate::pipeline) fn difference(record: &Record, task: &Task, now: &Fingerprint, open: bool) -> Option<Why> {
    if record.key == now.key {
        return None;
    }
    if record.options != task.options {
        return Some(options_changed(&record.options, &task.options));
    }
    for input in &now.inputs {
        match record.inputs.iter().find(|before| before.is_of(input)) {
            Some(before) if before.sha256 != input.sha256 => return Some(Why::InputChanged(input.name.clone())),
            Some(_) => {}
            None => return Some(Why::InputAdded(input.name.clone())),
        }
    }
    if open {
        return None;
    }
    let gone = record.inputs.iter().find(|before| !now.inputs.iter().any(|input| input.is_of(before)));
    // Else only their order changed, or the task's name.
    Some(gone.map_or_else(|| Why::OptionsChanged(Vec::new()), |input| Why::InputGone(input.name.clone())))
}

fn options_changed(before: &serde_json::Value, now: &serde_json::Value) -> Why {
    let (Some(before), Some(now)) = (before.as_object(), now.as_object()) else {
        return Why::OptionsChanged(Vec::new());
    };
    let changed = differing(before, now);
    if changed.iter().any(|name| matches!(name.as_str(), "revision" | "version")) {
        return Why::VersionChanged;
    }
    // Options within options are named by themselves.
    let within = |of: &Options| if let [one] = &changed[..] { of.get(one)?.as_object().cloned() } else { None };
    Why::OptionsChanged(match within(before).zip(within(now)) {
        Some((before, now)) => differing(&before, &now),
        None => changed,
    })
}

type Options = serde_json::Map<String, serde_json::Value>;

/// The names of options that are not the same in both, sorted.
fn differing(before: &Options, now: &Options) -> Vec<String> {
    let names: BTreeSet<&String> = before.keys().chain(now.keys()).collect();
    names.into_iter().filter(|name| before.get(*name) != now.get(*name)).cloned().collect()
}

/// A result that is not there as it was made.
pub(in crate::pipeline) fn spoilt(record: &Record, folder: &Path, hashes: &Hashes) -> Option<Why> {
    record.outputs.iter().find_map(|output| match hashes.of_file(&folder.join(&output.name)) {
        Ok((found, _)) if found == output.sha256 => None,
        Ok(_) | Err(FileFault::Changing(_)) => Some(Why::Edited(output.name.clone())),
        Err(_) => Some(Why::Deleted(output.name.clone())),
    })
}
