//! A mean over subjects with its confidence interval.

use lunula_live::spread::Spread;
use serde::Serialize;

/// The mean of a quantity over subjects, and its two-sided 95 % confidence interval by Student's t.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Estimate {
    /// Over subjects.
    pub mean: f64,
    /// The interval's lower end; none for one subject.
    pub low: Option<f64>,
    /// The interval's upper end; none for one subject.
    pub high: Option<f64>,
}

impl Estimate {
    /// Of independent values, one per subject; none of none.
    #[must_use]
    pub fn of(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let spread = Spread::of(values)?;
        let [low, high] = spread.interval().map_or([None; 2], |ends| ends.map(Some));
        Some(Self { mean: spread.mean, low, high })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_value_has_no_interval_and_none_no_mean() {
        assert_eq!(Estimate::of([]), None);
        assert_eq!(Estimate::of([0.25]), Some(Estimate { mean: 0.25, low: None, high: None }));
        let two = Estimate::of([1.0, 3.0]).expect("two values");
        // The standard error of 1 and 3 is 1; t of one degree of freedom is 12.706.
        assert!((two.mean - 2.0).abs() <= 1e-15 && (two.high.expect("an interval") - 14.706).abs() <= 5e-4);
    }
}
