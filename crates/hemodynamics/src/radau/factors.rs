//! The Newton matrices of a step, factored: one for every eigenvalue, `n + 1` walls each, in a time that grows with `n`
//! alone.
//!
//! With the rates eliminated from the lumens (`l' = w`), the matrix of the eigenvalue `mu` at the step size `h` is, for
//! `w = mu / h` and the Jacobian of [`Arrow`], `diag(w^2 - w b - a) - c (w r + e)^T`: a diagonal and a product of two
//! vectors, solved as Sherman and Morrison do.

use super::table::{reciprocal, scaled, times};
use crate::model::Arrow;

/// Factored matrices, every entry for all eigenvalues (see [`super::table`]).
#[derive(Clone, Debug)]
pub(crate) struct Factors<const S: usize> {
    /// `mu / h`.
    pub(crate) shift: [f64; S],
    /// `1 / g_j` of the diagonal `g_j`.
    diagonal: Vec<[f64; S]>,
    /// `(w r_j + e_j) / g_j` over the pivot of the rank-one part.
    row: Vec<[f64; S]>,
    /// `c_j / g_j`.
    column: Vec<[f64; S]>,
}

impl<const S: usize> Factors<S> {
    pub(crate) fn new(walls: usize) -> Self {
        let zero = || vec![[0.0; S]; walls];
        Factors { shift: [0.0; S], diagonal: zero(), row: zero(), column: zero() }
    }

    /// Factors the matrices of a step size. A singular one leaves infinities, which a solve hands on.
    pub(crate) fn factor(&mut self, arrow: &Arrow, eigenvalues: &[f64; S], step: f64) {
        let inverse_step = 1.0 / step;
        let shift = eigenvalues.map(|mu| mu * inverse_step);
        let square = times(&shift, &shift);
        let mut pivot = scaled(&[0.0; S], 0.0, 1.0);
        let walls = self.diagonal.len();
        for j in 0..walls {
            let mut entry = scaled(&shift, -arrow.by_rate[j], -arrow.by_lumen[j]);
            for k in 0..S {
                entry[k] += square[k];
            }
            let inverse = reciprocal(&entry);
            self.diagonal[j] = inverse;
            self.column[j] = inverse.map(|value| value * arrow.by_pressure[j]);
            let coupled = scaled(&shift, arrow.pressure_by_rate[j], arrow.pressure_by_lumen[j]);
            self.row[j] = times(&coupled, &inverse);
            for k in 0..S {
                pivot[k] -= self.row[j][k] * arrow.by_pressure[j];
            }
        }
        let pivot = reciprocal(&pivot);
        for row in &mut self.row {
            *row = times(row, &pivot);
        }
        self.shift = shift;
    }

    /// Solves for every wall and eigenvalue, in place.
    #[inline(always)]
    pub(crate) fn solve(&self, values: &mut [[f64; S]]) {
        let mut sum = [0.0; S];
        for (row, value) in self.row.iter().zip(values.iter()) {
            let part = times(row, value);
            for k in 0..S {
                sum[k] += part[k];
            }
        }
        for ((diagonal, column), value) in self.diagonal.iter().zip(&self.column).zip(values) {
            let (own, shared) = (times(diagonal, value), times(column, &sum));
            for k in 0..S {
                value[k] = own[k] + shared[k];
            }
        }
    }

    /// Solves with the matrix of the real eigenvalue alone, in place.
    pub(crate) fn solve_real(&self, values: &mut [f64]) {
        let sum: f64 = self.row.iter().zip(values.iter()).map(|(row, value)| row[S - 1] * value).sum();
        for ((diagonal, column), value) in self.diagonal.iter().zip(&self.column).zip(values) {
            *value = diagonal[S - 1] * *value + column[S - 1] * sum;
        }
    }
}

/// The rates' part of a Jacobian times a vector: `out_i = b_i x_i + c_i (r x)`.
pub(crate) fn apply_to_rates(arrow: &Arrow, x: &[f64], out: &mut [f64]) {
    let pressure: f64 = arrow.pressure_by_rate.iter().zip(x).map(|(by_rate, x)| by_rate * x).sum();
    for j in 0..out.len() {
        out[j] = arrow.by_rate[j] * x[j] + arrow.by_pressure[j] * pressure;
    }
}

#[cfg(test)]
mod tests {
    use super::super::tables::RADAU9;
    use super::*;
    use crate::load::Inputs;
    use crate::model::{Collapse, Model};
    use crate::parameters::Parameters;

    /// Residual relative to the right-hand side; measured 4e-13 (diagonal dominance lost to the border by four orders).
    const TOLERANCE: f64 = 1e-10;

    #[test]
    fn solves_what_it_was_given() {
        let model = Model::new(&Parameters::along_nail(4).unwrap(), Collapse::Error);
        let inputs = Inputs { upstream_pa: 1e4, downstream_pa: 0.0, proximal_pa: 3e3, distal_pa: 5e3 };
        let (lumens, rates) = ([1.9, 0.7, 1.07, 0.4, 0.6], [3.0, -8.0, 1.5, 0.1, -2.0]);
        let mut arrow = Arrow::default();
        model.jacobian(&lumens, &rates, &inputs, &mut arrow);
        for step in [1e-8, 1e-5, 1e-1] {
            let mut factors = Factors::<5>::new(5);
            factors.factor(&arrow, &RADAU9.eigenvalues, step);
            let right: Vec<[f64; 5]> =
                (0..5).map(|j| std::array::from_fn(|k| ((3 * j + 5 * k) as f64).sin())).collect();
            let mut x = right.clone();
            factors.solve(&mut x);
            let w = factors.shift;
            let mut shared = [0.0; 5];
            for j in 0..5 {
                let part = times(&scaled(&w, arrow.pressure_by_rate[j], arrow.pressure_by_lumen[j]), &x[j]);
                (0..5).for_each(|k| shared[k] += part[k]);
            }
            for j in 0..5 {
                let mut entry = scaled(&w, -arrow.by_rate[j], -arrow.by_lumen[j]);
                let square = times(&w, &w);
                (0..5).for_each(|k| entry[k] += square[k]);
                let own = times(&entry, &x[j]);
                for k in 0..5 {
                    let left = own[k] - arrow.by_pressure[j] * shared[k];
                    assert!((left - right[j][k]).abs() <= TOLERANCE, "h {step}, wall {j}, {k}: {left}");
                }
            }
            let mut real: Vec<f64> = right.iter().map(|value| value[4]).collect();
            factors.solve_real(&mut real);
            for j in 0..5 {
                assert!((real[j] - x[j][4]).abs() <= 1e-14 * x[j][4].abs(), "the real one alone");
            }
        }
    }
}
