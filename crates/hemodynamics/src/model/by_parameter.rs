//! The derivative of the accelerations by the parameters, along a direction in which any of them change together.
//!
//! In: a direction ([`Tangent`]) and the same lumens, rates and [`Inputs`] as [`Model::accelerations`]. Out: how the
//! accelerations of the lumens change when the parameters move along it, exact to rounding.
//!
//! The lumens `l = d / D` and rates `w = v / D` are held, not the displacements: where `D` changes, `x = D (l - 1)`
//! changes with it. With the symbols of the module above and a dot for the change along the direction, the pressures
//! change by
//!
//! `G_t P_V' = sum (g_i - R_Vi' G_Ai f_i) / t_i + G_V' (P_L - P_V) + G_V P_L' - q_V'` and
//! `t_i P_Ci' = R_Vi g_i + R_Vi' f_i + P_V'`
//!
//! with `g_i = G_Ai' (P_H - P_Ci) - q_i' + G_Ai P_H'` and the flow `f_i = (G_Ai (P_H - P_V) - q_i) / t_i` out of
//! capillary `i` into the vein.

use std::f64::consts::PI;

use super::{Collapse, Model, Venule, Wall, contact};
use crate::load::Inputs;
use crate::parameters::{Parameters, Site, Symbol};

/// A direction in the space of parameters: how fast the model's coefficients change along it.
#[derive(Clone, Debug)]
pub(crate) struct Tangent {
    walls: Vec<Wall>,
    units: Vec<Venule>,
    upstream_pa: f64,
    downstream_pa: f64,
}

impl Tangent {
    /// Along these symbols, each changing at its speed (in its own unit). Symbols of the optics, and those that the
    /// model has not got, move nothing.
    pub(crate) fn new(parameters: &Parameters, speeds: &[(Symbol, f64)]) -> Tangent {
        const STILL: Wall = Wall { push: 0.0, spring: 0.0, damper: 0.0, swept: 0.0, conductance: 0.0 };
        let n = parameters.units().len();
        let mut tangent = Tangent {
            walls: vec![STILL; n + 1],
            units: vec![Venule { resistance: 0.0, share: 0.0 }; n],
            upstream_pa: 0.0,
            downstream_pa: 0.0,
        };
        for &(symbol, speed) in speeds {
            tangent.add(parameters, symbol, speed);
        }
        tangent
    }

    /// The same where the loads have a `P_H`, a `P_L` of their own, which the parameters don't move.
    pub(crate) fn under(&self, own_upstream: bool, own_downstream: bool) -> Tangent {
        let mut tangent = self.clone();
        if own_upstream {
            tangent.upstream_pa = 0.0;
        }
        if own_downstream {
            tangent.downstream_pa = 0.0;
        }
        tangent
    }

    fn add(&mut self, parameters: &Parameters, symbol: Symbol, speed: f64) {
        let n = parameters.units().len();
        let wall_of = |site: Site| match site {
            Site::Capillary(i) if i < n => Some(i),
            Site::Capillary(_) => None,
            Site::Vein => Some(n),
        };
        match symbol {
            Symbol::Stiffness(site)
            | Symbol::Mass(site)
            | Symbol::Damping(site)
            | Symbol::Area(site)
            | Symbol::Diameter(site)
            | Symbol::Length(site)
            | Symbol::Count(site) => {
                if let Some(j) = wall_of(site) {
                    self.add_to_wall(parameters, j, symbol, speed);
                }
            }
            Symbol::Viscosity => {
                for j in 0..=n {
                    self.add_to_wall(parameters, j, symbol, speed);
                }
            }
            Symbol::Venule(i) if i < n => self.units[i].resistance += speed,
            Symbol::LoadShare(i) if i < n => self.units[i].share += speed,
            Symbol::Upstream => self.upstream_pa += speed,
            Symbol::Downstream => self.downstream_pa += speed,
            Symbol::Venule(_) | Symbol::LoadShare(_) => {}
            Symbol::Path(_) | Symbol::Tissue(_) | Symbol::Offset(_) | Symbol::Scaling(_) | Symbol::Absorption => {}
        }
    }

    /// `push = A / (m D)`, `spring = k / m`, `damper = b / m`, `swept = A D`, `conductance = N pi D^4 / (128 L mu)`.
    fn add_to_wall(&mut self, parameters: &Parameters, j: usize, symbol: Symbol, speed: f64) {
        let (vessel, to) = (parameters.wall(j), &mut self.walls[j]);
        let (m, d, a) = (vessel.mass_kg, vessel.diameter_m, vessel.area_m2);
        let push = a / (m * d);
        let conductance =
            vessel.count * PI * (d * d) * (d * d) / (128.0 * vessel.length_m * parameters.viscosity_pa_s());
        match symbol {
            Symbol::Stiffness(_) => to.spring += speed / m,
            Symbol::Damping(_) => to.damper += speed / m,
            Symbol::Mass(_) => {
                to.push -= push * (speed / m);
                to.spring -= vessel.stiffness_n_per_m / m * (speed / m);
                to.damper -= vessel.damping_n_s_per_m / m * (speed / m);
            }
            Symbol::Area(_) => {
                to.push += push * (speed / a);
                to.swept += d * speed;
            }
            Symbol::Diameter(_) => {
                to.push -= push * (speed / d);
                to.swept += a * speed;
                to.conductance += 4.0 * conductance * (speed / d);
            }
            Symbol::Count(_) => to.conductance += conductance * (speed / vessel.count),
            Symbol::Length(_) => to.conductance -= conductance * (speed / vessel.length_m),
            Symbol::Viscosity => to.conductance -= conductance * (speed / parameters.viscosity_pa_s()),
            _ => {}
        }
    }
}

/// What an evaluation at one state needs for every direction.
#[derive(Clone, Debug, Default)]
pub(crate) struct Currents {
    /// `1 / t_i`, `P_H - P_Ci`, `f_i` and `l^4` of every unit.
    units: Vec<[f64; 4]>,
    venous: f64,
    total: f64,
}

impl Model {
    /// Pressures and flows at a state, written to `out` (which keeps its memory).
    pub(crate) fn currents(&self, lumens: &[f64], rates: &[f64], inputs: &Inputs, out: &mut Currents) {
        let n = self.units.len();
        out.units.resize(n, [0.0; 4]);
        out.total = self.conductance(n, lumens[n]);
        out.venous = out.total * inputs.downstream_pa - self.walls[n].swept * rates[n];
        for i in 0..n {
            let g = self.conductance(i, lumens[i]);
            let inverse = 1.0 / (1.0 + g * self.units[i].resistance);
            out.total += g * inverse;
            out.venous += (g * inputs.upstream_pa - self.walls[i].swept * rates[i]) * inverse;
            out.units[i][0] = inverse;
        }
        out.venous /= out.total;
        for i in 0..n {
            let (g, q, inverse) = (self.conductance(i, lumens[i]), self.walls[i].swept * rates[i], out.units[i][0]);
            let over = inputs.upstream_pa - out.venous;
            let square = lumens[i] * lumens[i];
            out.units[i] =
                [inverse, (over + self.units[i].resistance * q) * inverse, (g * over - q) * inverse, square * square];
        }
    }

    /// The derivative of [`Model::accelerations`] along a direction of the parameters, 1/s2 per unit of it, written to
    /// `out`, which holds a value for each wall; `currents` are those of the same state.
    pub(crate) fn along(
        &self,
        lumens: &[f64],
        rates: &[f64],
        inputs: &Inputs,
        currents: &Currents,
        tangent: &Tangent,
        out: &mut [f64],
    ) {
        let n = self.units.len();
        let square = lumens[n] * lumens[n];
        let mut venous = tangent.walls[n].conductance * (square * square) * (inputs.downstream_pa - currents.venous)
            + self.conductance(n, lumens[n]) * tangent.downstream_pa
            - tangent.walls[n].swept * rates[n];
        for i in 0..n {
            let (wall, [inverse, drop, flow, fourth]) = (&tangent.walls[i], currents.units[i]);
            let g = self.walls[i].conductance * fourth;
            // What the capillary gets more from the artery, less what its wall takes more.
            let gain = wall.conductance * fourth * drop - wall.swept * rates[i] + g * tangent.upstream_pa;
            venous += (gain - tangent.units[i].resistance * g * flow) * inverse;
            out[i] = self.units[i].resistance * gain + tangent.units[i].resistance * flow;
        }
        venous /= currents.total;
        for j in 0..=n {
            let (wall, change) = (&self.walls[j], &tangent.walls[j]);
            let (pressure, by) = match self.units.get(j) {
                Some(unit) => (
                    inputs.upstream_pa - currents.units[j][1] - unit.share * inputs.distal_pa,
                    (out[j] + venous) * currents.units[j][0] - tangent.units[j].share * inputs.distal_pa,
                ),
                None => (currents.venous - inputs.proximal_pa, venous),
            };
            let mut stretch = lumens[j] - 1.0;
            if self.collapse == Collapse::Contact {
                stretch -= contact(lumens[j]);
            }
            out[j] = change.push * pressure + wall.push * by - change.spring * stretch - change.damper * rates[j];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn along(model: &Model, lumens: &[f64], rates: &[f64], inputs: &Inputs, tangent: &Tangent) -> Vec<f64> {
        let mut currents = Currents::default();
        model.currents(lumens, rates, inputs, &mut currents);
        let mut out = vec![f64::NAN; lumens.len()];
        model.along(lumens, rates, inputs, &currents, tangent, &mut out);
        out
    }

    /// Relative to the largest of the two accelerations' terms; measured 1.2e-8, central differences.
    const TOLERANCE: f64 = 1e-7;

    #[test]
    fn is_the_derivative_of_the_accelerations_by_every_symbol() {
        let mut seen = 0;
        for (units, lumens, rates) in [
            (2, vec![1.9, 0.7, 1.07], vec![3.0, -8.0, 1.5]),
            (2, vec![0.04, 0.03, 0.02], vec![-0.1, 0.4, 2.0]),
            (3, vec![1.9, 1.2, 0.3, 0.5], vec![3.0, 2.0, -8.0, 1.5]),
        ] {
            let parameters = Parameters::along_nail(units).unwrap().set(Symbol::LoadShare(0), 0.3).unwrap();
            let at = |parameters: &Parameters| {
                let mut inputs = Inputs { upstream_pa: 1e4, downstream_pa: 0.0, proximal_pa: 3e3, distal_pa: 5e3 };
                inputs.upstream_pa = parameters.upstream_pa();
                inputs.downstream_pa = parameters.downstream_pa();
                let mut out = vec![0.0; units + 1];
                Model::new(parameters, Collapse::Contact).accelerations(&lumens, &rates, &inputs, &mut out);
                (out, inputs)
            };
            let model = Model::new(&parameters, Collapse::Contact);
            for symbol in parameters.symbols() {
                let value = parameters.get(symbol).unwrap();
                let step = 1e-6 * if value == 0.0 { 1e4 } else { value };
                let (up, _) = at(&parameters.set(symbol, value + step).unwrap());
                let (down, inputs) = at(&parameters.set(symbol, value - step).unwrap());
                let tangent = Tangent::new(&parameters, &[(symbol, 1.0)]);
                let out = along(&model, &lumens, &rates, &inputs, &tangent);
                for j in 0..=units {
                    let numeric = (up[j] - down[j]) / (2.0 * step);
                    let wall = &model.walls[j];
                    // Rounding of the differences goes with the largest terms.
                    let blood = model.pressures(&lumens, &rates, &inputs);
                    let high = blood.capillary_pa.iter().fold(blood.venous_pa.abs(), |most, p| most.max(p.abs()));
                    let terms = wall.push * (1e4 + high) + wall.spring + wall.damper * rates[j].abs();
                    let scale = numeric.abs() + terms * 1e-8 / step;
                    assert!((out[j] - numeric).abs() <= TOLERANCE * scale, "{symbol}, {j}: {} {numeric}", out[j]);
                    seen += usize::from(out[j] != 0.0);
                }
            }
        }
        // What no photodiode's parameter moves is moved by all others: 7 of each vessel, R_Vi, share, mu, P_H, P_L.
        assert!(seen >= 150, "{seen}");
    }

    #[test]
    fn a_direction_is_the_sum_of_its_symbols() {
        let parameters = Parameters::thesis();
        let model = Model::new(&parameters, Collapse::Error);
        let (lumens, rates) = ([1.9, 0.7, 1.07], [3.0, -8.0, 1.5]);
        let inputs = Inputs { upstream_pa: 1e4, downstream_pa: 0.0, proximal_pa: 3e3, distal_pa: 5e3 };
        let along = |speeds| along(&model, &lumens, &rates, &inputs, &Tangent::new(&parameters, speeds));
        let pair = [(Symbol::Diameter(Site::Vein), 2e-5), (Symbol::Viscosity, -1e-4)];
        let (both, one, other) = (along(&pair), along(&pair[..1]), along(&pair[1..]));
        for j in 0..3 {
            // Rounding alone: measured 3e-16.
            assert!((both[j] - one[j] - other[j]).abs() <= 1e-14 * (one[j].abs() + other[j].abs()));
        }
    }
}
