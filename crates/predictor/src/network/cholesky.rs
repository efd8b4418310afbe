//! A damped step: (A + mu I) p = -g by Cholesky's factorization.

use crate::algebra::cholesky::{back, factorize, forward};

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
        if !factorize(&mut self.factor, size, mu) {
            return false;
        }
        for (step, gradient) in self.step.iter_mut().zip(gradient) {
            *step = -gradient;
        }
        forward(&self.factor, &mut self.step);
        back(&self.factor, &mut self.step);
        self.step.iter().all(|step| step.is_finite())
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
