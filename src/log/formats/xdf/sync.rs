//! A stream's stamps on the recorder's clock, and without the jitter of their delivery.
//!
//! The recorder measures every few seconds how far the source's clock is from its own. Between two resets of the
//! source's clock the difference is a straight line in time, fitted to these measurements with Huber's loss (threshold
//! 0.1 ms), as pyxdf does; a reset is where the measurements' time falls back, or where both their time and their value
//! leap. Samples belong to the line whose measurements are nearer.
//!
//! Departure from pyxdf: stamps of a regular stream are only put on a straight line where none lies further than half
//! an interval from it. Where samples were lost, or the rate is not even, a line through all of them can be off by
//! tenths of a second.

use crate::log::formats::xdf::chunks::Stream;

/// Beyond this a measurement of the clocks counts as an outlier, seconds.
const OUTLIER_S: f64 = 1e-4;

/// A step longer than this (and than so many intervals) begins a new line of stamps, seconds.
const BREAK_S: f64 = 1.0;

/// See [`BREAK_S`].
const BREAK_INTERVALS: f64 = 500.0;

/// `height + slope x`
type Line = [f64; 2];

/// Puts the stamps on the recorder's clock.
pub(super) fn to_recorder(stream: &mut Stream, notes: &mut Vec<String>) {
    let offsets_s = &stream.offsets_s;
    if offsets_s.is_empty() {
        notes.push(
            "the recording has no measurements of the stream's clock; its stamps are taken as they are".to_owned(),
        );
        return;
    }
    let ends = resets(offsets_s);
    if ends.len() > 1 {
        notes.push(format!("the stream's clock was reset {} time(s); its stamps go on over that", ends.len() - 1));
    }
    let (mut begin, mut sample) = (0, 0);
    for &end in &ends {
        let line = huber(&offsets_s[begin..end]);
        let last = match offsets_s.get(end) {
            Some(next) => {
                let here = offsets_s[end - 1][0];
                let nearer = |t: &f64| (t - here).abs() < (t - next[0]).abs();
                sample + stream.time_s[sample..].iter().take_while(|&t| nearer(t)).count()
            }
            None => stream.time_s.len(),
        };
        stream.time_s[sample..last].iter_mut().for_each(|t| *t += line[0] + line[1] * *t);
        (begin, sample) = (end, last);
    }
}

/// Takes away the jitter of a regular stream's stamps.
pub(super) fn smooth(stream: &mut Stream, notes: &mut Vec<String>) {
    if stream.rate_hz == 0.0 || stream.drops {
        return;
    }
    let interval_s = 1.0 / stream.rate_hz;
    let longest_s = BREAK_S.max(BREAK_INTERVALS * interval_s);
    let (mut smoothed, mut left) = (0, 0);
    for stretch in stream.time_s.chunk_by_mut(|a, b| (b - a).abs() <= longest_s) {
        let points: Vec<[f64; 2]> = stretch.iter().enumerate().map(|(k, &t)| [k as f64, t]).collect();
        let line = fit(&points, |_| 1.0);
        let near = |(k, t): (usize, &f64)| (t - line[0] - line[1] * k as f64).abs() <= 0.5 * interval_s;
        if !stretch.iter().enumerate().all(near) {
            left += stretch.len();
            continue;
        }
        smoothed += stretch.len();
        stretch.iter_mut().enumerate().for_each(|(k, t)| *t = line[0] + line[1] * k as f64);
    }
    if smoothed > 0 {
        notes.push(format!("the stamps of {smoothed} samples are put on a straight line, as their rate is even"));
    }
    if left > 0 {
        notes.push(format!("the stamps of {left} samples are left as they came, as their rate is not even"));
    }
}

/// Where stretches between two resets end.
fn resets(offsets_s: &[[f64; 2]]) -> Vec<usize> {
    let steps =
        |column: usize| -> Vec<f64> { offsets_s.windows(2).map(|pair| pair[1][column] - pair[0][column]).collect() };
    let (times, values) = (steps(0), steps(1));
    // pyxdf's thresholds: multiples of the median absolute deviation, and seconds.
    let (times_leap, values_leap) = (leaps(&times, 5.0, 5.0), leaps(&values, 10.0, 1.0));
    let reset = |k: &usize| times[*k] < 0.0 || times_leap[*k] && values_leap[*k];
    (0..times.len()).filter(reset).map(|k| k + 1).chain([offsets_s.len()]).collect()
}

/// Which steps are far from the usual one: by so many median absolute deviations, and by so many seconds.
fn leaps(steps: &[f64], deviations: f64, seconds: f64) -> Vec<bool> {
    if steps.is_empty() {
        return Vec::new();
    }
    let usual = median(steps.to_vec());
    let deviation = median(steps.iter().map(|s| (s - usual).abs()).collect()) + f64::EPSILON;
    let far = |s: &f64| (s - usual).abs() > seconds && (s - usual).abs() / deviation > deviations;
    steps.iter().map(far).collect()
}

/// The middle value; the mean of the two in the middle of an even number.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    if values.len() % 2 == 1 { values[middle] } else { 0.5 * (values[middle - 1] + values[middle]) }
}

/// The line through points with Huber's loss, by least squares with weights until they stand.
fn huber(points: &[[f64; 2]]) -> Line {
    const ROUNDS: usize = 200;
    let mut line = fit(points, |_| 1.0);
    for _ in 0..ROUNDS {
        let next = fit(points, |[x, y]| {
            let left = (y - line[0] - line[1] * x).abs();
            if left <= OUTLIER_S { 1.0 } else { OUTLIER_S / left }
        });
        let moved = points.iter().map(|[x, _]| (next[0] - line[0] + (next[1] - line[1]) * x).abs()).fold(0.0, f64::max);
        line = next;
        if moved <= 1e-12 {
            break;
        }
    }
    line
}

/// The weighted least-squares line; flat where the points have one x only.
fn fit(points: &[[f64; 2]], weight: impl Fn([f64; 2]) -> f64) -> Line {
    let mut sums = [0.0; 3];
    for &point in points {
        let w = weight(point);
        sums = [sums[0] + w, sums[1] + w * point[0], sums[2] + w * point[1]];
    }
    let (x0, y0) = (sums[1] / sums[0], sums[2] / sums[0]);
    let (mut xx, mut xy) = (0.0, 0.0);
    for &point in points {
        let w = weight(point);
        xx += w * (point[0] - x0) * (point[0] - x0);
        xy += w * (point[0] - x0) * (point[1] - y0);
    }
    let slope = if xx > 0.0 { xy / xx } else { 0.0 };
    [y0 - slope * x0, slope]
}
