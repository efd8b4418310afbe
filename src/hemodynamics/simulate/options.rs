//! What run is wanted.

use lunula_hemodynamics::Collapse;

use crate::hemodynamics::choices::OpticsChoice;
use crate::hemodynamics::given::{GivenLoads, GivenParameters, Start};
use crate::hemodynamics::grid::{multiple, multiples_within};

/// A run to be made.
#[derive(Debug, Clone)]
pub struct SimulateOptions {
    /// Of which nail.
    pub parameters: GivenParameters,
    /// Under what.
    pub loads: GivenLoads,
    /// From where.
    pub start: Start,
    /// What happens where a vessel closes.
    pub collapse: Collapse,
    /// How light depends on the capillaries.
    pub optics: OpticsChoice,
    /// The time of the last row; the first is 0.
    pub until_s: f64,
    /// Between two rows.
    pub every_s: f64,
    /// The error of every lumen over its nominal diameter is at most this.
    pub rtol: f64,
    /// A vessel that closes ends the table instead of the whole request.
    pub keep_partial: bool,
    /// The loads stand in the table as well.
    pub with_loads: bool,
}

impl Default for SimulateOptions {
    fn default() -> Self {
        Self {
            parameters: GivenParameters::default(),
            loads: GivenLoads::default(),
            start: Start::default(),
            collapse: Collapse::default(),
            optics: OpticsChoice::default(),
            until_s: 4.0,
            every_s: 0.01,
            rtol: 1e-8,
            keep_partial: false,
            with_loads: false,
        }
    }
}

/// More values than a run keeps at once.
const MOST_VALUES: f64 = 1e8;

impl SimulateOptions {
    /// Rows of the table: one every [`every_s`](Self::every_s) from 0 on, the end counted.
    #[must_use]
    pub fn rows(&self) -> f64 {
        multiples_within(self.until_s, self.every_s)
    }

    /// The times of the rows, each a multiple of [`every_s`](Self::every_s).
    #[must_use]
    pub fn times_s(&self) -> Vec<f64> {
        (0..self.rows() as usize).map(|k| multiple(k, self.every_s)).collect()
    }

    /// The time of the last row.
    pub(super) fn last_s(&self) -> f64 {
        multiple(self.rows() as usize - 1, self.every_s)
    }

    /// All that is wrong, by the command line's names; `units` is the number of capillary units.
    pub(super) fn faults(&self, units: usize) -> Vec<String> {
        let mut faults = Vec::new();
        let ends = self.until_s >= 0.0 && self.until_s.is_finite();
        if !ends {
            faults.push(format!("--until {}: choose 0 s or more, as 4", self.until_s));
        }
        let steps = self.every_s > 0.0 && self.every_s.is_finite();
        if !steps {
            faults.push(format!("--every {}: choose more than 0 s, as 0.01", self.every_s));
        }
        let values_a_row = 3.0 * (units as f64 + 1.0);
        if steps && ends && self.rows() * values_a_row > MOST_VALUES {
            faults.push(format!(
                "--every {}: {:.3e} rows are more than a run keeps at once; choose {:.1e} s or more, or go on from \
                 the last row with --from",
                self.every_s,
                self.rows(),
                1.05 * self.until_s * values_a_row / MOST_VALUES
            ));
        }
        if !(1e-13..=1e-2).contains(&self.rtol) {
            faults.push(format!("--rtol {:e}: choose 1e-13 to 1e-2, as 1e-8", self.rtol));
        }
        faults
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_time_is_one_row_and_every_fault_is_told() {
        let none = SimulateOptions { until_s: 0.0, ..SimulateOptions::default() };
        assert_eq!((none.times_s(), none.faults(2)), (vec![0.0], vec![]));
        let wrong = SimulateOptions { until_s: -1.0, every_s: 0.0, rtol: f64::NAN, ..SimulateOptions::default() };
        assert_eq!(wrong.faults(2).len(), 3);
        let huge = SimulateOptions { until_s: 1e9, every_s: 1e-6, ..SimulateOptions::default() };
        assert!(huge.faults(2)[0].contains("rows"), "{:?}", huge.faults(2));
    }
}
