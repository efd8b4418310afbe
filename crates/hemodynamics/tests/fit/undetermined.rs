//! What the data don't determine is said.

use lunula_hemodynamics::{FitOptions, Free, Parameters, Recording, Trace, fit};

use crate::phantom::{exact, noisy, softer, step, symbol, tied, times, with_photodiodes, zero};

fn recording() -> Recording {
    let truth = with_photodiodes(softer(1.3, 0.6), [2.5; 2], [0.4; 2]);
    noisy(&exact(&truth, &zero(), &step(9000.0), &[1]), 0.01, 5)
}

#[test]
fn two_names_of_one_thing_are_a_combination() {
    // Both enter through alpha alone: epsilon L.
    let [k, b] = tied();
    let free = [k, b, Free::one(symbol("epsilon_per_m")), Free::one(symbol("L_2_m"))];
    let result = fit(&[recording()], &Parameters::thesis(), &free, &FitOptions::default()).unwrap();
    for group in &result.groups[2..] {
        assert!(!group.identifiable && group.standard_errors.is_none(), "{group:?}");
    }
    let lost = result.undetermined.iter().find(|lost| lost.sd.is_none()).expect("a combination without any effect");
    let names: Vec<&str> = lost.weights.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["epsilon_per_m", "L_2_m"]);
    // One goes up as the other goes down.
    assert!((lost.weights[0].1 + lost.weights[1].1).abs() <= 1e-6, "{lost:?}");
    assert!(result.correlations[2].iter().all(|value| value.is_nan()));
}

#[test]
fn a_parameter_that_no_photodiode_sees_has_no_error() {
    // Tissue and path of the unit without a photodiode; inertia, whose time is a microsecond.
    let [k, b] = tied();
    let free = [k, b, Free::one(symbol("V_Tissue1_m3")), Free::one(symbol("L_1_m")), Free::one(symbol("m_C2_kg"))];
    let result = fit(&[recording()], &Parameters::thesis(), &free, &FitOptions::default()).unwrap();
    for group in &result.groups[2..] {
        assert!(!group.identifiable && group.standard_errors.is_none(), "{group:?}");
    }
    // What can't be seen stays where it was.
    assert!((result.groups[2].values[0] / 1e-7 - 1.0).abs() <= 1e-6);
    assert!(result.groups[..2].iter().all(|group| group.identifiable));
    assert!(result.undetermined.len() >= 2, "{:?}", result.undetermined);
}

#[test]
fn a_constant_recording_determines_the_offset_alone() {
    for unloaded in [false, true] {
        let load = if unloaded { zero() } else { step(5000.0) };
        let trace = Trace::new(0, vec![2.5; 400]);
        let recording = Recording::transient(times(), load, zero(), vec![trace]);
        let result = fit(&[recording], &Parameters::thesis(), &tied(), &FitOptions::default()).unwrap();
        assert!(result.groups.iter().all(|group| !group.identifiable && group.standard_errors.is_none()));
        assert_eq!(result.r2, None);
        let diode = &result.photodiodes[0];
        if unloaded {
            // The signal is constant too: only V_0 + V_1 f is known, and the scaling stays that of the start.
            assert!(!diode.scaling.identifiable && !diode.offset.identifiable);
            assert_eq!(diode.scaling.value, 1.0);
            assert_eq!(result.undetermined[0].weights.len(), 2);
        } else {
            assert!(diode.scaling.value.abs() <= 1e-12 && (diode.offset.value - 2.5).abs() <= 1e-12);
        }
        for number in [diode.offset.value, diode.scaling.value, result.residual_sd_v, result.groups[0].values[0]] {
            assert!(number.is_finite());
        }
        assert!(result.residual_sd_v <= 1e-12);
    }
}

#[test]
fn noise_without_a_response_determines_nothing_but_says_so() {
    let recording = Recording::transient(times(), step(5000.0), zero(), vec![Trace::new(0, vec![2.5; 400])]);
    let mut recording = recording;
    for (k, volts) in recording.photodiodes[0].voltages_v.iter_mut().enumerate() {
        *volts += 1e-3 * ((k * k) as f64 * 0.7).sin();
    }
    let result = fit(&[recording], &Parameters::thesis(), &tied(), &FitOptions::default()).unwrap();
    assert!(result.r2.unwrap() < 0.05, "{:?}", result.r2);
    // Either no error, or one that is as large as the bounds.
    let sure = result
        .groups
        .iter()
        .filter(|group| group.standard_errors.as_ref().is_some_and(|errors| errors[0] < 0.5 * group.values[0]));
    assert_eq!(sure.count(), 0, "{:?}", result.groups);
}
