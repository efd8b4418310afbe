//! Backwards: what is needed of each task, then the tasks that are needed.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Arc;

use super::{Demands, Laid, Layout, Node, NodeSource, Plan, Planned};
use crate::input::copies;
use crate::job::{Demand, Facts, Foreseen, Role, Takes};
use crate::pipeline::items::{Missing, World};
use crate::pipeline::spec::{Spec, StageSpec};
use crate::pipeline::tasks::{Input, Share, Source, Task};

/// What wanted results, and the tasks that they stand on, need of every node; nodes that nobody needs have nothing.
pub(super) fn demands(spec: &Spec, layout: &Layout<'_>) -> Demands {
    let mut demands = Demands::new();
    for wanted in &spec.wanted {
        let parts: BTreeSet<&'static str> = match wanted.part {
            Some(part) => [part.name].into(),
            None => spec.stages[wanted.stage].kind.parts.iter().filter(|p| !p.only_if_wanted).map(|p| p.name).collect(),
        };
        // Whoever wants a result wants all of it.
        let demand = Demand { parts, joints: None, clock: true };
        for node in layout.of_stage[wanted.stage].clone().into_iter().flatten() {
            add(&mut demands, node, &demand);
        }
    }
    // Nodes stand after those that they work on.
    for (at, node) in layout.nodes.iter().enumerate().rev() {
        let Some(own) = demands.get(&at).cloned() else { continue };
        let Some(stage) = node.stage.map(|stage| &spec.stages[stage]) else { continue };
        for input in &node.inputs {
            if let NodeSource::Made { node: before, part, .. } = &input.from {
                let mut demand = stage.prepared.demand(input.role, &own);
                demand.parts.extend(*part);
                add(&mut demands, *before, &demand);
            }
        }
    }
    demands
}

fn add(demands: &mut Demands, node: usize, more: &Demand) {
    let join = |there: &mut Demand| {
        there.parts.extend(&more.parts);
        there.joints = match (there.joints.take(), &more.joints) {
            (Some(some), Some(others)) => Some(some.union(others).cloned().collect()),
            _ => None,
        };
        there.clock |= more.clock;
    };
    demands.entry(node).and_modify(join).or_insert_with(|| more.clone());
}

/// The tasks of the nodes that are needed.
pub(super) fn plan(
    spec: &Spec,
    layout: Layout<'_>,
    mut demands: Demands,
    shares: &BTreeMap<usize, Share>,
    world: &World<'_>,
) -> Plan {
    let task_of: BTreeMap<usize, usize> = demands.keys().enumerate().map(|(task, &node)| (node, task)).collect();
    let mut plan = Plan {
        name: spec.name.clone(),
        about: spec.about.clone(),
        tasks: Vec::with_capacity(demands.len()),
        warnings: layout.warnings.clone(),
        stages: Vec::new(),
        planned: Vec::with_capacity(demands.len()),
    };
    for (at, node) in layout.nodes.iter().enumerate() {
        let Some(demand) = demands.remove(&at) else { continue };
        let stage = node.stage.map(|stage| &spec.stages[stage]);
        let inputs = foreseen(node, &layout.nodes, &task_of, world);
        let share = shares.get(&at).copied().unwrap_or(Share::Each);
        let Some(task) = task(&layout, at, stage, &demand, &inputs, share) else { continue };
        let lacks = node.inputs.iter().find_map(|input| match &input.from {
            NodeSource::Given { path, stands: false, .. } => Some(path.display().to_string()),
            _ => None,
        });
        let prepared = stage.map(|stage| Arc::clone(&stage.prepared));
        plan.tasks.push(task);
        plan.planned.push(Planned { prepared, demand, inputs, lacks });
    }
    stages(spec, &layout, &task_of, &mut plan);
    for what in spec.stages.iter().flat_map(|stage| copied(stage, &plan)).collect::<Vec<_>>() {
        if !plan.warnings.contains(&what) {
            plan.warnings.push(what);
        }
    }
    plan
}

/// What to say of a stage whose tasks are given one recording under several names: a task sees only its own, so that
/// no job can say it.
fn copied(stage: &StageSpec, plan: &Plan) -> Vec<String> {
    let laid = plan.stages.iter().find(|laid| laid.name == stage.name && laid.tasks.len() > 1);
    let tasks = laid.map_or(&[][..], |laid| &laid.tasks[..]);
    let recordings = |role: &&Role| matches!(role.takes, Takes::One | Takes::Many);
    let of_role = |role: &Role| {
        let given = tasks.iter().flat_map(|&task| &plan.planned[task].inputs);
        // Settings are alike for many.
        let given = given.filter(|(input, _)| input.role == role.name && input.exists && !is_toml(&input.path));
        let paths: BTreeSet<&Path> = given.map(|(input, _)| input.path.as_path()).collect();
        copies(paths.into_iter().map(|path| (path.display().to_string(), path)))
    };
    stage.kind.roles.iter().filter(recordings).flat_map(of_role).collect()
}

fn is_toml(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending == "toml")
}

/// A node's inputs as jobs foresee them, with the task that makes each.
fn foreseen(
    node: &Node,
    nodes: &[Node],
    task_of: &BTreeMap<usize, usize>,
    world: &World<'_>,
) -> Vec<(Foreseen, Option<usize>)> {
    let foresee = |input: &super::NodeInput| {
        let (path, stands, facts, task) = match &input.from {
            NodeSource::Given { path, stands, .. } => (path.clone(), *stands, Facts::default(), None),
            NodeSource::Made { node, file, facts, .. } => {
                let task = task_of.get(node).copied();
                (world.out.join(&nodes[*node].id).join(file), false, *facts, task)
            }
        };
        (Foreseen { role: input.role, keys: input.keys.clone(), path, exists: stands, facts }, task)
    };
    node.inputs.iter().map(foresee).collect()
}

fn task(
    layout: &Layout<'_>,
    at: usize,
    stage: Option<&StageSpec>,
    demand: &Demand,
    inputs: &[(Foreseen, Option<usize>)],
    share: Share,
) -> Option<Task> {
    let node = &layout.nodes[at];
    let Some(stage) = stage else {
        let made = &layout.catalogue?.tasks[at];
        return Some(Task {
            id: node.id.clone(),
            stage: "phantom".to_owned(),
            keys: node.keys.clone(),
            inputs: Vec::new(),
            options: made.options.clone(),
            share,
            memory: made.memory,
            cost_s: made.cost_s,
            job: Arc::clone(&made.job),
        });
    };
    let source = |from: &NodeSource| match from {
        NodeSource::Given { path, name, .. } => Source::Given { path: path.clone(), name: name.clone() },
        NodeSource::Made { node, file, .. } => {
            Source::Result { task: layout.nodes[*node].id.clone(), name: file.clone() }
        }
    };
    let input = |input: &super::NodeInput| Input {
        role: input.role,
        keys: input.keys.clone(),
        source: source(&input.from),
        may_fail: input.may_fail,
    };
    let known: Vec<Foreseen> = inputs.iter().map(|(input, _)| input.clone()).collect();
    let (memory, cost_s) = stage.prepared.cost(&known);
    Some(Task {
        id: node.id.clone(),
        stage: stage.name.clone(),
        keys: node.keys.clone(),
        inputs: node.inputs.iter().map(input).collect(),
        options: serde_json::json!({
            "job": stage.kind.name,
            "revision": stage.kind.revision,
            "options": stage.prepared.depends_on(demand),
        }),
        share,
        memory,
        cost_s,
        job: Arc::clone(&stage.prepared).maker(&node.keys, demand),
    })
}

/// Every stage with its tasks and with what has none.
fn stages(spec: &Spec, layout: &Layout<'_>, task_of: &BTreeMap<usize, usize>, plan: &mut Plan) {
    if let (Some(generated), Some(catalogue)) = (&spec.phantom, layout.catalogue) {
        let tasks: Vec<usize> = (0..catalogue.tasks.len()).filter_map(|node| task_of.get(&node).copied()).collect();
        let idle = catalogue.tasks.len() - tasks.len();
        plan.stages.push(Laid {
            name: "phantom".to_owned(),
            job: "phantom",
            line: spec.line(generated.at),
            wanted: false,
            tasks,
            left_out: unneeded(idle),
        });
    }
    for (at, stage) in spec.stages.iter().enumerate() {
        let nodes = layout.of_stage[at].clone();
        let mut left_out = layout.left_out[at].clone();
        let tasks: Vec<usize> =
            nodes.clone().into_iter().flatten().filter_map(|node| task_of.get(&node).copied()).collect();
        match nodes {
            None => left_out.push(Missing { reason: "nothing wanted needs it".to_owned(), count: 0 }),
            Some(nodes) => left_out.extend(unneeded(nodes.len() - tasks.len())),
        }
        plan.stages.push(Laid {
            name: stage.name.clone(),
            job: stage.kind.name,
            line: spec.line(stage.at),
            wanted: spec.wanted.iter().any(|wanted| wanted.stage == at),
            tasks,
            left_out,
        });
    }
}

fn unneeded(count: usize) -> Vec<Missing> {
    if count == 0 { Vec::new() } else { vec![Missing { reason: "nothing wanted needs it".to_owned(), count }] }
}
