//! A damped step: (A + mu I) p = -g by Cholesky's factorization.

use crate::algebra::simd::{Work, widest};

/// Factor and step, kept from one solution to the next.
#[derive(Debug, Clone)]
pub(super) struct Damped {
    factor: Vec<f64>,
    /// p.
    pub(super) step: Vec<f64>,
}

impl Damped {
    pub(super) fn new(size: usize) -> Self {
        Self { factor: vec![0.0; size * size], step: vec![0.0; size] }
    }

    /// Solves for `step`, of `matrix` (row by row) only what is right of the diagonal and on it. False where rounding
    /// leaves the matrix not positive definite or anything not finite.
    pub(super) fn solve(&mut self, matrix: &[f64], gradient: &[f64], mu: f64) -> bool {
        self.factor.copy_from_slice(matrix);
        let size = gradient.len();
        let positive = widest(Factorize { matrix: &mut self.factor, size, mu });
        if !positive {
            return false;
        }
        for (step, gradient) in self.step.iter_mut().zip(gradient) {
            *step = -gradient;
        }
        for (k, row) in self.factor.chunks_exact(size).enumerate() {
            let value = self.step[k] / row[k];
            self.step[k] = value;
            for (step, factor) in self.step[k + 1..].iter_mut().zip(&row[k + 1..]) {
                *step -= factor * value;
            }
        }
        for (k, row) in self.factor.chunks_exact(size).enumerate().rev() {
            let known: f64 = row[k + 1..].iter().zip(&self.step[k + 1..]).map(|(factor, step)| factor * step).sum();
            self.step[k] = (self.step[k] - known) / row[k];
        }
        self.step.iter().all(|step| step.is_finite())
    }
}

/// R of R^T R = A + mu I in A's place. False where there is none.
struct Factorize<'a> {
    matrix: &'a mut [f64],
    size: usize,
    mu: f64,
}

impl Work for Factorize<'_> {
    type Output = bool;

    #[inline(always)]
    fn call(self) -> bool {
        let Self { matrix, size, mu } = self;
        for k in 0..size {
            matrix[k * size + k] += mu;
        }
        for k in 0..size {
            let (above, below) = matrix.split_at_mut((k + 1) * size);
            let row = &mut above[k * size..];
            let pivot = row[k];
            if !(pivot.is_finite() && pivot > 0.0) {
                return false;
            }
            let root = pivot.sqrt();
            row[k] = root;
            for value in &mut row[k + 1..] {
                *value /= root;
            }
            for (under, i) in below.chunks_exact_mut(size).zip(k + 1..) {
                let factor = row[i];
                for (value, other) in under[i..].iter_mut().zip(&row[i..]) {
                    *value -= factor * other;
                }
            }
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Largest residual found: 1.1e-15.
    const TOLERANCE: f64 = 1e-14;

    #[test]
    fn solves_what_it_was_asked() {
        let size = 7;
        let matrix: Vec<f64> = (0..size * size).map(|k| 1.0 / (1.0 + (k / size) as f64 + (k % size) as f64)).collect();
        let gradient: Vec<f64> = (0..size).map(|k| (k as f64).sin()).collect();
        let mut damped = Damped::new(size);
        let mu = 0.1;
        assert!(damped.solve(&matrix, &gradient, mu));
        for i in 0..size {
            let product: f64 = (0..size).map(|m| matrix[i * size + m] * damped.step[m]).sum();
            let residual = product + mu * damped.step[i] + gradient[i];
            assert!(residual.abs() <= TOLERANCE, "{residual:e}");
        }
    }

    #[test]
    fn a_matrix_without_a_factor_is_refused() {
        let mut damped = Damped::new(2);
        assert!(!damped.solve(&[1.0, 2.0, 2.0, 1.0], &[1.0, 1.0], 0.0));
        assert!(!damped.solve(&[1.0, f64::NAN, f64::NAN, 1.0], &[1.0, 1.0], 0.0));
        assert!(!damped.solve(&[f64::INFINITY, 0.0, 0.0, 1.0], &[1.0, 1.0], 0.0));
        assert!(damped.solve(&[1.0, 1.0, 1.0, 1.0], &[1.0, 1.0], 1e-3));
    }
}
