//! Predictions with what was measured at the same time.

use lunula_predictor::{Dataset, Recording};
use ndarray::ArrayView2;

/// Predictions row by row. Arrays are rows x targets; NaN is not known.
#[derive(Debug, Clone, Copy)]
pub(in crate::predictor) struct Predicted<'a> {
    /// Names of the targets, with units: `Fz_N`, `J2_deg`.
    pub targets: &'a [String],
    /// The recordings, in order.
    pub recordings: &'a [Recording],
    /// Seconds within the recording; NaN where not known.
    pub time_s: &'a [f64],
    /// What was measured, if it was.
    pub measured: Option<ArrayView2<'a, f64>>,
    /// What was predicted.
    pub predicted: ArrayView2<'a, f64>,
    /// The ends of prediction intervals, and how much of the rows they are to cover (0.9 for 90 %).
    pub interval: Option<([ArrayView2<'a, f64>; 2], f64)>,
}

impl<'a> Predicted<'a> {
    /// Predictions of a dataset's rows.
    #[must_use]
    pub(in crate::predictor) fn of(data: &'a Dataset, predicted: ArrayView2<'a, f64>) -> Self {
        Self {
            targets: data.targets(),
            recordings: data.recordings(),
            time_s: data.time_s(),
            measured: Some(data.y().view()),
            predicted,
            interval: None,
        }
    }

    /// Root mean square of predicted less measured over the rows in which both are known, and their number; none
    /// without such a row.
    #[must_use]
    pub(in crate::predictor) fn rmse(&self, target: usize) -> Option<(f64, usize)> {
        let measured = self.measured?;
        let pairs = measured.column(target).into_iter().zip(self.predicted.column(target));
        let errors = pairs.map(|(m, p)| p - m).filter(|error| error.is_finite());
        // Scaled by the largest: squares of huge errors overflow.
        let largest = errors.clone().fold(0.0, |most: f64, error| most.max(error.abs()));
        let count = errors.clone().count();
        let scale = if largest > 0.0 { largest } else { 1.0 };
        let sum = errors.map(|error| (error / scale).powi(2)).sum::<f64>();
        (count > 0).then(|| (scale * (sum / count as f64).sqrt(), count))
    }
}
