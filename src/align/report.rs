//! What a run of the alignment job did: the JSON beside the labelled set.

use std::path::PathBuf;

use serde::Serialize;

use super::certificate::Certificate;
use crate::stages::Stage;

/// What a run did.
#[derive(Debug, Clone, Serialize)]
pub struct AlignReport {
    /// Which job.
    pub job: &'static str,
    /// The table of angles.
    pub joints: PathBuf,
    /// The log.
    pub log: PathBuf,
    /// Rows of the log.
    pub rows_read: u64,
    /// Rows of the set.
    pub rows: u64,
    /// Rows of the set in which a photodiode is saturated or has no ambient light to be taken away.
    pub rows_with_faults: u64,
    /// How the clocks were tied, how well, and what was left unlabelled.
    pub certificate: Certificate,
    /// What the recordings did not need.
    pub left_out: Vec<String>,
    /// What whoever uses the set should know.
    pub warnings: Vec<String>,
    /// What of the input could not be used, each with what to do.
    pub failed: Vec<String>,
    /// The pictures that a person looks at first.
    pub pictures: Vec<PathBuf>,
    /// Time by stage.
    pub stages: Vec<Stage>,
    /// Seconds from start to end, this report not counted.
    pub wall_s: f64,
}
