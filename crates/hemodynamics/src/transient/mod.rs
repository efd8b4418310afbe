//! Transients: the state of the walls over time under given loads, with an error that is known.
//!
//! In: a [`Model`], [`Loads`], a [`State`] to start from, the times asked for (growing, s), [`SolveOptions`]. Out: a
//! [`Trajectory`] with the lumens `d / D` and rates `v / D` at every time asked for, and [`Statistics`]; or a
//! [`SolveFault`] with the part before it.
//!
//! The solver is Radau IIA collocation ([`crate::radau`], internal). It steps from breakpoint to breakpoint of the
//! loads and never across one. At a breakpoint the state is continuous, so the output there is that of the step that
//! ends. `rtol` is what the error `|x - x_exact| / D` of every wall is to stay below at every time asked for. Promised
//! is that each step's own error is estimated twice, by estimates of different orders at different places, and kept
//! well below `rtol`; how far the problem amplifies it later is the problem's conditioning (near a fold, by orders of
//! magnitude). Measured: `rtol` held in all 30 reference responses with every order, and in all of 5040 runs of random
//! models within a factor 2 of the thesis', 1 to 5 units, random loads and starts, at 1e-3 to 1e-12, whose conditioning
//! amplifies no more than twofold (the worst 0.77 `rtol`); with contact and loads up to 2e4 Pa in 2498 of 2500 (the
//! others 1.5 at 1e-12). Errors of the rates are not bounded; beyond the layers they follow those of the displacements.
//!
//! Where a vessel closes under [`crate::Collapse::Error`], or comes within a few `rtol` of it, the run is repeated from
//! its start at the finest tolerance, and that one's time and trajectory are given: a loose tolerance moves the end of
//! a long slow fall by far more than itself.
//!
//! [`simulate`] is the whole of it for one run; [`Solver`] keeps its memory for those who run it ten thousand times.
//! Inside the crate, [`StepObserver`] hears of every accepted step.

mod course;
mod fault;
mod observer;
mod options;
mod trajectory;

pub use fault::SolveFault;
pub(crate) use observer::{AcceptedStep, StepObserver};
pub use options::{Order, SolveOptions};
pub use trajectory::{Statistics, Trajectory};

pub(crate) use course::{Begins, Course, Halt, Pace};

use crate::load::Loads;
use crate::model::{Collapse, InputLanes, Model};
use crate::parameters::Site;
use crate::radau::{Bounds, RADAU5, RADAU9, RADAU13, Stepper, root};
use crate::state::State;

/// The tolerance at which the time of a collapse is found.
const COLLAPSE_RTOL: f64 = 1e-13;
/// A run whose lumens come within so many tolerances of closing is repeated at [`COLLAPSE_RTOL`] too.
const NARROW: f64 = 3.0;

/// The trajectory from `start` at the first of `times_s` (or at [`SolveOptions::start_s`]) at all of `times_s`.
pub fn simulate(
    model: &Model,
    loads: &Loads,
    start: &State,
    times_s: &[f64],
    options: &SolveOptions,
) -> Result<Trajectory, SolveFault> {
    let mut trajectory = Trajectory::default();
    Solver::new(model).run(loads, start, times_s, options, &mut trajectory)?;
    Ok(trajectory)
}

/// The solver with its memory. After the first run of an order, a run allocates only what the trajectory has no room
/// for.
#[derive(Clone)]
pub struct Solver {
    model: Model,
    fifth: Option<Stepper<3>>,
    ninth: Option<Stepper<5>>,
    thirteenth: Option<Stepper<7>>,
}

impl Solver {
    /// A solver of this model.
    pub fn new(model: &Model) -> Solver {
        Solver { model: model.clone(), fifth: None, ninth: None, thirteenth: None }
    }

    /// Solves another model from now on; the memory is kept where it has as many walls.
    pub fn replace(&mut self, model: &Model) {
        if model.walls() == self.model.walls() {
            self.model.clone_from(model);
        } else {
            *self = Solver::new(model);
        }
    }

    /// As [`simulate`], into a trajectory whose memory is used again. After an error it holds nothing; the error has
    /// the part before it.
    pub fn run(
        &mut self,
        loads: &Loads,
        start: &State,
        times_s: &[f64],
        options: &SolveOptions,
        out: &mut Trajectory,
    ) -> Result<(), SolveFault> {
        self.run_observed(loads, start, times_s, options, out, &mut ())
    }

    /// As [`Solver::run`], with an observer of every accepted step.
    pub(crate) fn run_observed(
        &mut self,
        loads: &Loads,
        start: &State,
        times_s: &[f64],
        options: &SolveOptions,
        out: &mut Trajectory,
        observer: &mut impl StepObserver,
    ) -> Result<(), SolveFault> {
        out.begin(self.model.walls(), times_s.len());
        let from_s = options.begins_at(&self.model, start, times_s)?;
        let mut run = Run { loads, start, times_s, from_s, options };
        let first = self.dispatch(&run, out, observer);
        let tight = SolveOptions { rtol: COLLAPSE_RTOL, order: Order::Auto, ..options.clone() };
        let coarse = options.rtol > COLLAPSE_RTOL && options.fixed_step_s.is_none() && observer.times_collapse();
        let in_doubt = match first {
            Ok(narrowest) => self.model.collapse() == Collapse::Error && narrowest < NARROW * options.rtol,
            Err(halt) => matches!(halt, Halt::Collapsed { .. }),
        };
        let last = if in_doubt && coarse {
            out.begin(self.model.walls(), times_s.len());
            run.options = &tight;
            self.dispatch(&run, out, &mut ())
        } else {
            first
        };
        let Err(halt) = last else { return Ok(()) };
        Err(self.fault(halt, out))
    }

    /// With the method of the order. The smallest lumen at any stage.
    fn dispatch(&mut self, run: &Run<'_>, out: &mut Trajectory, observer: &mut impl StepObserver) -> Result<f64, Halt> {
        let model = &self.model;
        match run.options.order.at(run.options.rtol) {
            Order::Fifth => {
                run.drive(model, self.fifth.get_or_insert_with(|| Stepper::new(model, &RADAU5)), out, observer)
            }
            Order::Thirteenth => {
                run.drive(model, self.thirteenth.get_or_insert_with(|| Stepper::new(model, &RADAU13)), out, observer)
            }
            Order::Ninth | Order::Auto => {
                run.drive(model, self.ninth.get_or_insert_with(|| Stepper::new(model, &RADAU9)), out, observer)
            }
        }
    }

    fn fault(&self, halt: Halt, out: &mut Trajectory) -> SolveFault {
        let site = |wall| Site::of_wall(wall, self.model.walls() - 1);
        let before = Box::new(std::mem::take(out));
        match halt {
            Halt::Load { load, time_s, value } => SolveFault::Load { load, time_s, value },
            Halt::Collapsed { wall, time_s } => SolveFault::Collapsed { site: site(wall), time_s, before },
            Halt::Work { time_s } => SolveFault::Work { evaluations: before.statistics.evaluations, time_s, before },
            Halt::Stuck { time_s, step_s, wall } => SolveFault::Stuck { time_s, step_s, site: wall.map(site), before },
        }
    }
}

impl Order {
    /// The order that is taken at a tolerance.
    fn at(self, rtol: f64) -> Order {
        match self {
            Order::Auto if rtol >= FIFTH_FROM => Order::Fifth,
            Order::Auto if rtol < THIRTEENTH_BELOW => Order::Thirteenth,
            Order::Auto => Order::Ninth,
            order => order,
        }
    }
}

/// Newton iterations allowed where no shorter step can be taken instead.
const FIXED_ITERATIONS: u32 = 50;
/// Tolerance from which on the 5th order is the fastest.
const FIFTH_FROM: f64 = 5e-5;
/// Tolerance below which the 13th order is the fastest.
const THIRTEENTH_BELOW: f64 = 3e-11;

/// The bounds of a step that hold a tolerance. Where the polynomial is lifted, its error is of the order `S + 2` in the
/// step, as is the estimate at the probe, and the estimate at the start is of `S + 1`: its bound is the tolerance to
/// the power `(S + 1) / (S + 2)`. The factors are measured on random models (tests/transient/random.rs): with them none
/// of 5040 runs whose conditioning does not amplify more than twofold exceeds its tolerance; the worst reaches 0.77 of
/// it. What Newton's method leaves adds up over the steps of a time constant.
pub(crate) fn bounds<const S: usize>(rtol: f64) -> Bounds {
    Bounds {
        lifted: 0.02 * rtol / root(rtol, S as u32 + 2),
        plain: 0.03 * rtol,
        probed: 0.1 * rtol,
        newton: (0.001 * rtol).max(1e-15),
        iterations: 12,
        layer: 0.3 * rtol,
    }
}

struct Run<'a> {
    loads: &'a Loads,
    start: &'a State,
    times_s: &'a [f64],
    from_s: f64,
    options: &'a SolveOptions,
}

impl Run<'_> {
    fn drive<const S: usize>(
        &self,
        model: &Model,
        stepper: &mut Stepper<S>,
        out: &mut Trajectory,
        observer: &mut impl StepObserver,
    ) -> Result<f64, Halt> {
        let SolveOptions { rtol, fixed_step_s, longest_step_s, most_evaluations, .. } = *self.options;
        let longest = longest_step_s.unwrap_or(f64::INFINITY);
        let mut bounds = bounds::<S>(rtol);
        if fixed_step_s.is_some() {
            bounds.iterations = FIXED_ITERATIONS;
        }
        let mut pace = Pace::new(bounds, fixed_step_s, longest, most_evaluations);
        stepper.restart(&self.start.lumens, &self.start.rates);
        let waiting = self.times_s.partition_point(|&time| time <= self.from_s);
        for &time in &self.times_s[..waiting] {
            let (lumens, rates) = out.push(time);
            lumens.copy_from_slice(&self.start.lumens);
            rates.copy_from_slice(&self.start.rates);
        }
        let until = self.times_s.last().copied().unwrap_or(self.from_s);
        let mut result = Ok(());
        let mut last = None;
        let mut narrowest = f64::INFINITY;
        for segment in self.loads.segments(self.from_s, until) {
            pace.longest_s = longest.min(segment.longest_step_s());
            // Times count from the breakpoint: a step of 1e-11 s is nothing beside a clock's 1.7e9 s.
            let course = Course {
                model,
                from_s: 0.0,
                to_s: segment.to_s - segment.from_s,
                inputs: |time| segment.after(time),
                constant: segment.is_constant(),
                begins: if last == Some(segment.at(segment.from_s)) { Begins::Bend } else { Begins::Jump },
            };
            last = Some(segment.at(segment.to_s));
            result = course
                .cross(stepper, &mut pace, |stepper, from_s, step_s, inputs| {
                    narrowest = stepper.stage_lumens.as_flattened().iter().fold(narrowest, |least, &at| least.min(at));
                    self.put_out(stepper, [segment.from_s, segment.to_s], [from_s, step_s], inputs, out, observer)
                })
                .map_err(|halt| halt.later(segment.from_s));
            if result.is_err() {
                break;
            }
        }
        out.statistics = Statistics {
            stages: S as u32,
            steps: pace.steps,
            rejected: pace.rejected,
            evaluations: stepper.evaluations,
            factorizations: stepper.factorizations,
            iterations: stepper.iterations,
            smallest_step_s: Some(pace.smallest_s).filter(|step_s| step_s.is_finite()),
            largest_step_s: Some(pace.largest_s).filter(|step_s| *step_s > 0.0),
        };
        result.map(|()| narrowest)
    }

    /// Puts out what is asked for in a step. Whether all vessels are open there; if not, nothing is put out.
    fn put_out<const S: usize>(
        &self,
        stepper: &Stepper<S>,
        [begin_s, end_s]: [f64; 2],
        [from_s, step_s]: [f64; 2],
        inputs: &InputLanes<S>,
        out: &mut Trajectory,
        observer: &mut impl StepObserver,
    ) -> bool {
        let begun = out.len();
        let to_s = if from_s + step_s >= end_s - begin_s { end_s } else { begin_s + (from_s + step_s) };
        let mut next = begun;
        while let Some(&time) = self.times_s.get(next).filter(|&&time| time <= to_s) {
            let theta = if time == to_s { 1.0 } else { (((time - begin_s) - from_s) / step_s).min(1.0) };
            let (lumens, rates) = out.push(time);
            stepper.dense(theta, lumens, rates);
            if lumens.iter().any(|&lumen| lumen <= 0.0) {
                out.truncate(begun);
                return false;
            }
            next += 1;
        }
        observer.accepted(&AcceptedStep {
            from_s: begin_s + from_s,
            step_s,
            table: stepper.table,
            stages: [&stepper.stage_lumens, &stepper.stage_rates],
            inputs,
            times_s: &self.times_s[begun..next],
        });
        true
    }
}
