//! Prediction intervals: how far a prediction may be off.
//!
//! In: residuals of rows that the model was not trained on. Out: a half width a target, such that
//! `predicted +- half width` holds the measured value of a share `level` of rows: split conformal prediction, the k-th
//! smallest magnitude of n residuals, k = ceil((n + 1) level) (doi 10.1080/01621459.2017.1307116, algorithm 2).
//!
//! What is promised: that theorem needs rows that could be swapped for each other. Rows of one session could not, so
//! its exact coverage is not promised for a new session. What is promised is what was measured:
//! [`Coverage`](super::coverage::Coverage) of sessions used neither for training nor for calibration, each left out in
//! turn ([`nested_coverage`](super::coverage::nested_coverage)). With few sessions that figure itself is coarse: look
//! at the groups' least.

use ndarray::ArrayView2;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::cross::CrossFault;
use super::split::SplitFault;

/// Half widths about predictions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Intervals {
    /// The share of rows that they are made to hold, 0 to 1.
    pub level: f64,
    /// Half the width, a target each in its unit.
    pub half_width: Vec<f64>,
    /// How many residuals they were read from.
    pub rows: usize,
}

/// Why there are no intervals.
#[derive(Debug, Clone, PartialEq, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum IntervalFault {
    #[error("a level of {0}; it must be from 0 to 1")]
    Level(f64),
    #[error("{rows} held-out rows can't tell how wide {level} of all is: {}", needs(*.level))]
    TooFew { rows: usize, level: f64 },
    #[error("intervals from shuffled rows promise too much; hold out trajectories, sessions or subjects")]
    Shuffled,
    #[error("{0} groups; at least three are needed: to train on, to calibrate on and to test on")]
    Groups(usize),
    #[error(transparent)]
    Split(#[from] SplitFault),
    #[error(transparent)]
    Cross(#[from] CrossFault),
    #[error("no group gives a coverage; without {name}: {why}")]
    AllFailed { name: String, why: String },
}

fn needs(level: f64) -> String {
    if level >= 1.0 {
        "no number of rows can, ask for less than 1".to_owned()
    } else {
        format!("at least {} are needed", (level / (1.0 - level) - 1e-9).ceil())
    }
}

/// Reads half widths from residuals, rows x targets, of rows that were not trained on. Rows with a residual that is not
/// finite do not count.
///
/// # Errors
/// [`IntervalFault::Level`] and [`IntervalFault::TooFew`].
pub fn calibrate(residuals: ArrayView2<f64>, level: f64) -> Result<Intervals, IntervalFault> {
    if !(0.0..=1.0).contains(&level) {
        return Err(IntervalFault::Level(level));
    }
    let finite: Vec<_> = residuals.rows().into_iter().filter(|row| row.iter().all(|value| value.is_finite())).collect();
    let rows = finite.len();
    let place = (rows + 1) as f64 * level;
    // (99 + 1) * 0.55 is 55.00000000000001 in doubles.
    let whole = place.round();
    let place = if (place - whole).abs() <= 1e-9 * whole { whole } else { place.ceil() } as usize;
    if place > rows || rows == 0 {
        return Err(IntervalFault::TooFew { rows, level });
    }
    let half_width = (0..residuals.ncols()).map(|column| {
        let mut sizes: Vec<f64> = finite.iter().map(|row| row[column].abs()).collect();
        sizes.sort_by(f64::total_cmp);
        place.checked_sub(1).map_or(0.0, |k| sizes[k])
    });
    Ok(Intervals { level, half_width: half_width.collect(), rows })
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::{Array2, array};

    #[test]
    fn the_quantile_by_hand() {
        let residuals =
            Array2::from_shape_fn((9, 1), |(row, _)| if row % 2 == 0 { row as f64 + 1.0 } else { -(row as f64) - 1.0 });
        let half = |level| calibrate(residuals.view(), level).map(|intervals| intervals.half_width[0]);
        assert_eq!((half(0.9), half(0.5), half(0.51), half(0.0)), (Ok(9.0), Ok(5.0), Ok(6.0), Ok(0.0)));
        assert_eq!(half(0.95), Err(IntervalFault::TooFew { rows: 9, level: 0.95 }));
        assert!(half(0.95).unwrap_err().to_string().contains("at least 19 are needed"));
        assert!(half(1.0).unwrap_err().to_string().contains("ask for less than 1"));
        assert!(
            matches!(half(1.5), Err(IntervalFault::Level(_))) && matches!(half(f64::NAN), Err(IntervalFault::Level(_)))
        );
        assert!(matches!(calibrate(Array2::zeros((0, 1)).view(), 0.5), Err(IntervalFault::TooFew { rows: 0, .. })));
        let some = calibrate(array![[1.0], [f64::NAN], [f64::INFINITY], [3.0]].view(), 0.5).unwrap();
        assert_eq!((some.rows, some.half_width[0]), (2, 3.0));
    }
}
