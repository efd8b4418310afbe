//! What the generated recordings of a pipeline file will be: known before a file of them stands, so that stages can be
//! planned on them.
//!
//! A catalogue depends on the options of `[phantom]` alone. Its names are relative to the folder that a pipeline file
//! calls `{phantom}`, with `/`.

use crate::job::{Facts, Keys, Maker};
use std::collections::BTreeMap;
use std::sync::Arc;

/// What will be generated.
pub struct Catalogue {
    /// What makes the files. A task's folder is `{phantom}/` and its name; no name is another's beginning up to a `/`.
    pub tasks: Vec<CatalogueTask>,
    /// Every file that inputs may name, sorted by path.
    pub files: Vec<CatalogueFile>,
    /// The text of the tables of sessions, by path: they are also among the files.
    pub tables: BTreeMap<String, String>,
}

/// What makes some of the files.
pub struct CatalogueTask {
    /// Its name, which is its folder: `videos/S01`.
    pub name: String,
    /// Whose it is.
    pub keys: Keys,
    /// All that its result depends on: the kind's name, its revision and its options.
    pub options: serde_json::Value,
    /// About how much memory it takes, bytes.
    pub memory: u64,
    /// About how long it takes on one thread, seconds.
    pub cost_s: f64,
    /// Makes it.
    pub job: Arc<dyn Maker>,
}

/// One file of them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CatalogueFile {
    /// Its place: the task's name, then its name in the task's folder: `videos/S01/bending.mp4`.
    pub path: String,
    /// Which of the tasks makes it, by position.
    pub task: usize,
    /// What is known of it.
    pub facts: Facts,
}
