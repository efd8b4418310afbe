//! The surroundings of one nail at a working size: colours, edges, and likeness to the skin next to the nail.
//!
//! In: the upright photograph (any depth, colour or grey) and one outline. Out: a small square picture around the nail,
//! scaled so that the outline's long axis is [`NAIL_CELLS`] cells; only the window is read, and of a large photograph
//! only some pixels of each cell, so the cost does not grow with the photograph.
//!
//! Frame: cell (0, 0) is the outline's centroid, x right and y down as in the photograph. Colours are divided by the
//! nail's own median luma, so that exposure does not matter; a grey photograph has no colour differences and works on
//! brightness alone. Cells outside the photograph are marked, never made up.

use std::sync::LazyLock;

use image::{DynamicImage, ImageBuffer, Pixel, Primitive};
use wide::f32x4;

use crate::photo::outline::{Moments, Outline};
use crate::vision::{filled, smoothed, steps_out};

/// Cells along the outline's long axis.
pub(super) const NAIL_CELLS: f64 = 16.0;
/// Half the window's side, cells: the finger's sides are looked for up to 1.45 nail lengths aside and 1.3 behind.
const HALF: usize = 34;
const SIDE: usize = 2 * HALF + 1;
/// At most this many pixels are read along each side of a cell.
const READS: u32 = 3;
/// Smoothing before derivatives, cells: below it lie the pixels' noise and hairs.
const BLUR: f32 = 0.7;
/// Cells within this distance of the nail show its own edge.
const CLEAR_OF_NAIL: f64 = 2.0;
/// Derivatives below this, relative to the nail's luma a cell, are noise (1 % is 1.5 levels of an 8-bit nail at 150).
const EDGE_FLOOR: f32 = 0.01;
/// Colour distances below this, relative to the nail's luma, are noise.
const COLOUR_FLOOR: f32 = 0.02;
/// Colour differences count this much more than brightness: shading changes brightness, seldom hue.
const COLOUR_WEIGHT: f32 = 1.5;

/// What is known at one cell: the gradient's outer product summed over the channels (xx, xy, yy), and the distance from
/// the colour of the skin next to the nail, 0 (skin) to 1. Together, so that one interpolation gives all.
type Cell = [f32; 4];

/// The surroundings of one nail.
pub(super) struct Surroundings {
    cells: Vec<Cell>,
    /// Whether the cell and those right of and below it are all known.
    block: Vec<bool>,
    /// Cells of the nail, relative to the centroid.
    pub(super) nail: Vec<[f32; 2]>,
    /// Of these, the ends of each row: none lies further out in any direction.
    pub(super) rim: Vec<[f32; 2]>,
    /// Their mean.
    pub(super) centre: [f32; 2],
    /// 1 on the nail.
    mask: Vec<u8>,
    /// Square of the gradient that the stronger edges here reach.
    typical_edge2: f32,
    /// Whether anything around the nail stands out from noise.
    pub(super) featureless: bool,
}

impl Surroundings {
    /// Reads the surroundings; `None` where no cell of the nail lies on the photograph.
    pub(super) fn read(image: &DynamicImage, outline: &Outline, moments: &Moments) -> Option<Self> {
        let px_per_cell = moments.major_px / NAIL_CELLS;
        let mask = nail_mask(outline, moments.centroid_px, px_per_cell);
        let (mut colours, inside) = gather(image, moments.centroid_px, px_per_cell);
        let at_nail = |i: usize| mask[i] > 0;

        let around: Vec<u8> = mask.iter().map(|&nail| 1 - nail).collect();
        let steps = steps_out(&around, [SIDE; 2]);
        let away = |i: usize| f64::from(steps[i]);
        let ring = |i: usize| inside[i] && away(i) > 1.0 && away(i) <= 3.0;
        let median = |values: &mut dyn Iterator<Item = f32>| quantile(&mut values.collect::<Vec<f32>>(), 0.5);
        let on_nail = (0..SIDE * SIDE).filter(|&i| at_nail(i) && inside[i]);
        let nail_luma = median(&mut on_nail.map(|i| colours[i][0]))?;
        let skin_luma = median(&mut (0..SIDE * SIDE).filter(|&i| ring(i)).map(|i| colours[i][0]))?;
        let scale = 1.0 / nail_luma.min(skin_luma).max(1e-3);
        // Beyond thrice the nail's luma all is "much brighter": a lamp in the background is no stronger edge.
        for colour in &mut colours {
            *colour = colour.map(|c| (c * scale).clamp(-3.0, 3.0));
        }
        let colours = smoothed(&colours, [SIDE; 2], *KERNEL);

        let mut skin = [0.0; 3];
        for (c, value) in skin.iter_mut().enumerate() {
            *value = median(&mut (0..SIDE * SIDE).filter(|&i| ring(i)).map(|i| colours[i][c]))?;
        }

        let mut cells = vec![Cell::default(); SIDE * SIDE];
        let mut whole = vec![false; SIDE * SIDE];
        for y in 1..SIDE - 1 {
            for x in 1..SIDE - 1 {
                let i = y * SIDE + x;
                whole[i] = inside[i] && inside[i - 1] && inside[i + 1] && inside[i - SIDE] && inside[i + SIDE];
                let cell = &mut cells[i];
                for c in 0..3 {
                    let gx = 0.5 * (colours[i + 1][c] - colours[i - 1][c]);
                    let gy = 0.5 * (colours[i + SIDE][c] - colours[i - SIDE][c]);
                    cell[0] += gx * gx;
                    cell[1] += gx * gy;
                    cell[2] += gy * gy;
                    cell[3] += (colours[i][c] - skin[c]).powi(2);
                }
                cell[3] = cell[3].sqrt().min(1.0);
            }
        }
        let near: Vec<usize> =
            (0..SIDE * SIDE).filter(|&i| whole[i] && away(i) > CLEAR_OF_NAIL && away(i) <= 0.9 * NAIL_CELLS).collect();
        let mut edges: Vec<f32> = near.iter().map(|&i| (cells[i][0] + cells[i][2]).sqrt()).collect();
        let edge = quantile(&mut edges, 0.75)?;
        let strongest = quantile(&mut edges, 0.95)?;
        let mut unlike: Vec<f32> = near.iter().map(|&i| cells[i][3]).collect();
        let typical_unlike = quantile(&mut unlike, 0.6)?.max(COLOUR_FLOOR);
        for cell in &mut cells {
            cell[3] /= cell[3] + typical_unlike;
        }
        let half = HALF as f32;
        let place = |i: usize| [(i % SIDE) as f32 - half, (i / SIDE) as f32 - half];
        let ends_a_row = |i: usize| {
            let (x, y) = (i % SIDE, i / SIDE);
            let beside = |x: usize| x < SIDE && at_nail(y * SIDE + x);
            x == 0 || !beside(x - 1) || !beside(x + 1)
        };
        let on_nail = || (0..SIDE * SIDE).filter(|&i| at_nail(i));
        let nail: Vec<[f32; 2]> = on_nail().map(place).collect();
        let rim = on_nail().filter(|&i| ends_a_row(i)).map(place).collect();
        let count = nail.len() as f32;
        let centre = nail.iter().fold([0.0, 0.0], |sum, p| [sum[0] + p[0] / count, sum[1] + p[1] / count]);
        let block =
            (0..SIDE * SIDE).map(|i| [i, i + 1, i + SIDE, i + SIDE + 1].iter().all(|j| whole.get(*j) == Some(&true)));
        let block = block.collect();
        let featureless = strongest < EDGE_FLOOR;
        Some(Self { cells, block, nail, rim, centre, mask, typical_edge2: edge.max(EDGE_FLOOR).powi(2), featureless })
    }

    /// How much of an edge crosses the unit vector `normal` at `at`, 0 to 1 (0.5: as strong as the stronger ones here);
    /// `None` outside the photograph.
    pub(super) fn edge(&self, at: [f32; 2], normal: [f32; 2]) -> Option<f32> {
        let [xx, xy, yy, _] = self.cell(at)?;
        let [nx, ny] = normal;
        let change2 = (xx * nx * nx + 2.0 * xy * nx * ny + yy * ny * ny).max(0.0);
        Some(change2 / (change2 + self.typical_edge2))
    }

    /// How different from the skin next to the nail the place `at` is, 0 to 1; `None` outside the photograph.
    pub(super) fn unlike_skin(&self, at: [f32; 2]) -> Option<f32> {
        self.cell(at).map(|cell| cell[3])
    }

    /// The cell at `at`, interpolated; `None` outside the photograph.
    #[inline(always)]
    fn cell(&self, at: [f32; 2]) -> Option<Cell> {
        let (x, y) = (at[0] + HALF as f32, at[1] + HALF as f32);
        let last = (SIDE - 1) as f32;
        if !(x >= 0.0 && y >= 0.0 && x < last && y < last) {
            return None;
        }
        let (left, top) = (x as u32, y as u32);
        let (fx, fy) = (x - left as f32, y - top as f32);
        let i = top as usize * SIDE + left as usize;
        if !self.block[i] {
            return None;
        }
        let row = |i: usize| {
            let [left, right] = [i, i + 1].map(|i| f32x4::new(self.cells[i]));
            left + f32x4::splat(fx) * (right - left)
        };
        let (above, below) = (row(i), row(i + SIDE));
        Some((above + f32x4::splat(fy) * (below - above)).to_array())
    }

    /// Whether the cell nearest to `at` belongs to the nail.
    pub(super) fn is_nail(&self, at: [f32; 2]) -> bool {
        // Half a cell more: rounded when cut.
        let (x, y) = (at[0] + HALF as f32 + 0.5, at[1] + HALF as f32 + 0.5);
        let within = x >= 0.0 && y >= 0.0 && x < SIDE as f32 && y < SIDE as f32;
        within && self.mask[y as usize * SIDE + x as usize] > 0
    }
}

/// The `q`-quantile (nearest rank) of `values`, which it reorders.
fn quantile(values: &mut [f32], q: f64) -> Option<f32> {
    let rank = (q * values.len().saturating_sub(1) as f64).round() as usize;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(rank, f32::total_cmp).1)
}

/// Cells of which at least half lies in the outline: 1, others 0.
fn nail_mask(outline: &Outline, centre: [f64; 2], px_per_cell: f64) -> Vec<u8> {
    const FINE: usize = 4;
    // Corner of the window at cell -0.5; in fine cells' centres.
    let to_fine =
        |p: f64, c: f64| (((p - c) / px_per_cell + HALF as f64 + 0.5) * FINE as f64 - 0.5).round().clamp(-1e6, 1e6);
    let corners: Vec<[i32; 2]> =
        outline.points().iter().map(|p| [0, 1].map(|k| to_fine(p[k], centre[k]) as i32)).collect();
    let fine = filled(&corners, [SIDE * FINE; 2]);
    let covered = |cell: usize| -> u32 {
        let first = cell / SIDE * FINE * SIDE * FINE + cell % SIDE * FINE;
        let row =
            |row: usize| fine[first + row * SIDE * FINE..].first_chunk().map_or(0, |four| u32::from_ne_bytes(*four));
        // Sums of four zeros and ones, one in each byte.
        (0..FINE).map(row).sum::<u32>().to_ne_bytes().into_iter().map(u32::from).sum()
    };
    (0..SIDE * SIDE).map(|cell| u8::from(2 * covered(cell) as usize >= FINE * FINE)).collect()
}

/// Colours (luma, red less green, green less blue, as fractions of full scale) of the window's cells, and which cells
/// lie on the photograph; those outside repeat the nearest pixel.
fn gather(image: &DynamicImage, centre: [f64; 2], px_per_cell: f64) -> (Vec<[f32; 3]>, Vec<bool>) {
    macro_rules! typed {
        ($($variant:ident),+) => {
            match image {
                $(DynamicImage::$variant(pixels) => gather_typed(pixels, centre, px_per_cell),)+
                other => gather_typed(&other.to_rgb32f(), centre, px_per_cell),
            }
        };
    }
    typed!(ImageLuma8, ImageLumaA8, ImageRgb8, ImageRgba8, ImageLuma16, ImageLumaA16, ImageRgb16, ImageRgba16)
}

fn gather_typed<P>(
    pixels: &ImageBuffer<P, Vec<P::Subpixel>>,
    centre: [f64; 2],
    px_per_cell: f64,
) -> (Vec<[f32; 3]>, Vec<bool>)
where
    P: Pixel,
    P::Subpixel: Primitive + Into<f32>,
{
    let unit = 1.0 / P::Subpixel::DEFAULT_MAX_VALUE.into();
    let (width, height) = (f64::from(pixels.width()), f64::from(pixels.height()));
    let channels = usize::from(P::CHANNEL_COUNT);
    let stride = channels * pixels.width() as usize;
    let samples = pixels.as_raw();
    let colour_at = |column: usize, row: usize| {
        let at = row * stride + column * channels;
        P::from_slice(&samples[at..at + channels]).to_rgb().0.map(Into::<f32>::into)
    };
    let reads = (px_per_cell.ceil() as u32).clamp(1, READS);
    let [columns, rows] =
        [(centre[0], width), (centre[1], height)].map(|(centre, extent)| places(centre, px_per_cell, reads, extent));
    let mut colours = Vec::with_capacity(SIDE * SIDE);
    let mut inside = Vec::with_capacity(SIDE * SIDE);
    for row in &rows {
        for column in &columns {
            inside.push(column.inside && row.inside);
            let mut sum = f32x4::ZERO;
            let mut add = |[r, g, b]: [f32; 3], weight: f32| sum += f32x4::splat(weight) * f32x4::new([r, g, b, 0.0]);
            if reads == 1 {
                // Enlarged: between the four pixels around.
                let ([left, right, _], [top, below, _]) = (column.pixels, row.pixels);
                let (fx, fy) = (column.fraction, row.fraction);
                add(colour_at(left, top), (1.0 - fx) * (1.0 - fy));
                add(colour_at(right, top), fx * (1.0 - fy));
                add(colour_at(left, below), (1.0 - fx) * fy);
                add(colour_at(right, below), fx * fy);
            } else {
                let weight = 1.0 / (reads * reads) as f32;
                for &y in &row.pixels[..reads as usize] {
                    for &x in &column.pixels[..reads as usize] {
                        add(colour_at(x, y), weight);
                    }
                }
            }
            let [r, g, b, _] = (sum * f32x4::splat(unit)).to_array();
            colours.push([0.25 * r + 0.5 * g + 0.25 * b, COLOUR_WEIGHT * (r - g), COLOUR_WEIGHT * (g - b)]);
        }
    }
    (colours, inside)
}

/// Where a column or row of cells lies on the photograph.
struct Place {
    /// The pixels that are read; where cells are smaller than pixels, the two around.
    pixels: [usize; READS as usize],
    /// How far it lies from the first of two.
    fraction: f32,
    /// Whether it lies on the photograph.
    inside: bool,
}

fn places(centre: f64, px_per_cell: f64, reads: u32, extent: f64) -> Vec<Place> {
    // Nearest pixel; `round` would be a library call a pixel.
    let nearest = |at: f64| (at + 0.5).clamp(0.0, extent - 0.5) as usize;
    let place = |cell: usize| {
        let at = centre + (cell as f64 - HALF as f64) * px_per_cell;
        let offset = |k: u32| ((f64::from(k) + 0.5) / f64::from(reads) - 0.5) * px_per_cell;
        let first = at.floor();
        Place {
            pixels: std::array::from_fn(|k| nearest(if reads == 1 { first + k as f64 } else { at + offset(k as u32) })),
            fraction: (at - first) as f32,
            inside: at >= -0.5 && at < extent - 0.5,
        }
    };
    (0..SIDE).map(place).collect()
}

/// The taps of [`BLUR`].
static KERNEL: LazyLock<[f32; 5]> = LazyLock::new(|| {
    let taps = [2.0_f32, 1.0, 0.0, 1.0, 2.0].map(|x| (-x.powi(2) / (2.0 * BLUR.powi(2))).exp());
    taps.map(|tap| tap / taps.iter().sum::<f32>())
});
