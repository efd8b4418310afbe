//! The samples that a search looks at: chroma less grey, thinned out in large pictures, smoothed a little.

use crate::posture::survey::find::Blob;
use crate::video::{Frame, Plane};
use crate::vision::smoothed;

/// A grid has at most this many samples; larger planes are averaged over blocks.
const MOST_SAMPLES: usize = 600_000;

/// A part of the stored picture, in luma samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Area {
    pub(crate) left: f64,
    pub(crate) top: f64,
    pub(crate) right: f64,
    pub(crate) bottom: f64,
}

impl Area {
    /// The square with half its side `reach_px` about a point.
    pub(crate) fn about([x, y]: [f64; 2], reach_px: f64) -> Self {
        Self { left: x - reach_px, top: y - reach_px, right: x + reach_px, bottom: y + reach_px }
    }
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Spot {
    pub(super) at: [f64; 2],
    pub(super) area: f64,
    /// Central second moments: xx, xy, yy.
    pub(super) moments: [f64; 3],
    /// Levels from the core to the ground.
    pub(super) contrast: f32,
    /// It touches the grid's left, top, right, bottom side.
    pub(super) touches: [bool; 4],
}

/// Samples on a grid. With chroma planes their grid (or a coarser one), else luma's.
#[derive(Debug, Default)]
pub(super) struct Grid {
    pub(super) width: usize,
    pub(super) height: usize,
    /// Cb and Cr less 128; empty in grey video.
    pub(super) cb: Vec<f32>,
    pub(super) cr: Vec<f32>,
    /// Luma on the same grid, where it was needed.
    pub(super) luma: Vec<f32>,
    /// What a search looks for; see [`crate::posture::survey::find::Paint`].
    pub(super) levels: Vec<u8>,
    /// Samples that the whole picture would have.
    pub(super) samples_of_picture: usize,
    /// Grid sample (0, 0) begins at this luma sample.
    origin: [usize; 2],
    /// Luma samples from one grid sample to the next.
    pitch: [usize; 2],
    /// Plane samples averaged, across and down, for one grid sample.
    block: usize,
    /// The sides of the grid (left, top, right, bottom) that are the picture's.
    borders: [bool; 4],
    row: Vec<f32>,
}

impl Grid {
    pub(super) fn load(&mut self, frame: &Frame<'_>, area: Option<Area>) {
        let (across, down) = frame.subsampling();
        let plane = frame.chroma.map_or(frame.luma, |[cb, _]| cb);
        let clipped = |low: f64, high: f64, pitch: usize, size: usize| {
            let cell = |at: f64| ((at + 0.5) / pitch as f64).floor().clamp(0.0, size as f64) as usize;
            (cell(low), (cell(high) + 1).min(size))
        };
        let (mut x, mut y) = area.map_or(((0, plane.width), (0, plane.height)), |area| {
            (clipped(area.left, area.right, across, plane.width), clipped(area.top, area.bottom, down, plane.height))
        });
        let samples = (x.1 - x.0.min(x.1)) * (y.1 - y.0.min(y.1));
        self.block = (1..).find(|block| samples / (block * block) <= MOST_SAMPLES).unwrap_or(1);
        self.samples_of_picture = plane.width * plane.height / (self.block * self.block);
        self.borders = [x.0 == 0, y.0 == 0, x.1 == plane.width, y.1 == plane.height];
        x.1 = x.0 + (x.1 - x.0.min(x.1)) / self.block * self.block;
        y.1 = y.0 + (y.1 - y.0.min(y.1)) / self.block * self.block;
        (self.width, self.height) = ((x.1 - x.0) / self.block, (y.1 - y.0) / self.block);
        self.origin = [x.0 * across, y.0 * down];
        self.pitch = [across * self.block, down * self.block];
        self.luma.clear();
        self.cb.clear();
        self.cr.clear();
        if let Some([cb, cr]) = frame.chroma {
            let from = (x.0, y.0);
            average(&cb, from, (self.width, self.height), [self.block; 2], 128.0, &mut self.row, &mut self.cb);
            average(&cr, from, (self.width, self.height), [self.block; 2], 128.0, &mut self.row, &mut self.cr);
            let size = [self.width, self.height];
            (self.cb, self.cr) = (smooth(&self.cb, size), smooth(&self.cr, size));
        }
    }

    /// Luma averaged onto the grid, if it is not there yet.
    pub(super) fn load_luma(&mut self, frame: &Frame<'_>) {
        if self.luma.is_empty() {
            let from = (self.origin[0], self.origin[1]);
            // The last column or row of chroma of an odd size has less luma than its block: it takes the block before.
            let from = (
                from.0.min(frame.luma.width.saturating_sub(self.width * self.pitch[0])),
                from.1.min(frame.luma.height.saturating_sub(self.height * self.pitch[1])),
            );
            let size = (self.width, self.height);
            average(&frame.luma, from, size, self.pitch, 0.0, &mut self.row, &mut self.luma);
            self.luma = smooth(&self.luma, [self.width, self.height]);
        }
    }

    /// Whether a spot reaches a side of the grid that is not the picture's.
    pub(super) fn cuts(&self, spot: &Spot) -> bool {
        self.borders.iter().zip(spot.touches).any(|(&border, touches)| touches && !border)
    }

    /// A spot in the stored picture.
    pub(super) fn blob(&self, frame: &Frame<'_>, spot: &Spot) -> Blob {
        let at_px = [0, 1].map(|axis| self.origin[axis] as f64 + (spot.at[axis] + 0.5) * self.pitch[axis] as f64 - 0.5);
        // Half axes along and across, from second moments in luma samples.
        let [a, b] = self.pitch.map(|pitch| pitch as f64);
        let [xx, xy, yy] = [spot.moments[0] * a * a, spot.moments[1] * a * b, spot.moments[2] * b * b];
        let (mean, spread) = (0.5 * (xx + yy), (0.25 * (xx - yy) * (xx - yy) + xy * xy).sqrt());
        let (long, short) = ((mean + spread).max(1e-9), (mean - spread).max(1e-9));
        let area_px2 = spot.area * a * b;
        let [left, top, right, bottom] = self.borders;
        Blob {
            at_px,
            area_px2,
            contrast: f64::from(spot.contrast) / f64::from(crate::posture::survey::find::paint::FULL_LEVEL),
            elongation: (long / short).sqrt(),
            fill: area_px2 / (4.0 * std::f64::consts::PI * (long * short).sqrt()),
            colour: self.colour(frame, spot, at_px),
            at_the_border: (left && spot.touches[0])
                || (top && spot.touches[1])
                || (right && spot.touches[2])
                || (bottom && spot.touches[3]),
        }
    }

    fn colour(&self, frame: &Frame<'_>, spot: &Spot, at_px: [f64; 2]) -> [f64; 3] {
        let inside = |at: f64, size: usize| at.round().clamp(0.0, size as f64 - 1.0) as usize;
        let index = inside(spot.at[1], self.height) * self.width + inside(spot.at[0], self.width);
        let chroma = |plane: &[f32]| plane.get(index).map_or(128.0, |&value| 128.0 + f64::from(value));
        let (x, y) = (inside(at_px[0], frame.luma.width), inside(at_px[1], frame.luma.height));
        let (mut sum, mut count) = (0.0, 0.0);
        for y in y.saturating_sub(1)..(y + 2).min(frame.luma.height) {
            for x in x.saturating_sub(1)..(x + 2).min(frame.luma.width) {
                sum += f64::from(frame.luma.sample(x, y));
                count += 1.0;
            }
        }
        [sum / count, chroma(&self.cb), chroma(&self.cr)]
    }
}

/// Means over blocks of a plane from sample `from` on, less `zero`, appended to `into`.
fn average(
    plane: &Plane<'_>,
    from: (usize, usize),
    (width, height): (usize, usize),
    [across, down]: [usize; 2],
    zero: f32,
    row: &mut Vec<f32>,
    into: &mut Vec<f32>,
) {
    into.reserve(width * height);
    // A plane smaller than its blocks (odd sizes) repeats its last rows and columns.
    let columns = (width * across).min(plane.width - from.0);
    row.resize(columns, 0.0);
    let scale = 1.0 / (across * down) as f32;
    for y in 0..height {
        let start = into.len();
        into.resize(start + width, -zero);
        for line in 0..down {
            plane.copy_row((from.1 + y * down + line).min(plane.height - 1), from.0, row);
            let sums = &mut into[start..];
            if across == 1 {
                sums.iter_mut().zip(row.iter()).for_each(|(sum, &value)| *sum += scale * value);
            } else {
                let last = row[columns - 1];
                for (sum, block) in sums.iter_mut().zip(row.chunks(across)) {
                    let rest = (across - block.len()) as f32 * last;
                    *sum += scale * (block.iter().sum::<f32>() + rest);
                }
            }
        }
    }
}

fn smooth(values: &[f32], size: [usize; 2]) -> Vec<f32> {
    smoothed(values.as_chunks::<1>().0, size, [0.25, 0.5, 0.25]).into_flattened()
}
