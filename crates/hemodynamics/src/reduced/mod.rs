//! Reduced models: the walls' inertia dropped, or corrected for to first order, with the model's own error told.
//!
//! In: what [`crate::simulate`] takes, and [`Inertia`]. Out: [`Reduced`], a trajectory and how far the reduced model strays from the full one.
//!
//! The thesis' walls have masses that matter for microseconds (1e-7 s capillaries, 6e-6 s the vein) in responses that take a tenth of a
//! second. With the masses gone, equation 2 is `R(x) v = F(x, u)` in half as many states, no longer stiff: an explicit method does
//! ([`pair`]), and the network is solved in a time that goes with the number of units ([`drag`]). Singular perturbation gives the next
//! order: a term in the rates that goes with the masses ([`flow`]), and the distance that the walls cover in the layer after a load jumps,
//! before their inertia wears off ([`layer`]). Inside the layer the corrected model's outputs follow it.
//!
//! **Error of the model**, measured on steps of 1000 to 10 000 Pa of the thesis' table, proximal, distal and both, against 60 digits:
//! [`Inertia::Dropped`] 1e-7 to 4e-4 of `D` (a vein lags by 4e-4 under 1 N/cm2, of which 1.1e-4 is left after 10 ms),
//! [`Inertia::Corrected`] 2e-11 to 2.5e-7. What [`Reduced::model_error`] tells is the first neglected term carried along the path
//! ([`neglected`]): 1.0 to 1.1 times the true error dropped, 0.6 to 1.1 times corrected. The errors go with the masses, and with their
//! square: at 1 kg it says that neither will do. The error of the explicit method comes on top and is bounded by the tolerance: one far
//! below the model's error is wasted work.
//!
//! **Time**, the full model's solver being what it is: none is gained. At rtol 1e-4 a response of 4 s with 400 outputs takes as long dropped
//! as full, and half as long again corrected (`examples/reduced.rs`), for 2 units as for 50. What is gained is a model without stiffness, of
//! half the states, for those who bring a solver of their own, and a measure of what the inertia does.
//!
//! The explicit method is adaptive at all times: a fixed step is taken as the longest one. Under [`crate::Collapse::Contact`] pressed walls
//! make even the reduced model stiff; then the evaluations allowed are soon spent, and the error says so.
//! A vessel's closing is found as in the full model, to 1e-9 s of the reduced model's own time (which is 4e-6 s off dropped, 1e-9 s
//! corrected, at 1.2e4 Pa).

mod drag;
mod fault;
mod flow;
mod layer;
mod neglected;
mod pair;
mod run;
#[cfg(test)]
mod tests;

pub use fault::ReducedFault;

use crate::load::Loads;
use crate::model::Model;
use crate::parameters::Site;
use crate::state::State;
use crate::transient::{SolveFault, SolveOptions, Statistics, Stopped, Trajectory, simulate};
use run::{Bounds, Halt, Run};

/// What becomes of the walls' inertia.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Inertia {
    /// It is solved for: the model as it is.
    #[default]
    Full,
    /// It is dropped: `m = 0`. The thesis' walls then stray by up to 4e-4 `D` under 1 N/cm2. A load's jump makes the rates jump.
    Dropped,
    /// It is corrected for to first order in the masses, with the layers of microseconds after a load's jump: up to 2.5e-7 `D`.
    Corrected,
}

/// A trajectory of a reduced model.
#[derive(Clone, Debug, PartialEq)]
pub struct Reduced {
    /// Lumens and rates at the times asked for.
    pub trajectory: Trajectory,
    /// An estimate of the largest `|x - x_full| / D` of any wall up to the last time, as the reduced model causes it; 0 for the full model,
    /// infinite where it could not be told. The explicit method's error, bounded by the tolerance, comes on top.
    pub model_error: f64,
}

/// The tolerance at which the time of a collapse is found.
const COLLAPSE_RTOL: f64 = 1e-12;

/// As [`simulate`], with a choice of what becomes of the walls' inertia; [`Inertia::Full`] is [`simulate`] itself.
///
/// The reduced models are solved by an explicit method of order 5 with steps chosen by the tolerance, whatever [`SolveOptions::order`] says and
/// with [`SolveOptions::fixed_step_s`] as the longest step. The rates of `start` count but for [`Inertia::Dropped`]. Errors are those of
/// [`simulate`], and what only reduced models have ([`ReducedFault`]).
pub fn simulate_reduced(
    model: &Model,
    loads: &Loads,
    start: &State,
    times_s: &[f64],
    options: &SolveOptions,
    inertia: Inertia,
) -> Result<Reduced, ReducedFault> {
    if inertia == Inertia::Full {
        return Ok(Reduced { trajectory: simulate(model, loads, start, times_s, options)?, model_error: 0.0 });
    }
    let from_s = check(model, start, times_s, options)?;
    let mut trajectory = Trajectory::default();
    let mut bounds = Bounds {
        rtol: options.rtol,
        most_evaluations: options.most_evaluations,
        longest_step_s: [options.fixed_step_s, options.longest_step_s]
            .into_iter()
            .flatten()
            .fold(f64::INFINITY, f64::min),
    };
    loop {
        let mut run = Run::new(model, inertia, bounds);
        trajectory.begin(model.walls(), times_s.len());
        let result = run.over(loads, start, from_s, times_s, |time_s, lumens, rates| {
            let (own_lumens, own_rates) = trajectory.push(time_s);
            own_lumens.copy_from_slice(lumens);
            own_rates.copy_from_slice(rates);
        });
        trajectory.statistics = Statistics { stages: pair::STAGES as u32, ..run.statistics };
        match result {
            Ok(()) => return Ok(Reduced { trajectory, model_error: run.model_error() }),
            Err(Halt::Closed(..)) if bounds.rtol > COLLAPSE_RTOL => bounds.rtol = COLLAPSE_RTOL,
            Err(halt) => return Err(fault(model, halt, trajectory)),
        }
    }
}

/// What [`simulate`] checks, and that every wall has something to hold it back; where the run starts, s.
fn check(model: &Model, start: &State, times_s: &[f64], options: &SolveOptions) -> Result<f64, ReducedFault> {
    let from_s = options.begins_at(model, start, times_s)?;
    let undamped = |i: &usize| model.walls[*i].damper == 0.0 && model.units[*i].resistance == 0.0;
    match (0..model.units.len()).find(undamped) {
        Some(i) => Err(ReducedFault::Undamped { site: Site::Capillary(i) }),
        None => Ok(from_s),
    }
}

fn fault(model: &Model, halt: Halt, mut before: Trajectory) -> ReducedFault {
    let site = |wall| Site::of_wall(wall, model.units.len());
    before.statistics.stopped = match halt {
        Halt::Closed(..) => Stopped::Collapsed,
        Halt::Work(..) => Stopped::Work,
        Halt::Load { .. } => Stopped::Load,
        Halt::Stuck(..) | Halt::Layer(..) => Stopped::Stuck,
    };
    let evaluations = before.statistics.evaluations;
    let before = Box::new(before);
    match halt {
        Halt::Closed(wall, time_s) => SolveFault::Collapsed { site: site(wall), time_s, before }.into(),
        Halt::Work(time_s, true) => ReducedFault::Stiff { evaluations, time_s, before },
        Halt::Work(time_s, false) => SolveFault::Work { evaluations, time_s, before }.into(),
        Halt::Stuck(time_s, step_s) => SolveFault::Stuck { time_s, step_s, site: None, before }.into(),
        Halt::Load { load, time_s, value } => SolveFault::Load { load, time_s, value }.into(),
        Halt::Layer(wall, time_s) => ReducedFault::Layer { site: site(wall), time_s },
    }
}
