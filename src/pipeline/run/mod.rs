//! Brings a folder of results up to date: does what does not stand, several tasks at a time, and nothing twice.
//!
//! A task that fails, or panics, fails what needs it and nothing else. Each task's results appear whole or not at all,
//! and a run that is killed at whatever moment loses only what was under way. The bytes of results hang on tasks and
//! inputs alone, not on threads, memory or order.

mod attempt;
mod queue;
mod report;

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use thiserror::Error;

use crate::files::WriteError;
use crate::pipeline::parts::shard::{PartMark, PipelineMark, Shard, chosen};
use crate::pipeline::store::commit::recover;
use crate::pipeline::store::hashes::Hashes;
use crate::pipeline::store::lock::{Held, Holder, Refused, hold};
use crate::pipeline::store::record::Record;
use crate::pipeline::store::{FailureNote, Store};
use crate::pipeline::tasks::graph::{Graph, GraphFault};
use crate::pipeline::tasks::{Task, TaskId};
pub(super) use attempt::link;
use attempt::{Bench, Miss, TaskState};
use queue::{Next, Queue};
use report::STOPPED;
pub use report::{Outcome, RunReport, TaskFailure, TaskReport};

/// How often a thread that waits looks whether it is to stop.
const PATIENCE: Duration = Duration::from_millis(50);

/// Settings of a run; none of them changes a byte of results.
#[derive(Debug, Clone)]
pub struct RunOptions {
    /// Tasks at a time, at most; also what tasks share among them.
    pub threads: usize,
    /// What tasks at a time may take together, bytes, as they foresee it. One that takes more by itself runs alone.
    pub memory: u64,
    /// Only this part of the tasks.
    pub shard: Option<Shard>,
    /// What decides what is made: kept with a part, so that parts of different runs are not merged.
    pub pipeline: PipelineMark,
}

/// What happens in a run.
#[derive(Clone, Copy)]
pub enum Event<'a> {
    /// A task begins.
    Begins(&'a Task),
    /// A task is settled: done, kept, failed or not done.
    Settled(&'a Task, &'a Outcome),
}

/// How far a run is.
#[derive(Clone, Copy)]
pub struct Progress<'a> {
    /// What happened now.
    pub event: Event<'a>,
    /// How many tasks are settled.
    pub settled: usize,
    /// Of how many.
    pub of: usize,
}

/// A caller's view of a run.
pub struct RunWatch<'a> {
    /// Becomes true where the run is to stop; tasks at work see the same.
    pub stop: &'a AtomicBool,
    /// Called at each event, from any thread.
    pub tick: &'a (dyn Fn(Progress) + Sync),
}

/// Why there was no run.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum RunFault {
    #[error(transparent)]
    Tasks(#[from] GraphFault),
    #[error(
        "{}: cannot be written to ({why}); choose another --out or make room and permission for it",
        .path.display()
    )]
    Folder { path: PathBuf, why: io::Error },
    #[error(
        "{}: another run works here ({}); wait for it or choose another --out",
        .path.display(), said(.holder.as_ref())
    )]
    Busy { path: PathBuf, holder: Option<Holder> },
    #[error(
        "{}: holds part {found} of a run, and this is part {asked}; give each part a folder of its own",
        .path.display()
    )]
    OtherPart { path: PathBuf, found: Shard, asked: Shard },
    #[error(transparent)]
    Mark(#[from] WriteError),
}

pub(super) fn said(holder: Option<&Holder>) -> String {
    holder.map_or_else(|| "it does not tell which".into(), Holder::to_string)
}

/// A folder of results, held by this process alone as long as this lives.
#[derive(Debug)]
pub struct Results {
    pub(super) store: Store,
    pub(super) hashes: Hashes,
    /// What was found as it was opened.
    warnings: Vec<String>,
    counter: AtomicU64,
    _held: Held,
}

impl Results {
    /// Opens a folder, which is made where it is missing; what a run that was killed left is finished or removed.
    ///
    /// # Errors
    /// [`RunFault::Folder`] and [`RunFault::Busy`].
    pub fn open(out: &Path) -> Result<Self, RunFault> {
        let folder = |why| RunFault::Folder { path: out.to_owned(), why };
        let store = Store::new(out);
        store.create().map_err(folder)?;
        let held = hold(&store.lock()).map_err(|refused| match refused {
            Refused::Held(holder) => RunFault::Busy { path: out.to_owned(), holder },
            Refused::Io(why) => folder(why),
        })?;
        store.clear();
        let hashes = Hashes::keep(&store.hashes());
        let mut warnings = recover(&store, &hashes).map_err(folder)?;
        warnings.extend(held.unlocked.as_ref().map(|why| {
            format!(
                "{}: its file system knows no locks ({why}); see to it that only one run works there at a time",
                out.display()
            )
        }));
        Ok(Self { store, hashes, warnings, counter: AtomicU64::new(0), _held: held })
    }

    /// Does what does not stand.
    ///
    /// # Errors
    /// [`RunFault`] where nothing was begun. Tasks that fail are in the report.
    pub fn run(&self, tasks: &[Task], options: &RunOptions, watch: &RunWatch) -> Result<RunReport, RunFault> {
        let start = Instant::now();
        let graph = Graph::new(tasks)?;
        if let Some(shard) = options.shard {
            self.mark(shard, &options.pipeline, tasks)?;
        }
        let chosen = chosen(tasks, &graph, options.shard);
        let strays = self.store.strays(tasks);
        let bench = Bench { results: self, strays: &strays, retiring: Mutex::new(()) };
        let threads = options.threads.max(1);
        let run = Run {
            tasks,
            of: chosen.iter().filter(|chosen| **chosen).count(),
            bench,
            watch,
            queue: Mutex::new(Queue::new(tasks, &graph, &chosen, threads, options.memory)),
            changed: Condvar::new(),
        };
        std::thread::scope(|scope| {
            for _ in 0..threads.min(run.of) {
                scope.spawn(|| run.work());
            }
        });
        let mut report = run.report(&self.warnings);
        report.strays =
            strays.into_iter().map(|stray| stray.task).filter(|task| self.store.record_place(task).exists()).collect();
        report.stopped = watch.stop.load(Ordering::Relaxed) && !report.is_whole();
        report.threads = threads;
        report.wall_s = start.elapsed().as_secs_f64();
        Ok(report)
    }

    /// A new folder to work in, not made yet.
    pub(super) fn work_folder(&self) -> PathBuf {
        self.store.work().join(format!("{}-{}", std::process::id(), self.counter.fetch_add(1, Ordering::Relaxed)))
    }

    fn mark(&self, asked: Shard, pipeline: &PipelineMark, tasks: &[Task]) -> Result<(), RunFault> {
        let mark = PartMark::new(asked, pipeline, tasks);
        match PartMark::of(&self.store) {
            Some(found) if found == mark => Ok(()),
            Some(found) if found.shard != asked => {
                Err(RunFault::OtherPart { path: self.store.out.clone(), found: found.shard, asked })
            }
            _ => Ok(mark.write(&self.store)?),
        }
    }
}

/// Opens a folder and does what does not stand there.
///
/// # Errors
/// [`RunFault`] where nothing was begun. Tasks that fail are in the report.
pub fn run(tasks: &[Task], out: &Path, options: &RunOptions, watch: &RunWatch) -> Result<RunReport, RunFault> {
    // What makes no sense must not leave a folder.
    Graph::new(tasks)?;
    Results::open(out)?.run(tasks, options, watch)
}

/// A run under way, shared by its threads.
struct Run<'a> {
    tasks: &'a [Task],
    of: usize,
    bench: Bench<'a>,
    watch: &'a RunWatch<'a>,
    queue: Mutex<Queue<'a>>,
    changed: Condvar,
}

impl<'a> Run<'a> {
    fn queue(&self) -> MutexGuard<'_, Queue<'a>> {
        self.queue.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn work(&self) {
        let mut work = self.bench.results.work_folder();
        self.work_in(&mut work);
        // Not there where it did nothing, not empty where something is to be finished by the next run.
        let _ = fs::remove_dir(&work);
    }

    fn work_in(&self, work: &mut PathBuf) {
        loop {
            let mut queue = self.queue();
            let next = loop {
                if self.watch.stop.load(Ordering::Relaxed) {
                    return;
                }
                match queue.next() {
                    Next::Wait => {
                        let waited = self.changed.wait_timeout(queue, PATIENCE);
                        queue = waited.unwrap_or_else(PoisonError::into_inner).0;
                    }
                    next => break next,
                }
            };
            drop(queue);
            match next {
                Next::Look(at, needed) => match self.bench.find(&self.tasks[at], needed) {
                    TaskState::Due(due) => {
                        self.queue().is_due(at, due);
                        self.changed.notify_one();
                    }
                    TaskState::Kept(record, warnings) => {
                        let all = self.queue().looked(at, Outcome::Kept, Some(*record));
                        self.tell(&all, warnings);
                    }
                    TaskState::Failed(what) => {
                        self.note(at, &what);
                        let all = self.queue().looked(at, Outcome::Failed(what), None);
                        self.tell(&all, Vec::new());
                    }
                },
                Next::Do(at, due, threads) => {
                    let task = &self.tasks[at];
                    let why = due.why.to_string();
                    self.tick(Event::Begins(task));
                    match self.bench.attempt(work, task, *due, threads, self.watch.stop) {
                        Ok((record, warnings)) => {
                            let all = self.queue().tried(at, why, Outcome::Done, Some(record));
                            self.tell(&all, warnings);
                        }
                        Err(Miss::Failed(what)) => {
                            self.note(at, &what);
                            let all = self.queue().tried(at, why, Outcome::Failed(what), None);
                            self.tell(&all, Vec::new());
                        }
                        Err(Miss::Stopped) => self.queue().free(at),
                    }
                }
                Next::Wait => {}
                Next::End => {
                    self.changed.notify_all();
                    return;
                }
            }
        }
    }

    fn note(&self, at: usize, what: &str) {
        self.bench.results.store.keep_failure(&FailureNote { task: self.tasks[at].id.clone(), what: what.to_owned() });
    }

    /// Wakes the others and notifies the watcher.
    fn tell(&self, settled: &[usize], warnings: Vec<String>) {
        self.changed.notify_all();
        let mut queue = self.queue();
        queue.warnings.extend(warnings);
        let outcome = |at: usize| queue.settled[at].as_ref().map(|settled| settled.outcome.clone());
        let reported: Vec<_> = settled.iter().filter_map(|&at| Some((at, outcome(at)?))).collect();
        drop(queue);
        reported.iter().for_each(|(at, outcome)| self.tick(Event::Settled(&self.tasks[*at], outcome)));
    }

    fn tick(&self, event: Event) {
        let settled = self.queue().settled_count;
        (self.watch.tick)(Progress { event, settled, of: self.of });
    }

    fn report(self, found: &[String]) -> RunReport {
        let queue = self.queue.into_inner().unwrap_or_else(PoisonError::into_inner);
        let mut report = RunReport { warnings: found.to_vec(), ..RunReport::default() };
        let mut warnings = queue.warnings;
        // Threads tell in any order.
        warnings.sort_unstable();
        report.warnings.extend(warnings);
        for (task, settled) in self.tasks.iter().zip(queue.settled) {
            let (outcome, record, why) = match settled {
                Some(settled) => (settled.outcome, settled.record, settled.why),
                None => (Outcome::NotDone(STOPPED.into()), None, None),
            };
            let (wall_s, made, outputs, without) = match record.map(std::sync::Arc::unwrap_or_clone) {
                Some(Record { wall_s, made, outputs, without, .. }) => (Some(wall_s), Some(made), outputs, without),
                None => (None, None, Vec::new(), Vec::new()),
            };
            let id: TaskId = task.id.clone();
            report.tasks.push(TaskReport {
                task: id,
                stage: task.stage.clone(),
                keys: task.keys.clone(),
                outcome,
                why,
                wall_s,
                made,
                outputs,
                without,
            });
        }
        report.count();
        report
    }
}
