//! The model driven by a sensor: one implicit step a sample.
//!
//! In: the inputs at every sample, a fixed time apart. Between two samples they are taken as straight. Out: the state
//! at the sample.
//!
//! A sample is one step of Radau IIA with 5 stages. Where the estimate of its error or Newton's method ask for it (a
//! load that jumps between two samples, a vessel that closes), the step is cut into shorter ones, in bounded work. The
//! error against the exact response to the same straight pieces is below 1e-8 D at 1 kHz, for a touch that rises within
//! 50 ms over beating blood, and for one that jumps within a sample (tests). A sample that fails leaves the state of
//! the last one that did not; the next goes on from that state and the failed sample's inputs, if those were numbers.

use crate::load::Inputs;
use crate::model::Model;
use crate::parameters::Site;
use crate::radau::{Bounds, RADAU9, Stepper};
use crate::state::{State, StateFault};
use crate::transient::{Begins, Course, Halt, Pace, bounds};

/// The tolerance, `|x - x_exact| / D`.
const RTOL: f64 = 1e-8;
/// Only the steps' ends are put out, where the error of a layer that is stepped over has gone by: the bounds on the
/// estimates within the step are so many times wider.
const WIDER_LIFTED: f64 = 30.0;
const WIDER_PLAIN: f64 = 300.0;
const WIDER_PROBED: f64 = 10.0;
/// The evaluations that a sample may take.
const MOST_EVALUATIONS: u64 = 100_000;

/// The model driven sample by sample.
#[derive(Clone)]
pub struct Live {
    model: Model,
    stepper: Stepper<5>,
    pace: Pace,
    state: State,
    inputs: Inputs,
    sample_s: f64,
    samples: u64,
    failed: u64,
}

/// How the samples went.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LiveStatistics {
    /// Samples taken.
    pub samples: u64,
    /// Samples that failed.
    pub failed: u64,
    /// Steps accepted, one a sample at best.
    pub steps: u64,
    /// Steps tried and rejected.
    pub rejected: u64,
    /// Evaluations of the accelerations of all walls at one state.
    pub evaluations: u64,
    /// Newton iterations.
    pub iterations: u64,
}

/// Why a sample, or the beginning, failed.
#[derive(Debug, thiserror::Error, Clone, PartialEq)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum LiveFault {
    #[error("the start can't be used: {0}")]
    Start(#[from] StateFault),
    #[error("the time between samples is {0} s; it has to be finite and longer than 0")]
    Sample(f64),
    #[error("the load {load} of the sample is {value}; it has to be a finite pressure")]
    Input { load: &'static str, value: f64 },
    #[error("{site} closes {after_s} s after the last sample; the state is still that of the last sample")]
    Collapsed { site: Site, after_s: f64 },
    #[error(
        "the equations can't be solved {after_s} s after the last sample; the state is still that of the last sample"
    )]
    Stuck { after_s: f64 },
}

impl Live {
    /// From a state and the inputs at its moment; `sample_s` from one sample to the next, s.
    pub fn new(model: &Model, start: &State, inputs: &Inputs, sample_s: f64) -> Result<Live, LiveFault> {
        if !(sample_s > 0.0 && sample_s.is_finite()) {
            return Err(LiveFault::Sample(sample_s));
        }
        let bounds = bounds::<5>(RTOL);
        let bounds = Bounds {
            lifted: WIDER_LIFTED * bounds.lifted,
            plain: WIDER_PLAIN * bounds.plain,
            probed: WIDER_PROBED * bounds.probed,
            ..bounds
        };
        let mut live = Live {
            model: model.clone(),
            stepper: Stepper::new(model, &RADAU9),
            pace: Pace::new(bounds, None, f64::INFINITY, MOST_EVALUATIONS),
            state: start.clone(),
            inputs: *inputs,
            sample_s,
            samples: 0,
            failed: 0,
        };
        live.restart(start, inputs)?;
        Ok(live)
    }

    /// Goes on from another state and other inputs.
    pub fn restart(&mut self, start: &State, inputs: &Inputs) -> Result<(), LiveFault> {
        start.check_walls(self.model.walls())?;
        inputs.check(|load, value| LiveFault::Input { load, value })?;
        self.state.clone_from(start);
        self.inputs = *inputs;
        self.stepper.place_at(&start.lumens, &start.rates);
        Ok(())
    }

    /// One sample on: the state when the inputs have gone straight to these.
    pub fn sample(&mut self, inputs: &Inputs) -> Result<&State, LiveFault> {
        inputs.check(|load, value| LiveFault::Input { load, value })?;
        let (from, to, per_s) = (self.inputs, *inputs, 1.0 / self.sample_s);
        self.pace.restart(self.sample_s, self.stepper.evaluations + MOST_EVALUATIONS);
        let course = Course {
            model: &self.model,
            from_s: 0.0,
            to_s: self.sample_s,
            inputs: |time_s| between(&from, &to, time_s * per_s),
            constant: from == to,
            begins: Begins::Smooth,
        };
        match course.cross(&mut self.stepper, &mut self.pace, |_, _, _, _| true) {
            Ok(()) => {
                self.samples += 1;
                self.inputs = to;
                self.stepper.write_to(&mut self.state.lumens, &mut self.state.rates);
                Ok(&self.state)
            }
            Err(halt) => {
                self.failed += 1;
                // What made it fail has come all the same: the next sample goes on from there, not from the load before
                // it.
                self.inputs = to;
                self.stepper.place_at(&self.state.lumens, &self.state.rates);
                Err(match halt {
                    Halt::Collapsed { wall, time_s } => {
                        LiveFault::Collapsed { site: Site::of_wall(wall, self.model.walls() - 1), after_s: time_s }
                    }
                    Halt::Load { load, value, .. } => LiveFault::Input { load, value },
                    Halt::Work { time_s } | Halt::Stuck { time_s, .. } => LiveFault::Stuck { after_s: time_s },
                })
            }
        }
    }

    /// The state at the last sample.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// How the samples went.
    pub fn statistics(&self) -> LiveStatistics {
        LiveStatistics {
            samples: self.samples,
            failed: self.failed,
            steps: self.pace.steps,
            rejected: self.pace.rejected,
            evaluations: self.stepper.evaluations,
            iterations: self.stepper.iterations,
        }
    }
}

/// The inputs at a part of the way from one sample to the next, those of the samples to the last digit.
fn between(from: &Inputs, to: &Inputs, part: f64) -> Inputs {
    if part >= 1.0 {
        return *to;
    }
    let line = |a: f64, b: f64| a + part * (b - a);
    Inputs {
        upstream_pa: line(from.upstream_pa, to.upstream_pa),
        downstream_pa: line(from.downstream_pa, to.downstream_pa),
        proximal_pa: line(from.proximal_pa, to.proximal_pa),
        distal_pa: line(from.distal_pa, to.distal_pa),
    }
}
