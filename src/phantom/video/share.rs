//! How much of a marker is in view: the share of its disc that lies in the picture and that nothing covers.
//!
//! Points spread evenly over the disc (a sunflower's) are asked one by one; the share is exact to about 0.3 %.

use super::scene::{Moment, Scene};

const POINTS: usize = 512;

/// The shares of a marker's disc.
pub(super) struct Shares {
    /// In the picture, covered or not.
    pub(super) in_picture: f64,
    /// In the picture and not covered.
    pub(super) in_view: f64,
}

/// The shares of marker `marker` at one moment.
pub(super) fn shares(scene: &Scene, moment: &Moment, marker: usize) -> Shares {
    let radius = scene.options.finger.marker_px;
    let centre = moment.markers_px[marker];
    let (mut in_picture, mut in_view) = (0, 0);
    let later = &moment.markers_px[marker + 1..];
    for k in 0..POINTS {
        let out = radius * ((k as f64 + 0.5) / POINTS as f64).sqrt();
        // The golden angle.
        let (sin, cos) = (2.399_963_229_728_653 * k as f64).sin_cos();
        let point = [centre[0] + out * cos, centre[1] + out * sin];
        if !scene.in_picture(scene.shown(point)) {
            continue;
        }
        in_picture += 1;
        let from = |other: [f64; 2]| [point[0] - other[0], point[1] - other[1]];
        let by_marker = later.iter().any(|&other| {
            let [x, y] = from(other);
            x.hypot(y) < radius
        });
        let by_stick = scene.sticks.iter().zip(&moment.sticks_px).any(|(stick, &tip)| stick.distance(from(tip)) < 0.0);
        in_view += usize::from(!by_marker && !by_stick);
    }
    let share = |count: usize| count as f64 / POINTS as f64;
    Shares { in_picture: share(in_picture), in_view: share(in_view) }
}
