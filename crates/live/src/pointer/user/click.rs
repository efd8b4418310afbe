//! How far a click throws the pointer.

use super::desk::{Desk, LIFTED_S};
use super::hand::Hand;
use super::person::Person;
use crate::pointer::Config;

/// From one click to the next, s: the pointer has settled again.
const APART_S: f64 = 2.0;
/// After the time in the air the finger rests for so long, s.
const RESTS_S: f64 = 2.0;

/// Distances of many clicks, px.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Spread {
    /// The median.
    pub p50: f64,
    /// What 95 % do not exceed.
    pub p95: f64,
    /// The greatest.
    pub(super) most: f64,
}

/// Displacements by clicks of a finger that otherwise rests.
#[derive(Debug, Clone, Copy)]
pub(super) struct Displacement {
    /// Presses that clicked once, which is what the distances are of.
    pub(super) clicks: usize,
    /// Presses that did not click.
    pub(super) missed: usize,
    /// Clicks beyond the first of a press, and clicks without one.
    pub(super) extra: usize,
    /// From where the pointer was when the finger began to press to where it clicked; none without clicks.
    pub(super) at_down_px: Option<Spread>,
    /// To where it was when all had settled again.
    pub(super) settled_px: Option<Spread>,
}

/// Presses a number of times, each with shear of its own size and direction.
pub(super) fn click_displacement(
    config: &Config,
    person: &Person,
    presses: usize,
    seed: u64,
    sensor: impl FnMut(f64, [f64; 3]) -> [f64; 3],
) -> Displacement {
    let (mut desk, mut hand) = (Desk::new(config, sensor), Hand::new(*person, *config, seed));
    let (mut downs_px, mut ends_px, mut missed) = (Vec::new(), Vec::new(), 0);
    let mut until_s = LIFTED_S + RESTS_S;
    let mut extra = desk.hold(&mut hand, until_s).len();
    for _ in 0..presses {
        let from = desk.at;
        hand.press(until_s);
        until_s += APART_S;
        let clicks = desk.hold(&mut hand, until_s);
        let far = |to: [i64; 2]| ((to[0] - from[0]) as f64).hypot((to[1] - from[1]) as f64);
        match clicks.first() {
            Some(&down_at) => {
                downs_px.push(far(down_at));
                ends_px.push(far(desk.at));
                extra += clicks.len() - 1;
            }
            None => missed += 1,
        }
    }
    Displacement { clicks: downs_px.len(), missed, extra, at_down_px: spread(downs_px), settled_px: spread(ends_px) }
}

/// By nearest rank.
fn spread(mut values: Vec<f64>) -> Option<Spread> {
    values.sort_by(f64::total_cmp);
    let rank = |share: f64| values.get(((share * values.len() as f64).ceil() as usize).saturating_sub(1)).copied();
    Some(Spread { p50: rank(0.5)?, p95: rank(0.95)?, most: *values.last()? })
}
