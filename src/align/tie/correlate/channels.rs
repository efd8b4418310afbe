//! The log's columns as few that are independent: principal components of what changes quickly.

use nalgebra::DMatrix;

use super::drift::Drift;
use super::series::Series;

/// So many at most, and each with at least this share of the variance.
const MOST: usize = 3;
const LEAST: f64 = 0.002;

/// The least noise that is believed, as a share of the noisiest column's.
const LEAST_NOISE: f64 = 1e-3;

/// The components of `log` over time, and their weights, which add up to 1.
pub(super) fn components(log: &Series) -> (Series, Vec<f64>) {
    let drift = Drift::new(&log.time_s);
    let quick: Vec<Vec<f64>> = log
        .columns
        .iter()
        .map(|column| {
            let mut column = column.clone();
            drift.take_off(&mut column);
            column
        })
        .collect();
    let noise: Vec<f64> = quick.iter().map(|column| noise(column)).collect();
    let most = noise.iter().fold(f64::MIN_POSITIVE, |most: f64, noise| most.max(*noise));
    // What has no noise at all counts as having little.
    let scale: Vec<f64> = noise.iter().map(|noise| 1.0 / noise.max(LEAST_NOISE * most)).collect();
    let n = quick.len();
    let products = DMatrix::from_fn(n, n, |i, j| {
        scale[i] * scale[j] * quick[i].iter().zip(&quick[j]).map(|(a, b)| a * b).sum::<f64>()
    });
    let all = products.trace().max(f64::MIN_POSITIVE);
    let eigen = products.symmetric_eigen();
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]).then(a.cmp(&b)));
    order.truncate(MOST);
    let first = order[0];
    order.retain(|&k| k == first || eigen.eigenvalues[k] >= LEAST * all);
    let kept: f64 = order.iter().map(|&k| eigen.eigenvalues[k]).sum::<f64>().max(f64::MIN_POSITIVE);
    let column = |&k: &usize| {
        let share: Vec<f64> = (0..n).map(|i| scale[i] * eigen.eigenvectors[(i, k)]).collect();
        (0..log.time_s.len()).map(|row| log.columns.iter().zip(&share).map(|(c, s)| c[row] * s).sum()).collect()
    };
    let columns: Vec<Vec<f64>> = order.iter().map(column).collect();
    let weights = order.iter().map(|&k| eigen.eigenvalues[k] / kept).collect();
    (Series { time_s: log.time_s.clone(), columns, interval_s: log.interval_s }, weights)
}

/// The root mean square of second differences: of noise that changes from row to row it is a fixed multiple, and of
/// slow signals it is small.
fn noise(column: &[f64]) -> f64 {
    let squares = column.windows(3).map(|v| (v[0] - 2.0 * v[1] + v[2]).powi(2));
    (squares.sum::<f64>() / column.len() as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn copies_of_one_signal_are_one_component() {
        let time_s: Vec<f64> = (0..600).map(|k| 0.1 * f64::from(k)).collect();
        let columns = (1..9).map(|k| time_s.iter().map(|t| f64::from(k) * t.sin() + 0.2 * t).collect()).collect();
        let (few, weights) = components(&Series { time_s, columns, interval_s: 0.1 });
        assert_eq!((few.columns.len(), weights.len()), (1, 1));
        assert!((weights[0] - 1.0).abs() < 1e-12);
    }
}
