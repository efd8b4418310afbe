//! When a nail was pressed and let go, from the traces of all photodiodes.
//!
//! A step is a time at which the means of half a second after and before differ most, in some photodiode by 4 SDs of
//! its noise; where there is none near, means of one and a half seconds, for slow courses. The first step leads away
//! from rest, so it is a press; one in the opposite direction, over all photodiodes, is a release, one in the same
//! direction is pressing harder and belongs to the press.

use super::Trace;
use crate::median::{SD_OF_MAD, median};

/// What is averaged before and after a step, seconds (assumed: longer than the time constants of 4.3, shorter than a
/// quick press), and for slow courses.
const SIDES_S: [f64; 2] = [0.5, 1.5];
/// Such a difference, of the noise's SD in one sample: 8 standard errors of it, and more (measured: no figures in 600
/// traces without a press). Whether the step itself is large enough is for its course to say.
const LEAST_SDS: f64 = 4.0;
/// A step in the values themselves, of their size where the nail is at rest: 3.7 % of the light, 2 % as encoded
/// (assumed: below it are vasomotion and exposure; of a press, ratios of light change 1.8 times as much as those of
/// colours as encoded).
const LEAST_PART: f64 = 0.037;
/// The same over the longer means, in which slow changes are larger.
const LEAST_PART_SLOWLY: f64 = 0.074;
/// Samples on each side, and their share of the frames: over a gap slow changes look like steps.
const FEWEST: usize = 4;
const LEAST_KNOWN: f64 = 0.6;
/// Steps nearer than this are one, seconds.
const APART_S: f64 = 0.6;

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Found {
    pub(super) press_s: f64,
    /// When it ended, if it did.
    pub(super) release_s: Option<f64>,
}

/// SD of the noise in one sample: of second differences, by their median.
pub(in crate::nailvideo) fn noise_sd(values: &[f64]) -> Option<f64> {
    let mut all: Vec<f64> =
        values.windows(3).map(|v| (v[0] - 2.0 * v[1] + v[2]).abs()).filter(|d| d.is_finite()).collect();
    if all.len() < 8 {
        return None;
    }
    Some(SD_OF_MAD * median(&mut all)? / 6.0_f64.sqrt())
}

/// Presses in the order of time; `whole` is what a change of all light is in the unit of the traces.
pub(super) fn presses(time_s: &[f64], traces: &[Trace], whole: f64) -> Vec<Found> {
    let noise: Vec<f64> = traces.iter().map(|trace| noise_sd(&trace.values).unwrap_or(f64::INFINITY)).collect();
    let [quick, slow] = SIDES_S.map(|side_s| {
        let steps: Vec<Vec<f64>> = (0..time_s.len()).map(|k| step(time_s, traces, k, side_s)).collect();
        let part = if side_s == SIDES_S[0] { LEAST_PART } else { LEAST_PART_SLOWLY };
        let events = largest(time_s, &steps, &noise, part * whole, side_s.max(APART_S));
        events.into_iter().map(|(k, size)| Step { k, size, by: steps[k].clone() }).collect::<Vec<_>>()
    });
    let far = |one: &Step| quick.iter().all(|other| (time_s[one.k] - time_s[other.k]).abs() > SIDES_S[1]);
    let slow: Vec<Step> = slow.into_iter().filter(far).collect();
    let mut events: Vec<Step> = quick.into_iter().chain(slow).collect();
    events.sort_by_key(|step| step.k);
    paired(time_s, &events)
}

/// A place where the traces step.
#[derive(Debug)]
struct Step {
    k: usize,
    size: f64,
    /// Of each trace.
    by: Vec<f64>,
}

/// Where the traces step most within `apart_s`, and by how many SDs.
fn largest(time_s: &[f64], steps: &[Vec<f64>], noise: &[f64], least: f64, apart_s: f64) -> Vec<(usize, f64)> {
    let size = |k: usize| {
        let of = |(step, noise): (&f64, &f64)| {
            if step.is_finite() && step.abs() >= least { step.abs() / noise.max(1e-9) } else { 0.0 }
        };
        steps[k].iter().zip(noise).map(of).fold(0.0, f64::max)
    };
    let sizes: Vec<f64> = (0..time_s.len()).map(size).collect();
    let is_largest = |k: usize| {
        let near = |other: &usize| (time_s[*other] - time_s[k]).abs() <= apart_s;
        let before = (0..k).rev().take_while(near).all(|other| sizes[other] < sizes[k]);
        before && (k + 1..sizes.len()).take_while(near).all(|other| sizes[other] <= sizes[k])
    };
    (0..sizes.len()).filter(|&k| sizes[k] >= LEAST_SDS && is_largest(k)).map(|k| (k, sizes[k])).collect()
}

/// Presses and releases of steps in the order of time.
fn paired(time_s: &[f64], events: &[Step]) -> Vec<Found> {
    // With each, the step that began it, and the one that ended it.
    let mut found: Vec<(Found, &Step, Option<&Step>)> = Vec::new();
    for step in events {
        let same = |other: &Step| {
            let part = |(a, b): (&f64, &f64)| if a.is_finite() && b.is_finite() { a * b } else { 0.0 };
            step.by.iter().zip(&other.by).map(part).sum::<f64>() > 0.0
        };
        let at_s = time_s[step.k];
        match found.last_mut() {
            Some((last, first, end @ None)) if !same(first) => (last.release_s, *end) = (Some(at_s), Some(step)),
            // Pressing harder.
            Some((last, first, None)) => {
                if step.size > first.size {
                    (last.press_s, *first) = (at_s, step);
                }
            }
            // Letting go further.
            Some((last, first, Some(end))) if !same(first) => {
                if step.size > end.size {
                    (last.release_s, *end) = (Some(at_s), step);
                }
            }
            _ => found.push((Found { press_s: at_s, release_s: None }, step, None)),
        }
    }
    found.into_iter().map(|(found, ..)| found).collect()
}

/// Of each trace the mean after sample `k`, itself among them, less that before.
fn step(time_s: &[f64], traces: &[Trace], k: usize, side_s: f64) -> Vec<f64> {
    let from = time_s.partition_point(|&t| t < time_s[k] - side_s);
    let to = time_s.partition_point(|&t| t < time_s[k] + side_s);
    let mean = |values: &[f64]| {
        let known: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
        let few = known.len() < FEWEST || (known.len() as f64) < LEAST_KNOWN * values.len() as f64;
        if few { f64::NAN } else { known.iter().sum::<f64>() / known.len() as f64 }
    };
    traces.iter().map(|trace| mean(&trace.values[k..to]) - mean(&trace.values[from..k])).collect()
}
