//! The weights of a network in training as one vector, and what the network says with them.
//!
//! In order: for each hidden node its bias and a weight for each input; for each target its bias and a weight for each
//! node. All are for centred and scaled inputs and targets.

use super::rows::{BLOCK, Column, Rows};
use crate::algebra::simd::{Work, widest};
use crate::model::tansig;

/// Rows of a block that are worked on at once.
const LANES: usize = 8;

/// How large a network is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Shape {
    pub(super) inputs: usize,
    pub(super) hidden: usize,
    pub(super) targets: usize,
}

impl Shape {
    /// Weights of the hidden nodes.
    pub(super) fn first(self) -> usize {
        self.hidden * (1 + self.inputs)
    }

    pub(super) fn parameters(self) -> usize {
        self.first() + self.targets * (1 + self.hidden)
    }

    /// Each target's bias and weights.
    #[inline(always)]
    pub(super) fn outputs(self, weights: &[f64]) -> std::slice::ChunksExact<'_, f64> {
        weights[self.first()..].chunks_exact(1 + self.hidden)
    }
}

/// A block's hidden nodes and errors.
#[derive(Debug, Clone)]
pub(super) struct Forward {
    shape: Shape,
    /// tansig of each node.
    pub(super) hidden: Vec<Column>,
    /// Predicted less measured, each target; 0 for rows that do not count.
    pub(super) errors: Vec<Column>,
}

impl Forward {
    pub(super) fn new(shape: Shape) -> Self {
        Self { shape, hidden: vec![[0.0; BLOCK]; shape.hidden], errors: vec![[0.0; BLOCK]; shape.targets] }
    }

    #[inline(always)]
    pub(super) fn block(&mut self, weights: &[f64], inputs: &[Column], targets: &[Column]) {
        let nodes = weights.chunks_exact(1 + self.shape.inputs);
        for (hidden, weights) in self.hidden.iter_mut().zip(nodes) {
            for (part, hidden) in hidden.chunks_exact_mut(LANES).enumerate() {
                let mut sums = [weights[0]; LANES];
                add(&mut sums, &weights[1..], &inputs[1..], part);
                for (hidden, sum) in hidden.iter_mut().zip(&sums) {
                    *hidden = tansig(*sum);
                }
            }
        }
        for ((error, weights), target) in self.errors.iter_mut().zip(self.shape.outputs(weights)).zip(targets) {
            for (part, error) in error.chunks_exact_mut(LANES).enumerate() {
                let mut sums = [weights[0]; LANES];
                add(&mut sums, &weights[1..], &self.hidden, part);
                let (target, counts) = (&target[part * LANES..], &inputs[0][part * LANES..]);
                for (((error, sum), target), counts) in error.iter_mut().zip(&sums).zip(target).zip(counts) {
                    *error = (*sum - target) * counts;
                }
            }
        }
    }

    /// The mean square of all targets' errors over `rows`.
    pub(super) fn mean_square(&mut self, weights: &[f64], rows: &Rows) -> f64 {
        widest(MeanSquare { forward: self, weights, rows })
    }
}

#[inline(always)]
fn add(sums: &mut [f64; LANES], weights: &[f64], columns: &[Column], part: usize) {
    for (weight, column) in weights.iter().zip(columns) {
        for (sum, value) in sums.iter_mut().zip(&column[part * LANES..]) {
            *sum = weight.mul_add(*value, *sum);
        }
    }
}

struct MeanSquare<'a> {
    forward: &'a mut Forward,
    weights: &'a [f64],
    rows: &'a Rows,
}

impl Work for MeanSquare<'_> {
    type Output = f64;

    #[inline(always)]
    fn call(self) -> f64 {
        let Self { forward, weights, rows } = self;
        let mut sum = [0.0; BLOCK];
        for (inputs, targets) in rows.blocks() {
            forward.block(weights, inputs, targets);
            for error in &forward.errors {
                for (sum, error) in sum.iter_mut().zip(error) {
                    *sum = error.mul_add(*error, *sum);
                }
            }
        }
        sum.iter().sum::<f64>() / (rows.rows * rows.targets).max(1) as f64
    }
}
