//! Sums, means and root mean squares that neither cancel, overflow nor underflow.
//!
//! In: finite numbers of any size, in a fixed order. Out: the same bits wherever it runs. Sums carry what each addition
//! rounds off (Knuth's two-sum; The Art of Computer Programming 2, 4.2.2), scales are powers of two and round nothing.

use crate::algebra::exact::two_sum;

/// A sum that carries what rounding takes away.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Sum {
    high: f64,
    low: f64,
}

impl Sum {
    pub(crate) fn add(&mut self, value: f64) {
        let (sum, error) = two_sum(self.high, value);
        self.high = sum;
        self.low += error;
    }

    pub(crate) fn value(self) -> f64 {
        self.high + self.low
    }
}

impl FromIterator<f64> for Sum {
    fn from_iter<I: IntoIterator<Item = f64>>(values: I) -> Self {
        let mut sum = Self::default();
        values.into_iter().for_each(|value| sum.add(value));
        sum
    }
}

/// The power of two just below a size, at least the least normal one: what is divided by it is below 2.
pub(crate) fn power_of_two(size: f64) -> f64 {
    const EXPONENT: u64 = 0x7ff0_0000_0000_0000;
    f64::from_bits(size.to_bits() & EXPONENT).max(f64::MIN_POSITIVE)
}

/// The greatest magnitude, 0 of nothing.
pub(crate) fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |most, value| value.abs().max(most))
}

/// The mean; NaN of nothing. Infinite numbers give what plain addition gives.
pub(crate) fn mean(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let n = values.clone().count();
    let most = largest(values.clone());
    if most.is_infinite() {
        return values.sum::<f64>();
    }
    let scale = power_of_two(most);
    values.map(|value| value / scale).collect::<Sum>().value() / n as f64 * scale
}

/// The root mean square; NaN of nothing, infinite where a number is.
pub(crate) fn rms(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let n = values.clone().count();
    let most = largest(values.clone());
    if most.is_infinite() {
        return f64::INFINITY;
    }
    let scale = power_of_two(most);
    let squares: Sum = values.map(|value| (value / scale).powi(2)).collect();
    (squares.value() / n as f64).sqrt() * scale
}

/// A mean as its double and what the double leaves over, of finite numbers: an offset far above the signal costs no
/// digits. NaN of nothing.
pub(crate) fn exact_mean(values: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
    let near = mean(values.clone());
    (near, mean(values.map(|value| value - near)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_cancels() {
        let values = [1e16, 1.0, -1e16, 1.0];
        assert_eq!(values.iter().copied().collect::<Sum>().value(), 2.0);
        assert_eq!(mean(values.into_iter()), 0.5);
    }

    #[test]
    fn no_size_is_too_great_or_too_small() {
        for size in [1e300, 1e-300, f64::MAX, f64::MIN_POSITIVE, 1.0] {
            assert_eq!(mean([size, size].into_iter()), size);
            assert_eq!(rms([size, -size].into_iter()), size);
        }
        assert_eq!(rms([5e-324].into_iter()), 5e-324);
        assert_eq!(rms([0.0].into_iter()), 0.0);
        assert_eq!(rms([1.0, f64::NEG_INFINITY].into_iter()), f64::INFINITY);
        assert!(mean([].into_iter()).is_nan() && rms([].into_iter()).is_nan());
    }

    #[test]
    fn a_mean_is_known_beyond_its_double() {
        let offset = 2f64.powi(20);
        let (near, rest) = exact_mean([offset, offset, offset + 2f64.powi(-10)].into_iter());
        // Measured 0: a third of 2^-10 less what the double holds.
        let gap = ((near - offset) + rest - 2f64.powi(-10) / 3.0).abs();
        assert!(gap <= 1e-19, "{gap}");
    }
}
