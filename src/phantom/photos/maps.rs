//! The exact mean and standard deviation of normalized pictures, one after the other, in double precision.
//!
//! In: normalized pictures, NaN where not photographed. Out: mean, SD with n - 1 (NaN under two), and how many. Source:
//! B. P. Welford (1962), doi:10.1080/00401706.1962.10490022.

use ndarray::{Array2, Zip};

/// What has been seen of one pose.
#[derive(Debug, Clone)]
pub(super) struct ExactMaps {
    /// How many were seen.
    pub(super) count: Array2<u32>,
    mean: Array2<f64>,
    squares: Array2<f64>,
}

impl ExactMaps {
    /// Nothing seen yet, `size` x `size`.
    pub(super) fn new(size: usize) -> Self {
        let shape = (size, size);
        Self { count: Array2::zeros(shape), mean: Array2::zeros(shape), squares: Array2::zeros(shape) }
    }

    pub(super) fn add(&mut self, picture: &Array2<f32>) {
        Zip::from(&mut self.count).and(&mut self.mean).and(&mut self.squares).and(picture).for_each(
            |count, mean, squares, &value| {
                if !value.is_nan() {
                    let value = f64::from(value);
                    *count += 1;
                    let from_old = value - *mean;
                    *mean += from_old / f64::from(*count);
                    *squares += from_old * (value - *mean);
                }
            },
        );
    }

    /// Mean; NaN where nothing was seen.
    pub(super) fn mean(&self) -> Array2<f32> {
        Zip::from(&self.count).and(&self.mean).map_collect(|&n, &mean| if n == 0 { f32::NAN } else { mean as f32 })
    }

    /// Standard deviation with n - 1; NaN where fewer than two were seen.
    pub(super) fn sd(&self) -> Array2<f32> {
        Zip::from(&self.count)
            .and(&self.squares)
            .map_collect(|&n, &squares| if n < 2 { f32::NAN } else { (squares / f64::from(n - 1)).sqrt() as f32 })
    }
}
