//! When a nail was pressed and let go, from the traces of all photodiodes.
//!
//! A step is a time at which the means of a quarter of a second after and before differ most, over all photodiodes by
//! more than their standard errors say, which hold what an encoder leaves for many frames; where there is none near,
//! means of half a second and of one and a half, for slow courses. Steps in opposite directions are never one. The
//! first step leads away from rest, so it is a press; one in the opposite direction is a release, one in the same
//! direction is pressing harder and belongs to the press.

use super::Trace;
use crate::median::{SD_OF_MAD, median};

/// What steps are looked for at.
struct Scale {
    /// What is averaged before and after a step, seconds.
    side_s: f64,
    /// Steps in one direction that are nearer than this are one, seconds.
    apart_s: f64,
    /// The least step, as a part of the values' size where the nail is at rest: 3.7 % of the light, 2 % as encoded
    /// (assumed: below it are vasomotion and exposure; of a press, ratios of light change 1.8 times as much as those of
    /// colours as encoded). Slow changes are larger over longer means.
    least_part: f64,
}

/// Taps, presses, and slow courses (assumed; the second is longer than the time constants of 4.3).
const SCALES: [Scale; 3] = [
    Scale { side_s: 0.25, apart_s: 0.3, least_part: 0.037 },
    Scale { side_s: 0.5, apart_s: 0.6, least_part: 0.037 },
    Scale { side_s: 1.5, apart_s: 1.5, least_part: 0.074 },
];
/// The least squares of a step, each in standard errors of one value, summed over the photodiodes: of none, and more of
/// each. Of 77 films of real nails that nobody pressed 18 had presses by the noise from frame to frame, none by these.
/// Whether the step itself is large enough is for its course to say.
const LEAST_SQUARES: [f64; 2] = [20.0, 4.0];
/// Samples on each side, and their share of the frames: over a gap slow changes look like steps.
const FEWEST: usize = 4;
const LEAST_KNOWN: f64 = 0.6;

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

/// Presses in the order of time; `sd` are the traces' standard errors, `whole` is what a change of all light is in
/// their unit.
pub(super) fn presses(time_s: &[f64], traces: &[Trace], sd: &[Option<f64>], whole: f64) -> Vec<Found> {
    let mut events: Vec<Step> = Vec::new();
    for scale in &SCALES {
        let mut steps = largest(time_s, traces, sd, scale, whole);
        let is_far = |k: usize| events.iter().all(|other| (time_s[k] - time_s[other.k]).abs() > scale.side_s);
        steps.retain(|one| is_far(one.k));
        events.extend(steps);
    }
    events.sort_by_key(|step| step.k);
    paired(time_s, &events)
}

/// A place where the traces step.
#[derive(Debug, Clone)]
struct Step {
    k: usize,
    /// In standard errors, the root of the sum of squares; 0 where it is none.
    size: f64,
    /// Of each trace.
    by: Vec<f64>,
}

impl Step {
    /// Whether both lead in one direction, over all photodiodes.
    fn is_along(&self, other: &Self) -> bool {
        let part = |(a, b): (&f64, &f64)| if a.is_finite() && b.is_finite() { a * b } else { 0.0 };
        self.by.iter().zip(&other.by).map(part).sum::<f64>() > 0.0
    }
}

/// Where the traces step most of all steps near in the same direction.
fn largest(time_s: &[f64], traces: &[Trace], sd: &[Option<f64>], scale: &Scale, whole: f64) -> Vec<Step> {
    let of = |k: usize| {
        let by = step(time_s, traces, k, scale.side_s);
        let known = by.iter().zip(sd).filter(|(step, _)| step.is_finite());
        let squares: Vec<f64> = known.filter_map(|(step, sd)| Some((step / (*sd)?.max(1e-9)).powi(2))).collect();
        let sum: f64 = squares.iter().sum();
        let is_one = sum >= LEAST_SQUARES[0] + LEAST_SQUARES[1] * squares.len() as f64
            && by.iter().any(|step| step.abs() >= scale.least_part * whole);
        Step { k, size: if is_one { sum.sqrt() } else { 0.0 }, by }
    };
    let steps: Vec<Step> = (0..time_s.len()).map(of).collect();
    let is_largest = |one: &&Step| {
        let near = |other: &&Step| (time_s[other.k] - time_s[one.k]).abs() <= scale.apart_s;
        let before = steps[..one.k].iter().rev().take_while(near);
        let after = steps[one.k + 1..].iter().take_while(near);
        before.filter(|other| other.is_along(one)).all(|other| other.size < one.size)
            && after.filter(|other| other.is_along(one)).all(|other| other.size <= one.size)
    };
    steps.iter().filter(|one| one.size > 0.0).filter(is_largest).cloned().collect()
}

/// Presses and releases of steps in the order of time.
fn paired(time_s: &[f64], events: &[Step]) -> Vec<Found> {
    // With each, the step that began it, and the one that ended it.
    let mut found: Vec<(Found, &Step, Option<&Step>)> = Vec::new();
    for step in events {
        let at_s = time_s[step.k];
        match found.last_mut() {
            Some((last, first, end @ None)) if !step.is_along(first) => {
                (last.release_s, *end) = (Some(at_s), Some(step))
            }
            // Pressing harder.
            Some((last, first, None)) => {
                if step.size > first.size {
                    (last.press_s, *first) = (at_s, step);
                }
            }
            // Letting go further.
            Some((last, first, Some(end))) if !step.is_along(first) => {
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
