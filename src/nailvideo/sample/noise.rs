//! How noisy the mean over a disc is, from how discs all over the nail change through a video.
//!
//! An encoder's errors last over frames, so that differences from frame to frame do not show them. But blood, light and
//! the nail's motion change all discs together, in few ways; noise changes each by itself. So the covariance of the
//! discs' values has some large eigenvalues, each far above the next, and a slowly falling rest: the noise's.
//!
//! In: the values of all discs in some frames. Out: their noise's SD. Not determined: errors that last over the whole
//! video, and noise that all discs share.

use nalgebra::{DMatrix, DVector};

/// Fewer frames determine nothing (assumed).
const FEWEST: f64 = 20.0;
/// The first eigenvalue whose square root is not so far above the next one's is noise (measured on the phantom: those
/// of noise fall by 1.0 to 1.3 from one to the next, at times by 1.7; those of random forces, 9 of them, by 1.4 to 2).
const DROP: f64 = 1.3;

/// Sums over frames.
#[derive(Debug)]
pub(super) struct Noise {
    frames: f64,
    mean: DVector<f64>,
    /// Of squares and products about the mean (Welford 1962, doi:10.1080/00401706.1962.10490022).
    sums: DMatrix<f64>,
}

impl Noise {
    pub(super) fn new(discs: usize) -> Self {
        Self { frames: 0.0, mean: DVector::zeros(discs), sums: DMatrix::zeros(discs, discs) }
    }

    /// Adds a frame in which all discs have a value.
    pub(super) fn add(&mut self, values: &[f64]) {
        self.frames += 1.0;
        let before = DVector::from_column_slice(values) - &self.mean;
        self.mean += &before / self.frames;
        self.sums.ger(1.0 - 1.0 / self.frames, &before, &before, 1.0);
    }

    /// SD of a disc's noise; `None` of too few frames.
    pub(super) fn sd(&self) -> Option<f64> {
        if self.frames < FEWEST {
            return None;
        }
        let covariance = &self.sums / (self.frames - 1.0);
        let mut values: Vec<f64> = covariance.symmetric_eigenvalues().iter().map(|value| value.max(0.0)).collect();
        values.sort_by(|a, b| b.total_cmp(a));
        let common = values.windows(2).position(|pair| pair[0] <= DROP * DROP * pair[1])?;
        // Noise has a part in what is common as well: as large as the largest of its own.
        let own: f64 = values[common..].iter().sum::<f64>() + common as f64 * values[common];
        Some((own / values.len() as f64).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trial::normals;

    /// Of an SD of 1; measured 0.996 to 1.029 (0.996 without, 1.011 to 1.029 with common waves).
    const LARGEST_ERROR: f64 = 0.05;

    /// The SD of noise 1, correlated over frames by `rho`, in discs that `common` waves move together.
    fn sd(common: usize, rho: f64, frames: usize) -> Option<f64> {
        const DISCS: usize = 60;
        let mut normal = normals(7);
        let ways: Vec<Vec<f64>> = (0..common).map(|_| (0..DISCS).map(|_| normal()).collect()).collect();
        let mut noise = Noise::new(DISCS);
        let mut carried: Vec<f64> = (0..DISCS).map(|_| normal()).collect();
        for frame in 0..frames {
            carried.iter_mut().for_each(|one| *one = rho * *one + (1.0 - rho * rho).sqrt() * normal());
            let way = |k: usize| 40.0 * 0.5_f64.powi(k as i32) * (0.031 * (k + 1) as f64 * frame as f64).sin();
            let value = |disc: usize| carried[disc] + (0..common).map(|k| way(k) * ways[k][disc]).sum::<f64>();
            noise.add(&(0..DISCS).map(value).collect::<Vec<_>>());
        }
        noise.sd()
    }

    #[test]
    fn noise_that_lasts_is_seen_below_what_is_common() {
        for (common, rho) in [(0, 0.0), (3, 0.0), (3, 0.8), (5, 0.8)] {
            let sd = sd(common, rho, 400).expect("known");
            println!("{common} {rho}: {sd}");
            assert!((sd - 1.0).abs() <= LARGEST_ERROR, "{common} {rho}: {sd}");
        }
        assert_eq!(sd(1, 0.0, 10), None);
    }
}
