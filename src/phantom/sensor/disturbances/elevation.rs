//! The hand goes up and down: blood pressure in the finger changes with its height over the heart (3.1.2 e).
//!
//! Time goes in slots of five minutes; in each the hand goes within 2 to 6 s from the height of before to another, and
//! stays there. Heights are even between the extremes (*assumed*: at a desk).

use rand::RngExt;
use serde::Serialize;

use super::{CHANNELS, shares};
use crate::phantom::nail::numbers;

const KIND_ELEVATION: u32 = 35;
const KIND_SHARES: u32 = 38;
/// A slot, and how long a hand takes, seconds.
const SLOT_S: f64 = 300.0;
const TAKES_S: [f64; 2] = [2.0, 6.0];

/// The hand's height.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Elevation {
    #[serde(skip)]
    seed: u64,
    /// Each photodiode's share.
    pub shares: [f64; CHANNELS],
}

impl Elevation {
    /// That of a scene.
    pub(super) fn new(seed: u64) -> Self {
        Self { seed, shares: shares(seed, KIND_SHARES) }
    }

    /// What each photodiode sees at `t_s`, for a size of 1.
    pub(super) fn at(&self, t_s: f64) -> [f64; CHANNELS] {
        let slot = (t_s / SLOT_S).floor().max(0.0);
        let [before, (height, at, takes_s)] = [slot as u32, slot as u32 + 1].map(|index| {
            let mut rng = numbers(self.seed, KIND_ELEVATION, index);
            let mut within = |[low, high]: [f64; 2]| rng.random_range(low..=high);
            (within([-1.0, 1.0]), within([0.0, 1.0]), within(TAKES_S))
        });
        let from_s = SLOT_S * slot + at * (SLOT_S - takes_s);
        let x = ((t_s - from_s) / takes_s).clamp(0.0, 1.0);
        let now = before.0 + (height - before.0) * x * x * (3.0 - 2.0 * x);
        self.shares.map(|share| share * now)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hand_goes_once_in_five_minutes_and_stays() {
        let hand = Elevation::new(2);
        let heights: Vec<f64> = (0..36_000).map(|k| hand.at(0.1 * f64::from(k))[3] / hand.shares[3]).collect();
        assert!(heights.iter().all(|height| height.abs() <= 1.0));
        let moves = heights.windows(2).filter(|pair| pair[0] != pair[1]).count();
        // Twelve moves of 2 to 6 s.
        assert!((240..=732).contains(&moves), "{moves}");
        // The fastest: from one extreme to the other in 2 s.
        assert!(heights.windows(2).all(|pair| (pair[1] - pair[0]).abs() <= 0.1 * 2.0 * 1.5 / 2.0 + 1e-12));
        let levels: Vec<f64> = (0..12).map(|slot| heights[3000 * slot]).collect();
        assert!(levels.windows(2).all(|pair| pair[0] != pair[1]), "{levels:?}");
    }
}
