//! All equilibria of a network with open vessels, as roots of the balance of flows over the venous pressure.
//!
//! At a venous pressure `P` the vein has one lumen, and every unit one on each of its branches (module `branch`). For a
//! choice of a branch for each unit, the equilibria are the roots of
//!
//! `F(P) = sum s_i (P_H - P) - G_V (P - P_L)`, `s = G / (1 + G R_Vi)`.
//!
//! The pressures at which branches begin and end cut the range of pressures into cells over which every lumen is
//! monotone, so that the ends of a cell bound `F` and `F'` (module `cell`). A choice is settled where the bounds
//! exclude a root, or where `F'` keeps its sign: then there is one root if `F` changes its sign between the ends, and
//! none otherwise. Near a turning point of a unit, where its `dl / dP` is infinite, the derivative is taken by its
//! lumen. Cells with a choice that is not settled are halved. Units that are the same share their branches: a choice is
//! how many are on which one.
//!
//! What is proved: in exact arithmetic no equilibrium is missed, none is spurious and none is counted twice.
//! Neighbouring cells share the numbers at their ends, so that a root within rounding of an end is counted once all the
//! same. What is not: that rounding stays within the margins of module `range`; no directed rounding checks it, and the
//! turning points are those of the rounded `p'`.
//!
//! Near a fold two equilibria approach each other as the root of the load's distance. Where rounding leaves their
//! number open, the place is reported once, as not certified, for all equilibria nearer than [`NEAR`].

mod branch;
mod cell;
mod orders;
mod range;

use std::ops::Range;
use std::rc::Rc;

use super::network::{Network, Vessel};
use super::root::{LEAST_LUMEN, MOST_EQUILIBRIA, Root};
use branch::Branch;
use cell::{At, Bounds, Cell, Choice, Level, Verdict};
use orders::in_all_orders;

/// Cells over which no lumen changes by more than this (over the nominal diameter, or over itself where it is greater)
/// are not halved.
const NARROWEST: f64 = 1e-10;
/// Choices looked at before the search gives up.
const MOST_CHOICES: usize = 200_000;
/// Choices of a cell that are looked at one by one; where there are more, the cell is halved first.
const FEW: usize = 16;
/// Unsettled cells nearer than this to each other are one fold.
const NEAR: f64 = 1e-6;
/// How far out of its cell rounding may put an equilibrium, as a part of a lumen.
const BESIDE: f64 = 1e-9;

/// The search did not end within its bounds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum GaveUp {
    /// After so many choices.
    Choices(usize),
    /// There are more equilibria than this.
    Equilibria(usize),
}

/// Units that are the same.
struct Class {
    members: Vec<usize>,
    /// Where their branches are in [`Search::branches`].
    branches: Range<usize>,
}

struct Search<'a> {
    network: &'a Network,
    classes: Vec<Class>,
    branches: Vec<(Vessel, Branch)>,
    vein: Branch,
    choices: usize,
    roots: Vec<Root>,
    /// Ranges of lumens in which the number of roots is open, the vein's last.
    unsettled: Vec<Vec<[f64; 2]>>,
}

/// Everything with open vessels at which the network rests.
pub(super) fn search(network: &Network) -> Result<Vec<Root>, GaveUp> {
    let inside = network.pressures();
    let Some(&vein) = network.vein.branches(inside).first() else { return Ok(Vec::new()) };
    let (mut classes, mut branches): (Vec<Class>, Vec<(Vessel, Branch)>) = (Vec::new(), Vec::new());
    for (i, unit) in network.units.iter().enumerate() {
        let same = |class: &&mut Class| network.units[class.members[0]] == *unit;
        if let Some(class) = classes.iter_mut().find(same) {
            class.members.push(i);
            continue;
        }
        let first = branches.len();
        branches.extend(unit.branches(inside).into_iter().map(|branch| (*unit, branch)));
        classes.push(Class { members: vec![i], branches: first..branches.len() });
    }
    let (roots, unsettled) = (Vec::new(), Vec::new());
    let mut search = Search { network, classes, branches, vein, choices: 0, roots, unsettled };
    search.run([inside[0].max(vein.pressures[0]), inside[1]])?;
    let mut roots = folds(search.unsettled, search.roots);
    roots.retain(|root| root.units.iter().chain([&root.vein]).all(|&lumen| lumen >= LEAST_LUMEN));
    let classes = search.classes.iter().map(|class| class.members.as_slice());
    let mut roots = in_all_orders(roots, classes).ok_or(GaveUp::Equilibria(MOST_EQUILIBRIA))?;
    roots.sort_by(|a, b| {
        a.vein.total_cmp(&b.vein).then_with(|| a.units.partial_cmp(&b.units).expect("lumens are finite"))
    });
    Ok(roots)
}

impl Search<'_> {
    fn run(&mut self, [least, most]: [f64; 2]) -> Result<(), GaveUp> {
        let mut ends: Vec<f64> = self.branches.iter().flat_map(|(_, branch)| branch.pressures).collect();
        ends.retain(|&end| end > least && end < most);
        ends.extend([least, most]);
        ends.sort_by(f64::total_cmp);
        if least < most {
            ends.dedup();
        }
        let levels: Vec<Rc<Level>> = ends.iter().rev().map(|&end| Rc::new(self.level(end, None))).collect();
        let mut stack: Vec<Cell> = levels.windows(2).map(|pair| [pair[1].clone(), pair[0].clone()]).collect();
        while let Some(cell) = stack.pop() {
            if let Some(middle) = self.settle(&cell)? {
                let middle = Rc::new(self.level(middle, Some(&cell)));
                let [low, high] = cell;
                stack.extend([[middle.clone(), high], [low, middle]]);
            }
        }
        Ok(())
    }

    /// All vessels at a venous pressure, within a cell if there is one.
    fn level(&self, venous: f64, within: Option<&Cell>) -> Level {
        let at = |vessel: &Vessel, branch: &Branch, of: &dyn Fn(&Level) -> Option<At>| {
            let lumen = match within {
                None => branch.at(vessel, venous)?,
                Some([low, high]) => {
                    let (a, b) = (of(low)?.lumen, of(high)?.lumen);
                    vessel.lumen_at(venous, [a.min(b), a.max(b)], branch.rises())
                }
            };
            Some(At::new(vessel, lumen, venous))
        };
        let units = self.branches.iter().enumerate();
        let units = units.map(|(k, (vessel, branch))| at(vessel, branch, &|level: &Level| level.units[k])).collect();
        let vein = at(&self.network.vein, &self.vein, &|level: &Level| Some(level.vein));
        Level { venous, vein: vein.expect("the vein holds every pressure of the range"), units }
    }

    /// Notes the equilibria of a cell where every choice is settled, otherwise returns the pressure at which to halve
    /// it.
    fn settle(&mut self, cell: &Cell) -> Result<Option<f64>, GaveUp> {
        let bounds = Bounds::new(self.network, &self.branches, cell);
        let middle = bounds.middle();
        let mut choices = Vec::new();
        let first = &self.classes[0];
        let from = [0, first.branches.start, first.members.len()];
        if !self.choose(&bounds, from, [0.0; 2], &mut Vec::new(), &mut choices)? {
            return Ok(middle);
        }
        let (mut roots, mut unsettled) = (Vec::new(), Vec::new());
        for choice in &choices {
            let verdict = bounds.verdict(choice);
            if verdict == Verdict::Empty {
                continue;
            }
            let ranges = self.ranges(&bounds, choice);
            let root = if verdict == Verdict::One { self.root(&ranges) } else { None };
            let narrow = ranges.iter().all(|[low, high]| high - low <= NARROWEST * high.max(1.0));
            match root {
                Some(root) => roots.push(root),
                None if narrow || middle.is_none() => unsettled.push(ranges),
                None => return Ok(middle),
            }
        }
        self.roots.extend(roots);
        self.unsettled.extend(unsettled);
        Ok(None)
    }

    /// The choices of branches for the units that are left, `left` of them of this class on branches not before `from`,
    /// that the bounds of `F` don't exclude; `sum` is the conductance of those that have chosen. False where they are
    /// too many for a cell that can be halved.
    fn choose(
        &mut self,
        bounds: &Bounds,
        [class, from, left]: [usize; 3],
        sum: [f64; 2],
        chosen: &mut Choice,
        found: &mut Vec<Choice>,
    ) -> Result<bool, GaveUp> {
        self.choices += 1;
        if self.choices > MOST_CHOICES {
            return Err(GaveUp::Choices(MOST_CHOICES));
        }
        let mut range = sum;
        let mut add = |count: usize, [least, most]: [f64; 2]| {
            range[0] += count as f64 * least;
            range[1] += count as f64 * most;
        };
        for (k, other) in self.classes.iter().enumerate().skip(class) {
            let (from, left) = if k == class { (from, left) } else { (other.branches.start, other.members.len()) };
            if left > 0 {
                let Some(conductances) = bounds.conductances(from..other.branches.end) else { return Ok(true) };
                add(left, conductances);
            }
        }
        if !bounds.may_balance(range) {
            return Ok(true);
        }
        if left == 0 {
            let Some(next) = self.classes.get(class + 1) else {
                found.push(chosen.clone());
                return Ok(found.len() <= FEW || bounds.middle().is_none());
            };
            let next = [class + 1, next.branches.start, next.members.len()];
            return self.choose(bounds, next, sum, chosen, found);
        }
        for k in from..self.classes[class].branches.end {
            let Some([least, most]) = bounds.conductances(k..k + 1) else { continue };
            for count in 1..=left {
                let sum = [sum[0] + count as f64 * least, sum[1] + count as f64 * most];
                chosen.push((k, count));
                let complete = self.choose(bounds, [class, k + 1, left - count], sum, chosen, found)?;
                chosen.pop();
                if !complete {
                    return Ok(false);
                }
            }
        }
        Ok(true)
    }

    /// The lumens of a choice over a cell, those of units that are the same branch by branch, the vein's last.
    fn ranges(&self, bounds: &Bounds, choice: &Choice) -> Vec<[f64; 2]> {
        let sorted = |[a, b]: [f64; 2]| [a.min(b), a.max(b)];
        let mut ranges = vec![[0.0; 2]; self.network.units.len()];
        for class in &self.classes {
            let chosen = choice.iter().filter(|(k, _)| class.branches.contains(k));
            let lumens = chosen.flat_map(|&(k, count)| std::iter::repeat_n(sorted(bounds.lumens(k)), count));
            class.members.iter().zip(lumens).for_each(|(&i, range)| ranges[i] = range);
        }
        ranges.push(sorted(bounds.vein_lumens()));
        ranges
    }

    /// The one equilibrium in these ranges, to its last digits; `None` where it is not reached from their middle.
    fn root(&self, ranges: &[[f64; 2]]) -> Option<Root> {
        let mut units: Vec<f64> = ranges.iter().map(|[low, high]| low + 0.5 * (high - low)).collect();
        let vein = units.pop().expect("a vein");
        let (vein, mut units) = self.network.polish(vein, units)?;
        let within =
            |lumen: f64, [low, high]: [f64; 2]| lumen >= low * (1.0 - BESIDE) && lumen <= high * (1.0 + BESIDE);
        if !units.iter().chain([&vein]).zip(ranges).all(|(&lumen, &range)| within(lumen, range)) {
            return None;
        }
        for pair in self.classes.iter().flat_map(|class| class.members.windows(2)) {
            if ranges[pair[0]] == ranges[pair[1]] {
                units[pair[1]] = units[pair[0]];
            }
        }
        Some(Root { vein, units, certified: true })
    }
}

/// The equilibria, those around unsettled ranges that lie together joined to one that is not certified.
fn folds(unsettled: Vec<Vec<[f64; 2]>>, mut roots: Vec<Root>) -> Vec<Root> {
    let close = |[a, b]: &[f64; 2], [c, d]: &[f64; 2]| {
        let by = NEAR * b.max(1.0);
        a - by <= *d && *c <= b + by
    };
    let near = |one: &[[f64; 2]], other: &[[f64; 2]]| one.iter().zip(other).all(|(a, b)| close(a, b));
    let mut heaps: Vec<Vec<[f64; 2]>> = Vec::new();
    for mut heap in unsettled {
        while let Some(at) = heaps.iter().position(|other| near(&heap, other)) {
            let other = heaps.swap_remove(at);
            heap.iter_mut().zip(other).for_each(|([a, b], [c, d])| (*a, *b) = (a.min(c), b.max(d)));
        }
        heaps.push(heap);
    }
    for heap in heaps {
        roots.retain(|root| {
            let lumens: Vec<[f64; 2]> = root.units.iter().chain([&root.vein]).map(|&lumen| [lumen; 2]).collect();
            !near(&heap, &lumens)
        });
        let mut units: Vec<f64> = heap.iter().map(|[low, high]| low + 0.5 * (high - low)).collect();
        let vein = units.pop().expect("a vein");
        roots.push(Root { vein, units, certified: false });
    }
    roots
}
