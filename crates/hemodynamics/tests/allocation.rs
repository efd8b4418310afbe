//! After its first run, a solver allocates nothing; a live sample never does.

use lunula_hemodynamics::{
    Collapse, Inputs, Live, Load, Loads, Model, Order, Parameters, SolveOptions, Solver, State, Trajectory,
};

#[test]
fn runs_and_samples_allocate_nothing() {
    let parameters = Parameters::thesis();
    let model = Model::new(&parameters, Collapse::Contact);
    let step: Load = "step:20000@0..2".parse().expect("a load");
    let loads = Loads::on(&parameters, step.clone(), "sine:1000+500@2".parse().expect("a load"));
    let start = State::undisplaced(&parameters);
    let times: Vec<f64> = (0..=400).map(|k| f64::from(k) * 0.01).collect();
    let (mut solver, mut out) = (Solver::new(&model), Trajectory::default());
    for order in [Order::Fifth, Order::Ninth, Order::Thirteenth] {
        let options = SolveOptions { order, ..SolveOptions::at(1e-7) };
        solver.run(&loads, &start, &times, &options, &mut out).unwrap();
        let counted = allocation_counter::measure(|| {
            solver.run(&loads, &start, &times, &options, &mut out).unwrap();
        });
        assert_eq!(counted.count_total, 0, "{order:?}");
    }
    let quiet = Inputs { upstream_pa: 1e4, ..Inputs::default() };
    let mut live = Live::new(&model, &start, &quiet, 1e-3).unwrap();
    let counted = allocation_counter::measure(|| {
        for k in 0..100 {
            live.sample(&Inputs { proximal_pa: f64::from(k) * 200.0, ..quiet }).unwrap();
        }
    });
    assert_eq!(counted.count_total, 0, "live");
}
