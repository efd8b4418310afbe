//! Cells of venous pressures: all vessels at their two ends, and what these bound in between.
//!
//! Over a cell every lumen is monotone in the venous pressure, so the lumens at its ends bound it. With
//! `t = 1 + G R_Vi` and `s = G / t`, both of which grow with the lumen, `ds / dl = 4 s / (l t)`, and
//! `dp / dl = t alpha` with `alpha = w' - R_Vi ds/dl (P_H - P)`, in which nothing cancels. So all factors of `F` and
//! `F'` have bounds.

use std::ops::Range;
use std::rc::Rc;

use super::branch::Branch;
use super::range::{ROUNDING, Sum, product};
use crate::equilibrium::network::{Network, Vessel};

/// A vessel at a lumen and a venous pressure.
#[derive(Clone, Copy)]
pub(super) struct At {
    pub(super) lumen: f64,
    /// `s`.
    conductance: f64,
    /// `t`.
    behind: f64,
    /// How far rounding may move the lumen.
    error: f64,
}

/// All vessels at a venous pressure.
pub(super) struct Level {
    pub(super) venous: f64,
    pub(super) vein: At,
    /// By branch; `None` where the branch does not reach the pressure.
    pub(super) units: Vec<Option<At>>,
}

/// The levels at the two ends.
pub(super) type Cell = [Rc<Level>; 2];

/// How many units are on which branch.
pub(super) type Choice = Vec<(usize, usize)>;

/// What is known of a choice over a cell.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Verdict {
    Empty,
    One,
    Open,
}

/// A branch over a cell.
#[derive(Clone, Copy)]
struct Part {
    /// `s`.
    conductance: [f64; 2],
    /// `ds / dl`.
    slope: [f64; 2],
    /// `dp / dl`.
    venous: [f64; 2],
    /// `ds / dP`; infinite where `dp / dl` may be 0.
    by_venous: [f64; 2],
}

pub(super) struct Bounds<'a> {
    cell: &'a Cell,
    /// By branch; `None` where it does not reach over the cell.
    parts: Vec<Option<Part>>,
    /// The sign of `P_H - P_L`.
    sign: f64,
    /// `P_H - P` and `P - P_L` at both ends, times the sign.
    drops: [[f64; 2]; 2],
    /// Over the cell.
    drop: [f64; 2],
    /// `G_V`.
    outlet: [f64; 2],
    /// `G_V (P - P_L)`, times the sign.
    outflow: [f64; 2],
    /// `dG_V / dP (P - P_L)`, times the sign.
    widens: [f64; 2],
}

impl At {
    pub(super) fn new(vessel: &Vessel, lumen: f64, venous: f64) -> At {
        let row = vessel.row(lumen, venous, 0.0);
        let square = lumen * lumen;
        let behind = 1.0 + vessel.conductance * (square * square) * vessel.venule;
        let pressures = vessel.source.abs() + vessel.outside.abs() + venous.abs();
        let wall = vessel.pressure_slope(lumen);
        let rounded = 2.0 * f64::EPSILON * (pressures + vessel.stiffness + wall * lumen);
        // At a turning point a lumen has half of its digits.
        At { lumen, conductance: row.conductance, behind, error: rounded / row.alpha.abs().max(1e-8 * wall) }
    }
}

impl Part {
    fn new(vessel: &Vessel, branch: &Branch, ends: [At; 2], sign: f64, drop: [f64; 2]) -> Part {
        let [low, high] = if ends[0].lumen <= ends[1].lumen { ends } else { [ends[1], ends[0]] };
        let slope =
            [4.0 * low.conductance / (high.lumen * high.behind), 4.0 * high.conductance / (low.lumen * low.behind)];
        let through = product([sign * vessel.venule; 2], product(slope, drop));
        let mut alpha = Sum::default();
        alpha.add(1.0, [vessel.pressure_slope(high.lumen), vessel.pressure_slope(low.lumen)]);
        alpha.add(-1.0, through);
        let [least, most] = alpha.range();
        // The sign is known of the branch.
        let alpha = if branch.rises() { [least.max(0.0), most.max(0.0)] } else { [least.min(0.0), most.min(0.0)] };
        let venous = product(alpha, [low.behind, high.behind]);
        let over = |value: f64| if branch.rises() { 1.0 / value.abs() } else { -1.0 / value.abs() };
        let by_venous = product(slope, [over(venous[1]), over(venous[0])]);
        Part { conductance: [low.conductance, high.conductance], slope, venous, by_venous }
    }
}

impl<'a> Bounds<'a> {
    pub(super) fn new(network: &'a Network, branches: &[(Vessel, Branch)], cell: &'a Cell) -> Self {
        let (source, vein) = (network.units[0].source, &network.vein);
        let sign = if source >= vein.source { 1.0 } else { -1.0 };
        let drops = [0, 1].map(|end: usize| {
            let venous = cell[end].venous;
            [sign * (source - venous), sign * (venous - vein.source)]
        });
        let range = |which: usize| [drops[0][which].min(drops[1][which]), drops[0][which].max(drops[1][which])];
        let (drop, fall) = (range(0), range(1));
        let parts = branches.iter().enumerate().map(|(k, (vessel, branch))| {
            let ends = [cell[0].units[k]?, cell[1].units[k]?];
            Some(Part::new(vessel, branch, ends, sign, drop))
        });
        let parts = parts.collect();
        let [low, high] = [&cell[0].vein, &cell[1].vein];
        let outlet = [low.conductance, high.conductance];
        let widens = [
            4.0 * low.conductance / (high.lumen * vein.pressure_slope(low.lumen)),
            4.0 * high.conductance / (low.lumen * vein.pressure_slope(high.lumen)),
        ];
        let (outflow, widens) = (product(outlet, fall), product(widens, fall));
        Bounds { cell, parts, sign, drops, drop, outlet, outflow, widens }
    }

    /// The least and the greatest conductance on these branches; `None` where none reaches over the cell.
    pub(super) fn conductances(&self, branches: Range<usize>) -> Option<[f64; 2]> {
        let parts = self.parts[branches].iter().flatten().map(|part| part.conductance);
        parts.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
    }

    /// Whether `F` can be 0 with the units' conductances in this range.
    pub(super) fn may_balance(&self, conductances: [f64; 2]) -> bool {
        let inflow = product(conductances, self.drop);
        inflow[0] <= self.outflow[1] * (1.0 + ROUNDING) && self.outflow[0] <= inflow[1] * (1.0 + ROUNDING)
    }

    /// The venous pressure in the middle; `None` where there is no number in between.
    pub(super) fn middle(&self) -> Option<f64> {
        let [low, high] = [self.cell[0].venous, self.cell[1].venous];
        let middle = low + 0.5 * (high - low);
        (low < middle && middle < high).then_some(middle)
    }

    fn part(&self, k: usize) -> &Part {
        self.parts[k].as_ref().expect("chosen of the branches that reach over the cell")
    }

    /// The lumen of a branch at both ends.
    pub(super) fn lumens(&self, k: usize) -> [f64; 2] {
        [0, 1].map(|end: usize| self.at(end, k).lumen)
    }

    fn at(&self, end: usize, k: usize) -> &At {
        self.cell[end].units[k].as_ref().expect("chosen of the branches that reach over the cell")
    }

    /// `F` at an end, and how far rounding may move it.
    fn balance(&self, end: usize, choice: &Choice) -> [f64; 2] {
        let ([drop, fall], vein) = (self.drops[end], &self.cell[end].vein);
        let outflow = vein.conductance * fall;
        let (mut inflow, mut error) = (0.0, 4.0 * outflow * (vein.error / vein.lumen));
        for &(k, count) in choice {
            let at = self.at(end, k);
            let flow = count as f64 * at.conductance * drop;
            inflow += flow;
            error += 4.0 * flow * (at.error / (at.lumen * at.behind));
        }
        [inflow - outflow, error + ROUNDING * (inflow + outflow)]
    }

    /// What the bounds of `F'` say of a choice.
    pub(super) fn verdict(&self, choice: &Choice) -> Verdict {
        let [[first, rounding], [second, _]] = [0, 1].map(|end| self.balance(end, choice));
        if self.cell[0].venous == self.cell[1].venous {
            return if first == 0.0 { Verdict::One } else { Verdict::Empty };
        }
        // Of all units but the most sensitive, which comes last.
        let mut slope = Sum::default();
        slope.add(-1.0, self.widens);
        slope.add(-self.sign, self.outlet);
        let steepness = |&(k, count): &(usize, usize)| {
            let [a, b] = self.part(k).by_venous;
            count as f64 * a.abs().max(b.abs())
        };
        let last = (0..choice.len()).max_by(|&a, &b| steepness(&choice[a]).total_cmp(&steepness(&choice[b])));
        let last = last.expect("at least one unit");
        for (i, &(k, count)) in choice.iter().enumerate() {
            slope.add(-self.sign * count as f64, self.part(k).conductance);
            if i != last {
                slope.add(count as f64, product(self.part(k).by_venous, self.drop));
            }
        }
        let (part, count) = (self.part(choice[last].0), choice[last].1 as f64);
        let mut by_venous = slope;
        by_venous.add(count, product(part.by_venous, self.drop));
        let mut by_lumen = Sum::default();
        by_lumen.add(count, product(part.slope, self.drop));
        by_lumen.add(1.0, product(part.venous, slope.range()));
        if by_venous.keeps_its_sign() || by_lumen.keeps_its_sign() {
            return if (first >= 0.0) == (second >= 0.0) { Verdict::Empty } else { Verdict::One };
        }
        let [from, to] = [0, 1].map(|end| self.at(end, choice[last].0));
        let steps = [
            (self.cell[1].venous - self.cell[0].venous, 0.0, by_venous),
            (to.lumen - from.lumen, from.error + to.error, by_lumen),
        ];
        let excluded = steps.iter().any(|(step, error, slope)| {
            let change = product([step.min(0.0) - error, step.max(0.0) + error], slope.range());
            first + change[0] > rounding || first + change[1] < -rounding
        });
        if excluded { Verdict::Empty } else { Verdict::Open }
    }

    /// The lumen of the vein at both ends.
    pub(super) fn vein_lumens(&self) -> [f64; 2] {
        [0, 1].map(|end: usize| self.cell[end].vein.lumen)
    }
}
