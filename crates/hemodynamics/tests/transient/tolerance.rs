//! The error is within the tolerance, at every tolerance, with every order.

use lunula_hemodynamics::{Collapse, Loads, Model, Order, Parameters, SolveOptions, Solver, Trajectory};

use super::reference::{Row, responses};
use super::{loads, rest};

/// What the reference and 4 s of sums in doubles leave at the finest tolerance, over D; measured 2e-14.
const FLOOR: f64 = 5e-14;

fn worst(solver: &mut Solver, loads: &Loads, rows: &[Row], options: &SolveOptions, out: &mut Trajectory) -> f64 {
    let times: Vec<f64> = rows.iter().map(|row| row.0).collect();
    solver.run(loads, &rest(), &times, options, out).expect("a response of the reference");
    let mut worst = 0.0;
    for (k, (_, exact)) in rows.iter().enumerate() {
        for (lumen, exact) in out.lumens(k).iter().zip(exact) {
            let error = ((lumen - 1.0) - exact).abs();
            worst = if error <= worst { worst } else { error };
        }
    }
    worst
}

#[test]
fn every_tolerance_holds_on_every_response_with_every_order() {
    let mut solver = Solver::new(&Model::new(&Parameters::thesis(), Collapse::Error));
    let mut out = Trajectory::default();
    let mut cases = Vec::new();
    for (kind, table) in [
        include_str!("../reference/proximal.csv"),
        include_str!("../reference/both.csv"),
        include_str!("../reference/distal.csv"),
    ]
    .into_iter()
    .enumerate()
    {
        for (load_pa, rows) in responses(table) {
            let step = format!("step:{load_pa}@0..2");
            let (proximal, distal) = [(step.as_str(), "0"), (&step, &step), ("0", &step)][kind];
            cases.push((loads(proximal, distal), rows));
        }
    }
    assert_eq!(cases.len(), 30);
    let mut ran = 0;
    for exponent in 3..=12 {
        for order in [Order::Auto, Order::Fifth, Order::Ninth, Order::Thirteenth] {
            if order == Order::Fifth && exponent > 8 {
                continue;
            }
            let options = SolveOptions { order, ..SolveOptions::at(10f64.powi(-exponent)) };
            let mut most = 0.0_f64;
            for (case, (loads, rows)) in cases.iter().enumerate() {
                let error = worst(&mut solver, loads, rows, &options, &mut out);
                most = most.max(error);
                assert!(error <= options.rtol + FLOOR, "case {case}, {order:?}, {:e}: {error:e}", options.rtol);
                ran += 1;
            }
            println!("{order:?}, {:e}: {most:e} at most", options.rtol);
        }
    }
    assert_eq!(ran, 30 * (10 * 3 + 6));
}

#[test]
fn close_to_a_fold_a_thousand_evaluations_are_enough() {
    let mut solver = Solver::new(&Model::new(&Parameters::thesis(), Collapse::Error));
    let mut out = Trajectory::default();
    let [(load_pa, rows)]: [_; 1] = responses(include_str!("../reference/near_collapse.csv")).try_into().unwrap();
    let loads = loads("0", &format!("step:{load_pa}@0..2"));
    for (rtol, most) in [(1e-6, 999), (1e-9, 2000), (1e-12, 4000)] {
        let error = worst(&mut solver, &loads, &rows, &SolveOptions::at(rtol), &mut out);
        let statistics = out.statistics();
        println!("{rtol:e}: {error:e}, {statistics:?}");
        // The lumen of C2 falls to 1e-4: rounding of the parameters moves it by 1e-13.
        assert!(error <= rtol + 1e-12, "{rtol:e}: {error:e}");
        assert!(statistics.evaluations <= most, "{rtol:e}: {statistics:?}");
    }
}

#[test]
fn contact_holds_its_tolerance() {
    let mut solver = Solver::new(&Model::new(&Parameters::thesis(), Collapse::Contact));
    let mut out = Trajectory::default();
    let [(load_pa, rows)]: [_; 1] = responses(include_str!("../reference/contact.csv")).try_into().unwrap();
    let loads = loads(&format!("step:{load_pa}@0..2"), "0");
    for exponent in 3..=12 {
        let options = SolveOptions::at(10f64.powi(-exponent));
        let error = worst(&mut solver, &loads, &rows, &options, &mut out);
        println!("{exponent} {error:e} {:?}", out.statistics());
        assert!(error <= options.rtol + FLOOR, "{:e}: {error:e}", options.rtol);
    }
}
