//! The multi-directional tapping task of ISO 9241-411: targets in a ring, each across from the one before.

use std::f64::consts::TAU;

use super::hand::Target;

/// Distances and widths of the targets; every pair of them is a condition.
#[derive(Debug, Clone)]
pub(super) struct Task {
    /// Targets of a ring: an odd number, 3 at least.
    pub(super) targets: usize,
    /// Diameters of the ring, px.
    pub(super) distances_px: Vec<f64>,
    /// Diameters of a target, px.
    pub(super) widths_px: Vec<f64>,
    /// A target that was not hit after so long is given up, s.
    pub(super) patience_s: f64,
}

impl Default for Task {
    /// 25 targets, 256 and 512 px apart, 24, 48 and 96 px wide: 1.9 to 4.5 bits.
    fn default() -> Self {
        Self { targets: 25, distances_px: vec![256.0, 512.0], widths_px: vec![24.0, 48.0, 96.0], patience_s: 30.0 }
    }
}

impl Task {
    /// Whether each target is across from the one before and all are visited.
    pub(super) fn can_be_walked(&self) -> bool {
        self.targets >= 3 && self.targets % 2 == 1
    }

    /// The centres in the order in which they are to be hit, px from the ring's centre; the first comes again at the
    /// end. Half way round and one more each time, which visits all of an odd number.
    pub(super) fn targets(&self, distance_px: f64, width_px: f64) -> impl Iterator<Item = Target> + use<> {
        let (count, across) = (self.targets, self.targets / 2 + 1);
        (0..=count).map(move |index| {
            let turn = TAU * ((index * across) % count) as f64 / count as f64;
            let centre_px = [0.5 * distance_px * turn.cos(), 0.5 * distance_px * turn.sin()];
            Target { centre_px, radius_px: 0.5 * width_px }
        })
    }
}
