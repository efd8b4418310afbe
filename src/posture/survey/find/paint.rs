//! What makes a sample one of a marker's colour.

use crate::posture::survey::find::grid::Grid;
use crate::video::{Frame, Matrix};

/// Levels of a full share of the colour: a sample just as far from grey as the marker file says has this level.
pub(super) const FULL_LEVEL: f32 = 64.0;
/// Samples with a smaller share of the colour's distance from grey are not looked at.
const FLOOR_SHARE: f32 = 0.2;
/// Colours nearer to grey than this, on the scale of 8 bits, are looked for in luma.
const CHROMATIC: f64 = 14.0;
/// A colour seen is taken to be at least so far from grey (or black, or white), to stay within numbers.
const LEAST_DISTANCE: f64 = 6.0;
/// A sample's hue may differ by this (tangent) for free: white balance, shade and clipping turn it.
const HUE_TANGENT: f32 = 0.3;
/// What stands out by less than this, on the scale of 8 bits, is noise.
const LEAST_STEP: f32 = 4.0;
/// ... or by less than this share of the colour's distance from grey.
const LEAST_SHARE: f32 = 0.1;

/// A marker's colour as the planes show it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Paint {
    /// Y', Cb and Cr as the marker file has them.
    pub(crate) colour: [f64; 3],
    kind: Kind,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    /// Unit vector in (Cb, Cr) from `zero` (grey, or a surround's colour, less 128), and the distance from there.
    Chromatic {
        along: [f32; 2],
        distance: f32,
        zero: [f32; 2],
    },
    Dark {
        distance: f32,
    },
    Bright {
        distance: f32,
    },
}

impl Paint {
    /// The paint of an sRGB colour in a video of this matrix; `grey` if it has no chroma planes.
    pub(crate) fn new(colour: [u8; 3], matrix: &Matrix, grey: bool) -> Self {
        let colour = matrix.from_rgb(colour.map(|part| f64::from(part) / 255.0));
        let [luma, cb, cr] = [colour[0], colour[1] - 128.0, colour[2] - 128.0];
        let distance = cb.hypot(cr);
        let kind = if distance >= CHROMATIC && !grey {
            let along = [(cb / distance) as f32, (cr / distance) as f32];
            Kind::Chromatic { along, distance: distance as f32, zero: [0.0; 2] }
        } else if luma < 128.0 {
            Kind::Dark { distance: (255.0 - luma) as f32 }
        } else {
            Kind::Bright { distance: luma as f32 }
        };
        Self { colour, kind }
    }

    /// The paint of a direction in (Cb, Cr), as long as its distance from grey.
    pub(crate) fn chromatic([cb, cr]: [f64; 2]) -> Self {
        let distance = cb.hypot(cr).max(LEAST_DISTANCE);
        let along = [(cb / distance) as f32, (cr / distance) as f32];
        let kind = Kind::Chromatic { along, distance: distance as f32, zero: [0.0; 2] };
        Self { colour: [128.0, 128.0 + cb, 128.0 + cr], kind }
    }

    /// The same paint with the colour that a video shows of it, in its own samples.
    pub(crate) fn seen_as(&self, colour: [f64; 3]) -> Self {
        let kind = match self.kind {
            Kind::Chromatic { .. } => Self::chromatic([colour[1] - 128.0, colour[2] - 128.0]).kind,
            Kind::Dark { .. } => Kind::Dark { distance: (255.0 - colour[0]).max(LEAST_DISTANCE) as f32 },
            Kind::Bright { .. } => Kind::Bright { distance: colour[0].max(LEAST_DISTANCE) as f32 },
        };
        Self { colour, kind }
    }

    /// The cosine between the way from a surround's colour to a mark's and that to this paint's: in chroma, or in luma
    /// for a paint without any.
    pub(crate) fn parts(&self, mark: [f64; 3], surround: [f64; 3]) -> f64 {
        let planes = if self.is_chromatic() { 1..3 } else { 0..1 };
        let (mut dot, mut seen, mut meant) = (0.0, 0.0, 0.0);
        for p in planes {
            let (a, b) = (mark[p] - surround[p], self.colour[p] - surround[p]);
            (dot, seen, meant) = (dot + a * b, seen + a * a, meant + b * b);
        }
        dot / (seen * meant).sqrt().max(1e-9)
    }

    /// The same paint with the colour that a video shows of it on a surround: what is neither, as a paler or darker
    /// stroke, is judged by its way from the surround's colour, not from grey.
    pub(crate) fn seen_on(&self, colour: [f64; 3], surround: [f64; 3]) -> Self {
        let Kind::Chromatic { .. } = self.kind else { return self.seen_as(colour) };
        let Self { kind, .. } = Self::chromatic([colour[1] - surround[1], colour[2] - surround[2]]);
        let kind = match kind {
            Kind::Chromatic { along, distance, .. } => {
                let zero = [surround[1] - 128.0, surround[2] - 128.0].map(|part| part as f32);
                Kind::Chromatic { along, distance, zero }
            }
            other => other,
        };
        Self { colour, kind }
    }

    /// Cb and Cr that its shares are counted from.
    pub(crate) fn zero(&self) -> [f64; 2] {
        match self.kind {
            Kind::Chromatic { zero, .. } => zero.map(|part| 128.0 + f64::from(part)),
            _ => [128.0; 2],
        }
    }

    /// Whether it is looked for in the chroma planes.
    pub(crate) fn is_chromatic(&self) -> bool {
        matches!(self.kind, Kind::Chromatic { .. })
    }

    /// Whether one may be taken for the other: both are looked for in luma alike, or in directions within `within_rad`.
    pub(crate) fn is_like(&self, other: &Self, within_rad: f64) -> bool {
        match (self.kind, other.kind) {
            (Kind::Chromatic { along: [a, b], .. }, Kind::Chromatic { along: [c, d], .. }) => {
                f64::from((a * d - b * c).atan2(a * c + b * d)).abs() < within_rad
            }
            (Kind::Dark { .. }, Kind::Dark { .. }) | (Kind::Bright { .. }, Kind::Bright { .. }) => true,
            _ => false,
        }
    }

    pub(super) fn least_contrast(&self) -> f32 {
        let (Kind::Chromatic { distance, .. } | Kind::Dark { distance } | Kind::Bright { distance }) = self.kind;
        (FULL_LEVEL * LEAST_SHARE).max(FULL_LEVEL * LEAST_STEP / distance)
    }

    /// Each grid sample's level of this colour, 0 where it has none of it.
    pub(super) fn levels(&self, grid: &mut Grid, frame: &Frame<'_>) {
        if !self.is_chromatic() {
            grid.load_luma(frame);
        }
        let Grid { cb, cr, luma, levels, .. } = grid;
        levels.clear();
        match self.kind {
            Kind::Chromatic { along, distance, zero: [u, v] } => {
                let samples = cb.iter().zip(cr.iter());
                levels.extend(samples.map(|(&cb, &cr)| quantized(chromatic(along, distance, cb - u, cr - v))));
            }
            Kind::Dark { distance } | Kind::Bright { distance } => {
                let (sign, zero) = self.grey_line();
                let scale = FULL_LEVEL / distance;
                if cb.is_empty() {
                    levels.extend(luma.iter().map(|&luma| quantized(scale * (zero + sign * luma))));
                } else {
                    levels.extend(luma.iter().zip(cb.iter().zip(cr.iter())).map(|(&luma, (&cb, &cr))| {
                        let coloured = (cb.abs() + cr.abs() - 16.0).max(0.0);
                        quantized(scale * (zero + sign * luma - 2.0 * coloured))
                    }));
                }
            }
        }
    }

    /// How many samples, one every `pitch_px` luma samples across and down, have at least `share` of the colour.
    pub(crate) fn count(&self, frame: &Frame<'_>, pitch_px: f64, share: f64) -> usize {
        let (across, down) = frame.subsampling();
        let least = FULL_LEVEL * share as f32;
        let step = |samples: usize| ((pitch_px / samples as f64) as usize).max(1);
        match (self.kind, frame.chroma) {
            (Kind::Chromatic { along, distance, zero: [u, v] }, Some([cb, cr])) => {
                let (u, v) = (128.0 + u, 128.0 + v);
                let rows = (step(down) / 2..cb.height).step_by(step(down));
                rows.map(|y| {
                    (step(across) / 2..cb.width)
                        .step_by(step(across))
                        .filter(|&x| chromatic(along, distance, cb.sample(x, y) - u, cr.sample(x, y) - v) >= least)
                        .count()
                })
                .sum()
            }
            (Kind::Chromatic { .. }, None) => 0,
            (Kind::Dark { distance } | Kind::Bright { distance }, _) => {
                let (sign, zero) = self.grey_line();
                let scale = FULL_LEVEL / distance;
                let rows = (step(1) / 2..frame.luma.height).step_by(step(1));
                rows.map(|y| {
                    (step(1) / 2..frame.luma.width)
                        .step_by(step(1))
                        .filter(|&x| scale * (zero + sign * frame.luma.sample(x, y)) >= least)
                        .count()
                })
                .sum()
            }
        }
    }

    /// Levels without colour grow as `zero + sign * luma`.
    fn grey_line(&self) -> (f32, f32) {
        if matches!(self.kind, Kind::Dark { .. }) { (-1.0, 255.0) } else { (1.0, 0.0) }
    }
}

fn quantized(level: f32) -> u8 {
    if level < FULL_LEVEL * FLOOR_SHARE { 0 } else { level.min(127.0) as u8 }
}

/// The level of a sample, Cb and Cr less 128.
fn chromatic([u, v]: [f32; 2], distance: f32, cb: f32, cr: f32) -> f32 {
    let along = u * cb + v * cr;
    let across = (u * cr - v * cb).abs();
    FULL_LEVEL / distance * (along - 2.0 * (across - HUE_TANGENT * along.abs() - 1.0).max(0.0))
}
