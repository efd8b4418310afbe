//! A square look at one place: the photograph turned and scaled into a finger's (or nail's) own frame.
//!
//! In a [`Frame`] x runs to the right and y *up*, towards the distal end, in units of the frame (a finger's width, a
//! nail's half length, ...); a [`Patch`] holds the channels sampled on that frame, blurred to its own resolution.

use image::DynamicImage;

use super::picture::{Picture, Plane, sample};

/// An origin, a direction and a unit on the source picture.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    /// Origin, source pixels.
    pub(super) origin: [f64; 2],
    /// Unit vector of +y (distal) on the source picture.
    pub(super) up: [f64; 2],
    /// Source pixels a unit.
    pub(super) unit_px: f64,
}

impl Frame {
    /// Frame to source pixels.
    pub(super) fn to_source(&self, p: [f64; 2]) -> [f64; 2] {
        let [ux, uy] = self.up;
        let (x, y) = (p[0] * self.unit_px, p[1] * self.unit_px);
        [self.origin[0] - uy * x + ux * y, self.origin[1] + ux * x + uy * y]
    }

    /// Source pixels to frame.
    pub(super) fn from_source(&self, p: [f64; 2]) -> [f64; 2] {
        let [ux, uy] = self.up;
        let (x, y) = (p[0] - self.origin[0], p[1] - self.origin[1]);
        [(-uy * x + ux * y) / self.unit_px, (ux * x + uy * y) / self.unit_px]
    }
}

/// The part of a frame that a patch covers.
#[derive(Debug, Clone, Copy)]
pub(super) struct Extent {
    /// Left and right end.
    pub(super) x: [f64; 2],
    /// Lower and upper end.
    pub(super) y: [f64; 2],
    /// Samples a unit.
    pub(super) per_unit: f64,
}

/// Channels sampled on a frame; row 0 is the upper end.
#[derive(Debug, Clone)]
pub(super) struct Patch {
    /// Where it lies.
    pub(super) frame: Frame,
    /// What it covers.
    pub(super) extent: Extent,
    /// Columns and rows.
    pub(super) size: [usize; 2],
    /// Tone, and for colour ln(R/G) and ln(G/B).
    pub(super) planes: Vec<Vec<f32>>,
    /// Whether a sample lies on the photograph.
    pub(super) seen: Vec<bool>,
}

impl Patch {
    /// Samples `extent` of `frame`, averaging source pixels down to the patch's resolution.
    pub(super) fn cut(image: &DynamicImage, frame: Frame, extent: Extent) -> Self {
        let corners = [0, 1, 2, 3].map(|k| frame.to_source([extent.x[k & 1], extent.y[k >> 1]]));
        let low = |i: usize| corners.iter().map(|c| c[i]).fold(f64::INFINITY, f64::min);
        let high = |i: usize| corners.iter().map(|c| c[i]).fold(f64::NEG_INFINITY, f64::max);
        let step = ((frame.unit_px / extent.per_unit) as u32).max(1);
        let margin = f64::from(2 * step);
        let from = [0, 1].map(|i| (low(i) - margin).floor().max(0.0) as u32);
        let to = [0, 1].map(|i| (high(i) + margin).ceil().max(0.0) as u32);
        let picture = Picture::part(
            image,
            [from[0], from[1], to[0].saturating_sub(from[0]), to[1].saturating_sub(from[1])],
            step,
        );
        Self::of(&picture, [f64::from(image.width()), f64::from(image.height())], frame, extent)
    }

    /// Samples `extent` of `frame` from a working picture of a source of `source_px`.
    pub(super) fn of(picture: &Picture, source_px: [f64; 2], frame: Frame, extent: Extent) -> Self {
        let size = [extent.x, extent.y].map(|e| ((e[1] - e[0]) * extent.per_unit).round() as usize + 1);
        let channels: Vec<&Plane> = std::iter::once(&picture.tone).chain(picture.chroma.iter().flatten()).collect();
        let mut planes = vec![Vec::with_capacity(size[0] * size[1]); channels.len()];
        let mut seen = Vec::with_capacity(size[0] * size[1]);
        for j in 0..size[1] {
            for i in 0..size[0] {
                let p = frame.to_source([
                    extent.x[0] + i as f64 / extent.per_unit,
                    extent.y[1] - j as f64 / extent.per_unit,
                ]);
                let q = picture.from_source(p);
                for (plane, channel) in planes.iter_mut().zip(&channels) {
                    plane.push(sample(channel, q[0], q[1]));
                }
                let on = |i: usize| p[i] > -0.5 && p[i] < source_px[i] - 0.5;
                seen.push(on(0) && on(1));
            }
        }
        for plane in &mut planes {
            smooth(plane, size);
        }
        Self { frame, extent, size, planes, seen }
    }

    /// Index of the sample nearest to a point of the frame, held at the border.
    pub(super) fn index(&self, x: f64, y: f64) -> usize {
        let i = ((x - self.extent.x[0]) * self.extent.per_unit + 0.5).max(0.0) as usize;
        let j = ((self.extent.y[1] - y) * self.extent.per_unit + 0.5).max(0.0) as usize;
        j.min(self.size[1] - 1) * self.size[0] + i.min(self.size[0] - 1)
    }
}

impl Patch {
    /// Value of a plane between samples, linearly; held at the border.
    pub(super) fn between(&self, plane: &[f32], x: f64, y: f64) -> f32 {
        let [w, h] = self.size;
        let px = ((x - self.extent.x[0]) * self.extent.per_unit).clamp(0.0, (w - 1) as f64);
        let py = ((self.extent.y[1] - y) * self.extent.per_unit).clamp(0.0, (h - 1) as f64);
        let (i, j) = (px as usize, py as usize);
        let (fx, fy) = ((px - i as f64) as f32, (py - j as f64) as f32);
        let (i1, j1) = ((i + 1).min(w - 1), (j + 1).min(h - 1));
        let top = plane[j * w + i] * (1.0 - fx) + plane[j * w + i1] * fx;
        let low = plane[j1 * w + i] * (1.0 - fx) + plane[j1 * w + i1] * fx;
        top * (1.0 - fy) + low * fy
    }
}

/// Binomial blur (1 4 6 4 1)/16 both ways: SD of one sample.
fn smooth(plane: &mut [f32], size: [usize; 2]) {
    let [w, h] = size;
    let kernel = |a: f32, b: f32, c: f32, d: f32, e: f32| (a + 4.0 * b + 6.0 * c + 4.0 * d + e) / 16.0;
    let mut line = vec![0.0f32; w];
    for row in plane.chunks_exact_mut(w) {
        for (i, out) in line.iter_mut().enumerate() {
            let at = |k: isize| row[(i as isize + k).clamp(0, w as isize - 1) as usize];
            *out = kernel(at(-2), at(-1), at(0), at(1), at(2));
        }
        row.copy_from_slice(&line);
    }
    let copy = plane.to_vec();
    for j in 0..h {
        let at = |k: isize| (j as isize + k).clamp(0, h as isize - 1) as usize * w;
        let rows = [at(-2), at(-1), at(0), at(1), at(2)];
        for i in 0..w {
            let [a, b, c, d, e] = rows.map(|r| copy[r + i]);
            plane[j * w + i] = kernel(a, b, c, d, e);
        }
    }
}
