//! Newton's iteration on the stages, and the values that it begins with.

use super::step::{Attempt, Bounds, Stepper};
use super::table::{matvec, times};
use crate::model::{InputLanes, Model};

/// How often an iterate that closes a vessel is pulled halfway back before the step is given up.
const MOST_HALVINGS: u32 = 4;
/// The last polynomial is continued over a step at most so many times as long.
const LONGEST_CONTINUATION: f64 = 4.0;
/// And as long as its rates grow by no more than this.
const FURTHEST_RATE: f64 = 2.0;
/// A first change of a lumen beyond this says nothing about the convergence.
const LARGE_CHANGE: f64 = 0.2;
/// Changes of a lumen that are rounding where they don't shrink any more.
const ROUNDING: f64 = 1e-14;

impl<const S: usize> Stepper<S> {
    /// The stages to begin with: the last polynomial continued, or the walls moving on as they do.
    pub(super) fn begin(&mut self, step: f64) {
        let walls = self.lumens.len();
        let ratio = step / self.last_step;
        if ratio <= LONGEST_CONTINUATION {
            let mut columns = [[0.0; S]; S];
            for i in 0..S {
                let basis = self.table.basis(1.0 + ratio * self.table.nodes[i]);
                for k in 0..S {
                    columns[k][i] = basis[k];
                }
            }
            for value in &mut columns[S - 1] {
                *value -= 1.0;
            }
            for j in 0..walls {
                self.along[j] = matvec(&self.table.to_eigen, &matvec(&columns, &self.last[j]));
            }
            self.place(step);
            if self.is_plausible() && self.closed().is_none() {
                return;
            }
        }
        self.along.fill([0.0; S]);
        self.place(step);
        if self.closed().is_some() {
            // Walls at rest where they are.
            for j in 0..walls {
                let still = [-self.rates[j][0]; S];
                self.along[j] = matvec(&self.table.to_eigen, &still);
            }
            self.place(step);
        }
    }

    /// Whether the rates are not far beyond those that the continued polynomial comes from.
    fn is_plausible(&self) -> bool {
        let within = |values: &[f64; S]| values.iter().fold(0.0f64, |most, value| most.max(value.abs()));
        (0..self.rates.len()).all(|j| {
            let end = self.rates[j][0];
            let begun = end - self.last[j][S - 1];
            let before = within(&self.last[j].map(|by| begun + by));
            within(&self.stage_rates[j]) <= FURTHEST_RATE * before.max(begun.abs())
        })
    }

    /// Values at the stages from the coordinates along the eigenvectors. The largest change of a lumen at a stage.
    #[inline(always)]
    fn place(&mut self, step: f64) -> f64 {
        let mut largest = [0.0f64; S];
        for j in 0..self.along.len() {
            let along = &self.along[j];
            let by_rate = matvec(&self.table.from_eigen, along);
            let mut by_lumen = matvec(&self.table.from_eigen, &times(&self.table.reciprocals, along));
            let (lumen, rate) = (self.lumens[j][0], self.rates[j][0]);
            for k in 0..S {
                by_lumen[k] = step * (by_lumen[k] + self.table.nodes[k] * rate);
                let change = (by_lumen[k] - self.by_lumen[j][k]).abs();
                // Written so that NaN is kept.
                largest[k] = if change <= largest[k] { largest[k] } else { change };
                self.stage_lumens[j][k] = lumen + by_lumen[k];
                self.stage_rates[j][k] = rate + by_rate[k];
            }
            self.by_lumen[j] = by_lumen;
            self.by_rate[j] = by_rate;
        }
        largest.into_iter().fold(0.0, |most, change| if change <= most { most } else { change })
    }

    /// The first wall that is closed at a stage.
    #[inline(always)]
    fn closed(&self) -> Option<usize> {
        self.stage_lumens.iter().position(|lumens| lumens.iter().any(|&lumen| lumen <= 0.0))
    }

    pub(super) fn iterate(
        &mut self,
        model: &Model,
        inputs: &InputLanes<S>,
        step: f64,
        bounds: &Bounds,
    ) -> Result<(), Attempt> {
        let walls = self.along.len();
        let shift = self.factors.shift;
        let mut before = f64::INFINITY;
        // The Jacobian of the middle is as far from the stages as the step is long.
        let mut expected = softened(self.contraction) * (step / self.last_step).max(1.0);
        for left in (0..bounds.iterations).rev() {
            model.accelerations_in_lanes(
                &self.stage_lumens,
                &self.stage_rates,
                inputs,
                &mut self.scratch,
                &mut self.accelerations,
            );
            self.evaluations += S as u64;
            self.iterations += 1;
            for j in 0..walls {
                let mut residual = matvec(&self.table.to_eigen, &self.accelerations[j]);
                let held = times(&shift, &self.along[j]);
                for k in 0..S {
                    residual[k] -= held[k];
                }
                self.change[j] = times(&shift, &residual);
            }
            self.factors.solve(&mut self.change);
            for (along, change) in self.along.iter_mut().zip(&self.change) {
                for k in 0..S {
                    along[k] += change[k];
                }
            }
            let mut change = self.place(step);
            let mut halvings = 0;
            while let Some(wall) = self.closed() {
                if halvings == MOST_HALVINGS {
                    return Err(Attempt::Closed { wall });
                }
                halvings += 1;
                for (along, change) in self.along.iter_mut().zip(&mut self.change) {
                    for k in 0..S {
                        change[k] *= 0.5;
                        along[k] -= change[k];
                    }
                }
                change = self.place(step);
            }
            if !change.is_finite() {
                return Err(Attempt::Diverged);
            }
            if change == 0.0 {
                // At rest to the last digit.
                return Ok(());
            }
            if halvings > 0 {
                before = f64::INFINITY;
                expected = 1.0;
                continue;
            }
            if change > LARGE_CHANGE {
                before = f64::INFINITY;
                expected = 1.0;
                continue;
            }
            if before.is_finite() {
                let ratio = change / before;
                if ratio >= 1.0 {
                    return if change <= ROUNDING { Ok(()) } else { Err(Attempt::Diverged) };
                }
                expected = ratio / (1.0 - ratio).max(0.01);
                let hopeless = (0..left).fold(change * expected, |error, _| error * ratio) > bounds.newton;
                if hopeless && change * expected > bounds.newton {
                    return Err(Attempt::Diverged);
                }
            }
            if change * expected <= bounds.newton {
                self.contraction = expected;
                return Ok(());
            }
            before = change;
        }
        Err(Attempt::Diverged)
    }
}

/// `x^(3/4)`: what is expected of a convergence after a step in which it was `x`.
fn softened(x: f64) -> f64 {
    let half = x.max(1e-16).sqrt();
    half * half.sqrt()
}
