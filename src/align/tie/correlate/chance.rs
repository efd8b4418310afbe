//! How much chance explains: channels of the same kind that have nothing to do with the video.
//!
//! Two kinds: the channels with the phases of their spectrum redrawn, the same for all of them (J. Theiler et al.
//! 1992, doi:10.1016/0167-2789(92)90102-S), and the channels cut into pieces that are put together in another order,
//! each of them backwards, which keeps bursts and rests. The greatest gains over all lags and models follow Gumbel's
//! distribution.

use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use rustfft::FftPlanner;
use rustfft::num_complex::Complex;

/// Of each kind.
const DRAWN: u64 = 24;
/// So many first; where chance does as well with this probability by these alone, no more are drawn.
const FIRST: u64 = 8;
const PLAIN: f64 = 0.1;
/// Pieces that signals are cut into.
const PIECES: usize = 9;

/// Makes surrogate signals.
type Draw = fn(&[Vec<f64>], &mut ChaCha8Rng) -> Vec<Vec<f64>>;

/// How probably chance gains at least `gain` somewhere; the greater of what the two kinds of channels tell. `greatest`
/// is the greatest gain of given channels over all lags.
pub(super) fn probability(
    channels: &[Vec<f64>],
    greatest: &(dyn Fn(&[Vec<f64>]) -> f64 + Sync),
    gain: f64,
    seed: u64,
) -> f64 {
    let kinds: [Draw; 2] = [other_phases, other_order];
    let of_kind = |(stream, draw): (usize, &Draw)| {
        let draws = |range: std::ops::Range<u64>| -> Vec<f64> {
            let one = |k| {
                let mut rng = ChaCha8Rng::seed_from_u64(seed);
                rng.set_stream(2 * k + stream as u64);
                greatest(&draw(channels, &mut rng))
            };
            range.into_par_iter().map(one).collect()
        };
        let mut best = draws(0..FIRST);
        if beyond(&best, gain) < PLAIN {
            best.extend(draws(FIRST..DRAWN));
        }
        beyond(&best, gain)
    };
    kinds.iter().enumerate().map(of_kind).fold(0.0, f64::max)
}

/// The probability of at least `value` under Gumbel's distribution of the mean and the variance of `drawn`.
fn beyond(drawn: &[f64], value: f64) -> f64 {
    let n = drawn.len() as f64;
    let mean = drawn.iter().sum::<f64>() / n;
    let variance = drawn.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (n - 1.0);
    let scale = variance.sqrt() * 6f64.sqrt() / std::f64::consts::PI;
    const EULER: f64 = 0.577_215_664_901_532_9;
    let place = mean - EULER * scale;
    if scale <= 0.0 {
        return if value > mean { 0.0 } else { 1.0 };
    }
    -(-(-(value - place) / scale).exp()).exp_m1()
}

fn other_phases(signals: &[Vec<f64>], rng: &mut ChaCha8Rng) -> Vec<Vec<f64>> {
    let n = signals[0].len();
    let mut planner = FftPlanner::new();
    let (forward, inverse) = (planner.plan_fft_forward(n), planner.plan_fft_inverse(n));
    let turns: Vec<Complex<f64>> =
        (0..n.div_ceil(2)).map(|_| Complex::from_polar(1.0, rng.random_range(0.0..std::f64::consts::TAU))).collect();
    let draw = |signal: &Vec<f64>| {
        let mut sequence: Vec<Complex<f64>> = signal.iter().copied().map(Complex::from).collect();
        forward.process(&mut sequence);
        for k in 1..n.div_ceil(2) {
            sequence[k] *= turns[k];
            sequence[n - k] = sequence[k].conj();
        }
        inverse.process(&mut sequence);
        sequence.iter().map(|c| c.re / n as f64).collect()
    };
    signals.iter().map(draw).collect()
}

fn other_order(signals: &[Vec<f64>], rng: &mut ChaCha8Rng) -> Vec<Vec<f64>> {
    let n = signals[0].len();
    // The first cut is anywhere.
    let begin = rng.random_range(0..n);
    let mut pieces: Vec<usize> = (0..PIECES).collect();
    pieces.shuffle(rng);
    let draw = |signal: &Vec<f64>| {
        let mut drawn = Vec::with_capacity(n);
        for &piece in &pieces {
            let (from, to) = (piece * n / PIECES, (piece + 1) * n / PIECES);
            drawn.extend((from..to).rev().map(|k| signal[(k + begin) % n]));
        }
        drawn
    };
    signals.iter().map(draw).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drawn_signals_keep_their_size() {
        for n in [60, 61] {
            let signals = vec![(0..n).map(|k| ((k * 37 % 101) as f64).sin()).collect::<Vec<f64>>()];
            let square = |v: &[f64]| v.iter().map(|v| v * v).sum::<f64>();
            let mut rng = ChaCha8Rng::seed_from_u64(1);
            for drawn in [other_phases(&signals, &mut rng), other_order(&signals, &mut rng)] {
                assert_eq!(drawn[0].len(), n);
                assert!((square(&drawn[0]) - square(&signals[0])).abs() <= 1e-9 && drawn != signals);
            }
        }
    }

    #[test]
    fn far_beyond_what_was_drawn_is_improbable() {
        let drawn: Vec<f64> = (0..24).map(|k| 10.0 + f64::from(k % 6)).collect();
        assert!(beyond(&drawn, 12.0) > 0.3 && beyond(&drawn, 25.0) < 1e-2 && beyond(&drawn, 60.0) < 1e-9);
    }
}
