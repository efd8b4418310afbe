//! Parts of a run that was cut become one folder of results, as if it had been made at once.
//!
//! In: folders that `--shard i/n` runs wrote, and the tasks, planned again. Every part must be there once, be of the
//! same pipeline, options and version, and have come to an end. Their results and records are linked (or copied) into
//! the folder; then a run does there what no part could, and whatever inputs have changed since: that is shown by the
//! tasks' keys, not by times.

use std::fs;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::files::is_same_file;
use crate::pipeline::parts::shard::{PartMark, PipelineMark, hash_of, shares};
use crate::pipeline::run::{Results, RunFault, link, said};
use crate::pipeline::store::Store;
use crate::pipeline::store::commit::{commit, files};
use crate::pipeline::store::hashes::Hashes;
use crate::pipeline::store::lock::{Holder, Refused, share};
use crate::pipeline::store::record::Record;
use crate::pipeline::store::standing::{Why, spoilt};
use crate::pipeline::tasks::graph::{Graph, GraphFault};
use crate::pipeline::tasks::{Share, Task, TaskId};

/// How many names an error lists.
const NAMED: usize = 5;

/// Why parts can't be merged; nothing was written.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum MergeFault {
    #[error(
        "{}: is no part of a run; make it with lunula run PIPELINE --shard I/N --out {}",
        .0.display(), .0.display()
    )]
    NoPart(PathBuf),
    #[error("{}: a run works here ({}); wait for it", .path.display(), said(.holder.as_ref()))]
    Busy { path: PathBuf, holder: Option<Holder> },
    #[error("{} and {}: both are part {part}; give each part once", .one.display(), .other.display())]
    Twice { part: String, one: PathBuf, other: PathBuf },
    #[error(
        "{}: of {of} parts {} is missing; run it with --shard, or give its folder too",
        .missing.join(", "), if .missing.len() == 1 { "this" } else { "each of these" }
    )]
    Gap {
        /// Which, as `2/7`.
        missing: Vec<String>,
        of: usize,
    },
    #[error(
        "{} and {}: are parts of different runs: {what}; run one of them again as the other",
        .one.display(), .other.display()
    )]
    Differ { one: PathBuf, other: PathBuf, what: String },
    #[error("{}: the parts were made by another pipeline than {pipeline} is now: {what}; run the parts again, or give \
             theirs with --pipeline", .part.display())]
    Pipeline { part: PathBuf, pipeline: String, what: String },
    #[error("{}: did not come to its end: {}; run it again with --shard {part}", .path.display(), listed(.missing))]
    Unfinished { path: PathBuf, part: String, missing: Vec<TaskId> },
    #[error(
        "{task}: came out differently in {} and in {}; remove it from one of them and run that part again",
        .one.display(), .other.display()
    )]
    Overlap { task: TaskId, one: PathBuf, other: PathBuf },
    #[error("{}: {what} since it was made; run part {part} again", .path.display())]
    Spoilt {
        path: PathBuf,
        /// `was edited by hand` or `was deleted`.
        what: &'static str,
        part: String,
    },
    #[error("{}: is one of the parts; choose another --out", .0.display())]
    IntoPart(PathBuf),
    #[error(transparent)]
    Tasks(#[from] GraphFault),
    #[error(transparent)]
    Run(#[from] RunFault),
    /// A result can't be brought to its place; those before it were.
    #[error("{task}: {why}")]
    Put { task: TaskId, why: String },
}

fn listed(tasks: &[TaskId]) -> String {
    let named = tasks.iter().take(NAMED).cloned().collect::<Vec<_>>().join(", ");
    let more = tasks.len().saturating_sub(NAMED);
    if more == 0 { format!("{named} not done") } else { format!("{named} and {more} more not done") }
}

/// What was brought together.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Merged {
    /// Tasks whose results came from parts.
    pub imported: usize,
    /// Tasks whose results stood already, from an earlier merge.
    pub stood: usize,
    /// What a user should know.
    pub warnings: Vec<String>,
}

#[derive(Debug)]
struct Part {
    path: PathBuf,
    store: Store,
    hashes: Hashes,
    mark: PartMark,
    _shared: Option<File>,
}

/// All parts of one run; nobody works in them as long as this lives.
#[derive(Debug)]
pub struct Parts(Vec<Part>);

impl Parts {
    /// Opens the folders of parts, in any order; nothing is written to them.
    ///
    /// # Errors
    /// [`MergeFault`] where one is no part, is worked in, is there twice or missing, or where they are of different
    /// runs.
    pub fn open(paths: &[PathBuf]) -> Result<Self, MergeFault> {
        let mut parts = paths.iter().map(|path| Part::open(path)).collect::<Result<Vec<_>, _>>()?;
        parts.sort_by_key(|part| part.mark.shard.index());
        for pair in parts.windows(2) {
            let [one, other] = pair else { continue };
            let differ = |what: String| MergeFault::Differ { one: one.path.clone(), other: other.path.clone(), what };
            let (a, b) = (&one.mark, &other.mark);
            if a.shard.of() != b.shard.of() {
                return Err(differ(format!("part {} and part {}", a.shard, b.shard)));
            }
            if let Some(what) = difference(a, &b.pipeline, b.lunula.as_str()) {
                return Err(differ(what));
            }
            if a.shard == b.shard {
                let part = a.shard.to_string();
                return Err(MergeFault::Twice { part, one: one.path.clone(), other: other.path.clone() });
            }
            if a.tasks != b.tasks {
                return Err(differ("their inputs' lists are not the same".into()));
            }
        }
        let of = parts.first().map_or(0, |part| part.mark.shard.of());
        let there = |index: usize| parts.iter().any(|part| part.mark.shard.index() == index);
        let missing: Vec<String> =
            (1..=of).filter(|&index| !there(index)).map(|index| format!("{index}/{of}")).collect();
        if !missing.is_empty() {
            return Err(MergeFault::Gap { missing, of });
        }
        Ok(Self(parts))
    }

    /// The pipeline that the parts were made by; `None` of no parts.
    #[must_use]
    pub fn pipeline(&self) -> Option<&PipelineMark> {
        self.0.first().map(|part| &part.mark.pipeline)
    }

    /// Checks that the parts have done what was theirs of these tasks, then brings it into `out`, which may hold an
    /// earlier merge. What no part does is left for [`Results::run`].
    ///
    /// # Errors
    /// [`MergeFault`]; except for [`MergeFault::Put`], nothing was written.
    pub fn merge(&self, tasks: &[Task], pipeline: &PipelineMark, out: &Path) -> Result<(Results, Merged), MergeFault> {
        let graph = Graph::new(tasks)?;
        for part in &self.0 {
            let fault = |what| MergeFault::Pipeline { part: part.path.clone(), pipeline: pipeline.path.clone(), what };
            if let Some(what) = difference(&part.mark, pipeline, env!("CARGO_PKG_VERSION")) {
                return Err(fault(what));
            }
            if part.mark.tasks != hash_of(tasks) {
                return Err(fault("its inputs' list is not the same".into()));
            }
            if is_same_file(&part.path, out) {
                return Err(MergeFault::IntoPart(out.to_owned()));
            }
        }
        let shares = shares(tasks, &graph);
        let looked: Vec<Vec<Looked>> = self.0.iter().map(|part| part.look(tasks, &graph)).collect();
        for (part, looked) in self.0.iter().zip(&looked) {
            let own = |at: &usize| part.mark.shard.does(shares[*at]) && matches!(looked[*at], Looked::Nothing);
            let missing: Vec<TaskId> = (0..tasks.len()).filter(own).map(|at| tasks[at].id.clone()).collect();
            if !missing.is_empty() {
                return Err(MergeFault::Unfinished {
                    path: part.path.clone(),
                    part: part.mark.shard.to_string(),
                    missing,
                });
            }
        }
        let chosen = self.choose(tasks, &shares, &looked)?;
        chosen.par_iter().try_for_each(|(part, record)| part.check(record))?;
        let results = Results::open(out)?;
        self.0.iter().for_each(|part| results.hashes.learn(&part.store.hashes()));
        let brought: Vec<Option<Vec<String>>> = chosen
            .par_iter()
            .map(|(part, record)| {
                part.bring(record, &results).map_err(|why| MergeFault::Put { task: record.task.clone(), why })
            })
            .collect::<Result<_, _>>()?;
        let mut merged = Merged::default();
        for warnings in brought {
            match warnings {
                Some(warnings) => {
                    merged.imported += 1;
                    merged.warnings.extend(warnings);
                }
                None => merged.stood += 1,
            }
        }
        Ok((results, merged))
    }

    /// Which part each task's result is taken from: its own, or the first that has it where each may. No two may have
    /// made different ones.
    fn choose<'a>(
        &'a self,
        tasks: &[Task],
        shares: &[Share],
        looked: &'a [Vec<Looked>],
    ) -> Result<Vec<(&'a Part, &'a Record)>, MergeFault> {
        let mut chosen = Vec::new();
        for (at, task) in tasks.iter().enumerate() {
            let mut there = self.0.iter().zip(looked).filter_map(|(part, looked)| match &looked[at] {
                Looked::Done(record) => Some((part, &**record)),
                Looked::Failed | Looked::Nothing => None,
            });
            let there: Vec<_> = there.by_ref().collect();
            for pair in there.windows(2) {
                let [(one, first), (other, second)] = pair else { continue };
                if first.outputs != second.outputs {
                    let (one, other) = (one.path.clone(), other.path.clone());
                    return Err(MergeFault::Overlap { task: task.id.clone(), one, other });
                }
            }
            let owner = there.iter().find(|(part, _)| part.mark.shard.does(shares[at]));
            let any = there.first().filter(|_| shares[at] == Share::Each);
            chosen.extend(owner.or(any).copied());
        }
        Ok(chosen)
    }
}

fn difference(mark: &PartMark, pipeline: &PipelineMark, lunula: &str) -> Option<String> {
    if mark.lunula != lunula {
        return Some(format!("one by lunula {}, one by {lunula}", mark.lunula));
    }
    if mark.pipeline.decides == pipeline.decides {
        return None;
    }
    // Comments decide nothing.
    let decides = |(_, line): &(usize, &str)| !line.trim_start().starts_with('#') && !line.trim().is_empty();
    let [mut one, mut other] =
        [&mark.pipeline.text, &pipeline.text].map(|text| (1..).zip(text.lines()).filter(decides));
    loop {
        let (a, b) = (one.next(), other.next());
        let [line, ..] = [a, b].into_iter().flatten().map(|(line, _)| line).collect::<Vec<usize>>()[..] else {
            return Some("their options are not the same".into());
        };
        let [a, b] = [a, b].map(|of| of.map_or_else(|| "nothing".into(), |(_, text)| format!("{text:?}")));
        if a != b {
            return Some(format!("line {line} says {a} and {b}"));
        }
    }
}

/// What a part has of a task.
enum Looked {
    Done(Box<Record>),
    /// It was tried, or what it needs was.
    Failed,
    Nothing,
}

impl Part {
    fn open(path: &Path) -> Result<Self, MergeFault> {
        let store = Store::new(path);
        let mark = PartMark::of(&store).ok_or_else(|| MergeFault::NoPart(path.to_owned()))?;
        let shared = share(&store.lock()).map_err(|refused| match refused {
            Refused::Held(holder) => MergeFault::Busy { path: path.to_owned(), holder },
            Refused::Io(_) => MergeFault::NoPart(path.to_owned()),
        })?;
        let hashes = Hashes::look(&store.hashes());
        Ok(Self { path: path.to_owned(), store, hashes, mark, _shared: shared })
    }

    fn look(&self, tasks: &[Task], graph: &Graph) -> Vec<Looked> {
        let mut looked: Vec<Looked> = tasks
            .par_iter()
            .map(|task| match (self.store.failure(&task.id), self.store.record(&task.id)) {
                (Some(_), _) => Looked::Failed,
                (None, Some(record)) => Looked::Done(Box::new(record)),
                (None, None) => Looked::Nothing,
            })
            .collect();
        for &at in &graph.order {
            let failed = |needed: &usize| matches!(looked[*needed], Looked::Failed);
            if matches!(looked[at], Looked::Nothing) && graph.needs[at].iter().any(failed) {
                looked[at] = Looked::Failed;
            }
        }
        looked
    }

    fn check(&self, record: &Record) -> Result<(), MergeFault> {
        let (name, what) = match spoilt(record, &self.store.folder(&record.task), &self.hashes) {
            Some(Why::Edited(name)) => (name, "was edited by hand"),
            Some(Why::Deleted(name)) => (name, "was deleted"),
            _ => return Ok(()),
        };
        let path = self.store.folder(&record.task).join(name);
        Err(MergeFault::Spoilt { path, what, part: self.mark.shard.to_string() })
    }

    /// Brings a task's results into the folder; `None` where they stand there.
    fn bring(&self, record: &Record, into: &Results) -> Result<Option<Vec<String>>, String> {
        let there =
            into.store.record(&record.task).filter(|there| there.key == record.key && there.outputs == record.outputs);
        if there.is_some_and(|there| spoilt(&there, &into.store.folder(&there.task), &into.hashes).is_none()) {
            return Ok(None);
        }
        let work = into.work_folder();
        let io = |why: io::Error| format!("{}: {why}", work.display());
        for output in &record.outputs {
            let to = files(&work).join(&output.name);
            fs::create_dir_all(to.parent().unwrap_or(&work)).map_err(io)?;
            link(&self.store.folder(&record.task).join(&output.name), &to).map_err(io)?;
        }
        fs::create_dir_all(&work).map_err(io)?;
        let warnings = commit(&into.store, &into.hashes, &work, record).map_err(|why| why.to_string())?;
        // What can't be removed now, the next run removes.
        let _ = fs::remove_dir_all(&work);
        Ok(Some(warnings))
    }
}
