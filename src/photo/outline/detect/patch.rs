//! A square look at one place: the photograph turned and scaled into a finger's (or nail's) own frame.
//!
//! In a [`Frame`] x runs to the right and y *up*, towards the distal end, in units of the frame (a finger's width, a
//! nail's half length, ...); a [`Patch`] holds the channels sampled on that frame, blurred to its own resolution.

use super::picture::{Levels, Picture, between};
use crate::vision::{Cell, smoothed};

/// An origin, a direction and a unit on the source picture.
#[derive(Debug, Clone, Copy)]
pub struct Frame {
    /// Origin, source pixels.
    pub origin: [f64; 2],
    /// Unit vector of +y (distal) on the source picture.
    pub up: [f64; 2],
    /// Source pixels a unit.
    pub unit_px: f64,
}

impl Frame {
    /// Frame to source pixels.
    pub fn to_source(self, p: [f64; 2]) -> [f64; 2] {
        let [ux, uy] = self.up;
        let (x, y) = (p[0] * self.unit_px, p[1] * self.unit_px);
        [self.origin[0] - uy * x + ux * y, self.origin[1] + ux * x + uy * y]
    }

    /// Source pixels to frame.
    pub fn source_to_own(&self, p: [f64; 2]) -> [f64; 2] {
        let [ux, uy] = self.up;
        let (x, y) = (p[0] - self.origin[0], p[1] - self.origin[1]);
        [(-uy * x + ux * y) / self.unit_px, (ux * x + uy * y) / self.unit_px]
    }
}

/// The part of a frame that a patch covers.
#[derive(Debug, Clone, Copy)]
pub struct Extent {
    /// Left and right end.
    pub x: [f64; 2],
    /// Lower and upper end.
    pub y: [f64; 2],
    /// Samples a unit.
    pub per_unit: f64,
}

/// Channels sampled on a frame; row 0 is the upper end.
#[derive(Debug, Clone)]
pub struct Patch {
    /// Where it lies.
    pub frame: Frame,
    /// What it covers.
    pub extent: Extent,
    /// Columns and rows.
    pub size: [usize; 2],
    /// Row by row.
    pub cells: Vec<Cell>,
    /// Whether there is more than tone.
    pub colour: bool,
}

impl Patch {
    /// Samples `extent` of `frame` from the level of its resolution.
    pub fn cut(levels: &Levels, frame: Frame, extent: Extent) -> Self {
        Self::of(levels.resolving(frame.unit_px / extent.per_unit), frame, extent)
    }

    /// Samples `extent` of `frame` from a picture.
    pub fn of(picture: &Picture, frame: Frame, extent: Extent) -> Self {
        let size = [extent.x, extent.y].map(|e| ((e[1] - e[0]) * extent.per_unit).round() as usize + 1);
        let mut cells = Vec::with_capacity(size[0] * size[1]);
        let start = picture.source_to_own(frame.to_source([extent.x[0], extent.y[1]])).map(|v| v as f32);
        let d = frame.unit_px / extent.per_unit / picture.step;
        let right = [-frame.up[1] * d, frame.up[0] * d].map(|v| v as f32);
        let down = [-frame.up[0] * d, -frame.up[1] * d].map(|v| v as f32);
        for j in 0..size[1] {
            let row = [start[0] + j as f32 * down[0], start[1] + j as f32 * down[1]];
            for i in 0..size[0] {
                let at = [row[0] + i as f32 * right[0], row[1] + i as f32 * right[1]];
                cells.push(between(&picture.cells, picture.size, at));
            }
        }
        let cells = smoothed(&cells, size, KERNEL);
        Self { frame, extent, size, cells, colour: picture.colour }
    }

    /// The sample nearest to a point of the frame, held at the border.
    pub fn at(&self, x: f32, y: f32) -> Cell {
        let scale = self.extent.per_unit as f32;
        let i = ((x - self.extent.x[0] as f32) * scale + 0.5).max(0.0) as usize;
        let j = ((self.extent.y[1] as f32 - y) * scale + 0.5).max(0.0) as usize;
        self.cells[j.min(self.size[1] - 1) * self.size[0] + i.min(self.size[0] - 1)]
    }
}

/// Binomial: SD of one sample.
const KERNEL: [f32; 5] = [0.0625, 0.25, 0.375, 0.25, 0.0625];

#[cfg(test)]
mod tests {
    use image::{DynamicImage, GrayImage, Luma};

    use super::*;

    #[test]
    fn a_patch_shows_its_frame() {
        // Up on the frame is right on the picture.
        let frame = Frame { origin: [60.0, 40.0], up: [1.0, 0.0], unit_px: 20.0 };
        let p = frame.to_source([0.5, 1.0]);
        assert!((p[0] - 80.0).abs() <= 1e-12 && (p[1] - 50.0).abs() <= 1e-12, "{p:?}");
        let back = frame.source_to_own(p);
        assert!((back[0] - 0.5).abs() <= 1e-12 && (back[1] - 1.0).abs() <= 1e-12);

        let image = GrayImage::from_fn(120, 80, |x, _| Luma([if x > 60 { 200 } else { 50 }]));
        let levels = Levels::of(&DynamicImage::ImageLuma8(image), 120);
        let patch = Patch::cut(&levels, frame, Extent { x: [-1.0, 1.0], y: [-1.0, 1.0], per_unit: 20.0 });
        assert!(!patch.colour);
        let [distal, proximal] = [0.8, -0.8].map(|y| patch.at(0.0, y)[0]);
        assert!((distal - (200.0f32 / 255.0 + 0.02).ln()).abs() <= 1e-4, "{distal}");
        assert!((proximal - (50.0f32 / 255.0 + 0.02).ln()).abs() <= 1e-4, "{proximal}");
    }
}
