//! The equations as the thesis prints them: `x' = A(x) x + B(x) u` (equation 2), for two capillary units.
//!
//! In: [`Parameters`], lumens, rates, [`Inputs`]. Out: the matrices `A` and `B` in SI units, or the accelerations of
//! the walls as [`crate::Model::accelerations`] gives them. It is here as the oracle of the equations in conductances
//! and to show what it does to a solver.
//!
//! **Do not compute with it.** `R_11`, `R_22`, `B_41` and `B_51` are 1 less a fraction that goes to 1 as a capillary
//! closes, and `R_11` multiplies what is left by a resistance that grows with `d^-4`: its relative error is 1e-8 at
//! `d / D` = 0.01, 1e-4 at 1e-3, all of it at 1e-4, and below that the sign is as good as random: a damper drives. A
//! solver stalls there ([`Model::printed`]): under a distal step to 10858.037 Pa at rtol 1e-8 it takes 93 000
//! evaluations instead of 422, at 1e-10 more than a million; at 10859.04 Pa, where the capillary closes at 1.8127 s, it
//! stalls at 1.0 s or reports an open one.
//!
//! The printed `B` writes `A_V(x)` in its sixth row for the constant `A_V`; nothing else is odd, and no value differs
//! from the network of Figure 70. The thesis' distal pressure acts on the second unit only: here on each by its share
//! (0 and 1 in the thesis' table). Walls know nothing of each other in it: there is no contact.

use std::f64::consts::PI;

use crate::load::Inputs;
use crate::model::{Collapse, InputLanes, Model, contact};
use crate::parameters::{Parameters, Unit, Vessel};

/// The printed equations of two units.
#[derive(Clone, Debug)]
pub struct Printed {
    units: [Unit; 2],
    vein: Vessel,
    viscosity_pa_s: f64,
}

/// `A(x)` and `B(x)` of equation 2 for the state `[x_C1 x_C2 x_V x'_C1 x'_C2 x'_V]` and the inputs
/// `[P_H P_L P_F1 P_F2]`, SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Matrices {
    /// `A(x)`, row by row.
    pub a: [[f64; 6]; 6],
    /// `B(x)`, row by row.
    pub b: [[f64; 4]; 6],
}

/// Why there is no printed form.
#[derive(Debug, thiserror::Error, Clone, PartialEq, Eq)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum PrintedFault {
    #[error(
        "the thesis prints its equations for 2 capillary units, these parameters have {units}; use the model's own form"
    )]
    Units { units: usize },
}

impl Printed {
    /// The printed equations of these parameters. An error where there are not exactly two units.
    pub fn new(parameters: &Parameters) -> Result<Printed, PrintedFault> {
        match parameters.units() {
            &[first, second] => Ok(Printed {
                units: [first, second],
                vein: *parameters.vein(),
                viscosity_pa_s: parameters.viscosity_pa_s(),
            }),
            others => Err(PrintedFault::Units { units: others.len() }),
        }
    }

    /// The matrices at lumens `d / D` of C1, C2, V.
    pub fn matrices(&self, lumens: &[f64; 3]) -> Matrices {
        let [c1, c2] = self.units.map(|unit| unit.capillary);
        let v = self.vein;
        let [rv1, rv2] = self.units.map(|unit| unit.venule_pa_s_per_m3);
        let [ra1, ra2, rv] =
            [self.resistance(&c1, lumens[0]), self.resistance(&c2, lumens[1]), self.resistance(&v, lumens[2])];
        let total = ra1 + ra2 + rv1 + rv2 + (ra1 + rv1) * (ra2 + rv2) / rv;

        let r11 = c1.damping_n_s_per_m + c1.area_m2 * c1.area_m2 * ra1 * (1.0 - ra1 * (ra2 + rv2 + rv) / (rv * total));
        let r22 = c2.damping_n_s_per_m + c2.area_m2 * c2.area_m2 * ra2 * (1.0 - ra2 * (ra1 + rv1 + rv) / (rv * total));
        let r33 = v.damping_n_s_per_m + v.area_m2 * v.area_m2 * (ra1 + rv1) * (ra2 + rv2) / total;
        let r12 = c1.area_m2 * c2.area_m2 * ra1 * ra2 / total;
        let r13 = c1.area_m2 * v.area_m2 * ra1 * (ra2 + rv2) / total;
        let r23 = c2.area_m2 * v.area_m2 * ra2 * (ra1 + rv1) / total;

        let b41 = c1.area_m2 / c1.mass_kg * (1.0 - ra1 * (ra2 + rv2) / (rv * total));
        let b42 = c1.area_m2 * ra1 * (ra2 + rv2) / (c1.mass_kg * rv * total);
        let b51 = c2.area_m2 / c2.mass_kg * (1.0 - ra2 * (ra1 + rv1) / (rv * total));
        let b52 = c2.area_m2 * ra2 * (ra1 + rv1) / (c2.mass_kg * rv * total);
        let b61 = v.area_m2 * (ra1 + ra2 + rv1 + rv2) / (v.mass_kg * total);
        let b62 = v.area_m2 * (ra1 + rv1) * (ra2 + rv2) / (v.mass_kg * rv * total);

        let mut a = [[0.0; 6]; 6];
        for (j, (wall, row)) in [c1, c2, v].iter().zip([[r11, r12, r13], [r12, r22, r23], [r13, r23, r33]]).enumerate()
        {
            a[j][3 + j] = 1.0;
            a[3 + j][j] = -wall.stiffness_n_per_m / wall.mass_kg;
            for (k, r) in row.into_iter().enumerate() {
                a[3 + j][3 + k] = -r / wall.mass_kg;
            }
        }
        let pressed = |i: usize, wall: &Vessel| -self.units[i].load_share * wall.area_m2 / wall.mass_kg;
        let b = [
            [0.0; 4],
            [0.0; 4],
            [0.0; 4],
            [b41, b42, 0.0, pressed(0, &c1)],
            [b51, b52, 0.0, pressed(1, &c2)],
            [b61, b62, -v.area_m2 / v.mass_kg, 0.0],
        ];
        Matrices { a, b }
    }

    /// The accelerations of the lumens `v' / D`, 1/s2, at lumens `d / D` and rates `v / D` (1/s) of C1, C2, V.
    pub fn accelerations(&self, lumens: &[f64; 3], rates: &[f64; 3], inputs: &Inputs) -> [f64; 3] {
        let Matrices { a, b } = self.matrices(lumens);
        let d = [self.units[0].capillary.diameter_m, self.units[1].capillary.diameter_m, self.vein.diameter_m];
        let u = [inputs.upstream_pa, inputs.downstream_pa, inputs.proximal_pa, inputs.distal_pa];
        std::array::from_fn(|j| {
            let mut sum = 0.0;
            for k in 0..3 {
                sum += a[3 + j][k] * (d[k] * (lumens[k] - 1.0)) + a[3 + j][3 + k] * (d[k] * rates[k]);
            }
            for k in 0..4 {
                sum += b[3 + j][k] * u[k];
            }
            sum / d[j]
        })
    }

    /// Equation 1, Pa s/m3.
    fn resistance(&self, vessel: &Vessel, lumen: f64) -> f64 {
        let d = vessel.diameter_m * lumen;
        128.0 * vessel.length_m * self.viscosity_pa_s / (vessel.count * PI * ((d * d) * (d * d)))
    }
}

impl Model {
    /// The model whose accelerations are those of the printed matrices, to show what they do to a solver: its Jacobian,
    /// its pressures and the contact of walls stay those of [`Model::new`]. Never for results. An error where there are
    /// not exactly two units.
    pub fn printed(parameters: &Parameters, collapse: Collapse) -> Result<Model, PrintedFault> {
        Ok(Model { printed: Some(Printed::new(parameters)?), ..Model::new(parameters, collapse) })
    }

    /// [`Model::accelerations`] by the printed matrices.
    pub(crate) fn printed_accelerations(
        &self,
        printed: &Printed,
        lumens: &[f64],
        rates: &[f64],
        inputs: &Inputs,
        out: &mut [f64],
    ) {
        let of_three = |values: &[f64]| [values[0], values[1], values[2]];
        out.copy_from_slice(&printed.accelerations(&of_three(lumens), &of_three(rates), inputs));
        if self.collapse == Collapse::Contact {
            for (j, out) in out.iter_mut().enumerate() {
                *out += self.walls[j].spring * contact(lumens[j]);
            }
        }
    }

    /// The same in every lane, as [`Model::accelerations_in_lanes`].
    pub(crate) fn printed_in_lanes<const S: usize>(
        &self,
        printed: &Printed,
        lumens: &[[f64; S]],
        rates: &[[f64; S]],
        inputs: &InputLanes<S>,
        out: &mut [[f64; S]],
    ) {
        for lane in 0..S {
            let of_lane = |values: &[[f64; S]]| [values[0][lane], values[1][lane], values[2][lane]];
            let mut own = [0.0; 3];
            self.printed_accelerations(printed, &of_lane(lumens), &of_lane(rates), &inputs.lane(lane), &mut own);
            for (out, own) in out.iter_mut().zip(own) {
                out[lane] = own;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Arrow, Load, Loads, Site, SolveFault, SolveOptions, State, Trajectory, simulate};

    const INPUTS: Inputs = Inputs { upstream_pa: 1e4, downstream_pa: 300.0, proximal_pa: 3e3, distal_pa: 5e3 };

    /// Parameters of which no two are alike.
    fn uneven() -> Parameters {
        let mut parameters = Parameters::thesis();
        for (k, symbol) in parameters.symbols().into_iter().enumerate() {
            let value = parameters.get(symbol).expect("its own symbol");
            parameters = parameters.set(symbol, value * (1.0 + 0.01 * (k as f64))).expect("still positive");
        }
        parameters.set("share_1".parse().expect("a name"), 0.2).expect("a share")
    }

    #[test]
    fn is_the_form_in_conductances_for_open_vessels() {
        // Relative to the largest term of a wall's balance; measured 2.2e-16.
        const TOLERANCE: f64 = 4e-15;
        for parameters in [Parameters::thesis(), uneven()] {
            let (printed, model) = (Printed::new(&parameters).unwrap(), Model::new(&parameters, Collapse::Error));
            for lumens in [[1.9, 1.9, 2.0], [1.0, 0.7, 1.1], [2.5, 3.0, 0.6]] {
                for rates in [[0.0; 3], [3.0, -8.0, 1.5], [-40.0, 5.0, 0.1]] {
                    let mut own = [0.0; 3];
                    model.accelerations(&lumens, &rates, &INPUTS, &mut own);
                    let of_print = printed.accelerations(&lumens, &rates, &INPUTS);
                    for j in 0..3 {
                        let wall = &model.walls[j];
                        let scale = wall.push * 1e4 + wall.spring * lumens[j] + wall.damper * rates[j].abs();
                        let gap = (own[j] - of_print[j]).abs() / scale;
                        assert!(gap <= TOLERANCE, "wall {j} at {lumens:?}, {rates:?}: {gap}");
                    }
                }
            }
        }
    }

    #[test]
    fn loses_its_digits_then_its_sign_as_a_capillary_closes() {
        let parameters = Parameters::thesis().set("b_C1_N_s_per_m".parse().unwrap(), 0.0).unwrap();
        let (printed, model) = (Printed::new(&parameters).unwrap(), Model::new(&parameters, Collapse::Error));
        let mut arrow = Arrow::default();
        let mut lost = |lumen: f64| {
            let lumens = [lumen, 1.9, 1.1];
            model.jacobian(&lumens, &[0.0; 3], &INPUTS, &mut arrow);
            let exact = arrow.by_rate[0] + arrow.by_pressure[0] * arrow.pressure_by_rate[0];
            printed.matrices(&lumens).a[3][3] / exact - 1.0
        };
        for (lumen, least, most) in [(1.0, 0.0, 1e-14), (1e-2, 1e-9, 1e-7), (1e-3, 1e-5, 1e-3)] {
            let error = lost(lumen).abs();
            assert!((least..=most).contains(&error), "{lumen}: {error:e}");
        }
        // At 1e-4 a rounding is as large as what is left: nothing, or nearly twice as much. At 5e-5 a damper may drive
        // (52 of 100 here).
        assert!(lost(1e-4).abs() >= 0.5);
        let turned = (0..100).filter(|k| lost(5e-5 * (1.0 + 0.01 * f64::from(*k))) < -1.0).count();
        assert!((5..95).contains(&turned), "{turned} of 100 turned");
    }

    /// A distal load from 0 s on, from the equilibrium without load, by the equations in conductances and by the
    /// printed ones.
    fn pressed(load: f64, options: &SolveOptions) -> [Result<Trajectory, SolveFault>; 2] {
        let parameters = Parameters::thesis();
        let constant = |value| Load::constant(value).expect("a number");
        let loads = Loads::on(&parameters, constant(0.0), constant(load));
        let lumens = vec![1.927_397_108_816_434_3, 1.927_397_108_816_434_3, 2.076_925_007_320_9];
        let rest = State { lumens, rates: vec![0.0; 3] };
        let printed = Model::printed(&parameters, Collapse::Error).expect("two units");
        [Model::new(&parameters, Collapse::Error), printed]
            .map(|model| simulate(&model, &loads, &rest, &[0.0, 0.5, 4.0], options))
    }

    #[test]
    fn a_solver_gives_the_same_by_it_for_open_vessels() {
        // Measured 2.3e-16 D.
        let [own, printed] = pressed(5000.0, &SolveOptions::at(1e-10)).map(|run| run.unwrap().state(2));
        for (own, printed) in own.lumens.iter().zip(&printed.lumens) {
            assert!((own - printed).abs() <= 1e-12, "{own} {printed}");
        }
    }

    #[test]
    fn a_solver_stalls_on_it_as_a_capillary_closes() {
        // C2 narrows to d / D = 1.0001e-4. Measured at 1e-8: 422 evaluations, 93 000 by the printed form; at 1e-10: 665
        // and more than 1e6.
        let options = SolveOptions { most_evaluations: 20_000, ..SolveOptions::at(1e-8) };
        let [own, printed] = pressed(10858.037, &options);
        assert!(own.unwrap().statistics().evaluations <= 1000);
        assert!(matches!(printed, Err(SolveFault::Work { .. })), "{printed:?}");
    }

    #[test]
    fn a_solver_does_not_find_a_closing_vessel_by_it() {
        // There is no equilibrium with open vessels; C2 closes at 1.8127 s. By the printed form no run said so: most
        // stall at 1.0 s.
        let options = SolveOptions { most_evaluations: 20_000, ..SolveOptions::at(1e-6) };
        let [own, printed] = pressed(10859.04, &options);
        assert!(matches!(own, Err(SolveFault::Collapsed { site: Site::Capillary(1), .. })), "{own:?}");
        assert!(!matches!(printed, Err(SolveFault::Collapsed { .. })), "{printed:?}");
    }

    #[test]
    fn is_for_two_units_only() {
        for units in [1, 3] {
            let fault = Printed::new(&Parameters::along_nail(units).unwrap()).unwrap_err();
            assert_eq!(fault, PrintedFault::Units { units });
        }
    }
}
