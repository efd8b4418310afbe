//! Equations 17 and 18: H = tansig(W_P u + b_H), y = y_m + y_s (W_H H + b_F), u = (P - m) / s.
//!
//! The weights stand for centred and scaled voltages and targets, as training leaves them; the thesis' own weights are
//! W_P / s, biases b_H - W_P m / s, and so on.

use ndarray::Array2;
use serde::Serialize;

use super::ModelFault;
use super::block::{Kernel, LANES, Lanes, MOST, Volts, scale};
use super::tansig::tansig;
use crate::algebra::simd::Simd;

/// Targets worked out at once; hidden nodes are recomputed for each such group.
const GROUP: usize = MOST;
/// Hidden nodes of a row worked out at once.
const NODES: usize = 8;

/// The network: a layer of N tansig nodes, linear outputs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Network {
    centre: Vec<f64>,
    /// s, volts, an input each.
    pub(crate) scale: Vec<f64>,
    /// W_P, nodes x inputs, for centred and scaled voltages.
    #[serde(serialize_with = "crate::model::rows")]
    pub(crate) hidden_weights: Array2<f64>,
    /// b_H, a node each.
    pub(crate) hidden_biases: Vec<f64>,
    /// W_H, targets x nodes, for centred and scaled targets.
    #[serde(serialize_with = "crate::model::rows")]
    pub(crate) output_weights: Array2<f64>,
    /// b_F, a target each.
    pub(crate) output_biases: Vec<f64>,
    /// y_m, a target each, in its unit.
    pub(crate) target_centre: Vec<f64>,
    /// y_s, a target each, in its unit.
    pub(crate) target_scale: Vec<f64>,
    /// 1 / s.
    #[serde(skip)]
    inverse: Vec<f64>,
    /// The hidden weights again, [`NODES`] nodes side by side: node / NODES, then input, then node % NODES; missing
    /// nodes are zero.
    #[serde(skip)]
    turned: Vec<[f64; NODES]>,
    /// The hidden biases likewise.
    #[serde(skip)]
    biases: Vec<[f64; NODES]>,
}

impl Network {
    /// `centre`: m, volts, and `scale`: s, volts, positive, an input each; `hidden_weights`: W_P, nodes x inputs;
    /// `hidden_biases`: b_H; `output_weights`: W_H, targets x nodes; `output_biases`: b_F; `target_centre`: y_m and
    /// `target_scale`: y_s, positive, a target each.
    #[allow(clippy::too_many_arguments, reason = "the letters of two equations")]
    pub fn new(
        centre: Vec<f64>,
        scale: Vec<f64>,
        hidden_weights: Array2<f64>,
        hidden_biases: Vec<f64>,
        output_weights: Array2<f64>,
        output_biases: Vec<f64>,
        target_centre: Vec<f64>,
        target_scale: Vec<f64>,
    ) -> Result<Self, ModelFault> {
        let (inputs, nodes, targets) = (centre.len(), hidden_biases.len(), output_biases.len());
        if nodes == 0 {
            return Err(ModelFault::Shape { what: "hidden nodes", found: 0, wanted: 1 });
        }
        super::sizes(&[
            ("scales", scale.len(), inputs),
            ("rows of hidden weights", hidden_weights.nrows(), nodes),
            ("columns of hidden weights", hidden_weights.ncols(), inputs),
            ("rows of output weights", output_weights.nrows(), targets),
            ("columns of output weights", output_weights.ncols(), nodes),
            ("target centres", target_centre.len(), targets),
            ("target scales", target_scale.len(), targets),
        ])?;
        let hidden_weights = hidden_weights.as_standard_layout().into_owned();
        let output_weights = output_weights.as_standard_layout().into_owned();
        super::finite(&[
            ("centre", &centre),
            ("hidden biases", &hidden_biases),
            ("output biases", &output_biases),
            ("target centre", &target_centre),
        ])?;
        super::finite_matrix("hidden weights", &hidden_weights)?;
        super::finite_matrix("output weights", &output_weights)?;
        let inverse = super::inverses("scale", &scale)?;
        super::inverses("target scale", &target_scale)?;
        let groups = nodes.div_ceil(NODES);
        let mut turned = vec![[0.0; NODES]; groups * inputs];
        let mut biases = vec![[0.0; NODES]; groups];
        for node in 0..nodes {
            biases[node / NODES][node % NODES] = hidden_biases[node];
            for i in 0..inputs {
                turned[node / NODES * inputs + i][node % NODES] = hidden_weights[[node, i]];
            }
        }
        Ok(Self {
            centre,
            scale,
            hidden_weights,
            hidden_biases,
            output_weights,
            output_biases,
            target_centre,
            target_scale,
            inverse,
            turned,
            biases,
        })
    }

    /// N, how many hidden nodes.
    #[must_use]
    pub fn hidden(&self) -> usize {
        self.hidden_biases.len()
    }

    /// d target / d volt at `x` volts, targets x inputs.
    ///
    /// # Panics
    /// Where the length is not the model's.
    #[must_use]
    pub fn jacobian_at(&self, x: &[f64]) -> Array2<f64> {
        assert_eq!(x.len(), self.inputs(), "a row of the model's size");
        let mut slopes = Array2::<f64>::zeros((self.targets(), self.inputs()));
        for node in 0..self.hidden() {
            let weights = self.hidden_weights.row(node);
            let mut sum = self.hidden_biases[node];
            for i in 0..self.inputs() {
                sum = weights[i].mul_add((x[i] - self.centre[i]) * self.inverse[i], sum);
            }
            let h = tansig(sum);
            let slope = (1.0 - h) * (1.0 + h);
            for (k, mut slopes) in slopes.rows_mut().into_iter().enumerate() {
                slopes.scaled_add(self.output_weights[[k, node]] * slope, &weights);
            }
        }
        for ((k, i), slope) in slopes.indexed_iter_mut() {
            *slope *= self.target_scale[k] * self.inverse[i];
        }
        slopes
    }

    #[inline(always)]
    fn finish(&self, k: usize, sum: f64, poison: f64) -> f64 {
        self.target_scale[k].mul_add(sum + self.output_biases[k] + poison, self.target_centre[k])
    }
}

/// tansig of an infinite sum would be a number: `poison`, zero times every input, makes NaN of what an infinite voltage
/// leads to.
impl Kernel for Network {
    const GROUP: usize = GROUP;

    fn inputs(&self) -> usize {
        self.centre.len()
    }

    fn targets(&self) -> usize {
        self.output_biases.len()
    }

    #[inline(always)]
    fn row(&self, x: &impl Volts, first: usize, out: &mut [f64]) {
        let inputs = self.centre.len();
        let mut sums = [0.0; GROUP];
        let mut poison = 0.0;
        for (group, biases) in self.biases.iter().enumerate() {
            let mut nodes = *biases;
            let turned = &self.turned[group * inputs..(group + 1) * inputs];
            poison = 0.0;
            for (i, ((weights, centre), inverse)) in turned.iter().zip(&self.centre).zip(&self.inverse).enumerate() {
                let u = (x.volt(i) - centre) * inverse;
                poison += u * 0.0;
                for (node, weight) in nodes.iter_mut().zip(weights) {
                    *node = weight.mul_add(u, *node);
                }
            }
            for node in &mut nodes {
                *node = tansig(*node);
            }
            for (k, sum) in sums[..out.len()].iter_mut().enumerate() {
                let weights = self.output_weights.row(first + k);
                for (weight, node) in weights.iter().skip(group * NODES).zip(&nodes) {
                    *sum = weight.mul_add(*node, *sum);
                }
            }
        }
        for (k, (out, sum)) in out.iter_mut().zip(&sums).enumerate() {
            *out = self.finish(first + k, *sum, poison);
        }
    }

    #[inline(always)]
    fn prepare<S: Simd>(&self, simd: S, x: &mut [Lanes]) {
        scale(simd, x, &self.centre, &self.inverse);
    }

    #[inline(always)]
    fn block<S: Simd>(&self, _: S, x: &[Lanes], first: usize, out: &mut [Lanes]) {
        let mut poison = [0.0; LANES];
        for lanes in x {
            for (poison, u) in poison.iter_mut().zip(lanes) {
                *poison += u * 0.0;
            }
        }
        out.fill([0.0; LANES]);
        for (node, (weights, bias)) in self.hidden_weights.rows().into_iter().zip(&self.hidden_biases).enumerate() {
            let mut lanes = [*bias; LANES];
            for (weight, u) in weights.iter().zip(x) {
                for (lane, u) in lanes.iter_mut().zip(u) {
                    *lane = weight.mul_add(*u, *lane);
                }
            }
            for lane in &mut lanes {
                *lane = tansig(*lane);
            }
            for (k, sums) in out.iter_mut().enumerate() {
                let weight = self.output_weights[[first + k, node]];
                for (sum, lane) in sums.iter_mut().zip(&lanes) {
                    *sum = weight.mul_add(*lane, *sum);
                }
            }
        }
        for (k, sums) in out.iter_mut().enumerate() {
            for (sum, poison) in sums.iter_mut().zip(&poison) {
                *sum = self.finish(first + k, *sum, *poison);
            }
        }
    }
}

super::predicting!(Network);
