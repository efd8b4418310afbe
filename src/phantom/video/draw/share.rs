//! How much of a marker is in view: the share of its disc or blot that lies in the picture and that nothing covers.
//!
//! Points spread evenly over it (a sunflower's) are asked one by one; the share is exact to about 0.3 %, and a blot's
//! visible centroid to 0.01 px.

use crate::phantom::video::scene::{Moment, Scene};

/// Points of a disc.
const POINTS: usize = 512;

/// The shares of a marker.
pub(in crate::phantom::video) struct Shares {
    /// In the picture, covered or not.
    pub(in crate::phantom::video) in_picture: f64,
    /// In the picture and not covered.
    pub(in crate::phantom::video) in_view: f64,
    /// The centroid of what is in view of a blot, as the lens shows it.
    pub(in crate::phantom::video) seen_px: Option<[f64; 2]>,
}

pub(in crate::phantom::video) fn shares(scene: &Scene, moment: &Moment, marker: usize) -> Shares {
    let centre = moment.markers_px[marker];
    let blot = scene.blots.get(marker);
    let points = blot.map_or_else(|| disc(scene.options.finger.marker_px), |blot| blot.points(&moment.skins[marker]));
    let (mut all, mut in_picture, mut in_view, mut sum) = (0.0, 0.0, 0.0, [0.0; 2]);
    for ([x, y], area) in points {
        all += area;
        let point = [centre[0] + x, centre[1] + y];
        let shown = scene.shown(point);
        if !scene.in_picture(shown) {
            continue;
        }
        in_picture += area;
        let from = |other: [f64; 2]| [point[0] - other[0], point[1] - other[1]];
        let by_marker = (marker + 1..moment.markers_px.len()).any(|later| {
            let from = from(moment.markers_px[later]);
            let near = from[0].hypot(from[1]) < scene.options.finger.marker_px;
            near && scene.blots.get(later).is_none_or(|blot| blot.distance(&moment.skins[later], from) < 0.0)
        });
        let by_stick = scene.sticks.iter().zip(&moment.sticks_px).any(|(stick, &tip)| stick.distance(from(tip)) < 0.0);
        if !by_marker && !by_stick {
            in_view += area;
            sum = [sum[0] + area * shown[0], sum[1] + area * shown[1]];
        }
    }
    let seen_px = (blot.is_some() && in_view > 0.0).then(|| sum.map(|sum| sum / in_view));
    Shares { in_picture: in_picture / all, in_view: in_view / all, seen_px }
}

/// Points of a disc, relative to its centre, of like areas.
fn disc(radius: f64) -> Vec<([f64; 2], f64)> {
    let point = |k: usize| {
        let out = radius * ((k as f64 + 0.5) / POINTS as f64).sqrt();
        // The golden angle.
        let (sin, cos) = (2.399_963_229_728_653 * k as f64).sin_cos();
        ([out * cos, out * sin], 1.0)
    };
    (0..POINTS).map(point).collect()
}
