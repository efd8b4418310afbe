//! Slow drift within a session: creep of the soft tissue (5.2.2: over about 10 minutes) and a slow wander.

use rand::RngExt;
use serde::Serialize;

use super::CHANNELS;
use crate::phantom::motion::wave::{Wave, random_wave};
use crate::phantom::nail::numbers;

const KIND_WANDER: u32 = 25;
/// How long creep takes, seconds.
const CREEP_S: f64 = 600.0;
const RATES_HZ: std::ops::Range<f64> = 1.0 / 600.0..1.0 / 60.0;

/// Drift of each photodiode: size (creep (1 - exp(-t / 600 s)) + wander / 2), t from the log's beginning and no less
/// than 0, creep a number from -1 to 1, wander a sum of three sinusoids of periods from 1 to 10 minutes.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Wander {
    /// About how far it goes, volts.
    pub size_v: f64,
    /// Of each photodiode.
    pub creep: [f64; CHANNELS],
    #[serde(skip)]
    waves: [Wave; CHANNELS],
}

impl Wander {
    /// The drift of a scene.
    #[must_use]
    pub fn new(seed: u64, size_v: f64) -> Self {
        let mut rng = numbers(seed, KIND_WANDER, 0);
        let creep = std::array::from_fn(|_| rng.random_range(-1.0..=1.0));
        let waves = std::array::from_fn(|k| random_wave(1.0, RATES_HZ, seed, KIND_WANDER, 1 + k as u32));
        Self { size_v, creep, waves }
    }

    /// At `t_s`, volts.
    #[must_use]
    pub fn at(&self, t_s: f64) -> [f64; CHANNELS] {
        let crept = 1.0 - (-t_s.max(0.0) / CREEP_S).exp();
        std::array::from_fn(|k| self.size_v * (self.creep[k] * crept + 0.5 * self.waves[k].at(t_s)))
    }
}
