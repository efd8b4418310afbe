//! Which equilibrium is reached from a state: where there are several, the path decides.
//!
//! The transient from the state under the constant load is solved until it comes to rest at one of the stable
//! equilibria; the answer is that equilibrium as the search knows it, to its last digits, and when the walls were
//! there.

use super::{Equilibrium, EquilibriumFault, Stability, equilibria};
use crate::load::{Inputs, Load, Loads};
use crate::model::Model;
use crate::state::State;
use crate::transient::{SolveFault, SolveOptions, Solver, Trajectory};

/// Tolerance of the transient, over the nominal diameters.
const RTOL: f64 = 1e-11;
/// Walls this near to an equilibrium (over the nominal diameters) have come to rest, by default.
pub const AT_REST: f64 = 1e-6;
/// Times looked at in a span.
const SAMPLES: usize = 64;
/// Spans, each twice as long as that before it.
const MOST_SPANS: usize = 40;
/// Evaluations in a span.
const MOST_EVALUATIONS: u64 = 300_000;

/// An equilibrium that was reached.
#[derive(Clone, Debug, PartialEq)]
pub struct Reached {
    /// The equilibrium.
    pub equilibrium: Equilibrium,
    /// How long the walls took to come within the distance and stay there, s.
    pub settled_s: f64,
}

/// Why none was reached.
#[derive(Debug, thiserror::Error, Clone, PartialEq)]
pub enum ReachFault {
    /// The equilibria are not known.
    #[error(transparent)]
    Equilibria(#[from] EquilibriumFault),
    /// A vessel closes on the way, or the transient could not be solved.
    #[error("on the way to an equilibrium: {0}")]
    Transient(#[from] SolveFault),
    /// A distance to an equilibrium that is not positive.
    #[error(
        "walls can't be at rest to within {within} nominal diameters; the distance has to be at least 1e-8 and less \
         than 0.1"
    )]
    Within {
        /// The distance, in nominal diameters.
        within: f64,
    },
    /// The walls don't come to rest.
    #[error("after {time_s} s the walls are at no stable equilibrium ({stable} are there)")]
    Restless {
        /// When it was given up, s.
        time_s: f64,
        /// Stable equilibria.
        stable: usize,
    },
}

/// The stable equilibrium that is reached from a state under constant inputs, the walls at rest within `within` nominal
/// diameters ([`AT_REST`]). An error where a vessel closes on the way or the walls don't come to rest.
pub fn reached_from(model: &Model, inputs: &Inputs, start: &State, within: f64) -> Result<Reached, ReachFault> {
    if !(1e-8..0.1).contains(&within) {
        return Err(ReachFault::Within { within });
    }
    let mut stable = equilibria(model, inputs)?;
    stable.retain(|one| one.stability == Stability::Stable);
    let slowest = stable.iter().filter_map(Equilibrium::slowest_s).fold(0.0, f64::max);
    let constant = |value| Load::constant(value).expect("equilibria are found for finite inputs only");
    let loads = Loads {
        upstream: constant(inputs.upstream_pa),
        downstream: constant(inputs.downstream_pa),
        proximal: constant(inputs.proximal_pa),
        distal: constant(inputs.distal_pa),
    };
    let mut run = Run {
        solver: Solver::new(model),
        loads,
        trajectory: Trajectory::default(),
        options: SolveOptions { rtol: RTOL, most_evaluations: MOST_EVALUATIONS, ..SolveOptions::default() },
    };
    let (mut from, mut begin, mut span) = (start.clone(), 0.0, if slowest > 0.0 { slowest } else { 1.0 });
    let mut spans = Vec::new();
    for _ in 0..MOST_SPANS {
        run.over(&from, begin, span)?;
        spans.push((from, begin, span));
        let last = run.trajectory.state(run.trajectory.len() - 1);
        // Far enough inside that it stays.
        if let Some(equilibrium) = stable.iter().find(|one| gap(&last.lumens, one) <= 0.1 * within) {
            let settled_s = run.settled(spans, equilibrium, within)?;
            return Ok(Reached { equilibrium: equilibrium.clone(), settled_s });
        }
        from = last;
        begin += span;
        span *= 2.0;
    }
    Err(ReachFault::Restless { time_s: begin, stable: stable.len() })
}

struct Run {
    solver: Solver,
    loads: Loads,
    trajectory: Trajectory,
    options: SolveOptions,
}

impl Run {
    /// The transient over a span, at equal distances.
    fn over(&mut self, from: &State, begin: f64, span: f64) -> Result<(), SolveFault> {
        let times: Vec<f64> = (0..=SAMPLES).map(|k| begin + span * (k as f64 / SAMPLES as f64)).collect();
        self.solver.run(&self.loads, from, &times, &self.options, &mut self.trajectory)
    }

    /// When the walls came within a distance of an equilibrium for good, in the spans from the first on.
    fn settled(
        &mut self,
        mut spans: Vec<(State, f64, f64)>,
        equilibrium: &Equilibrium,
        within: f64,
    ) -> Result<f64, SolveFault> {
        let mut settled_s = 0.0;
        while let Some((from, begin, span)) = spans.pop() {
            self.over(&from, begin, span)?;
            if let Some(k) = self.last_outside(equilibrium, within) {
                settled_s = self.narrowed(k, equilibrium, within)?;
                break;
            }
        }
        Ok(settled_s)
    }

    /// The last time at which the walls are further away than that.
    fn last_outside(&self, equilibrium: &Equilibrium, within: f64) -> Option<usize> {
        (0..=SAMPLES).rev().find(|&k| gap(self.trajectory.lumens(k), equilibrium) > within)
    }

    /// When they come within it after time `k`: each round narrows it by the number of samples.
    fn narrowed(&mut self, mut k: usize, equilibrium: &Equilibrium, within: f64) -> Result<f64, SolveFault> {
        let mut settled_s = self.trajectory.times_s()[k];
        for _ in 0..3 {
            let Some(&end_s) = self.trajectory.times_s().get(k + 1) else { break };
            let from = self.trajectory.state(k);
            self.over(&from, settled_s, end_s - settled_s)?;
            k = self.last_outside(equilibrium, within).unwrap_or(0);
            settled_s = self.trajectory.times_s()[k];
        }
        Ok(settled_s)
    }
}

/// The greatest distance of a lumen to an equilibrium's.
fn gap(lumens: &[f64], equilibrium: &Equilibrium) -> f64 {
    lumens.iter().zip(&equilibrium.state.lumens).fold(0.0, |gap, (a, b)| gap.max((a - b).abs()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::equilibrium::rest;
    use crate::equilibrium::tests::{load, soft, thesis};
    use crate::model::Collapse;

    #[test]
    fn in_a_bistable_set_the_path_decides() {
        let model = Model::new(&soft(), Collapse::Error);
        let mut state = rest(&model, &load(0.0, 0.0)).unwrap().state;
        let mut lumens = Vec::new();
        // Up to beyond the upper fold (5846 Pa), and down again to below the lower one (3775 Pa).
        for distal in [3000.0, 5000.0, 5800.0, 5860.0, 5000.0, 3800.0, 3000.0] {
            let reached = reached_from(&model, &load(0.0, distal), &state, AT_REST).unwrap();
            assert!(reached.equilibrium.stability == Stability::Stable);
            assert!(reached.settled_s > 0.0 && reached.settled_s < 100.0, "{}", reached.settled_s);
            state = reached.equilibrium.state;
            lumens.push(state.lumens[1]);
        }
        assert!(lumens[1] > 1.5 && lumens[4] < 0.5, "the two branches at 5000 Pa: {lumens:?}");
        assert!(lumens[0] == lumens[6], "one branch at 3000 Pa: {lumens:?}");
        assert!(lumens[5] < 0.7, "still on the lower branch at 3800 Pa: {lumens:?}");
    }

    #[test]
    fn the_time_is_that_of_the_slowest_motion() {
        let model = thesis(Collapse::Error);
        let target = rest(&model, &load(0.0, 0.0)).unwrap();
        let mut start = target.state.clone();
        start.lumens[0] += 1e-3;
        let [rough, fine] =
            [1e-6, 1e-7].map(|within| reached_from(&model, &load(0.0, 0.0), &start, within).unwrap().settled_s);
        // A tenth of the distance takes ln 10 of the slowest time constant.
        let expected = std::f64::consts::LN_10 * target.slowest_s().unwrap();
        assert!(((fine - rough) / expected - 1.0).abs() <= 0.01, "{rough} {fine} {expected}");
    }

    #[test]
    fn who_collapses_reaches_nothing() {
        let model = thesis(Collapse::Error);
        let start = rest(&model, &load(0.0, 0.0)).unwrap().state;
        let fault = reached_from(&model, &load(2e4, 0.0), &start, AT_REST).unwrap_err();
        assert!(matches!(fault, ReachFault::Transient(SolveFault::Collapsed { .. })), "{fault}");
        assert!(matches!(reached_from(&model, &load(0.0, 0.0), &start, f64::NAN), Err(ReachFault::Within { .. })));
    }
}
