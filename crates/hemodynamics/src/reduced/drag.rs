//! Rates of the walls under given forces, where inertia is nothing: `R(x) v = F(x, u)`.
//!
//! With `G`, `t` and the pressures of [`crate::Model`], a capillary's balance is `D_i w_i = r_i + g_i P_V` with
//! `D_i = b_i / m_i + push_i R_Vi swept_i / t_i` and `g_i = push_i / t_i`; the vein's is `D_V w_V = r_V + push_V P_V`; and the blood's is
//! `G_t P_V = c - sum swept_i w_i / t_i - swept_V w_V`. Eliminating the capillaries leaves two equations for `P_V` and `w_V` whose
//! determinant is a sum of positive terms: nothing cancels, whatever is closed, and the work goes with the number of units.
//! `K = -d w' / d w` and `J = d w' / d l` are each a diagonal and a product of two vectors, as in [`crate::Arrow`].

use nalgebra::DMatrix;

use crate::load::Inputs;
use crate::model::{Collapse, Model, Wall, contact, contact_slope};

/// The network at some lumens, eliminated.
#[derive(Clone, Debug)]
pub(super) struct Drag {
    capillaries: Vec<Branch>,
    vein: Wall,
    contact: bool,
    /// `G_V`.
    conductance: f64,
    /// `G_t`.
    total: f64,
    /// `G_t + sum swept_i g_i / (t_i D_i)`.
    stiffness: f64,
    inverse_determinant: f64,
    /// The row of the vein in `J`.
    by_lumen: f64,
    pressure_by_lumen: f64,
}

/// A capillary and its venules.
#[derive(Clone, Copy, Debug)]
struct Branch {
    wall: Wall,
    resistance: f64,
    share: f64,
    /// `1 / t`.
    inverse_t: f64,
    /// `D`.
    damping: f64,
    /// `1 / D`.
    inverse: f64,
    /// `push / t`.
    gain: f64,
    /// `swept / t`.
    flow: f64,
    /// `G / t`.
    through: f64,
    /// Its row of `J`.
    by_lumen: f64,
    pressure_by_lumen: f64,
}

impl Drag {
    pub(super) fn new(model: &Model) -> Drag {
        let capillaries = model.walls.iter().zip(&model.units).map(|(&wall, unit)| Branch {
            wall,
            resistance: unit.resistance,
            share: unit.share,
            inverse_t: 0.0,
            damping: 0.0,
            inverse: 0.0,
            gain: 0.0,
            flow: 0.0,
            through: 0.0,
            by_lumen: 0.0,
            pressure_by_lumen: 0.0,
        });
        Drag {
            capillaries: capillaries.collect(),
            vein: model.walls[model.units.len()],
            contact: model.collapse == Collapse::Contact,
            conductance: 0.0,
            total: 0.0,
            stiffness: 0.0,
            inverse_determinant: 0.0,
            by_lumen: 0.0,
            pressure_by_lumen: 0.0,
        }
    }

    /// Eliminates the network at these lumens and gives the rates `w` (1/s) there under the inputs; returns `P_V`, Pa.
    pub(super) fn rates(&mut self, lumens: &[f64], inputs: &Inputs, out: &mut [f64]) -> f64 {
        let n = self.capillaries.len();
        let square = lumens[n] * lumens[n];
        self.conductance = self.vein.conductance * (square * square);
        let (mut total, mut moved) = (self.conductance, 0.0);
        let mut flow = self.conductance * inputs.downstream_pa;
        for (branch, (out, lumen)) in self.capillaries.iter_mut().zip(out.iter_mut().zip(lumens)) {
            let Wall { push, spring, damper, swept, conductance } = branch.wall;
            let square = lumen * lumen;
            let g = conductance * (square * square);
            let t = 1.0 + g * branch.resistance;
            // t D, and both inverses by one division.
            let damping = damper * t + push * branch.resistance * swept;
            let inverse = 1.0 / (t * damping);
            branch.inverse_t = damping * inverse;
            branch.inverse = t * t * inverse;
            branch.damping = damping * branch.inverse_t;
            branch.gain = push * branch.inverse_t;
            branch.flow = swept * branch.inverse_t;
            branch.through = g * branch.inverse_t;
            let driven = branch.through * inputs.upstream_pa;
            let mut force =
                push * (branch.resistance * driven - branch.share * inputs.distal_pa) - spring * (lumen - 1.0);
            if self.contact {
                force += spring * contact(*lumen);
            }
            total += branch.through;
            moved += branch.flow * branch.gain * branch.inverse;
            flow += driven - branch.flow * force * branch.inverse;
            *out = force;
        }
        self.total = total;
        self.stiffness = total + moved;
        self.inverse_determinant = 1.0 / (self.stiffness * self.vein.damper + self.vein.swept * self.vein.push);
        out[n] = -self.vein.push * inputs.proximal_pa - self.vein.spring * (lumens[n] - 1.0);
        if self.contact {
            out[n] += self.vein.spring * contact(lumens[n]);
        }
        self.close(flow, out)
    }

    /// What the inputs do to each wall at `P_V = 0`, 1/s2; returns the flow into the vein that they drive, m3/s.
    pub(super) fn press(&self, inputs: &Inputs, out: &mut [f64]) -> f64 {
        let n = self.capillaries.len();
        let mut source = self.conductance * inputs.downstream_pa;
        for (branch, out) in self.capillaries.iter().zip(out.iter_mut()) {
            let flow = branch.through * inputs.upstream_pa;
            source += flow;
            *out = branch.wall.push * (branch.resistance * flow - branch.share * inputs.distal_pa);
        }
        out[n] = -self.vein.push * inputs.proximal_pa;
        source
    }

    /// From forces on the walls (1/s2) and a flow into the vein (m3/s) to rates, 1/s, in place; returns `P_V`. Without a flow: `K^-1 walls`.
    pub(super) fn respond(&self, source: f64, walls: &mut [f64]) -> f64 {
        let mut flow = source;
        for (branch, force) in self.capillaries.iter().zip(walls.iter()) {
            flow -= branch.flow * force * branch.inverse;
        }
        self.close(flow, walls)
    }

    /// The rest of it, with the flow that the capillaries' forces leave.
    fn close(&self, flow: f64, walls: &mut [f64]) -> f64 {
        let n = self.capillaries.len();
        let force = walls[n];
        let pressure = (flow * self.vein.damper - self.vein.swept * force) * self.inverse_determinant;
        walls[n] = (self.stiffness * force + self.vein.push * flow) * self.inverse_determinant;
        for (branch, force) in self.capillaries.iter().zip(walls.iter_mut()) {
            *force = (*force + branch.gain * pressure) * branch.inverse;
        }
        pressure
    }

    /// `J` at lumens (those of [`Drag::rates`]), rates and the venous pressure there.
    pub(super) fn linearize(&mut self, lumens: &[f64], rates: &[f64], venous_pa: f64, inputs: &Inputs) {
        let n = self.capillaries.len();
        let inverse_total = 1.0 / self.total;
        for (branch, (lumen, rate)) in self.capillaries.iter_mut().zip(lumens.iter().zip(rates)) {
            let Wall { push, spring, swept, conductance, .. } = branch.wall;
            let slope = 4.0 * conductance * (lumen * lumen * lumen) * branch.inverse_t;
            // P_H - P_Ci, without P_Ci.
            let drop = (inputs.upstream_pa - venous_pa + branch.resistance * swept * rate) * branch.inverse_t;
            branch.by_lumen = push * branch.resistance * slope * drop - spring;
            branch.pressure_by_lumen = slope * drop * inverse_total;
            if self.contact {
                branch.by_lumen += spring * contact_slope(*lumen);
            }
        }
        let lumen = lumens[n];
        let slope = 4.0 * self.vein.conductance * (lumen * lumen * lumen);
        self.by_lumen = -self.vein.spring;
        self.pressure_by_lumen = -slope * (venous_pa - inputs.downstream_pa) * inverse_total;
        if self.contact {
            self.by_lumen += self.vein.spring * contact_slope(lumen);
        }
    }

    /// `out + J x`.
    pub(super) fn add_by_lumens(&self, x: &[f64], out: &mut [f64]) {
        let n = self.capillaries.len();
        let mut pressure = self.pressure_by_lumen * x[n];
        for (branch, x) in self.capillaries.iter().zip(x) {
            pressure += branch.pressure_by_lumen * x;
        }
        for (branch, (out, x)) in self.capillaries.iter().zip(out.iter_mut().zip(x)) {
            *out += branch.by_lumen * x + branch.gain * pressure;
        }
        out[n] += self.by_lumen * x[n] + self.vein.push * pressure;
    }

    /// From `y` to the `e` of `(K - half J) e = K y`, in place: an implicit step of `e' = K^-1 J e`. `memory` holds a value for each wall.
    pub(super) fn step_implicitly(&self, half_s: f64, y: &mut [f64], memory: &mut [f64]) {
        let n = self.capillaries.len();
        let inverse_total = 1.0 / self.total;
        let mut pressure = -self.vein.swept * inverse_total * y[n];
        for (branch, y) in self.capillaries.iter().zip(y.iter()) {
            pressure -= branch.flow * inverse_total * y;
        }
        let own = 1.0 / (self.vein.damper - half_s * self.by_lumen);
        let border = self.vein.swept * inverse_total - half_s * self.pressure_by_lumen;
        y[n] = own * (self.vein.damper * y[n] - self.vein.push * pressure);
        memory[n] = own * self.vein.push;
        let (mut through, mut across) = (border * y[n], 1.0 + border * memory[n]);
        for (branch, (y, memory)) in self.capillaries.iter().zip(y.iter_mut().zip(memory.iter_mut())) {
            let own = 1.0 / (branch.damping - half_s * branch.by_lumen);
            let border = branch.flow * inverse_total - half_s * branch.pressure_by_lumen;
            *y = own * (branch.damping * *y - branch.gain * pressure);
            *memory = own * branch.gain;
            through += border * *y;
            across += border * *memory;
        }
        let part = through / across;
        for (y, memory) in y.iter_mut().zip(memory.iter()) {
            *y -= memory * part;
        }
    }

    /// `K` made symmetric, `M^1/2 K M^-1/2` with `M = swept / push`.
    pub(super) fn symmetric(&self) -> DMatrix<f64> {
        let n = self.capillaries.len();
        let (own, border): (Vec<f64>, Vec<f64>) = self
            .capillaries
            .iter()
            .map(|branch| (branch.damping, (branch.gain * branch.flow).sqrt()))
            .chain([(self.vein.damper, (self.vein.push * self.vein.swept).sqrt())])
            .unzip();
        DMatrix::from_fn(n + 1, n + 1, |j, k| border[j] * border[k] / self.total + if j == k { own[j] } else { 0.0 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Arrow;
    use crate::parameters::Parameters;

    const INPUTS: Inputs = Inputs { upstream_pa: 1e4, downstream_pa: 300.0, proximal_pa: 3e3, distal_pa: 5e3 };

    /// Accelerations at these rates over the largest term of the walls' balances; measured 2e-16.
    const TOLERANCE: f64 = 1e-14;

    #[test]
    fn at_its_rates_no_wall_accelerates() {
        for collapse in [Collapse::Error, Collapse::Contact] {
            for (units, lumens) in [
                (2, vec![1.9, 0.7, 1.07]),
                (2, vec![0.04, 0.01, 0.02]),
                (3, vec![1.9, 1.2, 0.3, 0.5]),
                (1, vec![2.0, 1.9]),
            ] {
                let model = Model::new(&Parameters::along_nail(units).unwrap(), collapse);
                let mut drag = Drag::new(&model);
                let walls = model.walls();
                let (mut rates, mut left) = (vec![0.0; walls], vec![0.0; walls]);
                drag.rates(&lumens, &INPUTS, &mut rates);
                model.accelerations(&lumens, &rates, &INPUTS, &mut left);
                // The blood's pressures are differences of large ones where little flows.
                let mut arrow = Arrow::default();
                model.jacobian(&lumens, &rates, &INPUTS, &mut arrow);
                let blood: f64 = arrow.pressure_by_rate.iter().zip(&rates).map(|(by, rate)| (by * rate).abs()).sum();
                for j in 0..walls {
                    let wall = &model.walls[j];
                    let scale = wall.push * (blood + 1e4)
                        + wall.spring * (1.0 + contact(lumens[j]))
                        + wall.damper * rates[j].abs();
                    assert!(left[j].abs() <= TOLERANCE * scale, "{units} units, wall {j}: {}", left[j].abs() / scale);
                }
            }
        }
    }
}
