//! A run cut into parts: which tasks are a part's own, and the mark that a part leaves in its folder of results.
//!
//! Part `i` of `n` does the tasks of [`Share::Part`]`(k)` with `k % n == i - 1`, and those of [`Share::Each`] that they
//! need. Whatever needs tasks of several numbers is [`Share::Whole`], whatever it says itself; so is what needs such a
//! one. These are done when parts are merged.

use std::fmt;
use std::fs;
use std::path::Path;
use std::str::FromStr;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::files::{WriteError, write_whole};
use crate::pipeline::store::Store;
use crate::pipeline::store::hashes::ContentHash;
use crate::pipeline::store::record::canonical;
use crate::pipeline::tasks::graph::Graph;
use crate::pipeline::tasks::{Share, Task};

/// One part of a run that is cut into parts; written `2/7`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(try_from = "Numbers")]
pub struct Shard {
    index: usize,
    of: usize,
}

/// A part as a file has it, not checked.
#[derive(Deserialize)]
#[serde(rename = "Shard")]
struct Numbers {
    index: usize,
    of: usize,
}

impl TryFrom<Numbers> for Shard {
    type Error = ShardFault;

    fn try_from(Numbers { index, of }: Numbers) -> Result<Self, ShardFault> {
        Self::new(index, of).ok_or_else(|| ShardFault(format!("{index}/{of}")))
    }
}

/// Parts of a run, at most (assumed: clusters take arrays of up to 75 000 jobs, and those that are missing are listed).
const MOST: usize = 100_000;

/// What is no part.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{0:?}: a part is written I/N, from 1/N to N/N, N up to {MOST}: 2/7 is the second of seven")]
pub struct ShardFault(String);

impl Shard {
    /// Part `index`, from 1, of `of`; `None` where there is no such part.
    #[must_use]
    pub fn new(index: usize, of: usize) -> Option<Self> {
        (of <= MOST && (1..=of).contains(&index)).then_some(Self { index, of })
    }

    /// Which, from 1.
    #[must_use]
    pub fn index(self) -> usize {
        self.index
    }

    /// A task of this share is its own.
    pub(in crate::pipeline) fn does(self, share: Share) -> bool {
        matches!(share, Share::Part(number) if number % self.of == self.index - 1)
    }

    /// Of how many.
    #[must_use]
    pub fn of(self) -> usize {
        self.of
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.of)
    }
}

impl FromStr for Shard {
    type Err = ShardFault;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let shard = text.split_once('/').and_then(|(index, of)| Self::new(index.parse().ok()?, of.parse().ok()?));
        shard.ok_or_else(|| ShardFault(text.to_owned()))
    }
}

/// What decides what a pipeline makes; parts of one run must agree on it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct PipelineMark {
    /// The pipeline's name, for people.
    pub name: String,
    /// The hash of what the file says.
    pub decides: ContentHash,
    /// Where the pipeline file is, as it was given.
    pub path: String,
    /// What it says.
    pub text: String,
}

impl PipelineMark {
    /// Of the text of a pipeline file that stands at `path`; comments and the order of keys decide nothing.
    #[must_use]
    pub fn new(path: &Path, text: &str) -> Self {
        let table: toml::Table = text.parse().unwrap_or_default();
        let mut decides = Vec::new();
        match serde_json::to_value(&table) {
            Ok(said) if !table.is_empty() => canonical(&said, &mut decides),
            _ => decides.extend_from_slice(text.as_bytes()),
        }
        let stem = || path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        Self {
            name: table.get("name").and_then(|name| name.as_str()).map_or_else(stem, str::to_owned),
            decides: ContentHash::of(&decides),
            path: path.to_string_lossy().into_owned(),
            text: text.to_owned(),
        }
    }
}

/// What a part leaves in its folder of results.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct PartMark {
    /// Which part it is.
    pub shard: Shard,
    /// Of which pipeline.
    pub pipeline: PipelineMark,
    /// The version that made it.
    pub lunula: String,
    /// The hash of the list of tasks: names, options, inputs by name, shares.
    pub tasks: ContentHash,
}

impl PartMark {
    pub(in crate::pipeline) fn new(shard: Shard, pipeline: &PipelineMark, tasks: &[Task]) -> Self {
        Self { shard, pipeline: pipeline.clone(), lunula: env!("CARGO_PKG_VERSION").into(), tasks: hash_of(tasks) }
    }

    /// The mark of a folder, if it has one that can be read.
    pub(in crate::pipeline) fn of(store: &Store) -> Option<Self> {
        serde_json::from_slice(&fs::read(store.mark()).ok()?).ok()
    }

    pub(in crate::pipeline) fn write(&self, store: &Store) -> Result<(), WriteError> {
        let refused = |why: serde_json::Error| WriteError::File { path: store.mark(), why: why.to_string() };
        write_whole(&store.mark(), &serde_json::to_vec(self).map_err(refused)?)
    }
}

/// What the tasks are, without what their inputs hold.
pub(in crate::pipeline) fn hash_of(tasks: &[Task]) -> ContentHash {
    let mut text = Vec::new();
    for task in tasks {
        let inputs: Vec<_> =
            task.inputs.iter().map(|input| (input.role, &input.keys, input.name(), input.may_fail)).collect();
        let share = match task.share {
            Share::Part(number) => serde_json::json!(number),
            Share::Each => "each".into(),
            Share::Whole => "whole".into(),
        };
        canonical(&serde_json::json!([task.id, task.options, inputs, share]), &mut text);
    }
    ContentHash::of(&text)
}

/// The shares of tasks, where what needs several parts is the whole's.
pub(in crate::pipeline) fn shares(tasks: &[Task], graph: &Graph) -> Vec<Share> {
    let mut shares: Vec<Share> = tasks.iter().map(|task| task.share).collect();
    for &at in &graph.order {
        let fits = |needed: &usize| match (shares[at], shares[*needed]) {
            (Share::Whole, _) | (_, Share::Each) => true,
            (Share::Part(own), Share::Part(other)) => own == other,
            (Share::Each, Share::Part(_)) | (_, Share::Whole) => false,
        };
        if !graph.needs[at].iter().all(fits) {
            shares[at] = Share::Whole;
        }
    }
    shares
}

/// Which tasks a part does; all of them where there are no parts.
pub(in crate::pipeline) fn chosen(tasks: &[Task], graph: &Graph, shard: Option<Shard>) -> Vec<bool> {
    let Some(shard) = shard else { return vec![true; tasks.len()] };
    let shares = shares(tasks, graph);
    let mut chosen: Vec<bool> = shares.iter().map(|share| shard.does(*share)).collect();
    for &at in graph.order.iter().rev() {
        if chosen[at] {
            graph.needs[at].iter().for_each(|&needed| chosen[needed] = true);
        }
    }
    chosen
}
