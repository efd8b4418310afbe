//! What is in the picture beside the finger: blobs of marker colours on the desk, and sticks that cover a marker for a
//! while.
//!
//! Shapes are given by the distance from their outline, negative inside.

use std::f64::consts::TAU;

use rand::RngExt;
use serde::Serialize;

use crate::phantom::nail::numbers;

const KIND_DISTRACTORS: u32 = 12;

/// A blob's outline.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(in crate::phantom::video) enum Outline {
    Disc,
    Square,
    /// A strip with round ends, four times as long as wide.
    Strip,
}

/// A blob of a marker's colour.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(in crate::phantom::video) struct Distractor {
    pub(in crate::phantom::video) outline: Outline,
    /// Radius, or half the width.
    pub(in crate::phantom::video) size_px: f64,
    /// sRGB as 0xrrggbb.
    pub(in crate::phantom::video) colour: u32,
    pub(in crate::phantom::video) middle_px: [f64; 2],
    /// It goes round on a circle of this radius.
    pub(in crate::phantom::video) orbit_px: f64,
    pub(in crate::phantom::video) orbit_hz: f64,
    pub(in crate::phantom::video) turn_rad: f64,
}

impl Distractor {
    /// Where its middle is.
    pub(in crate::phantom::video) fn at(&self, t_s: f64) -> [f64; 2] {
        let (sin, cos) = (TAU * self.orbit_hz * t_s + self.turn_rad).sin_cos();
        [self.middle_px[0] + self.orbit_px * cos, self.middle_px[1] + self.orbit_px * sin]
    }

    /// How far its outline reaches from its middle.
    pub(in crate::phantom::video) fn reach_px(&self) -> f64 {
        self.size_px
            * match self.outline {
                Outline::Disc => 1.0,
                Outline::Square => std::f64::consts::SQRT_2,
                Outline::Strip => 4.0,
            }
    }

    /// Distance of a point, relative to the middle, from the outline.
    pub(in crate::phantom::video) fn distance(&self, [x, y]: [f64; 2]) -> f64 {
        let (sin, cos) = self.turn_rad.sin_cos();
        let (x, y) = ((cos * x + sin * y).abs(), (cos * y - sin * x).abs());
        match self.outline {
            Outline::Disc => x.hypot(y) - self.size_px,
            Outline::Square => {
                let (x, y) = (x - self.size_px, y - self.size_px);
                x.max(0.0).hypot(y.max(0.0)) + x.max(y).min(0.0)
            }
            Outline::Strip => (x - 3.0 * self.size_px).max(0.0).hypot(y) - self.size_px,
        }
    }

    /// Places up to `count` of them where `free` says that a disc of this middle and radius disturbs nothing.
    pub(in crate::phantom::video) fn place(
        seed: u64,
        count: usize,
        colours: &[u32],
        marker_px: f64,
        (width, height): (usize, usize),
        free: &dyn Fn([f64; 2], f64) -> bool,
    ) -> Vec<Self> {
        let mut rng = numbers(seed, KIND_DISTRACTORS, 0);
        let mut placed: Vec<Self> = Vec::new();
        for number in 0..count {
            // Moving ones as large as a marker, still ones larger, smaller and of other shapes.
            let (outline, size, moves) = match number % 6 {
                0 => (Outline::Disc, 1.0, true),
                1 => (Outline::Disc, 1.0, false),
                2 => (Outline::Square, 1.4, false),
                3 => (Outline::Strip, 0.6, false),
                4 => (Outline::Disc, 0.7, true),
                _ => (Outline::Disc, 1.8, false),
            };
            for _ in 0..400 {
                let mut at = |side: usize| rng.random_range(0.04..0.96) * side as f64;
                let middle_px = [at(width), at(height)];
                let one = Self {
                    outline,
                    size_px: size * marker_px,
                    colour: colours[number % colours.len()],
                    middle_px,
                    orbit_px: if moves { 4.0 * marker_px } else { 0.0 },
                    orbit_hz: if moves { rng.random_range(0.2..0.6) } else { 0.0 },
                    turn_rad: rng.random_range(0.0..TAU),
                };
                let radius = one.orbit_px + one.reach_px() + marker_px;
                let apart = placed.iter().all(|other| {
                    let [x, y] = other.middle_px;
                    (x - middle_px[0]).hypot(y - middle_px[1]) > radius + other.orbit_px + other.reach_px()
                });
                if apart && free(middle_px, radius) {
                    placed.push(one);
                    break;
                }
            }
        }
        placed
    }
}

/// A stick that comes to cover a marker and goes again.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::phantom::video) struct Stick {
    /// The marker's place in the list.
    pub(in crate::phantom::video) marker: usize,
    /// It covers all of the marker from here to there, seconds.
    pub(in crate::phantom::video) from_s: f64,
    pub(in crate::phantom::video) to_s: f64,
    /// How far its round end's middle is beside the marker's meanwhile.
    pub(in crate::phantom::video) rest_px: f64,
    /// How fast it comes and goes there, and faster further off.
    pub(in crate::phantom::video) speed_px_per_s: f64,
    pub(in crate::phantom::video) acceleration_px_per_s2: f64,
    /// Half its width.
    pub(in crate::phantom::video) radius_px: f64,
    /// The unit vector from its tip along it.
    pub(in crate::phantom::video) along: [f64; 2],
}

impl Stick {
    /// Where its round end's middle is, the marker being at `marker_px`.
    pub(in crate::phantom::video) fn tip(&self, t_s: f64, marker_px: [f64; 2]) -> [f64; 2] {
        let late_s = (self.from_s - t_s).max(t_s - self.to_s).max(0.0);
        let away = self.rest_px + late_s * (self.speed_px_per_s + late_s * self.acceleration_px_per_s2);
        [marker_px[0] + away * self.along[0], marker_px[1] + away * self.along[1]]
    }

    /// Distance of a point, relative to the tip, from the outline.
    pub(in crate::phantom::video) fn distance(&self, [x, y]: [f64; 2]) -> f64 {
        let along = (x * self.along[0] + y * self.along[1]).max(0.0);
        (x - along * self.along[0]).hypot(y - along * self.along[1]) - self.radius_px
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_those_from_the_outline() {
        let mut blob = Distractor {
            outline: Outline::Square,
            size_px: 2.0,
            colour: 0,
            middle_px: [0.0; 2],
            orbit_px: 0.0,
            orbit_hz: 0.0,
            turn_rad: 0.0,
        };
        assert!((blob.distance([5.0, 0.0]) - 3.0).abs() < 1e-12 && (blob.distance([0.5, 0.0]) + 1.5).abs() < 1e-12);
        blob.outline = Outline::Strip;
        assert!((blob.distance([9.0, 0.0]) - 1.0).abs() < 1e-12 && (blob.distance([4.0, 3.0]) - 1.0).abs() < 1e-12);
        blob.outline = Outline::Disc;
        assert!((blob.distance([3.0, 4.0]) - 3.0).abs() < 1e-12);
    }

    #[test]
    fn a_stick_is_over_its_marker_when_it_should_and_far_otherwise() {
        let stick = Stick {
            marker: 0,
            from_s: 2.0,
            to_s: 3.0,
            rest_px: 5.0,
            speed_px_per_s: 90.0,
            acceleration_px_per_s2: 200.0,
            radius_px: 15.0,
            along: [0.0, -1.0],
        };
        assert_eq!(stick.tip(2.4, [7.0, 8.0]), [7.0, 3.0]);
        assert_eq!(stick.tip(1.5, [7.0, 8.0]), [7.0, -92.0]);
        assert!(
            (stick.distance([3.0, -50.0]) + 12.0).abs() < 1e-12 && (stick.distance([0.0, 20.0]) - 5.0).abs() < 1e-12
        );
    }
}
