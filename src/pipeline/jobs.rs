//! The jobs that pipelines know.

use crate::align::{AlignJob, JoinJob};
use crate::hemodynamics::{CurveJob, FitJob, SimulateJob};
use crate::job::{Job, Kind};
use crate::photo::{MapsJob, NormalizeJob};
use crate::posture::PostureJob;
use crate::predictor::trajectory::TrajectoryJob;
use crate::predictor::{AnalyseJob, CompareJob, EvaluateJob, PredictJob, PruneJob, TrainJob};
use crate::study::responses::ResponsesJob;
use crate::study::{PressesJob, SectionJob, StudyJob, TypicalJob};

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
    &FitJob::KIND,
    &JoinJob::KIND,
    &MapsJob::KIND,
    &NormalizeJob::KIND,
    &PostureJob::KIND,
    &PredictJob::KIND,
    &PressesJob::KIND,
    &PruneJob::KIND,
    &ResponsesJob::KIND,
    &SectionJob::KIND,
    &SimulateJob::KIND,
    &CurveJob::KIND,
    &StudyJob::KIND,
    &TrainJob::KIND,
    &TrajectoryJob::KIND,
    &TypicalJob::KIND,
];
