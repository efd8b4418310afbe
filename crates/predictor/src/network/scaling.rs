//! Columns of rows to numbers of size 1 about 0, without overflow whatever their size.

use ndarray::ArrayView1;

/// Ranges below this, relative to the largest value, are what rounding leaves of a constant.
const ROUNDING: f64 = 8.0 * f64::EPSILON;
/// Scales stay where they and their reciprocals are normal numbers.
const EXTREME: i32 = 1022;

/// How a column is centred and scaled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Scaling {
    /// Its mean, or the constant.
    pub(super) centre: f64,
    /// Its standard deviation (n), or 1 where it is constant.
    pub(super) scale: f64,
    pub(super) constant: bool,
}

impl Scaling {
    /// Of a column with at least one row. `None` where the range is beyond what a double can hold.
    pub(super) fn of(column: ArrayView1<'_, f64>) -> Option<Self> {
        let (low, high) =
            column.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &v| (low.min(v), high.max(v)));
        let largest = low.abs().max(high.abs());
        if low == high {
            return Some(Self { centre: low, scale: 1.0, constant: true });
        }
        if !(high - low).is_finite() {
            return None;
        }
        let n = column.len() as f64;
        let unit = power_of_two(largest);
        let centre = (column.iter().map(|v| v / unit).sum::<f64>() / n * unit).clamp(low, high);
        if high - low <= ROUNDING * largest {
            return Some(Self { centre, scale: 1.0, constant: true });
        }
        let unit = power_of_two(high - low);
        let squares: f64 = column.iter().map(|v| ((v - centre) / unit).powi(2)).sum();
        let scale = ((squares / n).sqrt() * unit).max(power_of_two(0.0));
        Some(Self { centre, scale, constant: false })
    }

    /// The same with a power of two, so that scaling does not round.
    pub(super) fn rounded(self) -> Self {
        Self { scale: power_of_two(self.scale), ..self }
    }

    /// The value as the network sees it.
    pub(super) fn apply(&self, value: f64) -> f64 {
        (value - self.centre) / self.scale
    }
}

/// The power of two at or below, kept from the ends of the doubles.
pub(super) fn power_of_two(value: f64) -> f64 {
    let exponent = if value.is_normal() { ((value.to_bits() >> 52) & 0x7ff) as i32 - 1023 } else { -EXTREME };
    2_f64.powi(exponent.clamp(-EXTREME, EXTREME))
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::{Array1, array};

    #[test]
    fn constants_are_reported() {
        let of = |values: Array1<f64>| Scaling::of(values.view());
        assert_eq!(of(array![0.1, 0.1, 0.1]).unwrap(), Scaling { centre: 0.1, scale: 1.0, constant: true });
        assert!(of(array![3.0, 3.0 * (1.0 + f64::EPSILON)]).unwrap().constant);
        assert!(!of(array![1e6, 1e6 + 1e-3]).unwrap().constant);
        assert_eq!(of(array![-1.7e308, 1.7e308]), None);
        let tiny = of(array![0.0, 5e-324]).unwrap().rounded();
        assert!(!tiny.constant && (1.0 / tiny.scale).is_normal());
    }

    #[test]
    fn powers_of_two() {
        for (value, power) in [(1.0, 1.0), (1.99, 1.0), (2.0, 2.0), (0.75, 0.5), (1e-310, 2_f64.powi(-1022))] {
            assert_eq!(power_of_two(value), power);
        }
    }
}
