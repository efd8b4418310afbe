//! How much a model explains of the channels at every lag of a common grid, by Fourier transforms.

use std::sync::Arc;

use nalgebra::DMatrix;
use rustfft::num_complex::Complex;
use rustfft::{Fft, FftPlanner};

use super::line::{factor, left};

type Sequence = Vec<Complex<f64>>;

/// A lag at which enough overlaps.
struct Place {
    /// Grid steps that the log's row lies after the video's.
    lag: i64,
    rows: f64,
    factor: DMatrix<f64>,
    /// Means of the regressors over the overlap.
    means: Vec<f64>,
}

/// The video's side, and what does not depend on the channels' values.
pub(super) struct Coarse {
    forward: Arc<dyn Fft<f64>>,
    inverse: Arc<dyn Fft<f64>>,
    length: usize,
    /// Which of the log's grid times have values.
    there: Vec<bool>,
    /// Transforms of where the video has values, and of its regressors.
    video: Vec<Sequence>,
    places: Vec<Place>,
}

/// What is explained at a lag.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Explained {
    pub(super) lag: i64,
    /// Rows in which both have values.
    pub(super) rows: f64,
    /// See [`left`].
    pub(super) left: f64,
}

impl Coarse {
    /// Prepares for lags from `lags[0]` to `lags[1]` with at least `least_rows` rows in which both have values.
    /// Regressors are 0 where there are none.
    pub(super) fn new(
        regressors: &[Vec<f64>],
        video_there: &[bool],
        log_there: &[bool],
        lags: [i64; 2],
        least_rows: f64,
    ) -> Self {
        let length = (log_there.len() + video_there.len()).next_power_of_two();
        let mut planner = FftPlanner::new();
        let mut this = Self {
            forward: planner.plan_fft_forward(length),
            inverse: planner.plan_fft_inverse(length),
            length,
            there: log_there.to_vec(),
            video: Vec::new(),
            places: Vec::new(),
        };
        let mask = |there: &[bool]| there.iter().map(|&there| f64::from(u8::from(there))).collect::<Vec<f64>>();
        let log_mask = this.transform(mask(log_there).into_iter());
        let video_mask = this.transform(mask(video_there).into_iter());
        let rows = this.correlate(&log_mask, &video_mask);
        let of_columns: Vec<Sequence> = regressors.iter().map(|x| this.transform(x.iter().copied())).collect();
        let sums: Vec<Vec<f64>> = of_columns.iter().map(|x| this.correlate(&log_mask, x)).collect();
        this.video.push(video_mask);
        this.video.extend(of_columns);
        let mut products = Vec::new();
        for (i, a) in regressors.iter().enumerate() {
            for b in &regressors[..=i] {
                let product = this.transform(a.iter().zip(b).map(|(a, b)| a * b));
                products.push(this.correlate(&log_mask, &product));
            }
        }
        for lag in lags[0]..=lags[1] {
            let at = this.index(lag);
            let n = rows[at].round();
            if n < least_rows {
                continue;
            }
            let means: Vec<f64> = sums.iter().map(|sums| sums[at] / n).collect();
            let spread = DMatrix::from_fn(regressors.len(), regressors.len(), |i, j| {
                let (i, j) = (i.max(j), i.min(j));
                products[i * (i + 1) / 2 + j][at] / n - means[i] * means[j]
            });
            if let Some(factor) = factor(spread) {
                this.places.push(Place { lag, rows: n, factor, means });
            }
        }
        this
    }

    /// What is explained of `channels` at each lag with enough overlap.
    pub(super) fn explain(&self, channels: &[Vec<f64>]) -> Vec<Explained> {
        let masked: Vec<Vec<f64>> = channels
            .iter()
            .map(|channel| channel.iter().zip(&self.there).map(|(v, there)| if *there { *v } else { 0.0 }).collect())
            .collect();
        let (mut both, mut own) = (Vec::new(), Vec::new());
        for (i, a) in masked.iter().enumerate() {
            let transformed = self.transform(a.iter().copied());
            both.push(self.video.iter().map(|video| self.correlate(&transformed, video)).collect::<Vec<Vec<f64>>>());
            for b in &masked[..=i] {
                let product = self.transform(a.iter().zip(b).map(|(a, b)| a * b));
                own.push(self.correlate(&product, &self.video[0]));
            }
        }
        let explained = |place: &Place| {
            let (at, n) = (self.index(place.lag), place.rows);
            let mean = |k: usize| both[k][0][at] / n;
            let covariances = DMatrix::from_fn(place.means.len(), channels.len(), |i, k| {
                both[k][i + 1][at] / n - mean(k) * place.means[i]
            });
            let spread = DMatrix::from_fn(channels.len(), channels.len(), |i, j| {
                let (i, j) = (i.max(j), i.min(j));
                own[i * (i + 1) / 2 + j][at] / n - mean(i) * mean(j)
            });
            Explained { lag: place.lag, rows: n, left: left(&place.factor, covariances, spread) }
        };
        self.places.iter().map(explained).collect()
    }

    fn index(&self, lag: i64) -> usize {
        lag.rem_euclid(self.length as i64) as usize
    }

    fn transform(&self, values: impl Iterator<Item = f64>) -> Sequence {
        let mut sequence: Sequence = values.map(Complex::from).collect();
        sequence.resize(self.length, Complex::ZERO);
        self.forward.process(&mut sequence);
        sequence
    }

    /// For each lag the sum of the log's values times the video's that lie so many steps before.
    fn correlate(&self, log: &Sequence, video: &Sequence) -> Vec<f64> {
        let mut product: Sequence = log.iter().zip(video).map(|(log, video)| log * video.conj()).collect();
        self.inverse.process(&mut product);
        product.iter().map(|c| c.re / self.length as f64).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::line::Sums;
    use super::*;

    /// Measured: 2e-15.
    const SAME: f64 = 1e-10;

    #[test]
    fn every_lag_is_as_by_plain_sums() {
        let value = |k: usize, i: usize| ((k * (37 + 16 * i) % 101) as f64) / 50.0 - 1.0;
        let log: Vec<Vec<f64>> = (0..2).map(|i| (0..90).map(|k| value(k, i)).collect()).collect();
        let video: Vec<Vec<f64>> = (2..5).map(|i| (0..60).map(|k| value(k, i)).collect()).collect();
        let there = |n: usize, gap: std::ops::Range<usize>| (0..n).map(|k| !gap.contains(&k)).collect::<Vec<bool>>();
        let (log_there, video_there) = (there(90, 20..25), there(60, 40..43));
        let masked: Vec<Vec<f64>> = video
            .iter()
            .map(|c| c.iter().zip(&video_there).map(|(v, t)| if *t { *v } else { 0.0 }).collect())
            .collect();
        let coarse = Coarse::new(&masked, &video_there, &log_there, [-60, 90], 30.0);
        let curve = coarse.explain(&log);
        assert!(curve.len() > 60);
        for at in curve {
            let mut sums = Sums::new(3, 2);
            for k in 0..60i64 {
                let row = k + at.lag;
                if !(0..90).contains(&row) || !video_there[k as usize] || !log_there[row as usize] {
                    continue;
                }
                let of = |columns: &[Vec<f64>], k: i64| columns.iter().map(|c| c[k as usize]).collect::<Vec<f64>>();
                sums.add_row(&of(&video, k), &of(&log, row));
            }
            assert!((sums.left() - at.left).abs() <= SAME, "{at:?} {}", sums.left());
        }
    }
}
