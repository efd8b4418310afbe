//! What happens while nobody means anything: drift at rest, and clicks while only moving.

use super::RATE_HZ;
use super::hand::Hand;
use super::person::Person;
use super::sensor::Noise;
use crate::pointer::{Config, Event, Pointer, What};
use crate::switch::{Rate, rate_per_hour};

/// The finger is in the air for so long at the beginning, s.
const LIFTED_S: f64 = 3.0;
/// Then the force comes, and this passes before counting begins, s.
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
    mut sensor: impl FnMut(f64, [f64; 3]) -> [f64; 3],
) -> Rest {
    let mut pointer = Pointer::new(*config);
    let mut counts = 0;
    let samples = ((LIFTED_S + SETTLES_S + 60.0 * minutes) * RATE_HZ).round() as u64;
    for sample in 0..samples {
        let t_s = sample as f64 / RATE_HZ;
        let [fx_n, fy_n, fz_n] = sensor(t_s, if t_s < LIFTED_S { [0.0; 3] } else { force_n });
        pointer.sample(t_s, fx_n, fy_n, fz_n, None, true, &mut |event| {
            if let Event { t_s, what: What::Move { dx, dy } } = event
                && t_s >= LIFTED_S + SETTLES_S
            {
                counts += u64::from(dx.unsigned_abs()) + u64::from(dy.unsigned_abs());
            }
        });
    }
    Rest { counts, counts_per_minute: counts as f64 / minutes }
}

/// A person who moves the pointer about and presses no click.
pub(super) fn inadvertent_clicks(
    config: &Config,
    person: &Person,
    hours: f64,
    seed: u64,
    mut sensor: impl FnMut(f64, [f64; 3]) -> [f64; 3],
) -> Inadvertent {
    let (mut pointer, mut hand) = (Pointer::new(*config), Hand::new(*person, *config, seed));
    let mut sway = Noise::<2>::new(SWAY_N, SWAY_S, seed, 6 << 32);
    let mut clicks = 0;
    let samples = ((LIFTED_S + 3600.0 * hours) * RATE_HZ).round() as u64;
    for sample in 0..samples {
        let t_s = sample as f64 / RATE_HZ;
        let force_n = if t_s < LIFTED_S { [0.0; 3] } else { hand.force_n(t_s, sway.step(RATE_HZ.recip())) };
        let [fx_n, fy_n, fz_n] = sensor(t_s, force_n);
        pointer.sample(t_s, fx_n, fy_n, fz_n, None, true, &mut |event| {
            clicks += u64::from(matches!(event.what, What::Button { down: true, .. }));
        });
    }
    Inadvertent { clicks, rate: rate_per_hour(clicks, hours) }
}
