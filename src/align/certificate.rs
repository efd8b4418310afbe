//! The certificate of a labelled set: how the clocks were tied, how well, and what was left unlabelled.
//!
//! It is written beside the set (`training.sync.json`), and in a Parquet set's metadata too. No time of day, no
//! run time: the same input gives the same bytes.

use serde::Serialize;

use super::label::{Gap, LabelCounts, Labels};
use super::tie::{Tie, TieMethod};

/// How the clocks were tied, how well, and what was left unlabelled.
///
/// log time = offset + (1 + drift) * video time.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Certificate {
    /// lunula's version.
    pub version: &'static str,
    /// How the clocks were tied.
    pub method: TieMethod,
    /// The log's time at the video's first frame, seconds.
    pub offset_s: f64,
    /// Its standard error, seconds; `None` where not known.
    pub offset_sd_s: Option<f64>,
    /// The least and the greatest offset that agree with all that was seen, seconds.
    pub offset_interval_s: Option<[f64; 2]>,
    /// How much faster the log's clock runs than the video's, millionths.
    pub drift_ppm: f64,
    /// Its standard error, millionths; `None` where not known.
    pub drift_sd_ppm: Option<f64>,
    /// Root mean square of what the tie leaves over, seconds.
    pub residual_rms_s: Option<f64>,
    /// How sure it is that this is the right tie and no other, 0 to 1; `None` where not known.
    pub confidence: Option<f64>,
    /// Frames in which the clock was read and agrees with the rest.
    pub frames_read: u64,
    /// Frames in which it was not, or was not believed.
    pub frames_abstained: u64,
    /// How many rows have labels, and why others have not.
    #[serde(flatten)]
    pub rows: LabelCounts,
    /// Stretches of the log's time within the video that have no label of some joint.
    pub gaps: Vec<Gap>,
    /// The longest time between two frames that were seen over which labels are interpolated, seconds.
    pub max_gap_s: f64,
    /// What whoever uses the set should know.
    pub notes: Vec<String>,
}

impl Certificate {
    pub(super) fn new(tie: &Tie, labels: &Labels, notes: Vec<String>) -> Self {
        let known = |value: f64| value.is_finite().then_some(value);
        Self {
            version: env!("CARGO_PKG_VERSION"),
            method: tie.method,
            offset_s: tie.timebase.offset_s(),
            offset_sd_s: known(tie.timebase.offset_sd_s()),
            offset_interval_s: tie.offset_interval_s,
            drift_ppm: 1e6 * tie.timebase.drift,
            drift_sd_ppm: known(1e6 * tie.timebase.drift_sd),
            residual_rms_s: tie.residual_rms_s,
            confidence: tie.confidence,
            frames_read: tie.frames_read,
            frames_abstained: tie.frames_abstained,
            rows: labels.counts(),
            gaps: labels.gaps.clone(),
            max_gap_s: labels.max_gap_s,
            notes,
        }
    }
}
