//! The nail as it was in the first good frame: places, values and slopes of its locally normalized luma.
//!
//! It is never learnt again from frames that were followed: errors would add up (0.4 to 0.7 px in 24 frames, measured).

use super::sight::Sight;
use crate::median::{SD_OF_MAD, median_of};
use crate::nailvideo::affine::Affine;

/// Of these pixels the fit is made; half of them those of the steepest slopes, half spread evenly (measured: 6000 give
/// the accuracy of all).
const PIXELS: usize = 6000;
/// The first steps look at one of so many of them, of a template that has enough: the last ones decide.
const SPARSE: usize = 4;
const FEWEST_SPARSE: usize = 3000;
/// The box about the nail that is followed, of the nail's own (section 4.2.2's margin).
pub(super) const BOX: f64 = 1.25;

/// Blocks across and down that are compared each by itself.
pub(super) const BLOCKS: usize = 8;
/// Cells across and down in which it is seen where something lies over the nail; a whole number of them to a block.
pub(in crate::nailvideo) const CELLS: usize = 24;

/// Tukey's biweight is nothing from so many SDs on (measured).
pub(super) const TUKEY_SDS: f64 = 4.0;
/// Fewer pixels that are seen determine nothing (assumed).
const FEWEST_PIXELS: usize = 60;

/// Parameters of a motion: displacements in pixels at the nail's half extent: of x by x, y and 1, of y by x, y and 1.
pub(super) const MOTION: usize = 6;

#[derive(Debug, Clone, Copy)]
struct Pixel {
    at: [f32; 2],
    /// How the value changes with the motion's parameters, and the value.
    row: [f32; MOTION + 1],
    /// The cell of the nail's box that it lies in, of [`CELLS`] across and down.
    cell: u16,
}

/// Pixels of the template, a column for each of their numbers: as many pixels at once as vectors hold.
#[derive(Debug)]
pub(super) struct Pixels {
    pub(super) at: [Vec<f32>; 2],
    /// How the value changes with the motion's parameters, and the value: columns of the least squares.
    pub(super) rows: [Vec<f32>; MOTION + 1],
    /// The cell of the nail's box that each lies in, of [`CELLS`] across and down.
    pub(super) cells: Vec<u16>,
}

impl Pixels {
    fn of(pixels: &[Pixel]) -> Self {
        Self {
            at: std::array::from_fn(|axis| pixels.iter().map(|pixel| pixel.at[axis]).collect()),
            rows: std::array::from_fn(|k| pixels.iter().map(|pixel| pixel.row[k]).collect()),
            cells: pixels.iter().map(|pixel| pixel.cell).collect(),
        }
    }

    pub(super) fn values(&self) -> &[f32] {
        &self.rows[MOTION]
    }

    pub(super) fn places(&self) -> [&[f32]; 2] {
        self.at.each_ref().map(Vec::as_slice)
    }
}

/// The template at one scale.
#[derive(Debug)]
pub(super) struct Template {
    pub(super) pixels: Pixels,
    /// So many of them, the first ones, are spread evenly.
    pub(super) even: usize,
    /// One of so many of them, where they are enough for that.
    pub(super) sparse: Option<Pixels>,
    /// All that were to choose from, to look at.
    pub(super) all: Pixels,
    /// Of the box that all pixels lie in.
    pub(super) corners: [[f32; 2]; 4],
    /// Pixels of a block.
    pub(super) step: f64,
    /// The nail's middle, pixels.
    pub(super) middle: [f64; 2],
    /// Half of the nail's larger extent, pixels: where the parameters are displacements.
    pub(super) radius: f64,
}

/// The block that a cell lies in, of [`BLOCKS`] across and down.
#[inline]
pub(super) fn block_of(cell: u16) -> usize {
    const CELLS_OF_BLOCK: usize = CELLS / BLOCKS;
    let cell = usize::from(cell);
    cell % CELLS / CELLS_OF_BLOCK + BLOCKS * (cell / CELLS / CELLS_OF_BLOCK)
}

impl Template {
    /// Of a frame's sight; `frame_from_nail` leads from half widths and half lengths to its pixels.
    pub(super) fn new(sight: &Sight, frame_from_nail: &Affine, step: usize) -> Self {
        let [a, b, _, d, e, _] = frame_from_nail.0;
        let middle = frame_from_nail.of([0.0, 0.0]);
        let radius = a.hypot(d).max(b.hypot(e));
        let corners = [[-BOX, -BOX], [BOX, -BOX], [BOX, BOX], [-BOX, BOX]].map(|corner| frame_from_nail.of(corner));
        let low = [0, 1].map(|axis| corners.iter().map(|c| c[axis]).fold(f64::INFINITY, f64::min).max(0.0));
        let high = [0, 1].map(|axis| corners.iter().map(|c| c[axis]).fold(f64::NEG_INFINITY, f64::max).max(0.0));
        let nail_from_frame = frame_from_nail.inverse().unwrap_or(Affine::IDENTITY);
        let mut all = Vec::new();
        let half = 0.5 * (step as f64 - 1.0);
        let count = |axis: usize| ((high[axis] - low[axis]) / step as f64) as usize;
        for (row, column) in (0..count(1)).flat_map(|row| (0..count(0)).map(move |column| (row, column))) {
            let at = [column, row].map(|k| (k * step) as f64);
            let at = [low[0].floor() + at[0] + half, low[1].floor() + at[1] + half];
            let on_nail = nail_from_frame.of(at);
            let inside = on_nail.iter().all(|part| part.abs() <= BOX);
            if let Some(pixel) = inside.then(|| pixel(sight, at, step, middle, radius)).flatten() {
                all.push(Pixel { cell: cell_at(on_nail) as u16, ..pixel });
            }
        }
        let side = |axis: usize| {
            let all = all.iter().map(move |pixel: &Pixel| pixel.at[axis]);
            [all.clone().fold(f32::INFINITY, f32::min), all.fold(f32::NEG_INFINITY, f32::max)]
        };
        let ([left, right], [top, bottom]) = (side(0), side(1));
        let corners = [[left, top], [right, top], [right, bottom], [left, bottom]];
        let whole = Pixels::of(&all);
        let (chosen, even) = chosen(all);
        let few = || chosen.iter().step_by(SPARSE).copied().collect::<Vec<_>>();
        let sparse = (chosen.len() >= FEWEST_SPARSE).then(|| Pixels::of(&few()));
        Self { pixels: Pixels::of(&chosen), even, sparse, all: whole, corners, step: step as f64, middle, radius }
    }

    /// Share of the slopes' energy that is noise, 0 to 1. The noise is what a difference shows that smooth shading and
    /// edges straight along the picture leave at 0 (J. Immerkær, Comput. Vis. Image Underst. 64 (1996) 300,
    /// doi:10.1006/cviu.1996.0060; its median, as the nail's rim is no noise).
    pub(super) fn noise_of_slopes(&self, sight: &Sight, step: usize) -> f64 {
        /// Median of the difference's size, in SDs of a normal distribution's noise.
        const SDS: f64 = 0.6745 * 6.0;
        let h = step as f32;
        let difference = |k: usize| {
            let [x, y] = [0, 1].map(|axis| self.pixels.at[axis][k]);
            let row = |dy: f32| sight.at(x - h, y + dy) - 2.0 * sight.at(x, y + dy) + sight.at(x + h, y + dy);
            (row(-h) - 2.0 * row(0.0) + row(h)).abs()
        };
        let sizes = (0..self.even).map(difference).filter(|size| size.is_finite());
        let median = median_of(sizes.map(f64::from)).unwrap_or(0.0);
        let slopes =
            [2, 5].map(|k| self.pixels.rows[k][..self.even].iter().map(|slope| f64::from(*slope).powi(2)).sum());
        let all = slopes.iter().sum::<f64>() / self.even.max(1) as f64;
        // A slope is half the difference of two values, and there are two of them.
        let noise = (median / SDS / step as f64).powi(2);
        if all > 0.0 { (noise / all).min(1.0) } else { 1.0 }
    }

    /// The motion that its parameters stand for, about the nail's middle.
    pub(super) fn motion(&self, by: &[f64; MOTION]) -> Affine {
        let [x, y] = self.middle;
        let linear = [by[0], by[1], by[3], by[4]].map(|part| part / self.radius);
        let [a, b, d, e] = [1.0 + linear[0], linear[1], linear[2], 1.0 + linear[3]];
        Affine([a, b, x + by[2] - a * x - b * y, d, e, y + by[5] - d * x - e * y])
    }
}

/// A cell's middle, half widths and half lengths.
pub(in crate::nailvideo) fn cell_middle(cell: usize) -> [f64; 2] {
    [cell % CELLS, cell / CELLS].map(|k| BOX * ((2 * k + 1) as f64 / CELLS as f64 - 1.0))
}

/// The cell of a place in half widths and half lengths; beyond the box the nearest.
pub(in crate::nailvideo) fn cell_at(place: [f64; 2]) -> usize {
    let [u, v] = place.map(|at| (((at / BOX + 1.0) * 0.5 * CELLS as f64) as usize).min(CELLS - 1));
    u + CELLS * v
}

/// The SD of residuals by the median of their sizes; `None` of too few.
pub(super) fn sd_of(sizes: &mut [f32]) -> Option<f64> {
    if sizes.len() < FEWEST_PIXELS {
        return None;
    }
    // Sizes are in the order of their bits.
    let (_, median, _) = sizes.select_nth_unstable_by_key(sizes.len() / 2, |size| size.to_bits());
    Some(SD_OF_MAD * f64::from(*median))
}

/// The square of the slope along x and y.
fn slope2(pixel: &Pixel) -> f64 {
    f64::from(pixel.row[2]).powi(2) + f64::from(pixel.row[5]).powi(2)
}

fn pixel(sight: &Sight, at: [f64; 2], step: usize, middle: [f64; 2], radius: f64) -> Option<Pixel> {
    let [x, y] = at.map(|part| part as f32);
    let h = step as f32;
    let value = sight.at(x, y);
    let dx = 0.5 * (sight.at(x + h, y) - sight.at(x - h, y)) / h;
    let dy = 0.5 * (sight.at(x, y + h) - sight.at(x, y - h)) / h;
    let local = [0, 1].map(|axis| ((at[axis] - middle[axis]) / radius) as f32);
    let row = [dx * local[0], dx * local[1], dx, dy * local[0], dy * local[1], dy, value];
    (value + dx + dy).is_finite().then_some(Pixel { at: [x, y], row, cell: 0 })
}

/// Half spread evenly, half the steepest of the others; and how many are spread evenly.
fn chosen(all: Vec<Pixel>) -> (Vec<Pixel>, usize) {
    let count = all.len();
    if count <= PIXELS {
        return (all, count);
    }
    let (mut even, mut rest) = (Vec::with_capacity(PIXELS), Vec::with_capacity(count));
    for (k, pixel) in all.into_iter().enumerate() {
        // A step that is no divisor of a row's length spreads over columns as well.
        let is_even = k * (PIXELS / 2) / count != (k + 1) * (PIXELS / 2) / count;
        if is_even { even.push(pixel) } else { rest.push((k, pixel)) }
    }
    rest.sort_by(|(i, a), (j, b)| slope2(b).total_cmp(&slope2(a)).then(i.cmp(j)));
    rest.truncate(PIXELS - even.len());
    // Neighbours in memory are neighbours in the frame.
    rest.sort_by_key(|(k, _)| *k);
    let count = even.len();
    even.extend(rest.into_iter().map(|(_, pixel)| pixel));
    (even, count)
}
