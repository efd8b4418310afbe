//! A part of a frame's luma, locally normalized: (I - G)/(G + 4), with G the luma blurred over 1/24 of the nail's
//! width.
//!
//! Blanching and light change the luma slowly over the nail, and change G alike: what is left are edges and texture
//! (`follow::tests`). G is made of block means, blurred: as smooth as it is, nothing
//! is lost between them, and it costs a sixteenth.

use pulp::{Arch, NullaryFnOnce};

use crate::nailvideo::affine::{Affine, moved};
use crate::nailvideo::grid::{Grid, Part, RUN};
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
        let luma = Grid::of_luma(samples, part, step);
        let block = ((sd_px / step as f64 / LEAST_SD_BLOCKS) as usize).clamp(1, luma.size[0].min(luma.size[1]));
        let mut low = luma.reduced(block);
        let sd = sd_px / (step * block) as f64;
        let weights: [f64; TAPS] = std::array::from_fn(|k| (-0.5 * ((k as f64 - 12.0) / sd).powi(2)).exp());
        let sum: f64 = weights.iter().sum();
        let kernel = weights.map(|weight| (weight / sum) as f32);
        low.values = smoothed(low.values.as_chunks::<1>().0, low.size, kernel).into_flattened();
        Self { luma, low }
    }

    /// The locally normalized luma at a point of the frame; NaN outside.
    #[inline]
    pub(super) fn at(&self, x: f32, y: f32) -> f32 {
        let low = self.low.at(x, y);
        (self.luma.at(x, y) - low) / (low + DARK)
    }

    /// [`Self::at`] of each of these points once `motion` has moved them; all lie between these corners.
    pub(super) fn each(&self, motion: &Affine, corners: &[[f32; 2]; 4], [x, y]: [&[f32]; 2], values: &mut Vec<f32>) {
        let motion = motion.0.map(|part| part as f32);
        values.clear();
        let corners = corners.map(|corner| moved(motion, corner));
        if self.luma.holds(&corners) && self.low.holds(&corners) {
            values.resize(x.len(), 0.0);
            Arch::new().dispatch(Each { sight: self, motion, x, y, values });
        } else {
            let places = x.iter().zip(y).map(|(&x, &y)| moved(motion, [x, y]));
            values.extend(places.map(|[x, y]| self.at(x, y)));
        }
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

/// Points that lie within a sight's grids, as many at once as the machine's vectors hold.
struct Each<'a> {
    sight: &'a Sight,
    motion: [f32; 6],
    x: &'a [f32],
    y: &'a [f32],
    values: &'a mut [f32],
}

impl NullaryFnOnce for Each<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { sight, motion, x, y, values } = self;
        let ((xs, x_rest), (ys, y_rest)) = (x.as_chunks(), y.as_chunks());
        let (values, rest) = values.as_chunks_mut();
        for ((values, x), y) in values.iter_mut().zip(xs).zip(ys) {
            *values = many(sight, motion, x, y);
        }
        if let (Some(&x), Some(&y)) = (x_rest.first(), y_rest.first()) {
            // The last ones may be fewer: the first of them is there as often as one is missing.
            let (mut x, mut y) = ([x; RUN], [y; RUN]);
            x[..x_rest.len()].copy_from_slice(x_rest);
            y[..y_rest.len()].copy_from_slice(y_rest);
            rest.copy_from_slice(&many(sight, motion, &x, &y)[..rest.len()]);
        }
    }
}

#[inline(always)]
fn many(sight: &Sight, motion: [f32; 6], x: &[f32; RUN], y: &[f32; RUN]) -> [f32; RUN] {
    let (mut u, mut v) = ([0.0; RUN], [0.0; RUN]);
    for k in 0..RUN {
        [u[k], v[k]] = moved(motion, [x[k], y[k]]);
    }
    let (mut values, low) = (sight.luma.many(&u, &v), sight.low.many(&u, &v));
    for k in 0..RUN {
        values[k] = (values[k] - low[k]) / (low[k] + DARK);
    }
    values
}
