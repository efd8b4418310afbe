//! The estimate of a step's error.

use super::factors::apply_to_rates;
use super::root::rough_root;
use super::step::{Bounds, Stepper};
use super::table::dot;
use crate::load::Inputs;
use crate::model::{InputLanes, Model};

/// The bump is added to a wall's polynomial where the filtered estimate is at least this part of the raw one: beyond
/// the layers.
const LEAST_OF_RAW: f64 = 0.5;

impl<const S: usize> Stepper<S> {
    /// The error of the step, over its bound, by two estimates. The one is what the equations at the step's start and
    /// the polynomial's slope there differ by: an order lower than the lifted polynomial's error. The other is what the
    /// equations and the rates' slope differ by where the rates' error is greatest: of the order of the lifted
    /// polynomial's error. Both are filtered by the real eigenvalue's matrix.
    pub(super) fn estimate(&mut self, model: &Model, inputs: [&Inputs; 2], step: f64, bounds: &Bounds) -> f64 {
        let table = self.table;
        let (basis, bump_at) = (table.basis(table.probe), table.bump(table.probe));
        for j in 0..self.bumps.len() {
            let (lumen, rate) = (self.lumens[j][0], self.rates[j][0]);
            self.bumps[j] = step * rate - dot(&table.start_slopes, &self.by_lumen[j]);
            let probed = lumen + dot(&basis, &self.by_lumen[j]) + bump_at * self.bumps[j];
            self.pair_lumens[j] = [lumen, probed];
            self.pair_rates[j] = [rate, rate + dot(&basis, &self.by_rate[j])];
        }
        let inputs = InputLanes::of(inputs.map(|inputs| *inputs));
        let (lumens, rates) = (&self.pair_lumens, &self.pair_rates);
        model.accelerations_in_lanes(lumens, rates, &inputs, &mut self.pair_scratch, &mut self.pair);
        self.evaluations += 2;
        let (real, shift) = (table.eigenvalues[S - 1], self.factors.shift[S - 1]);
        let [lumens, probed, filtered] = &mut self.work;
        for j in 0..self.bumps.len() {
            lumens[j] = self.bumps[j] / real;
            probed[j] = self.pair[j][1] - dot(&table.probe_slopes, &self.by_rate[j]) / step;
        }
        // w^2 d_l - w J_w d_l + w d_w.
        apply_to_rates(&self.arrow, lumens, filtered);
        for j in 0..filtered.len() {
            let rate = (step * self.pair[j][0] - dot(&table.start_slopes, &self.by_rate[j])) / real;
            filtered[j] = shift * (shift * lumens[j] - filtered[j] + rate);
        }
        self.factors.solve_real(filtered);
        self.factors.solve_real(probed);
        let scale = real * table.bump_height / bounds.lifted;
        let probed_scale = real * table.probe_reach / bounds.probed;
        let mut error = 0.0f64;
        for ((bump, filtered), probed) in self.bumps.iter_mut().zip(filtered).zip(probed) {
            let size = filtered.abs();
            let part = if real * size >= LEAST_OF_RAW * bump.abs() {
                let probed = probed.abs() * probed_scale;
                // In the power of the other, for the choice of the next step.
                let probed = if probed > 1.0 { probed } else { probed / rough_root(probed.max(1e-30), S as u32 + 2) };
                if scale * size >= probed { scale * size } else { probed }
            } else {
                *bump = 0.0;
                size / bounds.plain
            };
            // Written so that NaN is kept.
            error = if part <= error { error } else { part };
        }
        error
    }
}
