//! A part of a frame's luma, locally normalized: (I - G)/(G + 4), with G the luma blurred over 1/24 of the nail's
//! width.
//!
//! Blanching and light change the luma slowly over the nail, and change G alike: what is left are edges and texture
//! (`follow::tests`). G is made of block means, blurred: as smooth as it is, nothing
//! is lost between them, and it costs a sixteenth.

use wide::f32x4;

use crate::nailvideo::grid::{Grid, Part};
use crate::vision::{Samples, smoothed};

/// Blur, of the nail's width, and at least (measured on the phantom: 1/16 is pulled 0.18 px along a pressed nail of 190
/// px, 1/24 by 0.05; below 2.5 px a nail of 40 px is lost at times).
const BLUR_WIDTHS: f64 = 1.0 / 24.0;
const LEAST_BLUR_PX: f64 = 2.5;
/// Added to the blurred luma, of 255: noise in the dark is not made larger than what is seen (assumed).
const DARK: f32 = 4.0;
/// Taps of the blur on block means; a block is so large that its SD is 2.5 to 5 blocks.
const TAPS: usize = 25;
const LEAST_SD_BLOCKS: f64 = 2.5;

/// The blur for a nail of some width, pixels.
pub(super) fn blur_px(width_px: f64) -> f64 {
    (BLUR_WIDTHS * width_px).max(LEAST_BLUR_PX)
}

/// Luma of a part of a frame.
#[derive(Debug)]
pub(super) struct Sight {
    luma: Grid,
    low: Grid,
}

impl Sight {
    /// Of a part of a frame in blocks of `step` pixels, blurred over `sd_px` pixels for what is taken off.
    pub(super) fn new(samples: &Samples<'_>, part: Part, step: usize, sd_px: f64) -> Self {
        let low_step = step * ((sd_px / step as f64 / LEAST_SD_BLOCKS) as usize).max(1);
        let mut low = Grid::of_luma(samples, part, low_step);
        let sd = sd_px / low_step as f64;
        let weights: [f64; TAPS] = std::array::from_fn(|k| (-0.5 * ((k as f64 - 12.0) / sd).powi(2)).exp());
        let sum: f64 = weights.iter().sum();
        let kernel = weights.map(|weight| (weight / sum) as f32);
        low.values = smoothed(low.values.as_chunks::<1>().0, low.size, kernel).into_iter().flatten().collect();
        Self { luma: Grid::of_luma(samples, part, step), low }
    }

    /// The locally normalized luma at a point of the frame; NaN outside.
    #[inline]
    pub(super) fn at(&self, x: f32, y: f32) -> f32 {
        let low = self.low.at(x, y);
        (self.luma.at(x, y) - low) / (low + DARK)
    }

    /// [`Self::at`] of each of these points, which lie between these corners: four at once where none is outside.
    pub(super) fn each(
        &self,
        corners: &[[f32; 2]; 4],
        mut places: impl Iterator<Item = [f32; 2]>,
        values: &mut Vec<f32>,
    ) {
        values.clear();
        if !self.holds(corners) {
            values.extend(places.map(|[x, y]| self.at(x, y)));
            return;
        }
        let mut count = 0;
        while let Some(first) = places.next() {
            count += 1;
            // The last four may be fewer: the others are there twice.
            let four: [[f32; 2]; 4] = std::array::from_fn(|k| {
                let next = if k == 0 { None } else { places.next() };
                count += usize::from(next.is_some());
                next.unwrap_or(first)
            });
            let [x, y] = [0, 1].map(|axis| f32x4::new(four.map(|at| at[axis])));
            values.extend(self.four(x, y).to_array());
        }
        values.truncate(count);
    }

    /// Whether [`Self::four`] may be asked for all points between these corners.
    fn holds(&self, corners: &[[f32; 2]; 4]) -> bool {
        self.luma.holds(corners) && self.low.holds(corners)
    }

    /// [`Self::at`] of four points of which [`Self::holds`] is true.
    #[inline]
    fn four(&self, x: f32x4, y: f32x4) -> f32x4 {
        let low = self.low.four(x, y);
        (self.luma.four(x, y) - low) / (low + f32x4::splat(DARK))
    }

    /// The same at every block, row by row, with columns and rows.
    pub(super) fn all(&self) -> (Vec<f32>, [usize; 2]) {
        let Grid { size, origin, per_px, .. } = &self.luma;
        let at = |k: usize, axis: usize| k as f32 / per_px[axis] + origin[axis];
        let values = (0..size[0] * size[1]).map(|k| self.at(at(k % size[0], 0), at(k / size[0], 1)));
        (values.map(|v| if v.is_finite() { v } else { 0.0 }).collect(), *size)
    }

    /// The frame's pixel at the middle of a block.
    pub(super) fn middle(&self, [column, row]: [f64; 2]) -> [f64; 2] {
        let Grid { origin, per_px, .. } = &self.luma;
        let at = |block: f64, axis: usize| block / f64::from(per_px[axis]) + f64::from(origin[axis]);
        [at(column, 0), at(row, 1)]
    }
}
