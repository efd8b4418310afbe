//! Whether a recording is a part of another, which it is tried on, or counted beside: a copy, a piece, every other row,
//! or one of these on another clock.
//!
//! In: two [`Dataset`]s. Out: which recordings of the second were, by time and voltages, sampled together with one of
//! the first. Errors on such rows are those on rows that the model has seen, and intervals from them hold too little.
//!
//! A row is compared with what lies about its time in the other recording, linear in between, in units of what each of
//! that one's own rows is off its neighbours. Measured on phantom logs of touch: every other row is 0.8 to 1.0 of that
//! off; a repetition by the same person, from the same time on, 6 and more. On another clock only the same rows are
//! parts, whatever digits they were rounded to: where some rows of the one are in the other says how far it is ahead.

use std::ops::Range;

use rayon::prelude::*;

use super::path::Between;
use crate::Dataset;
use crate::evaluate::sum::{mean, rms};

/// Rows of a recording, at least, and moments that are looked at.
const ROWS: usize = 20;
const MOMENTS: usize = 400;
/// A gap is longer than so many usual steps.
const GAP: f64 = 2.5;
/// Of a recording's rows so many lie about rows of the other, and are so many times as far off as those are off each
/// other at most (assumed; the head says what was measured).
const SHARED: f64 = 0.5;
const TIMES: f64 = 1.5;
/// A column says something that goes so many times as far as its rows are off each other.
const MOVES: f64 = 5.0;
/// What rounding leaves, as a share of how far a column goes.
const ROUNDING: f64 = 1e-9;
/// The same rows are no further off each other than by this (assumed: digits that were cut off), where so many of some
/// rows agree on how far the clock is ahead, to so many steps.
const SAME: f64 = 0.5;
const PROBES: usize = 5;
const AGREE: usize = 4;
const STEPS: f64 = 2.0;

/// The recordings of `held` that are parts of one of `train`: their places, and that one's.
///
/// # Panics
/// Where the sets have other inputs than each other.
#[must_use]
pub fn shared(train: &Dataset, held: &Dataset) -> Vec<(usize, usize)> {
    assert_eq!(train.inputs(), held.inputs(), "sets of the same inputs");
    let of = |b: usize| {
        let is_part = |a: &usize| is_part([train, held], [&train.recordings()[*a].rows, &held.recordings()[b].rows]);
        (0..train.recordings().len()).find(is_part).map(|a| (b, a))
    };
    (0..held.recordings().len()).filter_map(of).collect()
}

/// The recordings of one dataset that are parts of another of it: their places, and that one's, each once.
#[must_use]
pub fn shared_within(data: &Dataset) -> Vec<(usize, usize)> {
    let rows = |k: usize| &data.recordings()[k].rows;
    let of = |b: usize| {
        let larger = |a: &usize| (rows(*a).len(), b) > (rows(b).len(), *a);
        (0..data.recordings().len()).find(|a| larger(a) && is_part([data; 2], [rows(*a), rows(b)])).map(|a| (b, a))
    };
    (0..data.recordings().len()).into_par_iter().filter_map(of).collect()
}

fn is_part(sets: [&Dataset; 2], rows: [&Range<usize>; 2]) -> bool {
    is_part_ahead(sets, rows, 0.0, TIMES)
        || ahead_s(sets, rows).is_some_and(|ahead_s| is_part_ahead(sets, rows, ahead_s, SAME))
}

/// How far the clock of `train` seems to be ahead of that of `held`, by the rows that are nearest to some of it.
fn ahead_s([train, held]: [&Dataset; 2], rows: [&Range<usize>; 2]) -> Option<f64> {
    let count = rows[1].len();
    if count.min(rows[0].len()) < ROWS {
        return None;
    }
    let usual_s = (train.time_s()[rows[0].end - 1] - train.time_s()[rows[0].start]) / (rows[0].len() - 1) as f64;
    let ahead = |k: usize| {
        let row = rows[1].start + k * count / (PROBES + 1);
        let off = |other: usize| -> f64 {
            train.x().row(other).iter().zip(held.x().row(row)).map(|(a, b)| (a - b) * (a - b)).sum()
        };
        let near = rows[0].clone().min_by(|a, b| off(*a).total_cmp(&off(*b)))?;
        Some(train.time_s()[near] - held.time_s()[row])
    };
    let mut all: Vec<f64> = Vec::new();
    for k in 1..=PROBES {
        all.push(ahead(k)?);
        all.sort_by(f64::total_cmp);
        let middle = all[all.len() / 2];
        let agree = all.iter().filter(|ahead_s| (*ahead_s - middle).abs() <= STEPS * usual_s).count();
        if agree + PROBES < AGREE + all.len() {
            return None;
        }
    }
    Some(all[PROBES / 2]).filter(|middle| *middle != 0.0)
}

/// Whether it is, where the clock of the first is so far ahead, and rows may be so many times as far off.
fn is_part_ahead([train, held]: [&Dataset; 2], rows: [&Range<usize>; 2], ahead_s: f64, most: f64) -> bool {
    let times = &train.time_s()[rows[0].clone()];
    let moments: Vec<f64> = held.time_s()[rows[1].clone()].iter().map(|time_s| time_s + ahead_s).collect();
    let ascends =
        |times: &[f64]| times.windows(2).all(|pair| pair[0] <= pair[1]) && times.iter().all(|t| t.is_finite());
    if times.len().min(moments.len()) < ROWS || !ascends(times) || !ascends(&moments) {
        return false;
    }
    let mut steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let middle = steps.len() / 2;
    let usual_s = *steps.select_nth_unstable_by(middle, f64::total_cmp).1;
    let within = |&&row: &&usize| {
        let at = moments[row];
        let next = times.partition_point(|&t| t < at);
        let is_row = times.get(next) == Some(&at);
        is_row || next > 0 && next < times.len() && times[next] - times[next - 1] <= GAP * usual_s
    };
    let looked: Vec<usize> = (0..moments.len()).step_by(moments.len().div_ceil(MOMENTS)).collect();
    let about: Vec<usize> = looked.iter().filter(within).copied().collect();
    if (about.len() as f64) < SHARED * looked.len() as f64 {
        return false;
    }
    let between: Vec<Between> = Between::rows(times, about.iter().map(|&row| moments[row])).collect();
    let (mut moving, mut alike) = (0, 0);
    for column in 0..train.inputs().len() {
        let own = |row: usize| train.x()[[rows[0].start + row, column]];
        let values: Vec<f64> = (0..times.len()).map(own).collect();
        let middle = mean(values.iter().copied());
        let goes = rms(values.iter().map(|value| value - middle));
        let off = rms((1..times.len() - 1).filter(|&k| times[k + 1] > times[k - 1]).map(|k| {
            let share = (times[k] - times[k - 1]) / (times[k + 1] - times[k - 1]);
            values[k] - values[k - 1] - share * (values[k + 1] - values[k - 1])
        }));
        if goes > 0.0 && goes > MOVES * off {
            let there = |(&row, at): (&usize, &Between)| held.x()[[rows[1].start + row, column]] - at.value(own);
            moving += 1;
            alike += usize::from(rms(about.iter().zip(&between).map(there)) <= most * off + ROUNDING * goes);
        }
    }
    moving > 0 && alike == moving
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Recording;
    use ndarray::Array2;

    /// A recording of two photodiodes at `times`, with noise of its own.
    fn set(times: &[f64], seed: usize, value: impl Fn(f64) -> f64) -> Dataset {
        let noise = |k: usize| ((k * k * 7919 + (31 + seed) * k + seed) % 1009) as f64 / 1009.0 - 0.5;
        let n = times.len();
        let x = Array2::from_shape_fn((n, 2), |(row, column)| {
            let k = (times[row] * 25.0).round() as usize;
            (1.0 + column as f64) * value(times[row]) + 0.01 * noise(k + 5000 * column)
        });
        let (inputs, one) = (["P1", "P2"].map(str::to_owned).to_vec(), vec![Recording::of("r", 0..n)]);
        Dataset::new(inputs, vec!["F".into()], times.to_vec(), x, Array2::zeros((n, 1)), one).unwrap()
    }

    fn spiral(t: f64) -> f64 {
        (0.3 + 0.02 * t) * (1.1 * t).sin()
    }

    #[test]
    fn parts_of_a_recording_are_seen_and_repetitions_are_not() {
        let all: Vec<f64> = (0..1000).map(|k| 0.04 * f64::from(k)).collect();
        let every = |step: usize, from: usize| all.iter().copied().skip(from).step_by(step).collect::<Vec<f64>>();
        let whole = set(&all, 1, spiral);
        let odd = set(&every(2, 1), 1, spiral);
        for part in [&odd, &set(&all, 1, spiral), &set(&all[300..500], 1, spiral), &set(&every(7, 3), 1, spiral)] {
            assert_eq!(shared(&whole, part), [(0, 0)]);
        }
        assert_eq!(shared(&set(&every(2, 0), 1, spiral), &odd), [(0, 0)]);
        // Parts on another clock, one with fewer digits.
        let moved = |of: &Dataset, digits: i32| {
            let time_s: Vec<f64> = of.time_s().iter().map(|time_s| time_s - 7.3).collect();
            let x = of.x().mapv(|value| (value * 10f64.powi(digits)).round() / 10f64.powi(digits));
            let (inputs, targets) = (of.inputs().to_vec(), of.targets().to_vec());
            Dataset::new(inputs, targets, time_s, x, of.y().clone(), of.recordings().to_vec()).unwrap()
        };
        for (part, digits) in [(&set(&all[300..800], 1, spiral), 12), (&whole, 3), (&odd, 4)] {
            assert_eq!(shared(&whole, &moved(part, digits)), [(0, 0)]);
        }
        // Another time, and another day's run of the same prompt, followed a little otherwise.
        let later: Vec<f64> = all.iter().map(|t| t + 0.4).collect();
        let again = set(&all, 2, |t| 0.94 * spiral(t) + 0.02 * (0.4 * t).cos());
        for other in [again, set(&later, 2, |t| spiral(t - 0.4)), set(&all, 2, |_| 1.0)] {
            assert_eq!(shared(&whole, &other), []);
        }
        // A sensor at rest is like any other, and nobody knows when.
        let rest = set(&all, 1, |_| 1.0);
        assert_eq!(shared(&rest, &rest.clone()), []);
        let unknown = set(&[f64::NAN; 100], 1, |_| 1.0);
        assert_eq!(shared(&unknown, &unknown.clone()), []);
    }
}
