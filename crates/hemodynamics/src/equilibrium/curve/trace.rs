//! Curves through the equilibria at all loads: which belong to one branch, and where branches turn or end.

use std::collections::VecDeque;

use super::follow::{Follower, Place, Tangent};
use super::{LoadPath, Turn, TurnKind};
use crate::equilibrium::root::LEAST_LUMEN;
use crate::equilibrium::{Equilibrium, EquilibriumFault, Stability};
use crate::load::Inputs;
use crate::model::{Collapse, Model};
use crate::parameters::Site;
use crate::state::State;

/// Steps along a curve, over lumens and the load by the range of loads.
const FIRST_STEP: f64 = 1e-3;
const LONGEST_STEP: f64 = 0.1;
const SHORTEST_STEP: f64 = 1e-11;
/// Steps of a curve before giving up.
const MOST_STEPS: usize = 200_000;
/// The least cosine between two neighbouring directions.
const LEAST_COSINE: f64 = 0.98;
/// An equilibrium in numbers and one of the search are the same within this.
const SAME: f64 = 1e-7;

/// What is left of a lumen by rounding where it closes.
const CLOSED: f64 = 1e-12;

/// The branches of all equilibria by load, and the turns.
type Traced = (Vec<Vec<usize>>, Vec<Turn>);

pub(super) struct Tracer<'a> {
    follower: Follower<'a>,
    model: &'a Model,
    loads: Vec<f64>,
    found: &'a [Vec<Equilibrium>],
    branches: Vec<Vec<Option<usize>>>,
    turns: Vec<Turn>,
    next_branch: usize,
}

/// What one leg of a curve passed, in order: equilibria by load and number, and turns.
enum Passed {
    Equilibrium(usize, usize),
    Turn(TurnKind, Place),
}

impl<'a> Tracer<'a> {
    pub(super) fn new(
        model: &'a Model,
        others: Inputs,
        path: LoadPath,
        loads_pa: &[f64],
        found: &'a [Vec<Equilibrium>],
    ) -> Self {
        let (first, last) = (loads_pa[0], loads_pa[loads_pa.len() - 1]);
        let scale_pa = if last > first { last - first } else { 1.0 };
        Tracer {
            follower: Follower::new(model, others, path, scale_pa),
            model,
            loads: loads_pa.iter().map(|load| load / scale_pa).collect(),
            found,
            branches: found.iter().map(|all| vec![None; all.len()]).collect(),
            turns: Vec::new(),
            next_branch: 0,
        }
    }

    pub(super) fn all(mut self) -> Result<Traced, EquilibriumFault> {
        for k in 0..self.loads.len() {
            for m in 0..self.found[k].len() {
                if self.branches[k][m].is_none() {
                    self.curve(k, m)?;
                }
            }
        }
        self.exchanges()?;
        let branches = self.branches.iter().map(|all| {
            all.iter().map(|branch| branch.expect("every equilibrium has been passed by a curve")).collect()
        });
        Ok((branches.collect(), self.turns))
    }

    /// The whole curve through an equilibrium, both ways from it.
    fn curve(&mut self, k: usize, m: usize) -> Result<(), EquilibriumFault> {
        let start = self.place(k, m);
        let mut tangent = self.follower.tangent(&start, None);
        let mut passed = VecDeque::from([Passed::Equilibrium(k, m)]);
        let closed = self.leg(start.clone(), &tangent, (k, m), |one| passed.push_back(one))?;
        if !closed {
            tangent.scale(-1.0);
            self.leg(start, &tangent, (k, m), |one| passed.push_front(one))?;
        }
        self.number(passed, closed);
        Ok(())
    }

    /// Gives the equilibria of a curve their branches: a new one after each fold.
    fn number(&mut self, passed: VecDeque<Passed>, closed: bool) {
        let first = self.next_branch;
        let folds = passed.iter().filter(|one| matches!(one, Passed::Turn(TurnKind::Fold, _))).count();
        // On a closed curve what follows the last fold is the branch that it began with.
        let wraps = closed && folds > 0;
        let mut branch = first;
        for one in passed {
            match one {
                Passed::Equilibrium(k, m) => self.branches[k][m] = Some(branch),
                Passed::Turn(kind, place) => {
                    let mut branches = vec![branch];
                    if kind == TurnKind::Fold {
                        branch = if wraps && branch + 1 == first + folds { first } else { branch + 1 };
                        branches.push(branch);
                    }
                    self.turn(kind, &place, branches);
                }
            }
        }
        self.next_branch = if wraps { first + folds } else { branch + 1 };
    }

    fn turn(&mut self, kind: TurnKind, place: &Place, branches: Vec<usize>) {
        let mut lumens = place.units.clone();
        lumens.push(place.vein);
        if let TurnKind::Closing(_) = kind {
            // With it all units that are the same.
            lumens.iter_mut().filter(|lumen| lumen.abs() < CLOSED).for_each(|lumen| *lumen = 0.0);
        }
        let rates = vec![0.0; lumens.len()];
        let load_pa = place.load * self.follower.scale_pa;
        self.turns.push(Turn { load_pa, kind, state: State { lumens, rates }, branches });
    }

    fn place(&self, k: usize, m: usize) -> Place {
        let mut units = self.found[k][m].state.lumens.clone();
        let vein = units.pop().expect("a vein");
        Place { vein, units, load: self.loads[k] }
    }

    /// Follows a curve one way and reports what it passes; true where it comes back to its start.
    fn leg(
        &self,
        start: Place,
        tangent: &Tangent,
        from: (usize, usize),
        mut report: impl FnMut(Passed),
    ) -> Result<bool, EquilibriumFault> {
        let (mut at, mut tangent) = (start, tangent.clone());
        let mut step = FIRST_STEP;
        let fault = |at: &Place| EquilibriumFault::Curve { load_pa: at.load * self.follower.scale_pa };
        for _ in 0..MOST_STEPS {
            let Some((next, direction, passed)) = self.step(&at, &tangent, step) else {
                step *= 0.5;
                if step < SHORTEST_STEP {
                    return Err(fault(&at));
                }
                continue;
            };
            for one in passed {
                if let Passed::Equilibrium(k, m) = one
                    && (k, m) == from
                {
                    return Ok(true);
                }
                let closing = matches!(one, Passed::Turn(TurnKind::Closing(_), _));
                report(one);
                if closing {
                    return Ok(false);
                }
            }
            if next.load < self.loads[0] || next.load > self.loads[self.loads.len() - 1] {
                return Ok(false);
            }
            if direction.dot(&tangent) > 0.5 * (1.0 + LEAST_COSINE) {
                step = (1.6 * step).min(LONGEST_STEP);
            }
            (at, tangent) = (next, direction);
        }
        Err(fault(&at))
    }

    /// A step and what it passes; `None` where it has to be shorter.
    fn step(&self, at: &Place, tangent: &Tangent, by: f64) -> Option<(Place, Tangent, Vec<Passed>)> {
        let next = self.follower.correct(at.ahead(tangent, by), tangent)?;
        let direction = self.follower.tangent(&next, Some(tangent));
        let cosine = direction.dot(tangent);
        if cosine.is_nan() || cosine < LEAST_COSINE {
            return None;
        }
        let fold = (direction.load * tangent.load < 0.0).then(|| self.fold(at, tangent, by)).flatten();
        if direction.load * tangent.load < 0.0 && fold.is_none() {
            return None;
        }
        let closes = next.least().1 < 0.0;
        if closes && self.model.collapse() == Collapse::Contact {
            // Stepped over the walls' contact.
            return None;
        }
        let end = if closes { self.closing(at, tangent, by)? } else { next.clone() };
        let mut passed = Vec::new();
        match &fold {
            Some(fold) => {
                passed.extend(self.between(at, fold)?);
                passed.push(Passed::Turn(TurnKind::Fold, fold.clone()));
                passed.extend(self.between(fold, &end)?);
            }
            None => passed.extend(self.between(at, &end)?),
        }
        if closes {
            let site = Site::of_wall(end.least().0, end.units.len());
            passed.push(Passed::Turn(TurnKind::Closing(site), end));
        }
        Some((next, direction, passed))
    }

    /// The equilibria at loads that lie between two places of a branch, in order; `None` where one is not met.
    fn between(&self, from: &Place, to: &Place) -> Option<Vec<Passed>> {
        let (low, high) = (from.load.min(to.load), from.load.max(to.load));
        let first = self.loads.partition_point(|&load| load < low);
        let mut met = Vec::new();
        for k in first..self.loads.len() {
            let load = self.loads[k];
            if load > high {
                break;
            }
            // A place on a load belongs to the step that ends there.
            if load == from.load {
                continue;
            }
            let guess = from.between(to, (load - from.load) / (to.load - from.load));
            let (vein, units) = self.follower.network(load).polish(guess.vein, guess.units.clone())?;
            let here = Place { vein, units, load };
            if here.least().1 < 2.0 * LEAST_LUMEN {
                continue;
            }
            let gap = |m: usize| here.gap(&self.found[k][m].state.lumens);
            let m = (0..self.found[k].len()).min_by(|&a, &b| gap(a).total_cmp(&gap(b)))?;
            let chord = from.gap_to(to);
            if gap(m) > SAME || guess.gap(&self.found[k][m].state.lumens) > 0.5 * chord + SAME {
                return None;
            }
            met.push(Passed::Equilibrium(k, m));
        }
        if from.load > to.load {
            met.reverse();
        }
        Some(met)
    }

    /// The fold within a step: where the direction has no part along the load.
    fn fold(&self, at: &Place, tangent: &Tangent, by: f64) -> Option<Place> {
        self.root(at, tangent, by, |place| self.follower.tangent(place, Some(tangent)).load)
    }

    /// Where a lumen closes within a step.
    fn closing(&self, at: &Place, tangent: &Tangent, by: f64) -> Option<Place> {
        self.root(at, tangent, by, |place| place.least().1)
    }

    /// The place of a step at which a function changes its sign, by halving and secants in turn.
    fn root(&self, at: &Place, tangent: &Tangent, by: f64, value: impl Fn(&Place) -> f64) -> Option<Place> {
        let place = |s: f64| self.follower.correct(at.ahead(tangent, s), tangent);
        let (mut a, mut b) = (0.0, by);
        let (mut at_a, mut at_b) = (value(at), value(&place(by)?));
        let mut best = at.clone();
        for round in 0..200 {
            let secant = a + (b - a) * (at_a / (at_a - at_b));
            let s = if round % 3 == 2 || !(secant > a && secant < b) { a + 0.5 * (b - a) } else { secant };
            if s <= a || s >= b || b - a <= 1e-15 * by {
                break;
            }
            best = place(s)?;
            let here = value(&best);
            if here == 0.0 {
                break;
            }
            if (here > 0.0) == (at_a > 0.0) {
                (a, at_a) = (s, here);
            } else {
                (b, at_b) = (s, here);
            }
        }
        Some(best)
    }

    /// Where a branch changes its stability without a fold, between two loads.
    fn exchanges(&mut self) -> Result<(), EquilibriumFault> {
        let mut exchanges = Vec::new();
        for k in 1..self.loads.len() {
            for m in 0..self.found[k].len() {
                let Some(before) =
                    (0..self.found[k - 1].len()).find(|&b| self.branches[k - 1][b] == self.branches[k][m])
                else {
                    continue;
                };
                let (one, other) = (self.found[k - 1][before].stability, self.found[k][m].stability);
                if one != other && one != Stability::Marginal && other != Stability::Marginal {
                    let branch = self.branches[k][m].expect("passed");
                    exchanges.push((self.exchange(self.place(k - 1, before), self.place(k, m), one)?, branch));
                }
            }
        }
        for (place, branch) in exchanges {
            self.turn(TurnKind::Exchange, &place, vec![branch]);
        }
        Ok(())
    }

    /// By halving between two places of a branch, the first of this stability.
    fn exchange(&self, mut from: Place, mut to: Place, first: Stability) -> Result<Place, EquilibriumFault> {
        for _ in 0..60 {
            let guess = from.between(&to, 0.5);
            let (load, network) = (guess.load, self.follower.network(guess.load));
            let Some((vein, units)) = network.polish(guess.vein, guess.units) else { break };
            let here = Place { vein, units, load };
            let stability = Equilibrium::in_numbers(self.model, &self.follower.inputs(load), &here.vein, &here.units)?;
            if load <= from.load.min(to.load) || load >= from.load.max(to.load) {
                break;
            }
            if stability == first {
                from = here;
            } else {
                to = here;
            }
        }
        Ok(to)
    }
}

impl Place {
    /// The greatest difference of a lumen.
    fn gap_to(&self, other: &Place) -> f64 {
        let mut lumens = other.units.clone();
        lumens.push(other.vein);
        self.gap(&lumens)
    }
}
