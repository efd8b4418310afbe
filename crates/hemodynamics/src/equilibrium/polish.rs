//! The equations at rest in the form that does not cancel, solved by Newton's method in numbers.
//!
//! Where a venule resists a thousand times as much as the capillary before it, `p(l)` is a small difference of great
//! pressures: the lumen is well known and the venous pressure that it wants is not. Here the venous pressure is taken
//! as it is, `P = w_V(l_V)`, and with `t = 1 + G R`, `s = G / t`
//!
//! `w_i(l_i) - P_H + (P_H - P) / t_i = 0` and `sum s_i (P_H - P) + G_V (P_L - P) = 0`.
//!
//! With the slopes `alpha_i` of a unit's equation by its own lumen, `-beta_i` of it by the vein's lumen, `gamma_i` and
//! `delta` of the balance, a Newton step is an elimination of the units one by one, the vein last; a unit at a turning
//! point of its `p`, where `alpha` is about 0, is eliminated after the vein.

use super::network::{Network, Vessel};

const MOST_STEPS: usize = 50;
/// A step is small where no lumen moves by more than this part of itself, or of [`FINE`] where it is smaller.
const SMALL: f64 = 1e-11;
/// A lumen below this is known to digits of this, not of its own: it is small beside the 1 that is subtracted from it.
const FINE: f64 = 1e-2;
/// A unit is at a turning point where `alpha` is less than this part of the wall's stiffness.
const TURNING: f64 = 0.05;

/// A unit's part of the linearized equations.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    pub(super) alpha: f64,
    pub(super) beta: f64,
    pub(super) gamma: f64,
    pub(super) residual: f64,
    /// `s_i`.
    pub(super) conductance: f64,
}

impl Vessel {
    /// The unit's part at a lumen, with the venous pressure `venous` and its slope by the vein's lumen.
    pub(super) fn row(&self, lumen: f64, venous: f64, venous_slope: f64) -> Row {
        let square = lumen * lumen;
        let g = self.conductance * (square * square);
        let t = 1.0 + g * self.venule;
        let drop = self.source - venous;
        let by_lumen = 4.0 * self.conductance * (square * lumen) / (t * t) * drop;
        Row {
            alpha: self.pressure_slope(lumen) - self.venule * by_lumen,
            beta: venous_slope / t,
            gamma: by_lumen,
            residual: self.pressure(lumen) - self.source + drop / t,
            conductance: g / t,
        }
    }
}

impl Network {
    /// The equilibrium near a state; `None` where there is none near.
    pub(super) fn polish(&self, mut vein: f64, mut units: Vec<f64>) -> Option<(f64, Vec<f64>)> {
        let mut steps = vec![0.0; units.len()];
        let mut last = f64::INFINITY;
        for _ in 0..MOST_STEPS {
            let by = self.newton(vein, &units, &mut steps);
            let moves = || steps.iter().zip(&units).chain([(&by, &vein)]);
            let size = moves().map(|(step, at)| (step / at.max(FINE)).abs()).fold(0.0, f64::max);
            let relative = moves().map(|(step, at)| (step / at).abs()).fold(0.0, f64::max);
            if !size.is_finite() || !relative.is_finite() {
                return None;
            }
            if size >= last && last <= SMALL {
                return Some((vein, units));
            }
            last = size;
            // No lumen may shrink below half of itself in one step.
            let part = if relative > 0.5 { 0.5 / relative } else { 1.0 };
            vein += part * by;
            units.iter_mut().zip(&steps).for_each(|(at, step)| *at += part * step);
            if size == 0.0 {
                return Some((vein, units));
            }
        }
        (last <= SMALL).then_some((vein, units))
    }

    /// The step of all lumens that makes the linearized equations hold: of the vein returned, of the units written.
    fn newton(&self, at_vein: f64, at_units: &[f64], steps: &mut [f64]) -> f64 {
        let (venous, slope) = (self.vein.pressure(at_vein), self.vein.pressure_slope(at_vein));
        let row = |i: usize| self.units[i].row(at_units[i], venous, slope);
        let square = at_vein * at_vein;
        let outflow = self.vein.conductance * (square * square);
        let fall = self.vein.source - venous;
        let (mut total, mut balance) = (outflow, outflow * fall);
        let (mut excess, mut right) = (4.0 * self.vein.conductance * (square * at_vein) * fall, 0.0);
        let near = |i: usize| row(i).alpha.abs() / self.units[i].stiffness;
        let nearest = (0..at_units.len()).min_by(|&a, &b| near(a).total_cmp(&near(b)));
        let pivot = nearest.filter(|&i| near(i) < TURNING);
        for i in 0..at_units.len() {
            let row = row(i);
            total += row.conductance;
            balance += row.conductance * (self.units[i].source - venous);
            if Some(i) != pivot {
                excess += row.gamma * row.beta / row.alpha;
                right += row.gamma * row.residual / row.alpha;
            }
        }
        excess -= total * slope;
        right -= balance;
        let mut by = right / excess;
        if let Some(i) = pivot {
            let last = row(i);
            let step = (right - excess * last.residual / last.beta) / (excess * last.alpha / last.beta + last.gamma);
            steps[i] = step;
            by = (last.alpha * step + last.residual) / last.beta;
        }
        for (i, step) in steps.iter_mut().enumerate() {
            if Some(i) != pivot {
                let row = row(i);
                *step = (row.beta * by - row.residual) / row.alpha;
            }
        }
        by
    }
}
