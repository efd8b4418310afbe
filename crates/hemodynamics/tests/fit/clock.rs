//! Loads on another clock than the photodiodes are found, and those on the same one are not.

use lunula_hemodynamics::{Course, Delay, FitOptions, Load, Parameters, Recording, fit};

use crate::noise::beating;
use crate::phantom::{changed, noisy, seen, tied};

/// Presses of 1.5 s that rise within 40 ms, in 16 s at 25 Hz, whose stamps are late.
fn load(late_s: f64) -> Load {
    let rise = |t: f64| if t <= 0.0 { 0.0 } else { 1.0 - (-t / 0.04).exp() };
    let press = |t: f64| [1.0, 5.0, 10.0].iter().map(|on| rise(t - on) - rise(t - on - 1.5)).sum::<f64>();
    let times: Vec<f64> = (0..1600).map(|k| 0.01 * f64::from(k)).collect();
    let values: Vec<f64> = times.iter().map(|t| 5000.0 * press(t - late_s)).collect();
    Load::table(&times, &values).expect("growing times")
}

fn times() -> Vec<f64> {
    (0..400).map(|k| 0.04 * f64::from(k)).collect()
}

fn recorded(truth: &Parameters, units: &[usize]) -> Recording {
    seen(truth, &times(), &load(0.0), &load(0.0), units)
}

/// The delay of a fit to a recording whose loads are stamped late, and the stiffness over the true one.
fn fitted(mut recording: Recording, late_s: f64) -> (Delay, f64) {
    if let Course::Transient { proximal, distal, .. } = &mut recording.course {
        (*proximal, *distal) = (load(late_s), load(late_s));
    }
    let result = fit(&[recording], &Parameters::thesis(), &tied(), &FitOptions::default()).expect("a fit");
    (result.delays[0].expect("a response"), result.groups[0].values[0] / 1e5)
}

#[test]
fn loads_on_another_clock_are_seen_whatever_the_noise() {
    // The sensor's other parameters may be another's.
    for truth in [Parameters::thesis(), changed(&[("b_V_N_s_per_m", 2.0)])] {
        for units in [&[0, 1][..], &[1]] {
            let exact = recorded(&truth, units);
            for (noise, late_s) in
                [0.001, 0.05].iter().flat_map(|noise| [-0.08, -0.04, 0.04, 0.08, 0.3].map(|late_s| (*noise, late_s)))
            {
                let (delay, stiffness) = fitted(noisy(&exact, noise, 3), late_s);
                println!("{units:?} noise {noise}, {late_s} s late: k {stiffness:.2} times the true one, {delay:?}");
                assert!(delay.is_clear() && delay.by_s * late_s < 0.0, "{units:?} {noise} {late_s}: {delay:?}");
                assert!((delay.by_s + late_s).abs() <= 0.5 * late_s.abs(), "{units:?} {noise} {late_s}: {delay:?}");
            }
        }
    }
}

/// Of each kind; with 10, 300 recordings, none is doubted either (10 ms at most).
const SEEDS: u64 = 2;

#[test]
fn loads_on_the_same_clock_are_not_doubted() {
    let mut most = [0.0_f64; 2];
    let [mut clear, mut all] = [0; 2];
    for truth in [Parameters::thesis(), changed(&[("k_V_N_per_m", 1.5)]), changed(&[("b_V_N_s_per_m", 2.0)])] {
        for units in [&[0, 1][..], &[1]] {
            let exact = recorded(&truth, units);
            for seed in 0..SEEDS {
                let white = [0.001, 0.01, 0.05].map(|noise| noisy(&exact, noise, seed));
                let waves = [0.001, 0.01].map(|white| beating(&exact, &times(), [white, 0.02, 0.05], seed));
                for recording in white.into_iter().chain(waves) {
                    let (delay, _) = fitted(recording, 0.0);
                    most[0] = most[0].max(delay.by_s.abs());
                    most[1] = most[1].max((delay.by_s / delay.standard_error_s).abs());
                    clear += u64::from(delay.is_clear());
                    all += 1;
                }
            }
        }
    }
    println!("{clear} of {all}; at most {} s, {} standard errors", most[0], most[1]);
    assert_eq!(clear, 0);
}
