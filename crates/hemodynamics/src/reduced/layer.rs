//! The layer after a load jumps: the walls' inertia wears off within microseconds, and the lumens move meanwhile.
//!
//! With `z` the rates less those of the slow manifold, `z' = -K z` to first order in the masses, so `z = exp(-K t) z_0` and the lumens stand
//! `exp(-K t) K^-1 z_0` behind the slow solution. That starts `K^-1 z_0`, the layer's integral, away from where the walls were.
//! `K` has real positive eigenvalues: with `M = swept / push`, `M^1/2 K M^-1/2` is symmetric.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use super::drag::Drag;
use crate::model::Model;

/// Time constants after which nothing is left of a layer: exp(-40) = 4e-18.
const LASTING: f64 = 40.0;

/// What a load's jump leaves behind for some microseconds.
#[derive(Clone, Debug)]
pub(super) struct Layer {
    from_s: f64,
    /// When it is over.
    pub(super) until_s: f64,
    /// Eigenvalues of `K`, 1/s.
    decays: Vec<f64>,
    /// The part of `z_0` in each eigenvector, a column for each.
    parts: DMatrix<f64>,
}

impl Layer {
    /// The layer from a time on with the rates `z_0` (1/s) in excess, over the network in `drag`.
    pub(super) fn new(model: &Model, drag: &Drag, from_s: f64, excess: &[f64]) -> Layer {
        let walls = model.walls();
        let roots = DVector::from_iterator(walls, model.walls.iter().map(|wall| (wall.swept / wall.push).sqrt()));
        let eigen = SymmetricEigen::new(drag.symmetric());
        let along = eigen.eigenvectors.tr_mul(&roots.component_mul(&DVector::from_column_slice(excess)));
        let decays: Vec<f64> = eigen.eigenvalues.iter().copied().collect();
        let parts = DMatrix::from_fn(walls, walls, |j, k| eigen.eigenvectors[(j, k)] * along[k] / roots[j]);
        let slowest = decays.iter().copied().fold(f64::INFINITY, f64::min);
        Layer { from_s, until_s: from_s + LASTING / slowest, decays, parts }
    }

    /// Adds to lumens and rates of the slow solution what the layer still holds.
    pub(super) fn add(&self, time_s: f64, lumens: &mut [f64], rates: &mut [f64]) {
        for (k, decay) in self.decays.iter().enumerate() {
            let left = libm::exp(-decay * (time_s - self.from_s));
            for j in 0..lumens.len() {
                let rate = left * self.parts[(j, k)];
                rates[j] += rate;
                lumens[j] -= rate / decay;
            }
        }
    }
}
