//! What is not static: hysteresis and the blood's lag.
//!
//! Each of N, Fx, Fy and J2 goes through a play of half width h, as a pin in a slot: p is x held to p - h..p + h, and
//! the static map gets the middle of x and p. It does not depend on speed. Of forces h = 0.5 N / (N + 2): it vanishes
//! when the finger lets go. Of J2 it is half a degree.
//!
//! Then what the static map gives, of a [`Sensor`] the forces' part and bending's part of each photodiode, of the
//! nail's own colour the zones' weights, follows with a lag of first order, tau y' = s - y. For forces tau is one while
//! the pressing grows and another while it falls or stays (4.3: blood leaves and comes back at different speeds).
//!
//! Time goes in steps of a millisecond that start at a given time. Within a step the static map is taken for a straight
//! line, along which the lag is exact; a moment between two steps is reached by a part of one, so that what is asked
//! for does not change what comes after.

use clap::Args;
use serde::Serialize;

use super::{CHANNELS, Sensor, Touch};

/// A step, seconds.
const STEP_S: f64 = 1e-3;
/// Half width of the plays of forces at great pressing, and the pressing at which it is half of that, newtons.
const PLAY_N: f64 = 0.5;
const PLAY_HALF_N: f64 = 2.0;
/// Half width of the play of J2, radians.
const PLAY_RAD: f64 = 0.5 * std::f64::consts::PI / 180.0;
/// The play's share in what the static map gets.
const PLAY_SHARE: f64 = 0.5;

/// How much there is of what is not static.
#[derive(Debug, Clone, Copy, PartialEq, Args, Serialize)]
pub struct Dynamics {
    /// The blood's lag as a share of the usual 0.12 to 0.36 s; 0: none
    #[arg(long, value_name = "SHARE", default_value_t = 1.0)]
    pub lag: f64,
    /// Hysteresis as a share of the usual; 0: none
    #[arg(long, value_name = "SHARE", default_value_t = 1.0)]
    pub hysteresis: f64,
}

impl Default for Dynamics {
    fn default() -> Self {
        Self { lag: 1.0, hysteresis: 1.0 }
    }
}

/// What follows a movement: `N` values that a static map gives, each with lags of its own.
pub trait Following<const N: usize> {
    /// The static map of what is felt: N = -Fz, Fx, Fy newtons, J2 radians.
    fn drive(&self, felt: [f64; 4]) -> [f64; N];
    /// How slowly each follows while the pressing grows, and while it does not, seconds.
    fn lags_s(&self) -> [[f64; 2]; N];
}

/// Of each photodiode the forces' part and bending's part, volts before the gain.
const PARTS: usize = 2 * CHANNELS;

impl Following<PARTS> for Sensor {
    fn drive(&self, [pressing_n, fx_n, fy_n, j2_rad]: [f64; 4]) -> [f64; PARTS] {
        let parts = self.photodiodes.map(|one| [one.touch_v([fx_n, fy_n, -pressing_n]), one.bend_v(j2_rad)]);
        std::array::from_fn(|k| parts[k / 2][k % 2])
    }

    fn lags_s(&self) -> [[f64; 2]; PARTS] {
        let lags = self.photodiodes.map(|one| [[one.loading_s, one.unloading_s], [one.bending_s; 2]]);
        std::array::from_fn(|k| lags[k / 2][k % 2])
    }
}

/// State of the plays and of the lags at a time.
#[derive(Debug, Clone, Copy)]
struct State<const N: usize> {
    /// N, Fx, Fy, J2.
    plays: [f64; 4],
    pressing_n: f64,
    /// The static map behind the plays.
    drive: [f64; N],
    /// What has followed.
    followed: [f64; N],
}

/// A sensor, or a nail's colour, that follows a movement: what the finger does at a time.
pub struct Response<S, M, const N: usize> {
    map: S,
    dynamics: Dynamics,
    movement: M,
    start_s: f64,
    steps: u64,
    state: State<N>,
    lags_s: [[f64; 2]; N],
    /// For each value exp(-step / tau): loading, unloading.
    decays: [[f64; 2]; N],
}

impl<M: FnMut(f64) -> Touch> Response<Sensor, M, PARTS> {
    /// What each photodiode adds at `t_s` when the LED is on, volts. Times are asked for in ascending order, none
    /// before the start.
    pub fn at(&mut self, t_s: f64) -> [f64; CHANNELS] {
        let followed = self.followed(t_s);
        std::array::from_fn(|k| {
            let one = &self.map.photodiodes[k];
            one.rest_v + one.gain * (followed[2 * k] + followed[2 * k + 1])
        })
    }
}

impl<S: Following<N> + Clone, M: FnMut(f64) -> Touch, const N: usize> Response<S, M, N> {
    /// Begins in equilibrium at `start_s`.
    #[must_use]
    pub fn new(map: &S, dynamics: Dynamics, mut movement: M, start_s: f64) -> Self {
        let touch = movement(start_s);
        let plays = inputs(&touch);
        let drive = map.drive(plays);
        let state = State { plays, pressing_n: plays[0], drive, followed: drive };
        let lags_s = map.lags_s();
        let decays = decays(&lags_s, dynamics, STEP_S);
        Self { map: map.clone(), dynamics, movement, start_s, steps: 0, state, lags_s, decays }
    }

    /// What has followed at `t_s`. Times are asked for in ascending order, none before the start.
    pub fn followed(&mut self, t_s: f64) -> [f64; N] {
        let whole = ((t_s - self.start_s) / STEP_S).floor().max(0.0) as u64;
        while self.steps < whole {
            self.steps += 1;
            let touch = (self.movement)(self.start_s + self.steps as f64 * STEP_S);
            self.state = self.after(&touch, STEP_S, &self.decays);
        }
        let part_s = t_s - (self.start_s + self.steps as f64 * STEP_S);
        if part_s > 0.0 {
            let touch = (self.movement)(t_s);
            self.after(&touch, part_s, &decays(&self.lags_s, self.dynamics, part_s)).followed
        } else {
            self.state.followed
        }
    }

    /// The state `step_s` later, where the finger does `touch`.
    fn after(&self, touch: &Touch, step_s: f64, decays: &[[f64; 2]; N]) -> State<N> {
        let old = &self.state;
        let is = inputs(touch);
        let play_n = PLAY_N * is[0].max(0.0) / (is[0].max(0.0) + PLAY_HALF_N);
        let half = [play_n, play_n, play_n, PLAY_RAD].map(|half| self.dynamics.hysteresis * half);
        let plays: [f64; 4] = std::array::from_fn(|k| old.plays[k].clamp(is[k] - half[k], is[k] + half[k]));
        let felt = std::array::from_fn(|k| is[k] + PLAY_SHARE * (plays[k] - is[k]));
        let drive = self.map.drive(felt);
        let way = usize::from(is[0] <= old.pressing_n);
        let followed = std::array::from_fn(|k| {
            let (from, to) = (old.drive[k], drive[k]);
            // Along a straight line the lag settles at tau times its slope.
            let behind = self.dynamics.lag * self.lags_s[k][way] * (to - from) / step_s;
            to - behind + (old.followed[k] - from + behind) * decays[k][way]
        });
        State { plays, pressing_n: is[0], drive, followed }
    }
}

/// N, Fx, Fy in newtons, J2 in radians.
fn inputs(touch: &Touch) -> [f64; 4] {
    let [fx_n, fy_n, fz_n] = touch.forces_n;
    [-fz_n, fx_n, fy_n, touch.angles_rad[1]]
}

fn decays<const N: usize>(lags_s: &[[f64; 2]; N], dynamics: Dynamics, step_s: f64) -> [[f64; 2]; N] {
    // Without any lag, nothing is left of what was: exp(-infinity).
    lags_s.map(|lags_s| lags_s.map(|tau_s| (-step_s / (dynamics.lag * tau_s)).exp()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pressing(newtons: f64) -> Touch {
        Touch { forces_n: [0.0, 0.0, -newtons], angles_rad: [0.0; 3] }
    }

    /// By how much of its way a photodiode's volts have come at each of `times_s`.
    fn way(sensor: &Sensor, photodiode: usize, movement: &dyn Fn(f64) -> Touch, times_s: &[f64]) -> Vec<f64> {
        let dynamics = Dynamics { hysteresis: 0.0, ..Dynamics::default() };
        let mut response = Response::new(sensor, dynamics, movement, 0.0);
        let from = sensor.static_v(&movement(0.0))[photodiode];
        let to = sensor.static_v(&movement(100.0))[photodiode];
        times_s.iter().map(|&t_s| (response.at(t_s)[photodiode] - from) / (to - from)).collect()
    }

    #[test]
    fn blood_follows_with_one_lag_in_loading_and_another_in_unloading() {
        // The jump takes one step, half of which counts: 0.3 % of the least lag. Measured: 0.0001, as what is left of
        // loading falls with its lag.
        const NEAR: f64 = 0.002;
        let sensor = Sensor::new(3, 1);
        for (k, one) in sensor.photodiodes.iter().enumerate() {
            for (tau_s, from_n, to_n) in [(one.loading_s, 0.2, 2.0), (one.unloading_s, 2.0, 0.2)] {
                // From step 1000 on a ramp so slight that the finger goes on loading or unloading.
                let movement = move |t_s: f64| {
                    let slight = 1e-9 * (t_s - 1.0).max(0.0) * f64::signum(to_n - from_n);
                    pressing(if t_s < 0.9995 { from_n } else { to_n } + slight)
                };
                let ways = way(&sensor, k, &movement, &[0.99, 0.9995 + tau_s, 0.9995 + 3.0 * tau_s]);
                assert!(ways[0].abs() <= 1e-9);
                assert!((ways[1] - (1.0 - (-1f64).exp())).abs() <= NEAR, "P{} {ways:?}", k + 1);
                assert!((ways[2] - (1.0 - (-3f64).exp())).abs() <= NEAR, "P{} {ways:?}", k + 1);
            }
        }
    }

    #[test]
    fn the_steps_are_fine_enough() {
        // A straight line in each step errs by a part of the step's square; measured 1.7e-6 at 1 Hz against steps a
        // hundredth as long, a hundredth of the converter's step.
        const NEAR_V: f64 = 2.5e-6;
        let sensor = Sensor::new(1, 1);
        let angle = |t_s: f64| 0.3 + 0.4 * (6.0 * t_s).sin();
        let movement = |t_s: f64| Touch { forces_n: [0.0; 3], angles_rad: [0.0, angle(t_s), 0.0] };
        let mut response = Response::new(&sensor, Dynamics { hysteresis: 0.0, ..Dynamics::default() }, &movement, 0.0);
        let one = &sensor.photodiodes[1];
        let (mut blood, mut worst) = (one.bend_v(angle(0.0)), 0.0f64);
        const FINE_S: f64 = 1e-5;
        for k in 1..=200_000 {
            let drive = one.bend_v(angle((f64::from(k) - 0.5) * FINE_S));
            blood += (drive - blood) * (1.0 - (-FINE_S / one.bending_s).exp());
            if k % 777 == 0 {
                let volts = response.at(f64::from(k) * FINE_S)[1];
                worst = worst.max((volts - (one.rest_v + one.gain * (one.touch_v([0.0; 3]) + blood))).abs());
            }
        }
        assert!(worst <= NEAR_V, "{worst}");
    }

    #[test]
    fn what_is_asked_for_does_not_change_what_comes_after() {
        let sensor = Sensor::new(1, 1);
        let movement = |t_s: f64| pressing(1.5 + (3.0 * t_s).sin());
        let last = |times_s: &[f64]| {
            let mut response = Response::new(&sensor, Dynamics::default(), &movement, -1.0);
            times_s.iter().map(|&t_s| response.at(t_s)).last()
        };
        assert_eq!(last(&[2.0]), last(&[-0.5, 0.000_4, 1.234_567, 1.999_9, 2.0]));
    }

    #[test]
    fn hysteresis_is_evident_for_force_and_little_for_bending() {
        // The experiments of 3.3.2 and 3.3.5: the widest gap between the two ways as a share of the range, the mean
        // over the photodiodes that take part. Measured over 16 people: 0.169 to 0.200 and 0.077 to 0.086.
        let widest = |movement: &dyn Fn(f64) -> Touch, period_s: f64, sensor: &Sensor, photodiodes: &[usize]| {
            let mut response = Response::new(sensor, Dynamics::default(), movement, -period_s);
            let halves = 400;
            let volts: Vec<_> =
                (0..=2 * halves).map(|k| response.at(0.5 * period_s * f64::from(k) / f64::from(halves))).collect();
            let mean = photodiodes.iter().map(|&p| {
                let (low, high) =
                    volts.iter().fold((f64::MAX, f64::MIN), |(low, high), v| (v[p].min(low), v[p].max(high)));
                let gap = (0..=halves as usize)
                    .map(|k| (volts[k][p] - volts[2 * halves as usize - k][p]).abs())
                    .fold(0.0, f64::max);
                gap / (high - low) / photodiodes.len() as f64
            });
            mean.sum::<f64>()
        };
        for subject in 0..16 {
            let sensor = Sensor::new(subject, 1);
            let cycle = |t_s: f64| 1.0 - (std::f64::consts::TAU * t_s).cos();
            let force = widest(&|t_s| pressing(2.0 * cycle(t_s / 20.0)), 20.0, &sensor, &[0, 1]);
            let bend = |t_s: f64| Touch {
                forces_n: [0.0; 3],
                angles_rad: [0.0, (40.0 * cycle(t_s / 10.0) - 5.0).to_radians(), 0.0],
            };
            let bending = widest(&bend, 10.0, &sensor, &[0, 1, 2, 3, 4, 5, 6, 7]);
            assert!((0.1..=0.3).contains(&force) && bending <= 0.5 * force, "{force} {bending}");
        }
    }

    #[test]
    fn without_lag_and_hysteresis_it_is_the_static_map() {
        let sensor = Sensor::new(2, 1);
        let movement = |t_s: f64| pressing(1.5 + (9.0 * t_s).sin());
        let mut response = Response::new(&sensor, Dynamics { lag: 0.0, hysteresis: 0.0 }, &movement, 0.0);
        for t_s in [0.0, 0.3, 1.000_3, 2.0] {
            let (followed, still) = (response.at(t_s), sensor.static_v(&movement(t_s)));
            assert!((0..CHANNELS).all(|k| (followed[k] - still[k]).abs() <= 1e-12));
        }
    }
}
