//! Whether photodiodes and loads are on one clock.
//!
//! The model begins in equilibrium and knows no time of its own, so loads that are stamped late move its whole response
//! by as much: the voltages' derivative by a delay is minus their slope. What the parameters can't take up of it is
//! looked for in the residuals. Delays beyond the response's time constants leave none of it there: the fitted response
//! itself is shifted then, offsets and scalings following.
//!
//! Measured (`tests/fit/clock.rs`): loads 40 ms late give ten times the stiffness, at R2 of 0.98 to 0.99.

use crate::fit::algebra::levenberg::Point;
use crate::fit::algebra::qr::{dot, norm, triangle};
use crate::fit::problem::{Channel, Evaluation, Problem};

/// Of a slope's norm, what is left of it when the parameters do the same as a delay.
const DEPENDENT: f64 = 1e-6;

/// Shifts of a response that are tried: so many to either side, so far apart, s, up to this share of a recording.
const SHIFTS: i32 = 40;
const APART_S: f64 = 0.05;
const SHARE: f64 = 0.25;
/// Fewer samples have no shift.
const FEWEST: usize = 10;
/// Of the sum of squares, what the best of them leaves at most.
const HALF: f64 = 0.5;

/// Photodiodes of a recording, shifted in time against its loads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Delay {
    /// The photodiodes answer so many seconds after the model; below 0, before it.
    pub by_s: f64,
    /// Its standard error, s, parameters following; half the distance of the shifts that were tried, where it is one.
    pub standard_error_s: f64,
    /// The share of the sum of squares that it explains.
    pub share: f64,
}

impl Delay {
    /// Whether it is none of the noise: three standard errors, and 15 ms. Of 300 recordings on one clock, with pulse
    /// and waves and parameters of another finger, none is (10 ms at most).
    #[must_use]
    pub fn is_clear(&self) -> bool {
        self.by_s.abs() > (3.0 * self.standard_error_s).max(0.015)
    }
}

/// The delay of each recording, parameters following; `None` in equilibrium, or where the response does not change, or
/// only as parameters change it.
pub(in crate::fit) fn delays(problem: &Problem, best: &Evaluation, inside: &[usize], sd_v: f64) -> Vec<Option<Delay>> {
    let slopes: Vec<Vec<f64>> = (0..problem.recordings()).map(|of| slope(problem, best, of)).collect();
    let slopes = problem.as_columns(best, slopes);
    let squares = dot(best.residuals(), best.residuals());
    let of = |slope: Vec<f64>| {
        let whole = norm(&slope);
        let mut columns: Vec<Vec<f64>> = inside.iter().map(|&q| best.columns()[q].clone()).collect();
        columns.push(slope);
        let (last, mut target) = (columns.len() - 1, best.residuals().to_vec());
        let own = triangle(&mut columns, &mut target)[last * columns.len() + last];
        (own.abs() > DEPENDENT * whole && squares > 0.0).then(|| Delay {
            by_s: target[last] / own,
            standard_error_s: sd_v / own.abs(),
            share: target[last] * target[last] / squares,
        })
    };
    let small = slopes.into_iter().map(of);
    small.enumerate().map(|(recording, small)| large(problem, best, recording).or(small)).collect()
}

/// The shift of a recording's response that leaves far less of its voltages than none does.
fn large(problem: &Problem, best: &Evaluation, of: usize) -> Option<Delay> {
    let channels: Vec<(&Channel, Vec<f64>)> = problem
        .channels
        .iter()
        .filter(|channel| channel.recording == of && channel.rows.len() >= FEWEST)
        .filter_map(|channel| Some((channel, problem.times_s(channel)?)))
        .collect();
    let span_s = channels.iter().filter_map(|(_, times_s)| Some(times_s.last()? - times_s[0])).fold(0.0, f64::max);
    let left = |by_s: f64| -> f64 {
        let of_one = |(channel, times_s): &(&Channel, Vec<f64>)| {
            let rows = channel.rows.clone();
            let (signals, weights) = (&best.signals[rows.clone()], &problem.weights[rows.clone()]);
            let mut moved = at(times_s, signals, by_s);
            moved.iter_mut().zip(weights).for_each(|(value, weight)| *value *= weight);
            let mut target = problem.target[rows].to_vec();
            triangle(&mut [weights.to_vec(), moved], &mut target);
            dot(&target[2..], &target[2..])
        };
        channels.iter().map(of_one).sum()
    };
    let none = left(0.0);
    let shifts = (-SHIFTS..=SHIFTS).map(|k| APART_S * f64::from(k));
    let shifts = shifts.filter(|by_s| by_s.abs() > APART_S && by_s.abs() <= SHARE * span_s);
    let (by_s, least) = shifts.map(|by_s| (by_s, left(by_s))).min_by(|a, b| a.1.total_cmp(&b.1))?;
    let share = 1.0 - least / none;
    (least < HALF * none).then_some(Delay { by_s, standard_error_s: 0.5 * APART_S, share })
}

/// Signals `by_s` later, between samples on a line.
fn at(times_s: &[f64], signals: &[f64], by_s: f64) -> Vec<f64> {
    let mut next = 0;
    let value = |time_s: &f64| {
        let time_s = time_s - by_s;
        while next < times_s.len() && times_s[next] < time_s {
            next += 1;
        }
        match next {
            0 => signals[0],
            _ if next == times_s.len() => signals[next - 1],
            _ => {
                let part = (time_s - times_s[next - 1]) / (times_s[next] - times_s[next - 1]);
                signals[next - 1] + part * (signals[next] - signals[next - 1])
            }
        }
    };
    times_s.iter().map(value).collect()
}

/// Minus the slope of a recording's signals, per second, weighted; 0 in the rows of others.
fn slope(problem: &Problem, best: &Evaluation, of: usize) -> Vec<f64> {
    let mut slope = vec![0.0; problem.target.len()];
    for channel in problem.channels.iter().filter(|channel| channel.recording == of) {
        let Some(times_s) = problem.times_s(channel) else { continue };
        let (rows, last) = (channel.rows.clone(), times_s.len().saturating_sub(1));
        let signals = &best.signals[rows.clone()];
        for (k, row) in rows.enumerate() {
            let (from, to) = (k.saturating_sub(1), (k + 1).min(last));
            let took_s = times_s[to] - times_s[from];
            if took_s > 0.0 {
                slope[row] = -problem.weights[row] * (signals[to] - signals[from]) / took_s;
            }
        }
    }
    slope
}
