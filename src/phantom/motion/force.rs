//! How a fingertip presses and shears (section 3.3, Fig. 23, 26, 29; section 5.2.3, equations 21 to 23).
//!
//! In: the time. Out: `[Fx, Fy, Fz]`, newtons, those of the finger on the surface: pressing is a negative Fz. The
//! trajectories of calibrations are the predictor crate's, which plans with them; [`Cycles`] are the preliminary
//! experiments'.

use std::f64::consts::TAU;
use std::sync::Arc;

use lunula_predictor::{ForceSpace, RandomForce};
pub use lunula_predictor::{RELEASE_S, Spiral};
use serde::Serialize;

use crate::phantom::motion::contacts::Contacts;
use crate::phantom::motion::presses::Presses;

/// Which force is cycled slowly, and which is held.
///
/// Before time 0 it is as at time 0: a shear's experiment begins while the pressing is held already.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Cycles {
    /// Fz from 0 to -4 N and back, no shear (3.3.2, Fig. 23).
    Normal,
    /// Fx to 2 N, to -2 N and back while Fz is held at -3 N; held as well as people can: it swings a little, twice a
    /// cycle (3.3.3, Fig. 26).
    Lateral,
    /// Fy to 2 N, to -2 N and back while Fz is held at -3 N (3.3.4, Fig. 29).
    Longitudinal,
}

/// The greatest pressing of [`Cycles::Normal`], the pressing that is held under shear, and the shear, newtons.
const NORMAL_N: f64 = 4.0;
const HELD_N: f64 = 3.0;
const SHEAR_N: f64 = 2.0;
/// How far the pressing swings under lateral shear, newtons. Fig. 26 is a drawing that says "small but consistent"; the
/// size is assumed.
const SWING_N: f64 = 0.15;

impl Cycles {
    /// The rate of the thesis, hertz.
    pub const HZ: f64 = 0.05;
    /// How many cycles it takes.
    pub const COUNT: u32 = 5;

    /// `[Fx, Fy, Fz]` at `t_s` where the cycle comes `hz` times a second, newtons.
    #[must_use]
    pub fn forces_n(self, hz: f64, t_s: f64) -> [f64; 3] {
        let phase = TAU * hz * t_s.max(0.0);
        let shear_n = SHEAR_N * phase.sin();
        match self {
            Self::Normal => [0.0, 0.0, -0.5 * NORMAL_N * (1.0 - phase.cos())],
            Self::Lateral => [shear_n, 0.0, -(HELD_N - SWING_N * (2.0 * phase).cos())],
            Self::Longitudinal => [0.0, shear_n, -HELD_N],
        }
    }
}

/// How the fingertip presses.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum ForceTrajectory {
    /// Not at all: the finger is in the air.
    None,
    /// The calibration's spiral.
    Spiral(Spiral),
    /// One force slowly up and down, as in the preliminary experiments.
    Cycles {
        /// Normal, lateral or longitudinal.
        which: Cycles,
        /// How often a second.
        hz: f64,
    },
    /// Smooth and band-limited, within the cone of friction of the usual [`Spiral`]: the pressing goes from 0 to its
    /// greatest.
    Random {
        /// Rates lie between 0.4 and 4 times this.
        hz: f64,
        /// Where the random numbers come from.
        seed: u64,
    },
    /// Smooth and band-limited, about evenly all over that cone.
    Even {
        /// Rates lie between 0.4 and 4 times this.
        hz: f64,
        /// Where the random numbers come from.
        seed: u64,
    },
    /// Presses and releases at exact times, without shear.
    Presses(Presses),
    /// Contacts and near misses of the finger's own, which bend it as well.
    Contacts(Contacts),
}

/// A [`ForceTrajectory`] that is ready to be asked often: `[Fx, Fy, Fz]` at a time, newtons.
pub(in crate::phantom) type Press = Arc<dyn Fn(f64) -> [f64; 3] + Send + Sync>;

impl ForceTrajectory {
    /// With `soft_s`, random motion comes out of rest within so many seconds.
    pub(in crate::phantom) fn press(&self, soft_s: Option<f64>) -> Press {
        let random = |motion: RandomForce| -> Press {
            let motion = match soft_s {
                Some(soft_s) => motion.out_of_rest(soft_s, f64::INFINITY),
                None => motion,
            };
            Arc::new(move |t_s| motion.forces_n(t_s))
        };
        match *self {
            // A contact's force goes with its bending: whoever asks for one asks the contacts themselves.
            Self::None | Self::Contacts(_) => Arc::new(|_| [0.0; 3]),
            Self::Spiral(spiral) => Arc::new(move |t_s| spiral.forces_n(t_s)),
            Self::Presses(presses) => Arc::new(move |t_s| presses.forces_n(t_s)),
            Self::Cycles { which, hz } => Arc::new(move |t_s| which.forces_n(hz, t_s)),
            Self::Random { hz, seed } => random(RandomForce::new(ForceSpace::default(), hz, seed)),
            Self::Even { hz, seed } => random(RandomForce::even(ForceSpace::default(), hz, seed)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cycles_have_the_ranges_and_rates_of_the_preliminary_experiments() {
        for (which, shear, least_n, most_n) in [
            (Cycles::Normal, None, -4.0, 0.0),
            (Cycles::Lateral, Some(0), -3.15, -2.85),
            (Cycles::Longitudinal, Some(1), -3.0, -3.0),
        ] {
            let press = ForceTrajectory::Cycles { which, hz: Cycles::HZ }.press(None);
            let all: Vec<[f64; 3]> = (0..=2000).map(|k| press(0.05 * f64::from(k))).collect();
            for axis in 0..3 {
                let (low, high) =
                    all.iter().fold((f64::MAX, f64::MIN), |(low, high), f| (low.min(f[axis]), high.max(f[axis])));
                let expected = match axis {
                    2 => [least_n, most_n],
                    _ if shear == Some(axis) => [-2.0, 2.0],
                    _ => [0.0; 2],
                };
                assert!((low - expected[0]).abs() <= 1e-12 && (high - expected[1]).abs() <= 1e-12, "{which:?} {axis}");
            }
            for (k, now) in all.iter().enumerate().skip(400) {
                assert!((0..3).all(|axis| (now[axis] - all[k - 400][axis]).abs() <= 1e-12), "a cycle takes 20 s");
            }
            // No finger slips under what it does here.
            assert!(all.iter().all(|f| f[0].hypot(f[1]) <= 0.75 * -f[2] + 1e-12));
            assert_eq!(press(-3.0), press(0.0));
        }
        let swings = |t_s: f64| Cycles::Lateral.forces_n(Cycles::HZ, t_s)[2] + 3.0;
        assert!((swings(1.3) - swings(11.3)).abs() <= 1e-12 && (swings(0.0) + swings(5.0)).abs() <= 1e-12);
        assert!((swings(0.0) - 0.15).abs() <= 1e-12, "twice a cycle");
    }

    #[test]
    fn random_forces_are_those_that_every_log_so_far_was_made_of() {
        // From truth/log.csv of `--force random` and these seeds, as the first version wrote it.
        let before = ForceTrajectory::Random { hz: 0.1, seed: 3 }.press(None)(-0.736_290_583_943_329_6);
        assert_eq!(before, [0.352_079_065_887_657_03, -0.074_672_163_413_782_72, -2.581_476_845_979_117_3]);
        let now = ForceTrajectory::Random { hz: 0.1, seed: 5 }.press(None)(1.357_064_920_219_386_3);
        assert_eq!(now, [-0.337_984_698_528_149_16, -0.011_927_929_742_758_973, -0.845_660_617_756_789_6]);
    }
}
