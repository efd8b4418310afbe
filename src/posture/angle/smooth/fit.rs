//! What a series is like: the parameters of the greatest likelihood.

use super::filter::{Observation, Parameters, deviance};

/// Rows that are looked at in a longer series: so many after each other, in so many places.
const LOOK_ROWS: usize = 1000;
const LOOK_PLACES: usize = 4;

/// ln of the third derivative's density, logit of correlation and share, ln of the scale.
type Point = [f64; 4];

/// The middle and the standard deviation of the priors of correlation and share.
const PRIORS: [Option<(f64, f64)>; 4] = [None, Some((1.5, 1.5)), Some((0.0, 1.5)), None];
/// The standard deviation of the scale's prior, upwards. Errors that look larger than reported are; errors that look
/// smaller may hide in the motion, as slow ones do, and the more so the longer the series: the scale is never below 1.
const LARGER: f64 = 0.25;
/// ln of the density: from a motion that a thousand rows don't show to one that leaves each row by itself.
const MOTION: (f64, f64) = (-41.0, 9.0);

pub(super) fn fit(series: &[Observation], half_turn: f64) -> Parameters {
    let parts: Vec<&[Observation]> = if series.len() <= LOOK_ROWS * LOOK_PLACES {
        vec![series]
    } else {
        let apart = (series.len() - LOOK_ROWS) / (LOOK_PLACES - 1);
        (0..LOOK_PLACES).map(|k| &series[k * apart..k * apart + LOOK_ROWS]).collect()
    };
    let cost = |point: &Point| {
        let parameters = parameters(point);
        let seen: f64 = parts.iter().map(|part| deviance(part, &parameters, half_turn)).sum();
        let prior: f64 = point
            .iter()
            .zip(PRIORS)
            .filter_map(|(p, prior)| prior.map(|(middle, sd)| ((p - middle) / sd).powi(2)))
            .sum::<f64>()
            + (point[3] / LARGER).powi(2);
        let outside = (MOTION.0 - point[0]).max(point[0] - MOTION.1).max(0.0);
        seen + prior + outside * outside
    };
    // The likelihood may have two hills, a lively motion with white errors and a calm one with correlated errors.
    let begin = (0..13)
        .flat_map(|k| [-0.5, 2.0].map(|correlation| [-30.0 + 3.0 * f64::from(k), correlation, 0.0, 0.0]))
        .map(|point| (cost(&point), point))
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map_or([0.0; 4], |(_, point)| point);
    parameters(&lowest(&cost, begin))
}

fn parameters(point: &Point) -> Parameters {
    let logistic = |p: f64| 1.0 / (1.0 + (-p).exp());
    Parameters {
        jerk: point[0].clamp(MOTION.0, MOTION.1).exp(),
        // Neither is ever nothing or all: a white part remains, and so the observation has a variance.
        correlation: logistic(point[1]).min(0.999),
        share: logistic(point[2]).min(0.99),
        scale: point[3].clamp(0.0, 3.0).exp(),
    }
}

const MOST_STEPS: usize = 200;
/// A simplex whose corners' costs differ by less is at the bottom.
const FLAT: f64 = 1e-3;

/// The simplex method of Nelder and Mead (1965, doi:10.1093/comjnl/7.4.308).
fn lowest(cost: &impl Fn(&Point) -> f64, begin: Point) -> Point {
    let mut corners: Vec<(f64, Point)> = (0..=begin.len())
        .map(|k| {
            let mut point = begin;
            if let Some(p) = k.checked_sub(1).map(|k| &mut point[k]) {
                *p += if k == 1 { 1.5 } else { 0.5 };
            }
            (cost(&point), point)
        })
        .collect();
    for _ in 0..MOST_STEPS {
        corners.sort_by(|a, b| a.0.total_cmp(&b.0));
        let worst = corners.len() - 1;
        if corners[worst].0 - corners[0].0 < FLAT {
            break;
        }
        let middle: Point =
            std::array::from_fn(|i| corners[..worst].iter().map(|c| c.1[i]).sum::<f64>() / worst as f64);
        let along = |share: f64| {
            let point: Point = std::array::from_fn(|i| middle[i] + share * (middle[i] - corners[worst].1[i]));
            (cost(&point), point)
        };
        let mirrored = along(1.0);
        let next = if mirrored.0 < corners[0].0 {
            let further = along(2.0);
            if further.0 < mirrored.0 { further } else { mirrored }
        } else if mirrored.0 < corners[worst - 1].0 {
            mirrored
        } else {
            let nearer = along(if mirrored.0 < corners[worst].0 { 0.5 } else { -0.5 });
            if nearer.0 >= mirrored.0.min(corners[worst].0) {
                let best = corners[0].1;
                for corner in &mut corners[1..] {
                    let point = std::array::from_fn(|i| 0.5 * (best[i] + corner.1[i]));
                    *corner = (cost(&point), point);
                }
                continue;
            }
            nearer
        };
        corners[worst] = next;
    }
    corners.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).map_or(begin, |c| c.1)
}
