//! Transients against the reference trajectories of tests/reference, where vessels close, and where input is extreme.

mod closing;
mod extremes;
mod live;
mod order;
mod random;
mod reference;
mod tolerance;

use lunula_hemodynamics::{Load, Loads, Parameters, State, Trajectory};

/// The state of no load, as in the reference tables.
pub(crate) fn rest() -> State {
    State { lumens: vec![1.927_397_108_816_434_3, 1.927_397_108_816_434_3, 2.076_925_007_320_9], rates: vec![0.0; 3] }
}

/// The largest difference of two runs' lumens; NaN is kept.
pub(crate) fn distance(a: &Trajectory, b: &Trajectory) -> f64 {
    assert_eq!(a.len(), b.len());
    let all = |t: &Trajectory| (0..t.len()).flat_map(|k| t.lumens(k).to_vec()).collect::<Vec<f64>>();
    all(a).iter().zip(all(b)).fold(0.0, |most, (a, b)| if (a - b).abs() <= most { most } else { (a - b).abs() })
}

pub(crate) fn is_open(run: &Trajectory) -> bool {
    (0..run.len()).all(|k| run.lumens(k).iter().all(|&lumen| lumen > 0.0))
}

pub(crate) fn load(text: &str) -> Load {
    text.parse().expect(text)
}

/// Pressures on the two surfaces over the blood pressures of the thesis.
pub(crate) fn loads(proximal: &str, distal: &str) -> Loads {
    Loads::on(&Parameters::thesis(), load(proximal), load(distal))
}
