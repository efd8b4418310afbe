//! How many an hour: a count's rate with its exact interval.
//!
//! Garwood's interval (1936, DOI 10.1093/biomet/28.3-4.437): of a count k in h hours, from chi2(0.025, 2k) / 2h to
//! chi2(0.975, 2k + 2) / 2h. Where nothing was counted the interval is one-sided, up to -ln(0.05) / h: nothing in 12
//! minutes means up to 15 an hour, not none.

use serde::Serialize;
use statrs::function::gamma::gamma_lr;

/// The share that intervals hold.
const LEVEL: f64 = 0.95;

/// A rate with its interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Rate {
    /// An hour.
    pub per_hour: f64,
    /// The least that agrees with the count.
    pub low: f64,
    /// The most that agrees with it.
    pub high: f64,
}

/// A count's rate; nothing is known without time.
#[must_use]
pub fn rate_per_hour(count: u64, hours: f64) -> Option<Rate> {
    if !(hours > 0.0 && hours.is_finite()) {
        return None;
    }
    let tail = 0.5 * (1.0 - LEVEL);
    let k = count as f64;
    let (low, high) =
        if count == 0 { (0.0, -(1.0 - LEVEL).ln()) } else { (mean_below(k, tail), mean_below(k + 1.0, 1.0 - tail)) };
    Some(Rate { per_hour: k / hours, low: low / hours, high: high / hours })
}

/// The x with P(shape, x) = share, P the regularized lower incomplete gamma function: by halving, as it grows with x.
fn mean_below(shape: f64, share: f64) -> f64 {
    let (mut low, mut high) = (0.0, shape + 10.0 * shape.sqrt() + 10.0);
    // Each halving is a bit of 53, and some more for small values.
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if gamma_lr(shape, middle) < share { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_are_those_of_the_tables() {
        // Garwood's table, two-sided 95 %.
        for (count, low, high) in [(1, 0.0253, 5.572), (2, 0.2422, 7.225), (5, 1.6235, 11.668), (100, 81.36, 121.63)] {
            let rate = rate_per_hour(count, 1.0).unwrap();
            assert!((rate.low - low).abs() <= 1e-4 * low.max(1.0), "{count}: {rate:?}");
            assert!((rate.high - high).abs() <= 1e-4 * high, "{count}: {rate:?}");
        }
        let none = rate_per_hour(0, 0.2).unwrap();
        assert!(none.per_hour == 0.0 && none.low == 0.0 && (none.high - 14.979).abs() <= 1e-3, "{none:?}");
        assert_eq!(rate_per_hour(3, 0.0), None);
        assert_eq!(rate_per_hour(3, f64::NAN), None);
    }

    #[test]
    fn intervals_hold_the_truth() {
        // The exact probability that the interval holds a true mean, from the counts' own probabilities.
        for mean in [0.3, 1.0, 2.7, 8.0, 40.0] {
            let (mut held, mut probability) = (0.0, f64::exp(-mean));
            for count in 0..400u64 {
                let rate = rate_per_hour(count, 1.0).unwrap();
                held += if (rate.low..=rate.high).contains(&mean) { probability } else { 0.0 };
                probability *= mean / (count + 1) as f64;
            }
            assert!(held >= 0.949, "{mean}: {held}");
        }
    }
}
