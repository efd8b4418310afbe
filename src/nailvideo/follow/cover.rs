//! Whether something lies over the nail, by its rim: cells of the nail's box in which many pixels do not fit.
//!
//! The limits were measured on the phantom (`lunula phantom nailvideo --finger`, `--rod`): of 817 frames in which a
//! photodiode is covered all have 15 and more clear cells, of 1046 with nothing over the nail, moved, pressed, small
//! and coarsely encoded, none has more than 12.

use super::sight::Sight;
use super::template::{CELLS, TUKEY_SDS, Template, cell_middle, sd_of};
use crate::nailvideo::affine::Affine;
use crate::vision::{Neighbours, opened, parts};

/// A cell is the rim's where more than this share of its pixels does not fit, ..
const RIM: f64 = 0.15;
/// .. and something lies over the nail where so many touch each other on it that have more than this.
const CLEAR_RIM: f64 = 0.35;
const FEWEST_CELLS: usize = 13;
/// All pixels are looked at where so many cells are as clear by those of the fit, five a cell.
const FEWEST_BY_FIT: usize = 5;
/// Residuals of less than this are no rim: where nothing moves, encoders repeat most of a picture to the bit.
const LEAST_SD: f64 = 0.01;
/// A rim has gaps, up to twice so many cells wide, where it is as dark as what is below.
const WIDEST_GAP: usize = 3;
/// The nail is the largest part beside the rim, and each half as large: a rod may lie across it.
const LEAST_PART: f64 = 0.5;

/// Which cells of the nail's box are covered; rows from the proximal end.
pub(in crate::nailvideo) type Covered = [bool; CELLS * CELLS];

/// Cells of the nail's box in which the rim of something is seen; rows from the proximal end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::nailvideo) struct Rim([u32; CELLS]);

impl Rim {
    /// Whether a cell is one of the rim's.
    pub(in crate::nailvideo) fn has(&self, cell: usize) -> bool {
        self.0[cell / CELLS] >> (cell % CELLS) & 1 == 1
    }

    /// What is covered by something that has this rim, by the cells alone that are no rim.
    pub(super) fn covered(&self) -> Covered {
        covered(|cell| !self.has(cell))
    }

    /// Of a fit with its residuals; `None` where nothing lies over the nail.
    pub(super) fn of(
        template: &Template,
        sight: &Sight,
        (motion, gain, offset): (&Affine, f64, f64),
        residuals: &[f32],
    ) -> Option<Self> {
        let even = residuals.iter().map(|residual| residual.abs()).take(template.even);
        Self::with(FEWEST_BY_FIT, &template.pixels.cells, even.collect())?;
        let mut values = Vec::new();
        sight.each(motion, &template.corners, template.all.places(), &mut values);
        let (gain, offset) = (gain as f32, offset as f32);
        let all = template.all.values().iter().zip(values);
        let all = all.map(|(expected, value)| (gain * expected + offset - value).abs());
        Self::with(FEWEST_CELLS, &template.all.cells, all.collect())
    }

    /// Of residuals in cells, where as many cells touch each other.
    fn with(fewest: usize, cells: &[u16], residuals: Vec<f32>) -> Option<Self> {
        // Their own SD: a fit's has as many steep pixels, which any error of the place moves.
        let mut sorted: Vec<f32> = residuals.iter().copied().filter(|r| r.is_finite()).collect();
        let limit = (TUKEY_SDS * sd_of(&mut sorted)?.max(LEAST_SD)) as f32;
        let mut counts = [[0_u32; 2]; CELLS * CELLS];
        for (&cell, residual) in cells.iter().zip(residuals) {
            let [all, beside] = &mut counts[usize::from(cell)];
            *all += 1;
            // What is out of the picture says nothing.
            *beside += u32::from(residual >= limit);
        }
        let has = |cell: usize, share: f64| {
            let [all, beside] = counts[cell].map(f64::from);
            beside > share * all
        };
        let on_nail: Vec<u8> =
            (0..CELLS * CELLS).map(|cell| u8::from(is_near_nail(cell) && has(cell, CLEAR_RIM))).collect();
        let is_over = on_nail.iter().filter(|&&is| is == 1).count() >= fewest
            && parts(&on_nail, [CELLS; 2], Neighbours::Eight).all.iter().any(|part| part.area >= fewest);
        let row = |row: usize| (0..CELLS).fold(0, |bits, k| bits | u32::from(has(row * CELLS + k, RIM)) << k);
        is_over.then(|| Self(std::array::from_fn(row)))
    }
}

/// All but the nail, which is the largest part of the cells that may be bare.
pub(in crate::nailvideo) fn covered(may_be_bare: impl Fn(usize) -> bool) -> Covered {
    let bare: Vec<u8> = (0..CELLS * CELLS).map(|cell| u8::from(may_be_bare(cell))).collect();
    let parts = parts(&opened(&bare, [CELLS; 2], WIDEST_GAP), [CELLS; 2], Neighbours::Four);
    let largest = parts.all.iter().map(|part| part.area).max().unwrap_or(0) as f64;
    let is_nail = |label: i32| label > 0 && parts.all[label as usize - 1].area as f64 >= LEAST_PART * largest;
    std::array::from_fn(|cell| !is_nail(parts.labels[cell]))
}

/// On the nail, or so near that finger and not background is beside it; nails are rounder than their box.
fn is_near_nail(cell: usize) -> bool {
    const REACH: f64 = 1.12;
    let [u, v] = cell_middle(cell);
    u.powi(4) + v.powi(4) <= REACH.powi(4)
}
