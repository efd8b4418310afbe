//! Where things stand in a folder of results.
//!
//! `OUT/<task>/` holds what a task made and nothing else. All else is under `OUT/.lunula/`, which may be thrown away
//! (then all is made again):
//! - `records/*.json`: one file a task that was done, renamed into its place whole, so that there are no halves
//!   whenever the power goes
//! - `failures/*.json`: one file a task that failed when it was tried last
//! - `work/`: a folder for each task at work; what a run that was killed left there is finished or removed by the next
//! - `hashes`: which files hold what, so as not to read them again
//! - `lock`: who works here
//! - `part.json`: which part of a run cut into parts this is

pub(super) mod commit;
pub(super) mod hashes;
pub(super) mod lock;
pub(super) mod record;
pub(super) mod standing;

use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::files::{clear_leftovers, write_whole};
use crate::pipeline::tasks::{Task, TaskId};
use hashes::ContentHash;
use record::{FORMAT, Record};

/// What a run did, for scripts, in the folder of results, ..
pub(super) const REPORT: &str = "run.json";
/// .. and for people.
pub(super) const PAGE: &str = "report.html";

/// A task that failed when it was tried last.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct FailureNote {
    pub(super) task: TaskId,
    pub(super) what: String,
}

/// The places in a folder of results.
#[derive(Debug, Clone)]
pub(super) struct Store {
    pub(super) out: PathBuf,
    home: PathBuf,
}

impl Store {
    pub(super) fn new(out: &Path) -> Self {
        Self { out: out.to_owned(), home: out.join(".lunula") }
    }

    /// Makes the folders.
    pub(super) fn create(&self) -> io::Result<()> {
        [self.records(), self.failures(), self.work()].iter().try_for_each(fs::create_dir_all)
    }

    /// Removes what killed runs left, as far as it is not [`Store::work`]'s.
    pub(super) fn clear(&self) {
        [&self.out, &self.home, &self.records(), &self.failures()]
            .into_iter()
            .for_each(|folder| clear_leftovers(folder));
    }

    pub(super) fn hashes(&self) -> PathBuf {
        self.home.join("hashes")
    }

    pub(super) fn lock(&self) -> PathBuf {
        self.home.join("lock")
    }

    pub(super) fn mark(&self) -> PathBuf {
        self.home.join("part.json")
    }

    pub(super) fn work(&self) -> PathBuf {
        self.home.join("work")
    }

    fn records(&self) -> PathBuf {
        self.home.join("records")
    }

    fn failures(&self) -> PathBuf {
        self.home.join("failures")
    }

    /// The folder of a task's results.
    pub(super) fn folder(&self, id: &str) -> PathBuf {
        self.out.join(id)
    }

    /// Where a task's record stands, if there is one.
    pub(super) fn record_place(&self, id: &str) -> PathBuf {
        self.records().join(file_name(id))
    }

    /// What is kept of a task; what can't be read is as if it were not there.
    pub(super) fn record(&self, id: &str) -> Option<Record> {
        read_record(&self.record_place(id)).filter(|record| record.task == id)
    }

    /// Why a task failed when it was tried last.
    pub(super) fn failure(&self, id: &str) -> Option<FailureNote> {
        let text = fs::read(self.failures().join(file_name(id))).ok()?;
        serde_json::from_slice(&text).ok().filter(|note: &FailureNote| note.task == id)
    }

    /// Keeps why a task failed. Where there is no room for it, the next run just tries again.
    pub(super) fn keep_failure(&self, note: &FailureNote) {
        if let Ok(text) = serde_json::to_vec(note) {
            let _ = write_whole(&self.failures().join(file_name(&note.task)), &text);
        }
    }

    pub(super) fn forget_failure(&self, id: &str) {
        // Most never failed.
        let _ = fs::remove_file(self.failures().join(file_name(id)));
    }

    /// Records of tasks that are not among these: a pipeline's of before.
    pub(super) fn strays(&self, tasks: &[Task]) -> Vec<Record> {
        let mut strays = names(&self.records());
        tasks.iter().for_each(|task| {
            strays.remove(&file_name(&task.id));
        });
        strays.iter().filter_map(|name| read_record(&self.records().join(name))).collect()
    }
}

/// What a run of lunula put into a folder of results.
#[derive(Debug, Default, PartialEq, Eq)]
pub(super) struct MadeBefore {
    /// The folders of its tasks, relative to the results' folder, with `/`.
    pub(super) tasks: BTreeSet<String>,
}

impl MadeBefore {
    /// By the records that are kept there, and where these were thrown away by the report of the run.
    pub(super) fn of(out: &Path) -> Self {
        let mut tasks: BTreeSet<String> = Store::new(out).strays(&[]).into_iter().map(|record| record.task).collect();
        let report = fs::read(out.join(REPORT)).ok().and_then(|text| serde_json::from_slice::<Value>(&text).ok());
        let reported = report.as_ref().and_then(|report| report["tasks"].as_array()).into_iter().flatten();
        tasks.extend(reported.filter_map(|task| task["task"].as_str()).map(str::to_owned));
        Self { tasks }
    }

    /// Whether a file or a folder, named from the results' folder, with `/`, is one of these results, or holds some.
    pub(super) fn holds(&self, path: &str) -> bool {
        let mut above = std::iter::successors(Some(path), |path| path.rsplit_once('/').map(|(above, _)| above));
        let holds = |task: &String| task.strip_prefix(path).is_some_and(|rest| rest.starts_with('/'));
        [REPORT, PAGE].contains(&path) || above.any(|above| self.tasks.contains(above)) || self.tasks.iter().any(holds)
    }
}

/// The file's name of a task's record: unlike any other's, on file systems that know no case too, and easy to read.
pub(super) fn file_name(id: &str) -> String {
    let seen: String =
        id.chars().map(|c| if c.is_ascii_alphanumeric() || "-_.".contains(c) { c } else { '~' }).take(80).collect();
    let hash = ContentHash::of(id.as_bytes()).to_string();
    format!("{seen}.{}.json", &hash[..16])
}

pub(super) fn read_record(place: &Path) -> Option<Record> {
    let value: Value = serde_json::from_slice(&fs::read(place).ok()?).ok()?;
    if value.get("format")?.as_u64()? != u64::from(FORMAT) {
        return None;
    }
    serde_json::from_value(value).ok()
}

fn names(folder: &Path) -> BTreeSet<String> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    entries.filter_map(|entry| entry.file_name().into_string().ok()).filter(|name| name.ends_with(".json")).collect()
}
