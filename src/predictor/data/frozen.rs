//! Columns that stand still for a while in the middle of a recording: a transducer or an amplifier that hangs; targets
//! that do so throughout one of several recordings, as where 0 was written for what was not recorded.
//!
//! Values that stay the same to the last digit are no fault by themselves: a coarse converter at rest gives them, and a
//! force of 0, a photodiode at an end of its range, a force or an angle at the end that is nearer to 0, where a finger
//! rests. They are one where the other photodiodes say, by a linear model of the rest of the recording, or of the other
//! recordings, that the value moved meanwhile.

use std::ops::Range;

use lunula_predictor::{Dataset, Deficient, LeastSquaresOptions, Recording, least_squares};
use ndarray::{ArrayView1, ArrayView2, Axis, Slice, concatenate};

use super::health::called;
use crate::median::ends;
use crate::words::grouped;

/// The least that is called standing still, rows and seconds; and as rows of the rest for each unknown (assumed).
const ROWS: usize = 20;
const SECONDS: f64 = 1.0;
/// A force, or an angle, of so little of its range is at rest: a straight finger's that only presses (assumed).
const NEAR_0: f64 = 0.01;
/// The photodiodes know the column where they leave so much of its SD at most, and say that it moved where what they
/// make of it has so much of its SD at least (assumed).
const UNEXPLAINED: f64 = 0.6;
const MOVED: f64 = 0.5;

/// What to say of them, recording by recording.
pub(super) fn warnings(data: &Dataset) -> Vec<String> {
    let names: Vec<&String> = data.inputs().iter().chain(data.targets()).collect();
    let of_recording = |one: &Recording| {
        let rest = |run: &Range<usize>| [one.rows.start..run.start, run.end..one.rows.end];
        let held = names.iter().enumerate().filter_map(|(column, name)| {
            let run = longest_run(data, one, column).filter(|run| moved(data, column, run, &rest(run)))?;
            Some((run, name.as_str()))
        });
        let say = |(run, names): (Range<usize>, Vec<&str>)| {
            let [from, to] = [run.start, run.end - 1].map(|row| data.time_s()[row]);
            let when = if from.is_nan() { String::new() } else { format!(" from {from:.1} to {to:.1} s") };
            format!(
                "{}: {} doesn't change by a digit in {} rows{when}, while the {} say that it moved: did it hang?",
                one.name,
                names.join(", "),
                run.len(),
                called(data)
            )
        };
        grouped(held)
            .into_iter()
            .map(say)
            .chain(all_at_once(data, one))
            .chain(never_moves(data, one))
            .collect::<Vec<_>>()
    };
    data.recordings().iter().flat_map(of_recording).collect()
}

/// What to say where all photodiodes stand still while what they answer to moves, as where what logs them hangs.
fn all_at_once(data: &Dataset, one: &Recording) -> Option<String> {
    let (x, rows) = (data.x(), one.rows.clone());
    let longest = longest(&rows, |row| x.row(row) == x.row(row - 1), |_| true);
    let sd = |target: usize, rows: &Range<usize>| {
        data.y().column(target).slice_axis(Axis(0), Slice::from(rows.clone())).std(0.0)
    };
    let moved = |target: &usize| sd(*target, &longest) >= MOVED * sd(*target, &rows) && sd(*target, &rows) > 0.0;
    let moved: Vec<&str> =
        (0..data.targets().len()).filter(moved).map(|target| data.targets()[target].as_str()).collect();
    let is_one = data.inputs().len() > 1 && longest.len() < rows.len() && lasts(data, &longest) && !moved.is_empty();
    is_one.then(|| {
        let [from_s, to_s] = [longest.start, longest.end - 1].map(|row| data.time_s()[row]);
        format!(
            "{}: all {} keep their values in {} rows, from {from_s:.1} to {to_s:.1} s, while {} moves: did what logs \
             them hang?",
            one.name,
            called(data),
            longest.len(),
            moved.join(", ")
        )
    })
}

/// What to say of targets that have a single value in a recording in which another one moves, while the photodiodes
/// say, by the recordings in which they move, that they did. Where none moves, nothing was touched, or only pressed.
fn never_moves(data: &Dataset, one: &Recording) -> Option<String> {
    let y = data.y();
    let first = |rows: &Range<usize>, target: usize| y[[rows.start, target]];
    let is_one =
        |one: &Recording, target: usize| one.rows.clone().all(|row| y[[row, target]] == first(&one.rows, target));
    let all = 0..data.targets().len();
    if !lasts(data, &one.rows) || all.clone().all(|target| is_one(one, target)) {
        return None;
    }
    let is_still = |target: &usize| {
        let rest = data.recordings().iter().filter(|other| !is_one(other, *target)).map(|other| other.rows.clone());
        is_one(one, *target) && moved(data, data.inputs().len() + target, &one.rows, &rest.collect::<Vec<_>>())
    };
    let still: Vec<String> =
        all.filter(is_still).map(|k| format!("{} ({})", data.targets()[k], first(&one.rows, k))).collect();
    (!still.is_empty()).then(|| {
        format!(
            "{}: {} is the same in all {} rows, while the {} say, as in the other recordings, that it moved: was it \
             recorded? Leave cells empty that were not",
            one.name,
            still.join(", "),
            one.rows.len(),
            called(data)
        )
    })
}

/// The longest run of rows, the first of equals, each of which counts and is as the one before.
fn longest(rows: &Range<usize>, is_same: impl Fn(usize) -> bool, counts: impl Fn(usize) -> bool) -> Range<usize> {
    let (mut longest, mut start) = (rows.start..rows.start, rows.start);
    for row in rows.clone() {
        if row > rows.start && !is_same(row) {
            start = row;
        }
        if row + 1 - start > longest.len() && counts(row) {
            longest = start..row + 1;
        }
    }
    longest
}

/// Whether rows are enough to be called standing still.
fn lasts(data: &Dataset, rows: &Range<usize>) -> bool {
    let long = || data.time_s()[rows.end - 1] - data.time_s()[rows.start];
    rows.len() >= ROWS && (long().is_nan() || long() >= SECONDS)
}

fn column(data: &Dataset, column: usize) -> ArrayView1<'_, f64> {
    let inputs = data.inputs().len();
    if column < inputs { data.x().column(column) } else { data.y().column(column - inputs) }
}

/// The longest run of rows of a recording in which a column stays the same, neither near 0 nor at an end of its range
/// at which it may rest.
fn longest_run(data: &Dataset, one: &Recording, k: usize) -> Option<Range<usize>> {
    let values = column(data, k);
    let own = values.slice_axis(Axis(0), Slice::from(one.rows.clone()));
    let ends = ends(own.iter().copied());
    let is_target = k >= data.inputs().len();
    let near = if is_target { NEAR_0 * (ends[1] - ends[0]) } else { 0.0 };
    // A transducer that hangs while the force grows shows the greatest of all.
    let is_end = |value: f64| ends.contains(&value) && !(is_target && ends.iter().any(|end| end.abs() < value.abs()));
    let rests = |value: f64| value.abs() <= near || is_end(value);
    let longest = longest(&one.rows, |row| values[row] == values[row - 1], |row| !rests(values[row]));
    lasts(data, &longest).then_some(longest)
}

/// Whether the other photodiodes know a column by the rows of `rest`, and say that it moved in a run of rows.
fn moved(data: &Dataset, k: usize, run: &Range<usize>, rest: &[Range<usize>]) -> bool {
    let others: Vec<usize> = (0..data.inputs().len()).filter(|&input| input != k).collect();
    if others.is_empty() || rest.iter().map(Range::len).sum::<usize>() < ROWS * (1 + others.len()) {
        return false;
    }
    let x = data.x().select(Axis(1), &others);
    let values = column(data, k).insert_axis(Axis(1));
    let parts = |of: ArrayView2<'_, f64>| {
        let parts: Vec<_> = rest.iter().map(|rows| of.slice_axis(Axis(0), Slice::from(rows.clone()))).collect();
        concatenate(Axis(0), &parts).expect("parts of one array")
    };
    let (design, known) = (parts(x.view()), parts(values));
    let options = LeastSquaresOptions { deficient: Deficient::MinimumNorm, ..LeastSquaresOptions::default() };
    let Ok(fit) = least_squares(design.view(), known.view(), &options) else { return false };
    let sd = known.std(0.0);
    let is_known = fit.residual_sd[0].is_some_and(|left| left <= UNEXPLAINED * sd);
    let said = x.slice_axis(Axis(0), Slice::from(run.clone())).dot(&fit.coefficients.row(0));
    is_known && sd > 0.0 && said.std(0.0) >= MOVED * sd
}
