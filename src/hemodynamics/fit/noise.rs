//! How noisy each photodiode of each subject is: what is noisier counts less in the fit.
//!
//! A noise that is not given is estimated: a fit with all alike, the SD of each photodiode's residuals (the unknowns
//! taken from its values in proportion), a new fit with these as weights, until they stay. A step with noise 1 % of
//! each photodiode's range: two standard errors hold `k_C` and `b_C` in 39 and 37 of 40 cases, with equal weights in 32
//! and 32.

use lunula_hemodynamics::Calibration;

use super::recording::ReadRecording;
use super::{FitInputs, FitOptions};

/// The fit is repeated at most so often.
pub(super) const MOST_ROUNDS: usize = 3;
/// A ratio of noises that changes by less than this part is settled.
const SETTLED: f64 = 0.1;
/// Of a photodiode's range, residuals below this part are those of the simulation and of rounding, not noise.
const NO_NOISE: f64 = 1e-4;

/// Noises of all traces, V: of each recording, a photodiode each.
pub(super) type Noises = Vec<Vec<f64>>;

/// Subject and photodiode, sum of squares, values, and least and largest voltage.
type Misses<'a> = ((&'a str, &'a str), f64, usize, [f64; 2]);

fn given(options: &FitOptions, name: &str) -> Option<f64> {
    options.noise.iter().find(|(own, _)| own == name).map(|own| own.1)
}

/// What a fit begins with: what is given; all others are as noisy as the noisiest of these.
pub(super) fn begin(options: &FitOptions, recordings: &mut [ReadRecording]) {
    let most = options.noise.iter().map(|one| one.1).fold(0.0, f64::max);
    let other = if most > 0.0 { most } else { 1.0 };
    for read in recordings {
        for (name, trace) in read.photodiodes.iter().zip(&mut read.recording.photodiodes) {
            trace.noise_v = given(options, name).unwrap_or(other);
        }
    }
}

/// The noises by the residuals; those that are given stay.
pub(super) fn estimated(
    inputs: &FitInputs,
    options: &FitOptions,
    recordings: &[ReadRecording],
    curves: &[Vec<Vec<f64>>],
) -> Noises {
    let mut all: Vec<Misses> = Vec::new();
    for (k, (read, curves)) in recordings.iter().zip(curves).enumerate() {
        for ((name, trace), fitted) in read.photodiodes.iter().zip(&read.recording.photodiodes).zip(curves) {
            let key = (inputs.subject(k), name.as_str());
            let at = all.iter().position(|one| one.0 == key).unwrap_or_else(|| {
                all.push((key, 0.0, 0, [f64::INFINITY, f64::NEG_INFINITY]));
                all.len() - 1
            });
            let one = &mut all[at];
            for (measured, fitted) in trace.voltages_v.iter().zip(fitted) {
                let miss = measured - fitted;
                if miss.is_finite() {
                    one.1 += miss * miss;
                    one.2 += 1;
                    one.3 = [one.3[0].min(*measured), one.3[1].max(*measured)];
                }
            }
        }
    }
    let values: usize = all.iter().map(|one| one.2).sum();
    let own = if options.calibrate == Calibration::Fixed { 0.0 } else { 2.0 };
    let sd = |sum: f64, count: usize| {
        let share = own + options.free().len() as f64 * count as f64 / values.max(1) as f64;
        (sum / (count as f64 - share).max(1.0)).sqrt()
    };
    let noises: Vec<f64> = all
        .iter()
        .map(|(_, sum, count, [least, most])| sd(*sum, *count).max(NO_NOISE * (most - least).max(0.0)))
        .collect();
    // A photodiode that stays the same says nothing, whatever its weight.
    let most = noises.iter().copied().fold(0.0, f64::max);
    let of = |key: (&str, &str)| {
        let noise = all.iter().position(|one| one.0 == key).map_or(0.0, |at| noises[at]);
        match (noise > NO_NOISE * most, most > 0.0) {
            (true, _) => noise,
            (false, true) => most,
            (false, false) => 1.0,
        }
    };
    let one = |(k, read): (usize, &ReadRecording)| {
        let of = |name: &String| given(options, name).unwrap_or_else(|| of((inputs.subject(k), name)));
        read.photodiodes.iter().map(of).collect()
    };
    recordings.iter().enumerate().map(one).collect()
}

/// Sets the noises; whether their ratios changed by so much that the fit has to be repeated.
pub(super) fn set(recordings: &mut [ReadRecording], noises: &Noises) -> bool {
    let mut changes = [f64::INFINITY, f64::NEG_INFINITY];
    for (read, noises) in recordings.iter_mut().zip(noises) {
        for (trace, &noise_v) in read.recording.photodiodes.iter_mut().zip(noises) {
            let change = noise_v / trace.noise_v;
            changes = [changes[0].min(change), changes[1].max(change)];
            trace.noise_v = noise_v;
        }
    }
    changes[1] > (1.0 + SETTLED) * changes[0]
}
