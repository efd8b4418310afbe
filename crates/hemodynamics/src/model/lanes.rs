//! The accelerations at several moments at once, one in each lane, for a solver whose stages are evaluated together.

use super::{Collapse, Model, contact};
use crate::load::Inputs;

/// The inputs of each lane, Pa.
#[derive(Clone, Copy, Debug)]
pub(crate) struct InputLanes<const S: usize> {
    pub(crate) upstream: [f64; S],
    pub(crate) downstream: [f64; S],
    pub(crate) proximal: [f64; S],
    pub(crate) distal: [f64; S],
}

impl<const S: usize> InputLanes<S> {
    pub(crate) fn of(inputs: [Inputs; S]) -> Self {
        InputLanes {
            upstream: inputs.map(|u| u.upstream_pa),
            downstream: inputs.map(|u| u.downstream_pa),
            proximal: inputs.map(|u| u.proximal_pa),
            distal: inputs.map(|u| u.distal_pa),
        }
    }

    pub(crate) fn lane(&self, lane: usize) -> Inputs {
        Inputs {
            upstream_pa: self.upstream[lane],
            downstream_pa: self.downstream[lane],
            proximal_pa: self.proximal[lane],
            distal_pa: self.distal[lane],
        }
    }
}

/// Memory of an evaluation: `1 / t_i` of every unit.
#[derive(Clone, Debug)]
pub(crate) struct Scratch<const S: usize>(Vec<[f64; S]>);

impl<const S: usize> Scratch<S> {
    pub(crate) fn new(model: &Model) -> Self {
        Scratch(vec![[0.0; S]; model.units.len()])
    }
}

impl Model {
    /// [`Model::accelerations`] in every lane: `lumens`, `rates` and `out` hold the lanes of each wall.
    pub(crate) fn accelerations_in_lanes<const S: usize>(
        &self,
        lumens: &[[f64; S]],
        rates: &[[f64; S]],
        inputs: &InputLanes<S>,
        scratch: &mut Scratch<S>,
        out: &mut [[f64; S]],
    ) {
        if let Some(printed) = &self.printed {
            return self.printed_in_lanes(printed, lumens, rates, inputs, out);
        }
        let n = self.units.len();
        let vein = &self.walls[n];
        let (mut venous, mut total) = ([0.0; S], [0.0; S]);
        for lane in 0..S {
            let square = lumens[n][lane] * lumens[n][lane];
            total[lane] = vein.conductance * (square * square);
            venous[lane] = total[lane] * inputs.downstream[lane] - vein.swept * rates[n][lane];
        }
        for i in 0..n {
            let (wall, r) = (&self.walls[i], self.units[i].resistance);
            let (inverse, base) = (&mut scratch.0[i], &mut out[i]);
            for lane in 0..S {
                let square = lumens[i][lane] * lumens[i][lane];
                let g = wall.conductance * (square * square);
                let inverse_t = 1.0 / (1.0 + g * r);
                let flow = (g * inputs.upstream[lane] - wall.swept * rates[i][lane]) * inverse_t;
                venous[lane] += flow;
                total[lane] += g * inverse_t;
                inverse[lane] = inverse_t;
                base[lane] = r * flow;
            }
        }
        for lane in 0..S {
            venous[lane] /= total[lane];
        }
        for i in 0..n {
            let (wall, share) = (&self.walls[i], self.units[i].share);
            for lane in 0..S {
                let blood = out[i][lane] + venous[lane] * scratch.0[i][lane];
                out[i][lane] = wall.push * (blood - share * inputs.distal[lane])
                    - wall.spring * (lumens[i][lane] - 1.0)
                    - wall.damper * rates[i][lane];
            }
        }
        for lane in 0..S {
            out[n][lane] = vein.push * (venous[lane] - inputs.proximal[lane])
                - vein.spring * (lumens[n][lane] - 1.0)
                - vein.damper * rates[n][lane];
        }
        if self.collapse == Collapse::Contact {
            for (j, wall) in self.walls.iter().enumerate() {
                for lane in 0..S {
                    out[j][lane] += wall.spring * contact(lumens[j][lane]);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameters::Parameters;

    /// Relative to the largest term; measured 1e-16.
    const TOLERANCE: f64 = 2e-15;

    #[test]
    fn every_lane_is_the_accelerations_of_its_moment() {
        let model = Model::new(&Parameters::along_nail(3).unwrap(), Collapse::Contact);
        let lumens = [[1.9, 0.02], [0.7, 1e-6], [1.2, 2.0], [1.07, 0.04]];
        let rates = [[3.0, 0.0], [-8.0, 1.0], [0.5, -3.0], [2.0, 1e-3]];
        let inputs = [
            Inputs { upstream_pa: 1e4, downstream_pa: 0.0, proximal_pa: 3e3, distal_pa: 0.0 },
            Inputs { upstream_pa: 9e3, downstream_pa: 10.0, proximal_pa: 0.0, distal_pa: 7e3 },
        ];
        let mut out = [[0.0; 2]; 4];
        model.accelerations_in_lanes(&lumens, &rates, &InputLanes::of(inputs), &mut Scratch::new(&model), &mut out);
        for lane in 0..2 {
            let (l, w) = (lumens.map(|x| x[lane]), rates.map(|x| x[lane]));
            let mut single = [0.0; 4];
            model.accelerations(&l, &w, &inputs[lane], &mut single);
            for j in 0..4 {
                let scale = single[j].abs() + model.walls[j].push * 1e4 + model.walls[j].damper * w[j].abs();
                assert!((single[j] - out[j][lane]).abs() <= TOLERANCE * scale, "wall {j}, lane {lane}");
            }
        }
    }
}
