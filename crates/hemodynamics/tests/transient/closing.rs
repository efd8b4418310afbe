//! Vessels that close.

use lunula_hemodynamics::{Collapse, Model, Order, Parameters, Site, SolveFault, SolveOptions, State, simulate};

use super::reference::rows;
use super::{distance, is_open, loads, rest};

/// Of the time of a collapse, s.
const TIME_TOLERANCE_S: f64 = 1e-9;

fn times() -> Vec<f64> {
    (0..=400).map(|k| f64::from(k) * 0.01).collect()
}

#[test]
fn a_collapse_names_the_vessel_and_its_time_to_a_nanosecond_at_any_tolerance() {
    let model = Model::new(&Parameters::thesis(), Collapse::Error);
    let table = rows(include_str!("../reference/crossings.csv"));
    assert_eq!(table.len(), 3);
    for row in table {
        let (load_pa, exact) = (row[0], row[1]);
        for (rtol, order) in [(1e-3, Order::Auto), (1e-6, Order::Thirteenth), (1e-8, Order::Auto), (1e-12, Order::Auto)]
        {
            let options = SolveOptions { order, ..SolveOptions::at(rtol) };
            let loads = loads(&format!("step:{load_pa}@0..2"), "0");
            let fault = simulate(&model, &loads, &rest(), &times(), &options).unwrap_err();
            let SolveFault::Collapsed { site, time_s, before } = fault else { panic!("{load_pa} Pa: {fault}") };
            println!("{load_pa} {rtol:e}: {:e} {:?}", time_s - exact, before.statistics());
            assert_eq!(site, Site::Vein);
            assert!((time_s - exact).abs() <= TIME_TOLERANCE_S, "{load_pa} Pa, {rtol:e}: {time_s} is not {exact}");
            assert_eq!(before.len(), (exact * 100.0) as usize + 1);
            assert!(is_open(&before));
        }
    }
}

#[test]
fn a_distal_load_beyond_the_fold_closes_the_distal_capillaries() {
    let model = Model::new(&Parameters::thesis(), Collapse::Error);
    for load_pa in [10_900.0, 2e4, 1e6] {
        let loads = loads("0", &format!("step:{load_pa}@0..20"));
        let fault = simulate(&model, &loads, &rest(), &[0.0, 20.0], &SolveOptions::at(1e-4)).unwrap_err();
        let message = fault.to_string();
        let SolveFault::Collapsed { site, time_s, before } = fault else { panic!("{load_pa} Pa: {message}") };
        assert_eq!(site, Site::Capillary(1));
        assert!(time_s > 0.0 && time_s < 20.0 && before.len() == 1);
        assert!(message.contains("C2") && message.contains("contact"), "{message}");
    }
}

#[test]
fn contact_keeps_every_vessel_open_up_to_a_million_pascals() {
    let model = Model::new(&Parameters::thesis(), Collapse::Contact);
    // The facts page's lumens at rest under the load.
    for (load_pa, resting) in [(1.2e4, None), (2e4, Some(0.016_226_742)), (1e5, Some(0.009_149_301)), (1e6, None)] {
        for rtol in [1e-3, 1e-6, 1e-9, 1e-12] {
            for (proximal, distal) in [(load_pa, 0.0), (0.0, load_pa), (load_pa, load_pa)] {
                let loads = loads(&format!("step:{proximal}@0..2"), &format!("step:{distal}@0..2"));
                let got = simulate(&model, &loads, &rest(), &times(), &SolveOptions::at(rtol));
                let got = got.unwrap_or_else(|fault| panic!("{proximal} {distal} Pa, {rtol:e}: {fault}"));
                assert!(is_open(&got), "{proximal} {distal} Pa, {rtol:e}");
                let statistics = got.statistics();
                assert!(statistics.evaluations <= 20_000, "{proximal} {distal} Pa, {rtol:e}: {statistics:?}");
                if let Some(resting) = resting.filter(|_| distal == 0.0) {
                    assert!((got.lumens(200)[2] - resting).abs() <= rtol + 1e-9, "{proximal} Pa, {rtol:e}");
                }
            }
        }
    }
}

#[test]
fn contact_at_a_million_pascals_agrees_with_a_tight_run() {
    let model = Model::new(&Parameters::thesis(), Collapse::Contact);
    let loads = loads("step:1e6@0..2", "step:1e6@0..2");
    let tight = simulate(&model, &loads, &rest(), &times(), &SolveOptions::at(1e-13)).unwrap();
    for rtol in [1e-3, 1e-6, 1e-9] {
        let got = simulate(&model, &loads, &rest(), &times(), &SolveOptions::at(rtol)).unwrap();
        let error = distance(&got, &tight);
        assert!(error <= rtol, "{rtol:e}: {error:e}");
    }
}

#[test]
fn a_start_that_is_closed_is_refused_and_named() {
    let model = Model::new(&Parameters::thesis(), Collapse::Contact);
    for lumen in [0.0, -0.5, f64::NAN] {
        let start = State { lumens: vec![1.0, lumen, 1.0], rates: vec![0.0; 3] };
        let message =
            simulate(&model, &loads("0", "0"), &start, &[0.0, 1.0], &SolveOptions::default()).unwrap_err().to_string();
        assert!(message.contains("C2"), "{message}");
    }
}

/// A load that is taken away just before, or just after, the vein would close: every tolerance has to separate the two
/// apart. (Measured: taken away 1e-8 s before, the vein closes all the same by its inertia, 1e-9 s late; 1e-7 s before,
/// it stays open.)
#[test]
fn a_loose_run_sees_a_collapse_that_a_tight_one_sees() {
    let model = Model::new(&Parameters::thesis(), Collapse::Error);
    for load_pa in [1.104e4, 1.12e4, 1.14e4] {
        let held = loads(&load_pa.to_string(), "0");
        let fault = simulate(&model, &held, &rest(), &[0.0, 100.0], &SolveOptions::at(1e-12)).unwrap_err();
        let SolveFault::Collapsed { time_s, .. } = fault else { panic!("{load_pa} Pa: {fault}") };
        for away in [1e-4, 1e-3] {
            for (until, closes) in [(time_s - away, false), (time_s + away, true)] {
                let pulse = loads(&format!("step:{load_pa}@-1..{until}"), "0");
                for rtol in [1e-3, 1e-6, 1e-9] {
                    let got = simulate(&model, &pulse, &rest(), &[0.0, until + 1.0], &SolveOptions::at(rtol));
                    match got {
                        Ok(_) => assert!(!closes, "{load_pa} Pa, {away:e} s late, {rtol:e}"),
                        Err(SolveFault::Collapsed { time_s: at, .. }) => {
                            assert!(
                                closes && (at - time_s).abs() <= TIME_TOLERANCE_S,
                                "{load_pa} Pa, {away:e} s: {at}"
                            );
                        }
                        Err(fault) => panic!("{load_pa} Pa, {away:e} s, {rtol:e}: {fault}"),
                    }
                }
            }
        }
    }
}
