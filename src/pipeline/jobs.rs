//! The jobs of the library, which every pipeline knows.

use crate::align::{AlignJob, JoinJob};
use crate::camera::CameraJob;
use crate::hemodynamics::{CurveJob, FitJob, SimulateJob};
use crate::job::{Job, Kind};
use crate::layout::LayoutJob;
use crate::live::performance::PerformanceJob;
use crate::live::skill::SkillJob;
use crate::live::{EvaluateSwitchJob, TuneSwitchJob};
use crate::nailvideo::NailVideoJob;
use crate::photo::{MapsJob, NormalizeJob};
use crate::posture::PostureJob;
use crate::predictor::trajectory::TrajectoryJob;
use crate::predictor::{AnalyseJob, EvaluateJob, PredictJob, PruneJob, TrainJob};

/// Their kinds, by name.
#[must_use]
pub fn kinds() -> &'static [&'static Kind] {
    KINDS
}

/// One line per kind, sorted by name.
static KINDS: &[&Kind] = &[
    &AlignJob::KIND,
    &AnalyseJob::KIND,
    &CameraJob::KIND,
    &EvaluateJob::KIND,
    &FitJob::KIND,
    &JoinJob::KIND,
    &LayoutJob::KIND,
    &MapsJob::KIND,
    &NailVideoJob::KIND,
    &NormalizeJob::KIND,
    &PerformanceJob::KIND,
    &PostureJob::KIND,
    &PredictJob::KIND,
    &PruneJob::KIND,
    &SimulateJob::KIND,
    &SkillJob::KIND,
    &CurveJob::KIND,
    &EvaluateSwitchJob::KIND,
    &TuneSwitchJob::KIND,
    &TrainJob::KIND,
    &TrajectoryJob::KIND,
];
