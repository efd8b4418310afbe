//! One step: tried, measured, taken, and its polynomial for what lies between.

use super::factors::Factors;
use super::table::{Table, dot};
use crate::load::Inputs;
use crate::model::{Arrow, InputLanes, Model, Scratch};

/// Bounds on the errors of the lumens in a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bounds {
    /// On the estimate where the polynomial is lifted, and its error an order higher than the estimate.
    pub(crate) lifted: f64,
    /// On the estimate where it is not.
    pub(crate) plain: f64,
    /// On the estimate of the lifted polynomial's own error.
    pub(crate) probed: f64,
    /// On what Newton's method may leave.
    pub(crate) newton: f64,
    pub(crate) iterations: u32,
    /// On the height of a layer that may be stepped over.
    pub(crate) layer: f64,
}

/// What came of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Attempt {
    /// Newton's method converged with every lumen open: estimate of the largest error of a lumen, over its bound.
    Done { error: f64 },
    /// An iterate closed this wall's vessel.
    Closed { wall: usize },
    /// Newton's method did not converge, or met numbers that are not finite.
    Diverged,
}

/// A step's memory: nothing is allocated after [`Stepper::new`].
#[derive(Clone)]
pub(crate) struct Stepper<const S: usize> {
    pub(crate) table: &'static Table<S>,
    /// The state at the step's start.
    pub(crate) lumens: Vec<[f64; 1]>,
    pub(crate) rates: Vec<[f64; 1]>,
    /// Increments at the stages.
    pub(super) by_lumen: Vec<[f64; S]>,
    pub(super) by_rate: Vec<[f64; S]>,
    /// Increments of the rates along the eigenvectors.
    pub(super) along: Vec<[f64; S]>,
    /// Increments of the rates over the last accepted step.
    pub(super) last: Vec<[f64; S]>,
    pub(super) change: Vec<[f64; S]>,
    /// Values at the stages.
    pub(crate) stage_lumens: Vec<[f64; S]>,
    pub(crate) stage_rates: Vec<[f64; S]>,
    pub(super) accelerations: Vec<[f64; S]>,
    /// How far the polynomial of the lumens is lifted by the table's bump.
    pub(super) bumps: Vec<f64>,
    /// Accelerations at the start.
    pub(super) first: Vec<[f64; 1]>,
    pub(super) arrow: Arrow,
    pub(super) factors: Factors<S>,
    pub(super) scratch: Scratch<S>,
    pub(super) single: Scratch<1>,
    /// At the start and at the probe of the step.
    pub(super) pair_lumens: Vec<[f64; 2]>,
    pub(super) pair_rates: Vec<[f64; 2]>,
    pub(super) pair: Vec<[f64; 2]>,
    pub(super) pair_scratch: Scratch<2>,
    pub(super) work: [Vec<f64>; 3],
    /// Size of the last accepted step; 0 where there is none to be continued.
    pub(super) last_step: f64,
    /// Convergence of the last step's iteration.
    pub(super) contraction: f64,
    /// Evaluations of the accelerations at one state, and factorizations, since the beginning.
    pub(crate) evaluations: u64,
    pub(crate) factorizations: u64,
    pub(crate) iterations: u64,
}

impl<const S: usize> Stepper<S> {
    pub(crate) fn new(model: &Model, table: &'static Table<S>) -> Self {
        let walls = model.walls();
        let lanes = || vec![[0.0; S]; walls];
        let mut stepper = Stepper {
            table,
            lumens: vec![[1.0]; walls],
            rates: vec![[0.0]; walls],
            by_lumen: lanes(),
            by_rate: lanes(),
            along: lanes(),
            last: lanes(),
            change: lanes(),
            stage_lumens: vec![[1.0; S]; walls],
            stage_rates: lanes(),
            accelerations: lanes(),
            bumps: vec![0.0; walls],
            first: vec![[0.0]; walls],
            arrow: Arrow::default(),
            factors: Factors::new(walls),
            scratch: Scratch::new(model),
            single: Scratch::new(model),
            pair_lumens: vec![[1.0; 2]; walls],
            pair_rates: vec![[0.0; 2]; walls],
            pair: vec![[0.0; 2]; walls],
            pair_scratch: Scratch::new(model),
            work: [(); 3].map(|()| vec![0.0; walls]),
            last_step: 0.0,
            contraction: 1.0,
            evaluations: 0,
            factorizations: 0,
            iterations: 0,
        };
        let [lumens, rates, _] = &stepper.work;
        model.jacobian(lumens, rates, &Inputs::default(), &mut stepper.arrow);
        stepper
    }

    /// Restarts at a state, with all counters at 0.
    pub(crate) fn restart(&mut self, lumens: &[f64], rates: &[f64]) {
        self.place_at(lumens, rates);
        (self.evaluations, self.factorizations, self.iterations) = (0, 0, 0);
    }

    /// Goes on from another state.
    pub(crate) fn place_at(&mut self, lumens: &[f64], rates: &[f64]) {
        for (to, from) in self.lumens.iter_mut().zip(lumens).chain(self.rates.iter_mut().zip(rates)) {
            *to = [*from];
        }
        self.forget();
    }

    pub(crate) fn write_to(&self, lumens: &mut [f64], rates: &mut [f64]) {
        for j in 0..self.lumens.len() {
            (lumens[j], rates[j]) = (self.lumens[j][0], self.rates[j][0]);
        }
    }

    /// The next step does not continue the last one: the inputs jump.
    pub(crate) fn forget(&mut self) {
        self.last_step = 0.0;
        self.contraction = 1.0;
    }

    /// Tries a step of a size from the state, and leaves the state. The inputs: at its start, at the table's probe, at
    /// its stages.
    pub(crate) fn attempt(
        &mut self,
        model: &Model,
        [first, probe]: [&Inputs; 2],
        inputs: &InputLanes<S>,
        step: f64,
        bounds: &Bounds,
    ) -> Attempt {
        self.begin(step);
        let middle = S / 2;
        for j in 0..self.lumens.len() {
            self.work[0][j] = self.stage_lumens[j][middle];
            self.work[1][j] = self.stage_rates[j][middle];
        }
        model.jacobian(&self.work[0], &self.work[1], &inputs.lane(middle), &mut self.arrow);
        self.factors.factor(&self.arrow, &self.table.eigenvalues, step);
        self.factorizations += 1;
        match self.iterate(model, inputs, step, bounds) {
            Ok(()) => {
                let error = self.estimate(model, [first, probe], step, bounds);
                if error.is_finite() { Attempt::Done { error } } else { Attempt::Diverged }
            }
            Err(attempt) => attempt,
        }
    }

    /// Takes the step that was tried: the state moves to its end.
    pub(crate) fn accept(&mut self, step: f64) {
        for j in 0..self.lumens.len() {
            self.lumens[j][0] += self.by_lumen[j][S - 1];
            self.rates[j][0] += self.by_rate[j][S - 1];
        }
        std::mem::swap(&mut self.last, &mut self.by_rate);
        self.last_step = step;
    }

    /// Lumens and rates at a part `theta` of the step that was tried, before it is accepted.
    #[inline]
    pub(crate) fn dense(&self, theta: f64, lumens: &mut [f64], rates: &mut [f64]) {
        let (basis, bump) = (self.table.basis(theta), self.table.bump(theta));
        for j in 0..self.lumens.len() {
            lumens[j] = self.lumens[j][0] + (dot(&basis, &self.by_lumen[j]) + bump * self.bumps[j]);
            rates[j] = self.rates[j][0] + dot(&basis, &self.by_rate[j]);
        }
    }
}
