//! Errors hold the truth in the pulse (2 % of the step, 0.9 to 1.3 Hz and its double) and slow waves (5 %, 0.1 Hz) of
//! blood, which both photodiodes see at once, as in white noise (1 % or 0.1 %).
//!
//! Both loads press from 1 to 4 s of 16; 400 samples. The fit starts from 0.7 of the true stiffness.

use lunula_hemodynamics::{FitOptions, FitResult, Load, Parameters, Recording, fit};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::phantom::{changed, noisy, seen, tied};

const TAU: f64 = std::f64::consts::TAU;
const TRUTH: [f64; 2] = [1e5, 1e4];

const BOTH: [usize; 2] = [0, 1];

fn pressed(times: &[f64], units: &[usize]) -> Recording {
    let load = || Load::step(5000.0, 1.0, 4.0).expect("a finite load");
    seen(&Parameters::thesis(), times, &load(), &load(), units)
}

fn evenly() -> Vec<f64> {
    (0..400).map(|k| 0.04 * f64::from(k)).collect()
}

/// With white noise, a pulse and waves of a part of each photodiode's swing.
pub(crate) fn beating(recording: &Recording, times: &[f64], [white, pulse, waves]: [f64; 3], seed: u64) -> Recording {
    let mut random = ChaCha8Rng::seed_from_u64(1000 + seed);
    let hz = random.random_range(0.9..1.3);
    let [beat, wave] = [(); 2].map(|()| random.random_range(0.0..TAU));
    let mut noisy = noisy(recording, white, seed);
    for trace in &mut noisy.photodiodes {
        let swing = trace.noise_v / white;
        trace.noise_v = swing * (white.powi(2) + 0.58 * pulse.powi(2) + 0.5 * waves.powi(2)).sqrt();
        for (t, volts) in times.iter().zip(&mut trace.voltages_v) {
            let of_pulse = (TAU * hz * t + beat).sin() + 0.4 * (2.0 * TAU * hz * t + beat).sin();
            *volts += swing * (pulse * of_pulse + waves * (0.1 * TAU * t + wave).sin());
        }
    }
    noisy
}

fn fitted(recordings: &[Recording]) -> FitResult {
    let options = FitOptions { intervals: true, ..FitOptions::default() };
    let start = changed(&[("k_C1_N_per_m", 0.7), ("k_C2_N_per_m", 0.7)]);
    fit(recordings, &start, &tied(), &options).expect("a fit")
}

/// Of so many recordings, how many have k and b within two standard errors, how many within intervals that have an
/// end, and how many have intervals without ends; RMS errors of k and b over the truth.
fn held(parts: [f64; 3], units: &[usize], seeds: u64) -> ([u64; 4], [u64; 2], [f64; 2]) {
    let exact = pressed(&evenly(), units);
    let (mut counts, mut squares, mut without_ends) = ([0; 4], [0.0; 2], [0; 2]);
    for seed in 0..seeds {
        let result = fitted(&[beating(&exact, &evenly(), parts, seed)]);
        for (q, (group, truth)) in result.groups.iter().zip(TRUTH).enumerate() {
            let error = group.standard_errors.as_ref().map_or(f64::NAN, |errors| errors[0]);
            counts[q] += u64::from((group.values[0] - truth).abs() <= 2.0 * error);
            let [low, high] = &group.interval;
            let inside =
                low.as_ref().is_none_or(|low| low[0] <= truth) && high.as_ref().is_none_or(|high| truth <= high[0]);
            let has_end = low.is_some() || high.is_some();
            counts[2 + q] += u64::from(inside && has_end);
            without_ends[q] += u64::from(!has_end);
            squares[q] += (group.values[0] / truth - 1.0).powi(2);
        }
    }
    let rms = squares.map(|sum: f64| (sum / seeds as f64).sqrt());
    println!("{units:?} {parts:?}: k, b within two standard errors, intervals: {counts:?} of {seeds}; RMS {rms:.3?}");
    println!("  intervals without ends: {without_ends:?}");
    (counts, without_ends, rms)
}

/// White, pulse, pulse and waves; the largest RMS error of k that is allowed. Measured, k and b within two standard
/// errors, and within the intervals, of 24: 22, 22, 22, 22; 24 each; 24 each; RMS 0.118, 0.224, 0.272. Where all noise
/// was taken as white: 22 each; 19, 19, 21, 21; 9, 9, 10, 10; RMS 0.115, 0.240, 0.500.
const CASES: [([f64; 3], f64); 3] = [([0.01, 0.0, 0.0], 0.14), ([0.01, 0.02, 0.0], 0.23), ([0.01, 0.02, 0.05], 0.35)];

#[test]
fn errors_hold_the_truth_in_white_noise_a_pulse_and_waves() {
    for (parts, most) in CASES {
        let (counts, _, [rms, _]) = held(parts, &BOTH, 24);
        assert!(counts.iter().all(|count| *count >= 21), "{parts:?}: {counts:?}");
        assert!(rms <= most, "{parts:?}: {rms}");
    }
    // One photodiode with little white noise. Where waves were taken to be of just the shapes that are known: 13 to 16.
    // Four on the same unit see the same waves: as taken for one with just these, 41 of 60.
    for units in [&[1; 1][..], &[1; 4]] {
        let (counts, ..) = held([0.001, 0.02, 0.05], units, 24);
        assert!(counts.iter().all(|count| *count >= 21), "{units:?} {counts:?}");
    }
}

/// `cargo test --release -p lunula-hemodynamics --test fit -- --ignored --nocapture noise`. Measured with both
/// photodiodes: 185, 185, 190, 189 of 200; 198, 199, 200, 200; 193, 197, 200, 200; RMS of k 0.117, 0.171, 0.302. Taken
/// as white (`whiten` in `fit/mod.rs` left out): 182, 182, 188, 189; 144, 146, 169, 169; 101, 103, 111, 111; 0.115,
/// 0.281, 0.454. With waves the intervals are rather too wide.
#[test]
#[ignore = "takes three minutes; its figures are in docs/src/accuracy/models.md"]
fn errors_hold_the_truth_of_two_hundred() {
    let quieter = CASES.map(|([white, pulse, waves], _)| [0.1 * white, pulse, waves]);
    for parts in CASES.map(|(parts, _)| parts).into_iter().chain(quieter) {
        // A photodiode alone leaves k and b uncertain by as much as they are; what is said of them holds all the same.
        for units in [&BOTH[..], &[1], &[0]] {
            let (counts, without_ends, _) = held(parts, units, 200);
            assert!(units == [0] || counts[..2].iter().all(|count| *count >= 180), "{units:?} {parts:?}: {counts:?}");
            assert!((0..2).all(|q| counts[2 + q] + without_ends[q] >= 180), "{units:?} {parts:?}: {counts:?}");
        }
    }
}

#[test]
fn recordings_with_gaps_and_uneven_times_are_fitted_together_in_their_own_noise() {
    // Every third sample later, and a gap of 3 s.
    let uneven =
        |k: u32| 0.04 * f64::from(k) + if k.is_multiple_of(3) { 0.013 } else { 0.0 } + if k > 200 { 3.0 } else { 0.0 };
    let uneven: Vec<f64> = (0..400).map(uneven).collect();
    let mut beat = beating(&pressed(&uneven, &BOTH), &uneven, [0.01, 0.02, 0.05], 3).of("anna");
    // The photodiodes take turns.
    for (unit, trace) in beat.photodiodes.iter_mut().enumerate() {
        trace.voltages_v.iter_mut().skip(unit).step_by(2).for_each(|volts| *volts = f64::NAN);
    }
    let quiet = beating(&pressed(&evenly(), &BOTH), &evenly(), [0.01, 0.0, 0.0], 1).of("ben");
    let short: Vec<f64> = evenly().into_iter().step_by(16).collect();
    let short = noisy(&pressed(&short, &BOTH), 0.01, 4).of("anna");
    let result = fitted(&[beat, quiet, short]);
    let noises: Vec<Vec<String>> = (result.noises.iter())
        .map(|of| of.iter().map(|one| one.map_or("-".to_owned(), |slow| slow.to_string())).collect())
        .collect();
    assert!(noises[0].iter().all(|noise| noise.contains("slow") && noise.contains(" Hz")), "{noises:?}");
    assert!(noises[1].iter().all(|noise| noise == "white"), "{noises:?}");
    assert!(noises[2].iter().all(|noise| noise == "-"), "{noises:?}");
    for (group, truth) in result.groups.iter().zip(TRUTH) {
        let error = group.standard_errors.as_ref().expect("an error")[0];
        // The quiet recording is not drowned in the other one's noise: alone it leaves 0.1.
        assert!((group.values[0] - truth).abs() <= 2.0 * error && error <= 0.15 * truth, "{group:?}");
    }
}
