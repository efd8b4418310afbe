//! Slow drift taken off: a broken line over time, fitted by least squares.

use nalgebra::{DMatrix, DVector};

/// The line breaks every so many seconds; what is slower is drift.
const SLOW_S: f64 = 30.0;
/// Share of the greatest square by which each is raised: a piece without rows stays 0.
const RIDGE: f64 = 1e-9;

/// A broken line over given times.
pub(super) struct Drift {
    /// For each row the knot before it and how far on the way to the next it is.
    places: Vec<(usize, f64)>,
    factor: DMatrix<f64>,
}

impl Drift {
    /// For rows at ascending `time_s`.
    pub(super) fn new(time_s: &[f64]) -> Self {
        let (first_s, last_s) = (time_s.first().copied().unwrap_or(0.0), time_s.last().copied().unwrap_or(0.0));
        let pieces = ((last_s - first_s) / SLOW_S).round().max(1.0);
        let width_s = ((last_s - first_s) / pieces).max(f64::MIN_POSITIVE);
        let place = |t: &f64| {
            let at = (t - first_s) / width_s;
            let knot = at.floor().clamp(0.0, pieces - 1.0);
            (knot as usize, at - knot)
        };
        let places: Vec<(usize, f64)> = time_s.iter().map(place).collect();
        let knots = pieces as usize + 1;
        let mut squares = DMatrix::<f64>::zeros(knots, knots);
        for &(k, x) in &places {
            squares[(k, k)] += (1.0 - x) * (1.0 - x);
            squares[(k + 1, k)] += x * (1.0 - x);
            squares[(k + 1, k + 1)] += x * x;
        }
        let most = squares.diagonal().max().max(f64::MIN_POSITIVE);
        for k in 0..knots {
            squares[(k, k)] += RIDGE * most;
            if k + 1 < knots {
                squares[(k, k + 1)] = squares[(k + 1, k)];
            }
        }
        let factor = squares.cholesky().map_or_else(|| DMatrix::identity(knots, knots), |c| c.unpack());
        Self { places, factor }
    }

    /// Takes it off a column with a value in each row.
    pub(super) fn take_off(&self, column: &mut [f64]) {
        let mut line = DVector::zeros(self.factor.nrows());
        for (&(k, x), v) in self.places.iter().zip(column.iter()) {
            line[k] += (1.0 - x) * v;
            line[k + 1] += x * v;
        }
        if !(self.factor.solve_lower_triangular_mut(&mut line) && self.factor.tr_solve_lower_triangular_mut(&mut line))
        {
            return;
        }
        for (&(k, x), v) in self.places.iter().zip(column.iter_mut()) {
            *v -= (1.0 - x) * line[k] + x * line[k + 1];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What the ridge leaves; measured: 3e-8 of the size.
    const LEFT: f64 = 1e-5;

    #[test]
    fn a_broken_line_goes_and_what_is_quick_stays() {
        // 90 s, so knots at 30 s and 60 s; nothing is there for a while.
        let time_s: Vec<f64> = (0..900).map(|k| f64::from(k) * 0.1).filter(|t| !(62.0..75.0).contains(t)).collect();
        let drift = Drift::new(&time_s);
        let end = time_s[time_s.len() - 1] / 3.0;
        let mut slow: Vec<f64> = time_s.iter().map(|t| 5.0 + 0.1 * t + 0.7 * (t - end).max(0.0)).collect();
        drift.take_off(&mut slow);
        assert!(slow.iter().all(|v| v.abs() < LEFT), "{slow:?}");
        let quick: Vec<f64> = time_s.iter().map(|t| (3.0 * t).sin()).collect();
        let mut left = quick.clone();
        drift.take_off(&mut left);
        let (gone, all) = quick.iter().zip(&left).fold((0.0, 0.0), |(g, a), (q, l)| (g + (q - l).powi(2), a + q * q));
        assert!(gone < 0.01 * all, "{gone} {all}");
        let mut one = [3.0];
        Drift::new(&[7.0]).take_off(&mut one);
        assert!(one[0].abs() < LEFT);
    }
}
