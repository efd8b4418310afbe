//! Residuals and their products with the columns, in numbers of twice the length: what one step of refinement needs, in
//! one walk over the rows.
//!
//! Björck's refinement of the augmented system (doi:10.1007/BF01939321) keeps the residual r as an unknown beside the
//! coefficients x. Here r = y - A x is worked out afresh with some 32 digits, so its equation holds exactly and only
//! A^T r = 0 is left to be mended: the step d solves R^T R d = A^T r. That gains digits also where residuals are large,
//! which refining x alone does not.

use pulp::{Arch, Simd, WithSimd};

use super::blocks::{BLOCK, LANES, Lanes, NOTHING, Part, registers, spill, total, vectors};
use super::problem::Problem;
use crate::algebra::exact::{Long, product_error, product_errors, two_sum, two_sums};

/// For one target.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Products {
    /// Of ones and columns with the residuals.
    pub(super) gradient: Vec<Long>,
    /// Sum of squares of the residuals.
    pub(super) squares: f64,
}

/// Of coefficients of ones and columns, in the problem's units, target by target.
pub(super) fn products(problem: &Problem<'_>, coefficients: &[Vec<Long>]) -> Vec<Products> {
    Arch::new().dispatch(Walk { problem, coefficients })
}

struct Walk<'a, 'b> {
    problem: &'a Problem<'b>,
    coefficients: &'a [Vec<Long>],
}

impl WithSimd for Walk<'_, '_> {
    type Output = Vec<Products>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        // Every machine that pulp knows with lanes has a fused multiplication.
        if S::F64_LANES > 1 { self.run::<S, true>(simd) } else { self.run::<S, false>(simd) }
    }
}

impl Walk<'_, '_> {
    #[inline(always)]
    fn run<S: Simd, const FUSED: bool>(self, simd: S) -> Vec<Products> {
        let columns = 1 + self.problem.columns;
        let mut sums = vec![NOTHING; columns * self.problem.targets];
        let mut squares = vec![[0.0; LANES]; self.problem.targets];
        let mut high = self.problem.block();
        let mut low = self.problem.block();
        for start in (0..self.problem.rows).step_by(BLOCK) {
            self.problem.load::<FUSED>(start, &mut high, &mut low);
            for (k, x) in self.coefficients.iter().enumerate() {
                let (mut r, mut rest) = (high[columns + k], low[columns + k]);
                for (j, x) in x.iter().enumerate() {
                    subtract::<FUSED>(&mut r, &mut rest, &high[j], self.low(&low, j), *x);
                }
                for i in 0..BLOCK {
                    (r[i], rest[i]) = two_sum(r[i], rest[i]);
                }
                for (j, sums) in sums[k * columns..(k + 1) * columns].iter_mut().enumerate() {
                    accumulate::<S, FUSED>(simd, sums, &high[j], self.low(&low, j), &r, &rest);
                }
                for chunk in r.as_chunks::<LANES>().0 {
                    for lane in 0..LANES {
                        squares[k][lane] += chunk[lane] * chunk[lane];
                    }
                }
            }
        }
        sums.chunks(columns)
            .zip(&squares)
            .map(|(sums, squares)| Products {
                gradient: sums.iter().map(total).collect(),
                squares: squares.iter().sum(),
            })
            .collect()
    }

    /// Where there is any.
    #[inline(always)]
    fn low<'b>(&self, low: &'b [Part], j: usize) -> Option<&'b Part> {
        self.problem.inexact[j].then(|| &low[j])
    }
}

/// r -= column x.
#[inline(always)]
fn subtract<const FUSED: bool>(r: &mut Part, rest: &mut Part, column: &Part, low: Option<&Part>, x: Long) {
    for i in 0..BLOCK {
        let product = column[i] * x.0;
        let error = product_error::<FUSED>(column[i], x.0, product);
        let (sum, lost) = two_sum(r[i], -product);
        r[i] = sum;
        rest[i] += (lost - error) - column[i] * x.1;
    }
    if let Some(low) = low {
        for i in 0..BLOCK {
            rest[i] -= low[i] * x.0;
        }
    }
}

/// sums += column r.
#[inline(always)]
fn accumulate<S: Simd, const FUSED: bool>(
    simd: S,
    sums: &mut Lanes,
    column: &Part,
    low: Option<&Part>,
    r: &Part,
    rest: &Part,
) {
    let width = registers::<S>();
    let (mut high, mut tail) = ([simd.splat_f64s(0.0); LANES], [simd.splat_f64s(0.0); LANES]);
    high[..width].copy_from_slice(S::as_simd_f64s(&sums.0).0);
    tail[..width].copy_from_slice(S::as_simd_f64s(&sums.1).0);
    let (column, r, rest) = (vectors::<S>(column), vectors::<S>(r), vectors::<S>(rest));
    for i in 0..BLOCK / LANES {
        for lane in 0..width {
            let (c, r, rest) = (column[i * width + lane], r[i * width + lane], rest[i * width + lane]);
            let product = simd.mul_f64s(c, r);
            let error = product_errors::<S, FUSED>(simd, c, r, product);
            let (sum, lost) = two_sums(simd, high[lane], product);
            high[lane] = sum;
            let more = simd.add_f64s(simd.add_f64s(lost, error), simd.mul_f64s(c, rest));
            tail[lane] = simd.add_f64s(tail[lane], more);
        }
    }
    if let Some(low) = low {
        let low = vectors::<S>(low);
        for i in 0..BLOCK / LANES {
            for lane in 0..width {
                let product = simd.mul_f64s(low[i * width + lane], r[i * width + lane]);
                tail[lane] = simd.add_f64s(tail[lane], product);
            }
        }
    }
    *sums = (spill::<S>(&high), spill::<S>(&tail));
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Array2;
    use pulp::Scalar;

    #[test]
    fn machines_without_fused_multiplication_get_the_same_bits() {
        let x = Array2::from_shape_fn((150, 3), |(i, j)| ((i * 3 + j) as f64 * 0.7).sin() + 0.3);
        let y = Array2::from_shape_fn((150, 2), |(i, k)| ((i + k) as f64).cos() * 0.1);
        let pairs = crate::quadratic_terms(3);
        let (mut problem, ..) = Problem::quadratic(x.view(), y.view(), &pairs).unwrap();
        problem.triangle();
        assert!(problem.inexact[4..10].iter().all(|&inexact| inexact), "products are rounded");
        let coefficients = vec![(0..10).map(|j| Long((j as f64).cos(), 1e-17)).collect(); 2];
        let walk = || Walk { problem: &problem, coefficients: &coefficients };
        assert_eq!(walk().run::<_, true>(Scalar::new()), walk().run::<_, false>(Scalar::new()));
    }
}
