//! The light on each frame: its level, its colour, its gradient over the picture and its glare on the nail, which all
//! change with time.
//!
//! In: the options, a time and an encoded colour. Out: that colour in the light of its place. Light is multiplied and
//! glare added before a camera encodes, so the curve that the film is read with is undone for both. A gradient turns
//! once in 40 s; level, colour and glare drift with rates of 0.02 to 0.2 Hz (assumed). Glare is a streak along the
//! nail, a twentieth of the nail wide.

use std::f64::consts::TAU;

use rand::RngExt;

use super::{Affine, NailVideoOptions};
use crate::phantom::motion::wave::{Wave, random_wave};
use crate::phantom::nail::{NailScene, numbers};
use crate::video::{Curve, Lit, Times};

const KIND_LIGHT: u32 = 43;
const DRIFT_HZ: f64 = 0.05;
const TURN_S: f64 = 40.0;

/// The light of a scene.
#[derive(Debug, Clone)]
pub(super) struct DriftingLight {
    options: NailVideoOptions,
    curve: Curve,
    times: Times,
    phase: f64,
    waves: [Wave; 4],
    nail: NailScene,
}

/// Standard deviations of the glare across and along, of the nail's half width and length, and how far its middle goes
/// from the nail's.
const GLARE: [f64; 2] = [0.05, 0.22];
const GLARE_REACH: [f64; 2] = [0.5, 0.3];
/// Glare below this, of full white, changes nothing by more than 0.12 of 255 (4.5 times as much, of what is black).
const LEAST_GLARE: f64 = 1e-4;

#[derive(Debug, Clone, Copy)]
pub(super) struct FrameLight<'a> {
    of: &'a DriftingLight,
    /// In the picture's middle: red, green, blue; none where they are as they were.
    channels: Option<[Lit; 3]>,
    /// Change from the middle to the right border and to the lower one.
    gradient: [f64; 2],
    half_px: [f64; 2],
    /// How strong glare is, its middle, the nail's direction to the right and the glare's size, pixels.
    glare: f64,
    glare_px: [f64; 2],
    right: [f64; 2],
    size_px: [f64; 2],
}

impl DriftingLight {
    pub(super) fn new(options: &NailVideoOptions, scene: &NailScene) -> Self {
        let wave = |index: u32| random_wave(DRIFT_HZ, 0.4..4.0, options.seed, KIND_LIGHT, index);
        Self {
            curve: options.curve(),
            times: Times::new(options.curve()),
            phase: numbers(options.seed, KIND_LIGHT, 2).random_range(0.0..TAU),
            waves: [wave(0), wave(1), wave(3), wave(4)],
            nail: scene.clone(),
            options: options.clone(),
        }
    }

    /// At `t_s`, when the hand has come so far as `motion` says. Level and colour are those of the first frame but for
    /// what has changed since.
    pub(super) fn at(&self, t_s: f64, motion: &Affine) -> FrameLight<'_> {
        let NailVideoOptions { size, flicker_percent, flicker_hz, light_drift_percent, .. } = self.options;
        let NailVideoOptions { colour_drift_percent, gradient_percent, glare_percent, .. } = self.options;
        let [level, colour, ..] = self.waves.map(|wave| 0.5 * (wave.at(t_s) - wave.at(0.0)));
        let flicker = 1.0 + 0.01 * flicker_percent * (TAU * flicker_hz * t_s + self.phase).sin();
        let level = flicker * (1.0 + 0.01 * light_drift_percent * level);
        let colour = 0.01 * colour_drift_percent * colour;
        let (sin, cos) = (self.phase + TAU * t_s / TURN_S).sin_cos();
        let channels = [level * (1.0 + colour), level, level * (1.0 - colour)];
        FrameLight {
            of: self,
            channels: (channels != [1.0; 3]).then(|| channels.map(|channel| self.curve.times(channel))),
            gradient: [cos, sin].map(|part| 0.01 * gradient_percent * part),
            half_px: [size.0, size.1].map(|side| 0.5 * f64::from(side)),
            glare: 0.01 * glare_percent,
            glare_px: {
                let [u, v] = [0, 1].map(|axis| GLARE_REACH[axis] * self.waves[2 + axis].at(t_s));
                motion.apply(self.nail.picture_from_nail(u, v))
            },
            right: self.nail.axis().right(),
            size_px: [0.5 * GLARE[0] * self.nail.width_px(), 0.5 * GLARE[1] * self.nail.length_px()],
        }
    }
}

impl FrameLight<'_> {
    /// An encoded colour in the light at a pixel.
    pub(super) fn on(&self, colour: [f32; 3], at: [f64; 2]) -> [f32; 3] {
        let mut lit = colour;
        if let Some(channels) = self.over(at) {
            (0..3).for_each(|c| lit[c] = channels[c].of(f64::from(lit[c])) as f32);
        }
        let mirrored = self.mirrored(at);
        if mirrored > LEAST_GLARE {
            lit = lit.map(|part| {
                let light = self.of.curve.light(f64::from(part));
                self.of.curve.encoded(light + (1.0 - light).max(0.0) * mirrored) as f32
            });
        }
        lit
    }

    /// How much of full white is mirrored at a pixel.
    fn mirrored(&self, [x, y]: [f64; 2]) -> f64 {
        if self.glare == 0.0 {
            return 0.0;
        }
        let [rx, ry] = self.right;
        let d = [x - self.glare_px[0], y - self.glare_px[1]];
        let across = (d[0] * rx + d[1] * ry) / self.size_px[0];
        let along = (d[0] * ry - d[1] * rx) / self.size_px[1];
        self.glare * (-0.5 * (across * across + along * along)).exp()
    }

    /// What the light of red, green and blue is multiplied by at a pixel.
    pub(super) fn factors(&self, at: [f64; 2]) -> [f64; 3] {
        self.over(at).map_or([1.0; 3], |channels| channels.map(Lit::factor))
    }

    /// None where the light is as it was.
    fn over(&self, [x, y]: [f64; 2]) -> Option<[Lit; 3]> {
        if self.gradient == [0.0; 2] {
            return self.channels;
        }
        let [right, down] = [(x + 0.5) / self.half_px[0] - 1.0, (y + 0.5) / self.half_px[1] - 1.0];
        let here = self.of.times.of((1.0 + self.gradient[0] * right + self.gradient[1] * down).max(0.0));
        Some(self.channels.map_or([here; 3], |channels| channels.map(|channel| channel.and(here))))
    }
}
