//! Samples of a plane as the shown picture has them, to be read between pixels.

use wide::f32x4;

use crate::video::{Frame, Plane, Turn};
use crate::vision::Samples;

/// Values at the middles of equal blocks of pixels.
#[derive(Debug, Clone)]
pub(in crate::nailvideo) struct Grid {
    pub(in crate::nailvideo) values: Vec<f32>,
    /// Columns and rows.
    pub(in crate::nailvideo) size: [usize; 2],
    /// The middle of the first block, pixels of the shown picture.
    pub(in crate::nailvideo) origin: [f32; 2],
    /// Blocks for a pixel, across and down.
    pub(in crate::nailvideo) per_px: [f32; 2],
}

/// A part of the shown picture: first column and row, columns and rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::nailvideo) struct Part {
    pub(in crate::nailvideo) from: [usize; 2],
    pub(in crate::nailvideo) size: [usize; 2],
}

/// A plane that is turned by so many quarters to be shown.
pub(in crate::nailvideo) fn samples(plane: Plane<'_>, quarters: usize) -> Samples<'_> {
    let Plane { width, height, stride, depth, data } = plane;
    Samples { width, height, stride, depth, data, quarters }
}

/// Width and height of the shown plane.
pub(in crate::nailvideo) fn shown_size(samples: &Samples<'_>) -> [usize; 2] {
    if samples.quarters.is_multiple_of(2) { [samples.width, samples.height] } else { [samples.height, samples.width] }
}

impl Part {
    /// What lies within `reach` pixels of the points, as far as the picture goes; `None` where that is less than some
    /// pixels.
    pub(in crate::nailvideo) fn about(points: &[[f64; 2]], reach: f64, picture: [usize; 2]) -> Option<Self> {
        let (mut from, mut size) = ([0; 2], [0; 2]);
        for axis in 0..2 {
            let low = points.iter().map(|p| p[axis]).fold(f64::INFINITY, f64::min) - reach;
            let high = points.iter().map(|p| p[axis]).fold(f64::NEG_INFINITY, f64::max) + reach;
            let high = (high.ceil() + 1.0).min(picture[axis] as f64);
            let low = low.floor().max(0.0);
            let is_wide = high - low >= 8.0;
            if !is_wide {
                return None;
            }
            from[axis] = low as usize;
            size[axis] = high as usize - from[axis];
        }
        Some(Self { from, size })
    }
}

impl Grid {
    /// Means over blocks of `step` pixels of a part of the luma.
    pub(in crate::nailvideo) fn of_luma(samples: &Samples<'_>, part: Part, step: usize) -> Self {
        let size = part.size.map(|length| (length / step).max(1));
        let middle = 0.5 * (step as f32 - 1.0);
        let values = samples.means(part.from, size, step);
        Self { values, size, origin: part.from.map(|at| at as f32 + middle), per_px: [1.0 / step as f32; 2] }
    }

    /// Cb and Cr about a part of the picture; `site` is where samples lie in the blocks of pixels that they are for, as
    /// they are stored.
    pub(in crate::nailvideo) fn of_chroma(
        frame: &Frame<'_>,
        turn: Turn,
        site: (f64, f64),
        part: Part,
    ) -> Option<[Self; 2]> {
        let quarters = turn.quarters();
        let (across, down) = frame.subsampling();
        let block = if quarters.is_multiple_of(2) { [across, down] } else { [down, across] };
        let site = turn.shown_from_stored([site.0, site.1], (across, down));
        let grid = |plane: Plane<'_>| {
            let samples = samples(plane, quarters);
            let whole = shown_size(&samples);
            let from: [usize; 2] = std::array::from_fn(|k| (part.from[k] / block[k]).min(whole[k] - 1));
            let size: [usize; 2] =
                std::array::from_fn(|k| part.size[k].div_ceil(block[k]).max(1).min(whole[k] - from[k]));
            let origin = std::array::from_fn(|k| (from[k] * block[k]) as f32 + site[k] as f32);
            Self { values: samples.means(from, size, 1), size, origin, per_px: block.map(|n| 1.0 / n as f32) }
        };
        frame.chroma.map(|planes| planes.map(grid))
    }

    /// Values times a weight each, of two grids of the same places.
    pub(in crate::nailvideo) fn combined(&self, [own, others]: [f32; 2], other: &Self) -> Self {
        let values = self.values.iter().zip(&other.values).map(|(one, two)| own * one + others * two).collect();
        Self { values, ..self.clone() }
    }

    /// The value at a point of the picture, bilinear; beyond the outermost middles by up to a block theirs, NaN farther
    /// out.
    #[inline]
    pub(in crate::nailvideo) fn at(&self, x: f32, y: f32) -> f32 {
        let [columns, rows] = self.size;
        let (u, v) = ((x - self.origin[0]) * self.per_px[0], (y - self.origin[1]) * self.per_px[1]);
        let (right, bottom) = ((columns - 1) as f32, (rows - 1) as f32);
        if !(u >= -1.0 && v >= -1.0 && u <= right + 1.0 && v <= bottom + 1.0) {
            return f32::NAN;
        }
        let (u, v) = (u.clamp(0.0, right), v.clamp(0.0, bottom));
        let (left, top) = ((u as usize).min(columns.saturating_sub(2)), (v as usize).min(rows.saturating_sub(2)));
        let (p, q) = (u - left as f32, v - top as f32);
        let at = top * columns + left;
        let (across, down) = (usize::from(columns > 1), if rows > 1 { columns } else { 0 });
        let above = self.values[at] + p * (self.values[at + across] - self.values[at]);
        let below = self.values[at + down] + p * (self.values[at + down + across] - self.values[at + down]);
        above + q * (below - above)
    }

    /// Whether [`Self::four`] may be asked for all points between these corners.
    pub(in crate::nailvideo) fn holds(&self, corners: &[[f32; 2]; 4]) -> bool {
        corners.iter().all(|at| {
            [0, 1].into_iter().all(|axis| {
                let block = (at[axis] - self.origin[axis]) * self.per_px[axis];
                // Rounding moves a point within by less than that.
                let last = self.size[axis] as f32 - 1.0;
                block >= 0.01 && block <= last - 0.01
            })
        })
    }

    /// [`Self::at`] of four points that lie within the middles of the outermost blocks.
    #[inline]
    pub(in crate::nailvideo) fn four(&self, x: f32x4, y: f32x4) -> f32x4 {
        let [across, down] = self.per_px.map(f32x4::splat);
        let (u, v) = ((x - f32x4::splat(self.origin[0])) * across, (y - f32x4::splat(self.origin[1])) * down);
        let (left, top) = (u.fast_trunc_int(), v.fast_trunc_int());
        let (p, q) = (u - f32x4::from_i32x4(left), v - f32x4::from_i32x4(top));
        let (left, top) = (left.to_array(), top.to_array());
        let columns = self.size[0];
        let mut corners = [[0.0; 4]; 4];
        for k in 0..4 {
            let at = top[k] as usize * columns + left[k] as usize;
            let [above, below] = [&self.values[at..at + 2], &self.values[at + columns..at + columns + 2]];
            [corners[0][k], corners[1][k]] = [above[0], above[1]];
            [corners[2][k], corners[3][k]] = [below[0], below[1]];
        }
        let [above, above_right, below, below_right] = corners.map(f32x4::new);
        let above = above + p * (above_right - above);
        let below = below + p * (below_right - below);
        above + q * (below - above)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::video::{Format, Picture};

    #[test]
    fn planes_are_read_where_the_turn_shows_them() {
        let format = Format { width: 16, height: 12, subsampling: Some((2, 2)), depth: 8 };
        let mut picture = Picture::new(format);
        picture.planes[0].iter_mut().enumerate().for_each(|(k, v)| *v = (3 * (k % 16) + 9 * (k / 16)) as u8);
        picture.planes[1].iter_mut().enumerate().for_each(|(k, v)| *v = (6 * (k % 8) + 18 * (k / 8)) as u8);
        let frame = picture.frame(0, 0.0);
        let sites = [(0.5, 0.5), (0.0, 0.5)];
        for (turn, site) in [Turn::None, Turn::Quarter].into_iter().flat_map(|turn| sites.map(|site| (turn, site))) {
            let luma = samples(frame.luma, turn.quarters());
            let part = Part { from: [0; 2], size: shown_size(&luma) };
            let (grid, chroma) = (Grid::of_luma(&luma, part, 1), Grid::of_chroma(&frame, turn, site, part).unwrap());
            for stored in [[5.25, 6.5], [8.0, 3.0]] {
                let [x, y] = turn.shown_from_stored(stored, (16, 12)).map(|v| v as f32);
                let expected = (3.0 * stored[0] + 9.0 * stored[1]) as f32;
                assert!((grid.at(x, y) - expected).abs() <= 1e-3, "{turn:?} {stored:?}: {}", grid.at(x, y));
                let expected = (3.0 * (stored[0] - site.0) + 9.0 * (stored[1] - site.1)) as f32;
                assert!((chroma[0].at(x, y) - expected).abs() <= 1e-3, "{turn:?} {site:?} {stored:?}");
            }
            let four = grid.four(f32x4::new([2.0, 3.25, 5.5, 9.75]), f32x4::new([1.5, 8.0, 2.25, 6.0]));
            let each = [[2.0, 1.5], [3.25, 8.0], [5.5, 2.25], [9.75, 6.0]].map(|[x, y]| grid.at(x, y));
            assert_eq!(four.to_array(), each);
            assert!(grid.holds(&[[2.0, 2.0]; 4]) && !grid.holds(&[[2.0, 2.0], [2.0, 40.0], [2.0; 2], [2.0; 2]]));
            assert!(grid.at(-1.5, 3.0).is_nan() && grid.at(3.0, 40.0).is_nan());
        }
        assert_eq!(Part::about(&[[-50.0, 3.0]], 10.0, [16, 12]), None);
    }
}
