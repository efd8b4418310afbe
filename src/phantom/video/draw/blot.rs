//! A blot of paint: an irregular closed outline on the skin, which bends and stretches with it, with brush strokes and
//! shine inside.
//!
//! In: the seed and the mark's number; then how the skin lies ([`Skin`]). Out: distances from the drawn outline, its
//! shade, points spread over it.
//!
//! Skin coordinates: pixels along the finger and across it (clockwise of along). Their origin is the centroid of the
//! blot as it was painted on the straight finger: the material point that is the mark's place, and what joint angles
//! are taken from. Over a bent joint the skin lies along an arc about that point, so that it stretches on the outer
//! side, is pressed together on the inner one, and the centroid of what is seen leaves the mark's place.
//!
//! Sizes and tones are those measured in a real recording of eight marks (1280x720): 19-40 px long (median 27), 8-28 px
//! wide (20), solidity 0.9-1, luma inside varying by an SD of 8-22. The shares of strokes, thickness and shine are
//! assumed, and chosen to meet that.

use std::f64::consts::TAU;

use rand::RngExt;

use crate::phantom::motion::finger::Skin;
use crate::phantom::nail::numbers;
use crate::phantom::video::{Colours, VideoOptions};

const KIND_BLOTS: u32 = 14;
/// Of the length: least, median, greatest, and the SD of its logarithm.
const LENGTH_PX: [f64; 3] = [19.0, 27.0, 40.0];
const LENGTH_SPREAD: f64 = 0.22;
/// Of the width over the length.
const SLENDER: std::ops::Range<f64> = 0.5..1.0;
/// Of the width.
const WIDTH_PX: [f64; 2] = [8.0, 28.0];
/// Waves around the outline, from two on, and their greatest amplitudes as shares of the radius.
const WAVES: [f64; 4] = [0.07, 0.06, 0.04, 0.03];
/// Strokes and thickness: the range of wavelengths, pixels, and the amplitude as a share of the tone.
const STROKES: [(std::ops::Range<f64>, f64); 4] =
    [(3.5..5.0, 0.13), (5.0..8.0, 0.20), (8.0..14.0, 0.22), (20.0..40.0, 0.28)];
/// Of pale paint, whose luma is three to four times as high, by so much less.
const PALE_STROKES: f64 = 0.3;
const POINTS: usize = 4096;

/// A blot as it was painted.
#[derive(Debug)]
pub(in crate::phantom::video) struct Blot {
    half_px: [f64; 2],
    /// Sine and cosine of the angle from along the finger to the blot's long axis.
    turn: [f64; 2],
    /// Amplitude and phase.
    waves: [(f64, f64); WAVES.len()],
    /// The outline's centroid, in halves along the axes.
    centroid: [f64; 2],
    /// Its colour is this share of the paint's.
    tone: f64,
    /// Wave number along and across the long axis, phase, amplitude.
    strokes: [([f64; 2], f64, f64); STROKES.len()],
    /// Where it shines, on its own axes, pixels; how wide; how much.
    shine: ([f64; 2], f64, f64),
}

impl Blot {
    /// The marks of a video.
    pub(in crate::phantom::video) fn all(options: &VideoOptions) -> Vec<Self> {
        let (finger, scale) = (&options.finger, options.width as f64 / 1280.0);
        let blot =
            |mark| Self::new(options.seed, mark, scale, finger.half_width_px(mark), options.colours == Colours::Pale);
        (0..finger.layout.names().len()).map(blot).collect()
    }

    /// The blot of mark `mark` in a picture `scale` times as wide as 1280, on a limb so wide.
    fn new(seed: u64, mark: usize, scale: f64, half_width_px: f64, pale: bool) -> Self {
        let mut rng = numbers(seed, KIND_BLOTS, mark as u32);
        let [least, median, greatest] = LENGTH_PX;
        // A sum of three uniform numbers, near to a normal one.
        let normal: f64 = (0..3).map(|_| rng.random_range(-1.0..1.0)).sum();
        let length = (median * (LENGTH_SPREAD * normal).exp()).clamp(least, greatest);
        // It stays on the finger.
        let length = length.min(1.6 * half_width_px / scale);
        let width = (length * rng.random_range(SLENDER)).clamp(WIDTH_PX[0], WIDTH_PX[1]);
        let turn = rng.random_range(0.0..TAU).sin_cos();
        let waves = WAVES.map(|most| (most * rng.random_range(0.3..1.0), rng.random_range(0.0..TAU)));
        let lie = rng.random_range(0.0..TAU);
        let strokes = STROKES.map(|(lengths, amplitude)| {
            // Strokes lie about one way.
            let (sin, cos) = (lie + rng.random_range(-0.3..0.3)).sin_cos();
            let number = TAU / (scale * rng.random_range(lengths));
            (
                [number * cos, number * sin],
                rng.random_range(0.0..TAU),
                amplitude * if pale { PALE_STROKES } else { 1.0 },
            )
        });
        let tone = if pale { rng.random_range(0.85..1.0) } else { rng.random_range(0.42..0.7) };
        let half_px = [0.5 * scale * length, 0.5 * scale * width];
        let place = half_px.map(|half| half * rng.random_range(-0.4..0.4));
        let shine = (place, scale * rng.random_range(2.0..3.5), rng.random_range(0.08..0.2));
        let mut blot = Self { half_px, turn: [turn.0, turn.1], waves, centroid: [0.0; 2], tone, strokes, shine };
        blot.centroid = blot.design_centroid();
        blot
    }

    /// The outline's radius in a direction, in halves along the axes.
    fn radius(&self, direction: f64) -> f64 {
        let wave =
            |(k, (amplitude, phase)): (usize, &(f64, f64))| amplitude * ((k + 2) as f64 * direction + phase).cos();
        1.0 + self.waves.iter().enumerate().map(wave).sum::<f64>()
    }

    fn design_centroid(&self) -> [f64; 2] {
        const STEPS: usize = 720;
        let (mut area, mut sum) = (0.0, [0.0; 2]);
        for k in 0..STEPS {
            let direction = TAU * k as f64 / STEPS as f64;
            let radius = self.radius(direction);
            area += 0.5 * radius.powi(2);
            sum[0] += radius.powi(3) * direction.cos() / 3.0;
            sum[1] += radius.powi(3) * direction.sin() / 3.0;
        }
        sum.map(|sum| sum / area)
    }

    /// All of it lies within this of its place, on skin that is stretched as well.
    pub(in crate::phantom::video) fn reach_px(&self) -> f64 {
        1.5 * self.half_px[0]
    }

    /// A point of the skin on the blot's own axes, pixels from the middle of its outline.
    fn own(&self, [along, across]: [f64; 2]) -> [f64; 2] {
        let [sin, cos] = self.turn;
        let middle = [0, 1].map(|axis| self.centroid[axis] * self.half_px[axis]);
        [cos * along + sin * across + middle[0], cos * across - sin * along + middle[1]]
    }

    /// Where the outline is crossed: negative inside, in halves.
    fn beyond(&self, skin: &Skin, from: [f64; 2]) -> f64 {
        let own = self.own(skin.material(from));
        let [x, y] = [own[0] / self.half_px[0], own[1] / self.half_px[1]];
        x.hypot(y) - self.radius(y.atan2(x))
    }

    /// Distance of a point, relative to the mark's place, from the drawn outline; to the first order near it.
    pub(in crate::phantom::video) fn distance(&self, skin: &Skin, [x, y]: [f64; 2]) -> f64 {
        const STEP_PX: f64 = 0.05;
        let here = self.beyond(skin, [x, y]);
        let slope = [[STEP_PX, 0.0], [0.0, STEP_PX]].map(|[dx, dy]| {
            (self.beyond(skin, [x + dx, y + dy]) - self.beyond(skin, [x - dx, y - dy])) / (2.0 * STEP_PX)
        });
        here / slope[0].hypot(slope[1]).max(0.5 / self.half_px[0])
    }

    /// What the paint's R'G'B' is multiplied by at a point, relative to the mark's place, and what shine adds to it.
    pub(in crate::phantom::video) fn shade(&self, skin: &Skin, from: [f64; 2]) -> [f32; 2] {
        let [x, y] = self.own(skin.material(from));
        let strokes = self.strokes.iter().map(|([a, b], phase, amplitude)| amplitude * (a * x + b * y + phase).sin());
        let ([px, py], wide, most) = self.shine;
        let shine = most * (-0.5 * ((x - px).powi(2) + (y - py).powi(2)) / (wide * wide)).exp();
        [(self.tone * (1.0 + strokes.sum::<f64>())) as f32, shine as f32]
    }

    /// Points spread over all of it, relative to the mark's place, and the area that each of them speaks for.
    pub(in crate::phantom::video) fn points(&self, skin: &Skin) -> Vec<([f64; 2], f64)> {
        let [sin, cos] = self.turn;
        let point = |k: usize| {
            let out = ((k as f64 + 0.5) / POINTS as f64).sqrt();
            // The golden angle.
            let direction = 2.399_963_229_728_653 * k as f64;
            let radius = self.radius(direction);
            let [x, y] = [out * radius * direction.cos(), out * radius * direction.sin()];
            let [x, y] = [(x - self.centroid[0]) * self.half_px[0], (y - self.centroid[1]) * self.half_px[1]];
            let (from, stretch) = skin.shown([cos * x - sin * y, sin * x + cos * y]);
            (from, radius * radius * stretch)
        };
        (0..POINTS).map(point).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::phantom::video::draw::edge::soft;

    fn skins() -> impl Iterator<Item = (usize, Skin)> {
        (0..24).map(|k| (k, Skin { along_rad: 0.9 * k as f64, bend_per_px: 0.004 * (k % 7) as f64 - 0.008 }))
    }

    #[test]
    fn a_drawn_blots_centroid_is_that_of_its_points() {
        // Measured: 0.018.
        const NEAR_PX: f64 = 0.03;
        for (k, skin) in skins() {
            let blot = Blot::new(5, k, 1.0, 30.0, false);
            let (mut weight, mut sum) = (0.0, [0.0; 2]);
            for (x, y) in (-40..=40).flat_map(|x| (-40..=40).map(move |y| (f64::from(x), f64::from(y)))) {
                let share = f64::from(soft(blot.distance(&skin, [x, y]) / 0.55));
                assert!(share == 0.0 || x.hypot(y) <= blot.reach_px() + 2.0, "{k}");
                weight += share;
                sum = [sum[0] + share * x, sum[1] + share * y];
            }
            let points = blot.points(&skin);
            let area: f64 = points.iter().map(|(_, area)| area).sum();
            let of = |axis: usize| points.iter().map(|(at, area)| at[axis] * area).sum::<f64>() / area;
            let miss = (sum[0] / weight - of(0)).hypot(sum[1] / weight - of(1));
            assert!(miss <= NEAR_PX, "{k} {miss}");
            // As it was painted, its centroid is its place.
            let painted = blot.points(&Skin { bend_per_px: 0.0, ..skin });
            let area: f64 = painted.iter().map(|(_, area)| area).sum();
            let of = |axis: usize| painted.iter().map(|(at, area)| at[axis] * area).sum::<f64>() / area;
            assert!(of(0).hypot(of(1)) <= 0.01, "{k}");
        }
    }
}
