//! What a scene's options leave open is settled: the frames' times, when and how far the finger leaves, where sticks come from, where
//! distractors lie.

use std::f64::consts::TAU;

use rand::RngExt;

use super::objects::{Distractor, Stick};
use super::scene::{Scene, TICKS_PER_S};
use super::{Hide, VideoOptions};
use crate::phantom::nail::numbers;
use crate::phantom::screen::{Clock, Jump};

const KIND_TIMES: u32 = 13;
/// A share of the frames that is dropped where the frame rate varies.
const DROPPED: f64 = 0.04;

/// The frames' times in ticks.
pub(super) fn ticks(options: &VideoOptions) -> Vec<i64> {
    let per_frame = f64::from(TICKS_PER_S) / options.fps;
    if options.jitter <= 0.0 {
        return (0..options.frames()).map(|frame| (per_frame * frame as f64).round() as i64).collect();
    }
    let mut rng = numbers(options.seed, KIND_TIMES, 0);
    let mut now = 0;
    (0..options.frames())
        .map(|_| {
            let this = now;
            let dropped = if rng.random_bool(DROPPED) { per_frame } else { 0.0 };
            let change = options.jitter * rng.random_range(-1.0..1.0);
            now += ((1.0 + change) * per_frame + dropped).round().max(1.0) as i64;
            this
        })
        .collect()
}

impl Scene {
    /// The times of frames `frame` to `frame + frames - 1`, as far as there are such.
    fn span_s(&self, frame: usize, frames: usize) -> (f64, f64) {
        let last = (frame + frames - 1).min(self.frames() - 1);
        // Exposures are within half a mean interval.
        let half = 0.5 / self.options.fps;
        (self.time_s(frame) - half, self.time_s(last) + half)
    }

    /// The middle between frame `frame` and the one before.
    fn before_s(&self, frame: usize) -> f64 {
        let earlier_s = frame.checked_sub(1).map_or(-1.0 / self.options.fps, |earlier| self.time_s(earlier));
        0.5 * (earlier_s + self.time_s(frame))
    }

    /// When the clock's screen stops and jumps.
    pub(super) fn settle_clock(&self) -> Option<Clock> {
        let mut clock = self.options.clock.clone()?;
        let events = &self.options.screen;
        clock.stop_s = events.stop.map(|frame| self.before_s(frame)).or(clock.stop_s);
        let jump = events.jump.map(|(frame, by_s)| Jump { at_s: self.before_s(frame), by_s });
        clock.jump = jump.or(clock.jump);
        Some(clock)
    }

    pub(super) fn settle_leave(&self) -> Option<(f64, f64, f64)> {
        let leave = self.options.leave?;
        let (from_s, to_s) = self.span_s(leave.frame, leave.frames);
        let last = (leave.frame + leave.frames).min(self.frames());
        let left_most = (leave.frame..last)
            .map(|frame| self.moment(self.time_s(frame)).markers_px.last().map_or(0.0, |at| at[0]))
            .fold(f64::INFINITY, f64::min);
        let beyond = if self.mapping.is_some() { 1.3 } else { 1.0 } * self.options.width as f64;
        Some((from_s, to_s, (beyond + 2.0 * self.options.finger.marker_px - left_most).max(0.0)))
    }

    pub(super) fn settle_sticks(&self) -> Vec<Stick> {
        let radius = self.options.finger.marker_px;
        // The softness of the edges, covered as well.
        let edge_px = 3.5 * self.options.focus_px;
        let stick = |hide: &Hide| {
            let marker = self.markers.iter().position(|marker| marker.name == hide.marker)?;
            let (from_s, to_s) = self.span_s(hide.frame, hide.frames);
            // It comes from the back of the finger, across the marker's segment.
            let middle_s = 0.5 * (from_s + to_s);
            let directions = self.options.finger.directions_rad(self.options.trajectory.angles_rad(middle_s));
            let segment = (0..4).find(|&s| self.options.finger.layout.ends(s).contains(&marker))?;
            let back = directions[segment] - self.options.finger.flexion.sign() * 0.25 * TAU;
            Some(Stick {
                marker,
                from_s,
                to_s,
                rest_px: 0.6 * radius,
                // Half a frame interval before and after, a sliver is seen.
                speed_px_per_s: 2.0 * self.options.fps * (edge_px + 0.12 * radius),
                acceleration_px_per_s2: 30.0 * radius,
                radius_px: 1.6 * radius + edge_px,
                along: [back.cos(), back.sin()],
            })
        };
        self.options.hide.iter().filter_map(stick).collect()
    }

    /// Distractors keep away from the finger wherever it goes, and from the clock.
    pub(super) fn settle_distractors(&self) -> Vec<Distractor> {
        let options = &self.options;
        let every = self.frames().div_ceil(200);
        let fingers: Vec<[[f64; 2]; 5]> =
            (0..self.frames()).step_by(every).map(|frame| self.moment(self.time_s(frame)).bones_px).collect();
        let widest = options.finger.half_widths_px.iter().copied().fold(0.0, f64::max);
        let panel = options.clock.as_ref().map(|clock| options.clock_roi_px(clock).map(|side| side as f64));
        let free = |[x, y]: [f64; 2], radius: f64| {
            let inside =
                x > radius && y > radius && x < options.width as f64 - radius && y < options.height as f64 - radius;
            let off_panel = panel.is_none_or(|[left, top, width, height]| {
                let away = |v: f64, low: f64, span: f64| (low - v).max(v - low - span).max(0.0);
                away(x, left, width).hypot(away(y, top, height)) > radius + 0.03 * options.width as f64
            });
            inside
                && off_panel
                && fingers.iter().all(|bones| {
                    bones.windows(2).all(|pair| distance_to_line([x, y], pair[0], pair[1]) > widest + radius)
                })
        };
        let mut colours: Vec<u32> = Vec::new();
        for marker in &self.markers {
            if colours.len() < 3 && !colours.contains(&marker.colour) {
                colours.push(marker.colour);
            }
        }
        let size = (options.width, options.height);
        Distractor::place(options.seed, options.distractors, &colours, options.finger.marker_px, size, &free)
    }
}

fn distance_to_line([x, y]: [f64; 2], from: [f64; 2], to: [f64; 2]) -> f64 {
    let [dx, dy] = [to[0] - from[0], to[1] - from[1]];
    let along = (((x - from[0]) * dx + (y - from[1]) * dy) / (dx * dx + dy * dy)).clamp(0.0, 1.0);
    (x - from[0] - along * dx).hypot(y - from[1] - along * dy)
}
