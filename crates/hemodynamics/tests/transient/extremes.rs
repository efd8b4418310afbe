//! Extreme parameters and loads: right, or an error, in bounded work.

use lunula_hemodynamics::{
    Collapse, Load, Loads, Model, Parameters, Site, SolveFault, SolveOptions, State, Symbol, Trajectory, simulate,
};

use super::{distance, is_open, load, loads, rest};

const WALLS: [Site; 3] = [Site::Capillary(0), Site::Capillary(1), Site::Vein];

/// Runs from the undisplaced walls at loose tolerances against the finest. The largest error over the tolerance.
fn check(name: &str, parameters: &Parameters, loads: &Loads, until: f64) {
    let model = Model::new(parameters, Collapse::Contact);
    let start = State::undisplaced(parameters);
    let times: Vec<f64> = (0..=100).map(|k| until * f64::from(k) / 100.0).collect();
    let run = |rtol: f64| -> Trajectory {
        simulate(&model, loads, &start, &times, &SolveOptions::at(rtol))
            .unwrap_or_else(|fault| panic!("{name}: {fault}"))
    };
    let exact = run(1e-13);
    for rtol in [1e-3, 1e-6, 1e-9] {
        let got = run(rtol);
        assert!(is_open(&got), "{name}, {rtol:e}");
        let worst = distance(&got, &exact);
        println!("{name} {rtol:e}: {:.2} {:?}", worst / rtol, got.statistics());
        assert!(worst <= rtol, "{name}, {rtol:e}: {worst:e}");
    }
}

fn with(change: impl Fn(Site) -> Symbol, value: impl Fn(f64) -> f64) -> Parameters {
    WALLS.into_iter().fold(Parameters::thesis(), |parameters, site| {
        let symbol = change(site);
        let old = parameters.get(symbol).expect("a wall's symbol");
        parameters.set(symbol, value(old)).expect("a value that can be used")
    })
}

#[test]
fn masses_from_nothing_to_a_kilogram() {
    for mass in [1e-12, 1e-6, 1.0] {
        let parameters = with(Symbol::Mass, |_| mass);
        check(&format!("m = {mass} kg"), &parameters, &loads("step:3000@0..0.5", "step:3000@0..0.5"), 1.0);
    }
}

#[test]
fn stiffnesses_over_four_decades() {
    for factor in [0.1, 10.0, 1e3] {
        let parameters = with(Symbol::Stiffness, |k| factor * k);
        check(&format!("k x {factor}"), &parameters, &loads("step:3000@0..0.5", "step:3000@0..0.5"), 1.0);
    }
}

#[test]
fn walls_without_dampers() {
    let parameters = with(Symbol::Damping, |_| 0.0);
    check("b = 0", &parameters, &loads("step:3000@0..0.5", "step:3000@0..0.5"), 1.0);
}

#[test]
fn no_load_from_undisplaced_walls() {
    check("no load", &Parameters::thesis(), &loads("0", "0"), 1.0);
}

#[test]
fn a_pulse_of_a_millisecond_and_one_of_a_nanosecond() {
    check("1 ms", &Parameters::thesis(), &loads("step:1e4@0.5..0.501", "0"), 1.0);
    check("1 ns", &Parameters::thesis(), &loads("step:1e6@0.5..0.500000001", "0"), 1.0);
}

#[test]
fn blood_that_beats_a_thousand_times_a_second() {
    let parameters = Parameters::thesis();
    let mut loads = loads("step:3000@0..0.1", "0");
    loads.upstream = load("sine:1e4+3000@1000");
    check("1 kHz", &parameters, &loads, 0.2);
}

#[test]
fn a_recording_with_a_breakpoint_every_ten_milliseconds() {
    let times: Vec<f64> = (0..=100).map(|k| f64::from(k) * 0.01).collect();
    let values: Vec<f64> = times.iter().map(|t| 4000.0 * (3.0 * t).sin().abs()).collect();
    let recorded = Load::table(&times, &values).unwrap();
    let loads = Loads::on(&Parameters::thesis(), recorded, load("0"));
    check("recording", &Parameters::thesis(), &loads, 1.0);
}

#[test]
fn many_units() {
    for units in [1, 3, 20] {
        let parameters = Parameters::along_nail(units).unwrap();
        check(&format!("{units} units"), &parameters, &loads("step:3000@0..0.5", "step:5000@0..0.5"), 1.0);
    }
}

#[test]
fn loads_that_are_no_numbers_are_named_with_the_time() {
    let model = Model::new(&Parameters::thesis(), Collapse::Error);
    for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let bad = Load::function(move |t| if t > 0.3 { value } else { 1000.0 }, &[]).unwrap();
        let mut loads = loads("0", "0");
        loads.distal = bad;
        let times = [0.0, 0.1, 0.2, 1.0];
        let fault = simulate(&model, &loads, &rest(), &times, &SolveOptions::default()).unwrap_err();
        let SolveFault::Load { load, time_s, value: reported } = fault else { panic!("{fault}") };
        assert!(load == "P_F2" && time_s > 0.3 && time_s < 1.0 && reported.to_bits() == value.to_bits());
    }
}

#[test]
fn times_and_options_without_meaning_are_refused() {
    let model = Model::new(&Parameters::thesis(), Collapse::Error);
    let run = |times: &[f64], options: &SolveOptions| {
        simulate(&model, &loads("0", "0"), &rest(), times, options).unwrap_err().to_string()
    };
    let default = SolveOptions::default();
    assert!(run(&[], &default).contains("no times"));
    assert!(run(&[0.0, 2.0, 1.0], &default).contains("row 3"));
    assert!(run(&[0.0, f64::NAN], &default).contains("row 2"));
    assert!(run(&[f64::INFINITY], &default).contains("row 1"));
    for rtol in [0.0, -1e-6, 1e-14, 0.2, f64::NAN] {
        assert!(run(&[0.0, 1.0], &SolveOptions::at(rtol)).contains("between 1e-13 and 1e-1"));
    }
    let fixed = SolveOptions { fixed_step_s: Some(0.0), ..default.clone() };
    assert!(run(&[0.0, 1.0], &fixed).contains("the fixed step"));
    let start = SolveOptions { start_s: Some(1.0), ..default };
    assert!(run(&[0.0, 1.0], &start).contains("row 1"));
    let wrong = State { lumens: vec![1.0; 4], rates: vec![0.0; 4] };
    let fault = simulate(&model, &loads("0", "0"), &wrong, &[0.0], &SolveOptions::default()).unwrap_err();
    assert!(fault.to_string().contains("4 values for 3 walls"));
}

#[test]
fn work_is_bounded_and_what_was_done_is_kept() {
    let model = Model::new(&Parameters::thesis(), Collapse::Error);
    let options = SolveOptions { most_evaluations: 300, ..SolveOptions::at(1e-9) };
    let fault = simulate(&model, &loads("step:5000@0..2", "0"), &rest(), &[0.0, 1e-6, 4.0], &options).unwrap_err();
    let SolveFault::Work { evaluations, time_s, before } = fault else { panic!("{fault}") };
    assert!((300..400).contains(&evaluations) && time_s > 1e-6 && time_s < 4.0);
    assert_eq!(before.len(), 2);
}
