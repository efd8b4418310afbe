use super::*;
use crate::{Collapse, Load, Loads, Model, Parameters, State, Symbol};

/// A response of the reference tables: its load, times and lumens.
struct Case {
    name: &'static str,
    loads: Loads,
    times_s: Vec<f64>,
    lumens: Vec<[f64; 3]>,
}

fn none() -> Load {
    Load::constant(0.0).expect("a number")
}

/// The rows of a table of `tests/reference`.
fn rows(name: &str) -> Vec<Vec<f64>> {
    let path = format!("{}/tests/reference/{name}.csv", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&path).expect(&path);
    let lines = text.lines().filter(|line| !line.starts_with('#')).skip(1);
    lines.map(|line| line.split(',').map(|cell| cell.parse().expect(cell)).collect()).collect()
}

/// The thirty steps of load, solved in 60 digits: `tests/reference/README.md`.
fn reference() -> Vec<Case> {
    let mut cases = Vec::new();
    for name in ["proximal", "both", "distal"] {
        let rows = rows(name);
        for own in rows.chunk_by(|a, b| a[0] == b[0]) {
            let step = Load::step(own[0][0], 0.0, 2.0).expect("finite");
            let [proximal, distal] = match name {
                "proximal" => [step, none()],
                "distal" => [none(), step],
                _ => [step.clone(), step],
            };
            cases.push(Case {
                name,
                loads: Loads::on(&Parameters::thesis(), proximal, distal),
                times_s: own.iter().map(|row| row[1]).collect(),
                lumens: own.iter().map(|row| [1.0 + row[2], 1.0 + row[3], 1.0 + row[4]]).collect(),
            });
        }
    }
    assert_eq!(cases.len(), 30);
    cases
}

fn thesis() -> Model {
    Model::new(&Parameters::thesis(), Collapse::Error)
}

/// The equilibrium without load.
fn rest() -> State {
    let lumens = rows("proximal")[0][2..5].iter().map(|x| 1.0 + x).collect();
    State { lumens, rates: vec![0.0; 3] }
}

/// The largest difference of lumens.
fn gap(a: &Trajectory, b: &Trajectory) -> f64 {
    assert_eq!(a.times_s(), b.times_s());
    let each = (0..a.len()).flat_map(|k| a.lumens(k).iter().zip(b.lumens(k)));
    each.fold(0.0, |worst, (a, b)| worst.max((a - b).abs()))
}

fn run(model: &Model, loads: &Loads, start: &State, times_s: &[f64], rtol: f64, inertia: Inertia) -> Reduced {
    simulate_reduced(model, loads, start, times_s, &SolveOptions::at(rtol), inertia).expect("a solution")
}

#[test]
fn the_tolerance_bounds_the_methods_error() {
    // Measured over all cases: 0.49, 0.80, 0.58, 0.91 (at 1e-7), 0.77 of the tolerance.
    let model = thesis();
    for case in reference() {
        let mut times_s = case.times_s.clone();
        times_s.extend((0..400).flat_map(|k| [0.01 * f64::from(k), 1e-4 * f64::from(k)]));
        times_s.sort_by(f64::total_cmp);
        let of = |rtol| run(&model, &case.loads, &rest(), &times_s, rtol, Inertia::Dropped).trajectory;
        let fine = of(1e-12);
        for rtol in [1e-2, 1e-4, 1e-6, 1e-7, 1e-8] {
            let error = gap(&of(rtol), &fine);
            assert!(error <= rtol, "{} {:?} at {rtol}: {error}", case.name, case.loads.at(1.0));
        }
    }
}

#[test]
fn the_models_error_is_as_told() {
    // Measured: dropped up to 3.95e-4, told 1.00 to 1.09 of it; corrected up to 2.45e-7, told 0.62 to 1.08 of it.
    let bounds = [(Inertia::Dropped, 4e-4, 0.95..1.15), (Inertia::Corrected, 2.6e-7, 0.55..1.15)];
    let model = thesis();
    for case in reference() {
        for (inertia, most, ratios) in &bounds {
            let own = run(&model, &case.loads, &rest(), &case.times_s, 1e-12, *inertia);
            let mut error = 0.0_f64;
            for (k, exact) in case.lumens.iter().enumerate() {
                for (own, exact) in own.trajectory.lumens(k).iter().zip(exact) {
                    error = error.max((own - exact).abs());
                }
            }
            let place = format!("{} {:?} {inertia:?}: {error} of {}", case.name, case.loads.at(1.0), own.model_error);
            assert!(error <= *most, "{place}");
            assert!(ratios.contains(&(own.model_error / error)), "{place}");
        }
    }
}

/// The model with all masses multiplied.
fn heavier(factor: f64) -> Model {
    let mut parameters = Parameters::thesis();
    for symbol in parameters.symbols() {
        if let Symbol::Mass(_) = symbol {
            let mass = parameters.get(symbol).expect("its own symbol");
            parameters = parameters.set(symbol, mass * factor).expect("a mass");
        }
    }
    Model::new(&parameters, Collapse::Error)
}

/// Inputs that jump, rise, bend and swing.
fn lively() -> Loads {
    let swinging = Load::sine(1e4, 500.0, 1.0).expect("finite");
    let rising = Load::table(&[0.0, 0.3, 0.5, 1.0], &[0.0, 4000.0, 1500.0, 3000.0]).expect("a table");
    let step = Load::step(2000.0, 0.1, 0.6).expect("finite");
    Loads { upstream: swinging, ..Loads::on(&Parameters::thesis(), rising, step) }
}

#[test]
fn errors_go_with_the_masses_and_with_their_square() {
    // From a tenth to all of the thesis' masses: measured 10.0005 and 99.99. Told over true: 1.003 and 0.999.
    let times_s: Vec<f64> = (0..=100).map(|k| 0.01 * f64::from(k)).collect();
    for (inertia, expected) in [(Inertia::Dropped, 10.0), (Inertia::Corrected, 100.0)] {
        let error = |factor: f64| {
            let model = heavier(factor);
            let start = State { rates: vec![1e-3, -2e-3, 5e-3], ..rest() };
            let full = run(&model, &lively(), &start, &times_s, 1e-13, Inertia::Full);
            let own = run(&model, &lively(), &start, &times_s, 1e-13, inertia);
            let error = gap(&full.trajectory, &own.trajectory);
            assert!((own.model_error / error - 1.0).abs() <= 0.02, "{inertia:?}: {error} of {}", own.model_error);
            error
        };
        let gain = error(1.0) / error(0.1);
        assert!((gain / expected - 1.0).abs() <= 0.01, "{inertia:?}: {gain}");
    }
}

#[test]
fn with_masses_of_a_kilogram_the_error_told_is_too_large_to_use() {
    // Measured: dropped 0.11 D, told 0.20 D; corrected 0.055 D, told 0.11 D.
    let model = heavier(1000.0);
    let case = &reference()[4];
    let full = run(&model, &case.loads, &rest(), &case.times_s, 1e-10, Inertia::Full);
    for inertia in [Inertia::Dropped, Inertia::Corrected] {
        let own = run(&model, &case.loads, &rest(), &case.times_s, 1e-8, inertia);
        let error = gap(&full.trajectory, &own.trajectory);
        assert!(error >= 0.05 && own.model_error >= error, "{inertia:?}: {error} of {}", own.model_error);
        assert!(own.model_error <= 3.0 * error, "{inertia:?}: {error} of {}", own.model_error);
    }
}

#[test]
fn masses_that_carry_a_wall_shut_are_refused() {
    // A million times the thesis' masses: the layer's integral is many diameters.
    let loads = Loads::on(&Parameters::thesis(), Load::step(8000.0, -1.0, 0.0).unwrap(), none());
    let model = heavier(1e6);
    let options = SolveOptions { start_s: Some(-1.0), ..SolveOptions::at(1e-6) };
    let fault = simulate_reduced(&model, &loads, &rest(), &[1.0], &options, Inertia::Corrected).unwrap_err();
    assert!(matches!(fault, ReducedFault::Layer { .. }), "{fault}");
    let dropped = simulate_reduced(&model, &loads, &rest(), &[1.0], &options, Inertia::Dropped).unwrap();
    assert!(dropped.model_error >= 1.0, "{}", dropped.model_error);
}

#[test]
fn a_closing_vessel_is_told_with_its_time() {
    // Measured: dropped 4.0e-6 s, corrected 8.8e-10 s from the full model's time.
    let rows = rows("crossings");
    assert_eq!(rows.len(), 3);
    for row in rows {
        let loads = Loads::on(&Parameters::thesis(), Load::constant(row[0]).unwrap(), none());
        for (inertia, most) in [(Inertia::Dropped, 1e-5), (Inertia::Corrected, 2e-9)] {
            let fault =
                simulate_reduced(&thesis(), &loads, &rest(), &[0.0, 1e-3, 4.0], &SolveOptions::at(1e-4), inertia);
            match fault {
                Err(ReducedFault::Solve(SolveFault::Collapsed { site: Site::Vein, time_s, before })) => {
                    assert!((time_s - row[1]).abs() <= most, "{inertia:?} {}: {}", row[0], time_s - row[1]);
                    assert_eq!(before.times_s(), [0.0, 1e-3]);
                    assert_eq!(before.statistics().stopped, Stopped::Collapsed);
                }
                other => panic!("{other:?}"),
            }
        }
    }
}

#[test]
fn walls_in_contact_are_solved_while_the_work_allowed_lasts() {
    let model = Model::new(&Parameters::thesis(), Collapse::Contact);
    let times_s: Vec<f64> = (0..=100).map(|k| 0.04 * f64::from(k)).collect();
    let pressed = |load: f64| Loads::on(&Parameters::thesis(), Load::step(load, 0.0, 2.0).unwrap(), none());
    // Measured: corrected 2.5e-7, told 8.9e-7, 16 512 evaluations.
    let full = run(&model, &pressed(2e4), &rest(), &times_s, 1e-10, Inertia::Full);
    let own = run(&model, &pressed(2e4), &rest(), &times_s, 1e-8, Inertia::Corrected);
    let error = gap(&full.trajectory, &own.trajectory);
    assert!(error <= own.model_error && own.model_error <= 1e-6, "{error} of {}", own.model_error);
    let options = SolveOptions { most_evaluations: 50_000, ..SolveOptions::at(1e-6) };
    for inertia in [Inertia::Dropped, Inertia::Corrected] {
        match simulate_reduced(&model, &pressed(1e6), &rest(), &times_s, &options, inertia) {
            Err(ReducedFault::Stiff { evaluations, .. }) => assert!(evaluations <= 50_010, "{evaluations}"),
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn any_number_of_units_and_walls_without_damping_are_solved() {
    // Measured 1.0e-9 with damping, 2.5e-7 without.
    let times_s: Vec<f64> = (0..=50).map(|k| 0.02 * f64::from(k)).collect();
    let mut models: Vec<(Parameters, Model)> = Vec::new();
    for units in [1, 2, 3, 8] {
        let mut parameters = Parameters::along_nail(units).unwrap();
        models.push((parameters.clone(), Model::new(&parameters, Collapse::Error)));
        for symbol in parameters.symbols() {
            if let Symbol::Damping(_) = symbol {
                parameters = parameters.set(symbol, 0.0).unwrap();
            }
        }
        models.push((parameters.clone(), Model::new(&parameters, Collapse::Error)));
    }
    for (parameters, model) in models {
        let start = State::undisplaced(&parameters);
        let loads = Loads { upstream: Load::constant(1e4).unwrap(), ..lively() };
        let full = run(&model, &loads, &start, &times_s, 1e-12, Inertia::Full);
        let own = run(&model, &loads, &start, &times_s, 1e-12, Inertia::Corrected);
        let error = gap(&full.trajectory, &own.trajectory);
        assert!(error <= 1e-6, "{} walls: {error} of {}", model.walls(), own.model_error);
    }
}

#[test]
fn a_capillary_that_only_its_inertia_holds_back_is_refused() {
    let mut parameters = Parameters::thesis();
    for name in ["b_C2_N_s_per_m", "R_V2_Pa_s_per_m3"] {
        parameters = parameters.set(name.parse().unwrap(), 0.0).unwrap();
    }
    let model = Model::new(&parameters, Collapse::Error);
    let fault = simulate_reduced(&model, &lively(), &rest(), &[0.0], &SolveOptions::default(), Inertia::Dropped);
    assert_eq!(fault, Err(ReducedFault::Undamped { site: Site::Capillary(1) }));
}

#[test]
fn a_rested_finger_stays_at_rest() {
    let loads = Loads::on(&Parameters::thesis(), none(), none());
    for inertia in [Inertia::Dropped, Inertia::Corrected] {
        let own = run(&thesis(), &loads, &rest(), &[0.0, 1.0, 1000.0], 1e-8, inertia);
        for k in 0..3 {
            let start = rest().lumens;
            let moved = own.trajectory.lumens(k).iter().zip(&start).map(|(a, b)| (a - b).abs());
            // An explicit method lets roundings grow to its tolerance, no further; measured 3e-11.
            let moved = moved.fold(0.0, f64::max);
            assert!(moved <= 1e-8, "{inertia:?}: {moved}");
        }
        assert!(own.model_error <= 1e-12, "{inertia:?}: {}", own.model_error);
    }
}

#[test]
fn loads_that_are_no_numbers_are_told() {
    let broken = Load::function(|t| if t < 0.5 { 1000.0 } else { f64::NAN }, &[]).unwrap();
    let loads = Loads::on(&Parameters::thesis(), none(), broken);
    for inertia in [Inertia::Dropped, Inertia::Corrected] {
        match simulate_reduced(&thesis(), &loads, &rest(), &[0.0, 1.0], &SolveOptions::default(), inertia) {
            Err(ReducedFault::Solve(SolveFault::Load { load: "P_F2", value, .. })) => assert!(value.is_nan()),
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn what_cannot_be_asked_is_refused_as_by_the_full_model() {
    let ask = |start: &State, times_s: &[f64], options: &SolveOptions, inertia| {
        let loads = Loads::on(&Parameters::thesis(), none(), none());
        simulate_reduced(&thesis(), &loads, start, times_s, options, inertia).unwrap_err()
    };
    let closed = State { lumens: vec![1.0, 0.0, 1.0], ..rest() };
    let short = State { lumens: vec![1.0; 2], rates: vec![0.0; 2] };
    let early = SolveOptions { start_s: Some(1.0), ..SolveOptions::default() };
    let asked: [(&State, &[f64], SolveOptions); 6] = [
        (&closed, &[0.0], SolveOptions::default()),
        (&short, &[0.0], SolveOptions::default()),
        (&rest(), &[], SolveOptions::default()),
        (&rest(), &[1.0, 0.0], SolveOptions::default()),
        (&rest(), &[0.0], early),
        (&rest(), &[0.0], SolveOptions::at(0.0)),
    ];
    for (start, times_s, options) in asked {
        let full = ask(start, times_s, &options, Inertia::Full);
        for inertia in [Inertia::Dropped, Inertia::Corrected] {
            assert_eq!(ask(start, times_s, &options, inertia), full);
        }
    }
}

#[test]
fn a_table_of_a_hundred_thousand_rows_takes_a_step_a_row() {
    let times_s: Vec<f64> = (0..100_000).map(|k| 1e-4 * f64::from(k)).collect();
    let values: Vec<f64> = (0..100_000).map(|k| 500.0 * f64::from(k % 7)).collect();
    let loads = Loads::on(&Parameters::thesis(), Load::table(&times_s, &values).unwrap(), none());
    let own = run(&thesis(), &loads, &rest(), &[0.0, 10.0], 1e-6, Inertia::Corrected);
    let statistics = own.trajectory.statistics();
    assert!(statistics.steps <= 110_000, "{statistics:?}");
    assert!(own.model_error.is_finite());
}

#[test]
fn a_pulse_of_a_millisecond_is_seen() {
    let loads = Loads::on(&Parameters::thesis(), Load::step(1e4, 1.0, 1.001).unwrap(), none());
    let times_s = [0.0, 1.0005, 1.001, 1.1, 4.0];
    let full = run(&thesis(), &loads, &rest(), &times_s, 1e-12, Inertia::Full);
    let own = run(&thesis(), &loads, &rest(), &times_s, 1e-10, Inertia::Corrected);
    let moved = (own.trajectory.lumens(2)[2] - rest().lumens[2]).abs();
    let error = gap(&full.trajectory, &own.trajectory);
    // Measured: moved 0.06, error 2.4e-7.
    assert!(moved >= 0.05 && error <= 5e-7, "{moved} {error}");
}

#[test]
fn breakpoints_next_to_each_other_are_crossed() {
    let at = 1.0_f64;
    let times = [at, at.next_up(), at.next_up().next_up()];
    let loads = Loads::on(&Parameters::thesis(), Load::table(&times, &[0.0, 1000.0, 50.0]).unwrap(), none());
    for inertia in [Inertia::Dropped, Inertia::Corrected] {
        let own = run(&thesis(), &loads, &rest(), &[0.5, 1.0, 1.5], 1e-8, inertia);
        assert!(own.trajectory.lumens(2).iter().all(|lumen| lumen.is_finite()), "{inertia:?}");
        assert!(own.model_error.is_finite(), "{inertia:?}");
    }
}

/// Numbers of a fixed sequence, 0 to 1.
fn numbers() -> impl FnMut() -> f64 {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 53) as f64
    }
}

#[test]
fn extremes_end_with_a_solution_or_a_reason() {
    // Masses 1e-12 to 1 kg, stiffness x 0.1 to 1000, damping none to x 100, steps of 10 to 1e6 Pa, pulses of P_H up to 1 kHz, 1 to 3 units,
    // both policies. Measured: 294 of 400 solved, their errors up to 1.22 times what was told and the tolerance.
    let mut next = numbers();
    let mut solved = 0;
    for run in 0..200 {
        let mut spread = |least: f64, most: f64| least * (most / least).powf(next());
        let mut parameters = Parameters::along_nail(1 + run % 3).unwrap();
        for symbol in parameters.symbols() {
            let value = parameters.get(symbol).unwrap();
            let changed = match symbol {
                Symbol::Mass(_) => spread(1e-12, 1.0),
                Symbol::Stiffness(_) => value * spread(1e-1, 1e3),
                Symbol::Damping(_) if run % 4 == 0 => 0.0,
                Symbol::Damping(_) => value * spread(1e-2, 1e2),
                _ => value,
            };
            parameters = parameters.set(symbol, changed).unwrap();
        }
        let collapse = if run % 2 == 0 { Collapse::Error } else { Collapse::Contact };
        let model = Model::new(&parameters, collapse);
        let pulsatile = Load::sine(1e4, 1e3, if run % 5 == 0 { 1000.0 } else { spread(0.1, 10.0) }).unwrap();
        let step = Load::step(spread(10.0, 1e6), 0.01, 0.01 + spread(1e-3, 1.0)).unwrap();
        let ramp = Load::ramp(0.0, spread(10.0, 1e4), 0.2, 0.2 + spread(1e-3, 1.0)).unwrap();
        let loads = Loads { upstream: pulsatile, ..Loads::on(&parameters, step, ramp) };
        let times_s = [0.0, 0.0100001, 0.1, 0.3];
        let options = SolveOptions { most_evaluations: 30_000, ..SolveOptions::at(1e-6) };
        let start = State::undisplaced(&parameters);
        let full = simulate(&model, &loads, &start, &times_s, &options);
        for inertia in [Inertia::Dropped, Inertia::Corrected] {
            let Ok(own) = simulate_reduced(&model, &loads, &start, &times_s, &options, inertia) else { continue };
            solved += 1;
            assert_eq!(own.trajectory.times_s(), times_s);
            for k in 0..times_s.len() {
                assert_eq!(own.trajectory.state(k).check(), Ok(()), "{run} {inertia:?}");
            }
            assert!(own.model_error >= 0.0, "{run} {inertia:?}: {}", own.model_error);
            if let Ok(full) = &full {
                let error = gap(full, &own.trajectory);
                let told = own.model_error + options.rtol;
                assert!(error <= 1.5 * told, "{run} {inertia:?}: {error} of {told}");
            }
        }
    }
    assert!(solved >= 250, "{solved}");
}
