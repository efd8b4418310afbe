//! Whether a recording is a part of another, which it is tried on, or counted beside: a copy, a piece, every other row,
//! or one of these on another clock.
//!
//! In: two [`Dataset`]s. Out: which recordings of the second were, by time and voltages, sampled together with one of
//! the first. Errors on such rows are those on rows that the model has seen, and intervals from them hold too little.
//!
//! A row is compared with what lies about its time in the other recording, linear in between, in units of what each of
//! that one's own rows is off its neighbours. On another clock only the same rows are parts, whatever digits they were
//! rounded to: where some rows of the one are in the other says how far it is ahead.
//!
//! Noise widens these units, and a repetition by the same person hides in it. Noise goes out of means of rows, and
//! labels have little of it: rows between another's are a part where both are as near. Measured on phantoms of touch
//! and bending, lit rows at 2.5 to 30 Hz, noise of up to 20 mV and hum: where photodiodes of repetitions are 0.4 to 1.5
//! of that off, labels or means are 1.5 and more, except where labels are sampled sparsely ([`DENSE`]).

use std::ops::Range;

use ndarray::{ArrayView1, ArrayView2, Axis, Slice};
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
/// So are means of so many rows in a row, out of which noise goes and in which another path stays; of so many means
/// (assumed).
const MEANS: [usize; 3] = [4, 16, 64];
const LEAST_MEANS: usize = 12;
/// A column says something that goes so many times as far as its rows are off each other.
const MOVES: f64 = 5.0;
/// Labels tell repetitions from parts where one of them goes more than so many times as far as its rows are off each
/// other. Sampled more sparsely, angles of phantoms' repetitions lay between each other's rows: at 5 and 6 Hz in 24 of
/// 24 pairs, where no angle went more than 14.7 times as far.
const DENSE: f64 = 16.0;
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
    // Rows between those of the other one have labels between its labels, too; the same rows may be labelled again.
    let is_same = |off: &Off| off.voltages == 0.0 || off.voltages <= SAME && off.labels <= TIMES;
    let is_between = |off: &Off| off.voltages.max(off.means).max(off.labels) <= TIMES;
    off_ahead(sets, rows, 0.0).is_some_and(|off| is_same(&off) || is_between(&off))
        || ahead_s(sets, rows).and_then(|ahead_s| off_ahead(sets, rows, ahead_s)).is_some_and(|off| is_same(&off))
}

/// How far rows are off another recording's, in units of what that one's rows are off each other: the worst of
/// photodiodes, means of rows over all photodiodes, and the worst of labels.
struct Off {
    voltages: f64,
    means: f64,
    labels: f64,
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

/// Nothing where few rows lie about the other's, where no photodiode moves, and where one is too far off.
fn off_ahead([train, held]: [&Dataset; 2], rows: [&Range<usize>; 2], ahead_s: f64) -> Option<Off> {
    let times = &train.time_s()[rows[0].clone()];
    let moments: Vec<f64> = held.time_s()[rows[1].clone()].iter().map(|time_s| time_s + ahead_s).collect();
    let ascends =
        |times: &[f64]| times.windows(2).all(|pair| pair[0] <= pair[1]) && times.iter().all(|t| t.is_finite());
    if times.len().min(moments.len()) < ROWS || !ascends(times) || !ascends(&moments) {
        return None;
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
        return None;
    }
    let between: Vec<Between> = Between::rows(times, about.iter().map(|&row| moments[row])).collect();
    let all = |columns: [ArrayView2<'_, f64>; 2]| -> Vec<Compared> {
        let of = |column: usize| {
            let own = |row: usize| columns[0][[rows[0].start + row, column]];
            let there = |(&row, at): (&usize, &Between)| columns[1][[rows[1].start + row, column]] - at.value(own);
            Compared::new(times, own, about.iter().zip(&between).map(there).collect())
        };
        (0..columns[0].ncols()).filter_map(of).collect()
    };
    let photodiodes = all([train.x().view(), held.x().view()]);
    let voltages = worst(&photodiodes);
    if photodiodes.is_empty() || voltages > TIMES {
        return None;
    }
    let means = MEANS.iter().map(|&rows| rms(photodiodes.iter().filter_map(|one| one.means(rows))));
    let means = means.filter(|times| !times.is_nan()).fold(0.0, f64::max);
    let same_targets = train.targets() == held.targets();
    let labels = if same_targets { all([train.y().view(), held.y().view()]) } else { Vec::new() };
    let moves = |column: ArrayView1<'_, f64>| column.iter().any(|value| *value != column[0]);
    let some_move =
        same_targets && train.y().slice_axis(Axis(0), Slice::from(rows[0].clone())).axis_iter(Axis(1)).any(moves);
    let sparse = some_move && !labels.iter().any(|one| one.goes > DENSE * rms(one.own.iter().copied()));
    let labels = if sparse { f64::INFINITY } else { worst(&labels) };
    Some(Off { voltages, means, labels })
}

fn worst(columns: &[Compared]) -> f64 {
    columns.iter().map(Compared::rows).fold(0.0, f64::max)
}

/// A column that says something: how far rows are off the other recording, and how far that one's are off each other.
struct Compared {
    there: Vec<f64>,
    own: Vec<f64>,
    goes: f64,
}

impl Compared {
    fn new(times: &[f64], own: impl Fn(usize) -> f64, there: Vec<f64>) -> Option<Self> {
        let values: Vec<f64> = (0..times.len()).map(own).collect();
        let middle = mean(values.iter().copied());
        let goes = rms(values.iter().map(|value| value - middle));
        let inner = (1..times.len() - 1).filter(|&k| times[k + 1] > times[k - 1]);
        let own = inner.map(|k| {
            let share = (times[k] - times[k - 1]) / (times[k + 1] - times[k - 1]);
            values[k] - values[k - 1] - share * (values[k + 1] - values[k - 1])
        });
        let own: Vec<f64> = own.collect();
        let moves = goes > 0.0 && goes > MOVES * rms(own.iter().copied());
        moves.then_some(Self { there, own, goes })
    }

    /// How many times as far rows are off.
    fn rows(&self) -> f64 {
        self.times(rms(self.there.iter().copied()), rms(self.own.iter().copied()))
    }

    /// The same of means of so many rows in a row, where there are enough.
    fn means(&self, rows: usize) -> Option<f64> {
        // Every other row between those that are left, as a part's would be: means of all rows would hold little noise,
        // as each row's is taken away again by its neighbours.
        let odd: Vec<f64> = self.own.iter().copied().step_by(2).collect();
        let of = |off: &[f64]| rms(off.chunks_exact(rows).map(|chunk| mean(chunk.iter().copied())));
        let enough = self.there.len().min(odd.len()) >= LEAST_MEANS * rows;
        enough.then(|| self.times(of(&self.there), of(&odd)))
    }

    fn times(&self, there: f64, own: f64) -> f64 {
        let least = ROUNDING * self.goes;
        let times = if there <= least { 0.0 } else { (there - least) / own };
        if times.is_nan() { f64::INFINITY } else { times }
    }
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

    /// The same with ten times the noise, and a label.
    fn noisy(times: &[f64], seed: usize, value: impl Fn(f64) -> f64, label: impl Fn(f64) -> f64) -> Dataset {
        let of = set(times, seed, |t| 0.1 * value(t));
        let y = Array2::from_shape_fn((times.len(), 1), |(row, _)| label(times[row]));
        let x = of.x().mapv(|value| 10.0 * value);
        Dataset::new(of.inputs().to_vec(), of.targets().to_vec(), times.to_vec(), x, y, of.recordings().to_vec())
            .unwrap()
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

    #[test]
    fn repetitions_in_noise_are_no_parts_and_parts_in_noise_are() {
        let all: Vec<f64> = (0..1000).map(|k| 0.04 * f64::from(k)).collect();
        let [even, odd] = [0, 1].map(|from| all.iter().copied().skip(from).step_by(2).collect::<Vec<f64>>());
        let whole = noisy(&all, 1, spiral, spiral);
        let another = |t: f64| spiral(t) + 0.015 * (0.4 * t).cos();
        // Noise hides where another went otherwise; it does not hide it from means of rows, nor from labels.
        for (value, label) in [(&another as &dyn Fn(f64) -> f64, &spiral as &dyn Fn(f64) -> f64), (&spiral, &another)] {
            let again = noisy(&all, 2, value, label);
            let off = off_ahead([&whole, &again], [&(0..1000), &(0..1000)], 0.0).unwrap();
            assert!(off.voltages < TIMES && (off.means > TIMES || off.labels > TIMES));
            assert_eq!(shared(&whole, &again), []);
        }
        assert_eq!(shared(&noisy(&even, 1, spiral, spiral), &noisy(&odd, 1, spiral, spiral)), [(0, 0)]);
        assert_eq!(shared(&whole, &noisy(&odd, 1, spiral, spiral)), [(0, 0)]);
        // The same rows, labelled again.
        assert_eq!(shared(&whole, &noisy(&odd, 1, spiral, another)), [(0, 0)]);
    }
}
