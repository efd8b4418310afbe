//! How a fingertip presses and shears (section 5.2.3, equations 21 to 23).
//!
//! In: the time. Out: `[Fx, Fy, Fz]`, newtons, those of the finger on the surface: pressing is a negative Fz. The equations' own F_z is how
//! hard the finger presses, here the pressing N = -Fz:
//!
//! - (21) N = N_max sqrt(t / T)
//! - (22) F_r = mu N sin(2 pi f_s N)
//! - (23) F_x = F_r sin(2 pi f_c t), F_y = F_r cos(2 pi f_c t)
//!
//! Departures: equation 21 begins infinitely fast, so a cubic that meets it in value and slope takes its place in the first seconds
//! ([`Spiral::soft_s`]); after T the finger lets go within [`RELEASE_S`].

use std::f64::consts::{FRAC_1_SQRT_2, TAU};

use serde::Serialize;

use super::wave::Wave;

const KIND_FORCE: u32 = 21;
/// How long the finger takes to let go after the spiral's end, seconds.
pub const RELEASE_S: f64 = 2.0;

/// The spiral of equations 21 to 23.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Spiral {
    /// N_max, newtons.
    pub fz_max_n: f64,
    /// T, seconds.
    pub duration_s: f64,
    /// mu, the coefficient of friction.
    pub mu: f64,
    /// f_s, cycles a newton.
    pub fs_per_n: f64,
    /// f_c, hertz.
    pub fc_hz: f64,
    /// How long the beginning is not equation 21's but a soft start, seconds.
    pub soft_s: f64,
}

impl Default for Spiral {
    fn default() -> Self {
        Self { fz_max_n: 3.0, duration_s: 180.0, mu: 0.75, fs_per_n: 1.0, fc_hz: 0.15, soft_s: 2.0 }
    }
}

impl Spiral {
    /// Equation 21 with its soft start: how hard the finger presses, newtons; 0 before time 0.
    #[must_use]
    pub fn pressing_n(&self, t_s: f64) -> f64 {
        let soft_s = self.soft_s.min(self.duration_s);
        let root = |t_s: f64| self.fz_max_n * (t_s / self.duration_s).sqrt();
        if t_s <= 0.0 {
            0.0
        } else if t_s < soft_s {
            // From 0 with slope 0 to the root's value and slope.
            let x = t_s / soft_s;
            root(soft_s) * x * x * (2.5 - 1.5 * x)
        } else {
            root(t_s.min(self.duration_s))
        }
    }

    /// Equation 22: the shear force along its direction, newtons, at a pressing.
    #[must_use]
    pub fn shear_n(&self, pressing_n: f64) -> f64 {
        self.mu * pressing_n * (TAU * self.fs_per_n * pressing_n).sin()
    }

    /// Equation 23 and the pressing's sign: `[Fx, Fy, Fz]`, newtons.
    #[must_use]
    pub fn forces_n(&self, t_s: f64) -> [f64; 3] {
        let until_s = t_s.min(self.duration_s);
        let pressing_n = self.pressing_n(until_s);
        let shear_n = self.shear_n(pressing_n);
        let (sin, cos) = (TAU * self.fc_hz * until_s).sin_cos();
        let late = ((t_s - self.duration_s) / RELEASE_S).clamp(0.0, 1.0);
        let left = 1.0 - late * late * (3.0 - 2.0 * late);
        [left * shear_n * sin, left * shear_n * cos, -left * pressing_n]
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
    /// Smooth and band-limited, within the cone of friction of the usual [`Spiral`]: the pressing goes from 0 to its greatest.
    Random {
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
    /// Of the pressing, of Fx, of Fy.
    Random([Wave; 3]),
}

impl ForceTrajectory {
    pub(super) fn press(&self) -> Press {
        match self {
            Self::None => Press::None,
            Self::Spiral(spiral) => Press::Spiral(*spiral),
            Self::Random { hz, seed } => {
                Press::Random([0, 1, 2].map(|index| Wave::random(*hz, 0.4..4.0, *seed, KIND_FORCE, index)))
            }
        }
    }

    /// `[Fx, Fy, Fz]` at `t_s`, newtons.
    #[must_use]
    pub fn forces_n(&self, t_s: f64) -> [f64; 3] {
        self.press().forces_n(t_s)
    }
}

impl Press {
    /// `[Fx, Fy, Fz]` at `t_s`, newtons.
    pub(super) fn forces_n(&self, t_s: f64) -> [f64; 3] {
        match self {
            Self::None => [0.0; 3],
            Self::Spiral(spiral) => spiral.forces_n(t_s),
            Self::Random([pressing, x, y]) => {
                let Spiral { fz_max_n, mu, .. } = Spiral::default();
                let pressing_n = 0.5 * fz_max_n * (1.0 + pressing.at(t_s));
                // Two waves of at most 1 each lie in the circle of radius sqrt 2.
                let shear_n = FRAC_1_SQRT_2 * mu * pressing_n;
                [shear_n * x.at(t_s), shear_n * y.at(t_s), -pressing_n]
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_spiral_is_the_thesis_from_the_soft_start_on() {
        let spiral = Spiral::default();
        assert!((spiral.pressing_n(45.0) - 1.5).abs() <= 1e-12 && (spiral.pressing_n(180.0) - 3.0).abs() <= 1e-12);
        for t_s in [2.0, 31.0, 77.7, 180.0] {
            let n = 3.0 * (t_s / 180.0f64).sqrt();
            let r = 0.75 * n * (TAU * n).sin();
            let [fx, fy, fz] = spiral.forces_n(t_s);
            assert!((fx - r * (TAU * 0.15 * t_s).sin()).abs() <= 1e-12, "{t_s}");
            assert!((fy - r * (TAU * 0.15 * t_s).cos()).abs() <= 1e-12 && (fz + n).abs() <= 1e-12, "{t_s}");
        }
    }

    #[test]
    fn the_start_is_soft_and_the_end_lets_go() {
        // Equation 21 alone rises by 7 N/s in its first millisecond. Measured: 0.22.
        const FASTEST_N_PER_S: f64 = 0.25;
        let spiral = Spiral::default();
        for k in 0..4000 {
            let t_s = f64::from(k) * 1e-3;
            let rise = (spiral.pressing_n(t_s + 1e-3) - spiral.pressing_n(t_s)) / 1e-3;
            assert!((0.0..=FASTEST_N_PER_S).contains(&rise), "{t_s} {rise}");
        }
        assert!(spiral.forces_n(-1.0).iter().all(|force| *force == 0.0));
        assert!(spiral.forces_n(181.0)[2] == 0.5 * spiral.forces_n(180.0)[2]);
        assert!(spiral.forces_n(182.0).iter().all(|force| *force == 0.0));
    }

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
}
