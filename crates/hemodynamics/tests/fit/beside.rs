//! What goes with the load or bends the signal is found where a stiffness would take it up, and nothing is where it is
//! not.

use lunula_hemodynamics::{Beside, BesidePart, FitOptions, Load, Parameters, Recording, fit};

use crate::noise::beating;
use crate::phantom::{changed, noisy, seen, tied};

fn times() -> Vec<f64> {
    (0..800).map(|k| 0.02 * f64::from(k)).collect()
}

/// Four presses of 16 s that rise and fall smoothly.
fn load() -> Load {
    let press = |t: f64, [on, off, pa]: [f64; 3]| 0.5 * pa * (((t - on) / 0.12).tanh() - ((t - off) / 0.12).tanh());
    let presses = [[1.0, 3.0, 4000.0], [4.5, 6.0, 2500.0], [7.5, 10.0, 5500.0], [11.5, 13.0, 3500.0]];
    let values: Vec<f64> =
        times().iter().map(|&t| presses.iter().map(|&one| press(t, one)).sum::<f64>().max(0.0)).collect();
    Load::table(&times(), &values).expect("growing times")
}

/// Voltages changed by `change`, of a signal and a load from 0 to 1.
fn with(recording: &Recording, change: impl Fn(f64, f64) -> f64) -> Recording {
    let mut changed = recording.clone();
    for trace in &mut changed.photodiodes {
        let ends = |values: &[f64]| values.iter().fold([f64::MAX, f64::MIN], |[a, b], v| [a.min(*v), b.max(*v)]);
        let [least, most] = ends(&trace.voltages_v);
        for (t, volts) in times().iter().zip(&mut trace.voltages_v) {
            *volts = least + (most - least) * change((*volts - least) / (most - least), load().at(*t) / 5500.0);
        }
    }
    changed
}

/// What is found, and how far the stiffness is from the true one in its standard errors.
fn fitted(recording: Recording) -> (Beside, f64) {
    let result = fit(&[recording], &Parameters::thesis(), &tied(), &FitOptions::default()).expect("a fit");
    let group = &result.groups[0];
    let off = (group.values[0] - 1e5) / group.standard_errors.as_ref().expect("a standard error")[0];
    (result.beside.expect("a free parameter"), off)
}

#[test]
fn what_goes_with_the_load_or_bends_the_signal_is_found() {
    let exact = seen(&Parameters::thesis(), &times(), &load(), &load(), &[0, 1]);
    for (part, size) in
        [(BesidePart::Load, 0.03), (BesidePart::Load, -0.03), (BesidePart::Load, 0.1), (BesidePart::Square, 0.1)]
    {
        let changed = with(&exact, |signal, load| match part {
            BesidePart::Load => signal + size * load,
            BesidePart::Square => signal - size * signal * signal,
        });
        for (noise, seed) in [(0.002, 0), (0.002, 1), (0.01, 2), (0.01, 3)] {
            let (beside, off) = fitted(noisy(&changed, noise, seed));
            println!("{part:?} {size}, noise {noise}: {off:.1} standard errors off, {beside:?}");
            assert!(beside.is_clear() && beside.part == part, "{part:?} {size} {noise} {seed}: {beside:?}");
            assert!((beside.share / size.abs() - 1.0).abs() <= 0.4, "{part:?} {size} {noise} {seed}: {beside:?}");
        }
    }
}

/// A parameter that is held at another finger's value makes errors as large, and looks alike.
#[test]
fn a_vein_of_another_finger_is_found_as_well() {
    let exact = seen(&changed(&[("k_V_N_per_m", 1.5)]), &times(), &load(), &load(), &[0, 1]);
    let (beside, off) = fitted(noisy(&exact, 0.002, 0));
    println!("{off:.1} standard errors off, {beside:?}");
    assert!(beside.is_clear() && off.abs() > 3.0, "{off} {beside:?}");
}

/// Of each kind; with 20, 400 recordings, 3.2 standard deviations at most.
const SEEDS: u64 = 2;

#[test]
fn recordings_of_the_model_hold_nothing_beside_it() {
    let mut most = 0.0_f64;
    for units in [&[0, 1][..], &[1]] {
        let smooth = seen(&Parameters::thesis(), &times(), &load(), &load(), units);
        let step = || Load::step(5000.0, 1.0, 4.0).expect("a finite load");
        let steps = seen(&Parameters::thesis(), &times(), &step(), &step(), units);
        for (exact, seed) in [&smooth, &steps].into_iter().flat_map(|exact| (0..SEEDS).map(move |seed| (exact, seed))) {
            let white = [0.002, 0.01, 0.05].map(|noise| noisy(exact, noise, seed));
            let waves = [0.001, 0.01].map(|white| beating(exact, &times(), [white, 0.02, 0.05], seed));
            for recording in white.into_iter().chain(waves) {
                let (beside, off) = fitted(recording);
                most = most.max(beside.sds);
                assert!(!beside.is_clear(), "{units:?} {seed}: {off:.1} standard errors off, {beside:?}");
            }
        }
    }
    println!("at most {most} standard deviations");
}
