//! Which part of a run that is cut makes which task.
//!
//! Tasks that hang together go together; what would tie all of them into one, because it gathers everything, is made
//! when the parts are merged, and so is what stands on it. What several parts stand on and is cheap, generated
//! recordings and tasks that are nobody's in particular, each makes for itself. Parts are numbered in the order of
//! their first task's name.

use std::collections::{BTreeMap, BTreeSet};

use super::{Demands, Layout, Node, NodeSource};
use crate::pipeline::tasks::Share;

/// The share of every node that is needed.
pub(super) fn shares(layout: &Layout<'_>, demands: &Demands) -> BTreeMap<usize, Share> {
    let nodes: Vec<usize> = demands.keys().copied().collect();
    let common = common(layout, &nodes);
    let mut whole: BTreeSet<usize> = BTreeSet::new();
    let mut groups = Groups::new(layout.nodes.len());
    for stage in nodes.chunk_by(|a, b| layout.nodes[*a].stage == layout.nodes[*b].stage) {
        let on_whole = |node: &usize| makers(&layout.nodes[*node]).any(|before| whole.contains(&before));
        let (late, now): (Vec<usize>, Vec<usize>) = stage.iter().partition(|node| on_whole(node));
        whole.extend(late);
        let mut joined = groups.clone();
        for &node in &now {
            let mut before = makers(&layout.nodes[node]).filter(|before| !common.contains(before));
            before.by_ref().for_each(|before| joined.join(node, before));
        }
        // Stages before this one, with and without it.
        let apart = |groups: &mut Groups, nodes: &BTreeSet<usize>| -> usize {
            nodes.iter().map(|&node| groups.find(node)).collect::<BTreeSet<usize>>().len()
        };
        let gathered: BTreeSet<usize> =
            now.iter().flat_map(|&node| makers(&layout.nodes[node])).filter(|n| !common.contains(n)).collect();
        let gathers = now.iter().any(|&node| layout.nodes[node].gathers);
        let ties_all = gathers && apart(&mut groups, &gathered) > 1 && apart(&mut joined, &gathered) == 1;
        // Given files only, all of them: nothing to wait for, but nothing to share either.
        if ties_all {
            whole.extend(now);
        } else {
            groups = joined;
        }
    }
    numbered(layout, &nodes, &common, &whole, groups)
}

/// Tasks that others share: generated recordings, and what stands on nothing but such and is nobody's in particular.
fn common(layout: &Layout<'_>, nodes: &[usize]) -> BTreeSet<usize> {
    let mut common = BTreeSet::new();
    for &at in nodes {
        let node = &layout.nodes[at];
        let shared = node.stage.is_none()
            || (node.keys.0.is_empty() && !node.gathers && makers(node).all(|before| common.contains(&before)));
        if shared {
            common.insert(at);
        }
    }
    common
}

fn makers(node: &Node) -> impl Iterator<Item = usize> {
    node.inputs.iter().filter_map(|input| match &input.from {
        NodeSource::Made { node, .. } => Some(*node),
        NodeSource::Given { .. } => None,
    })
}

/// Numbers for what hangs together; what is shared goes to its only part, if it has only one.
fn numbered(
    layout: &Layout<'_>,
    nodes: &[usize],
    common: &BTreeSet<usize>,
    whole: &BTreeSet<usize>,
    mut groups: Groups,
) -> BTreeMap<usize, Share> {
    let mut users: BTreeMap<usize, BTreeSet<usize>> = BTreeMap::new();
    for &at in nodes.iter().rev().filter(|at| !whole.contains(at)) {
        let of =
            if common.contains(&at) { users.get(&at).cloned().unwrap_or_default() } else { [groups.find(at)].into() };
        for before in makers(&layout.nodes[at]).filter(|before| common.contains(before)) {
            users.entry(before).or_default().extend(&of);
        }
    }
    for &at in common {
        if let Some(only) = users.get(&at).filter(|of| of.len() == 1).and_then(BTreeSet::first) {
            groups.join(at, *only);
        }
    }
    let is_each = |at: usize| common.contains(&at) && users.get(&at).is_some_and(|of| of.len() > 1);
    let mut by_id: Vec<usize> = nodes.iter().copied().filter(|&at| !whole.contains(&at) && !is_each(at)).collect();
    by_id.sort_by(|&a, &b| layout.nodes[a].id.cmp(&layout.nodes[b].id));
    let mut numbers: BTreeMap<usize, usize> = BTreeMap::new();
    let mut shares = BTreeMap::new();
    for at in by_id {
        let next = numbers.len();
        shares.insert(at, Share::Part(*numbers.entry(groups.find(at)).or_insert(next)));
    }
    shares.extend(whole.iter().map(|&at| (at, Share::Whole)));
    shares.extend(nodes.iter().copied().filter(|&at| is_each(at)).map(|at| (at, Share::Each)));
    shares
}

/// What hangs together.
#[derive(Clone)]
struct Groups(Vec<usize>);

impl Groups {
    fn new(count: usize) -> Self {
        Self((0..count).collect())
    }

    fn find(&mut self, of: usize) -> usize {
        let mut at = of;
        while self.0[at] != at {
            self.0[at] = self.0[self.0[at]];
            at = self.0[at];
        }
        at
    }

    fn join(&mut self, one: usize, other: usize) {
        let (one, other) = (self.find(one), self.find(other));
        self.0[one.max(other)] = one.min(other);
    }
}
