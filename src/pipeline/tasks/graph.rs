//! Tasks and what they need of one another, checked: no two of one name, none within another's folder, nothing unknown,
//! no circle.

use std::collections::{BTreeSet, HashMap};

use thiserror::Error;

use crate::pipeline::tasks::{Source, Task, TaskId};

/// Why tasks can't be worked through.
#[derive(Debug, Error, PartialEq, Eq)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum GraphFault {
    #[error("{0:?}: is no name for a task: it must be names with / between them, none of them empty, . or ..")]
    Name(TaskId),
    #[error("{0}: two tasks have this name, so they would write the same files; name their stages or keys differently")]
    Twice(TaskId),
    #[error("{inner}: lies in the folder of the task {outer}; name one of their stages differently")]
    Within { inner: TaskId, outer: TaskId },
    #[error("{task}: needs the result of {needs}, which is no task")]
    Unknown { task: TaskId, needs: TaskId },
    #[error("tasks need one another in a circle: {}", .0.join(" needs "))]
    Circle(Vec<TaskId>),
}

/// Who needs whom, by position in the list of tasks.
#[derive(Debug)]
pub(in crate::pipeline) struct Graph {
    /// Each after all that it needs.
    pub(in crate::pipeline) order: Vec<usize>,
    /// Whose results each works on; none twice.
    pub(in crate::pipeline) needs: Vec<Vec<usize>>,
    /// Who works on each one's results.
    pub(in crate::pipeline) needed_by: Vec<Vec<usize>>,
    /// Each one's own time and that of the longest way on from it, seconds.
    pub(in crate::pipeline) path_s: Vec<f64>,
    position: HashMap<TaskId, usize>,
}

impl Graph {
    pub(in crate::pipeline) fn new(tasks: &[Task]) -> Result<Self, GraphFault> {
        let mut position = HashMap::with_capacity(tasks.len());
        for (at, task) in tasks.iter().enumerate() {
            let is_name = |part: &str| !matches!(part, "" | "." | ".." | ".lunula") && !part.contains(['\\', '\0']);
            if !task.id.split('/').all(is_name) {
                return Err(GraphFault::Name(task.id.clone()));
            }
            if position.insert(task.id.clone(), at).is_some() {
                return Err(GraphFault::Twice(task.id.clone()));
            }
        }
        for task in tasks {
            if let Some(outer) = above(&task.id).find(|outer| position.contains_key(*outer)) {
                return Err(GraphFault::Within { inner: task.id.clone(), outer: outer.to_owned() });
            }
        }
        let mut needs = Vec::with_capacity(tasks.len());
        for task in tasks {
            let mut own = BTreeSet::new();
            for input in &task.inputs {
                if let Source::Result { task: needed, .. } = &input.source {
                    let unknown = || GraphFault::Unknown { task: task.id.clone(), needs: needed.clone() };
                    own.insert(*position.get(needed).ok_or_else(unknown)?);
                }
            }
            needs.push(own.into_iter().collect::<Vec<usize>>());
        }
        let mut needed_by = vec![Vec::new(); tasks.len()];
        for (at, own) in needs.iter().enumerate() {
            own.iter().for_each(|&needed| needed_by[needed].push(at));
        }
        let order = order(&needs, &needed_by)
            .map_err(|circle| GraphFault::Circle(circle.into_iter().map(|at| tasks[at].id.clone()).collect()))?;
        let mut path_s = vec![0.0; tasks.len()];
        for &at in order.iter().rev() {
            let on = needed_by[at].iter().map(|&next: &usize| path_s[next]).fold(0.0, f64::max);
            // What is not known counts as nothing.
            path_s[at] = on + tasks[at].cost_s.max(0.0);
        }
        Ok(Self { order, needs, needed_by, path_s, position })
    }

    /// Where a task stands in the list.
    pub(in crate::pipeline) fn at(&self, task: &str) -> usize {
        self.position[task]
    }
}

/// The names of folders that a task's folder lies in: of `a/b/c` they are `a/b` and `a`.
pub(in crate::pipeline) fn above(id: &str) -> impl Iterator<Item = &str> {
    std::iter::successors(id.rfind('/').map(|end| &id[..end]), |outer| outer.rfind('/').map(|end| &outer[..end]))
}

fn order(needs: &[Vec<usize>], needed_by: &[Vec<usize>]) -> Result<Vec<usize>, Vec<usize>> {
    let mut open: Vec<usize> = needs.iter().map(Vec::len).collect();
    let mut order: Vec<usize> = (0..needs.len()).filter(|&at| open[at] == 0).collect();
    let mut next = 0;
    while next < order.len() {
        for &by in &needed_by[order[next]] {
            open[by] -= 1;
            if open[by] == 0 {
                order.push(by);
            }
        }
        next += 1;
    }
    let Some(mut at) = open.iter().position(|&count| count > 0) else { return Ok(order) };
    // Whoever is left needs another that is left: going back from one comes round.
    let mut way = Vec::new();
    loop {
        if let Some(start) = way.iter().position(|&before| before == at) {
            let mut circle = way.split_off(start);
            circle.push(at);
            return Err(circle);
        }
        way.push(at);
        match needs[at].iter().find(|&&needed| open[needed] > 0) {
            Some(&needed) => at = needed,
            None => return Err(way),
        }
    }
}
