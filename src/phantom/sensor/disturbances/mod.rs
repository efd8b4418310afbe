//! What a day's wear adds to the light of the LED: the pulse, bumps, raised hands, drift over hours (3.1.2 d to g).
//!
//! In: [`DisturbanceSizes`] and a seed. Out: volts at each photodiode over time. The thesis names hand elevation,
//! temperature and the sensor's position as what a design can't take away, and gives no sizes; it says that the pulse
//! is "damped in the capillaries" (Fig. 40) and that the constant part is what counts. Sizes, rates and shapes are
//! *assumed*. In a pulse oximeter's light through the finger the pulse is 1.4 % of the constant part (median of healthy
//! people: Lima, Beelen, Bakker, Crit Care Med 30(6), 2002); under the nail it is taken for an eighth of that: 5 mV of
//! the 2.7 V of a photodiode at rest.
//!
//! Each photodiode has its own share of each disturbance but drift, from 0.5 to 1.5. The pulse does not depend on how
//! hard the finger presses, which a real one does.

mod bumps;
mod elevation;
mod pulse;

use rand::RngExt;
use serde::Serialize;

use super::CHANNELS;
use crate::phantom::motion::wave::{Wave, random_wave};
use crate::phantom::nail::numbers;
use bumps::Bumps;
pub use elevation::Elevation;
pub use pulse::Pulse;

const KIND_DRIFT: u32 = 36;
/// Rates of the drift, hertz: a period of half an hour to three hours.
const DRIFT_HZ: std::ops::Range<f64> = 1.0 / 10_800.0..1.0 / 1800.0;
/// A photodiode's share of a disturbance.
const SHARE: [f64; 2] = [0.5, 1.5];

/// How great the disturbances are.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct DisturbanceSizes {
    /// The pulse's greatest height at a share of 1, volts.
    pub pulse_v: f64,
    /// The greatest bump's height at a share of 1, volts.
    pub bump_v: f64,
    /// How often the sensor or its wires are bumped.
    pub bumps_per_hour: f64,
    /// How much the light changes at most either way as the hand goes up and down, at a share of 1, volts.
    pub elevation_v: f64,
    /// How far each photodiode drifts at most either way over hours, volts.
    pub drift_v: f64,
}

impl DisturbanceSizes {
    /// Nothing is added.
    pub const NONE: Self = Self { pulse_v: 0.0, bump_v: 0.0, elevation_v: 0.0, drift_v: 0.0, ..Self::WORN };
    /// Of a sensor that is worn for hours at a desk.
    pub const WORN: Self =
        Self { pulse_v: 0.005, bump_v: 0.03, bumps_per_hour: 12.0, elevation_v: 0.005, drift_v: 0.01 };

    /// Whether nothing is added.
    #[must_use]
    pub fn is_none(&self) -> bool {
        [self.pulse_v, self.bump_v, self.elevation_v, self.drift_v] == [0.0; 4]
    }
}

/// The disturbances of a scene.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Disturbances {
    /// How great they are.
    pub sizes: DisturbanceSizes,
    /// Of the heart.
    pub pulse: Pulse,
    /// Of the hand's height over the heart.
    pub elevation: Elevation,
    #[serde(skip)]
    bumps: Bumps,
    #[serde(skip)]
    drift: [Wave; CHANNELS],
}

impl Disturbances {
    /// Those of a scene.
    #[must_use]
    pub fn new(seed: u64, sizes: DisturbanceSizes) -> Self {
        Self {
            sizes,
            pulse: Pulse::new(seed),
            elevation: Elevation::new(seed),
            bumps: Bumps::new(seed, sizes.bumps_per_hour),
            drift: std::array::from_fn(|k| random_wave(1.0, DRIFT_HZ, seed, KIND_DRIFT, k as u32)),
        }
    }

    /// What they add at `t_s`, volts.
    #[must_use]
    pub fn at(&self, t_s: f64) -> [f64; CHANNELS] {
        let DisturbanceSizes { pulse_v, bump_v, elevation_v, drift_v, .. } = self.sizes;
        let mut all_v = [0.0; CHANNELS];
        let mut add = |size_v: f64, shares: &dyn Fn() -> [f64; CHANNELS]| {
            if size_v > 0.0 {
                let shares = shares();
                (0..CHANNELS).for_each(|k| all_v[k] += size_v * shares[k]);
            }
        };
        add(pulse_v, &|| self.pulse.at(t_s));
        add(bump_v, &|| self.bumps.at(t_s));
        add(elevation_v, &|| self.elevation.at(t_s));
        add(drift_v, &|| self.drift.map(|wave| wave.at(t_s)));
        all_v
    }
}

/// Each photodiode's share of the disturbance `kind`.
fn shares(seed: u64, kind: u32) -> [f64; CHANNELS] {
    let mut rng = numbers(seed, kind, 0);
    std::array::from_fn(|_| rng.random_range(SHARE[0]..=SHARE[1]))
}

#[cfg(test)]
mod tests {
    use super::*;

    const NONE: DisturbanceSizes = DisturbanceSizes::NONE;

    #[test]
    fn none_adds_nothing_and_all_add_up() {
        assert!(NONE.is_none() && !DisturbanceSizes::WORN.is_none());
        let worn = DisturbanceSizes::WORN;
        let [none, all, pulse, bumps, elevation, drift] = [
            NONE,
            worn,
            DisturbanceSizes { pulse_v: worn.pulse_v, ..NONE },
            DisturbanceSizes { bump_v: worn.bump_v, ..NONE },
            DisturbanceSizes { elevation_v: worn.elevation_v, ..NONE },
            DisturbanceSizes { drift_v: worn.drift_v, ..NONE },
        ]
        .map(|sizes| Disturbances::new(3, sizes));
        for second in 0..20_000 {
            let t_s = 1.37 * f64::from(second);
            assert_eq!(none.at(t_s), [0.0; CHANNELS]);
            let parts = [pulse, bumps, elevation, drift].map(|one| one.at(t_s));
            for k in 0..CHANNELS {
                let sum: f64 = parts.iter().map(|part| part[k]).sum();
                assert!((all.at(t_s)[k] - sum).abs() <= 1e-15);
                assert!(parts[3][k].abs() <= worn.drift_v && parts[0][k].abs() <= 1.5 * 1.2 * worn.pulse_v);
            }
        }
    }

    #[test]
    fn drift_takes_hours() {
        let drift = Disturbances::new(5, DisturbanceSizes { drift_v: 1.0, ..NONE });
        for k in 0..CHANNELS {
            let hours: Vec<f64> = (0..480).map(|minute| drift.at(60.0 * f64::from(minute))[k]).collect();
            // In a minute at most 2 pi times a thirtieth of the size.
            assert!(hours.windows(2).all(|pair| (pair[1] - pair[0]).abs() <= 0.21), "P{}", k + 1);
            let (low, high) = hours.iter().fold((f64::MAX, f64::MIN), |(low, high), v| (low.min(*v), high.max(*v)));
            assert!(high - low >= 0.8, "P{}: {low} to {high}", k + 1);
        }
    }
}
