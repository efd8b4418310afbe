//! Which run: the options of `lunula simulate` and of a pipeline's stage, the files that it reads, where results go.

use std::path::PathBuf;

use clap::Args;
use clap::builder::{PathBufValueParser, TypedValueParser};

use crate::hemodynamics::given::{LoadOptions, ModelOptions, Start};
use crate::hemodynamics::grid::{multiple, multiples_within};

/// The files that a run reads.
#[derive(Debug, Clone, Default, Args)]
pub struct SimulateInputs {
    /// Read the loads from a table time_s,pf1_Pa,pf2_Pa instead (and ph_Pa, pl_Pa where they change): straight between
    /// rows, held before and after
    #[arg(long, value_name = "FILE.csv", conflicts_with_all = ["pf1", "pf2"])]
    pub loads: Option<PathBuf>,
    /// Parameters under the thesis' symbols with their units, such as k_C1_N_per_m = 1e5 [default: the thesis' table];
    /// --print-params writes a whole file to start from
    #[arg(long, value_name = "PARAMS.toml")]
    pub params: Option<PathBuf>,
}

/// How to run: the options of `lunula simulate` and of a pipeline's stage.
#[derive(Debug, Clone, Args)]
pub struct SimulateOptions {
    /// The loads.
    #[command(flatten)]
    pub loads: LoadOptions,
    /// Start from another state: zero (no displacement, no velocity), or the last row of a trajectory's table; time
    /// begins at 0 again [default: the equilibrium of the loads just before t = 0]
    #[arg(long = "from", value_name = "zero|FILE", value_parser = PathBufValueParser::new().map(Start::from))]
    pub start: Option<Start>,
    /// The time of the last row; that of the first is 0
    #[arg(long = "until", value_name = "SECONDS", default_value_t = 4.0, allow_negative_numbers = true)]
    pub until_s: f64,
    /// The time between two rows
    #[arg(long = "every", value_name = "SECONDS", default_value_t = 0.01, allow_negative_numbers = true)]
    pub every_s: f64,
    /// The largest error of any lumen, as a share of its nominal diameter
    #[arg(long, value_name = "ERROR", default_value = "1e-8", allow_negative_numbers = true)]
    pub rtol: f64,
    /// Write the loads into the table as well, in columns that `lunula fit` reads
    #[arg(long)]
    pub with_loads: bool,
    /// Where a vessel closes, write the rows before it (exit status 1) [default: nothing is written]
    #[arg(long)]
    pub keep_partial: bool,
    /// The model.
    #[command(flatten)]
    pub model: ModelOptions,
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
