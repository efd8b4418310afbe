//! Light that is not the LED's: lamps' hum and slow changes, as daylight and shadows.

use std::f64::consts::TAU;

use rand::RngExt;
use serde::Serialize;

use crate::phantom::motion::wave::{Wave, random_wave};
use crate::phantom::nail::numbers;

const KIND_AMBIENT: u32 = 24;
/// The hum's share of the swing; the rest is slow.
const HUM_SHARE: f64 = 0.25;
/// Rates of the slow part, hertz.
const SLOW_HZ: std::ops::Range<f64> = 0.03..0.5;

/// Ambient light over time: level (1 + swing (3/4 slow + 1/4 sin(2 pi hum t + phase))), slow a sum of three sinusoids
/// between 0.03 and 0.5 Hz.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Ambient {
    /// Its mean at a photodiode whose share of it is 1, volts.
    pub level_v: f64,
    /// How far it goes up and down at most, as a share.
    pub swing: f64,
    /// Of the lamps, twice the mains' frequency.
    pub hum_hz: f64,
    /// The hum's phase at time 0, turns.
    pub hum_phase: f64,
    #[serde(skip)]
    slow: Wave,
}

impl Ambient {
    /// The light of a scene.
    #[must_use]
    pub fn new(seed: u64, level_v: f64, swing: f64, hum_hz: f64) -> Self {
        let hum_phase = numbers(seed, KIND_AMBIENT, 0).random_range(0.0..1.0);
        Self { level_v, swing, hum_hz, hum_phase, slow: random_wave(1.0, SLOW_HZ, seed, KIND_AMBIENT, 1) }
    }

    /// At the scene's time `t_s`, volts.
    #[must_use]
    pub fn at(&self, t_s: f64) -> f64 {
        let hum = (TAU * (self.hum_hz * t_s + self.hum_phase)).sin();
        self.level_v * (1.0 + self.swing * ((1.0 - HUM_SHARE) * self.slow.at(t_s) + HUM_SHARE * hum))
    }
}
