//! What happens while nobody means anything: drift at rest, and clicks while only moving.

use super::RATE_HZ;
use super::desk::{Desk, LIFTED_S};
use super::hand::Hand;
use super::person::Person;
use super::sensor::Noise;
use crate::pointer::Config;
use crate::switch::{Rate, rate_per_hour};

/// After the time in the air the force comes, and this passes before counting begins, s.
const SETTLES_S: f64 = 1.0;
/// SD of the shear by which the simulated person moves about, N of each axis (assumed): mostly beyond the dead zone,
/// often at what friction holds.
const SWAY_N: f64 = 0.35;
/// Its time constant, s (assumed).
const SWAY_S: f64 = 0.5;

/// Motion at rest.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rest {
    /// Counts to the sides and up and down, all taken as positive.
    pub(super) counts: u64,
    /// The same a minute.
    pub(super) counts_per_minute: f64,
}

/// Clicks that nobody meant.
#[derive(Debug, Clone, Copy)]
pub(super) struct Inadvertent {
    /// Times that the button went down.
    pub(super) clicks: u64,
    /// Clicks an hour with their exact interval; none without time.
    pub(super) rate: Option<Rate>,
}

/// A force that stays, after a time in the air.
pub(super) fn rest_drift(
    config: &Config,
    force_n: [f64; 3],
    minutes: f64,
    sensor: impl FnMut(f64, [f64; 3]) -> [f64; 3],
) -> Rest {
    let mut desk = Desk::new(config, sensor);
    let counts_until = |desk: &mut Desk<_>, end_s: f64| {
        while desk.t_s() < end_s {
            desk.feel(force_n);
        }
        desk.counts
    };
    let before = counts_until(&mut desk, LIFTED_S + SETTLES_S);
    let counts = counts_until(&mut desk, LIFTED_S + SETTLES_S + 60.0 * minutes) - before;
    Rest { counts, counts_per_minute: counts as f64 / minutes }
}

/// A person who moves the pointer about and presses no click.
pub(super) fn inadvertent_clicks(
    config: &Config,
    person: &Person,
    hours: f64,
    seed: u64,
    sensor: impl FnMut(f64, [f64; 3]) -> [f64; 3],
) -> Inadvertent {
    let (mut desk, mut hand) = (Desk::new(config, sensor), Hand::new(*person, *config, seed));
    let mut sway = Noise::<2>::new(SWAY_N, SWAY_S, seed, 6 << 32);
    let mut clicks = 0;
    while desk.t_s() < LIFTED_S + 3600.0 * hours {
        let force_n = hand.force_n(desk.t_s(), sway.step(RATE_HZ.recip()));
        clicks += u64::from(desk.feel(force_n).is_some());
    }
    Inadvertent { clicks, rate: rate_per_hour(clicks, hours) }
}
