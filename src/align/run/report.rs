//! What a run of the alignment job did: the JSON beside the labelled set.

use std::path::PathBuf;

use serde::Serialize;

use crate::align::certificate::Certificate;
use crate::align::label::Labels;
use crate::job::Report;

/// What a run did.
pub type AlignReport = Report<AlignFigures>;

/// The figures of a run.
#[derive(Debug, Clone, Serialize)]
pub struct AlignFigures {
    /// The table of angles.
    pub joints: PathBuf,
    /// The log.
    pub log: PathBuf,
    /// Rows of the log.
    pub rows_read: u64,
    /// Rows of the set.
    pub rows: u64,
    /// Rows of the set in which a photodiode is saturated or has no ambient light to be subtracted.
    pub rows_with_faults: u64,
    /// How the clocks were tied, how well, and what was left unlabelled.
    pub certificate: Certificate,
    /// The joints' labels, in the table's order.
    pub labels: Vec<LabelReport>,
}

/// How a joint's labels came out.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LabelReport {
    /// The joint.
    pub joint: String,
    /// Rows with its label.
    pub rows: u64,
    /// The root mean square of the labels' standard errors, degrees; none where none is known.
    pub sd_deg: Option<f64>,
}

impl LabelReport {
    pub(in crate::align) fn of(labels: &Labels) -> Vec<Self> {
        let report = |(k, joint): (usize, &String)| {
            let known = labels.sds_deg[k].iter().filter(|sd| sd.is_finite());
            let (squares, count) = known.fold((0.0, 0_u64), |(squares, count), sd| (squares + sd * sd, count + 1));
            let rows = labels.angles_deg[k].iter().filter(|angle| angle.is_finite()).count() as u64;
            let sd_deg = (count > 0).then(|| (squares / count as f64).sqrt());
            Self { joint: joint.clone(), rows, sd_deg }
        };
        labels.joints.iter().enumerate().map(report).collect()
    }
}
