//! Naive twins: least squares by the textbook, in plain arithmetic, for designs that make that good enough.

use ndarray::{Array1, Array2, Axis};

/// The columns less their means, over their lengths, and these lengths (1 where a column is constant).
fn standard(design: &Array2<f64>) -> (Array2<f64>, Array1<f64>) {
    let centred = design - &design.mean_axis(Axis(0)).unwrap();
    let lengths =
        centred.map_axis(Axis(0), |c| c.dot(&c).sqrt()).mapv(|length| if length > 1e-9 { length } else { 1.0 });
    (&centred / &lengths, lengths)
}

/// Solves A x = b by Gauss with row pivoting; b may have several columns.
pub(crate) fn solve(mut a: Array2<f64>, mut b: Array2<f64>) -> Array2<f64> {
    let n = a.nrows();
    for k in 0..n {
        let best = (k..n).max_by(|&p, &q| a[[p, k]].abs().total_cmp(&a[[q, k]].abs())).unwrap();
        for j in 0..n {
            a.swap([k, j], [best, j]);
        }
        for j in 0..b.ncols() {
            b.swap([k, j], [best, j]);
        }
        for i in (0..n).filter(|&i| i != k) {
            let factor = a[[i, k]] / a[[k, k]];
            for j in 0..n {
                a[[i, j]] -= factor * a[[k, j]];
            }
            for j in 0..b.ncols() {
                b[[i, j]] -= factor * b[[k, j]];
            }
        }
    }
    for i in 0..n {
        b.row_mut(i).mapv_inplace(|v| v / a[[i, i]]);
    }
    b
}

/// Coefficients, targets x columns, of least squares with lambda times the sum of squares of coefficient times length.
pub(crate) fn ridge(design: &Array2<f64>, targets: &Array2<f64>, lambda: f64) -> Array2<f64> {
    let (z, lengths) = standard(design);
    let y = targets - &targets.mean_axis(Axis(0)).unwrap();
    let gram = z.t().dot(&z) + Array2::<f64>::eye(z.ncols()) * lambda;
    solve(gram, z.t().dot(&y)).reversed_axes() / &lengths
}

/// The limit of the ridge towards 0, by Richardson's extrapolation: the minimum norm.
pub(crate) fn minimum_norm(design: &Array2<f64>, targets: &Array2<f64>) -> Array2<f64> {
    // Errors go with lambda, then lambda^2, ..
    let mut table: Vec<Array2<f64>> = (0..7).map(|k| ridge(design, targets, 1e-2 / 2f64.powi(k))).collect();
    for order in 1..table.len() {
        let factor = 2f64.powi(order as i32);
        for k in 0..table.len() - order {
            table[k] = (&table[k + 1] * factor - &table[k]) / (factor - 1.0);
        }
    }
    table.swap_remove(0)
}

/// Largest difference, over the largest value.
pub(crate) fn gap(a: &Array2<f64>, b: &Array2<f64>) -> f64 {
    let most = b.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
    (a - b).iter().fold(0.0, |worst: f64, v| worst.max(v.abs())) / most
}
