//! What was chosen, as reported.

use std::path::PathBuf;

use serde::Serialize;

use crate::job::Report;
use crate::layout::read::{LeftOutCandidates, PersonFigures};
use crate::layout::solve::{LeftOut, Method};
use crate::nail::Positions;

/// What a run did.
pub type LayoutReport = Report<LayoutFigures>;

/// The figures of a run.
#[derive(Debug, Clone, Serialize)]
pub struct LayoutFigures {
    /// Where the results are.
    pub folder: PathBuf,
    /// What errors are: of targets over their SD, or the confusion of two poses.
    pub error_is: &'static str,
    /// What no photodiode at all reaches.
    pub error_of_none: f64,
    /// Places that were chosen from.
    pub candidates: usize,
    /// Places that were not.
    pub left_out_candidates: LeftOutCandidates,
    /// Whose rows or pictures were used.
    pub persons: Vec<PersonFigures>,
    /// Targets, or pairs of poses.
    pub targets: Vec<String>,
    /// The layout of `layout.json`.
    pub chosen: ChosenFigures,
    /// Every method for every number of photodiodes.
    pub methods: Vec<MethodFigures>,
}

/// The layout of `layout.json`.
#[derive(Debug, Clone, Serialize)]
pub struct ChosenFigures {
    /// How many photodiodes.
    pub k: usize,
    /// Why so many.
    pub why: String,
    /// The candidates, in the order of the photodiodes.
    pub candidates: Vec<String>,
    /// Their places.
    pub positions: Positions,
    /// Of each target the RMSE in its unit, mean over persons; of poses how far each two are apart (Mahalanobis).
    pub by_target: Vec<(String, f64)>,
}

/// A method's layout of so many photodiodes.
#[derive(Debug, Clone, Serialize)]
pub struct MethodFigures {
    /// How many photodiodes.
    pub k: usize,
    /// Who chose them.
    pub method: Method,
    /// On the rows that it was chosen by.
    pub error: f64,
    /// For persons who had no part in choosing it; of one person none.
    pub left_out: Option<LeftOut>,
    /// No layout has a smaller error than this; of the best only.
    pub bound: Option<f64>,
    /// Whether the bound is reached: there is none better.
    pub optimal: Option<bool>,
    /// Branches that the proof looked into.
    pub nodes: Option<u64>,
    /// The candidates, from the tip down; of all of them not listed.
    pub places: Vec<String>,
}

impl MethodFigures {
    /// `optimal`, or how far below its error another layout could be.
    #[must_use]
    pub fn proof(&self) -> Option<String> {
        let gap = self.error - self.bound?;
        Some(if self.optimal? { "optimal".to_owned() } else { format!("gap {gap:.4}") })
    }
}
