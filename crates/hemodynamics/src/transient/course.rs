//! Steps across a smooth part of the loads: their size, and what is done where one does not come through.

use crate::load::Inputs;
use crate::model::{Collapse, InputLanes, Model};
use crate::radau::{Attempt, Bounds, Stepper, rough_root};

/// A step is at most so many times as long as the last: what an estimate says of so much longer a step is a guess.
const MOST_GROWTH: f64 = 3.0;
/// And after a rejection at least this part of the one tried.
const MOST_SHRINKING: f64 = 0.05;
/// Of the step that would just hold the tolerance.
const SAFETY: f64 = 0.9;
const AFTER_FAILURE: f64 = 0.25;
/// Of the time that a closing vessel has left at its present rate.
const TOWARDS_CLOSURE: f64 = 0.9;
/// Estimates below this part of their bound say nothing more.
const LEAST_ERROR: f64 = 1e-10;
/// A vessel that closes within this time, s, is closed.
const CLOSED_WITHIN_S: f64 = 1e-10;
/// After a bend in the loads, of the step that would be the first of a run.
const AFTER_BEND: f64 = 0.5;
/// The first step of a run with nothing to go by, s.
const FIRST_STEP_S: f64 = 1e-3;

/// Why a course was not finished.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Halt {
    Load { load: &'static str, time_s: f64, value: f64 },
    Collapsed { wall: usize, time_s: f64 },
    Work { time_s: f64 },
    Stuck { time_s: f64, step_s: f64, wall: Option<usize> },
}

impl Halt {
    /// The same by a clock that began so much earlier, s.
    pub(crate) fn later(mut self, by_s: f64) -> Halt {
        let (Halt::Load { time_s, .. }
        | Halt::Collapsed { time_s, .. }
        | Halt::Work { time_s }
        | Halt::Stuck { time_s, .. }) = &mut self;
        *time_s += by_s;
        self
    }
}

/// Size of the steps over a run.
#[derive(Clone, Debug)]
pub(crate) struct Pace {
    pub(crate) bounds: Bounds,
    pub(crate) fixed_s: Option<f64>,
    pub(crate) longest_s: f64,
    pub(crate) most_evaluations: u64,
    pub(crate) next_s: f64,
    /// Size and estimate of the last accepted step; its size 0 where there is none to go by.
    last: [f64; 2],
    pub(crate) steps: u64,
    pub(crate) rejected: u64,
    pub(crate) smallest_s: f64,
    pub(crate) largest_s: f64,
}

impl Pace {
    pub(crate) fn new(bounds: Bounds, fixed_s: Option<f64>, longest_s: f64, most_evaluations: u64) -> Pace {
        Pace {
            bounds,
            fixed_s,
            longest_s,
            most_evaluations,
            next_s: f64::INFINITY,
            last: [0.0; 2],
            steps: 0,
            rejected: 0,
            smallest_s: f64::INFINITY,
            largest_s: 0.0,
        }
    }

    /// Goes on with a step of this size, whatever was before; with so many evaluations at most, counted from the
    /// stepper's beginning.
    pub(crate) fn restart(&mut self, next_s: f64, most_evaluations: u64) {
        self.next_s = next_s;
        self.last = [0.0; 2];
        self.most_evaluations = most_evaluations;
    }

    /// After an accepted step, of which nothing is known but the estimate of its error (Gustafsson's predictive
    /// control).
    fn accepted(&mut self, step: f64, error: f64, order: u32) {
        self.steps += 1;
        self.smallest_s = self.smallest_s.min(step);
        self.largest_s = self.largest_s.max(step);
        let error = error.max(LEAST_ERROR);
        let mut growth = SAFETY * rough_root(1.0 / error, order);
        if self.last[0] > 0.0 {
            let predicted = SAFETY * (step / self.last[0]) * rough_root(self.last[1] / (error * error), order);
            growth = growth.min(predicted);
        }
        self.last = [step, error];
        self.next_s = step * growth.clamp(MOST_SHRINKING, MOST_GROWTH);
    }

    fn rejected(&mut self, next: f64) {
        self.rejected += 1;
        self.next_s = next;
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Begins {
    /// The inputs jump, or the run begins.
    Jump,
    /// They bend: what the last steps say of the next is no more than a bound.
    Bend,
    /// Nothing: the pace knows.
    Smooth,
}

/// A part of the loads without breakpoints. Its times may count from anywhere: near 0 they are exact to the smallest
/// step.
pub(crate) struct Course<'a, F: Fn(f64) -> Inputs> {
    pub(crate) model: &'a Model,
    pub(crate) from_s: f64,
    pub(crate) to_s: f64,
    pub(crate) inputs: F,
    /// Whether the inputs do not change in it.
    pub(crate) constant: bool,
    /// What happens to the inputs at its start.
    pub(crate) begins: Begins,
}

impl<F: Fn(f64) -> Inputs> Course<'_, F> {
    /// Steps from its start to its end. `listen` hears of each step before it is taken, with the stepper, its start,
    /// its size and the inputs at its stages; it answers whether the vessels are open wherever it looked.
    pub(crate) fn cross<const S: usize>(
        &self,
        stepper: &mut Stepper<S>,
        pace: &mut Pace,
        mut listen: impl FnMut(&Stepper<S>, f64, f64, &InputLanes<S>) -> bool,
    ) -> Result<(), Halt> {
        let order = S as u32 + 1;
        let mut first = self.inputs_at(self.from_s)?;
        let mut lanes = InputLanes::of([first; S]);
        let mut probe = first;
        self.begin(stepper, pace, &first);
        let (mut t, mut closing) = (self.from_s, false);
        while t < self.to_s {
            let mut wanted = pace.next_s.min(pace.longest_s);
            if closing {
                let (wall, time) = time_to_closure(stepper);
                if self.model.collapse() == Collapse::Error && time <= CLOSED_WITHIN_S {
                    return Err(Halt::Collapsed { wall, time_s: t + time });
                }
                wanted = wanted.min(TOWARDS_CLOSURE * time);
            }
            let left = self.to_s - t;
            let until = if let Some(fixed) = pace.fixed_s {
                t + left / (left / fixed - 1e-6).ceil().max(1.0)
            } else if wanted * 1.000_001 >= left {
                self.to_s
            } else if wanted * 1.6 >= left {
                t + 0.5 * left
            } else {
                t + wanted
            };
            let until = if until * (1.0 + f64::EPSILON) >= self.to_s { self.to_s } else { until };
            let step = until - t;
            if until < self.to_s && (step <= 4.0 * f64::EPSILON * t.abs() || step <= f64::MIN_POSITIVE) {
                return Err(Halt::Stuck { time_s: t, step_s: step, wall: None });
            }
            if stepper.evaluations >= pace.most_evaluations {
                return Err(Halt::Work { time_s: t });
            }
            if !self.constant {
                let mut at = [first; S];
                for (input, node) in at.iter_mut().zip(&stepper.table.nodes) {
                    *input = self.inputs_at(if *node == 1.0 { until } else { t + node * step })?;
                }
                lanes = InputLanes::of(at);
                probe = self.inputs_at(t + stepper.table.probe * step)?;
            }
            match stepper.attempt(self.model, [&first, &probe], &lanes, step, &pace.bounds) {
                Attempt::Done { error } if error <= 1.0 || pace.fixed_s.is_some() => {
                    if !listen(stepper, t, step, &lanes) {
                        closing = true;
                        pace.rejected(0.5 * step);
                        continue;
                    }
                    stepper.accept(step);
                    let asked = pace.next_s;
                    pace.accepted(step, error, order);
                    if until == self.to_s && step < asked {
                        // Cut short by the end, not by its error.
                        pace.next_s = pace.next_s.max(asked);
                    }
                    t = until;
                    first = lanes.lane(S - 1);
                }
                Attempt::Done { error } => {
                    let shrinking = SAFETY * rough_root(1.0 / error, order);
                    pace.rejected(step * shrinking.max(MOST_SHRINKING));
                }
                failed if pace.fixed_s.is_some() => {
                    let wall = if let Attempt::Closed { wall } = failed { Some(wall) } else { None };
                    return Err(Halt::Stuck { time_s: t, step_s: step, wall });
                }
                Attempt::Diverged => pace.rejected(AFTER_FAILURE * step),
                Attempt::Closed { wall } => {
                    closing = true;
                    pace.rejected(0.5 * step);
                    if step <= 1e-14 * t.abs().max(1e-3) {
                        return Err(Halt::Stuck { time_s: t, step_s: step, wall: Some(wall) });
                    }
                }
            }
        }
        Ok(())
    }

    /// Begins after a breakpoint: where the inputs jump, with a step for what comes after it.
    fn begin<const S: usize>(&self, stepper: &mut Stepper<S>, pace: &mut Pace, first: &Inputs) {
        if self.begins == Begins::Smooth {
            return;
        }
        stepper.forget();
        pace.last = [0.0; 2];
        let first_step = stepper.first_step(self.model, first, &pace.bounds).min(self.to_s - self.from_s);
        pace.next_s = match self.begins {
            Begins::Bend => pace.next_s.min(AFTER_BEND * first_step),
            _ if self.constant => first_step,
            _ => first_step.min(FIRST_STEP_S),
        };
    }

    /// The inputs at a time, all finite.
    fn inputs_at(&self, time_s: f64) -> Result<Inputs, Halt> {
        let inputs = (self.inputs)(time_s);
        inputs.check(|load, value| Halt::Load { load, time_s, value })?;
        Ok(inputs)
    }
}

/// The wall that would close first at the walls' present rates, and in what time, s.
fn time_to_closure<const S: usize>(stepper: &Stepper<S>) -> (usize, f64) {
    let mut soonest = (0, f64::INFINITY);
    for (j, (lumen, rate)) in stepper.lumens.iter().zip(&stepper.rates).enumerate() {
        let time = -lumen[0] / rate[0];
        if rate[0] < 0.0 && time < soonest.1 {
            soonest = (j, time);
        }
    }
    soonest
}
