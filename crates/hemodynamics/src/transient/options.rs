//! How a transient is solved.

use super::fault::SolveFault;
use crate::model::Model;
use crate::state::State;

/// Tolerances that can be asked for.
const TOLERANCES: [f64; 2] = [1e-13, 1e-1];

/// The order of the method.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Order {
    /// The one that is fastest at the tolerance.
    #[default]
    Auto,
    /// Radau IIA with 3 stages.
    Fifth,
    /// Radau IIA with 5 stages.
    Ninth,
    /// Radau IIA with 7 stages.
    Thirteenth,
}

/// How a transient is solved. [`SolveOptions::default`] asks for `rtol = 1e-8` and bounds the work at ten million
/// evaluations.
#[derive(Clone, Debug, PartialEq)]
pub struct SolveOptions {
    /// The largest error of a displacement over its nominal diameter, `|x - x_exact| / D`, at every time asked for;
    /// 1e-13 to 1e-1.
    pub rtol: f64,
    /// The order of the method.
    pub order: Order,
    /// When the run starts, s; the first of the times asked for where there is none.
    pub start_s: Option<f64>,
    /// Steps of this size (s) instead of steps chosen by the tolerance; between two breakpoints of the loads they are
    /// shortened to equal ones. The tolerance then bounds the error of Newton's method alone.
    pub fixed_step_s: Option<f64>,
    /// No step is longer than this, s: for loads given as functions whose short pulses have no breakpoints.
    pub longest_step_s: Option<f64>,
    /// The run gives up after so many evaluations of the accelerations (one is all walls at one state: an iteration of
    /// a method with 5 stages takes 5).
    pub most_evaluations: u64,
}

impl Default for SolveOptions {
    fn default() -> Self {
        SolveOptions {
            rtol: 1e-8,
            order: Order::Auto,
            start_s: None,
            fixed_step_s: None,
            longest_step_s: None,
            most_evaluations: 10_000_000,
        }
    }
}

impl SolveOptions {
    /// The defaults at a tolerance.
    pub fn at(rtol: f64) -> SolveOptions {
        SolveOptions { rtol, ..SolveOptions::default() }
    }

    pub(crate) fn check(&self) -> Result<(), SolveFault> {
        if !(self.rtol >= TOLERANCES[0] && self.rtol <= TOLERANCES[1]) {
            return Err(SolveFault::Tolerance { rtol: self.rtol });
        }
        for (what, value) in [("the fixed step", self.fixed_step_s), ("the longest step", self.longest_step_s)] {
            if let Some(value) = value
                && !(value > 0.0 && value.is_finite())
            {
                return Err(SolveFault::Option { what, value });
            }
        }
        match self.start_s {
            Some(value) if !value.is_finite() => Err(SolveFault::Option { what: "the start", value }),
            _ => Ok(()),
        }
    }

    /// Whether a run from `start` through `times_s` can be asked for with these options; where it begins, s.
    pub(crate) fn begins_at(&self, model: &Model, start: &State, times_s: &[f64]) -> Result<f64, SolveFault> {
        self.check()?;
        start.check_walls(model.walls())?;
        let from_s = self.start_s.or(times_s.first().copied()).ok_or(SolveFault::NoTimes)?;
        let mut before_s = from_s;
        for (row, &time_s) in times_s.iter().enumerate() {
            if !(time_s >= before_s && time_s.is_finite()) {
                return Err(SolveFault::Times { row: row + 1, time_s, before_s });
            }
            before_s = time_s;
        }
        Ok(from_s)
    }
}
