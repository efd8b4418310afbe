//! Samples at the end of the recorded range.
//!
//! Either the user gives the range, and a sample within a thousandth of it from an end is saturated (the highest code
//! of a converter of 10 bits stands that far below the top). Or the ends are found: clipping piles samples up at
//! exactly the greatest or least value, and stops the signal in full run. A signal that turns, or comes to rest by
//! itself, also stays at its extreme for a while, so a pile is a rail only where all of these hold:
//! - at least [`COUNT`] samples and at least [`RUN`] of them in a row have exactly this value;
//! - they are at least [`PILE`] times as many as have the value next to it (where a parabola turns: at most 2.4 times);
//! - the step that leads to the pile is, in the median over all arrivals, at least half of a usual step, and more than
//!   one of a converter whose steps show: of 1168 ends of phantoms' photodiodes less ambient light, rounded to 8 bits,
//!   11 are taken for rails rather than 55, and of those that are cut off in truth at 12 bits 742 rather than 797.
//!
//! A channel that is nearly always at its extreme is dead rather than saturated ([`dead`](super::dead)).
//!
//! Lit and unlit samples are looked at apart: only one of the two may be at an end.

use super::dead::DEAD_SHARE;
use crate::median::median_of;

/// The share of a channel's samples from which on saturation has to be acted on; assumed.
const MUCH: f64 = 0.01;

/// The least samples at a rail.
const COUNT: usize = 10;

/// The least samples at a rail in a row.
const RUN: usize = 5;

/// How many times as many samples a rail has as the value next to it.
const PILE: usize = 8;

/// An arrival is so many of the converter's steps, whatever digits they were rounded to.
const STEPS: f64 = 1.5;

/// How near to the end of a given range a sample is saturated, as a share of the range.
const NEAR: f64 = 1e-3;

/// The ends of a channel's range, as far as they were reached.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rails {
    low: f64,
    high: f64,
    /// Samples at the ends, where they were found and not given.
    found: [usize; 2],
}

impl Rails {
    /// Of a channel's lit and unlit samples.
    pub(super) fn of(lit: &[f64], dark: &[f64], full_scale_v: Option<[f64; 2]>) -> Self {
        if let Some(full_scale_v) = full_scale_v {
            return Self::given(full_scale_v);
        }
        let negated = |values: &[f64]| -> Vec<f64> { values.iter().map(|v| -v).collect() };
        let top = |lit: &[f64], dark: &[f64]| {
            let greatest = lit.iter().chain(dark).copied().fold(f64::NEG_INFINITY, f64::max);
            let of = |values: &[f64]| pile_at(values, greatest).unwrap_or(0);
            (greatest, of(lit) + of(dark))
        };
        let (high, at_high) = top(lit, dark);
        let (low, at_low) = top(&negated(lit), &negated(dark));
        Self {
            low: if at_low > 0 { -low } else { f64::NEG_INFINITY },
            high: if at_high > 0 { high } else { f64::INFINITY },
            found: [at_low, at_high],
        }
    }

    /// Of a given range.
    pub(super) fn given([low, high]: [f64; 2]) -> Self {
        let near = NEAR * (high - low);
        Self { low: low + near, high: high - near, found: [0; 2] }
    }

    /// Whether a sample is at an end.
    pub(super) fn reached(&self, value: f64) -> bool {
        value <= self.low || value >= self.high
    }

    /// Whether so much of `samples` is saturated that it is a warning.
    pub(super) fn is_much_of(&self, samples: usize) -> bool {
        self.found.iter().sum::<usize>() as f64 > MUCH * samples as f64
    }

    /// What was found.
    pub(super) fn note(&self, name: &str) -> Option<String> {
        let ends = [(self.found[0], self.low, "least"), (self.found[1], self.high, "greatest")];
        let shares: Vec<String> = ends
            .iter()
            .filter(|(count, ..)| *count > 0)
            .map(|(count, value, which)| format!("its {which} value, {value} V, in {count} samples"))
            .collect();
        (!shares.is_empty()).then(|| {
            format!(
                "{name} stays at exactly {}: taken as saturated; --full-scale LOW,HIGH says where the range ends",
                shares.join(", and ")
            )
        })
    }
}

/// The least and the greatest value of a channel, each with how many samples have exactly it, where they are the ends
/// of its range.
pub(crate) fn piles(values: &[f64]) -> [Option<(f64, usize)>; 2] {
    let Rails { low, high, found } = Rails::of(values, &[], None);
    [(low, found[0]), (high, found[1])].map(|(value, count)| (count > 0).then_some((value, count)))
}

/// How many samples are piled up at the value `greatest`, if it is a rail for these samples.
fn pile_at(values: &[f64], greatest: f64) -> Option<usize> {
    let values: Vec<f64> = values.iter().copied().filter(|v| !v.is_nan()).collect();
    let count = values.iter().filter(|&&v| v == greatest).count();
    if count < COUNT || count as f64 >= DEAD_SHARE * values.len() as f64 {
        return None;
    }
    let longest = values.chunk_by(|a, b| a == b).filter(|run| run[0] == greatest).map(<[f64]>::len).max();
    let next = values.iter().copied().filter(|&v| v < greatest).fold(f64::NEG_INFINITY, f64::max);
    let beside = values.iter().filter(|&&v| v == next).count();
    if longest < Some(RUN) || count < PILE * beside {
        return None;
    }
    let off = |pair: &&[f64]| pair[0] < greatest && pair[1] < greatest;
    let usual = median_of(values.windows(2).filter(off).map(|pair| (pair[1] - pair[0]).abs()))?;
    let arrives = |three: &&[f64]| three[0] < greatest && three[1] < greatest && three[2] == greatest;
    let arriving = median_of(values.windows(3).filter(arrives).map(|three| (three[1] - three[0]).abs()))?;
    let mut sorted = values;
    sorted.sort_by(f64::total_cmp);
    let step = sorted.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0).fold(f64::INFINITY, f64::min);
    (arriving >= 0.5 * usual && arriving > STEPS * step).then_some(count)
}
