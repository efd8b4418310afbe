//! A proof that no other `k` places cost less, by branch and bound, or how much less any could cost.
//!
//! Units are put into one order, those that cost least by themselves first. A branch has some units taken and may take
//! any later ones; it can't cost less than all of these together. Where that is no less than the best known, nothing
//! of the branch is looked at.

use serde::Serialize;

use super::ladder::Ladder;
use super::problem::LayoutProblem;
use super::rules::{Rules, Units};
use super::search::{Choice, choice};

/// What is this near to the best known is no better: rounding.
const ROUNDING: f64 = 1e-14;
/// A branch with fewer places left to take than this is searched without a bound, whose work, about n^3/6 multiply-adds
/// for each person, is more than that of the branch's n^2/2 layouts (counted).
const BOUND_FROM: usize = 3;

/// What branch and bound came to.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Proof {
    /// The best layout known: as given, or better.
    pub best: Choice,
    /// No `k` places cost less than this; the best's cost where that is optimal.
    pub bound: f64,
    /// Whether every branch was searched or ruled out.
    pub optimal: bool,
    /// Branches that were looked into.
    pub nodes: u64,
}

/// Looks for a better layout than `known`, or proves that there is none, in at most about `budget` multiply-adds. That
/// is counted, not timed: the same problem has the same proof on any machine.
#[must_use]
pub fn prove(problem: &LayoutProblem, rules: &Rules, known: &Choice, budget: u64) -> Proof {
    let units = Units::new(problem, rules);
    let k = known.places.len();
    let (ordered, order) = by_own_cost(problem, &units);
    let mut ladder = Ladder::new(&ordered);
    units.kept.iter().for_each(|&place| ladder.push(order.new[place]));
    let sizes: Vec<Vec<usize>> =
        order.units.iter().map(|&unit| units.units[unit].iter().map(|&place| order.new[place]).collect()).collect();
    let mut tree = Tree {
        ladder,
        units: &units,
        order: &order.units,
        places: &sizes,
        blocked: vec![0; sizes.len()],
        taken: Vec::new(),
        best: known.cost,
        better: None,
        open: f64::INFINITY,
        nodes: 0,
        budget,
        costs: vec![0.0; problem.len()],
    };
    let left = k.saturating_sub(units.kept.len());
    if left > 0 {
        let all = tree.bounds(0, 0.0);
        tree.branch(0, left, all.first().copied().unwrap_or(0.0));
    }
    let Tree { better, open, nodes, .. } = tree;
    let best = better.map_or_else(|| known.clone(), |units_of| choice(problem, &units, &units_of));
    let optimal = open.is_infinite();
    Proof { bound: best.cost.min(open), best, optimal, nodes }
}

/// Units in the order of their own costs, and where each place is in a problem of that order.
struct Order {
    units: Vec<usize>,
    /// Of the problem's places, the new number.
    new: Vec<usize>,
}

/// The problem with kept places first, then those of units that cost least by themselves.
fn by_own_cost(problem: &LayoutProblem, units: &Units) -> (LayoutProblem, Order) {
    let mut ladder = Ladder::new(problem);
    units.kept.iter().for_each(|&place| ladder.push(place));
    let own = |ladder: &mut Ladder, unit: &[usize]| {
        unit.iter().for_each(|&place| ladder.push(place));
        let cost = ladder.cost();
        unit.iter().for_each(|_| ladder.pop());
        cost
    };
    let costs: Vec<f64> = units.units.iter().map(|unit| own(&mut ladder, unit)).collect();
    let mut order: Vec<usize> = (0..units.units.len()).collect();
    order.sort_by(|&i, &j| costs[i].total_cmp(&costs[j]).then(i.cmp(&j)));
    let mut old: Vec<usize> = units.kept.clone();
    old.extend(order.iter().flat_map(|&unit| &units.units[unit]));
    let mut new = vec![usize::MAX; problem.len()];
    old.iter().enumerate().for_each(|(at, &place)| new[place] = at);
    (problem.reordered(&old), Order { units: order, new })
}

struct Tree<'a> {
    ladder: Ladder<'a>,
    units: &'a Units,
    /// Units in the order of branching.
    order: &'a [usize],
    /// Their places in the ladder's problem, ascending from unit to unit.
    places: &'a [Vec<usize>],
    /// By how many units that are taken each is ruled out.
    blocked: Vec<usize>,
    /// By the problem's own numbers of units.
    taken: Vec<usize>,
    best: f64,
    better: Option<Vec<usize>>,
    /// The least bound of a branch that was not searched.
    open: f64,
    nodes: u64,
    budget: u64,
    costs: Vec<f64>,
}

impl Tree<'_> {
    /// Searches the layouts that take `left` more places of units from `from` on, none of which costs less than
    /// `bound`. False where the budget ended before.
    fn branch(&mut self, from: usize, left: usize, bound: f64) -> bool {
        self.nodes += 1;
        if self.ladder.work >= self.budget {
            self.open = self.open.min(bound);
            return false;
        }
        if left == 1 {
            self.leaves(from);
            return true;
        }
        let bounds = if left >= BOUND_FROM { self.bounds(from, bound) } else { vec![bound; self.places.len() - from] };
        for unit in from..self.places.len() {
            let bound = bounds[unit - from];
            if bound >= self.best - ROUNDING {
                break;
            }
            let size = self.places[unit].len();
            if self.blocked[unit] > 0 || size > left {
                continue;
            }
            self.take(unit);
            let done = if size < left {
                self.branch(unit + 1, left - size, bound)
            } else {
                let cost = self.ladder.cost();
                self.note(cost);
                true
            };
            self.give_back(unit);
            if !done {
                // Bounds rise from one unit to the next.
                let next = bounds.get(unit + 1 - from).copied().unwrap_or(f64::INFINITY);
                self.open = self.open.min(if next < self.best - ROUNDING { next } else { f64::INFINITY });
                return false;
            }
        }
        true
    }

    /// For each unit from `from` on, what all of it and later ones cost together.
    fn bounds(&mut self, from: usize, least: f64) -> Vec<f64> {
        let mut places = Vec::new();
        let starts: Vec<usize> = (from..self.places.len())
            .map(|unit| {
                let start = places.len();
                if self.blocked[unit] == 0 {
                    places.extend(&self.places[unit]);
                }
                start
            })
            .collect();
        let costs = self.ladder.costs_with_all_from(&places);
        let none = self.ladder.cost();
        starts.into_iter().map(|start| costs.get(start).copied().unwrap_or(none).max(least)).collect()
    }

    /// Layouts that one more place completes.
    fn leaves(&mut self, from: usize) {
        let Some(first) = self.places.get(from).map(|unit| unit[0]) else { return };
        let mut costs = std::mem::take(&mut self.costs);
        self.ladder.costs_with(first, &mut costs);
        for unit in from..self.places.len() {
            if let ([place], 0) = (&self.places[unit][..], self.blocked[unit])
                && costs[*place] < self.best - ROUNDING
            {
                self.taken.push(self.order[unit]);
                self.note(costs[*place]);
                self.taken.pop();
            }
        }
        self.costs = costs;
    }

    fn note(&mut self, cost: f64) {
        if cost < self.best - ROUNDING {
            self.best = cost;
            self.better = Some(self.taken.clone());
        }
    }

    fn take(&mut self, unit: usize) {
        for &place in &self.places[unit] {
            self.ladder.push_for(place, self.places[unit][0]);
        }
        self.mark(unit, |count| count + 1);
        self.taken.push(self.order[unit]);
    }

    fn give_back(&mut self, unit: usize) {
        self.places[unit].iter().for_each(|_| self.ladder.pop());
        self.mark(unit, |count| count - 1);
        self.taken.pop();
    }

    fn mark(&mut self, unit: usize, change: impl Fn(usize) -> usize) {
        for other in unit + 1..self.places.len() {
            if self.units.near(self.order[unit], self.order[other]) {
                self.blocked[other] = change(self.blocked[other]);
            }
        }
    }
}
