//! The model's parameters from recorded photodiodes (section 4.3.4).
//!
//! In: [`Recording`]s over time (Fig. 80, 82) or in equilibrium (Fig. 79, 81), the [`Parameters`] to start from, and
//! which of them are [`Free`] within which bounds. Out: a [`FitResult`] with values, standard errors, correlations, and
//! what the data don't determine.
//!
//! Least squares by Levenberg's and Marquardt's method within bounds, in the logarithms of what can't be negative, with
//! the exact derivatives of the simulated voltages. The thesis tunes stiffness and damping "within an order of
//! magnitude" for all subjects and calibrates offset and scaling to each; so offsets and scalings belong to a subject
//! here ([`Calibration`]), and are solved for at every point. Parameters at which a vessel closes are refused, and the
//! step towards them is shortened.
//!
//! The noise is white, and over time also slow or a pulse where the residuals of a fit in white noise show it
//! ([`FitResult::noises`]): residuals and derivatives are then whitened and fitted again, so that errors and intervals
//! hold ([`noise`]; measured in `tests/fit/noise.rs`). Same input, same bytes.

mod algebra;
mod certainty;
mod fault;
mod free;
pub mod noise;
mod options;
mod problem;
mod recording;
mod response;
mod result;
mod time_constant;

pub use crate::fit::algebra::levenberg::Stop;
pub use certainty::beside::{Beside, Part as BesidePart};
pub use certainty::delay::Delay;
pub use fault::FitFault;
pub use free::{Bounds, Free};
pub use options::{Calibration, FitOptions};
pub use recording::{Course, Recording, Trace};
pub use result::{Bound, Calibrated, Combination, Estimate, FitResult, FitStatistics, Group, Rival};
pub use time_constant::time_constant;

use crate::fit::algebra::levenberg::{Minimum, Point, Search};
use certainty::certainty;
use problem::{Evaluation, Problem};

use crate::parameters::{Parameters, Symbol};

/// Fits what is free to recordings.
///
/// # Errors
/// What can't be fitted to or is requested wrongly, and parameters to start from at which the model has no response.
pub fn fit(
    recordings: &[Recording],
    start: &Parameters,
    free: &[Free],
    options: &FitOptions,
) -> Result<FitResult, FitFault> {
    let mut problem = Problem::new(recordings, start, free, options)?;
    let (mut found, starts_refused) = search(&mut problem)?;
    let starts = found.len() as u64 + starts_refused;
    whiten(&mut problem, &mut found);
    let others = found.split_off(1);
    let found = &found[0];
    let best = &found.point;
    let mut known = certainty(&problem, found);
    if options.intervals {
        certainty::profile::intervals(&mut problem, best, &mut known);
    }
    let (mut parameters, diodes) = (best.parameters.clone(), &known.result.photodiodes);
    for diode in diodes {
        if diodes.iter().filter(|other| other.unit == diode.unit).count() == 1 {
            for (symbol, estimate) in
                [(Symbol::Offset(diode.unit), diode.offset), (Symbol::Scaling(diode.unit), diode.scaling)]
            {
                parameters = parameters.set(symbol, estimate.value).unwrap_or(parameters);
            }
        }
    }
    Ok(FitResult {
        rivals: rivals(&problem, best, &others, known.noise_sd_v),
        parameters,
        statistics: FitStatistics {
            starts,
            starts_refused,
            iterations: found.iterations as u64,
            points: problem.points,
            refused: problem.refused,
            simulations: problem.responder.simulations,
            steps: problem.responder.steps,
        },
        ..known.result
    })
}

/// The minima found from all starts, the best one first, and how many starts had no response.
fn search(problem: &mut Problem) -> Result<(Vec<Minimum<Evaluation>>, u64), FitFault> {
    let [lower, upper] = bounds(problem);
    let settings = settings(problem, &lower, &upper);
    let mut all: Vec<Minimum<Evaluation>> = vec![];
    let (mut refused, mut seen): (u64, Vec<bool>) = (0, vec![]);
    for number in 0..starts(&lower, &upper, problem.options.starts) {
        let mut from = spread(number, &lower, &upper);
        for (at, _) in from.iter_mut().zip(&seen).filter(|(_, seen)| !**seen) {
            *at = 0.0;
        }
        match problem.evaluate(&from) {
            Ok(first) => {
                if number == 0 {
                    // What the photodiodes don't see stays where it starts.
                    seen =
                        first.columns().iter().map(|column| algebra::qr::norm(column) > UNSEEN * first.raw).collect();
                }
                let short = if number == 0 { settings.most_points } else { SHORT.min(settings.most_points) };
                let mut found = Search { most_points: short, ..settings }.run(first, |at| problem.evaluate(at).ok());
                // Only what comes near the best is followed to its end.
                let best = all.iter().map(|found| squares(&found.point)).fold(f64::INFINITY, f64::min);
                if number > 0 && found.stop == Stop::Points && squares(&found.point) < 2.0 * best {
                    found = settings.run(found.point, |at| problem.evaluate(at).ok());
                }
                all.push(found);
            }
            Err((recording, why)) if number == 0 => return Err(FitFault::Start { recording: recording + 1, why }),
            Err(_) => refused += 1,
        }
    }
    // The sort is stable: of equal ones the earlier start counts.
    all.sort_by(|a, b| squares(&a.point).total_cmp(&squares(&b.point)));
    Ok((all, refused))
}

/// How often the noise is estimated.
const ROUNDS: usize = 3;

/// Goes on from the minima found to those in the noise about the best one.
fn whiten(problem: &mut Problem, found: &mut Vec<Minimum<Evaluation>>) {
    for _ in 0..ROUNDS {
        if !certainty::noise::estimate(problem, &found[0].point) {
            return;
        }
        let [lower, upper] = bounds(problem);
        let settings = settings(problem, &lower, &upper);
        let least = squares(&found[0].point);
        let mut again: Vec<Minimum<Evaluation>> = vec![];
        for (k, old) in found.iter().enumerate().filter(|(_, old)| squares(&old.point) <= 2.0 * least) {
            let at = old.point.at();
            if found[..k].iter().any(|other| are_same(other.point.at(), at)) {
                continue;
            }
            let Ok(first) = problem.evaluate(at) else { continue };
            let new = settings.run(first, |at| problem.evaluate(at).ok());
            again.push(Minimum { iterations: old.iterations + new.iterations, ..new });
        }
        if again.is_empty() {
            // The points found are in white noise.
            problem.channels.iter_mut().for_each(|channel| (channel.slow, channel.whitening) = (None, None));
            return;
        }
        again.sort_by(|a, b| squares(&a.point).total_cmp(&squares(&b.point)));
        *found = again;
    }
}

fn bounds(problem: &Problem) -> [Vec<f64>; 2] {
    [
        problem.coordinates.iter().map(|coordinate| coordinate.lower).collect(),
        problem.coordinates.iter().map(|coordinate| coordinate.upper).collect(),
    ]
}

fn settings<'a>(problem: &Problem, lower: &'a [f64], upper: &'a [f64]) -> Search<'a> {
    let unknowns = lower.len() + 2 * problem.diodes.len();
    Search {
        lower,
        upper,
        tolerance: problem.options.tolerance,
        freedom: problem.target.len().saturating_sub(unknowns).max(1) as f64,
        data: algebra::qr::norm(&problem.target),
        most_points: problem.options.most_points,
    }
}

/// The points that a start besides the first has to come near the best.
const SHORT: usize = 10;
/// Of the largest column, a column that moves next to nothing.
const UNSEEN: f64 = 1e-6;

/// One start is enough where there is nothing to spread over.
fn starts(lower: &[f64], upper: &[f64], requested: usize) -> usize {
    if lower.iter().zip(upper).any(|(low, high)| (high - low).is_finite()) { requested } else { 1 }
}

fn squares(point: &Evaluation) -> f64 {
    algebra::qr::dot(point.residuals(), point.residuals())
}

/// A rise of the sum of squares over the variance from which on a minimum is no rival: three standard errors.
const NO_RIVAL: f64 = 9.0;
/// Coordinates nearer than this are the same minimum.
const SAME: f64 = 0.02;

fn are_same(one: &[f64], other: &[f64]) -> bool {
    one.iter().zip(other).all(|(a, b)| (a - b).abs() <= SAME)
}

/// Of other minima those that fit nearly as well.
fn rivals(problem: &Problem, best: &Evaluation, others: &[Minimum<Evaluation>], sd: f64) -> Vec<Rival> {
    let mut kept: Vec<&Evaluation> = vec![best];
    let mut rivals = vec![];
    for other in others.iter().filter(|found| found.stop != Stop::Points).map(|found| &found.point) {
        let near = |one: &&Evaluation| are_same(one.at(), other.at());
        let rise = (squares(other) - squares(best)) / (sd * sd);
        if rise < NO_RIVAL && !kept.iter().any(near) {
            kept.push(other);
            let values = problem.coordinates.iter().zip(other.at()).map(|(coordinate, &at)| coordinate.values(at));
            rivals.push(Rival { values: values.collect(), rise });
        }
    }
    rivals
}

/// The start of a number: the first at 0, the others spread over the bounds by Halton's sequence.
fn spread(number: usize, lower: &[f64], upper: &[f64]) -> Vec<f64> {
    let mut base = 1;
    lower
        .iter()
        .zip(upper)
        .map(|(low, high)| {
            base = next_prime(base);
            if number == 0 || !(high - low).is_finite() { 0.0 } else { low + (high - low) * halton(number, base) }
        })
        .collect()
}

fn halton(mut number: usize, base: usize) -> f64 {
    let (mut value, mut part) = (0.0, 1.0);
    while number > 0 {
        part /= base as f64;
        value += part * (number % base) as f64;
        number /= base;
    }
    value
}

fn next_prime(after: usize) -> usize {
    (after + 1..).find(|n| (2..*n).all(|d| n % d != 0)).unwrap_or(after)
}
