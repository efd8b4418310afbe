//! The network's word on a digit in a crop.

use super::look::Cut;
use crate::clock::glyph::{Levels, Patch, Scores, recognise};
use crate::clock::ink::crop::Gray;
use crate::video::Plane;

/// A crop as the network looks at it.
#[derive(Debug)]
pub(in crate::clock) struct Page {
    width: usize,
    height: usize,
    bytes: Vec<u8>,
}

/// Samples of 16 bits keep the fractions of means.
const DEPTH: u32 = 16;

impl Page {
    pub(in crate::clock) fn new(gray: &Gray) -> Self {
        let deep = |&value: &f32| ((value * 256.0 + 0.5).clamp(0.0, 65_535.0) as u16).to_le_bytes();
        Self { width: gray.width, height: gray.height, bytes: gray.values.iter().flat_map(deep).collect() }
    }

    /// What the network says of the character whose ink fills this box.
    pub(in crate::clock) fn judge(&self, ink: Cut, levels: Levels) -> Scores {
        let plane =
            Plane { width: self.width, height: self.height, stride: 2 * self.width, depth: DEPTH, data: &self.bytes };
        // A cut's edges lie between samples, an ink box's zero on the first one's centre.
        let [left, top] = [ink.left, ink.top].map(|edge| f64::from(edge) - 0.5);
        let ink = [left, top, left + f64::from(ink.width), top + f64::from(ink.height)];
        recognise(&Patch::cut(&plane, ink, levels))
    }
}
