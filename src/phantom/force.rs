//! How a fingertip presses and shears (section 5.2.3, equations 21 to 23).
//!
//! In: the time. Out: `[Fx, Fy, Fz]`, newtons, those of the finger on the surface: pressing is a negative Fz. The trajectories themselves are the
//! predictor crate's, which plans calibrations with them.

use lunula_predictor::{ForceSpace, RandomForce};
pub use lunula_predictor::{RELEASE_S, Spiral};
use serde::Serialize;

/// How the fingertip presses.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum ForceTrajectory {
    /// Not at all: the finger is in the air.
    None,
    /// The calibration's spiral.
    Spiral(Spiral),
    /// Smooth and band-limited, within the cone of friction of the usual [`Spiral`]: the pressing goes from 0 to its greatest.
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
}

/// A [`ForceTrajectory`] that is ready to be asked often.
#[derive(Debug, Clone)]
pub(super) enum Press {
    None,
    Spiral(Spiral),
    Random(Box<RandomForce>),
}

impl ForceTrajectory {
    pub(super) fn press(&self) -> Press {
        match self {
            Self::None => Press::None,
            Self::Spiral(spiral) => Press::Spiral(*spiral),
            Self::Random { hz, seed } => Press::Random(Box::new(RandomForce::new(ForceSpace::default(), *hz, *seed))),
            Self::Even { hz, seed } => Press::Random(Box::new(RandomForce::even(ForceSpace::default(), *hz, *seed))),
        }
    }

    /// `[Fx, Fy, Fz]` at `t_s`, newtons.
    #[must_use]
    pub fn forces_n(&self, t_s: f64) -> [f64; 3] {
        self.press().forces_n(t_s)
    }
}

impl Press {
    /// The same, but nothing is pressed before time 0; random motion comes out of rest within `soft_s`.
    pub(super) fn out_of_rest(self, soft_s: f64) -> Self {
        match self {
            Self::Random(random) => Self::Random(Box::new(random.out_of_rest(soft_s, f64::INFINITY))),
            other => other,
        }
    }

    /// `[Fx, Fy, Fz]` at `t_s`, newtons.
    pub(super) fn forces_n(&self, t_s: f64) -> [f64; 3] {
        match self {
            Self::None => [0.0; 3],
            Self::Spiral(spiral) => spiral.forces_n(t_s),
            Self::Random(random) => random.forces_n(t_s),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forces_stay_within_the_cone_of_friction() {
        let random = ForceTrajectory::Random { hz: 0.1, seed: 5 }.press();
        let spiral = ForceTrajectory::Spiral(Spiral::default()).press();
        let mut greatest = 0.0f64;
        for k in 0..4000 {
            for press in [&random, &spiral] {
                let [fx, fy, fz] = press.forces_n(0.05 * f64::from(k));
                assert!((-3.0..=0.0).contains(&fz) && fx.hypot(fy) <= -0.75 * fz + 1e-12);
            }
            greatest = greatest.max(-random.forces_n(0.05 * f64::from(k))[2]);
        }
        assert!(greatest > 2.4);
        assert_ne!(random.forces_n(1.0), ForceTrajectory::Random { hz: 0.1, seed: 6 }.forces_n(1.0));
    }

    #[test]
    fn random_forces_are_those_that_every_log_so_far_was_made_of() {
        // From truth/log.csv of `--force random` and these seeds, as the first version wrote it.
        let before = ForceTrajectory::Random { hz: 0.1, seed: 3 }.forces_n(-0.736_290_583_943_329_6);
        assert_eq!(before, [0.352_079_065_887_657_03, -0.074_672_163_413_782_72, -2.581_476_845_979_117_3]);
        let now = ForceTrajectory::Random { hz: 0.1, seed: 5 }.forces_n(1.357_064_920_219_386_3);
        assert_eq!(now, [-0.337_984_698_528_149_16, -0.011_927_929_742_758_973, -0.845_660_617_756_789_6]);
    }
}
