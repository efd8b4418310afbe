//! An interval Newton step in the form of the equations that does not cancel (module `polish`), for small boxes.

use super::cell::{Cell, Last, Step};
use super::interval::Interval;
use super::network::{Network, Vessel};

/// A unit's part of the linearized equations, enclosed.
struct Row {
    alpha: Interval,
    beta: Interval,
    gamma: Interval,
    residual: Interval,
}

impl Cell {
    /// As [`Cell::step`], for small boxes.
    pub(super) fn fine_step(&self, network: &Network, at_vein: f64, at_units: &[f64]) -> Step {
        self.fine_step_or_nothing(network, at_vein, at_units).unwrap_or(Step::Singular)
    }

    fn fine_step_or_nothing(&self, network: &Network, at_vein: f64, at_units: &[f64]) -> Option<Step> {
        let vein = &network.vein;
        let (here, around) = (vein.pressure_about(at_vein), vein.pressures(self.vein));
        let slope = vein.pressure_slopes(self.vein);
        let source = Interval::point(vein.source);
        let outflow = vein.conductance * self.vein.fourth();
        let mut total = outflow;
        let mut balance = vein.conductance * Interval::point(at_vein).fourth() * (source - here);
        let mut rows = Vec::with_capacity(at_units.len());
        for ((unit, lumens), &at) in network.units.iter().zip(&self.units).zip(at_units) {
            let head = Interval::point(unit.source);
            total = total + unit.conductances(*lumens);
            balance = balance + unit.conductances(Interval::point(at)) * (head - here);
            rows.push(unit.enclosed(*lumens, at, head - around, head - here, slope)?);
        }
        let pivot = rows.iter().position(|row| row.alpha.contains(0.0));
        let mut excess = (4.0 * outflow).over(self.vein)? * (source - around) - total * slope;
        let mut right = -balance;
        for (i, row) in rows.iter().enumerate() {
            if Some(i) != pivot {
                let ratio = row.gamma.over(row.alpha)?;
                excess = excess + ratio * row.beta;
                right = right + ratio * row.residual;
            }
        }
        let solved = match pivot {
            None => Last::Vein.solve(self, at_vein, right, excess),
            Some(k) => {
                let (last, per) = (&rows[k], excess.over(rows[k].beta)?);
                Last::Unit(k).solve(self, at_units[k], right - per * last.residual, per * last.alpha + last.gamma)
            }
        };
        let last = match solved {
            Ok(last) => last,
            Err(nothing) => return Some(nothing),
        };
        let by = match pivot.map(|k| &rows[k]) {
            None => last,
            Some(row) => (row.alpha * last + row.residual).over(row.beta)?,
        };
        let mut units = Vec::with_capacity(rows.len());
        for (i, row) in rows.iter().enumerate() {
            let step = if Some(i) == pivot { last } else { (row.beta * by - row.residual).over(row.alpha)? };
            units.push(Interval::point(at_units[i]) + step);
        }
        Some(Step::Image(Cell { vein: Interval::point(at_vein) + by, units }))
    }
}

impl Vessel {
    /// The unit's part over lumens and from one of them, with the drops `P_H - P` over the box and there.
    fn enclosed(
        &self,
        lumens: Interval,
        at: f64,
        drop: Interval,
        drop_here: Interval,
        venous_slope: Interval,
    ) -> Option<Row> {
        let one = Interval::point(1.0);
        let g = self.conductance * lumens.fourth();
        let t = one + self.venule * g;
        let gamma = (4.0 * g).over(lumens)?.over(t * t)? * drop;
        let t_here = one + self.venule * (self.conductance * Interval::point(at).fourth());
        Some(Row {
            alpha: self.pressure_slopes(lumens) - self.venule * gamma,
            beta: venous_slope.over(t)?,
            gamma,
            residual: self.pressure_about(at) - Interval::point(self.source) + drop_here.over(t_here)?,
        })
    }
}
