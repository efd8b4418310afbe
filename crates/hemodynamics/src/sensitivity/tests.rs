//! Equilibria and derivatives against the proved equilibria and against differences.

use super::{Rest, Variation};
use crate::equilibrium::rest;
use crate::load::{Inputs, Load, Loads};
use crate::model::{Collapse, Model, Tangent};
use crate::parameters::{Parameters, Site, Symbol};
use crate::state::State;
use crate::transient::{Order, SolveOptions, Solver, Trajectory, simulate};

fn settled(parameters: &Parameters, inputs: &Inputs) -> Vec<f64> {
    let model = Model::new(parameters, Collapse::Error);
    let mut lumens = State::undisplaced(parameters).lumens;
    Rest::default().settle(&model, inputs, &mut lumens).expect("an equilibrium");
    lumens
}

fn inputs_of(parameters: &Parameters, proximal_pa: f64, distal_pa: f64) -> Inputs {
    let (upstream_pa, downstream_pa) = (parameters.upstream_pa(), parameters.downstream_pa());
    Inputs { upstream_pa, downstream_pa, proximal_pa, distal_pa }
}

#[test]
fn settles_in_the_equilibrium_that_is_proved() {
    // Measured 9e-16 D.
    const TOLERANCE: f64 = 1e-13;
    for units in [1, 2, 4] {
        let parameters = Parameters::along_nail(units).unwrap();
        let model = Model::new(&parameters, Collapse::Error);
        for (proximal, distal) in [(0.0, 0.0), (3e3, 0.0), (1.05e4, 0.0), (0.0, 6e3), (9e3, 9e3), (0.0, 1.0858e4)] {
            let inputs = inputs_of(&parameters, proximal, distal);
            let Ok(proved) = rest(&model, &inputs) else {
                continue;
            };
            for (got, expected) in settled(&parameters, &inputs).iter().zip(&proved.state.lumens) {
                assert!((got - expected).abs() <= TOLERANCE, "{units} units, {proximal}, {distal}: {got} {expected}");
            }
        }
    }
}

#[test]
fn where_no_equilibrium_is_left_the_closing_vessel_is_named() {
    let parameters = Parameters::thesis();
    let model = Model::new(&parameters, Collapse::Error);
    for (proximal, distal, site) in [(1.2e4, 0.0, Site::Vein), (0.0, 1.2e4, Site::Capillary(1)), (1e6, 0.0, Site::Vein)]
    {
        let mut lumens = State::undisplaced(&parameters).lumens;
        let inputs = inputs_of(&parameters, proximal, distal);
        let fault = Rest::default().settle(&model, &inputs, &mut lumens).unwrap_err();
        assert_eq!(fault.site, site);
        assert!(lumens.iter().all(|&lumen| lumen > 0.0));
    }
    // With contact there is one.
    let model = Model::new(&parameters, Collapse::Contact);
    let mut lumens = State::undisplaced(&parameters).lumens;
    Rest::default().settle(&model, &inputs_of(&parameters, 1e5, 0.0), &mut lumens).unwrap();
    assert!((lumens[2] - 0.009_149_301).abs() <= 1e-9, "{lumens:?}");
}

/// A step of a parameter for central differences.
fn step(symbol: Symbol, value: f64) -> f64 {
    match symbol {
        Symbol::Downstream => 1.0,
        Symbol::LoadShare(_) => 1e-4,
        _ => 1e-4 * value,
    }
}

/// Thesis' parameters with a share of the load for both units, so that nothing is 0 but `P_L`.
fn shared() -> Parameters {
    Parameters::thesis().set(Symbol::LoadShare(0), 0.2).unwrap()
}

#[test]
fn equilibria_move_with_every_parameter_as_differences_say() {
    // Central differences at 1e-4: measured 1.4e-7 of a parameter's largest derivative.
    const TOLERANCE: f64 = 2e-7;
    let parameters = shared();
    let inputs = inputs_of(&parameters, 4e3, 6e3);
    let lumens = settled(&parameters, &inputs);
    let model = Model::new(&parameters, Collapse::Error);
    let mut moved = 0;
    for symbol in parameters.symbols() {
        let value = parameters.get(symbol).unwrap();
        let step = step(symbol, value);
        if step == 0.0 {
            continue;
        }
        let mut exact = vec![f64::NAN; 3];
        let tangent = Tangent::new(&parameters, &[(symbol, step)]);
        assert!(Rest::default().derivatives(&model, &inputs, &lumens, &[tangent], &mut exact));
        let at = |value: f64| {
            let parameters = parameters.set(symbol, value).unwrap();
            settled(&parameters, &inputs_of(&parameters, 4e3, 6e3))
        };
        let (up, down) = (at(value + step), at(value - step));
        let scale = exact.iter().fold(1e-9, |most: f64, d| most.max(d.abs()));
        for j in 0..3 {
            let numeric = 0.5 * (up[j] - down[j]);
            assert!((numeric - exact[j]).abs() <= TOLERANCE * scale, "{symbol} {j}: {} {numeric}", exact[j]);
        }
        moved += usize::from(scale > 1e-9);
    }
    // k, A, D, L, N of three vessels, R_V and share of two units, P_H, P_L: what moves an equilibrium; mu cancels in it
    // but for R_V.
    assert!(moved >= 20, "{moved}");
}

#[test]
fn transients_move_with_every_parameter_as_differences_say() {
    // Central differences at 1e-4 of runs at 1e-12: measured 3e-8 of a parameter's largest
    // derivative; that of inertia is lost in the runs' own error. Derivatives of runs at 1e-6, by 3 and by 5 stages: a
    // quarter of what is allowed.
    const TOLERANCE: f64 = 5e-7;
    const LOOSE: f64 = 1e-4;
    // What the runs' own errors may leave.
    const RUNS: f64 = 1e-11;
    let parameters = shared();
    let model = Model::new(&parameters, Collapse::Error);
    let load = |text: &str| text.parse::<Load>().unwrap();
    let times: Vec<f64> = (0..=30).map(|k| 0.1 * k as f64).collect();
    let loads = |parameters: &Parameters| {
        Loads::on(parameters, load("ramp:2000..6000@0.05..0.35"), load("step:5000@0.5..1.75"))
    };
    let start = |parameters: &Parameters| settled(parameters, &inputs_of(parameters, 2e3, 0.0));
    let run = |parameters: &Parameters| {
        let state = State { lumens: start(parameters), rates: vec![0.0; 3] };
        let model = Model::new(parameters, Collapse::Error);
        simulate(&model, &loads(parameters), &state, &times, &SolveOptions::at(1e-12)).unwrap()
    };
    let symbols: Vec<Symbol> =
        parameters.symbols().into_iter().filter(|&s| step(s, parameters.get(s).unwrap()) != 0.0).collect();
    let tangents: Vec<Tangent> = symbols
        .iter()
        .map(|&symbol| Tangent::new(&parameters, &[(symbol, step(symbol, parameters.get(symbol).unwrap()))]))
        .collect();
    let mut first = vec![0.0; tangents.len() * 3];
    let lumens = start(&parameters);
    assert!(Rest::default().derivatives(&model, &inputs_of(&parameters, 2e3, 0.0), &lumens, &tangents, &mut first));
    let state = State { lumens, rates: vec![0.0; 3] };
    let derivatives = |options: &SolveOptions| {
        let mut variation = Variation::new(&model, &tangents, first.clone());
        variation.put_out();
        let mut out = Trajectory::default();
        let mut solver = Solver::new(&model);
        solver.run_observed(&loads(&parameters), &state, &times, options, &mut out, &mut variation).unwrap();
        assert!(variation.sound && variation.steps > 10);
        variation.into_derivatives()
    };
    let exact = derivatives(&SolveOptions::at(1e-11));
    let ninth = derivatives(&SolveOptions::at(1e-6));
    let fifth = derivatives(&SolveOptions { order: Order::Fifth, ..SolveOptions::at(1e-6) });
    let mut moved = 0;
    for (q, &symbol) in symbols.iter().enumerate() {
        let value = parameters.get(symbol).unwrap();
        let step = step(symbol, value);
        let up = run(&parameters.set(symbol, value + step).unwrap());
        let down = run(&parameters.set(symbol, value - step).unwrap());
        let place = |k: usize, j: usize| (k * symbols.len() + q) * 3 + j;
        let scale = (0..times.len()).flat_map(|k| (0..3).map(move |j| (k, j)));
        let scale = scale.fold(1e-9, |most: f64, (k, j)| most.max(exact[place(k, j)].abs()));
        for k in 0..times.len() {
            for j in 0..3 {
                let numeric = 0.5 * (up.lumens(k)[j] - down.lumens(k)[j]);
                let gap = (numeric - exact[place(k, j)]).abs();
                assert!(
                    gap <= TOLERANCE * scale + RUNS,
                    "{symbol}, time {k}, wall {j}: {} {numeric}",
                    exact[place(k, j)]
                );
                for loose in [&ninth, &fifth] {
                    let gap = (loose[place(k, j)] - exact[place(k, j)]).abs();
                    assert!(
                        gap <= LOOSE * scale + 10.0 * RUNS,
                        "{symbol}, time {k}, wall {j} at 1e-6: {gap} of {scale}"
                    );
                }
            }
        }
        moved += usize::from(scale > 1e-9);
    }
    assert!(moved >= 25, "{moved}");
}
