//! The size of a first step.

use super::root::root;
use super::step::{Bounds, Stepper};
use crate::load::Inputs;
use crate::model::{InputLanes, Model};

/// A first step is this share of a layer's time constant where the layer is as high as its bound.
const LAYER_SHARE: f64 = 2.5;
/// And moves no lumen by more than this part of it where the bound on the error is 1.
const MOTION_SHARE: f64 = 2.0;

impl<const S: usize> Stepper<S> {
    /// A first step from the state under inputs that have just changed. It resolves the layers of the walls whose
    /// inertia displaces a lumen by more than `bounds.layer` before it is spent, and the motion after them, at the
    /// rates to which the accelerations at the start lead.
    pub(crate) fn first_step(&mut self, model: &Model, first: &Inputs, bounds: &Bounds) -> f64 {
        let inputs = InputLanes::of([*first]);
        model.accelerations_in_lanes(&self.lumens, &self.rates, &inputs, &mut self.single, &mut self.first);
        self.evaluations += 1;
        let order = S as u32 + 1;
        let [lumens, rates, later] = &mut self.work;
        for j in 0..lumens.len() {
            (lumens[j], rates[j]) = (self.lumens[j][0], self.rates[j][0]);
        }
        model.jacobian(lumens, rates, first, &mut self.arrow);
        let mut step = f64::INFINITY;
        let arrow = &self.arrow;
        for j in 0..lumens.len() {
            let by_rate = arrow.by_rate[j] + arrow.by_pressure[j] * arrow.pressure_by_rate[j];
            let by_lumen = arrow.by_lumen[j] + arrow.by_pressure[j] * arrow.pressure_by_lumen[j];
            let speed = by_rate.abs().max(by_lumen.abs().sqrt());
            let height = self.first[j][0].abs() / (speed * speed);
            if height > bounds.layer {
                step = step.min(LAYER_SHARE / speed * root(bounds.layer / height, order));
            }
        }
        // Rates at which the accelerations vanish: J_w (w - w_0) = -f_0, a diagonal and a product of two vectors.
        let (mut sum, mut pivot) = (0.0, 1.0);
        for j in 0..later.len() {
            later[j] = -self.first[j][0] / arrow.by_rate[j];
            sum += arrow.pressure_by_rate[j] * later[j];
            pivot += arrow.pressure_by_rate[j] * arrow.by_pressure[j] / arrow.by_rate[j];
        }
        let slow = MOTION_SHARE * root(bounds.lifted, order);
        for j in 0..later.len() {
            let rate = rates[j] + later[j] - arrow.by_pressure[j] / arrow.by_rate[j] * (sum / pivot);
            let time = slow * lumens[j] / rate.abs().max(rates[j].abs());
            if time < step {
                step = time;
            }
        }
        step
    }
}
