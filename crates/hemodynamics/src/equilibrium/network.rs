//! The model at rest as functions of one lumen each.
//!
//! A wall at rest holds the pressure `w(l) = P_ext + e (l - 1 - c(l))` inside, with `e = k D / A` and the contact force
//! `c` over `k D` (0 where collapse is an error); it grows with the lumen `l`. Blood flows into the vessel from its far
//! side, which is under `S`, at `f(l) = g l^4 (S - w(l))`, with `S = P_H` for a capillary and `S = P_L` for the vein
//! (whose `f` is the outflow, negated). Behind a capillary is its venule, so the venous pressure has to be
//! `p(l) = w(l) - R_Vi f(l)`. An equilibrium is
//!
//! `p_i(l_i) = w_V(l_V)` for every unit and `sum f_i(l_i) + f_V(l_V) = 0`.
//!
//! The walls act on each other through the venous pressure alone: module `search` finds the venous pressures at
//! which the flows balance.

use crate::load::Inputs;
use crate::model::{Collapse, Model, contact, contact_slope};

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Vessel {
    /// `e = k D / A`, Pa.
    pub(super) stiffness: f64,
    /// Conductance at the nominal diameter `g`, m3/(s Pa).
    pub(super) conductance: f64,
    /// External pressure `P_ext`, Pa.
    pub(super) outside: f64,
    /// Pressure at the far side `S`, Pa.
    pub(super) source: f64,
    /// Resistance of the venules behind `R_Vi`, Pa s/m3; 0 for the vein.
    pub(super) venule: f64,
    pub(super) contact: bool,
}

/// `k D / A`, Pa, that can be computed with.
const STIFFNESSES: [f64; 2] = [1e-6, 1e30];
/// Conductances, m3/(s Pa), that can be computed with.
const CONDUCTANCES: [f64; 2] = [1e-60, 1e20];

#[derive(Clone, Debug)]
pub(super) struct Network {
    pub(super) units: Vec<Vessel>,
    pub(super) vein: Vessel,
}

impl Network {
    pub(super) fn new(model: &Model, inputs: &Inputs) -> Network {
        let vessel = |j: usize, outside: f64, source: f64, venule: f64| Vessel {
            stiffness: model.walls[j].spring / model.walls[j].push,
            conductance: model.walls[j].conductance,
            outside,
            source,
            venule,
            contact: model.collapse == Collapse::Contact,
        };
        let n = model.units.len();
        Network {
            units: (0..n)
                .map(|i| {
                    let unit = &model.units[i];
                    vessel(i, unit.share * inputs.distal_pa, inputs.upstream_pa, unit.resistance)
                })
                .collect(),
            vein: vessel(n, inputs.proximal_pa, inputs.downstream_pa, 0.0),
        }
    }

    /// Whether no product of lumens, conductances and pressures can leave the range of numbers, whatever the lumens.
    pub(super) fn in_range(&self) -> bool {
        let within = |value: f64, [least, most]: [f64; 2]| value >= least && value <= most;
        self.units.iter().chain([&self.vein]).all(|vessel| {
            within(vessel.stiffness, STIFFNESSES)
                && within(vessel.conductance, CONDUCTANCES)
                && within(vessel.venule, [0.0, 1e40])
                && within(vessel.outside.abs(), [0.0, 1e15])
                && within(vessel.source.abs(), [0.0, 1e15])
        })
    }

    /// The pressures between which every pressure of an equilibrium lies: all flows go from the greater to the lesser.
    pub(super) fn pressures(&self) -> [f64; 2] {
        let (a, b) = (self.units[0].source, self.vein.source);
        [a.min(b), a.max(b)]
    }
}

impl Vessel {
    /// `w` at a lumen, Pa.
    pub(super) fn pressure(&self, lumen: f64) -> f64 {
        let shape = if self.contact { lumen - 1.0 - contact(lumen) } else { lumen - 1.0 };
        self.stiffness * shape + self.outside
    }

    /// `w'` at a lumen, Pa.
    pub(super) fn pressure_slope(&self, lumen: f64) -> f64 {
        if self.contact { self.stiffness * (1.0 - contact_slope(lumen)) } else { self.stiffness }
    }
}
