//! Boxes of lumens, and what an interval Newton step says of one.
//!
//! For any two states of a box the equations differ by a matrix times their difference, whose entries are slopes of
//! functions of one lumen each and so lie in the ranges that [`Vessel`] gives. Eliminating the units leaves one
//! interval number `D` for the determinant. Where 0 is not in it, the box holds at most one equilibrium; where the
//! image of the box under the step lies within the box, it holds one (Brouwer). A venule in front of a capillary makes
//! `p'` change its sign; where that happens for a single unit, this unit's lumen is eliminated last in place of the
//! vein's, so that turning points of a branch need no care.

use super::interval::Interval;
use super::network::{Network, Vessel};

const ONE: Interval = Interval { lo: 1.0, hi: 1.0 };

/// Ranges of lumens.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Cell {
    pub(super) vein: Interval,
    pub(super) units: Vec<Interval>,
}

/// The slopes of a unit over a range of its lumens.
#[derive(Clone, Copy, Debug)]
struct Slopes {
    /// `f'`.
    flow: Interval,
    /// `w'`.
    pressure: Interval,
    /// `p'`.
    venous: Interval,
}

/// What a Newton step says.
pub(super) enum Step {
    /// Nothing: the box may hold several equilibria.
    Singular,
    /// The box holds none.
    Empty,
    /// The box holds at most one equilibrium, and that lies in the image.
    Image(Cell),
}

/// The lumen that is eliminated last.
#[derive(Clone, Copy)]
pub(super) enum Last {
    Vein,
    Unit(usize),
}

impl Last {
    /// The lumen's step from `at` by `determinant * step = right`. Where the determinant may be 0 there is none, but
    /// where no step within the box can make the equation hold, the box is known to be empty.
    pub(super) fn solve(self, cell: &Cell, at: f64, right: Interval, determinant: Interval) -> Result<Interval, Step> {
        let range = match self {
            Last::Vein => cell.vein,
            Last::Unit(k) => cell.units[k],
        };
        right.over(determinant).ok_or_else(|| match (determinant * (range - Interval::point(at))).meet(right) {
            Some(_) => Step::Singular,
            None => Step::Empty,
        })
    }
}

impl Cell {
    /// The lumens, more or less by `by`, or by this part of themselves where they are greater than 1; none is less than
    /// half of itself.
    pub(super) fn about(vein: f64, units: &[f64], by: f64) -> Cell {
        let wide = |lumen: f64| {
            let by = by * lumen.max(1.0);
            Interval::new(lumen - by.min(0.5 * lumen), lumen + by)
        };
        Cell { vein: wide(vein), units: units.iter().map(|&lumen| wide(lumen)).collect() }
    }

    pub(super) fn hull(&self, other: &Cell) -> Cell {
        let units = self.units.iter().zip(&other.units).map(|(a, b)| a.hull(*b)).collect();
        Cell { vein: self.vein.hull(other.vein), units }
    }

    pub(super) fn within(&self, other: &Cell) -> bool {
        self.vein.within(other.vein) && self.units.iter().zip(&other.units).all(|(a, b)| a.within(*b))
    }

    pub(super) fn meets(&self, other: &Cell) -> bool {
        self.vein.meet(other.vein).is_some() && self.units.iter().zip(&other.units).all(|(a, b)| a.meet(*b).is_some())
    }

    /// Whether every range comes within `by` of the other's, or within this part of lumens greater than 1.
    pub(super) fn near(&self, other: &Cell, by: f64) -> bool {
        let close = |a: Interval, b: Interval| a.wider(by * a.hi.max(1.0)).meet(b).is_some();
        close(self.vein, other.vein) && self.units.iter().zip(&other.units).all(|(a, b)| close(*a, *b))
    }

    /// The widest range, of lumens as they are or over themselves where they are greater than 1.
    pub(super) fn width(&self) -> f64 {
        self.units.iter().map(|range| extent(*range)).fold(extent(self.vein), f64::max)
    }

    /// Narrows the box to what the equations one by one allow; false where they allow nothing.
    pub(super) fn narrow(&mut self, network: &Network) -> bool {
        self.narrow_or_empty(network).is_some()
    }

    fn narrow_or_empty(&mut self, network: &Network) -> Option<()> {
        let vein = &network.vein;
        let mut venous = network.pressures().meet(vein.pressures(self.vein))?;
        // The venous pressure as the mean of P_H and P_L weighted by conductances, each of which grows with its lumen.
        let outer = Interval::point(network.units[0].source);
        let mut inflow = Interval::point(0.0);
        for (unit, lumens) in network.units.iter().zip(&self.units) {
            inflow = inflow + unit.conductances(*lumens);
        }
        let drop = outer - Interval::point(vein.source);
        let ratio = vein.conductances(self.vein).over(inflow);
        let part = ratio.and_then(|ratio| ONE.over(ONE + ratio));
        if let Some(part) = part {
            venous = venous.meet(Interval::point(vein.source) + part * drop)?;
        }
        for (unit, lumens) in network.units.iter().zip(&mut self.units) {
            // P_Ci as the mean of P_H and P_V.
            if let Some(behind) = ONE.over(ONE + unit.venule * (unit.conductance * lumens.fourth())) {
                *lumens = unit.lumens_at(*lumens, outer - behind * (outer - venous))?;
            }
            let slopes = unit.slopes(*lumens);
            let middle = lumens.middle();
            let at = unit.venous_about(middle);
            let from_middle = *lumens - Interval::point(middle);
            let natural = unit.pressures(*lumens) - unit.venule * unit.flows(*lumens);
            venous = venous.meet(natural)?.meet(at + slopes.venous * from_middle)?;
            if let Some(step) = (venous - at).over(slopes.venous) {
                *lumens = lumens.meet(Interval::point(middle) + step)?;
            }
        }
        self.vein = vein.lumens_at(self.vein, venous)?;
        Some(())
    }

    /// A Newton step over the box from a state in it.
    pub(super) fn step(&self, network: &Network, at_vein: f64, at_units: &[f64]) -> Step {
        self.step_or_nothing(network, at_vein, at_units).unwrap_or(Step::Singular)
    }

    fn step_or_nothing(&self, network: &Network, at_vein: f64, at_units: &[f64]) -> Option<Step> {
        let vein = &network.vein;
        let by_vein = vein.pressure_slopes(self.vein);
        let pressure = vein.pressure_about(at_vein);
        let mut balance = vein.flow_about(at_vein);
        // The unit whose p' may be 0, if there is one; the flow's slope by the venous pressure through all others.
        let mut pivot = None;
        let mut through = Interval::point(0.0);
        let mut carried = Interval::point(0.0);
        for (i, (unit, lumens)) in network.units.iter().zip(&self.units).enumerate() {
            balance = balance + unit.flow_about(at_units[i]);
            let slopes = unit.slopes(*lumens);
            match slopes.flow_by_venous(unit.venule) {
                Some(ratio) => {
                    through = through + ratio;
                    carried = carried + ratio * (unit.venous_about(at_units[i]) - pressure);
                }
                None if pivot.is_none() => pivot = Some((i, slopes)),
                None => return None,
            }
        }
        let outflow = vein.flow_slopes(self.vein);
        let right = carried - balance;
        let solved = match pivot {
            None => Last::Vein.solve(self, at_vein, right, by_vein * through + outflow),
            Some((k, slopes)) => {
                let unit = &network.units[k];
                let excess = through + outflow.over(by_vein)?;
                let determinant = excess * slopes.pressure + slopes.flow * (ONE - unit.venule * excess);
                let residual = unit.venous_about(at_units[k]) - pressure;
                Last::Unit(k).solve(self, at_units[k], right - excess * residual, determinant)
            }
        };
        let last = match solved {
            Ok(last) => last,
            Err(nothing) => return Some(nothing),
        };
        let (by, pivot_step) = match pivot {
            None => (last, None),
            Some((k, slopes)) => {
                let residual = network.units[k].venous_about(at_units[k]) - pressure;
                ((slopes.venous * last + residual).over(by_vein)?, Some((k, last)))
            }
        };
        let mut units = Vec::with_capacity(self.units.len());
        for (i, (unit, lumens)) in network.units.iter().zip(&self.units).enumerate() {
            let step = match pivot_step {
                Some((k, step)) if k == i => step,
                _ => {
                    let residual = unit.venous_about(at_units[i]) - pressure;
                    (by_vein * by - residual).over(unit.slopes(*lumens).venous)?
                }
            };
            units.push(Interval::point(at_units[i]) + step);
        }
        Some(Step::Image(Cell { vein: Interval::point(at_vein) + by, units }))
    }

    /// In two: the range of a unit whose `p'` may be 0, or the vein's, whichever leaves the venous pressure more open;
    /// or the widest where neither can be cut. `None` where all are narrower than `least` or nothing can be cut.
    pub(super) fn cut(&self, network: &Network, least: f64) -> Option<[Cell; 2]> {
        if self.width() <= least {
            return None;
        }
        let can = |range: Interval| extent(range) > 4.0 * f64::EPSILON;
        let venous = network.vein.pressures(self.vein).width();
        let mut widest = if can(self.vein) { (venous, None) } else { (f64::NEG_INFINITY, None) };
        for (i, (unit, lumens)) in network.units.iter().zip(&self.units).enumerate() {
            let slopes = unit.slopes(*lumens).venous;
            let open = slopes.magnitude() * lumens.width();
            if slopes.contains(0.0) && can(*lumens) && open > widest.0 {
                widest = (open, Some(i));
            }
        }
        if widest.0 == f64::NEG_INFINITY {
            let widths = self.units.iter().map(|range| extent(*range)).enumerate();
            widest.1 = widths.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(i, _)| i);
        }
        let range = widest.1.map_or(self.vein, |i| self.units[i]);
        let at = network.vein.cut_of(range);
        if at <= range.lo || at >= range.hi {
            return None;
        }
        Some([Interval::new(range.lo, at), Interval::new(at, range.hi)].map(|part| {
            let mut cell = self.clone();
            match widest.1 {
                None => cell.vein = part,
                Some(i) => cell.units[i] = part,
            }
            cell
        }))
    }
}

/// The width of a range, or over itself where it reaches beyond 1.
fn extent(range: Interval) -> f64 {
    range.width() / range.hi.max(1.0)
}

impl Slopes {
    /// `f' / p'`, the flow's slope by the venous pressure, which is monotone in `f'` and in `w'`; `None` where `p'` may
    /// be 0.
    fn flow_by_venous(&self, venule: f64) -> Option<Interval> {
        if self.venous.contains(0.0) {
            return None;
        }
        let at = |flow: f64, pressure: f64| {
            Interval::point(flow).over(Interval::point(pressure) - venule * Interval::point(flow))
        };
        let ends = at(self.flow.lo, self.pressure.lo)?.hull(at(self.flow.hi, self.pressure.lo)?);
        if self.pressure.lo == self.pressure.hi {
            return Some(ends);
        }
        Some(ends.hull(at(self.flow.lo, self.pressure.hi)?).hull(at(self.flow.hi, self.pressure.hi)?))
    }
}

impl Vessel {
    fn slopes(&self, lumens: Interval) -> Slopes {
        let (flow, pressure) = (self.flow_slopes(lumens), self.pressure_slopes(lumens));
        Slopes { flow, pressure, venous: pressure - self.venule * flow }
    }

    /// `p` at one lumen, enclosed.
    fn venous_about(&self, lumen: f64) -> Interval {
        self.pressure_about(lumen) - self.venule * self.flow_about(lumen)
    }

    /// `s = G / (1 + G R)` over lumens, with which it grows.
    pub(super) fn conductances(&self, lumens: Interval) -> Interval {
        let bare = self.conductance * lumens.fourth();
        let with = |g: f64| {
            let g = Interval::point(g);
            g.over(ONE + self.venule * g).expect("1 + G R is not 0")
        };
        Interval::new(with(bare.lo).lo, with(bare.hi).hi)
    }

    /// Where among the lumens the pressure inside can be in a range; `None` where nowhere.
    fn lumens_at(&self, lumens: Interval, inside: Interval) -> Option<Interval> {
        let middle = lumens.middle();
        match (inside - self.pressure_about(middle)).over(self.pressure_slopes(lumens)) {
            Some(step) => (Interval::point(middle) + step).meet(lumens),
            None => Some(lumens),
        }
    }
}
