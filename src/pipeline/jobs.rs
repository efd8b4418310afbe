//! The jobs that pipelines know.

use crate::align::{AlignJob, JoinJob};
use crate::job::{Job, Kind};
use crate::photo::{MapsJob, NormalizeJob};
use crate::posture::PostureJob;
use crate::predictor::{AnalyseJob, CompareJob, EvaluateJob, PredictJob, PruneJob, TrainJob};

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
    &MapsJob::KIND,
    &NormalizeJob::KIND,
    &PostureJob::KIND,
    &PredictJob::KIND,
    &PruneJob::KIND,
    &TrainJob::KIND,
];
