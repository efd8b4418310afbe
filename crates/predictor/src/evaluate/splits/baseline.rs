//! What a model has to beat: the mean of the rows trained on, and what the nearest of them had.

use ndarray::{Array2, ArrayView1, Axis};
use rayon::prelude::*;

use crate::Dataset;

/// The mean of the training rows for each row of a test.
pub(super) fn mean(train: &Dataset, test: &Dataset) -> Array2<f64> {
    let mean = train.y().mean_axis(Axis(0)).unwrap_or_else(|| ndarray::Array1::from_elem(train.y().ncols(), f64::NAN));
    Array2::from_shape_fn(test.y().dim(), |(_, target)| mean[target])
}

/// What the nearest training row had, by the mean squared distance of the inputs that both have; of equals the first,
/// NaN without any. It remembers all, so rows nearby in time flatter it most.
pub(in crate::evaluate) fn nearest(train: &Dataset, test: &Dataset) -> Array2<f64> {
    let near: Vec<Option<usize>> = (0..test.rows())
        .into_par_iter()
        .map(|row| {
            let all = (0..train.rows()).filter_map(|k| Some((k, apart(test.x().row(row), train.x().row(k))?)));
            all.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(k, _)| k)
        })
        .collect();
    let value = |(row, target): (usize, usize)| near[row].map_or(f64::NAN, |k| train.y()[[k, target]]);
    Array2::from_shape_fn(test.y().dim(), value)
}

fn apart(a: ArrayView1<'_, f64>, b: ArrayView1<'_, f64>) -> Option<f64> {
    let (mut sum, mut both) = (0.0, 0_u32);
    for (a, b) in a.iter().zip(b) {
        let apart = a - b;
        if !apart.is_nan() {
            sum += apart * apart;
            both += 1;
        }
    }
    (both > 0).then(|| sum / f64::from(both))
}
