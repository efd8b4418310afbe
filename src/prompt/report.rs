//! What a prompted session reports.

use std::path::PathBuf;

use lunula_predictor::ConeCoverage;
use serde::Serialize;

use super::cover::Extra;
use super::desk::Shared;
use super::frames::FrameFigures;
use super::run::{Phase, Turn};
use crate::job::Report;

/// How a prompted session went.
pub type PromptReport = Report<PromptFigures>;

/// The figures of a prompted session.
#[derive(Debug, Clone, Serialize)]
pub struct PromptFigures {
    /// The recording.
    pub out: PathBuf,
    /// Rows that were recorded.
    pub rows: usize,
    /// Whether all steps were gone through.
    pub completed: bool,
    /// What happened, in order.
    pub turns: Vec<Turn>,
    /// How well each step was followed.
    pub followed: Vec<StepFigures>,
    /// How evenly the recorded rows cover the cone: `cone_coverage` of the recording, the finger in the air below
    /// `rest_n`.
    pub coverage: ConeCoverage,
    /// The least force of a finger that touches, newtons.
    pub rest_n: f64,
    /// What would fill what is missing.
    pub extra: Option<Extra>,
    /// The protocol's file of it.
    pub extra_file: Option<PathBuf>,
    /// What a page has shown.
    pub frames: Option<FrameFigures>,
    /// The table of it.
    pub frames_file: Option<PathBuf>,
}

/// A step that was followed.
#[derive(Debug, Clone, Serialize)]
pub struct StepFigures {
    /// The step.
    pub step: String,
    /// Forces that were measured while it was collected.
    pub forces: u64,
    /// Their RMS distance from what was prompted then, newtons; a person's lag is in it.
    pub rms_n: Option<f64>,
}

pub(super) fn figures(shared: &Shared, out: PathBuf) -> PromptFigures {
    let steps = &shared.run.protocol.steps;
    let followed = shared.followed.iter().enumerate().filter(|(_, followed)| followed.forces > 0);
    let step = |place: usize| steps.get(place).map_or(String::new(), |step| step.name.clone());
    let (place, count) = shared.run.place();
    PromptFigures {
        out,
        rows: shared.cover.rows(),
        completed: place >= count && matches!(shared.run.phase().0, Phase::Done | Phase::Over),
        turns: shared.run.turns.clone(),
        followed: followed
            .map(|(place, followed)| StepFigures {
                step: step(place),
                forces: followed.forces,
                rms_n: shared.followed_n(place),
            })
            .collect(),
        coverage: shared.cover.coverage(),
        rest_n: super::cover::REST_N,
        extra: shared.cover.extra(),
        extra_file: None,
        frames: shared.frames.figures(),
        frames_file: None,
    }
}
