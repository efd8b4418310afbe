//! What a run did, and how sure it is.

use std::path::PathBuf;

use lunula_hemodynamics::{Loads, Statistics};
use serde::Serialize;

use crate::hemodynamics::choices::OpticsChoice;
use crate::job::Report;

/// A vessel that closed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Collapsed {
    /// Which, by the thesis' name.
    pub vessel: String,
    /// When, s.
    pub time_s: f64,
}

impl Collapsed {
    /// In words.
    #[must_use]
    pub fn words(&self) -> String {
        format!("{} closes at {:.9} s", self.vessel, self.time_s)
    }
}

/// The loads of a run, as the command line writes them.
#[derive(Debug, Clone, Serialize)]
pub struct LoadsReport {
    /// `P_F1`.
    pub pf1: String,
    /// `P_F2`.
    pub pf2: String,
    /// `P_H`.
    pub ph: String,
    /// `P_L`.
    pub pl: String,
    /// The table that they are from.
    pub file: Option<PathBuf>,
}

impl LoadsReport {
    pub(in crate::hemodynamics) fn of(loads: &Loads, file: Option<PathBuf>) -> Self {
        let [pf1, pf2, ph, pl] =
            [&loads.proximal, &loads.distal, &loads.upstream, &loads.downstream].map(|load| load.to_string());
        Self { pf1, pf2, ph, pl, file }
    }
}

/// What a run did.
pub type SimulateReport = Report<SimulateFigures>;

/// The figures of a run.
#[derive(Debug, Clone, Serialize)]
pub struct SimulateFigures {
    /// The table.
    pub table: PathBuf,
    /// Its rows.
    pub rows: u64,
    /// The last row's time, s.
    pub last_s: Option<f64>,
    /// Capillary units.
    pub units: usize,
    /// What pressed.
    pub loads: LoadsReport,
    /// The file of the parameters; none: the thesis' table.
    pub parameters_file: Option<PathBuf>,
    /// From where.
    pub from: String,
    /// How light depends on the capillaries.
    pub optics: OpticsChoice,
    /// What happens where a vessel closes.
    pub collapse: &'static str,
    /// Until when, s.
    pub until_s: f64,
    /// Between rows, s.
    pub every_s: f64,
    /// The tolerance: the largest error of every lumen over its nominal diameter.
    pub rtol: f64,
    /// Why the run stopped.
    pub stopped: String,
    /// A vessel that closed, where a part of the table was to be kept.
    pub collapsed: Option<Collapsed>,
    /// What the solver did.
    pub work: Statistics,
    /// The parameters, by their names in files.
    #[serde(serialize_with = "crate::hemodynamics::as_map")]
    pub parameters: Vec<(String, f64)>,
}
