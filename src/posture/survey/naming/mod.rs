//! Which spot of a frame is which marker.

mod chain;
mod cost;

pub(crate) use chain::Chain;
pub(crate) use cost::{LENGTH_FREE_PX, LENGTH_SHARE, MISSING, Naming, Scene, colour_cost, rigid_cost};

use crate::posture::layout::Layout;
use crate::posture::survey::find::Blob;

/// The best naming is taken if it is cheaper by this than any other.
pub(crate) const MARGIN: f64 = 3.0;

/// A spot in a frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Point {
    pub(crate) frame: u64,
    pub(crate) at_px: [f64; 2],
    pub(crate) radius_px: f64,
    pub(crate) contrast: f64,
    pub(crate) colour: [f64; 3],
}

impl Point {
    pub(crate) fn new(frame: u64, blob: &Blob) -> Self {
        Self { frame, at_px: blob.at_px, radius_px: blob.radius_px(), contrast: blob.contrast, colour: blob.colour }
    }
}

/// For each marker of a layout, whether it is on no segment.
pub(crate) fn lone(layout: &Layout) -> Vec<bool> {
    let on_one = |marker| layout.segments.iter().any(|segment| segment.markers.contains(&marker));
    (0..layout.markers.len()).map(|marker| !on_one(marker)).collect()
}
