//! The thesis' protocols (3.3, 5.2.4, 5.3): what a finger is prompted to do, one after the other.

use lunula_predictor::Bending;
use serde::Serialize;

use super::LogOptions;
use crate::phantom::motion::force::{Cycles, ForceTrajectory, Spiral};
use crate::phantom::motion::trajectory::Trajectory;

/// How long the finger bends before it touches at random, and touches then, seconds (5.3.1).
const RANDOM_S: [f64; 2] = [20.0, 100.0];
/// How well people follow a picture of their force (5.2.2a: Jones 1998).
const FOLLOW: f64 = 0.06;
/// How far off straight the finger touches at most (assumed), degrees.
const POSTURE_SHIFT_DEG: f64 = 3.0;
/// Rates of random movement, hertz.
const RANDOM_HZ: f64 = 0.1;

/// An experiment with a sensor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Protocol {
    /// 60 s of equation 27, then the spiral's 180 s with the finger straight (Fig. 94).
    Touch,
    /// 20 s of equation 27, then 100 s of random forces all over the cone of friction (Fig. 99).
    TouchRandom,
    /// 60 s of equation 27 (Fig. 101).
    Bending,
    /// 60 s of random bending all over equation 27's range.
    BendingRandom,
    /// 100 s: five cycles of normal force from 0 to -4 N, the finger straight (3.3.2, Fig. 23 to 25).
    Normal,
    /// 100 s: five cycles of lateral shear of +-2 N at -3 N, the finger straight (3.3.3, Fig. 26 to 28).
    Lateral,
    /// 100 s: five cycles of longitudinal shear of +-2 N at -3 N, the finger straight (3.3.4, Fig. 29 to 31).
    Longitudinal,
    /// 60 s: six cycles from fully flexed to fully extended and back, the knuckle held (3.3.5, Fig. 32 to 34).
    FreeBending,
}

impl Protocol {
    /// Which force it cycles.
    #[must_use]
    pub fn cycles(self) -> Option<Cycles> {
        match self {
            Self::Normal => Some(Cycles::Normal),
            Self::Lateral => Some(Cycles::Lateral),
            Self::Longitudinal => Some(Cycles::Longitudinal),
            _ => None,
        }
    }

    /// How long the finger bends and how long it touches then, seconds.
    #[must_use]
    pub fn seconds(self) -> [f64; 2] {
        match self {
            Self::Touch => [Bending::PROTOCOL_S, Spiral::default().duration_s],
            Self::TouchRandom => RANDOM_S,
            Self::Bending | Self::BendingRandom | Self::FreeBending => [Bending::PROTOCOL_S, 0.0],
            Self::Normal | Self::Lateral | Self::Longitudinal => [0.0, f64::from(Cycles::COUNT) / Cycles::HZ],
        }
    }
}

impl LogOptions {
    /// A log of a protocol, with a finger that follows as people do; all else is the usual.
    #[must_use]
    pub fn of(protocol: Protocol, seed: u64) -> Self {
        let [bending_s, touching_s] = protocol.seconds();
        let trajectory = match protocol {
            Protocol::BendingRandom => Trajectory::Even { hz: RANDOM_HZ, seed },
            Protocol::FreeBending => Trajectory::Free { hz: Bending::default().hz },
            Protocol::Normal | Protocol::Lateral | Protocol::Longitudinal => Trajectory::Rest,
            _ => Trajectory::Eq27 { hz: Bending::default().hz },
        };
        let cycles = protocol.cycles().map(|which| ForceTrajectory::Cycles { which, hz: Cycles::HZ });
        let force = match protocol {
            Protocol::Touch => ForceTrajectory::Spiral(Spiral::default()),
            Protocol::TouchRandom => ForceTrajectory::Even { hz: RANDOM_HZ, seed },
            _ => cycles.unwrap_or(ForceTrajectory::None),
        };
        Self {
            seed,
            trajectory,
            force,
            touch_from_s: (bending_s > 0.0 && touching_s > 0.0).then_some(bending_s),
            follow: FOLLOW,
            posture_shift_rad: POSTURE_SHIFT_DEG.to_radians(),
            seconds: bending_s + touching_s,
            ..Self::default()
        }
    }
}
