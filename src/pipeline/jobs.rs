//! The jobs of the library, which every pipeline knows.

use crate::align::{AlignJob, JoinJob};
use crate::camera::CameraOptions;
use crate::hemodynamics::{CurveOptions, FitOptions, SimulateOptions};
use crate::job::{Job, Kind};
use crate::layout::LayoutOptions;
use crate::live::performance::PerformanceOptions;
use crate::live::skill::SkillOptions;
use crate::live::{ContactOptions, TuneOptions};
use crate::nailvideo::NailVideoJob;
use crate::photo::{MapsJob, PhotosOptions};
use crate::posture::PostureJob;
use crate::predictor::trajectory::TrajectoryOptions;
use crate::predictor::{AnalyseJob, EvaluateChoices, PredictChoices, PruneChoices, TrainChoices};

/// Their kinds, one line each, sorted by name.
#[must_use]
pub fn kinds() -> &'static [&'static Kind] {
    &[
        &AlignJob::KIND,
        &AnalyseJob::KIND,
        &CameraOptions::KIND,
        &EvaluateChoices::KIND,
        &FitOptions::KIND,
        &JoinJob::KIND,
        &LayoutOptions::KIND,
        &MapsJob::KIND,
        &NailVideoJob::KIND,
        &PhotosOptions::KIND,
        &PerformanceOptions::KIND,
        &PostureJob::KIND,
        &PredictChoices::KIND,
        &PruneChoices::KIND,
        &SimulateOptions::KIND,
        &SkillOptions::KIND,
        &CurveOptions::KIND,
        &ContactOptions::KIND,
        &TuneOptions::KIND,
        &TrainChoices::KIND,
        &TrajectoryOptions::KIND,
    ]
}
