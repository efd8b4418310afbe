//! Photograph to nail frame: the normalized picture (section 4.2.2, Fig. 53).
//!
//! In: an upright photograph and a [`NailFrame`]. Out: `size` x `size` values, fractions of full scale, distal end at
//! the top, `margin` times the nail's box: row i, column j lies at ((j + 0.5 - size/2), (size/2 - i - 0.5)) /
//! (size / margin) in widths and lengths from the centre. NaN where the photograph does not show the place.
//!
//! Where an output pixel covers up to 1.25 pixels of the photograph, the value is interpolated at its centre, by
//! cubic convolution (Keys 1981, DOI 10.1109/TASSP.1981.1163711, a = -1/2), limited to the range of the four pixels around
//! so that an edge never rings. Where it covers more, it is the mean of a grid of such samples over its footprint, at
//! least one a (block of) pixel(s) of the photograph, so that nothing aliases.

use super::frame::NailFrame;
use super::plane::{Channel, Plane, Taking};
use image::DynamicImage;

/// How values between pixels come about; `tradeoff photos` shows what each costs and gives.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Resample {
    /// The nearest pixel, whatever the scale: what cropping by hand does; aliases.
    Nearest,
    /// Between the four pixels around; averages the footprint.
    Linear,
    /// Cubic convolution without overshoot; averages the footprint.
    #[default]
    Cubic,
}

/// What a normalized picture is made with. Checked by [`Normalization::new`].
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Normalization {
    /// Width and height of the result, pixels.
    pub size: usize,
    /// Side of the result in nail boxes; 1.25 shows an eighth of the nail's size around it.
    pub margin: f64,
    /// Which channel of a colour photograph.
    pub channel: Channel,
    /// Undo the sRGB curve first.
    pub linear: bool,
    /// How values between pixels come about.
    pub resample: Resample,
}

impl Default for Normalization {
    /// The thesis' 400 x 400 pixels of 125 % of the nail, green as encoded.
    fn default() -> Self {
        Self { size: 400, margin: 1.25, channel: Channel::Green, linear: false, resample: Resample::Cubic }
    }
}

impl Normalization {
    /// Sizes that make sense, pixels.
    pub const SIZES: std::ops::RangeInclusive<usize> = 8..=4096;
    /// Margins that make sense, in nail boxes.
    pub const MARGINS: std::ops::RangeInclusive<f64> = 1.0..=5.0;

    /// Checks the numbers.
    ///
    /// # Errors
    /// A sentence that names what is out of range and the range.
    pub fn check(self) -> Result<Self, String> {
        if !Self::SIZES.contains(&self.size) {
            return Err(format!("a size of {} px is outside of {}..={}", self.size, Self::SIZES.start(), Self::SIZES.end()));
        }
        if !Self::MARGINS.contains(&self.margin) {
            return Err(format!(
                "a margin of {} nail boxes is outside of {}..={} (1.25 is 125 %)",
                self.margin,
                Self::MARGINS.start(),
                Self::MARGINS.end()
            ));
        }
        Ok(self)
    }
}

/// A normalized picture; NaN where the photograph does not show the place.
#[derive(Debug, Clone, PartialEq)]
pub struct Normalized {
    /// Width and height, pixels.
    pub size: usize,
    /// Row by row from the top (distal), fractions of full scale.
    pub values: Vec<f32>,
}

/// Brings a nail into its frame.
pub fn normalize(image: &DynamicImage, frame: &NailFrame, with: &Normalization) -> Normalized {
    let grid = Grid::new(frame, with);
    let size = with.size;
    let mut values = Vec::with_capacity(size * size);
    let Some(source) = Source::new(image, &grid, with) else {
        return Normalized { size, values: vec![f32::NAN; size * size] };
    };
    let inside = grid.lies_within(&source);
    for row in 0..size {
        for column in 0..size {
            values.push(source.mean(grid.corner(row, column), &grid, inside));
        }
    }
    Normalized { size, values }
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

/// Up to here an output pixel's centre stands for all of it; beyond, its footprint is averaged.
const POINT_SAMPLED_UP_TO_PX: f64 = 1.25;
/// Samples an axis of a footprint after the photograph was reduced by whole blocks.
const SAMPLES_KEPT: f64 = 3.0;

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

    /// Lowest and highest photograph coordinates touched.
    fn bounds(&self) -> ([f64; 2], [f64; 2]) {
        let corners = [(0, 0), (0, self.size), (self.size, 0), (self.size, self.size)].map(|(r, c)| self.corner(r, c));
        let low = [0, 1].map(|k| corners.iter().map(|c| c[k]).fold(f64::INFINITY, f64::min));
        let high = [0, 1].map(|k| corners.iter().map(|c| c[k]).fold(f64::NEG_INFINITY, f64::max));
        (low, high)
    }

    fn lies_within(&self, source: &Source) -> bool {
        let (low, high) = self.bounds();
        (0..2).all(|k| low[k] >= -0.5 && high[k] <= source.photo_end[k])
    }
}

/// The part of the photograph that the grid needs, reduced by whole blocks where it covers many pixels.
struct Source {
    width: usize,
    height: usize,
    values: Vec<f32>,
    /// Photograph coordinates of the centre of `values[0]`, and their distance.
    first: [f64; 2],
    spacing: f64,
    /// Photograph coordinates end here (width - 0.5, height - 0.5).
    photo_end: [f64; 2],
    /// Samples a footprint across and along.
    samples: [usize; 2],
    resample: Resample,
}

/// Neighbours that a cubic needs on either side, pixels.
const REACH: f64 = 3.0;

impl Source {
    /// `None` where the grid lies wholly outside of the photograph.
    fn new(image: &DynamicImage, grid: &Grid, with: &Normalization) -> Option<Self> {
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
        let range = [0, 1].map(|k| {
            let start = (low[k].max(-0.5) - reach).floor() as i64;
            let end = (high[k].min(photo_end[k]) + reach).ceil() as i64 + 1;
            let whole = (end - start + factor as i64 - 1) / factor as i64 * factor as i64;
            [start, start + whole]
        });
        let plane = Plane::take(image, Taking { channel: with.channel, linear: with.linear }, range[0], range[1]);
        let middle = (factor - 1) as f64 / 2.0;
        let first = [plane.x0 as f64 + middle, plane.y0 as f64 + middle];
        let (width, height) = (plane.width / factor, plane.height / factor);
        let values = if factor == 1 { plane.values } else { plane.reduce(factor) };
        let samples = grid.covers.map(|covers| match with.resample {
            Resample::Nearest => 1,
            _ if covers <= POINT_SAMPLED_UP_TO_PX => 1,
            _ => (covers / factor as f64).ceil() as usize,
        });
        Some(Self { width, height, values, first, spacing: factor as f64, photo_end, samples, resample: with.resample })
    }

    /// The mean over the output pixel whose outer corner is `corner`; NaN where part of it is not seen.
    fn mean(&self, corner: [f64; 2], grid: &Grid, inside: bool) -> f32 {
        let [across, along] = self.samples;
        let mut sum = 0.0;
        for row in 0..along {
            let r = (row as f64 + 0.5) / along as f64;
            for column in 0..across {
                let c = (column as f64 + 0.5) / across as f64;
                let place = [0, 1].map(|k| corner[k] + grid.per_column[k] * c + grid.per_row[k] * r);
                if !inside && (0..2).any(|k| !(place[k] >= -0.5 && place[k] <= self.photo_end[k])) {
                    return f32::NAN;
                }
                sum += self.at(place);
            }
        }
        sum / (across * along) as f32
    }

    fn at(&self, place: [f64; 2]) -> f32 {
        let x = (place[0] - self.first[0]) / self.spacing;
        let y = (place[1] - self.first[1]) / self.spacing;
        match self.resample {
            Resample::Nearest => self.values[(y.round() as usize) * self.width + x.round() as usize],
            Resample::Linear => {
                let (rows, fx, fy) = self.neighbours::<2>(x, y, 0);
                let line = |row: &[f32; 2]| row[0] + (row[1] - row[0]) * fx;
                line(&rows[0]) + (line(&rows[1]) - line(&rows[0])) * fy
            }
            Resample::Cubic => {
                let (rows, fx, fy) = self.neighbours::<4>(x, y, 1);
                let (wx, wy) = (cubic_weights(fx), cubic_weights(fy));
                let mut columns = [0.0_f32; 4];
                for (row, weight) in rows.iter().zip(wy) {
                    for k in 0..4 {
                        columns[k] += row[k] * weight;
                    }
                }
                let value = columns[0] * wx[0] + columns[1] * wx[1] + columns[2] * wx[2] + columns[3] * wx[3];
                let [low, high] = [
                    rows[1][1].min(rows[1][2]).min(rows[2][1].min(rows[2][2])),
                    rows[1][1].max(rows[1][2]).max(rows[2][1].max(rows[2][2])),
                ];
                // Not `clamp`: it panics on NaN limits, and a NaN value has to stay one.
                if value < low {
                    low
                } else if value > high {
                    high
                } else {
                    value
                }
            }
        }
    }

    /// The N x N values around (x, y), the first `before` columns and rows ahead of its own, and where between them it is.
    fn neighbours<const N: usize>(&self, x: f64, y: f64, before: usize) -> ([[f32; N]; N], f32, f32) {
        let (column, row) = (x.floor(), y.floor());
        let start_x = (column as usize).saturating_sub(before).min(self.width - N);
        let start_y = (row as usize).saturating_sub(before).min(self.height - N);
        let mut rows = [[0.0_f32; N]; N];
        for (k, line) in rows.iter_mut().enumerate() {
            let at = (start_y + k) * self.width + start_x;
            line.copy_from_slice(&self.values[at..at + N]);
        }
        (rows, (x - column) as f32, (y - row) as f32)
    }
}

/// Keys' cubic convolution with a = -1/2 at `t` within 0..1 after the second of four equally spaced values.
fn cubic_weights(t: f32) -> [f32; 4] {
    let (t2, t3) = (t * t, t * t * t);
    [0.5 * (2.0 * t2 - t3 - t), 0.5 * (3.0 * t3 - 5.0 * t2 + 2.0), 0.5 * (4.0 * t2 - 3.0 * t3 + t), 0.5 * (t3 - t2)]
}
