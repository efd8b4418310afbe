//! Where a job's results go, and which of them.

use std::path::PathBuf;

use super::kind::Demand;
use crate::stages::Step;

/// Where a job's results go, and which of them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Outputs {
    /// The file that the job is run for, beside which the others stand, named after it; or the folder of all.
    pub out: PathBuf,
    /// Whether the table with one row per row of the recordings is written, where the job has one.
    pub rows: bool,
    /// Whether pictures are drawn.
    pub figures: bool,
    /// Whether the report is written, with its times and the files' places; a pipeline has its own record.
    pub report: bool,
}

impl Outputs {
    /// All there is.
    #[must_use]
    pub fn all(out: PathBuf) -> Self {
        Self { out, rows: true, figures: true, report: true }
    }

    /// A step of plans for the pictures; `what` they show.
    #[must_use]
    pub fn figures_step(outputs: Option<&Self>, what: &str) -> Step {
        match outputs {
            None => Step::new("figures", false, "no --out".to_owned()),
            Some(outputs) => Step::figures(outputs.figures, what),
        }
    }

    /// A step of plans for a table that is always written where there is a folder.
    #[must_use]
    pub fn table_step(outputs: Option<&Self>, what: &str) -> Step {
        let there = outputs.is_some();
        Step::new("tables", there, if there { what } else { "no --out" }.to_owned())
    }
}

impl Demand {
    /// A stage's outputs, without a report of their own.
    #[must_use]
    pub fn outputs(&self, out: impl Into<PathBuf>) -> Outputs {
        Outputs { out: out.into(), rows: true, figures: self.draws(), report: false }
    }
}
