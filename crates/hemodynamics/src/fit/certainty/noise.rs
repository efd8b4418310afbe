//! The noise of each channel over time, estimated from what a fit leaves.
//!
//! In: a fitted point. Out: for each channel the slow noise of the highest restricted likelihood, which knows that the
//! fit bends along with it, and by what its rows become white and as large as before: that the noise of a channel is
//! larger than another's is for [`Trace::noise_v`](crate::Trace::noise_v) to say. A channel in equilibrium or
//! of few samples stays as it is: its noise is taken as white.
//!
//! Photodiodes on one nail see the same pulse and waves. Channels are whitened one by one; those of a recording whose
//! slow parts go together count for less, in the worst case (all alike) as one of them. A channel with slow noise
//! counts for less by itself too, as blood's waves are not quite of the shapes that are known ([`OF_OTHER_SHAPE`]).

use crate::fit::algebra::levenberg::Point;
use crate::fit::algebra::qr::{dot, norm, triangle};
use crate::fit::noise::{Noise, Slow};
use crate::fit::problem::{Channel, Evaluation, Problem, Whitening};

/// Values beyond the unknowns of a channel from which on its noise is estimated (assumed).
const LEAST: usize = 30;
/// Of the data's norm, residuals that are rounding.
const ROUNDING: f64 = 1e-9;
/// Of a column's norm, what is left of it when it has no direction of its own.
const DEPENDENT: f64 = 1e-6;

/// Least factor of the variance of a channel with slow noise. Without it two standard errors of a distal photodiode
/// alone held k in 60 to 71 of 100, where the white noise was 0.1 % of the step or less (`tests/fit/noise.rs`: a pulse
/// has harmonics).
const OF_OTHER_SHAPE: f64 = 3.0;

/// Sets the noise of all channels as it is likeliest about a point; whether it is another one than before.
pub(in crate::fit) fn estimate(problem: &mut Problem, best: &Evaluation) -> bool {
    if norm(&best.misses) <= ROUNDING * norm(&problem.target) {
        return false;
    }
    let before: Vec<Option<Whitening>> = problem.channels.iter_mut().map(|channel| channel.whitening.take()).collect();
    let likely: Vec<Option<Likely>> = match problem.evaluate(best.at()) {
        Ok(white) => problem.channels.iter().map(|channel| Likely::of(problem, channel, &white)).collect(),
        Err(_) => vec![],
    };
    let slow = |likely: &Option<Likely>| likely.as_ref().map(|likely| likely.slow);
    if likely.iter().zip(&problem.channels).all(|(likely, channel)| slow(likely) == channel.slow) {
        problem.channels.iter_mut().zip(before).for_each(|(channel, before)| channel.whitening = before);
        return false;
    }
    problem.channels.iter_mut().zip(&likely).for_each(|(channel, likely)| channel.slow = slow(likely));
    if problem.channels.iter().all(|channel| channel.slow.is_none_or(|slow| slow == Slow::NONE)) {
        return before.iter().any(Option::is_some);
    }
    let shared: Vec<f64> = (0..likely.len()).map(|k| shared(&problem.channels, &likely, k)).collect();
    for ((channel, likely), shared) in problem.channels.iter_mut().zip(likely).zip(shared) {
        let slow = likely.filter(|likely| likely.slow != Slow::NONE);
        channel.whitening =
            slow.map(|Likely { noise, white, .. }| Whitening { noise, size: white * shared.sqrt(), shared });
    }
    true
}

/// The noise of a channel.
struct Likely {
    slow: Slow,
    noise: Noise,
    /// SD of the white noise, of that of the residuals.
    white: f64,
    /// The slow part as it is known at each sample.
    levels: Vec<f64>,
}

impl Likely {
    fn of(problem: &Problem, channel: &Channel, about: &Evaluation) -> Option<Likely> {
        let time_s = problem.times_s(channel)?;
        let rows = channel.rows.clone();
        let mut columns: Vec<Vec<f64>> = about.columns().iter().map(|column| column[rows.clone()].to_vec()).collect();
        if !about.fitted.is_empty() {
            columns.extend([vec![1.0; rows.len()], about.signals[rows.clone()].to_vec()]);
        }
        let (basis, residuals) = (independent(columns), &about.residuals()[rows.clone()]);
        let free = rows.len().checked_sub(basis.len()).filter(|free| *free >= LEAST)? as f64;
        // Twice the logarithm of the likelihood, and the sum of the whitened squares.
        let likelihood = |slow: Slow| {
            let noise = Noise::new(&time_s, slow);
            let (mut columns, mut target) = (basis.clone(), residuals.to_vec());
            columns.iter_mut().chain([&mut target]).for_each(|rows| noise.whiten(rows));
            let triangle = triangle(&mut columns, &mut target);
            let left = &target[basis.len()..];
            let squares = dot(left, left);
            let ln_det: f64 = (0..basis.len()).map(|k| 2.0 * triangle[k * (basis.len() + 1)].abs().ln()).sum();
            (-free * squares.ln() - noise.ln_det - ln_det, squares)
        };
        let slow = Slow::likeliest(|slow| likelihood(slow).0).enlarged();
        let (_, squares) = likelihood(slow);
        let noise = Noise::new(&time_s, slow);
        let misses = &about.misses[rows];
        let white = (squares / free * misses.len() as f64).sqrt() / norm(misses);
        let levels = noise.levels(misses);
        (squares > 0.0 && white.is_finite()).then_some(Likely { slow, noise, white, levels })
    }
}

/// An orthonormal basis of what some columns span.
fn independent(columns: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let mut basis: Vec<Vec<f64>> = vec![];
    for mut column in columns {
        let whole = norm(&column);
        // Twice: what is left of a nearly dependent one keeps its digits.
        for one in basis.iter().chain(&basis) {
            let along = dot(one, &column);
            column.iter_mut().zip(one).for_each(|(value, one)| *value -= along * one);
        }
        let left = norm(&column);
        if left > DEPENDENT * whole {
            column.iter_mut().for_each(|value| *value /= left);
            basis.push(column);
        }
    }
    basis
}

/// By how much the slow noise of a recording's channels enlarges the variance as it is the same noise: the largest sum
/// of a channel's correlations, which the largest eigenvalue does not exceed; at least [`OF_OTHER_SHAPE`] times that
/// with those of its unit, which see the same signal too.
fn shared(channels: &[Channel], likely: &[Option<Likely>], of: usize) -> f64 {
    let mates: Vec<(&Channel, &Likely)> = channels
        .iter()
        .zip(likely)
        .filter(|(channel, _)| channel.recording == channels[of].recording)
        .filter_map(|(channel, likely)| Some((channel, likely.as_ref().filter(|likely| likely.slow != Slow::NONE)?)))
        .collect();
    let of_one = |one: &(&Channel, &Likely)| {
        let [mut of_all, mut of_unit] = [0.0; 2];
        for other in &mates {
            let shared = correlation(*one, *other);
            of_all += shared;
            of_unit += if other.0.unit == one.0.unit { shared } else { 0.0 };
        }
        of_all.max(OF_OTHER_SHAPE * of_unit)
    };
    mates.iter().map(of_one).fold(1.0, f64::max)
}

/// How far the slow parts of two channels go together, either way; wholly where no sample has both.
fn correlation(a: (&Channel, &Likely), b: (&Channel, &Likely)) -> f64 {
    let [mut of_a, mut of_b, mut of_both] = [0.0; 3];
    let mut theirs = b.0.samples.iter().zip(&b.1.levels).peekable();
    for (sample, x) in a.0.samples.iter().zip(&a.1.levels) {
        while theirs.next_if(|(other, _)| *other < sample).is_some() {}
        if let Some((_, y)) = theirs.next_if(|(other, _)| *other == sample) {
            (of_a, of_b, of_both) = (of_a + x * x, of_b + y * y, of_both + x * y);
        }
    }
    let scale = (of_a * of_b).sqrt();
    if scale > 0.0 { (of_both.abs() / scale).min(1.0) } else { 1.0 }
}
