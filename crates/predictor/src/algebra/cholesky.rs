//! Cholesky's factorization: R of R^T R = A + mu I, and what is solved with it.
//!
//! Matrices are square, row by row; of A and R only what is on the diagonal and right of it is read.

use super::simd::{Work, widest};

/// Puts R in A's place. False where rounding leaves the matrix not positive definite or anything not finite.
pub(crate) fn factorize(matrix: &mut [f64], size: usize, mu: f64) -> bool {
    widest(Factorize { matrix, size, mu })
}

/// Solves R^T z = b in b's place.
pub(crate) fn forward(factor: &[f64], b: &mut [f64]) {
    let size = b.len();
    for (k, row) in factor.chunks_exact(size).enumerate() {
        let value = b[k] / row[k];
        b[k] = value;
        for (b, factor) in b[k + 1..].iter_mut().zip(&row[k + 1..]) {
            *b -= factor * value;
        }
    }
}

/// Solves R x = z in z's place.
pub(crate) fn back(factor: &[f64], z: &mut [f64]) {
    let size = z.len();
    for (k, row) in factor.chunks_exact(size).enumerate().rev() {
        let known: f64 = row[k + 1..].iter().zip(&z[k + 1..]).map(|(factor, z)| factor * z).sum();
        z[k] = (z[k] - known) / row[k];
    }
}

/// A factored matrix.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Cholesky {
    factor: Vec<f64>,
    size: usize,
}

impl Cholesky {
    /// Of a matrix, row by row, with `mu` added to its diagonal; none where it is not positive definite.
    pub(crate) fn of(mut matrix: Vec<f64>, size: usize, mu: f64) -> Option<Self> {
        factorize(&mut matrix, size, mu).then_some(Self { factor: matrix, size })
    }

    /// Solves A x = b in b's place.
    pub(crate) fn solve(&self, b: &mut [f64]) {
        forward(&self.factor, b);
        back(&self.factor, b);
    }

    /// b^T A^-1 b; b is used up.
    pub(crate) fn square(&self, b: &mut [f64]) -> f64 {
        forward(&self.factor, b);
        b.iter().map(|value| value * value).sum()
    }

    /// ln det A.
    pub(crate) fn log_determinant(&self) -> f64 {
        2.0 * (0..self.size).map(|k| self.factor[k * self.size + k].ln()).sum::<f64>()
    }

    /// Row k of R; 0 left of the diagonal.
    pub(crate) fn row(&self, k: usize) -> impl Iterator<Item = f64> + '_ {
        let row = &self.factor[k * self.size..(k + 1) * self.size];
        row.iter().enumerate().map(move |(j, value)| if j < k { 0.0 } else { *value })
    }

    /// A^-1, row by row, the whole of it.
    pub(crate) fn inverse(&self) -> Vec<f64> {
        let mut inverse = vec![0.0; self.size * self.size];
        for (k, row) in inverse.chunks_exact_mut(self.size).enumerate() {
            row[k] = 1.0;
            self.solve(row);
        }
        inverse
    }
}

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
