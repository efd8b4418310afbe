//! Least squares by Householder's reflections: a tall matrix to a triangle, never to normal equations. Fixed order of
//! summation: the same digits on every machine.

/// Reduces the columns of a tall matrix (each of `rows` values, at least as many as columns) to the upper triangle `R`,
/// row-major, and `target` to `Q^T target`, whose first values belong to `R`'s rows. Columns are overwritten.
pub(in crate::fit) fn triangle(columns: &mut [Vec<f64>], target: &mut [f64]) -> Vec<f64> {
    let n = columns.len();
    let mut r = vec![0.0; n * n];
    for k in 0..n {
        let (done, rest) = columns.split_at_mut(k + 1);
        let column = &mut done[k];
        for (i, value) in column[..k].iter().enumerate() {
            r[i * n + k] = *value;
        }
        let norm = norm(&column[k..]);
        if norm == 0.0 {
            continue;
        }
        // v = x + sign(x_0) |x| e_0, scaled so that |v|^2 = 2 is not needed: beta = 2 / |v|^2 = 1 / (|x| (|x| +
        // |x_0|)).
        let diagonal = if column[k] > 0.0 { -norm } else { norm };
        let beta = 1.0 / (norm * (norm + column[k].abs()));
        column[k] -= diagonal;
        for other in rest.iter_mut().map(|other| &mut other[..]).chain([&mut *target]) {
            let along = beta * dot(&column[k..], &other[k..]);
            for (value, v) in other[k..].iter_mut().zip(&column[k..]) {
                *value -= along * v;
            }
        }
        r[k * n + k] = diagonal;
    }
    r
}

pub(in crate::fit) fn dot(a: &[f64], b: &[f64]) -> f64 {
    // Four sums: the order is fixed, and the machine need not wait for each addition.
    let mut sums = [0.0; 4];
    let (fours_a, fours_b) = (a.chunks_exact(4), b.chunks_exact(4));
    let tail: f64 = fours_a.remainder().iter().zip(fours_b.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in fours_a.zip(fours_b) {
        for k in 0..4 {
            sums[k] += a[k] * b[k];
        }
    }
    (sums[0] + sums[2]) + (sums[1] + sums[3]) + tail
}

pub(in crate::fit) fn norm(a: &[f64]) -> f64 {
    let largest = a.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    if largest > 1e-140 && largest < 1e140 {
        return dot(a, a).sqrt();
    }
    if largest == 0.0 || !largest.is_finite() {
        return largest;
    }
    let scaled: f64 = a.iter().map(|value| (value / largest) * (value / largest)).sum();
    largest * scaled.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keeps_all_inner_products() {
        let columns: Vec<Vec<f64>> = (0..3)
            .map(|k| (0..11).map(|i| ((i * (k + 2)) as f64 * 0.37).sin() * 10.0_f64.powi(4 * k)).collect())
            .collect();
        let target: Vec<f64> = (0..11).map(|i| (i as f64).cos()).collect();
        let (mut reduced, mut turned) = (columns.clone(), target.clone());
        let r = triangle(&mut reduced, &mut turned);
        for i in 0..3 {
            let of_r = |j: usize| -> f64 { (0..3).map(|k| r[3 * k + i] * r[3 * k + j]).sum() };
            for j in 0..3 {
                let exact = dot(&columns[i], &columns[j]);
                let scale = norm(&columns[i]) * norm(&columns[j]);
                // Measured 2e-16 (products), 1.1e-16 (target), 5e-16 (its norm).
                assert!((of_r(j) - exact).abs() <= 1e-14 * scale);
            }
            let turned: f64 = (0..3).map(|k| r[3 * k + i] * turned[k]).sum();
            assert!((turned - dot(&columns[i], &target)).abs() <= 1e-14 * norm(&columns[i]) * norm(&target));
        }
        assert!((norm(&turned) - norm(&target)).abs() <= 1e-14);
        assert_eq!([r[3], r[6], r[7]], [0.0; 3]);
    }

    #[test]
    fn norms_neither_overflow_nor_vanish() {
        for scale in [1e-300, 1.0, 1e200] {
            assert!((norm(&[3.0 * scale, 4.0 * scale]) / (5.0 * scale) - 1.0).abs() <= 1e-15);
        }
        assert_eq!(norm(&[0.0, 0.0]), 0.0);
    }
}
