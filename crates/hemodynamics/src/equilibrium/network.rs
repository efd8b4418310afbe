//! The model at rest as functions of one lumen each.
//!
//! A wall at rest holds the pressure `w(l) = P_ext + e (l - 1 - c(l))` inside, with `e = k D / A` and the contact force
//! `c` over `k D` (0 where collapse is an error); it grows with the lumen `l`. Blood flows into the vessel from its far
//! side, which is under `S`, at `f(l) = g l^4 (S - w(l))`, with `S = P_H` for a capillary and `S = P_L` for the vein
//! (whose `f` is the outflow, negated). Behind a capillary stands its venule, so it wants the venous pressure
//! `p(l) = w(l) - R_Vi f(l)`. An equilibrium is
//!
//! `p_i(l_i) = w_V(l_V)` for every unit and `sum f_i(l_i) + f_V(l_V) = 0`.
//!
//! Nothing has to be inverted. Without contact `f' = g l^3 (4 h - 5 e l)` with `h = S - P_ext + e`, which has its only
//! turning point at `l = 3 h / (5 e)`: the ranges of `f'` and `p' = w' - R f'` over an interval of lumens are known
//! exactly but for rounding.

use super::interval::Interval;
use crate::load::Inputs;
use crate::model::{Collapse, Model, TOUCH, contact, contact_slope};

/// A vessel at rest.
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

/// All vessels at rest.
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
    pub(super) fn pressures(&self) -> Interval {
        let (a, b) = (self.units[0].source, self.vein.source);
        Interval::new(a.min(b), a.max(b))
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

    /// `w` over lumens. It grows, so its ends are those of the lumens.
    pub(super) fn pressures(&self, lumens: Interval) -> Interval {
        Interval::new(self.pressure_about(lumens.lo).lo, self.pressure_about(lumens.hi).hi)
    }

    /// `w` at one lumen, enclosed.
    pub(super) fn pressure_about(&self, lumen: f64) -> Interval {
        let lumen = Interval::point(lumen);
        let mut shape = lumen - Interval::point(1.0);
        if self.touches(lumen.lo) {
            let near = nearness(lumen);
            shape = shape - near.cube();
        }
        self.stiffness * shape + Interval::point(self.outside)
    }

    /// `w'` over lumens. It falls with the lumen and is never below `e`.
    pub(super) fn pressure_slopes(&self, lumens: Interval) -> Interval {
        if !self.touches(lumens.lo) {
            return Interval::point(self.stiffness);
        }
        let steepest = self.slope_about(lumens.lo).hi;
        let flattest = if self.touches(lumens.hi) { self.slope_about(lumens.hi).lo } else { self.stiffness };
        Interval::new(flattest, steepest)
    }

    /// `w'` at a lumen below contact, enclosed.
    fn slope_about(&self, lumen: f64) -> Interval {
        let lumen = Interval::point(lumen);
        let near = nearness(lumen);
        let of_contact = (3.0 * (near * near)).over(lumen * lumen).expect("lumens are greater than 0");
        self.stiffness * (Interval::point(1.0) + TOUCH * of_contact)
    }

    /// `f` at one lumen, enclosed.
    pub(super) fn flow_about(&self, lumen: f64) -> Interval {
        let drop = Interval::point(self.source) - self.pressure_about(lumen);
        self.conductance * (Interval::point(lumen).fourth() * drop)
    }

    /// `f` over lumens, from the product of its parts.
    pub(super) fn flows(&self, lumens: Interval) -> Interval {
        let drop = Interval::point(self.source) - self.pressures(lumens);
        self.conductance * (lumens.fourth() * drop)
    }

    /// `f'` over lumens.
    pub(super) fn flow_slopes(&self, lumens: Interval) -> Interval {
        if self.touches(lumens.lo) {
            let drop = Interval::point(self.source) - self.pressures(lumens);
            let bracket = 4.0 * drop - lumens * self.pressure_slopes(lumens);
            return self.conductance * (lumens.cube() * bracket);
        }
        let h = Interval::point(self.source) - Interval::point(self.outside) + Interval::point(self.stiffness);
        let at = |lumen: Interval| self.conductance * (lumen.cube() * (4.0 * h - 5.0 * (self.stiffness * lumen)));
        let ends = at(Interval::point(lumens.lo)).hull(at(Interval::point(lumens.hi)));
        let turn = (3.0 * h).over(5.0 * Interval::point(self.stiffness)).and_then(|turn| turn.meet(lumens));
        turn.map_or(ends, |turn| ends.hull(at(turn)))
    }

    /// Whether the walls touch at a lumen.
    fn touches(&self, lumen: f64) -> bool {
        self.contact && lumen < TOUCH
    }
}

/// `d_c / d - 1` of a lumen below contact, enclosed and not negative.
fn nearness(lumen: Interval) -> Interval {
    let near = Interval::point(TOUCH).over(lumen).expect("lumens are greater than 0") - Interval::point(1.0);
    Interval::new(near.lo.max(0.0), near.hi)
}
