//! The equations against exact rational arithmetic: doubles are rationals, and the network of Figure 70 is solved node
//! by node in them.
//!
//! Entries of the matrices (`R_ij`, `B_ij`) are held to a relative gap. Pressures, accelerations and derivatives by
//! lumens may cancel in truth (a wall at rest has no acceleration): their gap is relative to the sum of the magnitudes
//! of the terms that make them up.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod draw;
mod network;
mod number;
mod printed;

use draw::Draw;
use lunula_hemodynamics::{Arrow, Collapse, Inputs, Model, Parameters};
use network::{Moment, accelerations, pressures};
use num_rational::BigRational;
use num_traits::{One, Signed, ToPrimitive, Zero};
use number::{Dual, exact, gap};

/// All of what follows; measured over 120 cases: R_ij 6.4e-16, B_ij 7.0e-16, pressures 6.9e-16, accelerations 7.2e-16,
/// by lumens 1.3e-15.
const TOLERANCE: f64 = 4e-15;
const CASES: usize = 40;
const TOUCH: f64 = 0.05;

fn worse(worst: &mut f64, now: f64) {
    assert!(now.is_finite());
    *worst = worst.max(now);
}

/// The moment whose pressures are the sums of the magnitudes of the terms of this one's: they fall with every rate and
/// rise with every input.
fn magnitudes(lumens: &[f64], rates: &[f64], inputs: &Inputs) -> Moment {
    let against: Vec<f64> = rates.iter().map(|w| -w.abs()).collect();
    let up = Inputs { upstream_pa: inputs.upstream_pa.abs(), downstream_pa: inputs.downstream_pa.abs(), ..*inputs };
    Moment::new(lumens, &against, &up)
}

/// Everything of a case, and the sums of magnitudes.
struct Case {
    parameters: Parameters,
    lumens: Vec<f64>,
    rates: Vec<f64>,
    inputs: Inputs,
    /// Of the pressures.
    sums: Vec<BigRational>,
}

fn case(draw: &mut Draw, units: usize) -> Case {
    let parameters = draw.parameters(units);
    let (lumens, rates) = (draw.lumens(units + 1), draw.rates(units + 1));
    let inputs = draw.inputs(&parameters);
    let sums = pressures(&parameters, &magnitudes(&lumens, &rates, &inputs));
    let sums = sums.into_iter().map(|p| p.value).collect();
    Case { parameters, lumens, rates, inputs, sums }
}

fn cases() -> impl Iterator<Item = Case> {
    let mut draw = Draw(6);
    (0..CASES).map(move |k| case(&mut draw, if k % 8 == 7 { 3 } else { 2 }))
}

impl Case {
    /// The sum of the magnitudes of the terms of wall `j`'s acceleration.
    fn acceleration(&self, j: usize) -> BigRational {
        let wall = self.parameters.wall(j);
        let outside = match self.parameters.units().get(j) {
            Some(unit) => unit.load_share * self.inputs.distal_pa,
            None => self.inputs.proximal_pa,
        };
        let d = exact(wall.diameter_m);
        let near = (exact(TOUCH / self.lumens[j]) - BigRational::one()).max(BigRational::zero());
        let spring = (exact(self.lumens[j]) - BigRational::one()).abs() + &near * &near * &near;
        let force = exact(wall.area_m2) * (&self.sums[j] + exact(outside.abs()))
            + exact(wall.stiffness_n_per_m) * &d * spring
            + exact(wall.damping_n_s_per_m) * &d * exact(self.rates[j].abs());
        force / (exact(wall.mass_kg) * d)
    }
}

#[test]
fn pressures_and_accelerations() {
    let (mut of_pressures, mut of_accelerations) = (0.0, 0.0);
    let mut checked = 0;
    for case in cases() {
        let moment = Moment::new(&case.lumens, &case.rates, &case.inputs);
        let wanted = pressures(&case.parameters, &moment);
        let found = Model::new(&case.parameters, Collapse::Error).pressures(&case.lumens, &case.rates, &case.inputs);
        let found = found.capillary_pa.iter().chain([&found.venous_pa]);
        for ((found, wanted), sum) in found.zip(&wanted).zip(&case.sums) {
            worse(&mut of_pressures, gap(*found, &wanted.value, sum));
        }
        for (collapse, touch) in [(Collapse::Error, None), (Collapse::Contact, Some(TOUCH))] {
            let wanted = accelerations(&case.parameters, &moment, touch);
            let mut found = vec![0.0; case.lumens.len()];
            Model::new(&case.parameters, collapse).accelerations(&case.lumens, &case.rates, &case.inputs, &mut found);
            for (j, (found, wanted)) in found.iter().zip(&wanted).enumerate() {
                worse(&mut of_accelerations, gap(*found, &wanted.value, &case.acceleration(j)));
                checked += 1;
            }
        }
    }
    println!("pressures {of_pressures:.1e}, accelerations {of_accelerations:.1e}");
    assert_eq!(checked, 2 * (3 * CASES + CASES / 8));
    assert!(of_pressures <= TOLERANCE);
    assert!(of_accelerations <= TOLERANCE);
}

/// The derivatives of all accelerations by lumen or rate `k`, exact.
fn column(case: &Case, which: usize, k: usize) -> Vec<BigRational> {
    let mut moment = Moment::new(&case.lumens, &case.rates, &case.inputs);
    let side = if which == 0 { &mut moment.lumens } else { &mut moment.rates };
    side[k].slope = BigRational::one();
    accelerations(&case.parameters, &moment, Some(TOUCH)).into_iter().map(|w| w.slope).collect()
}

/// The sum of the magnitudes of the terms of `d w'_i / d l_k`, in doubles (it is a scale): with `t`, `G`, `G_t` of the
/// module's head in `model`, `P_V` falls or rises with a lumen by its conductance's slope times a drop of pressure,
/// whose terms are added.
fn by_lumen(case: &Case, i: usize, k: usize) -> BigRational {
    let (p, n) = (&case.parameters, case.lumens.len() - 1);
    let conductance = |j: usize| {
        let d = p.wall(j).diameter_m * case.lumens[j];
        p.wall(j).count * std::f64::consts::PI * d.powi(4) / (128.0 * p.wall(j).length_m * p.viscosity_pa_s())
    };
    let venule = |j: usize| p.units()[j].venule_pa_s_per_m3;
    let t = |j: usize| if j < n { 1.0 + conductance(j) * venule(j) } else { 1.0 };
    let total: f64 = (0..=n).map(|j| conductance(j) / t(j)).sum();
    let slope = 4.0 * conductance(k) / case.lumens[k];
    let venous = case.sums[n].to_f64().unwrap();
    let drop = if k < n {
        let taken = venule(k) * p.wall(k).area_m2 * p.wall(k).diameter_m * case.rates[k].abs();
        (case.inputs.upstream_pa + venous + taken) / t(k)
    } else {
        venous + case.inputs.downstream_pa
    };
    let wall = p.wall(i);
    let push = wall.area_m2 / (wall.mass_kg * wall.diameter_m);
    let mut sum = push / t(i) * slope * drop / (t(k) * total);
    if i == k {
        let near = (TOUCH / case.lumens[k] - 1.0).max(0.0);
        let contact = 3.0 * near * near * TOUCH / (case.lumens[k] * case.lumens[k]);
        sum += wall.stiffness_n_per_m / wall.mass_kg * (1.0 + contact);
        sum += if k < n { push * venule(k) * slope * drop / t(k) } else { 0.0 };
    }
    exact(sum)
}

#[test]
fn jacobian() {
    let (mut of_lumens, mut of_rates) = (0.0, 0.0);
    let mut checked = 0;
    for case in cases() {
        let mut arrow = Arrow::default();
        let model = Model::new(&case.parameters, Collapse::Contact);
        model.jacobian(&case.lumens, &case.rates, &case.inputs, &mut arrow);
        let walls = case.lumens.len();
        for k in 0..walls {
            let (by_lumens, by_rates) = (column(&case, 0, k), column(&case, 1, k));
            for i in 0..walls {
                let own = |values: &[f64]| if i == k { values[i] } else { 0.0 };
                let found = own(&arrow.by_lumen) + arrow.by_pressure[i] * arrow.pressure_by_lumen[k];
                worse(&mut of_lumens, gap(found, &by_lumens[i], &by_lumen(&case, i, k)));
                // -R_ik / m_i, scaled: a relative gap.
                let found = own(&arrow.by_rate) + arrow.by_pressure[i] * arrow.pressure_by_rate[k];
                worse(&mut of_rates, gap(found, &by_rates[i], &by_rates[i]));
                checked += 1;
            }
        }
    }
    println!("by lumens {of_lumens:.1e}, by rates (entries R_ij) {of_rates:.1e}");
    assert_eq!(checked, 9 * (CASES - CASES / 8) + 16 * (CASES / 8));
    assert!(of_lumens <= TOLERANCE);
    assert!(of_rates <= TOLERANCE);
}

#[test]
fn input_matrix() {
    let mut worst = 0.0;
    for case in cases() {
        let still = vec![0.0; case.lumens.len()];
        let model = Model::new(&case.parameters, Collapse::Error);
        for (upstream_pa, downstream_pa) in [(1.0, 0.0), (0.0, 1.0)] {
            let inputs = Inputs { upstream_pa, downstream_pa, ..Inputs::default() };
            // m B / A, a relative gap.
            let wanted = pressures(&case.parameters, &Moment::new(&case.lumens, &still, &inputs));
            let found = model.pressures(&case.lumens, &still, &inputs);
            for (found, wanted) in found.capillary_pa.iter().chain([&found.venous_pa]).zip(&wanted) {
                worse(&mut worst, gap(*found, &wanted.value, &wanted.value));
            }
        }
    }
    println!("entries B_ij {worst:.1e}");
    assert!(worst <= TOLERANCE);
}

#[test]
fn the_printed_matrices_are_the_network_exactly() {
    let mut draw = Draw(2);
    for _ in 0..20 {
        let case = case(&mut draw, 2);
        let p = &case.parameters;
        let printed = printed::printed(p, &case.lumens);
        let value = |x: f64| exact(x);
        let wanted = accelerations(p, &Moment::new(&case.lumens, &case.rates, &case.inputs), None);
        for (j, wanted) in wanted.iter().enumerate() {
            let wall = p.wall(j);
            let (m, d) = (value(wall.mass_kg), value(wall.diameter_m));
            let displacement = &d * (value(case.lumens[j]) - BigRational::one());
            let mut sum = -value(wall.stiffness_n_per_m) / &m * displacement;
            for k in 0..3 {
                sum -= &printed.r[j][k] / &m * value(p.wall(k).diameter_m) * value(case.rates[k]);
            }
            sum +=
                &printed.b[j][0] * value(case.inputs.upstream_pa) + &printed.b[j][1] * value(case.inputs.downstream_pa);
            let outside = match p.units().get(j) {
                Some(unit) => value(unit.load_share) * value(case.inputs.distal_pa),
                None => value(case.inputs.proximal_pa),
            };
            sum -= value(wall.area_m2) / &m * outside;
            assert_eq!(sum / d, wanted.value, "wall {j}");
        }
    }
}

#[test]
fn exact_derivatives_are_derivatives() {
    // The oracle's own check: (x^2 / (1 - x))' = (2 x - x^2) / (1 - x)^2 at 3 is -3 / 4.
    let x = Dual { value: exact(3.0), slope: BigRational::one() };
    let found = &(&x * &x) / &(&Dual::of(1.0) - &x);
    assert_eq!((found.value, found.slope), (exact(-4.5), exact(-0.75)));
}
