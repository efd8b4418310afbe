//! The network of Figure 70 in exact arithmetic, straight from its nodes: what flows into a node flows out of it or
//! widens its wall.
//!
//! `(P_H - P_Ci) G_Ai = A_Ci v_Ci + (P_Ci - P_V) / R_Vi` at each capillary,
//! `sum (P_Ci - P_V) / R_Vi = A_V v_V + (P_V - P_L) G_V` at the vein, solved by elimination; then
//! `m v' = A (P - P_ext) - k x - b v` at every wall. Pi is taken to 60 digits.

use lunula_hemodynamics::{Inputs, Parameters, Vessel};
use num_rational::BigRational;
use num_traits::{Signed, Zero};

use crate::number::{Dual, exact};

const PI: &str = "314159265358979323846264338327950288419716939937510582097494";

pub(crate) fn pi() -> BigRational {
    let ten = BigRational::from_integer(10.into());
    BigRational::from_integer(PI.parse().expect("digits")) / num_traits::pow(ten, PI.len() - 1)
}

/// Equation 1, `d` the lumen in metres.
pub(crate) fn resistance(vessel: &Vessel, viscosity_pa_s: f64, d: &Dual) -> Dual {
    let above = exact(128.0) * exact(vessel.length_m) * exact(viscosity_pa_s);
    let square = d * d;
    &Dual::constant(above / (exact(vessel.count) * pi())) / &(&square * &square)
}

/// A moment: lumens over nominal diameters and rates, each with a slope.
pub(crate) struct Moment {
    pub(crate) lumens: Vec<Dual>,
    pub(crate) rates: Vec<Dual>,
    pub(crate) inputs: [Dual; 4],
}

impl Moment {
    pub(crate) fn new(lumens: &[f64], rates: &[f64], inputs: &Inputs) -> Moment {
        let inputs = [inputs.upstream_pa, inputs.downstream_pa, inputs.proximal_pa, inputs.distal_pa];
        let of = |values: &[f64]| values.iter().map(|&x| Dual::of(x)).collect();
        Moment { lumens: of(lumens), rates: of(rates), inputs: inputs.map(Dual::of) }
    }

    /// What the wall takes up, `q = A v`.
    fn flow(&self, walls: &[&Vessel], j: usize) -> Dual {
        let swept = exact(walls[j].area_m2) * exact(walls[j].diameter_m);
        &Dual::constant(swept) * &self.rates[j]
    }
}

/// Blood pressures of all walls, Pa.
pub(crate) fn pressures(parameters: &Parameters, moment: &Moment) -> Vec<Dual> {
    let walls: Vec<&Vessel> = parameters.walls().collect();
    let n = walls.len() - 1;
    let one = Dual::of(1.0);
    let mu = parameters.viscosity_pa_s();
    let conductance = |j: usize| {
        let d = &Dual::of(walls[j].diameter_m) * &moment.lumens[j];
        &one / &resistance(walls[j], mu, &d)
    };
    let mut rows = vec![vec![Dual::of(0.0); n + 2]; n + 1];
    for (i, unit) in parameters.units().iter().enumerate() {
        let (g, venule) = (conductance(i), &one / &Dual::of(unit.venule_pa_s_per_m3));
        rows[i][i] = &g + &venule;
        rows[i][n] = -&venule;
        rows[i][n + 1] = &(&g * &moment.inputs[0]) - &moment.flow(&walls, i);
        rows[n][i] = venule.clone();
        rows[n][n] = &rows[n][n] - &venule;
    }
    let g = conductance(n);
    rows[n][n] = &rows[n][n] - &g;
    rows[n][n + 1] = &moment.flow(&walls, n) - &(&g * &moment.inputs[1]);
    solve(rows)
}

/// Gauss' elimination.
fn solve(mut rows: Vec<Vec<Dual>>) -> Vec<Dual> {
    let n = rows.len();
    for k in 0..n {
        let (head, below) = rows.split_at_mut(k + 1);
        let pivot = &head[k];
        for row in below.iter_mut().filter(|row| !row[k].value.is_zero() || !row[k].slope.is_zero()) {
            let factor = &row[k] / &pivot[k];
            for j in k..=n {
                row[j] = &row[j] - &(&factor * &pivot[j]);
            }
        }
    }
    let mut x = vec![Dual::of(0.0); n];
    for k in (0..n).rev() {
        let known = (k + 1..n).fold(rows[k][n].clone(), |sum, j| &sum - &(&rows[k][j] * &x[j]));
        x[k] = &known / &rows[k][k];
    }
    x
}

/// Accelerations of the lumens `v' / D`, 1/s2, by the walls' pressures; `touch` is `d_c / D` of the contact law.
pub(crate) fn accelerations(parameters: &Parameters, moment: &Moment, touch: Option<f64>) -> Vec<Dual> {
    let blood = pressures(parameters, moment);
    let one = Dual::of(1.0);
    parameters
        .walls()
        .enumerate()
        .map(|(j, wall)| {
            let outside = match parameters.units().get(j) {
                Some(unit) => &Dual::of(unit.load_share) * &moment.inputs[3],
                None => moment.inputs[2].clone(),
            };
            let d = Dual::of(wall.diameter_m);
            let mut force = &Dual::of(wall.area_m2) * &(&blood[j] - &outside);
            force = &force - &(&(&Dual::of(wall.stiffness_n_per_m) * &d) * &(&moment.lumens[j] - &one));
            force = &force - &(&(&Dual::of(wall.damping_n_s_per_m) * &d) * &moment.rates[j]);
            let near = &(&Dual::of(touch.unwrap_or(0.0)) / &moment.lumens[j]) - &one;
            if near.value.is_positive() {
                let cube = &(&near * &near) * &near;
                force = &force + &(&(&Dual::of(wall.stiffness_n_per_m) * &d) * &cube);
            }
            &force / &(&Dual::of(wall.mass_kg) * &d)
        })
        .collect()
}
