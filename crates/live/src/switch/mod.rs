//! The virtual switch (thesis 6.1): predicted pressing to press and release, and how far that can be trusted.
//!
//! In: a [`SwitchConfig`] (`switch.toml`) and one [`Reading`] per sample. Out: [`SwitchEvent`]s, and, where the true
//! contact is known as well, false switches an hour with their exact interval, misses and delays ([`Evaluation`]).
//!
//! The thesis names no threshold, no hold, no latency and no error rate; what is here is ours, but for the robot's rule
//! of appendix C, whose switch *moves while pressed*: whoever does not hear of the sensor any more has to let go.
//!
//! Conventions: seconds of the stream's clock; pressing in newtons is positive here (-`Fz_N`).

mod config;
mod contact;
mod evaluate;
mod event;
mod lag;
mod machine;
mod poisson;
mod rice;
#[cfg(test)]
mod tests;
mod tune;

pub use config::{ConfigFault, Outside, Place, SwitchConfig, compared};
pub use contact::{Contact, Contacts, LONGEST_GAP_S};
pub use evaluate::{Evaluation, FalseRate, Fate, Match, Quartiles, Trace, false_by_parts, matches};
pub use event::{Reason, SwitchEvent, Turn};
pub use lag::Lag;
pub use machine::{Reading, Switch};
pub use poisson::{PARTS, Rate, dispersion, heaping, rate_of, rate_per_hour};
pub use rice::{NoiseRate, crossings_per_hour};
pub use tune::{Candidate, Goal, TuneFault, Tuned, any_contact, tune};
