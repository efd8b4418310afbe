//! The transient solver against diffsol's BDF, which shares no code with it but the Jacobian:
//! `cargo test -p lunula-hemodynamics-peer`.

use lunula_hemodynamics::{Collapse, Load, Loads, Model, Parameters, SolveOptions, State, simulate};

use lunula_hemodynamics_peer::{Peer, Step, bdf};

/// `|x - x_diffsol| / D` where diffsol is asked for 1e-10; measured 6e-9, nearly all of it diffsol's (that crate's
/// tests/reference).
const TOLERANCE: f64 = 3e-8;

#[test]
fn step_responses_are_those_of_diffsol() {
    let parameters = Parameters::thesis();
    let model = Model::new(&parameters, Collapse::Error);
    let rest = State {
        lumens: vec![1.927_397_108_816_434_3, 1.927_397_108_816_434_3, 2.076_925_007_320_9],
        rates: vec![0.0; 3],
    };
    let times: Vec<f64> = (1..=40).map(|k| 0.1 * f64::from(k)).collect();
    for (proximal_pa, distal_pa) in [(1000.0, 0.0), (8000.0, 0.0), (0.0, 9000.0), (6000.0, 6000.0)] {
        let step = |height| Load::step(height, 0.0, 2.0).expect("a load");
        let loads = Loads::on(&parameters, step(proximal_pa), step(distal_pa));
        let options = SolveOptions { start_s: Some(0.0), ..SolveOptions::at(1e-10) };
        let ours = simulate(&model, &loads, &rest, &times, &options).expect("no vessel closes");
        let mut theirs = Vec::new();
        let peer = Peer { rest: &rest, rates: 1e4 };
        bdf(&peer, Step { proximal_pa, distal_pa }, 1e-10, &times, &mut theirs).expect("diffsol comes through");
        assert_eq!(theirs.len(), times.len());
        for (k, theirs) in theirs.iter().enumerate() {
            for (j, theirs) in theirs.iter().enumerate() {
                let gap = (ours.lumens(k)[j] - theirs).abs();
                assert!(gap <= TOLERANCE, "{proximal_pa}, {distal_pa} Pa, wall {j} at {} s: {gap:e}", times[k]);
            }
        }
    }
}
