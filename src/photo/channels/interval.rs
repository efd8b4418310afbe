//! A mean over subjects with its confidence interval.

use serde::Serialize;

/// Probability that an interval of many holds the mean.
const CONFIDENCE: f64 = 0.95;

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
    pub fn of(values: &[f64]) -> Option<Self> {
        let n = values.len();
        if n == 0 {
            return None;
        }
        let mean = values.iter().sum::<f64>() / n as f64;
        let half = (n > 1).then(|| {
            let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (n - 1) as f64;
            t_quantile(n - 1) * (variance / n as f64).sqrt()
        });
        Some(Self { mean, low: half.map(|half| mean - half), high: half.map(|half| mean + half) })
    }
}

/// How many standard errors the interval reaches to either side, for `freedom` degrees of freedom.
///
/// By bisection of the probability as a finite series in the angle atan(t / sqrt(freedom)): Abramowitz and Stegun
/// 26.7.3 and 26.7.4.
fn t_quantile(freedom: usize) -> f64 {
    let (mut low, mut high) = (0.0, std::f64::consts::FRAC_PI_2);
    // Bisected to the last bit of the angle.
    for _ in 0..64 {
        let middle = 0.5 * (low + high);
        if probability_within(middle, freedom) < CONFIDENCE {
            low = middle;
        } else {
            high = middle;
        }
    }
    (freedom as f64).sqrt() * low.tan()
}

/// Probability that |t| is at most sqrt(`freedom`) tan(`angle`).
fn probability_within(angle: f64, freedom: usize) -> f64 {
    let (sin, cos) = angle.sin_cos();
    let odd = freedom % 2 == 1;
    let mut term = if odd { cos } else { 1.0 };
    let mut sum = term;
    let mut k = if odd { 2 } else { 1 };
    while k + 3 <= freedom {
        term *= cos * cos * k as f64 / (k + 1) as f64;
        sum += term;
        k += 2;
    }
    match (odd, freedom) {
        (true, 1) => std::f64::consts::FRAC_2_PI * angle,
        (true, _) => std::f64::consts::FRAC_2_PI * (angle + sin * sum),
        (false, _) => sin * sum,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_the_tables() {
        // Abramowitz and Stegun, table 26.10, to its three digits; 1 and 2 in closed form.
        for (freedom, expected) in [(3, 3.182), (4, 2.776), (7, 2.365), (15, 2.131), (30, 2.042), (120, 1.980)] {
            let t = t_quantile(freedom);
            assert!((t - expected).abs() <= 5e-4, "{freedom}: {t}");
        }
        assert!((t_quantile(1) - (0.475 * std::f64::consts::PI).tan()).abs() <= 1e-12);
        assert!((t_quantile(2) - 0.95 * (2.0_f64 / (1.0 - 0.95 * 0.95)).sqrt()).abs() <= 1e-12);
        assert!((t_quantile(100_000) - 1.96).abs() <= 1e-4);
    }

    #[test]
    fn one_value_has_no_interval_and_none_no_mean() {
        assert_eq!(Estimate::of(&[]), None);
        assert_eq!(Estimate::of(&[0.25]), Some(Estimate { mean: 0.25, low: None, high: None }));
        let two = Estimate::of(&[1.0, 3.0]).expect("two values");
        // The standard error of 1 and 3 is 1.
        assert!(
            (two.mean - 2.0).abs() <= 1e-15 && (two.high.expect("an interval") - 2.0 - t_quantile(1)).abs() <= 1e-12
        );
    }
}
