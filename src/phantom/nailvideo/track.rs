//! How the hand moves before the camera: an affine map from the first frame to each moment.
//!
//! In: the options and a time. Out: [`Affine`], frame 0's pixels to those of the moment: about the nail's middle a
//! turn, a change of size and a tilt (stretch and shear), and a shift; slow sums of sinusoids each, with what they are
//! at time 0 taken off. A jerk goes away within three frames and back within three frames a second later.

use std::f64::consts::TAU;

use lunula_predictor::smooth;
use rand::RngExt;
use serde::Serialize;

use super::NailVideoOptions;
use crate::phantom::motion::wave::{Wave, random_wave};
use crate::phantom::nail::numbers;

const KIND_TRACK: u32 = 41;
const KIND_JERK: u32 = 42;
/// The drift's rate, hertz; its sinusoids have 0.4 to 4 times it (assumed).
const DRIFT_HZ: f64 = 0.15;
/// From one jerk to the next, seconds, and how many frames one takes.
const JERK_EVERY_S: f64 = 1.0;
const JERK_FRAMES: f64 = 3.0;
/// How long the hand takes to leave and to come back, seconds.
const LEAVE_S: f64 = 0.5;

/// (x, y) goes to (a x + b y + c, d x + e y + f).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Affine(pub [f64; 6]);

impl Affine {
    /// Leaves everything in its place.
    pub const IDENTITY: Self = Self([1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);

    /// Where a point goes.
    #[must_use]
    pub fn apply(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [a, b, c, d, e, f] = self.0;
        [a * x + b * y + c, d * x + e * y + f]
    }

    /// First `first`, then this.
    #[must_use]
    pub fn after(&self, first: &Self) -> Self {
        let [a, b, _, d, e, _] = self.0;
        let [a1, b1, c1, d1, e1, f1] = first.0;
        let [c, f] = self.apply([c1, f1]);
        Self([a * a1 + b * d1, a * b1 + b * e1, c, d * a1 + e * d1, d * b1 + e * e1, f])
    }

    /// The way back; of a map that flattens the plane it is not finite.
    #[must_use]
    pub fn inverse(&self) -> Self {
        let [a, b, c, d, e, f] = self.0;
        let per = 1.0 / (a * e - b * d);
        Self([per * e, -per * b, per * (b * f - e * c), -per * d, per * a, per * (d * c - a * f)])
    }
}

/// A hand's way.
#[derive(Debug, Clone)]
pub(super) struct Track {
    options: NailVideoOptions,
    centre_px: [f64; 2],
    /// Shift right, down; turn; size; stretch, shear.
    waves: [Wave; 6],
    /// The hand is out from and until, and where to.
    leave: Option<([f64; 2], [f64; 2])>,
    back: Affine,
}

impl Track {
    pub(super) fn new(options: &NailVideoOptions, centre_px: [f64; 2], away_px: f64) -> Self {
        let wave = |index: u32| random_wave(DRIFT_HZ, 0.4..4.0, options.seed, KIND_TRACK, index);
        let turn = numbers(options.seed, KIND_TRACK, 6).random_range(0.0..TAU);
        let leave = options.leave.map(|[frame, count]| {
            let span_s = [frame as f64 / options.fps, (frame + count) as f64 / options.fps];
            (span_s, [away_px * turn.cos(), away_px * turn.sin()])
        });
        let mut track = Self {
            options: options.clone(),
            centre_px,
            waves: [0, 1, 2, 3, 4, 5].map(wave),
            leave,
            back: Affine::IDENTITY,
        };
        track.back = track.posed(0.0).inverse();
        track
    }

    /// Frame 0's pixels to those at `t_s`.
    pub(super) fn at(&self, t_s: f64) -> Affine {
        self.posed(t_s).after(&self.back)
    }

    fn posed(&self, t_s: f64) -> Affine {
        let NailVideoOptions { drift_px, turn_deg, scale_percent, tilt_percent, .. } = self.options;
        let [right, down, turn, size, stretch, shear] = self.waves.map(|wave| wave.at(t_s));
        let (sin, cos) = (turn_deg.to_radians() * turn).sin_cos();
        let (scale, tilt) = (0.01 * scale_percent, 0.01 * tilt_percent);
        let (size, stretch, shear) = (1.0 + scale * size, tilt * stretch, tilt * shear);
        // Stretched and sheared, then turned.
        let [a, b, d, e] = [size * (1.0 + 0.5 * stretch), size * shear, 0.0, size * (1.0 - 0.5 * stretch)];
        let [a, b, d, e] = [cos * a - sin * d, cos * b - sin * e, sin * a + cos * d, sin * b + cos * e];
        let [jerk_x, jerk_y] = self.jerk(t_s);
        let [away_x, away_y] = self.away(t_s);
        let [x, y] = self.centre_px;
        let c = x + drift_px * right + jerk_x + away_x - a * x - b * y;
        let f = y + drift_px * down + jerk_y + away_y - d * x - e * y;
        Affine([a, b, c, d, e, f])
    }

    fn jerk(&self, t_s: f64) -> [f64; 2] {
        let NailVideoOptions { seed, fps, jerk_px, .. } = self.options;
        if jerk_px == 0.0 || t_s < JERK_EVERY_S {
            return [0.0; 2];
        }
        let which = (t_s / JERK_EVERY_S).floor();
        let gone = smooth((t_s - which * JERK_EVERY_S) / (JERK_FRAMES / fps));
        // Away and back in turn, the next one elsewhere.
        let odd = which as u64 % 2 == 1;
        let turn = numbers(seed, KIND_JERK, (which as u64).div_ceil(2) as u32).random_range(0.0..TAU);
        // A smooth step is half as steep again in its middle as on the whole.
        let far = jerk_px * JERK_FRAMES / 1.5 * if odd { gone } else { 1.0 - gone };
        let before = numbers(seed, KIND_JERK, (which as u64 / 2) as u32).random_range(0.0..TAU);
        let turn = if odd { turn } else { before };
        [far * turn.cos(), far * turn.sin()]
    }

    fn away(&self, t_s: f64) -> [f64; 2] {
        self.leave.map_or([0.0; 2], |([from_s, to_s], away_px)| {
            let gone = smooth((t_s - from_s) / LEAVE_S + 1.0) * (1.0 - smooth((t_s - to_s) / LEAVE_S));
            away_px.map(|away| gone * away)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_affine_maps_inverse_undoes_it() {
        let map = Affine([1.02, -0.1, 7.0, 0.13, 0.97, -20.0]);
        let other = Affine([0.9, 0.2, 1.0, -0.1, 1.1, 3.0]);
        for point in [[0.0, 0.0], [640.0, 10.0], [-3.0, 480.0]] {
            let back = map.inverse().apply(map.apply(point));
            assert!((back[0] - point[0]).hypot(back[1] - point[1]) <= 1e-9);
            let [x, y] = map.after(&other).apply(point);
            let [x1, y1] = map.apply(other.apply(point));
            assert!((x - x1).hypot(y - y1) <= 1e-9);
        }
    }

    #[test]
    fn a_jerk_is_as_fast_as_it_says_and_nothing_jumps() {
        let still = NailVideoOptions {
            drift_px: 0.0,
            turn_deg: 0.0,
            scale_percent: 0.0,
            tilt_percent: 0.0,
            ..NailVideoOptions::default()
        };
        for jerk_px in [2.0, 8.0] {
            let options = NailVideoOptions { jerk_px, ..still.clone() };
            let track = Track::new(&options, [320.0, 240.0], 0.0);
            let (mut fastest, mut before) = (0.0f64, track.at(0.0).apply([0.0, 0.0]));
            let steps = 100;
            for k in 1..=steps * 600 {
                let here = track.at(f64::from(k) / f64::from(steps) / 30.0).apply([0.0, 0.0]);
                fastest = fastest.max(f64::from(steps) * (here[0] - before[0]).hypot(here[1] - before[1]));
                before = here;
            }
            assert!((fastest / jerk_px - 1.0).abs() <= 0.01, "{fastest}");
        }
        assert_eq!(Track::new(&still, [320.0, 240.0], 0.0).at(5.0), Affine::IDENTITY);
    }

    #[test]
    fn the_first_frame_is_where_it_is_and_a_hand_that_leaves_is_away() {
        let options = NailVideoOptions { leave: Some([60, 30]), jerk_px: 3.0, ..NailVideoOptions::default() };
        let track = Track::new(&options, [320.0, 240.0], 900.0);
        let [first, away, back] = [0.0, 2.5, 5.0].map(|t_s| track.at(t_s).apply([320.0, 240.0]));
        assert!((first[0] - 320.0).hypot(first[1] - 240.0) <= 1e-9);
        assert!((away[0] - 320.0).hypot(away[1] - 240.0) >= 850.0);
        assert!((back[0] - 320.0).hypot(back[1] - 240.0) <= 40.0);
        let other = Track::new(&NailVideoOptions { seed: 2, ..options }, [320.0, 240.0], 900.0);
        assert_ne!(other.at(1.0), track.at(1.0));
    }
}
