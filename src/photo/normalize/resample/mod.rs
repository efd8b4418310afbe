//! Values of a turned and scaled grid of pixels on a photograph, without aliasing and without ringing.
//!
//! Where an output pixel covers up to 1.25 pixels of the photograph, the value is interpolated at its centre, by
//! cubic convolution (Keys 1981, DOI 10.1109/TASSP.1981.1163711, a = -1/2), limited to the range of the pixels around
//! so that an edge never rings. Where it covers more, it is the mean of a grid of such samples over its footprint, at
//! least one a (block of) pixel(s) of the photograph, so that nothing aliases.

use std::sync::LazyLock;

use image::DynamicImage;
use wide::f32x4;

use super::frame::NailFrame;
use super::options::{Normalization, Resample};
use super::plane::{Plane, Taking};

/// The values, row by row from the top (distal), fractions of full scale; NaN where the photograph does not show the
/// place. False where it shows nothing at all.
pub(super) fn values(image: &DynamicImage, frame: &NailFrame, with: &Normalization, buffers: &mut Buffers) -> bool {
    let grid = Grid::new(frame, with);
    let Buffers { plane, values, lines } = buffers;
    let Some(source) = Source::new(image, &grid, with, std::mem::take(plane)) else { return false };
    values.clear();
    values.reserve_exact(grid.size * grid.size);
    match source.samples {
        [1, 1] if source.is_whole && source.resample == Resample::Cubic && grid.is_nearly_upright() => {
            source.points_in_two_passes(&grid, values, lines);
        }
        [1, 1] if source.is_whole => source.points(&grid, values),
        _ => source.means(&grid, values),
    }
    if !grid.lies_within(&source) {
        grid.forget_outside(&source, values);
    }
    *plane = source.values;
    true
}

/// Memory that goes from nail to nail.
#[derive(Default)]
pub(super) struct Buffers {
    /// The last nail's values, see [`values`].
    pub(super) values: Vec<f32>,
    plane: Vec<f32>,
    lines: Vec<f32>,
}

/// The normalized picture's pixels on the photograph: an affine map.
struct Grid {
    size: usize,
    /// The outer corner of the top-left output pixel.
    origin: [f64; 2],
    /// One output column, one output row.
    per_column: [f64; 2],
    per_row: [f64; 2],
    /// Photograph pixels an output pixel covers, across and along.
    covers: [f64; 2],
}

/// Up to here an output pixel's centre represents all of it; beyond, its footprint is averaged.
const POINT_SAMPLED_UP_TO_PX: f64 = 1.25;
/// Samples an axis of a footprint after the photograph was reduced by whole blocks.
const SAMPLES_KEPT: f64 = 3.0;

/// Tangent of the turn up to which two passes are taken, 30 degrees.
const STEEPEST: f64 = 0.577_350_27;
/// Output columns that two passes fill side by side.
const COLUMNS: usize = 8;
/// Of these, columns that are interpolated at once.
const LANES: usize = 4;

impl Grid {
    fn new(frame: &NailFrame, with: &Normalization) -> Self {
        let nail = with.size as f64 / with.margin;
        let half = with.size as f64 / 2.0 / nail;
        let origin = frame.photo_from_nail(-half, half);
        let (right, distal) = (frame.axis.right(), frame.axis.distal());
        let covers = [frame.width_px / nail, frame.length_px / nail];
        let per_column = [right[0] * covers[0], right[1] * covers[0]];
        let per_row = [-distal[0] * covers[1], -distal[1] * covers[1]];
        Self { size: with.size, origin, per_column, per_row, covers }
    }

    fn corner(&self, row: usize, column: usize) -> [f64; 2] {
        let (row, column) = (row as f64, column as f64);
        [0, 1].map(|k| self.origin[k] + self.per_column[k] * column + self.per_row[k] * row)
    }

    /// Turned little enough for two one-dimensional passes: their samples lie 1 / cos(angle) apart.
    fn is_nearly_upright(&self) -> bool {
        self.per_row[0].abs() <= STEEPEST * self.per_row[1].abs()
    }

    /// Lowest and highest photograph coordinates touched.
    fn bounds(&self) -> ([f64; 2], [f64; 2]) {
        let corners = [(0, 0), (0, self.size), (self.size, 0), (self.size, self.size)].map(|(r, c)| self.corner(r, c));
        let low = [0, 1].map(|k| corners.iter().map(|c| c[k]).fold(f64::INFINITY, f64::min));
        let high = [0, 1].map(|k| corners.iter().map(|c| c[k]).fold(f64::NEG_INFINITY, f64::max));
        (low, high)
    }

    /// Makes NaN of what lies beyond the photograph's border, where border pixels were repeated.
    fn forget_outside(&self, source: &Source, values: &mut [f32]) {
        for (row, line) in values.chunks_exact_mut(self.size).enumerate() {
            let corner = self.corner(row, 0);
            // Along a row, what lies within is one stretch of columns.
            let (mut from, mut to) = (0.0_f64, self.size as f64 - 1.0);
            for (k, corner) in corner.into_iter().enumerate() {
                let (step, first) = (self.per_column[k], corner + 0.5 * (self.per_column[k] + self.per_row[k]));
                let crossings = [(-0.5 - first) / step, (source.photo_end[k] - first) / step];
                if step != 0.0 {
                    from = from.max(crossings[0].min(crossings[1]).ceil());
                    to = to.min(crossings[0].max(crossings[1]).floor());
                } else if source.lies_outside_along(k, first) {
                    to = -1.0;
                }
            }
            let (from, end) = (from as usize, (to + 1.0).max(0.0) as usize);
            if from < end {
                line[..from].fill(f32::NAN);
                line[end..].fill(f32::NAN);
            } else {
                line.fill(f32::NAN);
            }
        }
    }

    fn lies_within(&self, source: &Source) -> bool {
        let (low, high) = self.bounds();
        (0..2).all(|k| low[k] >= -0.5 && high[k] <= source.photo_end[k])
    }
}

/// An output column's line through the photograph, in fixed point.
struct Strand {
    /// The output pixel's row, from `top`.
    y: i64,
    /// The rows that its cubics reach.
    top: usize,
    bottom: usize,
    /// Where the line crosses the row at hand.
    crossing: i64,
}

/// The part of the photograph that the grid needs, reduced by whole blocks where it covers many pixels.
struct Source {
    width: usize,
    values: Vec<f32>,
    /// Photograph coordinates of the centre of `values[0]`, and their distance.
    first: [f64; 2],
    spacing: f64,
    /// Photograph coordinates end here (width - 0.5, height - 0.5).
    photo_end: [f64; 2],
    /// Samples a footprint across and along.
    samples: [usize; 2],
    resample: Resample,
    /// Every place of the grid has its neighbours here, those beyond the photograph's border repeated.
    is_whole: bool,
}

/// Neighbours that a cubic needs on either side, pixels.
const REACH: f64 = 3.0;

impl Source {
    /// `None` where the grid lies wholly outside of the photograph.
    fn new(image: &DynamicImage, grid: &Grid, with: &Normalization, memory: Vec<f32>) -> Option<Self> {
        let photo_end = [f64::from(image.width()) - 0.5, f64::from(image.height()) - 0.5];
        let factor = match with.resample {
            Resample::Nearest => 1,
            _ => (grid.covers[0].min(grid.covers[1]) / SAMPLES_KEPT).floor().max(1.0) as usize,
        };
        let reach = REACH * factor as f64;
        let (low, high) = grid.bounds();
        if (0..2).any(|k| !(high[k] > -0.5 && low[k] < photo_end[k])) {
            return None;
        }
        // A nail at the border is taken whole; of an outline that lies mostly elsewhere, only what is there.
        let beyond = 0.5 * photo_end[0].max(photo_end[1]);
        let (lowest, highest) = ([-beyond; 2], photo_end.map(|end| end + beyond));
        let is_whole = (0..2).all(|k| low[k] >= lowest[k] && high[k] <= highest[k]);
        let range = [0, 1].map(|k| {
            let start = (low[k].max(lowest[k]) - reach).floor() as i64;
            let end = (high[k].min(highest[k]) + reach).ceil() as i64 + 1;
            let whole = (end - start + factor as i64 - 1) / factor as i64 * factor as i64;
            [start, start + whole]
        });
        let plane = Plane::take(image, Taking { channel: with.channel, linear: with.linear }, range, memory);
        let middle = (factor - 1) as f64 / 2.0;
        let first = [plane.x0 as f64 + middle, plane.y0 as f64 + middle];
        let width = plane.width / factor;
        let values = if factor == 1 { plane.values } else { plane.reduce(factor) };
        let samples = grid.covers.map(|covers| match with.resample {
            Resample::Nearest => 1,
            _ if covers <= POINT_SAMPLED_UP_TO_PX => 1,
            _ => (covers / factor as f64).ceil() as usize,
        });
        Some(Self {
            width,
            values,
            first,
            spacing: factor as f64,
            photo_end,
            samples,
            resample: with.resample,
            is_whole,
        })
    }

    fn lies_outside(&self, place: [f64; 2]) -> bool {
        (0..2).any(|k| self.lies_outside_along(k, place[k]))
    }

    fn lies_outside_along(&self, k: usize, coordinate: f64) -> bool {
        !(coordinate >= -0.5 && coordinate <= self.photo_end[k])
    }

    /// Every output pixel at its centre, all of them known to lie within this source.
    fn points(&self, grid: &Grid, values: &mut Vec<f32>) {
        let step = [0, 1].map(|k| fixed(grid.per_column[k] / self.spacing));
        for row in 0..grid.size {
            let corner = grid.corner(row, 0);
            let [mut x, mut y] = [0, 1].map(|k| {
                let centre = corner[k] + 0.5 * (grid.per_column[k] + grid.per_row[k]);
                fixed((centre - self.first[k]) / self.spacing)
            });
            values.extend((0..grid.size).map(|_| {
                let value = self.at((x >> 32) as usize, (y >> 32) as usize, fraction(x), fraction(y));
                x += step[0];
                y += step[1];
                value
            }));
        }
    }

    /// As [`Source::points`], at less than half its work: for each output column, the photograph's rows are
    /// interpolated along x where the column's line crosses them, then that line is along y (Catmull and Smith 1980,
    /// DOI 10.1145/800250.807505). On a slanted line the second pass's samples are not those of the upright
    /// neighbourhood, so values differ a little where the photograph has detail of one or two pixels.
    fn points_in_two_passes(&self, grid: &Grid, values: &mut Vec<f32>, lines: &mut Vec<f32>) {
        let size = grid.size;
        values.resize(size * size, 0.0);
        let corner = grid.corner(0, 0);
        let place = |k: usize, column: usize| {
            let along = corner[k] + grid.per_column[k] * (column as f64 + 0.5) + 0.5 * grid.per_row[k];
            (along - self.first[k]) / self.spacing
        };
        let weights = &*PHASE_WEIGHTS;
        let down = grid.per_row[1] / self.spacing;
        let slant = fixed(grid.per_row[0] / grid.per_row[1]);
        // A column's line has at most as many values as the photograph has rows.
        let tall = self.values.len() / self.width;
        lines.resize(COLUMNS * tall, 0.0);
        let mut block = vec![[0.0_f32; COLUMNS]; size];
        for first in (0..size).step_by(COLUMNS) {
            let columns = COLUMNS.min(size - first);
            // The last column again where there are fewer.
            let mut strands: [Strand; COLUMNS] = std::array::from_fn(|k| {
                let column = first + k.min(columns - 1);
                let [x, y] = [place(0, column), place(1, column)];
                let last = y + down * (size - 1) as f64;
                let top = y.min(last) as usize - 1;
                let crossing = fixed(x) + fixed_product(slant, top as f64 - y);
                Strand { y: fixed(y - top as f64), top, bottom: y.max(last) as usize + 3, crossing }
            });
            let top = strands.iter().map(|s| s.top).min().unwrap_or(0);
            let bottom = strands.iter().map(|s| s.bottom).max().unwrap_or(0);
            for row in top..=bottom {
                let source = &self.values[row * self.width..][..self.width];
                let crosses = |strand: &Strand| (strand.top..=strand.bottom).contains(&row);
                let lines = lines.chunks_exact_mut(LANES * tall);
                for (strands, lines) in strands.as_chunks_mut::<LANES>().0.iter_mut().zip(lines) {
                    let values = if strands.iter().all(crosses) {
                        between_each([source; LANES], strands.each_ref().map(|strand| strand.crossing), weights)
                    } else {
                        let value = |strand: &Strand| between(source, strand.crossing, weights);
                        strands.each_ref().map(|strand| if crosses(strand) { value(strand) } else { 0.0 })
                    };
                    for ((strand, line), value) in strands.iter_mut().zip(lines.chunks_exact_mut(tall)).zip(values) {
                        if crosses(strand) {
                            line[row - strand.top] = value;
                            strand.crossing += slant;
                        }
                    }
                }
            }
            let step = fixed(down);
            let lines = lines.chunks_exact(LANES * tall);
            for (at, (strands, lines)) in strands.as_chunks::<LANES>().0.iter().zip(lines).enumerate() {
                let lines = std::array::from_fn(|k| &lines[k * tall..][..tall]);
                let mut places = strands.each_ref().map(|strand| strand.y);
                for row in &mut block {
                    row[at * LANES..][..LANES].copy_from_slice(&between_each(lines, places, weights));
                    places.iter_mut().for_each(|place| *place += step);
                }
            }
            for (row, block) in values.chunks_exact_mut(size).zip(&block) {
                row[first..first + columns].copy_from_slice(&block[..columns]);
            }
        }
    }

    /// The mean over every output pixel's footprint; NaN where part of it is not seen.
    fn means(&self, grid: &Grid, values: &mut Vec<f32>) {
        let inside = grid.lies_within(self);
        let pixels = (0..grid.size).flat_map(|row| (0..grid.size).map(move |column| (row, column)));
        values.extend(pixels.map(|(row, column)| self.mean(grid.corner(row, column), grid, inside)));
    }

    fn mean(&self, corner: [f64; 2], grid: &Grid, inside: bool) -> f32 {
        let [across, along] = self.samples;
        let mut sum = 0.0;
        for row in 0..along {
            let r = (row as f64 + 0.5) / along as f64;
            for column in 0..across {
                let c = (column as f64 + 0.5) / across as f64;
                let place = [0, 1].map(|k| corner[k] + grid.per_column[k] * c + grid.per_row[k] * r);
                if !inside && self.lies_outside(place) {
                    return f32::NAN;
                }
                let [x, y] = [0, 1].map(|k| (place[k] - self.first[k]) / self.spacing);
                sum += self.at(x as usize, y as usize, x.fract() as f32, y.fract() as f32);
            }
        }
        sum / (across * along) as f32
    }

    /// The value at (column + fx, row + fy) of the reduced photograph. [`Source::new`] takes a margin of [`REACH`]
    /// pixels all around, so that every neighbour is there.
    #[inline(always)]
    fn at(&self, column: usize, row: usize, fx: f32, fy: f32) -> f32 {
        match self.resample {
            Resample::Nearest => {
                self.values[(row + usize::from(fy >= 0.5)) * self.width + column + usize::from(fx >= 0.5)]
            }
            Resample::Linear => {
                let [top, below]: [[f32; 2]; 2] = self.block(column, row);
                let line = |row: [f32; 2]| row[0] + (row[1] - row[0]) * fx;
                line(top) + (line(below) - line(top)) * fy
            }
            Resample::Cubic => {
                let rows = self.block(column - 1, row - 1).map(f32x4::new);
                let down = cubic_weights(fy).to_array();
                let columns = (rows[0] * down[0] + rows[1] * down[1]) + (rows[2] * down[2] + rows[3] * down[3]);
                let value = (columns * cubic_weights(fx)).reduce_add();
                let ([_, a, b, _], [_, c, d, _]) = (rows[1].to_array(), rows[2].to_array());
                let low = lesser(lesser(a, b), lesser(c, d));
                let high = greater(greater(a, b), greater(c, d));
                limit(value, low, high)
            }
        }
    }

    #[inline(always)]
    fn block<const N: usize>(&self, column: usize, row: usize) -> [[f32; N]; N] {
        let mut rows = [[0.0; N]; N];
        for (k, line) in rows.iter_mut().enumerate() {
            let at = (row + k) * self.width + column;
            line.copy_from_slice(&self.values[at..at + N]);
        }
        rows
    }
}

/// A coordinate with 32 bits after the point, so that stepping along a row does not gather rounding.
fn fixed(coordinate: f64) -> i64 {
    (coordinate * 4_294_967_296.0).round() as i64
}

#[inline(always)]
fn fraction(fixed: i64) -> f32 {
    (fixed & 0xFFFF_FFFF) as f32 * (1.0 / 4_294_967_296.0)
}

/// `slope`, in fixed point, times a number.
fn fixed_product(slope: i64, factor: f64) -> i64 {
    (slope as f64 * factor).round() as i64
}

/// Places between two values that [`between`] distinguishes: a thousandth of a pixel moves no value by a level.
const PHASES: usize = 1024;

static PHASE_WEIGHTS: LazyLock<[f32x4; PHASES]> =
    LazyLock::new(|| std::array::from_fn(|k| cubic_weights(k as f32 / PHASES as f32)));
/// Half a phase, in fixed point: places are rounded to the nearest.
const HALF_PHASE: i64 = (1 << 32) / (2 * PHASES as i64);

/// The cubic through the four of `values` around a place in fixed point, limited to its two neighbours.
#[inline(always)]
fn between(values: &[f32], place: i64, weights: &[f32x4; PHASES]) -> f32 {
    let (four, weights) = around(values, place, weights);
    let [_, before, after, _] = four.to_array();
    limit((four * weights).reduce_add(), lesser(before, after), greater(before, after))
}

/// [`between`] on each of four lines, to the bit.
#[inline(always)]
fn between_each(lines: [&[f32]; LANES], places: [i64; LANES], weights: &[f32x4; PHASES]) -> [f32; LANES] {
    let each: [_; LANES] = std::array::from_fn(|k| around(lines[k], places[k], weights));
    let [a, b, c, d] = f32x4::transpose(each.map(|(four, weights)| four * weights));
    let [_, before, after, _] = f32x4::transpose(each.map(|(four, _)| four)).map(f32x4::to_array);
    let sums = (((a + b) + c) + d).to_array();
    std::array::from_fn(|k| limit(sums[k], lesser(before[k], after[k]), greater(before[k], after[k])))
}

/// The four of `values` around a place in fixed point, and their weights.
#[inline(always)]
fn around(values: &[f32], place: i64, weights: &[f32x4; PHASES]) -> (f32x4, f32x4) {
    let place = place + HALF_PHASE;
    let before = (place >> 32) as usize - 1;
    let four = &values[before..before + 4];
    let weights = weights[(place as u32 >> (32 - PHASES.ilog2())) as usize];
    (f32x4::new([four[0], four[1], four[2], four[3]]), weights)
}

/// The value comes last in both comparisons: a missing neighbour makes it NaN, and NaN it stays.
#[inline(always)]
fn limit(value: f32, low: f32, high: f32) -> f32 {
    let limited = if value < low { low } else { value };
    if limited > high { high } else { limited }
}

#[inline(always)]
fn lesser(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[inline(always)]
fn greater(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// Keys' cubic convolution with a = -1/2 at `t` within 0..1 after the second of four equally spaced values.
#[inline(always)]
fn cubic_weights(t: f32) -> f32x4 {
    const CONSTANT: f32x4 = f32x4::new([0.0, 1.0, 0.0, 0.0]);
    const LINEAR: f32x4 = f32x4::new([-0.5, 0.0, 0.5, 0.0]);
    const SQUARE: f32x4 = f32x4::new([1.0, -2.5, 2.0, -0.5]);
    const CUBE: f32x4 = f32x4::new([-0.5, 1.5, -1.5, 0.5]);
    let t = f32x4::splat(t);
    ((CUBE * t + SQUARE) * t + LINEAR) * t + CONSTANT
}

#[cfg(test)]
mod tests;
