//! Error and time of the reduced models beside the full one, on 20 step responses of the thesis' table (1000 to 10 000 Pa from 0 to 2 s,
//! proximal and both, 400 outputs over 4 s).
//!
//! `cargo run --release -p lunula-hemodynamics --example reduced`

use std::error::Error;
use std::time::Instant;

use lunula_hemodynamics::{
    Collapse, Inertia, Load, Loads, Model, Parameters, SolveOptions, State, Trajectory, simulate, simulate_reduced,
};

/// Runs of which the fastest counts.
const TRIES: usize = 20;

fn main() -> Result<(), Box<dyn Error>> {
    let parameters = Parameters::thesis();
    let model = Model::new(&parameters, Collapse::Error);
    let none = Loads::on(&parameters, Load::constant(0.0)?, Load::constant(0.0)?);
    let near = State { lumens: vec![1.9273971, 1.9273971, 2.076925], rates: vec![0.0; 3] };
    let rest = simulate(&model, &none, &near, &[0.0, 100.0], &SolveOptions::at(1e-12))?.state(1);
    let times: Vec<f64> = (0..=400).map(|k| 0.01 * f64::from(k)).collect();
    let mut cases = Vec::new();
    for k in 1..=10 {
        let step = Load::step(1000.0 * f64::from(k), 0.0, 2.0)?;
        cases.push(Loads::on(&parameters, step.clone(), Load::constant(0.0)?));
        cases.push(Loads::on(&parameters, step.clone(), step));
    }
    let exact: Vec<Trajectory> = cases
        .iter()
        .map(|loads| simulate(&model, loads, &rest, &times, &SolveOptions::at(1e-13)))
        .collect::<Result<_, _>>()?;
    println!("model      rtol   error/D  told     steps  evaluations  us a response");
    for inertia in [Inertia::Full, Inertia::Dropped, Inertia::Corrected] {
        for rtol in [1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8] {
            let options = SolveOptions::at(rtol);
            let (mut error, mut told) = (0.0_f64, 0.0_f64);
            let (mut steps, mut evaluations) = (0, 0);
            for (loads, exact) in cases.iter().zip(&exact) {
                let run = simulate_reduced(&model, loads, &rest, &times, &options, inertia)?;
                told = told.max(run.model_error);
                steps += run.trajectory.statistics().steps;
                evaluations += run.trajectory.statistics().evaluations;
                for k in 0..times.len() {
                    for (own, exact) in run.trajectory.lumens(k).iter().zip(exact.lumens(k)) {
                        error = error.max((own - exact).abs());
                    }
                }
            }
            let mut best = f64::INFINITY;
            for _ in 0..TRIES {
                let begun = Instant::now();
                for loads in &cases {
                    simulate_reduced(&model, loads, &rest, &times, &options, inertia)?;
                }
                best = best.min(begun.elapsed().as_secs_f64());
            }
            let each = cases.len() as f64;
            println!(
                "{:<9} {rtol:>6.0e}  {error:8.1e}  {told:7.1e}  {:5.0}  {:11.0}  {:6.1}",
                format!("{inertia:?}"),
                steps as f64 / each,
                evaluations as f64 / each,
                1e6 * best / each
            );
        }
    }
    Ok(())
}
