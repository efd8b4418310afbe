//! The box in which the search begins, and where it cuts ranges.
//!
//! All flows go from the greater of `P_H`, `P_L` to the lesser, so every pressure of an equilibrium lies between the
//! two, and every lumen between those at which a wall holds the one and the other.

use super::cell::Cell;
use super::interval::Interval;
use super::network::{Network, Vessel};
use super::root::LEAST_LUMEN;
use crate::model::TOUCH;

/// A box that holds every equilibrium with open vessels; `None` where there is none.
pub(super) fn first_box(network: &Network) -> Option<Cell> {
    let pressures = network.pressures();
    let units = network.units.iter().map(|unit| unit.lumens_between(pressures)).collect::<Option<_>>()?;
    Some(Cell { vein: network.vein.lumens_between(pressures)?, units })
}

impl Vessel {
    /// Lumens outside of which the pressure inside is not in the range; `None` where the vessel would be closed.
    fn lumens_between(&self, inside: Interval) -> Option<Interval> {
        let linear = |pressure: f64| 1.0 + (pressure - self.outside) / self.stiffness;
        let below = |lumen: f64| lumen <= LEAST_LUMEN || self.pressure_about(lumen).hi <= inside.lo;
        let above = |lumen: f64| self.pressure_about(lumen).lo >= inside.hi;
        let (mut lo, mut hi) = (linear(inside.lo), linear(inside.hi));
        if self.contact && lo < TOUCH {
            lo = TOUCH;
            while !below(lo) {
                lo *= 0.7;
            }
        }
        if self.contact && hi < TOUCH {
            hi = TOUCH;
            while above(0.7 * hi) && hi > LEAST_LUMEN {
                hi *= 0.7;
            }
        }
        let mut margin = 1e-15 * (1.0 + lo.abs().max(hi.abs()));
        while !below(lo) {
            lo -= margin;
            margin *= 4.0;
        }
        if hi < LEAST_LUMEN {
            return None;
        }
        let mut margin = 1e-15 * (1.0 + hi.abs());
        while !above(hi) {
            hi += margin;
            margin *= 4.0;
        }
        Some(Interval::new(lo.max(LEAST_LUMEN), hi))
    }

    /// Where to cut a range: where walls begin to touch, otherwise in the middle.
    pub(super) fn cut_of(&self, range: Interval) -> f64 {
        if self.contact && range.lo < TOUCH && range.hi > TOUCH { TOUCH } else { range.middle() }
    }
}
