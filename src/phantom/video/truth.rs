//! What is true of a frame.

use super::scene::{FrameTruth, MarkerStatus, MarkerTruth, Scene};
use crate::phantom::video::draw::share::shares;

/// A marker's visible shares under and over which it counts as hidden and as seen.
const HIDDEN_UNDER: f64 = 0.005;
const SEEN_OVER: f64 = 0.995;

impl Scene {
    /// What is true of a frame.
    #[must_use]
    pub fn truth(&self, frame: usize) -> FrameTruth {
        let time_s = self.time_s(frame);
        let moment = self.moment(time_s);
        let markers = (0..self.markers.len())
            .map(|marker| {
                let shares = shares(self, &moment, marker);
                let status = match (shares.in_picture, shares.in_view) {
                    (in_picture, _) if in_picture < HIDDEN_UNDER => MarkerStatus::Outside,
                    (_, in_view) if in_view < HIDDEN_UNDER => MarkerStatus::Hidden,
                    (_, in_view) if in_view < SEEN_OVER => MarkerStatus::Partial,
                    _ => MarkerStatus::Ok,
                };
                let at_px = self.shown(moment.markers_px[marker]);
                MarkerTruth { at_px, seen_px: shares.seen_px, in_view: shares.in_view, status }
            })
            .collect();
        FrameTruth {
            time_s,
            clock_s: self.options.clock.as_ref().map(|clock| clock.counts_s(time_s)),
            angles_rad: self.options.finger.joints_rad(self.options.trajectory.angles_rad(time_s)),
            markers,
        }
    }
}
