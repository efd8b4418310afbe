//! The jobs that pipelines know.

mod phantom;

use crate::align::{AlignJob, JoinJob};
use crate::job::{Job, Kind};
use crate::posture::PostureJob;
use crate::predictor::{AnalyseJob, CompareJob, EvaluateJob, PredictJob, PruneJob, TrainJob};

pub use phantom::phantom_catalogue;

/// All kinds of jobs, by name.
#[must_use]
pub fn kinds() -> &'static [&'static Kind] {
    KINDS
}

/// One line per kind, sorted by name.
static KINDS: &[&Kind] = &[
    &AlignJob::KIND,
    &AnalyseJob::KIND,
    &CompareJob::KIND,
    &EvaluateJob::KIND,
    &JoinJob::KIND,
    &PostureJob::KIND,
    &PredictJob::KIND,
    &PruneJob::KIND,
    &TrainJob::KIND,
];
