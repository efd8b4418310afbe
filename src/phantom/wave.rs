//! Smooth random movement: sums of sinusoids of random rates and phases.

use std::f64::consts::TAU;
use std::ops::Range;

use rand::RngExt;

use super::nail::numbers;

/// Shares of the sinusoids; they add up to 1.
const SHARES: [f64; 3] = [0.5, 0.3, 0.2];

/// A sum of three sinusoids, from -1 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Wave {
    /// Share, rate in hertz, phase in turns.
    parts: [[f64; 3]; 3],
}

impl Wave {
    /// Rates lie in `rates` times `hz`; `seed`, `kind` and `index` tell the random numbers.
    pub(super) fn random(hz: f64, rates: Range<f64>, seed: u64, kind: u32, index: u32) -> Self {
        let mut rng = numbers(seed, kind, index);
        Self { parts: SHARES.map(|share| [share, hz * rng.random_range(rates.clone()), rng.random_range(0.0..1.0)]) }
    }

    /// Its height at `t_s`.
    pub(super) fn at(&self, t_s: f64) -> f64 {
        self.parts.iter().map(|[share, rate_hz, phase]| share * (TAU * (rate_hz * t_s + phase)).sin()).sum()
    }
}
