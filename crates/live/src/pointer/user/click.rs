//! How far a click throws the pointer.

use super::RATE_HZ;
use super::hand::Hand;
use super::person::Person;
use crate::pointer::{Config, Pointer, What};

/// From one click to the next, s: the pointer has settled again.
const APART_S: f64 = 2.0;
/// The finger is in the air for so long at the beginning, s, then rests for so long.
const LIFTED_S: f64 = 3.0;
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
    mut sensor: impl FnMut(f64, [f64; 3]) -> [f64; 3],
) -> Displacement {
    let (mut pointer, mut hand) = (Pointer::new(*config), Hand::new(*person, *config, seed));
    let mut at = [0i64; 2];
    let (mut down_at, mut clicks_of_press) = (None, 0);
    let (mut downs_px, mut ends_px, mut missed, mut extra) = (Vec::new(), Vec::new(), 0, 0);
    let mut samples = 0u64;
    let mut run = |until_s: f64, hand: &mut Hand, at: &mut [i64; 2], down: &mut Option<[i64; 2]>, count: &mut usize| {
        while samples as f64 / RATE_HZ < until_s {
            let t_s = samples as f64 / RATE_HZ;
            samples += 1;
            let force_n = if t_s < LIFTED_S { [0.0; 3] } else { hand.force_n(t_s, [0.0; 2]) };
            let [fx_n, fy_n, fz_n] = sensor(t_s, force_n);
            pointer.sample(t_s, fx_n, fy_n, fz_n, None, true, &mut |event| match event.what {
                What::Move { dx, dy } => *at = [at[0] + i64::from(dx), at[1] + i64::from(dy)],
                What::Button { down: true, .. } => {
                    *count += 1;
                    down.get_or_insert(*at);
                }
                _ => {}
            });
        }
    };
    let mut until_s = LIFTED_S + RESTS_S;
    run(until_s, &mut hand, &mut at, &mut down_at, &mut clicks_of_press);
    extra += clicks_of_press;
    for _ in 0..presses {
        let from = at;
        (down_at, clicks_of_press) = (None, 0);
        hand.press(until_s);
        until_s += APART_S;
        run(until_s, &mut hand, &mut at, &mut down_at, &mut clicks_of_press);
        let far = |to: [i64; 2]| ((to[0] - from[0]) as f64).hypot((to[1] - from[1]) as f64);
        match down_at {
            Some(down_at) => {
                downs_px.push(far(down_at));
                ends_px.push(far(at));
                extra += clicks_of_press - 1;
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
