//! A finger that wears the sensor for hours, in words: its contacts, and what a day's wear adds.

use clap::Args;

use crate::phantom::motion::contacts::{ContactKind, Contacts};
use crate::phantom::sensor::DisturbanceSizes;
use crate::words::Words;

const PER_HOUR: f64 = DisturbanceSizes::WORN.bumps_per_hour;

/// What a worn sensor's log takes.
#[derive(Debug, Clone, Args)]
pub(super) struct WornRequest {
    /// Kinds of contacts and near misses, as press,tap [default: press,hold,slide,tap,hover,brush,bend; with --protocol
    /// rest bend]
    #[arg(long, value_name = "KIND,..", value_delimiter = ',', value_parser = ContactKind::by_word)]
    kinds: Vec<ContactKind>,
    /// The mean pause between two contacts; each is a third to five thirds of it [default: 3; with --protocol rest 60]
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    pause: Option<f64>,
    /// The heart's pulse, its greatest height at a photodiode of the mean share (assumed) [default: 0; with --protocol
    /// contacts or rest 0.005]
    #[arg(long, value_name = "VOLTS", allow_negative_numbers = true)]
    pulse: Option<f64>,
    /// Bumps of finger and wires, the greatest, 0.2 to 1 s long (assumed) [default: 0; with --protocol contacts or rest
    /// 0.03]
    #[arg(long, value_name = "VOLTS", allow_negative_numbers = true)]
    bumps: Option<f64>,
    /// So many bumps an hour (assumed)
    #[arg(long, value_name = "N", default_value_t = PER_HOUR, allow_negative_numbers = true)]
    bumps_per_hour: f64,
    /// The hand is raised or lowered every five minutes, which changes the light by up to so much either way (assumed)
    /// [default: 0; with --protocol contacts or rest 0.005]
    #[arg(long, value_name = "VOLTS", allow_negative_numbers = true)]
    elevation: Option<f64>,
    /// Photodiodes drift by up to so much either way over hours, beside --wander (assumed) [default: 0; with --protocol
    /// contacts or rest 0.01]
    #[arg(long, value_name = "VOLTS", allow_negative_numbers = true)]
    drift: Option<f64>,
    /// The log has no columns of the force transducer
    #[arg(long)]
    pub(super) no_forces: bool,
    /// The log has a column `contact`, exactly 1 or 0, as of an ideal switch under the finger that brushes do not close
    #[arg(long)]
    pub(super) contact: bool,
}

impl WornRequest {
    /// The finger's contacts, where it makes some of its own accord; `usual` are the protocol's.
    pub(super) fn contacts(&self, usual: Option<Contacts>, seed: u64) -> Contacts {
        let usual = usual.unwrap_or(Contacts { kinds: ContactKind::ALL.to_vec(), pause_s: Contacts::PAUSE_S, seed });
        Contacts {
            kinds: if self.kinds.is_empty() { usual.kinds } else { self.kinds.clone() },
            pause_s: self.pause.unwrap_or(usual.pause_s),
            seed,
        }
    }

    /// Whether it says something on contacts.
    pub(super) fn says_contacts(&self) -> bool {
        !self.kinds.is_empty() || self.pause.is_some()
    }

    /// What is added; `usual` is the protocol's.
    pub(super) fn disturbances(&self, usual: DisturbanceSizes) -> DisturbanceSizes {
        DisturbanceSizes {
            pulse_v: self.pulse.unwrap_or(usual.pulse_v),
            bump_v: self.bumps.unwrap_or(usual.bump_v),
            bumps_per_hour: self.bumps_per_hour,
            elevation_v: self.elevation.unwrap_or(usual.elevation_v),
            drift_v: self.drift.unwrap_or(usual.drift_v),
        }
    }
}
