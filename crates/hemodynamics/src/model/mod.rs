//! The equations of section 4.3.2 in the form that does not cancel.
//!
//! In: [`Parameters`], a state (lumens `l = d / D` and rates `w = v / D` of the walls), the [`Inputs`] at that moment.
//! Out: blood pressures, accelerations of the walls, their Jacobian.
//!
//! The printed matrices `A(x)`, `B(x)` (equation 2) follow from the network of Figure 70, but subtract resistances that
//! grow without bound as a capillary closes. In conductances nothing does: `G = d^4 / c` with `c = 128 L mu / (N pi)`
//! (equation 1), `t_i = 1 + G_Ai R_Vi`, `s_i = G_Ai / t_i`, `G_t = s_1 + s_2 + .. + G_V`, `q = A v`,
//!
//! `P_V = (sum s_i P_H + G_V P_L - sum q_i / t_i - q_V) / G_t`, `P_Ci = (R_Vi (G_Ai P_H - q_i) + P_V) / t_i`,
//!
//! and each wall moves by `m v' = A (P - P_ext) - k x - b v`, with the external pressure `share_i P_F2` on a capillary
//! and `P_F1` on the vein. Only where all lumens are exactly 0 is there no answer. The capillaries act on each other
//! through `P_V` alone, so the Jacobian is diagonal but for a product of two vectors ([`Arrow`]).

mod arrow;
mod by_parameter;
mod contact;
mod lanes;
mod printed;

use std::f64::consts::PI;

pub use arrow::Arrow;
pub(crate) use by_parameter::{Currents, Tangent};
pub(crate) use contact::{TOUCH, contact, contact_slope};
pub(crate) use lanes::{InputLanes, Scratch};
pub use printed::{Matrices, Printed, PrintedFault};

use crate::load::Inputs;
use crate::parameters::Parameters;

/// What happens where a vessel closes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Collapse {
    /// A closed vessel ends the run: the thesis' walls know nothing of each other.
    #[default]
    Error,
    /// Opposite walls push each other apart below a twentieth of the nominal diameter: `k D (d_c / d - 1)^3` with
    /// `d_c = 0.05 D` is added to the wall's force, zero above `d_c` and with the exponent of the tube law of deep
    /// collapse below it (Shapiro 1977, doi:10.1115/1.3426281).
    Contact,
}

/// The model with its parameters' products computed.
#[derive(Clone, Debug)]
pub struct Model {
    pub(crate) walls: Vec<Wall>,
    pub(crate) units: Vec<Venule>,
    pub(crate) collapse: Collapse,
    /// Where the accelerations are to be those of the printed matrices.
    pub(crate) printed: Option<Printed>,
}

/// A wall's coefficients, scaled to its nominal diameter.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wall {
    /// `A / (m D)`: acceleration of the lumen by a pressure, 1/(s2 Pa).
    pub(crate) push: f64,
    /// `k / m`, 1/s2.
    pub(crate) spring: f64,
    /// `b / m`, 1/s.
    pub(crate) damper: f64,
    /// `A D`: flow by a rate of the lumen, m3.
    pub(crate) swept: f64,
    /// Conductance at the nominal diameter `N pi D^4 / (128 L mu)`, m3/(s Pa).
    pub(crate) conductance: f64,
}

/// The venules behind a capillary.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Venule {
    /// `R_Vi`, Pa s/m3.
    pub(crate) resistance: f64,
    /// Share of `P_F2` on the unit.
    pub(crate) share: f64,
}

/// Blood pressures, Pa (gage).
#[derive(Clone, Debug, PartialEq)]
pub struct Pressures {
    /// `P_C1`, `P_C2`, .. in the capillaries.
    pub capillary_pa: Vec<f64>,
    /// `P_V` in the vein.
    pub venous_pa: f64,
}

impl Model {
    /// The model of these parameters.
    pub fn new(parameters: &Parameters, collapse: Collapse) -> Model {
        let mu = parameters.viscosity_pa_s();
        let walls = parameters.walls().map(|wall| {
            let d = wall.diameter_m;
            Wall {
                push: wall.area_m2 / (wall.mass_kg * d),
                spring: wall.stiffness_n_per_m / wall.mass_kg,
                damper: wall.damping_n_s_per_m / wall.mass_kg,
                swept: wall.area_m2 * d,
                conductance: wall.count * PI * (d * d) * (d * d) / (128.0 * wall.length_m * mu),
            }
        });
        let units = parameters
            .units()
            .iter()
            .map(|unit| Venule { resistance: unit.venule_pa_s_per_m3, share: unit.load_share });
        Model { walls: walls.collect(), units: units.collect(), collapse, printed: None }
    }

    /// The number of walls: capillary units and the vein.
    pub fn walls(&self) -> usize {
        self.walls.len()
    }

    /// What happens where a vessel closes.
    pub fn collapse(&self) -> Collapse {
        self.collapse
    }

    /// The blood pressures at lumens `d / D` and rates `v / D` (1/s) of all walls. NaN where every lumen is exactly 0.
    pub fn pressures(&self, lumens: &[f64], rates: &[f64], inputs: &Inputs) -> Pressures {
        let n = self.units.len();
        let mut capillary_pa = vec![0.0; n];
        let mut venous_pa = self.conductance(n, lumens[n]) * inputs.downstream_pa - self.walls[n].swept * rates[n];
        let mut total = self.conductance(n, lumens[n]);
        for i in 0..n {
            let g = self.conductance(i, lumens[i]);
            let q = self.walls[i].swept * rates[i];
            let t = 1.0 + g * self.units[i].resistance;
            venous_pa += (g * inputs.upstream_pa - q) / t;
            total += g / t;
        }
        venous_pa /= total;
        for i in 0..n {
            let g = self.conductance(i, lumens[i]);
            let q = self.walls[i].swept * rates[i];
            let r = self.units[i].resistance;
            capillary_pa[i] = (r * (g * inputs.upstream_pa - q) + venous_pa) / (1.0 + g * r);
        }
        Pressures { capillary_pa, venous_pa }
    }

    /// The accelerations of the lumens `v' / D`, 1/s2, written to `out`. Every slice holds a value for each wall.
    pub fn accelerations(&self, lumens: &[f64], rates: &[f64], inputs: &Inputs, out: &mut [f64]) {
        if let Some(printed) = &self.printed {
            return self.printed_accelerations(printed, lumens, rates, inputs, out);
        }
        let pressures = self.pressures(lumens, rates, inputs);
        for (j, wall) in self.walls.iter().enumerate() {
            let (blood, outside) = match self.units.get(j) {
                Some(unit) => (pressures.capillary_pa[j], unit.share * inputs.distal_pa),
                None => (pressures.venous_pa, inputs.proximal_pa),
            };
            out[j] = wall.push * (blood - outside) - wall.spring * (lumens[j] - 1.0) - wall.damper * rates[j];
            if self.collapse == Collapse::Contact {
                out[j] += wall.spring * contact(lumens[j]);
            }
        }
    }

    /// The conductance of a wall's vessel at a lumen, m3/(s Pa).
    pub(crate) fn conductance(&self, j: usize, lumen: f64) -> f64 {
        let square = lumen * lumen;
        self.walls[j].conductance * (square * square)
    }
}
