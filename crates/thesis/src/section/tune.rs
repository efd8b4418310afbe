//! Stiffness and damping tuned to time constants, within an order of magnitude, as the thesis tunes them for Fig. 80
//! and 82.

use lunula_hemodynamics::Parameters;
use rayon::prelude::*;

use super::experiments::SITES;
use super::steps::{change, steps};
use crate::section::groups::scaled;

/// Tenfold either way.
const MOST: f64 = std::f64::consts::LN_10;
/// How far from the start further searches begin, in the logarithm of a factor.
const CORNER: f64 = 1.2;
/// A search's first and last step, in the logarithm of a factor.
const STEPS: [f64; 2] = [0.8, 2e-3];

/// Time constants, s: of the proximal photodiode under proximal steps (loading, unloading) and of the distal one under
/// distal steps.
pub(super) fn constants_s(parameters: &Parameters, load_pa: f64) -> Option<[f64; 4]> {
    let mut found = [0.0; 4];
    for (k, pressed) in SITES.into_iter().enumerate() {
        let stepped = steps(parameters, pressed, &[load_pa], 1e-5).ok()?;
        let response = &stepped[0].response;
        let [loading, unloading] = change(&response.times_s, &response.photodiode_v(k)).constants_s;
        [found[2 * k], found[2 * k + 1]] = [loading?, unloading?];
    }
    Some(found)
}

/// The factors of [`GROUPS`](crate::section::groups::GROUPS) whose time constants under steps of this
/// load are the nearest to those wanted, in ratio: the best of searches from the parameters themselves and from all
/// corners about them, the same each time.
pub(super) fn tune(parameters: &Parameters, wanted_s: [f64; 4], load_pa: f64) -> [f64; 4] {
    let cost = |logs: &[f64; 4]| -> f64 {
        let own = scaled(parameters, &logs.map(f64::exp)).and_then(|scaled| constants_s(&scaled, load_pa));
        own.map_or(f64::INFINITY, |own| {
            own.iter().zip(wanted_s).map(|(own, wanted)| (own / wanted).ln()).map(|miss| miss * miss).sum()
        })
    };
    let corner = |k: usize| std::array::from_fn(|group| if k >> group & 1 == 1 { CORNER } else { -CORNER });
    let starts: Vec<[f64; 4]> = std::iter::once([0.0; 4]).chain((0..16).map(corner)).collect();
    let ends: Vec<([f64; 4], f64)> = starts.into_par_iter().map(|start| search(start, &cost)).collect();
    let best = ends.into_iter().reduce(|best, next| if next.1 < best.1 { next } else { best });
    best.map_or([1.0; 4], |(logs, _)| logs.map(f64::exp))
}

/// Whether a factor ended where its range does.
pub(super) fn is_at_end(factor: f64) -> bool {
    // The search goes there in steps of 2e-3 or less, and stops at the end itself.
    factor.ln().abs() >= MOST - STEPS[1]
}

/// Hooke and Jeeves' pattern search: along one factor after the other, then on in the direction that this took; steps
/// are halved where nothing is better. Gives where it ends, and the cost there.
fn search(start: [f64; 4], cost: &impl Fn(&[f64; 4]) -> f64) -> ([f64; 4], f64) {
    let (mut at, mut best) = (start, cost(&start));
    let mut step = STEPS[0];
    while step >= STEPS[1] {
        let before = at;
        (at, best) = around(at, best, step, cost);
        if at == before {
            step *= 0.5;
            continue;
        }
        let ahead = std::array::from_fn(|k| (2.0 * at[k] - before[k]).clamp(-MOST, MOST));
        let further = around(ahead, cost(&ahead), step, cost);
        if further.1 < best {
            (at, best) = further;
        }
    }
    (at, best)
}

/// The best that single factors bring.
fn around(mut at: [f64; 4], mut best: f64, step: f64, cost: &impl Fn(&[f64; 4]) -> f64) -> ([f64; 4], f64) {
    for k in 0..4 {
        for sign in [1.0, -1.0] {
            let mut next = at;
            next[k] = (at[k] + sign * step).clamp(-MOST, MOST);
            let found = cost(&next);
            if found < best {
                (at, best) = (next, found);
                break;
            }
        }
    }
    (at, best)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_at_the_end_of_their_range_are_known() {
        assert!(is_at_end(10.0) && is_at_end(0.1) && is_at_end(f64::exp(-MOST)));
        assert!(!is_at_end(0.734) && !is_at_end(1.176) && !is_at_end(9.9));
    }

    #[test]
    fn people_are_about_values_with_the_time_constants_that_were_tuned_to() {
        // As docs/src/thesis/section-4-3.md has them, of the tuned values under steps of 1 N/cm2.
        let told_s = [0.136, 0.144, 0.175, 0.362];
        let middle = crate::section::people::Person::middle().unwrap();
        let found_s = constants_s(&middle, crate::section::TUNED_AT_PA).unwrap();
        assert!(
            found_s.iter().zip(told_s).all(|(found, published)| (found - published).abs() <= 0.0006),
            "{found_s:?}"
        );
    }
}
