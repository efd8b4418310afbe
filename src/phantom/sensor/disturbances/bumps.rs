//! Bumps: the finger hits something, a wire pulls at the sensor (3.1.2 d).
//!
//! Time goes in slots, as many an hour as there are bumps; one bump lies anywhere in each. It takes 0.2 to 1 s, is a
//! bell or rocks up to twice, is up to as great as the size says, and every photodiode sees its share of it.

use std::f64::consts::{PI, TAU};

use rand::RngExt;

use super::{CHANNELS, SHARE};
use crate::phantom::nail::numbers;

const KIND_BUMPS: u32 = 34;
/// How long a bump takes, seconds, how great it is as a share of the size, and how often it rocks.
const LENGTH_S: [f64; 2] = [0.2, 1.0];
const HEIGHT: [f64; 2] = [0.3, 1.0];
const ROCKS: [f64; 2] = [0.0, 2.0];

/// The bumps of a scene.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bumps {
    seed: u64,
    slot_s: f64,
}

impl Bumps {
    /// None where there are 0 an hour.
    pub(super) fn new(seed: u64, per_hour: f64) -> Self {
        Self { seed, slot_s: if per_hour > 0.0 { 3600.0 / per_hour } else { f64::INFINITY } }
    }

    /// What each photodiode sees at `t_s`, for a size of 1.
    pub(super) fn at(&self, t_s: f64) -> [f64; CHANNELS] {
        if t_s < 0.0 || self.slot_s.is_infinite() {
            return [0.0; CHANNELS];
        }
        let slot = (t_s / self.slot_s).floor();
        let mut rng = numbers(self.seed, KIND_BUMPS, slot as u32);
        let mut within = |[low, high]: [f64; 2]| rng.random_range(low..=high);
        let length_s = within(LENGTH_S).min(self.slot_s);
        let from_s = self.slot_s * slot + within([0.0, 1.0]) * (self.slot_s - length_s);
        let x = (t_s - from_s) / length_s;
        if !(0.0..=1.0).contains(&x) {
            return [0.0; CHANNELS];
        }
        let (height, rocks, phase) = (within(HEIGHT), within(ROCKS), within([0.0, 1.0]));
        let bump = height * (PI * x).sin().powi(2) * (TAU * (rocks * x + phase)).cos();
        std::array::from_fn(|_| bump * within(SHARE))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_are_as_many_as_were_ordered_each_as_long_as_it_says() {
        let bumps = Bumps::new(4, 30.0);
        let (mut begun_s, mut spans_s, mut greatest) = (None, Vec::new(), 0.0f64);
        for k in 0..1_440_000 {
            let t_s = 5e-3 * f64::from(k);
            let seen = bumps.at(t_s);
            match (seen[0] != 0.0, begun_s) {
                (true, None) => begun_s = Some(t_s),
                (false, Some(from_s)) => {
                    spans_s.push(t_s - from_s);
                    begun_s = None;
                }
                _ => {}
            }
            greatest = seen.iter().fold(greatest, |greatest, v| greatest.max(v.abs()));
        }
        assert_eq!(spans_s.len(), 60, "thirty an hour for two hours");
        assert!(spans_s.iter().all(|span_s| (0.19..=1.01).contains(span_s)), "{spans_s:?}");
        assert!((0.8..=1.5).contains(&greatest), "{greatest}");
        assert_eq!(Bumps::new(4, 0.0).at(100.0), [0.0; CHANNELS]);
    }
}
