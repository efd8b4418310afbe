//! The Jacobian of the accelerations: a diagonal and a border, since walls act on each other through the venous
//! pressure alone.

use super::{Collapse, Model, contact_slope};
use crate::load::Inputs;

/// The derivatives of the accelerations by lumens and rates. With `P` the venous pressure, for walls `i` and `j`:
/// `d w'_i / d l_j = (i = j) by_lumen_i + by_pressure_i pressure_by_lumen_j`, and
/// `d w'_i / d w_j = (i = j) by_rate_i + by_pressure_i pressure_by_rate_j`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Arrow {
    /// By a wall's own lumen at a held venous pressure, 1/s2.
    pub by_lumen: Vec<f64>,
    /// By a wall's own rate at a held venous pressure, 1/s.
    pub by_rate: Vec<f64>,
    /// By the venous pressure, 1/(s2 Pa).
    pub by_pressure: Vec<f64>,
    /// The venous pressure by each lumen, Pa.
    pub pressure_by_lumen: Vec<f64>,
    /// The venous pressure by each rate, Pa s.
    pub pressure_by_rate: Vec<f64>,
}

impl Model {
    /// The Jacobian at lumens and rates of all walls, written to `out` (which keeps its memory).
    pub fn jacobian(&self, lumens: &[f64], rates: &[f64], inputs: &Inputs, out: &mut Arrow) {
        let (n, walls) = (self.units.len(), self.walls.len());
        for values in [
            &mut out.by_lumen,
            &mut out.by_rate,
            &mut out.by_pressure,
            &mut out.pressure_by_lumen,
            &mut out.pressure_by_rate,
        ] {
            values.resize(walls, 0.0);
        }
        let vein = &self.walls[n];
        let mut total = self.conductance(n, lumens[n]);
        let mut venous = total * inputs.downstream_pa - vein.swept * rates[n];
        for i in 0..n {
            let g = self.conductance(i, lumens[i]);
            let t = 1.0 + g * self.units[i].resistance;
            total += g / t;
            venous += (g * inputs.upstream_pa - self.walls[i].swept * rates[i]) / t;
        }
        venous /= total;
        for i in 0..n {
            let (wall, r) = (&self.walls[i], self.units[i].resistance);
            let square = lumens[i] * lumens[i];
            let g = wall.conductance * (square * square);
            let slope = 4.0 * wall.conductance * (square * lumens[i]);
            let t = 1.0 + g * r;
            // P_H - P_Ci, without P_Ci.
            let drop = (inputs.upstream_pa - venous + r * wall.swept * rates[i]) / t;
            out.by_lumen[i] = wall.push * (r * slope * drop / t) - wall.spring;
            out.by_rate[i] = -wall.damper - wall.push * (r * wall.swept / t);
            out.by_pressure[i] = wall.push / t;
            out.pressure_by_lumen[i] = slope * drop / (t * total);
            out.pressure_by_rate[i] = -wall.swept / (t * total);
        }
        let square = lumens[n] * lumens[n];
        let slope = 4.0 * vein.conductance * (square * lumens[n]);
        out.by_lumen[n] = -vein.spring;
        out.by_rate[n] = -vein.damper;
        out.by_pressure[n] = vein.push;
        out.pressure_by_lumen[n] = -slope * (venous - inputs.downstream_pa) / total;
        out.pressure_by_rate[n] = -vein.swept / total;
        if self.collapse == Collapse::Contact {
            for (j, wall) in self.walls.iter().enumerate() {
                out.by_lumen[j] += wall.spring * contact_slope(lumens[j]);
            }
        }
    }
}
