//! What trajectory is wanted.

use lunula_predictor::{Bending, ForceSpace, Spiral};
use serde::Serialize;

/// Which way through the space of forces, or of postures. Rates in hertz.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "lowercase", tag = "kind")]
pub enum Kind {
    /// The spiral of equations 21 to 23.
    Force {
        /// f_s, cycles a newton.
        fs_per_n: f64,
        /// f_c.
        fc_hz: f64,
    },
    /// Random forces within the cone of friction.
    Random {
        /// Rates lie between 0.4 and 4 times this.
        hz: f64,
        /// Where the random numbers come from.
        seed: u64,
    },
    /// Equation 27, or random bending within its range.
    Posture {
        /// f_b; of random bending, rates lie between 0.4 and 4 times this.
        hz: f64,
        /// Of random bending, where the random numbers come from.
        seed: Option<u64>,
    },
}

/// A trajectory to be made.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TrajectoryOptions {
    /// Which.
    #[serde(flatten)]
    pub kind: Kind,
    /// How long it takes (T of the spiral), without lead and trail.
    pub seconds: f64,
    /// Between rows.
    pub every_s: f64,
    /// At rest before it begins.
    pub lead_s: f64,
    /// After its end: the finger lets go and rests.
    pub trail_s: f64,
    /// How long forces, and random angles, take to come out of rest.
    pub soft_s: f64,
    /// The largest pressing.
    pub fz_max_n: f64,
    /// The coefficient of friction.
    pub mu: f64,
    /// tau of equation 19.
    pub tau_s: f64,
    /// The error that equation 19 may come to, as a share.
    pub error: f64,
}

impl Kind {
    /// The spiral of the thesis.
    pub const FORCE: Self = Self::Force { fs_per_n: 1.0, fc_hz: 0.15 };
    /// Random forces that keep equation 19's usual limit.
    pub const RANDOM: Self = Self::Random { hz: 0.03, seed: 1 };
    /// The thesis' bending.
    pub const POSTURE: Self = Self::Posture { hz: 0.1, seed: None };
}

impl TrajectoryOptions {
    /// The thesis' own figures.
    #[must_use]
    pub fn of(kind: Kind) -> Self {
        let (spiral, space) = (Spiral::default(), ForceSpace::default());
        Self {
            kind,
            seconds: match kind {
                Kind::Force { .. } => spiral.duration_s,
                Kind::Random { .. } => 100.0,
                Kind::Posture { .. } => Bending::PROTOCOL_S,
            },
            every_s: 0.04,
            lead_s: 0.0,
            trail_s: 0.0,
            // The spiral begins with little force, random motion anywhere.
            soft_s: match kind {
                Kind::Random { .. } => 5.0,
                // Equation 27 begins at rest by itself.
                Kind::Posture { seed: None, .. } => 0.0,
                _ => spiral.soft_s,
            },
            fz_max_n: space.fz_max_n(),
            mu: space.mu(),
            tau_s: 0.1,
            error: 0.1,
        }
    }

    /// With lead and trail.
    #[must_use]
    pub fn whole_s(&self) -> f64 {
        self.lead_s + self.seconds + self.trail_s
    }

    /// Rows of the table: one every [`every_s`](Self::every_s) from 0 on, the end counted.
    #[must_use]
    pub fn rows(&self) -> f64 {
        // 180 / 0.04 is a little less than 4500 in floating point.
        (self.whole_s() / self.every_s * (1.0 + 1e-12)).floor() + 1.0
    }

    /// Whether it is one of forces.
    #[must_use]
    pub fn is_force(&self) -> bool {
        !matches!(self.kind, Kind::Posture { .. })
    }
}
