//! From a pipeline file to tasks: worked back from the results that are wanted.
//!
//! In: a [`Spec`], where its results go, and what it generates; out: a [`Plan`]: the tasks that the wanted results need
//! and no others, each after those whose results it works on, and for every stage what was left out and why. Nothing is
//! written, and the same inputs give the same plan whatever of the results stands already.
//!
//! Stages are first laid out forwards, from inputs to tasks; then each task learns what is needed of it, backwards;
//! what nobody needs goes.

mod ids;
mod layout;
mod needs;
mod rows;
mod shares;
mod show;
mod slips;
#[cfg(test)]
mod tests;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::items::{Missing, World};
use super::spec::{PipelineError, Spec};
use crate::job::{Demand, Facts, Foreseen, Keys, Prepared};
use crate::pipeline::items::catalogue::Catalogue;
use crate::pipeline::tasks::Task;

pub use show::{PlanFate, PlanLine, StagePlan, plan_text};

/// What is to be made.
pub struct Plan {
    /// The pipeline's name.
    pub name: String,
    /// What it is for.
    pub about: String,
    /// Every task that the wanted results need, after those that it works on.
    pub tasks: Vec<Task>,
    /// What a user should know before it runs: files that are named and do not stand, what a slip leaves out.
    pub warnings: Vec<String>,
    pub(super) stages: Vec<Laid>,
    pub(super) planned: Vec<Planned>,
}

/// A stage of the plan.
#[derive(Debug, Clone)]
pub(super) struct Laid {
    pub(super) name: String,
    pub(super) job: &'static str,
    pub(super) line: usize,
    pub(super) wanted: bool,
    pub(super) tasks: Vec<usize>,
    /// What has no task, and why.
    pub(super) left_out: Vec<Missing>,
}

/// What else is known of a task.
pub(super) struct Planned {
    pub(super) prepared: Option<Arc<dyn Prepared>>,
    pub(super) demand: Demand,
    /// What it works on, and which task makes it.
    pub(super) inputs: Vec<(Foreseen, Option<usize>)>,
    /// A file that it works on and that is not there.
    pub(super) lacks: Option<String>,
}

impl Plan {
    /// Plans a pipeline whose results go to the folder `out`, with what it generates.
    ///
    /// # Errors
    /// With all faults of the pipeline file that its inputs show, each with line and column.
    pub fn new(spec: &Spec, out: &Path, generated: Option<&Catalogue>) -> Result<Self, PipelineError> {
        let faulty = |faults| PipelineError::Faults { path: spec.path.clone(), faults };
        let world = World::new(spec.folder(), out, generated);
        let layout = layout::lay_out(spec, &world).map_err(faulty)?;
        let demands = needs::demands(spec, &layout);
        let shares = shares::shares(&layout, &demands);
        Ok(needs::plan(spec, layout, demands, &shares, &world))
    }

    /// How many parts a run can be cut into that have something to do.
    #[must_use]
    pub fn parts(&self) -> usize {
        let part = |task: &Task| if let crate::pipeline::tasks::Share::Part(k) = task.share { k + 1 } else { 0 };
        self.tasks.iter().map(part).max().unwrap_or(0)
    }
}

/// A task before it is known whether anybody needs it.
pub(super) struct Node {
    pub(super) id: String,
    /// Which stage; none: it makes generated recordings.
    pub(super) stage: Option<usize>,
    pub(super) keys: Keys,
    pub(super) inputs: Vec<NodeInput>,
    /// Whether it gathers items.
    pub(super) gathers: bool,
    /// Where it comes from, as messages tell.
    pub(super) place: String,
}

pub(super) struct NodeInput {
    pub(super) role: &'static str,
    pub(super) keys: Keys,
    pub(super) from: NodeSource,
    pub(super) may_fail: bool,
}

pub(super) enum NodeSource {
    Given {
        path: PathBuf,
        name: String,
        stands: bool,
    },
    /// A result: which node's, the file in its folder; its part, if it is a stage's; what is known of it beforehand.
    Made {
        node: usize,
        file: String,
        part: Option<&'static str>,
        facts: Facts,
    },
}

/// All stages that are needed, laid out.
pub(super) struct Layout<'a> {
    /// Those of the catalogue first, then stage by stage.
    pub(super) nodes: Vec<Node>,
    /// For each stage its nodes; none: nothing wanted needs the stage.
    pub(super) of_stage: Vec<Option<std::ops::Range<usize>>>,
    pub(super) left_out: Vec<Vec<Missing>>,
    pub(super) catalogue: Option<&'a Catalogue>,
    pub(super) warnings: Vec<String>,
    /// The places of all items that its tasks work on.
    pub(super) taken: BTreeSet<String>,
}

/// What is needed of each node that is needed.
pub(super) type Demands = BTreeMap<usize, Demand>;
