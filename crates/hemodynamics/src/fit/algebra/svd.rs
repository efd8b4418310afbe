//! Singular values of a few columns by one-sided Jacobi rotations (Hestenes 1958, doi:10.1137/0106005): small ones come
//! out as precisely as large ones. nalgebra's way does not keep them so, and has been seen to fail where the rank is
//! deficient (<https://github.com/dimforge/nalgebra/issues/1172>), which is what is asked here.

use crate::fit::algebra::qr::{dot, norm};

/// Sweeps until rotations are given up; about 6 are used.
const SWEEPS: usize = 60;

/// Singular values, falling, and the right singular vector of each (a combination of the columns, of length 1).
pub(in crate::fit) struct Svd {
    pub(in crate::fit) values: Vec<f64>,
    pub(in crate::fit) vectors: Vec<Vec<f64>>,
}

impl Svd {
    /// Of a matrix given by its columns.
    pub(in crate::fit) fn of(mut columns: Vec<Vec<f64>>) -> Svd {
        let n = columns.len();
        let mut vectors: Vec<Vec<f64>> =
            (0..n).map(|k| (0..n).map(|i| if i == k { 1.0 } else { 0.0 }).collect()).collect();
        for _ in 0..SWEEPS {
            let mut turned = false;
            for p in 0..n {
                for q in p + 1..n {
                    let (a, b, c) =
                        (dot(&columns[p], &columns[p]), dot(&columns[q], &columns[q]), dot(&columns[p], &columns[q]));
                    let oblique = c.abs() > 1e-15 * (a * b).sqrt();
                    if !oblique {
                        continue;
                    }
                    turned = true;
                    let zeta = (b - a) / (2.0 * c);
                    let tangent = zeta.signum() / (zeta.abs() + (1.0 + zeta * zeta).sqrt());
                    let cosine = 1.0 / (1.0 + tangent * tangent).sqrt();
                    for set in [&mut columns, &mut vectors] {
                        let (head, tail) = set.split_at_mut(q);
                        for (x, y) in head[p].iter_mut().zip(&mut tail[0]) {
                            let (old, other) = (*x, *y);
                            *x = cosine * old - cosine * tangent * other;
                            *y = cosine * tangent * old + cosine * other;
                        }
                    }
                }
            }
            if !turned {
                break;
            }
        }
        let mut found: Vec<(f64, Vec<f64>)> = columns.iter().map(|column| norm(column)).zip(vectors).collect();
        found.sort_by(|a, b| b.0.total_cmp(&a.0));
        let (values, vectors) = found.into_iter().unzip();
        Svd { values, vectors }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_singular_values_are_precise() {
        // Two nearly parallel columns and one of another size: sum and difference are the singular vectors.
        let delta = 1e-6;
        let svd = Svd::of(vec![vec![1.0, delta, 0.0], vec![1.0, -delta, 0.0], vec![0.0, 0.0, 1e5]]);
        let expected = [1e5, 2.0_f64.sqrt(), 2.0_f64.sqrt() * delta];
        for (got, expected) in svd.values.iter().zip(expected) {
            // Measured 1.2e-16, in spite of delta^2 = 1e-12 beside 1.
            assert!((got / expected - 1.0).abs() <= 1e-14, "{:?}", svd.values);
        }
        assert!((svd.vectors[2][0] + svd.vectors[2][1]).abs() <= 1e-14);
        assert!((svd.vectors[0][2].abs() - 1.0).abs() <= 1e-15);
    }

    #[test]
    fn a_zero_column_has_the_singular_value_zero() {
        let svd = Svd::of(vec![vec![0.0; 3], vec![1.0, 2.0, 2.0]]);
        assert_eq!(svd.values, [3.0, 0.0]);
        assert_eq!(svd.vectors[1], [1.0, 0.0]);
        assert!(Svd::of(vec![]).values.is_empty());
    }
}
