//! What the choice of a switch reports.

use lunula_live::switch::{Candidate, Evaluation, NoiseRate, SwitchConfig};
use serde::Serialize;

use crate::job::Report;

/// What was chosen, and how it does.
pub type TuneReport = Report<TuneFigures>;

/// The figures of a choice.
#[derive(Debug, Clone, Serialize)]
pub struct TuneFigures {
    /// The recordings.
    pub recordings: Vec<String>,
    /// What is true contact.
    pub contact: String,
    /// The choice.
    pub switch: SwitchConfig,
    /// How it does on the recordings that chose it: it flatters.
    pub chosen: Evaluation,
    /// Each recording judged by what the others choose.
    pub held_out: Option<Evaluation>,
    /// What nothing but noise would do at `on_N`, an hour, if the value were Gaussian while nothing touches (Rice).
    pub rice_per_hour: Option<f64>,
    /// The value while nothing touches.
    pub noise: Option<NoiseRate>,
    /// The fastest for each number of false switches.
    pub curve: Vec<CurvePoint>,
    /// Combinations that were tried.
    pub tried: usize,
}

/// A point of the curve of delay against false switches.
#[derive(Debug, Clone, Serialize)]
pub struct CurvePoint {
    /// False switches an hour.
    pub false_per_hour: f64,
    /// Mean delay of presses, seconds.
    pub delay_on_s: f64,
    /// The share of presses that are missed.
    pub missed_share: f64,
    /// What does it.
    #[serde(flatten)]
    pub switch: SwitchConfig,
}

impl CurvePoint {
    /// A candidate's; none where its rate or delay is not known.
    pub(super) fn of(candidate: Candidate) -> Option<Self> {
        let Candidate { config, evaluation } = candidate;
        Some(Self {
            false_per_hour: evaluation.rate?.false_per_hour,
            delay_on_s: evaluation.delay_on_s?.mean,
            missed_share: evaluation.missed as f64 / evaluation.presses.max(1) as f64,
            switch: config,
        })
    }
}
