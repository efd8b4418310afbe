//! A solver and a trajectory that are used again keep their memory.

use lunula_hemodynamics::{Collapse, Model, Parameters, SolveOptions, Solver, Trajectory};

use super::{loads, rest};

#[test]
fn a_trajectory_used_again_stands_where_it_stood() {
    let mut solver = Solver::new(&Model::new(&Parameters::thesis(), Collapse::Error));
    let mut out = Trajectory::default();
    let times: Vec<f64> = (0..=400).map(|k| f64::from(k) * 0.01).collect();
    let loads = loads("step:5000@0..2", "0");
    solver.run(&loads, &rest(), &times, &SolveOptions::at(1e-6), &mut out).unwrap();
    let (first, at) = (out.clone(), out.lumens(0).as_ptr());
    solver.run(&loads, &rest(), &times, &SolveOptions::at(1e-6), &mut out).unwrap();
    assert_eq!(out, first);
    assert_eq!(out.lumens(0).as_ptr(), at);
}
