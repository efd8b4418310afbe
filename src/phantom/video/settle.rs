//! What a scene's options leave open is settled: the frames' times, when and how far the finger leaves, where sticks
//! come from, where distractors lie.

use std::f64::consts::TAU;

use rand::RngExt;

use super::scene::{Scene, SceneMarker};
use super::{Faults, Hide, VideoOptions};
use crate::flexion::Flexion;
use crate::phantom::nail::numbers;
use crate::phantom::scene::lens::row_moves;
use crate::phantom::scene::reel::TICKS_PER_S;
use crate::phantom::screen::{Clock, Jump};
use crate::phantom::video::draw::blot::Blot;
use crate::phantom::video::draw::limb::Limb;
use crate::phantom::video::draw::objects::{Distractor, Outline, Stick};

const KIND_TIMES: u32 = 13;
/// A share of the frames that is dropped where the frame rate varies.
const DROPPED: f64 = 0.04;

/// The frames' times in ticks.
fn ticks(options: &VideoOptions) -> Vec<i64> {
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
    /// Settles a scene.
    ///
    /// # Errors
    /// [`Faults`]: all that is wrong with the options.
    pub fn new(options: VideoOptions) -> Result<Self, Faults> {
        options.check()?;
        let colours = options.colours.of(options.finger.layout);
        let names = options.finger.layout.names();
        let markers = names.into_iter().zip(colours).map(|(name, colour)| SceneMarker { name, colour }).collect();
        let mapping = options.mapping();
        let mut scene = Self {
            ticks: ticks(&options),
            markers,
            blots: if options.finger.layout.painted() { Blot::all(&options) } else { Vec::new() },
            other_hand: other_hand(&options),
            distractors: Vec::new(),
            sticks: Vec::new(),
            straighten: None,
            row_moves: None,
            mapping,
            leave: None,
            options,
        };
        scene.straighten =
            scene.mapping.as_ref().map(|mapping| mapping.straighten(scene.options.width, scene.options.height));
        scene.row_moves = scene.straighten.as_ref().map(|moves| row_moves(moves, scene.options.width));
        scene.options.clock = scene.settle_clock();
        scene.leave = scene.settle_leave();
        scene.sticks = scene.settle_sticks();
        scene.distractors = scene.settle_distractors();
        Ok(scene)
    }

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
    fn settle_clock(&self) -> Option<Clock> {
        let mut clock = self.options.clock.clone()?;
        let events = &self.options.screen;
        clock.stop_s = events.stop.map(|frame| self.before_s(frame)).or(clock.stop_s);
        let jump = events.jump.map(|(frame, by_s)| Jump { at_s: self.before_s(frame), by_s });
        clock.jump = jump.or(clock.jump);
        Some(clock)
    }

    fn settle_leave(&self) -> Option<(f64, f64, f64)> {
        let leave = self.options.leave?;
        let (from_s, to_s) = self.span_s(leave.frame, leave.frames);
        let last = (leave.frame + leave.frames).min(self.frames());
        let left_most = (leave.frame..last)
            .map(|frame| self.moment(self.time_s(frame)).markers_px[self.options.finger.layout.tip()][0])
            .fold(f64::INFINITY, f64::min);
        let beyond = if self.mapping.is_some() { 1.3 } else { 1.0 } * self.options.width as f64;
        Some((from_s, to_s, (beyond + 2.0 * self.options.finger.marker_px - left_most).max(0.0)))
    }

    fn settle_sticks(&self) -> Vec<Stick> {
        let radius = self.options.finger.marker_px;
        // The softness of the edges, covered as well.
        let edge_px = 3.5 * self.options.focus_px;
        let stick = |hide: &Hide| {
            let marker = self.markers.iter().position(|marker| marker.name == hide.marker)?;
            let (from_s, to_s) = self.span_s(hide.frame, hide.frames);
            // It comes from the back of the finger, across the marker's segment.
            let middle_s = 0.5 * (from_s + to_s);
            let along_rad = self.moment(middle_s).skins[marker].along_rad;
            let back = along_rad - self.options.finger.flexion.sign() * 0.25 * TAU;
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
    fn settle_distractors(&self) -> Vec<Distractor> {
        let options = &self.options;
        let every = self.frames().div_ceil(200);
        if let Some(other) = &self.other_hand {
            return spots(options.distractors, other, options.finger.marker_px);
        }
        let fingers: Vec<Vec<[f64; 2]>> =
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

/// With paint, another hand lies at the picture's right border, on the side to which the finger bends: three fingers of
/// the same skin.
fn other_hand(options: &VideoOptions) -> Option<Limb> {
    let at = |[x, y]: [f64; 2]| {
        let y = if options.finger.flexion == Flexion::Clockwise { y } else { 1.0 - y };
        [x * options.width as f64, y * options.height as f64]
    };
    let points =
        [[1.2, 1.1], [0.92, 0.86], [0.76, 0.76], [0.69, 0.87], [0.8, 0.98], [0.84, 0.62], [0.76, 0.55]].map(at);
    let half_widths = [80.0, 70.0, 34.0, 27.0, 26.0, 31.0, 25.0].map(|half| half * options.width as f64 / 1280.0);
    let bones = [[0, 1], [1, 2], [2, 3], [1, 4], [1, 5], [5, 6]];
    options.finger.layout.painted().then(|| Limb::new(&points, &half_widths, &bones))
}

/// Dark spots on the other hand that are no marks: brown, grey and nearly black ones, as shadows, hair and rings are.
fn spots(count: usize, hand: &Limb, reach_px: f64) -> Vec<Distractor> {
    const COLOURS: [u32; 3] = [0x4a2f24, 0x33363a, 0x241c1a];
    let spot = |k: usize| {
        // Along one bone after the other, each time elsewhere.
        let bone = &hand.bones[1 + k % (hand.bones.len() - 1)];
        let along = (0.45 + 0.31 * k as f64).fract();
        let outline = [Outline::Disc, Outline::Strip, Outline::Square][k % 3];
        Distractor {
            outline,
            size_px: reach_px * [0.5, 0.25, 0.4][k % 3],
            colour: COLOURS[k % COLOURS.len()],
            middle_px: [0, 1].map(|axis| bone.ends[0][axis] + along * (bone.ends[1][axis] - bone.ends[0][axis])),
            orbit_px: 0.0,
            orbit_hz: 0.0,
            turn_rad: 1.1 * k as f64,
        }
    };
    (0..count).map(spot).collect()
}

fn distance_to_line([x, y]: [f64; 2], from: [f64; 2], to: [f64; 2]) -> f64 {
    let [dx, dy] = [to[0] - from[0], to[1] - from[1]];
    let along = (((x - from[0]) * dx + (y - from[1]) * dy) / (dx * dx + dy * dy)).clamp(0.0, 1.0);
    (x - from[0] - along * dx).hypot(y - from[1] - along * dy)
}
