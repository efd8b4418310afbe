//! The thesis' protocols (3.3, 5.2.4, 5.3): what a finger is prompted to do, one after the other; and what it does of
//! its own accord while a sensor is worn for hours: contacts, and none.

use lunula_predictor::Bending;
use serde::Serialize;

use super::LogOptions;
use crate::phantom::motion::contacts::{ContactKind, Contacts};
use crate::phantom::motion::force::{Cycles, ForceTrajectory, Spiral};
use crate::phantom::motion::trajectory::Trajectory;
use crate::phantom::sensor::DisturbanceSizes;

/// How long the finger bends before it touches at random, and touches then, seconds (5.3.1).
const RANDOM_S: [f64; 2] = [20.0, 100.0];
/// How long contacts go on, and a rest; the mean pause between two bends of a finger that rests, seconds (assumed).
const CONTACTS_S: f64 = 600.0;
const REST_S: f64 = 3600.0;
const RESTING_PAUSE_S: f64 = 60.0;
/// How well people follow a picture of their force (5.2.2a: Jones 1998).
const FOLLOW: f64 = 0.06;
/// How far off straight the finger touches at most (assumed), degrees.
const POSTURE_SHIFT_DEG: f64 = 3.0;
/// Rates of random movement, hertz.
const RANDOM_HZ: f64 = 0.1;

/// An experiment with a sensor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, clap::ValueEnum)]
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
    /// 600 s of presses, holds, slides, taps and near misses with pauses, of a worn sensor, with pulse, bumps, raised
    /// hands and drift.
    Contacts,
    /// An hour of rest: the finger sways, bends about once a minute, and touches nothing; the same disturbances.
    Rest,
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
            Self::Contacts => [0.0, CONTACTS_S],
            Self::Rest => [REST_S, 0.0],
        }
    }

    /// What the finger does of its own accord; nobody prompts it.
    #[must_use]
    pub fn contacts(self, seed: u64) -> Option<Contacts> {
        match self {
            Self::Contacts => Some(Contacts { kinds: ContactKind::ALL.to_vec(), pause_s: Contacts::PAUSE_S, seed }),
            Self::Rest => Some(Contacts { kinds: vec![ContactKind::Bend], pause_s: RESTING_PAUSE_S, seed }),
            _ => None,
        }
    }
}

impl LogOptions {
    /// A log of a protocol, with a finger that follows as people do, or is worn; all else is the default.
    #[must_use]
    pub fn of(protocol: Protocol, seed: u64) -> Self {
        let [bending_s, touching_s] = protocol.seconds();
        let trajectory = match protocol {
            Protocol::BendingRandom => Trajectory::Even { hz: RANDOM_HZ, seed },
            Protocol::FreeBending => Trajectory::Free { hz: Bending::default().hz },
            Protocol::Normal | Protocol::Lateral | Protocol::Longitudinal => Trajectory::Rest,
            Protocol::Contacts | Protocol::Rest => Trajectory::Sway { seed },
            _ => Trajectory::Eq27 { hz: Bending::default().hz },
        };
        let contacts = protocol.contacts(seed);
        let worn = contacts.is_some();
        let cycles = protocol.cycles().map(|which| ForceTrajectory::Cycles { which, hz: Cycles::HZ });
        let force = match protocol {
            Protocol::Touch => ForceTrajectory::Spiral(Spiral::default()),
            Protocol::TouchRandom => ForceTrajectory::Even { hz: RANDOM_HZ, seed },
            _ => cycles.or(contacts.map(ForceTrajectory::Contacts)).unwrap_or(ForceTrajectory::None),
        };
        Self {
            seed,
            trajectory,
            force,
            touch_from_s: (bending_s > 0.0 && touching_s > 0.0).then_some(bending_s),
            follow: if worn { 0.0 } else { FOLLOW },
            posture_shift_rad: POSTURE_SHIFT_DEG.to_radians(),
            seconds: bending_s + touching_s,
            disturbances: if worn { DisturbanceSizes::WORN } else { DisturbanceSizes::NONE },
            ..Self::default()
        }
    }
}
