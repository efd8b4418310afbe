//! What is kept of a task that was done: from what it was made, what came out, how long it took.
//!
//! The key is the SHA-256 of all that the result depends on: the task's name and keys, its options (kind, revision,
//! options) and, for each input in the task's order, role, keys, name and content. Times and the machine are given in
//! the record too, but are no part of the key.

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::job::{Keys, Made};
use crate::pipeline::store::hashes::{ContentHash, of_names};
use crate::pipeline::tasks::{Input, Source, Task, TaskId};

/// The form of records; another is read as none.
pub(in crate::pipeline) const FORMAT: u32 = 1;

/// A file that a task made.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Output {
    /// Its name in the task's folder, with `/`.
    pub name: String,
    /// Its size, bytes.
    pub size: u64,
    /// What it holds.
    pub sha256: ContentHash,
}

/// An input as it was.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(in crate::pipeline) struct Known {
    pub(in crate::pipeline) role: String,
    pub(in crate::pipeline) keys: Keys,
    pub(in crate::pipeline) name: String,
    pub(in crate::pipeline) sha256: ContentHash,
}

impl Known {
    pub(in crate::pipeline) fn new(input: &Input, sha256: ContentHash) -> Self {
        Self { role: input.role.to_owned(), keys: input.keys.clone(), name: input.name(), sha256 }
    }

    /// It is the same thing to the job, whatever it holds.
    pub(in crate::pipeline) fn is_of(&self, other: &Self) -> bool {
        self.role == other.role && self.keys == other.keys && self.name == other.name
    }
}

/// All that a task's result depends on.
#[derive(Debug, Clone)]
pub(in crate::pipeline) struct Fingerprint {
    pub(in crate::pipeline) key: ContentHash,
    pub(in crate::pipeline) inputs: Vec<Known>,
    /// Names of inputs that failed and may.
    pub(in crate::pipeline) without: Vec<String>,
}

impl Fingerprint {
    pub(in crate::pipeline) fn new(task: &Task, inputs: Vec<Known>, without: Vec<String>) -> Self {
        let all = serde_json::json!({ "task": task.id, "keys": task.keys, "options": task.options, "inputs": inputs });
        let mut text = b"lunula task 1\n".to_vec();
        canonical(&all, &mut text);
        Self { key: ContentHash::of(&text), inputs, without }
    }
}

/// What is kept of a task.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(in crate::pipeline) struct Record {
    pub(in crate::pipeline) format: u32,
    pub(in crate::pipeline) task: TaskId,
    pub(in crate::pipeline) key: ContentHash,
    pub(in crate::pipeline) options: Value,
    pub(in crate::pipeline) inputs: Vec<Known>,
    pub(in crate::pipeline) without: Vec<String>,
    pub(in crate::pipeline) outputs: Vec<Output>,
    pub(in crate::pipeline) made: Made,
    /// How long it took, seconds.
    pub(in crate::pipeline) wall_s: f64,
    /// When it was done (UTC), for people.
    pub(in crate::pipeline) at: String,
    /// The version that did it, for people.
    pub(in crate::pipeline) lunula: String,
}

impl Record {
    /// What an input of this name in the task's folder holds: a file, or a folder of files (empty: all). `None`: there
    /// is none.
    pub(in crate::pipeline) fn content(&self, name: &str) -> Option<ContentHash> {
        if let Some(output) = self.outputs.iter().find(|output| output.name == name) {
            return Some(output.sha256);
        }
        let within = within(&self.outputs, name);
        (name.is_empty() || !within.is_empty())
            .then(|| of_names(within.iter().map(|(name, output)| (*name, output.sha256))))
    }
}

/// The outputs in a folder of the task's (empty: all), named from there.
pub(in crate::pipeline) fn within<'a>(outputs: &'a [Output], folder: &str) -> Vec<(&'a str, &'a Output)> {
    let rest = |name: &'a str| match folder {
        "" => Some(name),
        folder => name.strip_prefix(folder)?.strip_prefix('/'),
    };
    outputs.iter().filter_map(|output| Some((rest(&output.name)?, output))).collect()
}

impl Input {
    /// What results may call it: as the pipeline file names it, or `<task>/<name>`.
    #[must_use]
    pub fn name(&self) -> String {
        match &self.source {
            Source::Given { name, .. } => name.clone(),
            Source::Result { task, name } if name.is_empty() => task.clone(),
            Source::Result { task, name } => format!("{task}/{name}"),
        }
    }
}

/// JSON with the keys of objects sorted, whatever order they stand in.
pub(in crate::pipeline) fn canonical(value: &Value, into: &mut Vec<u8>) {
    match value {
        Value::Object(map) => {
            let mut keys: Vec<&String> = map.keys().collect();
            keys.sort_unstable();
            into.push(b'{');
            for key in keys {
                into.extend_from_slice(Value::from(key.as_str()).to_string().as_bytes());
                into.push(b':');
                canonical(&map[key], into);
                into.push(b',');
            }
            into.push(b'}');
        }
        Value::Array(items) => {
            into.push(b'[');
            for item in items {
                canonical(item, into);
                into.push(b',');
            }
            into.push(b']');
        }
        plain => into.extend_from_slice(plain.to_string().as_bytes()),
    }
}
