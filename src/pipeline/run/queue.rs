//! Which task is next: those whose inputs are settled, the one with the longest way on from it first, as many as memory
//! allows.

use std::collections::VecDeque;
use std::sync::Arc;

use super::attempt::{Due, Needed};
use super::report::Outcome;
use crate::pipeline::store::record::Record;
use crate::pipeline::tasks::graph::Graph;
use crate::pipeline::tasks::{Source, Task};

/// What is next for a thread.
pub(super) enum Next {
    /// Look whether it stands.
    Look(usize, Needed),
    /// Do it, with so many threads.
    Do(usize, Box<Due>, usize),
    /// Nothing now; something that is under way may change that.
    Wait,
    /// Nothing any more.
    End,
}

/// A task that is settled.
pub(super) struct Settled {
    pub(super) outcome: Outcome,
    pub(super) record: Option<Arc<Record>>,
    pub(super) why: Option<String>,
    /// The task that failed by itself, where this is not done because of it.
    root: Option<usize>,
}

/// Where a run stands.
pub(super) struct Queue<'a> {
    tasks: &'a [Task],
    graph: &'a Graph,
    threads: usize,
    memory: u64,
    /// How many tasks that each needs are not settled.
    open: Vec<usize>,
    looks: VecDeque<usize>,
    due: Vec<(usize, Box<Due>)>,
    /// Being looked at or done.
    under_way: usize,
    doing: usize,
    in_use: u64,
    pub(super) settled: Vec<Option<Settled>>,
    pub(super) settled_count: usize,
    pub(super) warnings: Vec<String>,
}

impl<'a> Queue<'a> {
    /// All tasks that are `chosen`; the others are elsewhere.
    pub(super) fn new(tasks: &'a [Task], graph: &'a Graph, chosen: &[bool], threads: usize, memory: u64) -> Self {
        let elsewhere = || Settled { outcome: Outcome::Elsewhere, record: None, why: None, root: None };
        let open: Vec<usize> = graph.needs.iter().map(Vec::len).collect();
        Self {
            tasks,
            graph,
            threads,
            memory,
            looks: (0..tasks.len()).filter(|&at| chosen[at] && open[at] == 0).collect(),
            open,
            due: Vec::new(),
            under_way: 0,
            doing: 0,
            in_use: 0,
            settled: chosen.iter().map(|chosen| (!chosen).then(elsewhere)).collect(),
            settled_count: 0,
            warnings: Vec::new(),
        }
    }

    /// What a thread may do; it says so when that is over.
    pub(super) fn next(&mut self) -> Next {
        if let Some(at) = self.looks.pop_front() {
            self.under_way += 1;
            let records = self.graph.needs[at].iter().filter_map(|&needed| {
                let record = self.settled[needed].as_ref()?.record.as_ref()?;
                Some((self.tasks[needed].id.clone(), Arc::clone(record)))
            });
            return Next::Look(at, records.collect());
        }
        let longest = |&(_, one): &(usize, usize), &(_, other): &(usize, usize)| {
            let order = self.graph.path_s[one].total_cmp(&self.graph.path_s[other]);
            order.then(other.cmp(&one))
        };
        let fitting = self.due.iter().enumerate().map(|(place, (at, _))| (place, *at)).filter(|&(_, at)| self.fits(at));
        let Some((place, at)) = fitting.max_by(longest) else {
            return if self.under_way == 0 { Next::End } else { Next::Wait };
        };
        let (_, due) = self.due.swap_remove(place);
        let memory = self.tasks[at].memory;
        if memory > self.memory {
            self.warnings.push(format!(
                "{}: may take {} MB, more than the {} MB allowed; it runs alone",
                self.tasks[at].id,
                memory / 1_000_000,
                self.memory / 1_000_000
            ));
        }
        self.under_way += 1;
        self.doing += 1;
        self.in_use = self.in_use.saturating_add(memory);
        let share = self.threads / (self.doing + self.due.len()).clamp(1, self.threads);
        Next::Do(at, due, share.max(1))
    }

    fn fits(&self, at: usize) -> bool {
        self.doing == 0 || self.in_use.saturating_add(self.tasks[at].memory) <= self.memory
    }

    /// A task that was looked at is to be done.
    pub(super) fn is_due(&mut self, at: usize, due: Box<Due>) {
        self.under_way -= 1;
        self.due.push((at, due));
    }

    /// A task that was looked at is settled by that.
    pub(super) fn looked(&mut self, at: usize, outcome: Outcome, record: Option<Record>) -> Vec<usize> {
        self.under_way -= 1;
        self.settle(at, Settled { outcome, record: record.map(Arc::new), why: None, root: None })
    }

    /// A task was done, or tried.
    pub(super) fn tried(&mut self, at: usize, why: String, outcome: Outcome, record: Option<Record>) -> Vec<usize> {
        self.free(at);
        self.settle(at, Settled { outcome, record: record.map(Arc::new), why: Some(why), root: None })
    }

    /// A task that was begun is no longer under way; stopped from outside, neither it nor what needs it is settled.
    pub(super) fn free(&mut self, at: usize) {
        self.under_way -= 1;
        self.doing -= 1;
        self.in_use = self.in_use.saturating_sub(self.tasks[at].memory);
    }

    /// Settles a task and those that can't be done because of it; returns which.
    fn settle(&mut self, at: usize, settled: Settled) -> Vec<usize> {
        let mut all = Vec::new();
        let mut todo = vec![(at, settled)];
        while let Some((at, settled)) = todo.pop() {
            self.settled[at] = Some(settled);
            self.settled_count += 1;
            all.push(at);
            for &next in &self.graph.needed_by[at] {
                self.open[next] -= 1;
                if self.open[next] > 0 || self.settled[next].is_some() {
                    continue;
                }
                match self.broken(next) {
                    None => self.looks.push_back(next),
                    Some((needs, root)) => {
                        let what = if needs == root {
                            format!("needs {}, which failed", self.tasks[needs].id)
                        } else {
                            format!("needs {}, which needs {}, which failed", self.tasks[needs].id, self.tasks[root].id)
                        };
                        let outcome = Outcome::NotDone(what);
                        todo.push((next, Settled { outcome, record: None, why: None, root: Some(root) }));
                    }
                }
            }
        }
        all
    }

    /// A task that this one can't do without and that has no result, and the one that this comes from.
    fn broken(&self, at: usize) -> Option<(usize, usize)> {
        self.tasks[at].inputs.iter().filter(|input| !input.may_fail).find_map(|input| {
            let Source::Result { task, .. } = &input.source else { return None };
            let needed = self.graph.at(task);
            let settled = self.settled[needed].as_ref()?;
            settled.record.is_none().then(|| (needed, settled.root.unwrap_or(needed)))
        })
    }
}
