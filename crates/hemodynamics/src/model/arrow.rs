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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameters::Parameters;

    /// Relative to the largest entry of a row; measured 2.7e-8, central differences.
    const TOLERANCE: f64 = 1e-7;

    #[test]
    fn is_the_derivative_of_the_accelerations() {
        for (units, lumens, rates) in [
            (2, vec![1.9, 0.7, 1.07], vec![3.0, -8.0, 1.5]),
            (2, vec![0.04, 0.03, 0.02], vec![-0.1, 0.4, 2.0]),
            (3, vec![1.9, 1.2, 0.3, 0.5], vec![3.0, 2.0, -8.0, 1.5]),
        ] {
            let model = Model::new(&Parameters::along_nail(units).unwrap(), Collapse::Contact);
            let inputs = Inputs { upstream_pa: 1e4, downstream_pa: 500.0, proximal_pa: 3e3, distal_pa: 5e3 };
            let walls = model.walls();
            let mut arrow = Arrow::default();
            model.jacobian(&lumens, &rates, &inputs, &mut arrow);
            let (mut up, mut down) = (vec![0.0; walls], vec![0.0; walls]);
            for column in 0..2 * walls {
                let mut state = [lumens.clone(), rates.clone()];
                let (which, j) = (column / walls, column % walls);
                let step = 1e-6 * state[which][j].abs();
                let at = state[which][j];
                state[which][j] = at + step;
                model.accelerations(&state[0], &state[1], &inputs, &mut up);
                state[which][j] = at - step;
                model.accelerations(&state[0], &state[1], &inputs, &mut down);
                for i in 0..walls {
                    let numeric = (up[i] - down[i]) / (2.0 * step);
                    let (own, pressure) =
                        [(&arrow.by_lumen, &arrow.pressure_by_lumen), (&arrow.by_rate, &arrow.pressure_by_rate)][which];
                    let exact = if i == j { own[i] } else { 0.0 } + arrow.by_pressure[i] * pressure[j];
                    let scale = own[i].abs() + (arrow.by_pressure[i] * pressure[j]).abs();
                    assert!((numeric - exact).abs() <= TOLERANCE * scale, "{i} by {which} {j}: {numeric} {exact}");
                }
            }
        }
    }
}
