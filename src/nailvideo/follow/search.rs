//! Where the nail may be after it was lost, or be rather than where it was fitted: its locally normalized luma, reduced
//! to some 24 pixels across, turned and scaled, is looked for over the whole picture, or about a place. What is found
//! is a start for the fit, no more.

use super::sight::Sight;
use crate::nailvideo::affine::Affine;
use crate::nailvideo::grid::{Part, shown_size};
use crate::vision::{Samples, matched};

/// The nail's width in blocks (assumed: an eighth of a nail of 190 px).
const WIDTH_BLOCKS: f64 = 24.0;
/// Turns and scales that are tried, from the last that are known (section 2.4 of the design: assumed).
const TURNS_DEG: [f64; 5] = [0.0, -7.5, 7.5, -15.0, 15.0];
const SCALES: [f64; 3] = [1.0, 0.87, 1.15];
/// Places handed on, and the correlation below which none is (assumed: a fit judges them).
const MOST_PLACES: usize = 3;
const LEAST_FIT: f32 = 0.35;

/// Where a picture has more blocks, the whole of it is not looked at in every frame, but in one of so many at least
/// (measured: 1.2 million blocks, a nail of 26 px in 960 x 1280, take 0.6 s of one core).
const MOST_BLOCKS: usize = 150_000;
const RAREST: usize = 8;

/// How far about a place is looked, of [`Search::reach`] (assumed: a quarter of the nail's width).
const NEAR: f64 = 0.5;

/// What is looked for.
#[derive(Debug)]
pub(super) struct Search {
    template: Sight,
    middle: [f64; 2],
    /// Half of the square that is compared, pixels.
    reach: f64,
    step: usize,
    blur_px: f64,
}

impl Search {
    /// For the nail of a frame; `extent_px` are its width and length.
    pub(super) fn new(samples: &Samples<'_>, middle: [f64; 2], extent_px: [f64; 2], blur_px: f64) -> Self {
        let step = ((extent_px[0] / WIDTH_BLOCKS) as usize).max(1);
        let template = Sight::new(samples, Part::whole(samples), step, blur_px);
        Self { template, middle, reach: 0.55 * extent_px[0].min(extent_px[1]), step, blur_px }
    }

    /// In which of the frames without the nail the whole picture is looked at: one of so many.
    pub(super) fn every(&self, samples: &Samples<'_>) -> usize {
        let [width, height] = shown_size(samples).map(|size| size / self.step);
        (width * height).div_ceil(MOST_BLOCKS).clamp(1, RAREST)
    }

    /// Motions that may be the nail's in a frame, the likeliest first; `last` is the last that was known.
    pub(super) fn places(&self, samples: &Samples<'_>, last: &Affine) -> Vec<Affine> {
        let seen = Sight::new(samples, Part::whole(samples), self.step, self.blur_px);
        let cells = seen.all();
        let ways = TURNS_DEG.iter().flat_map(|turn| SCALES.map(|scale| (turn.to_radians(), scale)));
        let mut found: Vec<(f32, Affine)> = ways.filter_map(|way| self.best(&seen, &cells, last, way)).collect();
        found.sort_by(|a, b| b.0.total_cmp(&a.0));
        found.into_iter().take(MOST_PLACES).map(|(_, motion)| motion).collect()
    }

    /// Where about a place the nail fits best, turned and scaled as there.
    pub(super) fn about(&self, samples: &Samples<'_>, place: &Affine) -> Option<Affine> {
        let reach = (1.0 + NEAR) * self.reach + 2.0 * self.step as f64;
        let part = Part::about(&[place.of(self.middle)], reach, shown_size(samples))?;
        let seen = Sight::new(samples, part, self.step, self.blur_px);
        self.best(&seen, &seen.all(), place, (0.0, 1.0)).map(|(_, motion)| motion)
    }

    /// How well the nail fits where it fits best, turned and scaled by so much from `last`, and where that is.
    fn best(
        &self,
        seen: &Sight,
        (cells, size): &(Vec<f32>, [usize; 2]),
        last: &Affine,
        (turn_rad, by): (f64, f64),
    ) -> Option<(f32, Affine)> {
        let (turn, scale) = (last.0[3].atan2(last.0[0]), last.determinant().abs().sqrt());
        let way = Affine::similarity(self.middle, [0.0; 2], turn + turn_rad, scale * by);
        let back = way.inverse()?;
        // Blocks from the middle to each side.
        let side = (self.reach * scale * by / self.step as f64).floor() as usize;
        let across = 2 * side + 1;
        let from_middle = |k: usize| (k as f64 - side as f64) * self.step as f64;
        let patch = (0..across * across).map(|k| {
            let [x, y] = back.of([from_middle(k % across), from_middle(k / across)]);
            Some(self.template.at(x as f32, y as f32)).filter(|v| v.is_finite()).unwrap_or(0.0)
        });
        let patch: Vec<f32> = patch.collect();
        let fits = matched(cells, *size, &patch, [across; 2]);
        let columns = (size[0] + 1).saturating_sub(across);
        let best = (0..fits.len()).max_by(|&a, &b| fits[a].total_cmp(&fits[b]));
        let best = best.filter(|&best| fits[best] >= LEAST_FIT)?;
        // Between blocks by a parabola, where both neighbours are there.
        let peak = |at: usize, count: usize, step: usize| {
            if at == 0 || at + 1 >= count {
                return at as f64;
            }
            let [low, middle, high] = [best - step, best, best + step].map(|k| f64::from(fits[k]));
            let by = 0.5 * (low - high) / (low - 2.0 * middle + high);
            at as f64 + if by.is_finite() { by } else { 0.0 }
        };
        let corner = [peak(best % columns, columns, 1), peak(best / columns, fits.len() / columns, columns)];
        let [x, y] = seen.middle(corner.map(|at| at + side as f64));
        let mut motion = way.0;
        (motion[2], motion[5]) = (motion[2] + x, motion[5] + y);
        Some((fits[best], Affine(motion)))
    }
}
