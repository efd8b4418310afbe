//! How many independent samples there are: both sides remember, and only what both remember counts.
//!
//! M. S. Bartlett 1935, doi:10.2307/2980235: of two independent series the correlation varies as that of
//! `rows / sum(r_x r_y)` independent rows, r the correlation of each with itself over lags.

use rustfft::FftPlanner;
use rustfft::num_complex::Complex;

/// Lags up to this share of the rows are looked at.
const LONGEST: f64 = 0.25;

/// Correlation of columns with themselves at lags of 0, 1, .. rows, the mean over columns by `weights`.
pub(super) fn own(columns: &[Vec<f64>], weights: &[f64]) -> Vec<f64> {
    let rows = columns.first().map_or(0, Vec::len);
    let length = (2 * rows).next_power_of_two();
    let mut planner = FftPlanner::new();
    let (forward, inverse) = (planner.plan_fft_forward(length), planner.plan_fft_inverse(length));
    let lags = ((LONGEST * rows as f64) as usize).max(1);
    let mut mean = vec![0.0; lags];
    for (column, weight) in columns.iter().zip(weights) {
        let mut sequence: Vec<Complex<f64>> = column.iter().copied().map(Complex::from).collect();
        sequence.resize(length, Complex::ZERO);
        forward.process(&mut sequence);
        sequence.iter_mut().for_each(|c| *c = Complex::from(c.norm_sqr()));
        inverse.process(&mut sequence);
        let whole = sequence[0].re.max(f64::MIN_POSITIVE);
        for (lag, mean) in mean.iter_mut().enumerate() {
            *mean += weight * sequence[lag].re / whole;
        }
    }
    mean
}

/// Rows that count as one.
pub(super) fn rows_each(x: &[f64], y: &[f64]) -> f64 {
    let later: f64 = x.iter().zip(y).skip(1).map(|(x, y)| x * y).sum();
    (1.0 + 2.0 * later).max(1.0)
}

/// What is known of a model before any lag.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Judge {
    /// Seconds that count as one independent sample.
    pub(super) each_s: f64,
    /// Its free numbers, without the mean.
    pub(super) free: f64,
}

impl Judge {
    /// Independent samples that are left for an error, of an overlap.
    pub(super) fn samples(&self, overlap_s: f64) -> f64 {
        (overlap_s / self.each_s - 1.0 - self.free).max(0.0)
    }

    /// Twice how much an explanation raises the logarithm of the likelihood, less its free numbers; `left` is the
    /// logarithm of the share that it leaves over.
    pub(super) fn gain(&self, overlap_s: f64, left: f64) -> f64 {
        -self.samples(overlap_s) * left - self.free
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_remembers_counts_less() {
        let mut state = 1u64;
        let mut noise = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f64 / f64::from(1 << 24) - 0.5
        };
        let white: Vec<f64> = (0..4000).map(|_| noise()).collect();
        let slow: Vec<f64> = white.windows(20).map(|w| w.iter().sum()).collect();
        let (white, slow) = (own(&[white], &[1.0]), own(&[slow], &[1.0]));
        assert!(rows_each(&white, &slow) < 2.0);
        // A mean over m rows remembers as sum((1 - k/m)^2) = about 2 m / 3.
        assert!((10.0..18.0).contains(&rows_each(&slow, &slow)), "{}", rows_each(&slow, &slow));
    }

    #[test]
    fn free_numbers_cost_and_few_samples_prove_nothing() {
        let judge = Judge { each_s: 2.0, free: 5.0 };
        assert_eq!((judge.samples(60.0), judge.samples(8.0)), (24.0, 0.0));
        assert!(judge.gain(60.0, -3.0) > 60.0 && judge.gain(8.0, -9.0) < 0.0 && judge.gain(60.0, -0.1) < 0.0);
    }
}
