//! Linear regression of channels on regressors from sums over rows, so that rows can be added up, taken away and
//! resampled in blocks.

use nalgebra::DMatrix;

/// A share of the greatest by which each regressor's square is raised, so that regressors that are the same don't
/// matter.
const RIDGE: f64 = 1e-6;
/// No less is said to be left over.
const LEAST: f64 = 1e-6;

/// Sums over rows: number of rows, regressors x, channels y, their products.
#[derive(Debug, Clone)]
pub(super) struct Sums {
    regressors: usize,
    channels: usize,
    /// count, then x, y, x by x (lower half), x by y, y by y (lower half).
    values: Vec<f64>,
}

impl Sums {
    pub(super) fn new(regressors: usize, channels: usize) -> Self {
        let many = 1
            + regressors
            + channels
            + regressors * (regressors + 1) / 2
            + regressors * channels
            + channels * (channels + 1) / 2;
        Self { regressors, channels, values: vec![0.0; many] }
    }

    pub(super) fn add_row(&mut self, x: &[f64], y: &[f64]) {
        let mut at = self.values.iter_mut();
        let mut add = |value: f64| {
            if let Some(sum) = at.next() {
                *sum += value;
            }
        };
        add(1.0);
        x.iter().for_each(|&x| add(x));
        y.iter().for_each(|&y| add(y));
        for (i, &a) in x.iter().enumerate() {
            x[..=i].iter().for_each(|&b| add(a * b));
        }
        for &a in x {
            y.iter().for_each(|&b| add(a * b));
        }
        for (i, &a) in y.iter().enumerate() {
            y[..=i].iter().for_each(|&b| add(a * b));
        }
    }

    pub(super) fn add(&mut self, other: &Self) {
        for (sum, value) in self.values.iter_mut().zip(&other.values) {
            *sum += value;
        }
    }

    pub(super) fn clear(&mut self) {
        self.values.fill(0.0);
    }

    pub(super) fn count(&self) -> f64 {
        self.values[0]
    }

    /// See [`left`]; 0 where there is too little.
    pub(super) fn left(&self) -> f64 {
        let (p, q, n) = (self.regressors, self.channels, self.values[0]);
        if n < (p + q + 1) as f64 {
            return 0.0;
        }
        let (x, y) = (&self.values[1..=p], &self.values[1 + p..1 + p + q]);
        let xx = &self.values[1 + p + q..];
        let xy = &xx[p * (p + 1) / 2..];
        let yy = &xy[p * q..];
        let spread = |sums: &[f64], means: &[f64]| {
            DMatrix::from_fn(means.len(), means.len(), |i, j| {
                let (i, j) = (i.max(j), i.min(j));
                sums[i * (i + 1) / 2 + j] / n - means[i] * means[j] / (n * n)
            })
        };
        let Some(factor) = factor(spread(xx, x)) else { return 0.0 };
        left(&factor, DMatrix::from_fn(p, q, |i, k| xy[i * q + k] / n - x[i] * y[k] / (n * n)), spread(yy, y))
    }
}

/// The Cholesky factor of regressors' covariances, each variance raised a little; none where nothing varies.
pub(super) fn factor(mut spread: DMatrix<f64>) -> Option<DMatrix<f64>> {
    let most = spread.diagonal().max();
    if most.is_nan() || most <= 0.0 {
        return None;
    }
    for i in 0..spread.nrows() {
        spread[(i, i)] += RIDGE * most;
    }
    spread.cholesky().map(|c| c.unpack())
}

/// The logarithm of the share that the regressors leave over of the variance of that combination of channels which they
/// explain best (1 less the square of the first canonical correlation), from the regressors' [`factor`], their
/// covariances with the channels, and the channels' own.
pub(super) fn left(regressors: &DMatrix<f64>, mut both: DMatrix<f64>, channels: DMatrix<f64>) -> f64 {
    let Some(own) = factor(channels) else { return 0.0 };
    if !regressors.solve_lower_triangular_mut(&mut both) {
        return 0.0;
    }
    let mut turned = both.transpose();
    if !own.solve_lower_triangular_mut(&mut turned) {
        return 0.0;
    }
    let explained = &turned * turned.transpose();
    let most = match explained.nrows() {
        1 => explained[(0, 0)],
        2 => {
            let [a, b, c] = [explained[(0, 0)], explained[(1, 0)], explained[(1, 1)]];
            0.5 * (a + c) + (0.5 * (a - c)).hypot(b)
        }
        _ => explained.symmetric_eigenvalues().max(),
    };
    (1.0 - most).clamp(LEAST, 1.0).ln()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_channel_made_of_the_regressors_is_explained_and_noise_is_not() {
        let mut sums = Sums::new(2, 1);
        let mut other = Sums::new(2, 1);
        for k in 0..200 {
            let x = [f64::from(k * 37 % 101), f64::from(k * 53 % 89)];
            sums.add_row(&x, &[3.0 * x[0] - x[1] + 7.0]);
            other.add_row(&x, &[f64::from(k * 71 % 97)]);
        }
        let (own, unlike) = (sums.left(), other.left());
        assert!(own < 1e-5f64.ln() && unlike > 0.9f64.ln(), "{own} {unlike}");
    }
}
