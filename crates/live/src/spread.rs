//! Means of people or trials, how they differ, and what that says of the mean.
//!
//! In: independent values, one per person or trial. Out: their mean, standard deviation (n - 1) and the 95 % interval
//! of the mean by Student's t. Values that are not finite are not known, and not counted.

use serde::Serialize;
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

/// Probability that an interval holds the mean.
pub const CONFIDENCE: f64 = 0.95;

/// A mean with its standard deviation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Spread {
    /// Values that are known.
    pub n: usize,
    /// Their mean.
    pub mean: f64,
    /// Their standard deviation, with n - 1; none of one value.
    pub sd: Option<f64>,
}

impl Spread {
    /// Of the finite values; none of none.
    #[must_use]
    pub fn of(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let known: Vec<f64> = values.into_iter().filter(|value| value.is_finite()).collect();
        let n = known.len();
        if n == 0 {
            return None;
        }
        let mean = known.iter().sum::<f64>() / n as f64;
        let squares = known.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
        Some(Self { n, mean, sd: (n > 1).then(|| (squares / (n - 1) as f64).sqrt()) })
    }

    /// The 95 % interval of the mean, `[low, high]`; none of one value.
    #[must_use]
    pub fn interval(&self) -> Option<[f64; 2]> {
        let half = t_quantile(self.n.checked_sub(1)?)? * self.sd? / (self.n as f64).sqrt();
        Some([self.mean - half, self.mean + half])
    }
}

/// How many standard errors a two-sided 95 % interval reaches to either side, for `freedom` degrees of freedom; none
/// for 0.
#[must_use]
pub fn t_quantile(freedom: usize) -> Option<f64> {
    let t = StudentsT::new(0.0, 1.0, freedom as f64).ok()?;
    Some(t.inverse_cdf(0.5 * (1.0 + CONFIDENCE)))
}

/// The share of normal values that lie below so many standard deviations over their mean.
#[must_use]
pub fn normal_below(standard_deviations: f64) -> f64 {
    Normal::standard().cdf(standard_deviations)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_the_tables() {
        // Abramowitz and Stegun, table 26.10, to its three digits; 1 and 2 in closed form.
        for (freedom, expected) in [(3, 3.182), (4, 2.776), (7, 2.365), (15, 2.131), (30, 2.042), (120, 1.980)] {
            let t = t_quantile(freedom).unwrap();
            assert!((t - expected).abs() <= 5e-4, "{freedom}: {t}");
        }
        assert!((t_quantile(1).unwrap() - (0.475 * std::f64::consts::PI).tan()).abs() <= 1e-12);
        assert!((t_quantile(2).unwrap() - 0.95 * (2.0_f64 / (1.0 - 0.95 * 0.95)).sqrt()).abs() <= 1e-12);
        assert!((t_quantile(100_000).unwrap() - 1.96).abs() <= 1e-4);
        assert_eq!(t_quantile(0), None);
    }

    #[test]
    fn means_are_of_what_is_known() {
        assert_eq!(Spread::of([f64::NAN, f64::INFINITY]), None);
        let one = Spread::of([0.25]).unwrap();
        assert_eq!((one, one.interval()), (Spread { n: 1, mean: 0.25, sd: None }, None));
        let three = Spread::of([1.0, f64::NAN, 2.0, 6.0]).unwrap();
        // 1, 2 and 6 are 2, 1 and 3 off their mean.
        assert_eq!(three, Spread { n: 3, mean: 3.0, sd: Some(7.0_f64.sqrt()) });
        let [low, high] = three.interval().unwrap();
        let half = t_quantile(2).unwrap() * (7.0_f64 / 3.0).sqrt();
        assert!((low - 3.0 + half).abs() <= 1e-15 && (high - 3.0 - half).abs() <= 1e-15);
    }
}
