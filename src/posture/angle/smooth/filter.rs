//! The Kalman filter forwards and the smoother backwards, over the known rows of one series.
//!
//! State: the angle, its first and second derivative, and the correlated part of the error in its own standard
//! deviations. Values come in medians of the standard errors, times in medians of the time between rows.
//!
//! A row whose prediction makes it less likely than an error anywhere on the circle, met once in [`WILD`] rows, is left
//! out. Where several in a row would be, it was the filter that was wrong, so it starts again; so it does when, after a
//! long gap, it knows no more than half a turn.

use nalgebra::{Matrix4, RowVector4, Vector4};

/// A known row.
#[derive(Debug, Clone, Copy)]
pub(super) struct Observation {
    pub(super) time: f64,
    pub(super) value: f64,
    pub(super) sd: f64,
}

/// What the series is like.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Parameters {
    /// Spectral density of the third derivative.
    pub(super) jerk: f64,
    /// Of the correlated part of the errors of rows at a distance of 1.
    pub(super) correlation: f64,
    /// Of the errors' variance that is correlated.
    pub(super) share: f64,
    /// Errors over given standard errors.
    pub(super) scale: f64,
}

/// One row in how many is no measurement of the angle.
const WILD: f64 = 1000.0;
/// So many rows after each other are not all wild.
const NEW_START: usize = 5;
/// So many rows tell the angle and both derivatives.
const SETTLED: usize = 3;

/// A row on the way forwards: before its observation.
struct Passed {
    state: Vector4<f64>,
    spread: Matrix4<f64>,
    /// Rows from here on know nothing of the rows before.
    starts: bool,
    used: bool,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Row {
    pub(super) value: f64,
    pub(super) sd: f64,
    /// No motion explains what was measured: only the neighbours speak.
    pub(super) left_out: bool,
}

/// -2 ln of the likelihood of a series.
pub(super) fn deviance(series: &[Observation], parameters: &Parameters, half_turn: f64) -> f64 {
    forwards(series, parameters, half_turn, |_, _| {})
}

pub(super) fn smooth(series: &[Observation], parameters: &Parameters, half_turn: f64) -> Vec<Row> {
    let mut passed: Vec<Passed> = Vec::with_capacity(series.len());
    forwards(series, parameters, half_turn, |at, row| {
        passed.truncate(at);
        passed.push(row);
    });
    let mut rows = vec![Row { value: 0.0, sd: 0.0, left_out: false }; series.len()];
    // Bierman's adjoint: what the rows from here on say, as gradient and information.
    let (mut gradient, mut information) = (Vector4::zeros(), Matrix4::zeros());
    for at in (0..series.len()).rev() {
        let (row, seen) = (&passed[at], &series[at]);
        if row.used {
            let (look, noise) = parameters.look(seen);
            let variance = (look * row.spread * look.transpose())[0] + noise;
            let gain = row.spread * look.transpose() / variance;
            let rest = Matrix4::identity() - gain * look;
            let surprise = seen.value - (look * row.state)[0];
            gradient = rest.transpose() * gradient - look.transpose() * (surprise / variance);
            information = rest.transpose() * information * rest + look.transpose() * look / variance;
        }
        let by_angle = row.spread.column(0).into_owned();
        let variance = row.spread[(0, 0)] - by_angle.dot(&(information * by_angle));
        let value = row.state[0] - by_angle.dot(&gradient);
        rows[at] = Row { value, sd: variance.max(0.0).sqrt(), left_out: !row.used };
        if row.starts {
            (gradient, information) = (Vector4::zeros(), Matrix4::zeros());
        } else {
            let step = parameters.step(seen.time - series[at - 1].time).0;
            gradient = step.transpose() * gradient;
            information = step.transpose() * information * step;
        }
    }
    rows
}

/// Runs the filter and shows each row with its place; a place may be shown again, and then all after it are too.
fn forwards(
    series: &[Observation],
    parameters: &Parameters,
    half_turn: f64,
    mut show: impl FnMut(usize, Passed),
) -> f64 {
    let wild = 2.0 * (2.0 * half_turn * WILD).ln();
    let (mut state, mut spread) = start(&series[0], half_turn);
    let mut starts = true;
    // Rows used since the start, and rows left out since the last that was used.
    let (mut used_rows, mut out_of_line) = (0, 0);
    let mut deviance = 0.0;
    let mut at = 0;
    while at < series.len() {
        let seen = &series[at];
        if at > 0 && !starts {
            let (step, noise) = parameters.step(seen.time - series[at - 1].time);
            state = step * state;
            spread = step * spread * step.transpose() + noise;
            if used_rows >= SETTLED && spread[(0, 0)] > half_turn * half_turn {
                (state, spread) = start(seen, half_turn);
                (starts, used_rows) = (true, 0);
            }
        }
        let (look, noise) = parameters.look(seen);
        let variance = (look * spread * look.transpose())[0] + noise;
        let surprise = seen.value - (look * state)[0];
        let tame = surprise * surprise / variance + (std::f64::consts::TAU * variance).ln();
        let used = tame < wild || starts;
        deviance += if used { tame } else { wild };
        show(at, Passed { state, spread, starts, used });
        starts = false;
        if used {
            (used_rows, out_of_line) = (used_rows + 1, 0);
            let gain = spread * look.transpose() / variance;
            state += gain * surprise;
            // Joseph's form keeps the spread symmetric and positive.
            let rest = Matrix4::identity() - gain * look;
            spread = rest * spread * rest.transpose() + gain * noise * gain.transpose();
        } else {
            out_of_line += 1;
            if out_of_line == NEW_START {
                at -= NEW_START - 1;
                (state, spread) = start(&series[at], half_turn);
                (starts, used_rows, out_of_line) = (true, 0, 0);
                continue;
            }
        }
        at += 1;
    }
    deviance
}

/// Nothing known but that the angle is about half a turn around its first value, and moves about a quarter of that a
/// row.
fn start(first: &Observation, half_turn: f64) -> (Vector4<f64>, Matrix4<f64>) {
    let wide = half_turn * half_turn;
    let moves = wide / 16.0;
    (Vector4::new(first.value, 0.0, 0.0, 0.0), Matrix4::from_diagonal(&Vector4::new(wide, moves, moves, 1.0)))
}

impl Parameters {
    /// How an observation looks at the state, and the variance of its white error.
    fn look(&self, seen: &Observation) -> (RowVector4<f64>, f64) {
        let sd = self.scale * seen.sd;
        (RowVector4::new(1.0, 0.0, 0.0, sd * self.share.sqrt()), sd * sd * (1.0 - self.share))
    }

    /// What `t` does to the state, and what it adds to its spread.
    fn step(&self, t: f64) -> (Matrix4<f64>, Matrix4<f64>) {
        let t = t.max(0.0);
        let kept = self.correlation.powf(t);
        #[rustfmt::skip]
        let step = Matrix4::new(
            1.0, t, 0.5 * t * t, 0.0,
            0.0, 1.0, t, 0.0,
            0.0, 0.0, 1.0, 0.0,
            0.0, 0.0, 0.0, kept,
        );
        let q = self.jerk * t;
        let [a, b, c, d, e] = [t.powi(4) / 20.0, t.powi(3) / 8.0, t * t / 6.0, t * t / 3.0, t / 2.0];
        #[rustfmt::skip]
        let noise = Matrix4::new(
            q * a, q * b, q * c, 0.0,
            q * b, q * d, q * e, 0.0,
            q * c, q * e, q, 0.0,
            0.0, 0.0, 0.0, 1.0 - kept * kept,
        );
        (step, noise)
    }
}
