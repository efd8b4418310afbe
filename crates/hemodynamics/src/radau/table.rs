//! What a Radau IIA method is made of, and the arithmetic of its eigenvalues.
//!
//! The inverse of the matrix `A` of a method with `S` stages (odd) has one real eigenvalue and `(S - 1) / 2` pairs of
//! complex ones. What belongs to the eigenvalues is kept in `S` numbers: the real parts of one of each pair, their
//! imaginary parts, the real one. Sums and products of such arrays, eigenvalue by eigenvalue, are those of
//! `R x C^((S - 1) / 2)`.

/// Coefficients of a method with `S` stages; matrices by columns.
pub(crate) struct Table<const S: usize> {
    /// `c`, growing, the last is 1.
    pub(crate) nodes: [f64; S],
    /// `A`.
    pub(crate) weights_by_column: [[f64; S]; S],
    /// Eigenvalues of `A^-1`.
    pub(crate) eigenvalues: [f64; S],
    pub(crate) reciprocals: [f64; S],
    /// From values at the stages to coordinates along the eigenvectors.
    pub(crate) to_eigen: [[f64; S]; S],
    /// And back.
    pub(crate) from_eigen: [[f64; S]; S],
    /// Derivatives at 0 of the Lagrange polynomials through 0 and the nodes.
    pub(crate) start_slopes: [f64; S],
    /// `1 / (c_i prod_j (c_i - c_j))`.
    pub(crate) barycentric: [f64; S],
    /// The polynomial that is 0 at 0, has the slope 1 there and the slope 0 at every node: coefficients of its powers 1
    /// to `S`.
    pub(crate) bump: [f64; S],
    /// Its coefficient of the power `S + 1`.
    pub(crate) bump_last: f64,
    /// Its largest absolute value on the step.
    pub(crate) bump_height: f64,
    /// Where in the step the error of the rates' polynomial is greatest.
    pub(crate) probe: f64,
    /// Derivatives there of the Lagrange polynomials through 0 and the nodes.
    pub(crate) probe_slopes: [f64; S],
    /// The largest error of the lifted polynomial, over the error of the rates' polynomial at the probe and the step.
    pub(crate) probe_reach: f64,
}

impl<const S: usize> Table<S> {
    /// The Lagrange polynomials of the nodes through 0 and the nodes, at `theta` (0 is the step's start, 1 its end).
    pub(crate) fn basis(&self, theta: f64) -> [f64; S] {
        let mut values = [0.0; S];
        let mut product = theta;
        for i in 0..S {
            values[i] = product * self.barycentric[i];
            product *= theta - self.nodes[i];
        }
        product = 1.0;
        for i in (0..S).rev() {
            values[i] *= product;
            product *= theta - self.nodes[i];
        }
        values
    }

    /// The polynomial `bump` at `theta`.
    pub(crate) fn bump(&self, theta: f64) -> f64 {
        self.bump.iter().rev().fold(self.bump_last, |sum, coefficient| sum * theta + coefficient) * theta
    }
}

/// `matrix x`, the matrix by columns.
#[inline(always)]
pub(crate) fn matvec<const S: usize>(matrix: &[[f64; S]; S], x: &[f64; S]) -> [f64; S] {
    let mut out = [0.0; S];
    for column in 0..S {
        for row in 0..S {
            out[row] += matrix[column][row] * x[column];
        }
    }
    out
}

/// The scalar product, in order.
#[inline(always)]
pub(crate) fn dot<const S: usize>(a: &[f64; S], b: &[f64; S]) -> f64 {
    let mut sum = 0.0;
    for i in 0..S {
        sum += a[i] * b[i];
    }
    sum
}

/// The product, eigenvalue by eigenvalue.
#[inline(always)]
pub(crate) fn times<const S: usize>(a: &[f64; S], b: &[f64; S]) -> [f64; S] {
    let pairs = S / 2;
    let mut out = [0.0; S];
    for k in 0..pairs {
        out[k] = a[k] * b[k] - a[k + pairs] * b[k + pairs];
    }
    for k in 0..pairs {
        out[k + pairs] = a[k] * b[k + pairs] + a[k + pairs] * b[k];
    }
    out[S - 1] = a[S - 1] * b[S - 1];
    out
}

/// The reciprocal, eigenvalue by eigenvalue.
#[inline(always)]
pub(crate) fn reciprocal<const S: usize>(a: &[f64; S]) -> [f64; S] {
    let pairs = S / 2;
    let mut out = [0.0; S];
    for k in 0..pairs {
        let inverse = 1.0 / (a[k] * a[k] + a[k + pairs] * a[k + pairs]);
        out[k] = a[k] * inverse;
        out[k + pairs] = -a[k + pairs] * inverse;
    }
    out[S - 1] = 1.0 / a[S - 1];
    out
}

/// `a factor + shift`, with `shift` real.
#[inline(always)]
pub(crate) fn scaled<const S: usize>(a: &[f64; S], factor: f64, shift: f64) -> [f64; S] {
    let mut out = [0.0; S];
    for k in 0..S {
        out[k] = a[k] * factor;
    }
    for value in out.iter_mut().take(S / 2) {
        *value += shift;
    }
    out[S - 1] += shift;
    out
}

#[cfg(test)]
mod tests {
    use super::super::tables::{RADAU5, RADAU9, RADAU13};
    use super::*;

    /// Measured 7e-15 (order conditions), 3e-13 (the transformation there and back, relative to its largest entries).
    const TOLERANCE: f64 = 2e-12;

    fn check<const S: usize>(table: &Table<S>) {
        for i in 0..S {
            let row: Vec<f64> = (0..S).map(|j| table.weights_by_column[j][i]).collect();
            for q in 1..=S {
                let sum: f64 = (0..S).map(|j| row[j] * table.nodes[j].powi(q as i32 - 1)).sum();
                assert!((sum - table.nodes[i].powi(q as i32) / q as f64).abs() <= TOLERANCE, "C({q}) at stage {i}");
            }
        }
        for q in 1..2 * S {
            let sum: f64 = (0..S).map(|j| table.weights_by_column[j][S - 1] * table.nodes[j].powi(q as i32 - 1)).sum();
            assert!((sum - 1.0 / q as f64).abs() <= TOLERANCE, "B({q})");
        }
        for j in 0..S {
            let mut unit = [0.0; S];
            unit[j] = 1.0;
            // A x = V (V^-1 x / mu), and x = V V^-1 x.
            let image = matvec(&table.from_eigen, &times(&table.reciprocals, &matvec(&table.to_eigen, &unit)));
            let same = matvec(&table.from_eigen, &matvec(&table.to_eigen, &unit));
            for i in 0..S {
                assert!((image[i] - table.weights_by_column[j][i]).abs() <= TOLERANCE, "A {i} {j}");
                assert!((same[i] - unit[i]).abs() <= TOLERANCE, "V V^-1 {i} {j}");
            }
        }
        let one = times(&table.eigenvalues, &reciprocal(&table.eigenvalues));
        for (k, value) in one.iter().enumerate() {
            let unit = if k < S / 2 || k == S - 1 { 1.0 } else { 0.0 };
            assert!((value - unit).abs() <= TOLERANCE);
        }
    }

    #[test]
    fn tables_fulfil_the_order_conditions() {
        check(&RADAU5);
        check(&RADAU9);
        check(&RADAU13);
    }

    fn check_dense<const S: usize>(table: &Table<S>) {
        let width = 1e-6;
        for i in 0..S {
            let at_node = table.basis(table.nodes[i]);
            for (j, value) in at_node.iter().enumerate() {
                assert!((value - if i == j { 1.0 } else { 0.0 }).abs() <= TOLERANCE);
            }
            let slope = (table.bump(table.nodes[i] + width) - table.bump(table.nodes[i] - width)) / (2.0 * width);
            // Central differences; measured 1.2e-8.
            assert!(slope.abs() <= 1e-7, "the bump is flat at node {i}: {slope}");
            assert!(table.bump(table.nodes[i]).abs() <= table.bump_height * (1.0 + TOLERANCE));
        }
        assert!(table.basis(0.0).iter().all(|&value| value == 0.0) && table.bump(0.0) == 0.0);
        assert!(table.bump(1.0).abs() <= TOLERANCE);
        let (here, there) = (table.basis(-width), table.basis(width));
        for i in 0..S {
            let slope = (there[i] - here[i]) / (2.0 * width);
            assert!((slope - table.start_slopes[i]).abs() <= 1e-6 * slope.abs(), "slope {i} at the start");
        }
    }

    #[test]
    fn dense_output_passes_through_the_stages() {
        check_dense(&RADAU5);
        check_dense(&RADAU9);
        check_dense(&RADAU13);
    }
}
