//! One task: whether it stands, and if not, one attempt at it.

use std::any::Any;
use std::collections::HashMap;
use std::fs;
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use jiff::Timestamp;

use super::Results;
use crate::job::{At, Work};
use crate::pipeline::spec::said::{in_keys, made_in_keys};
use crate::pipeline::store::commit::{CommitFault, commit, files, is_kept_aside, outputs, retire};
use crate::pipeline::store::hashes::{FileFault, files_in};
use crate::pipeline::store::record::{FORMAT, Fingerprint, Known, Record, within};
use crate::pipeline::store::standing::{Why, difference, spoilt};
use crate::pipeline::tasks::graph::above;
use crate::pipeline::tasks::{Input, Source, Task, TaskId};

/// The records of the tasks that one works on, without those that failed.
pub(super) type Needed = HashMap<TaskId, Arc<Record>>;

/// What one task's attempt needs of the run around it.
pub(super) struct Bench<'a> {
    pub(super) results: &'a Results,
    /// Records of tasks that the pipeline has no more.
    pub(super) strays: &'a [Record],
    /// Held by whoever removes one of them.
    pub(super) retiring: Mutex<()>,
}

/// A task that is to be done.
pub(super) struct Due {
    pub(super) why: Why,
    fingerprint: Fingerprint,
    /// Its inputs, those that are there.
    inputs: Vec<usize>,
    /// The records of the tasks whose results it works on.
    needed: Needed,
    /// The results before are there as they were made, by the same options.
    stands: bool,
}

/// Whether a task is up to date, due or failed.
pub(super) enum TaskState {
    /// Its results are up to date; with warnings for the user.
    Kept(Box<Record>, Vec<String>),
    Due(Box<Due>),
    Failed(String),
}

/// Why a task has no result.
pub(super) enum Miss {
    Failed(String),
    Stopped,
}

impl Bench<'_> {
    /// Whether a task stands.
    pub(super) fn find(&self, task: &Task, needed: Needed) -> TaskState {
        let mut inputs = Vec::new();
        let mut known = Vec::new();
        let mut without = Vec::new();
        for (at, input) in task.inputs.iter().enumerate() {
            let hash = match &input.source {
                Source::Given { path, .. } => match self.results.hashes.of_given(path) {
                    Ok(hash) => hash,
                    Err(why) => return TaskState::Failed(why.to_string()),
                },
                Source::Result { task: maker, name } => match needed.get(maker) {
                    None => {
                        without.push(input.name());
                        continue;
                    }
                    Some(record) => match record.content(name) {
                        Some(hash) => hash,
                        None => return TaskState::Failed(format!("{maker} made no {name}")),
                    },
                },
            };
            inputs.push(at);
            known.push(Known::new(input, hash));
        }
        if let Some(role) = emptied(task, &inputs) {
            return TaskState::Failed(format!("nothing to work on: all of its {role} failed"));
        }
        let fingerprint = Fingerprint::new(task, known, without);
        let folder = self.results.store.folder(&task.id);
        let Some(record) = self.results.store.record(&task.id) else {
            let why = self.results.store.failure(&task.id).map_or(Why::NeverMade, |note| Why::Failed(note.what));
            return TaskState::Due(Box::new(Due { why, fingerprint, inputs, needed, stands: false }));
        };
        let spoilt = spoilt(&record, &folder, &self.results.hashes);
        let stands = spoilt.is_none() && record.options == task.options;
        match difference(&record, task, &fingerprint, false).or(spoilt) {
            Some(why) => TaskState::Due(Box::new(Due { why, fingerprint, inputs, needed, stands })),
            None => {
                // It may have failed since, on other inputs.
                self.results.store.forget_failure(&task.id);
                let warnings = self.foreign(&folder, &record);
                TaskState::Kept(Box::new(record), warnings)
            }
        }
    }

    /// Does a task in the folder `work`, which is empty or not made yet before and after, or another; what a user
    /// should know comes with the record.
    pub(super) fn attempt(
        &self,
        work: &mut PathBuf,
        task: &Task,
        due: Due,
        threads: usize,
        stop: &AtomicBool,
    ) -> Result<(Record, Vec<String>), Miss> {
        let outcome = self.attempt_in(work, task, due, threads, stop);
        clean(work);
        if fs::read_dir(&*work).is_ok_and(|mut left| left.next().is_some()) {
            // What can't be put in its place or removed now, the next run finishes or removes.
            *work = self.results.work_folder();
        }
        outcome
    }

    fn attempt_in(
        &self,
        work: &Path,
        task: &Task,
        due: Due,
        threads: usize,
        stop: &AtomicBool,
    ) -> Result<(Record, Vec<String>), Miss> {
        let start = Instant::now();
        let failed = |what: String| Miss::Failed(what);
        let folder = files(work);
        fs::create_dir_all(&folder).map_err(|why| failed(cannot(&folder, &why)))?;
        let mut at = Vec::with_capacity(due.inputs.len());
        for &position in &due.inputs {
            let input = &task.inputs[position];
            let path = self.place(work, position, input, &due.needed).map_err(failed)?;
            at.push(At { role: input.role, keys: input.keys.clone(), path, name: input.name() });
        }
        let before = self.results.store.folder(&task.id);
        let work_given =
            Work { inputs: at, folder: &folder, before: due.stands.then_some(before.as_path()), threads, stop };
        let made = match catch_unwind(AssertUnwindSafe(|| task.job.run(&work_given))) {
            Ok(Ok(mut made)) => {
                made_in_keys(&mut made);
                made
            }
            Ok(Err(_)) if stop.load(Ordering::Relaxed) => return Err(Miss::Stopped),
            Ok(Err(why)) => return Err(Miss::Failed(with_advice(in_keys(&format!("{why:#}")), is_full(&why)))),
            Err(panic) => return Err(Miss::Failed(format!("the program has a fault here: {}", words(&*panic)))),
        };
        let outputs = outputs(work, &self.results.hashes).map_err(|why| Miss::Failed(why.to_string()))?;
        self.unchanged(task, &due).map_err(Miss::Failed)?;
        let record = Record {
            format: FORMAT,
            task: task.id.clone(),
            key: due.fingerprint.key,
            options: task.options.clone(),
            inputs: due.fingerprint.inputs,
            without: due.fingerprint.without,
            outputs,
            made,
            wall_s: start.elapsed().as_secs_f64(),
            at: Timestamp::now().to_string(),
            lunula: env!("CARGO_PKG_VERSION").to_owned(),
        };
        let failed = |why: CommitFault| failed(with_advice(why.to_string(), is_full_text(&why.to_string())));
        let mut warnings = self.make_room(&task.id).map_err(failed)?;
        warnings.extend(commit(&self.results.store, &self.results.hashes, work, &record).map_err(failed)?);
        warnings.extend(self.foreign(&before, &record));
        Ok((record, warnings))
    }

    /// Removes results of tasks of before that this one's place lies in, or that lie in its.
    fn make_room(&self, id: &str) -> Result<Vec<String>, CommitFault> {
        let mut warnings = Vec::new();
        for stray in self.strays.iter().filter(|stray| in_the_way(&stray.task, id)) {
            let _one_at_a_time = self.retiring.lock().unwrap_or_else(PoisonError::into_inner);
            // Another task may have done it, and may have put its own there.
            if self.results.store.record_place(&stray.task).exists() {
                warnings.extend(retire(&self.results.store, &self.results.hashes, stray)?);
            }
        }
        Ok(warnings)
    }

    /// Where an input stands. A folder of results that holds something else too is shown without that.
    fn place(&self, work: &Path, position: usize, input: &Input, needed: &Needed) -> Result<PathBuf, String> {
        let (task, name) = match &input.source {
            Source::Given { path, .. } => return Ok(path.clone()),
            Source::Result { task, name } => (task, name),
        };
        let folder = self.results.store.folder(task);
        let path = if name.is_empty() { folder } else { folder.join(name) };
        if !path.is_dir() {
            return Ok(path);
        }
        let record = needed.get(task).ok_or_else(|| format!("{task} has no record"))?;
        let own = within(&record.outputs, name);
        let found = files_in(&path).map_err(|why| why.to_string())?;
        if found.len() == own.len() {
            return Ok(path);
        }
        let view = work.join(format!("input-{position}"));
        for (name, _) in own {
            let (from, to) = (path.join(name), view.join(name));
            let parent = to.parent().unwrap_or(&view);
            fs::create_dir_all(parent).and_then(|()| link(&from, &to)).map_err(|why| cannot(&to, &why))?;
        }
        Ok(view)
    }

    /// The given files hold what they held before the job read them.
    fn unchanged(&self, task: &Task, due: &Due) -> Result<(), String> {
        for (&position, known) in due.inputs.iter().zip(&due.fingerprint.inputs) {
            let Source::Given { path, .. } = &task.inputs[position].source else { continue };
            if self.results.hashes.of_given(path).map_err(|why| why.to_string())? != known.sha256 {
                return Err(FileFault::Changing(path.clone()).to_string());
            }
        }
        Ok(())
    }

    /// Files in a task's folder that are none of its results.
    fn foreign(&self, folder: &Path, record: &Record) -> Vec<String> {
        let Ok(found) = files_in(folder) else { return Vec::new() };
        if found.len() == record.outputs.len() {
            return Vec::new();
        }
        let ours = |name: &String| record.outputs.iter().any(|output| output.name == *name) || is_kept_aside(name);
        let foreign = found.iter().filter(|name| !ours(name));
        foreign
            .map(|name| format!("{}: is none of the results here; it is left", folder.join(name).display()))
            .collect()
    }
}

/// Removes what a task left in its folder, unless its record stands there: then it is to be put in its place yet.
pub(super) fn clean(work: &Path) {
    if work.join("record.json").exists() {
        return;
    }
    for entry in fs::read_dir(work).into_iter().flatten().flatten() {
        let path = entry.path();
        let is_dir = entry.file_type().is_ok_and(|kind| kind.is_dir());
        // What can't be removed shows by its being there.
        let _ = if is_dir { fs::remove_dir_all(&path) } else { fs::remove_file(&path) };
    }
}

/// A role whose inputs all failed, if there is one.
fn emptied<'t>(task: &'t Task, there: &[usize]) -> Option<&'t str> {
    let roles = task.inputs.iter().map(|input| input.role);
    roles.into_iter().find(|role| !there.iter().any(|&at| task.inputs[at].role == *role))
}

fn in_the_way(stray: &str, id: &str) -> bool {
    above(id).any(|outer| outer == stray) || above(stray).any(|outer| outer == id)
}

/// The same file under another name: as a link where that can be, else as a copy.
pub(in super::super) fn link(from: &Path, to: &Path) -> io::Result<()> {
    fs::hard_link(from, to).or_else(|_| fs::copy(from, to).map(|_| ()))
}

fn words(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<String>().map(String::as_str).or_else(|| panic.downcast_ref::<&str>().copied());
    text.unwrap_or("it said nothing").to_owned()
}

fn cannot(path: &Path, why: &io::Error) -> String {
    with_advice(format!("{}: cannot be written ({why})", path.display()), is_full_kind(why.kind()))
}

fn with_advice(what: String, full: bool) -> String {
    if full { format!("{what}; there is no room: make some, then run again, and what is done stands") } else { what }
}

fn is_full_kind(kind: io::ErrorKind) -> bool {
    matches!(kind, io::ErrorKind::StorageFull | io::ErrorKind::FileTooLarge | io::ErrorKind::QuotaExceeded)
}

/// Jobs tell of the disk in the system's words, some as text only.
fn is_full(why: &anyhow::Error) -> bool {
    let disk_full =
        why.chain().filter_map(|cause| cause.downcast_ref::<io::Error>()).any(|cause| is_full_kind(cause.kind()));
    disk_full || is_full_text(&format!("{why:#}"))
}

fn is_full_text(text: &str) -> bool {
    [28, 27, 122].iter().any(|number| text.contains(&format!("os error {number})")))
        || text.contains("No space left on device")
}
