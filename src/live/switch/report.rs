//! What the choice of a switch reports, and what any report on a switch says of its recordings.

use lunula_live::switch::{Candidate, Evaluation, NoiseRate, SwitchConfig};
use serde::Serialize;

use super::options::ContactOptions;
use super::traces::SwitchInputs;
use crate::job::Report;
use crate::log::AmbientRule;

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

/// Notes what of the recordings is not counted, and options of reading that they do not need; `led`: whether one of
/// them says when the LED was on.
pub(super) fn note<F: Serialize>(
    report: &mut Report<F>,
    found: &Evaluation,
    inputs: &SwitchInputs,
    options: &ContactOptions,
    led: bool,
) {
    if found.unknown_s > 0.0 || found.not_judged > 0 {
        report.notes.push(format!(
            "contact is not known for {:.1} s, which are not counted; presses that begin there, {}, are neither true \
             nor false; contacts of which the beginning or the end is not known, {}, count neither as pressed nor as \
             missed",
            found.unknown_s, found.not_judged, found.cut_off
        ));
    }
    if !led {
        report.unused(&["ambient", "full_scale"], "no recording says when its LED was on");
    } else if options.log.ambient.rule == AmbientRule::Interpolated {
        let why = "rows are read as a stream gives them, and from each lit row the unlit row before it is taken away";
        report.unused(&["ambient"], why);
    }
    if !inputs.recordings.iter().any(|one| one.path.to_string_lossy().to_lowercase().contains(".xdf")) {
        report.unused(&["stream"], "only recordings of the Lab Streaming Layer have streams");
    }
}

/// That a switch's thresholds were chosen on the predictions of another model than this.
pub(crate) fn of_another_model(switch: &SwitchConfig, model_sha256: Option<&str>) -> Option<String> {
    let (chosen_on, this) = switch.model_sha256.as_deref().zip(model_sha256)?;
    (chosen_on != this).then(|| {
        format!(
            "the switch was chosen on predictions of another model (sha256 {:.8}.. in its file, {this:.8}.. in this \
             model's): its thresholds need not fit; choose it again with `lunula switch tune`",
            chosen_on
        )
    })
}
