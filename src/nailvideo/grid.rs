//! Samples of a plane as the shown picture has them, to be read between pixels.

use crate::video::{Frame, Plane, Turn};
use crate::vision::{Samples, reduced};

/// Numbers in the vectors of most machines.
pub(in crate::nailvideo) const LANES: usize = 8;
/// Points that are looked up at once: first where they all lie, then what is there, so that all but the look-up itself
/// is done by vectors.
pub(in crate::nailvideo) const RUN: usize = 64;

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
    /// All of the shown picture.
    pub(in crate::nailvideo) fn whole(samples: &Samples<'_>) -> Self {
        Self { from: [0; 2], size: shown_size(samples) }
    }

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

    /// Means over blocks of `block` x `block` values.
    pub(in crate::nailvideo) fn reduced(&self, block: usize) -> Self {
        let (values, size) = reduced(self.values.as_chunks::<1>().0, self.size, block);
        let to_middle = |axis: usize| 0.5 * (block as f32 - 1.0) / self.per_px[axis];
        let origin = std::array::from_fn(|axis| self.origin[axis] + to_middle(axis));
        let per_px = self.per_px.map(|blocks| blocks / block as f32);
        Self { values: values.into_flattened(), size, origin, per_px }
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

    /// Whether [`Self::many`] may be asked for all points between these corners.
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

    /// [`Self::at`] of points that lie within the middles of the outermost blocks; compiled for the vectors that its
    /// caller is compiled for.
    #[inline(always)]
    pub(in crate::nailvideo) fn many<const N: usize>(&self, x: &[f32; N], y: &[f32; N]) -> [f32; N] {
        let columns = self.size[0];
        let (mut p, mut q) = ([0.0; N], [0.0; N]);
        let mut first = [0_u32; N];
        for k in 0..N {
            let (u, v) = ((x[k] - self.origin[0]) * self.per_px[0], (y[k] - self.origin[1]) * self.per_px[1]);
            let ((left, over_left), (top, over_top)) = (whole_and_part(u), whole_and_part(v));
            first[k] = top.wrapping_mul(columns as u32).wrapping_add(left);
            (p[k], q[k]) = (over_left, over_top);
        }
        let (mut above, mut below) = ([[0.0; 2]; N], [[0.0; 2]; N]);
        for k in 0..N {
            let block = &self.values[first[k] as usize..][..columns + 2];
            above[k] = [block[0], block[1]];
            below[k] = [block[columns], block[columns + 1]];
        }
        let mut values = [0.0; N];
        for k in 0..N {
            let above = above[k][0] + p[k] * (above[k][1] - above[k][0]);
            let below = below[k][0] + p[k] * (below[k][1] - below[k][0]);
            values[k] = above + q[k] * (below - above);
        }
        values
    }
}

/// A place from 0 to 2^22 as whole blocks and the rest, 0 to 1: by additions, as the compiler makes no vectors of
/// conversions that saturate.
#[inline(always)]
fn whole_and_part(at: f32) -> (u32, f32) {
    /// About it numbers are whole.
    const WHOLE: f32 = (3 << 22) as f32;
    let above = at - 0.5 + WHOLE;
    (above.to_bits() & 0x3f_ffff, at - (above - WHOLE))
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
            let part = Part::whole(&luma);
            let (grid, chroma) = (Grid::of_luma(&luma, part, 1), Grid::of_chroma(&frame, turn, site, part).unwrap());
            for stored in [[5.25, 6.5], [8.0, 3.0]] {
                let [x, y] = turn.shown_from_stored(stored, (16, 12)).map(|v| v as f32);
                let expected = (3.0 * stored[0] + 9.0 * stored[1]) as f32;
                assert!((grid.at(x, y) - expected).abs() <= 1e-3, "{turn:?} {stored:?}: {}", grid.at(x, y));
                let expected = (3.0 * (stored[0] - site.0) + 9.0 * (stored[1] - site.1)) as f32;
                assert!((chroma[0].at(x, y) - expected).abs() <= 1e-3, "{turn:?} {site:?} {stored:?}");
            }
            let (x, y) = ([2.0, 3.25, 5.5, 9.75, 0.01, 14.99, 7.0, 6.2], [1.5, 8.0, 2.25, 6.0, 0.01, 10.99, 7.0, 0.1]);
            let (mut x, mut y): ([f32; LANES], [f32; LANES]) = (x, y);
            if turn == Turn::Quarter {
                (x, y) = (y, x);
            }
            assert_eq!(grid.many(&x, &y), std::array::from_fn(|k| grid.at(x[k], y[k])));
            assert!(grid.holds(&[[2.0, 2.0]; 4]) && !grid.holds(&[[2.0, 2.0], [2.0, 40.0], [2.0; 2], [2.0; 2]]));
            assert!(grid.at(-1.5, 3.0).is_nan() && grid.at(3.0, 40.0).is_nan());
        }
        assert_eq!(Part::about(&[[-50.0, 3.0]], 10.0, [16, 12]), None);
    }
}
