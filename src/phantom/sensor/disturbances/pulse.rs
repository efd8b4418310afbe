//! The heart's pulse in the light that comes back: less when the vessels fill.
//!
//! height = -(1 + 0.2 sin b) (sin h + 0.4 sin (2 h + 1)) / 1.376, h the heart's phase and b that of breathing. The
//! heart beats at a mean rate from 0.8 to 1.3 Hz, which breathing and slower waves of 0.04 to 0.15 Hz move by some
//! hundredths; breathing takes 0.2 to 0.3 Hz. All *assumed*, after the textbook's pulse of a resting person.

use std::f64::consts::TAU;

use rand::RngExt;
use serde::Serialize;

use super::{CHANNELS, shares};
use crate::phantom::motion::wave::{Wave, random_wave};
use crate::phantom::nail::numbers;

const KIND_PULSE: u32 = 33;
const KIND_SHARES: u32 = 37;
/// Mean rates of hearts and of breathing, hertz.
const HEART_HZ: [f64; 2] = [0.8, 1.3];
const BREATH_HZ: [f64; 2] = [0.2, 0.3];
/// Slow waves of the heart's phase, hertz, and their size and breathing's, turns.
const SLOW_HZ: std::ops::Range<f64> = 0.04..0.15;
const SLOW_TURNS: f64 = 0.08;
const BREATH_TURNS: f64 = 0.015;
/// How much breathing changes the height, and the second harmonic's share and phase.
const BREATH_SHARE: f64 = 0.2;
const SECOND: [f64; 2] = [0.4, 1.0];
/// The greatest of sin h + 0.4 sin (2 h + 1): 1.3751.
const GREATEST: f64 = 1.376;

/// A pulse.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Pulse {
    /// The heart's mean rate, hertz.
    pub heart_hz: f64,
    /// The rate of breathing, hertz.
    pub breath_hz: f64,
    /// Each photodiode's share.
    pub shares: [f64; CHANNELS],
    /// Where breathing begins, turns.
    #[serde(skip)]
    breath: f64,
    #[serde(skip)]
    slow: Wave,
}

impl Pulse {
    /// The pulse of a scene.
    pub(super) fn new(seed: u64) -> Self {
        let mut rng = numbers(seed, KIND_PULSE, 0);
        let mut within = |[low, high]: [f64; 2]| rng.random_range(low..=high);
        let (heart_hz, breath_hz, breath) = (within(HEART_HZ), within(BREATH_HZ), within([0.0, 1.0]));
        let slow = random_wave(1.0, SLOW_HZ, seed, KIND_PULSE, 1);
        Self { heart_hz, breath_hz, shares: shares(seed, KIND_SHARES), breath, slow }
    }

    /// The height at each photodiode at `t_s`, for a size of 1.
    pub(super) fn at(&self, t_s: f64) -> [f64; CHANNELS] {
        let breath = (TAU * (self.breath_hz * t_s + self.breath)).sin();
        let heart = TAU * (self.heart_hz * t_s + SLOW_TURNS * self.slow.at(t_s) + BREATH_TURNS * breath);
        let [share, phase] = SECOND;
        let height = (1.0 + BREATH_SHARE * breath) * (heart.sin() + share * (2.0 * heart + phase).sin()) / GREATEST;
        self.shares.map(|share| -share * height)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hearts_beat_at_their_rates_and_no_two_seconds_are_alike() {
        let mut rates = Vec::new();
        for seed in 0..20 {
            let pulse = Pulse::new(seed);
            let heights: Vec<f64> = (0..60_000).map(|k| pulse.at(0.01 * f64::from(k))[0] / pulse.shares[0]).collect();
            let greatest = heights.iter().fold(0.0f64, |greatest, v| greatest.max(v.abs()));
            assert!((1.1..=1.2).contains(&greatest), "{greatest}");
            // The light falls through 0 once a beat: the second harmonic is too small for more.
            let beats: Vec<usize> = (1..heights.len()).filter(|&k| heights[k - 1] > 0.0 && heights[k] <= 0.0).collect();
            let hz = (beats.len() - 1) as f64 / (0.01 * (beats[beats.len() - 1] - beats[0]) as f64);
            assert!((hz / pulse.heart_hz - 1.0).abs() <= 0.002, "{hz} {}", pulse.heart_hz);
            // Standard deviation of the time between beats as a share: some hundredths, as a person's at rest.
            let times: Vec<f64> = beats.windows(2).map(|pair| 0.01 * (pair[1] - pair[0]) as f64 * hz).collect();
            let sd = (times.iter().map(|t| (t - 1.0).powi(2)).sum::<f64>() / times.len() as f64).sqrt();
            assert!((0.01..=0.06).contains(&sd), "{sd}");
            rates.push(pulse.heart_hz);
        }
        assert!(rates.iter().all(|hz| (0.8..=1.3).contains(hz)));
        assert!(rates.iter().any(|hz| *hz < 0.95) && rates.iter().any(|hz| *hz > 1.15));
    }
}
