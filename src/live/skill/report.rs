//! What fingers did: by trial, by person, over people.

use std::collections::BTreeMap;

use lunula_live::skill::Figures;
use lunula_live::spread::Spread;
use serde::Serialize;

use crate::job::Report;

/// What a run did.
pub type SkillReport = Report<SkillFigures>;

/// The figures of all recordings.
#[derive(Debug, Clone, Serialize)]
pub struct SkillFigures {
    /// What was compared with; none: nothing was.
    pub reference: Option<String>,
    /// Each trial, in the recordings' order.
    pub trials: Vec<TrialFigures>,
    /// Each person, over trials.
    pub people: Vec<PersonFigures>,
    /// Each finger over the people's means; empty where nobody is named.
    pub over_people: Vec<FingerSpread>,
}

/// One trial.
#[derive(Debug, Clone, Serialize)]
pub struct TrialFigures {
    /// The recording.
    pub recording: String,
    /// The person; none where nobody is named.
    pub subject: Option<String>,
    /// The trial.
    pub trial: String,
    /// The time of its first row, seconds of the recording.
    pub from_s: f64,
    /// From its first row to its last, seconds.
    pub seconds: f64,
    /// Its fingers.
    pub fingers: Vec<FingerFigures>,
    /// The finger that touched first (several with `+` between them); none where nobody touched or that was not seen.
    pub first: Option<String>,
    /// Angles in rows in bending; empty where no gate says which those are.
    pub posture: Vec<PostureFigures>,
}

/// A finger in a trial.
#[derive(Debug, Clone, Serialize)]
pub struct FingerFigures {
    /// Its name.
    pub finger: String,
    /// What it did.
    #[serde(flatten)]
    pub figures: Figures,
    /// When it first touched, seconds from the trial's first row; none where it did not, or that was not seen.
    pub onset_s: Option<f64>,
    /// Its place in the order of fingers, from 1 on; none where it did not touch, or that is not known.
    pub rank: Option<usize>,
    /// Mean distance from the reference along the warped time, newtons; none without a reference, of the reference
    /// itself, or where one of both has no contact, not this finger, or too much that is not known.
    pub distance_n: Option<f64>,
}

/// An angle in the rows in which the finger bends.
#[derive(Debug, Clone, Serialize)]
pub struct PostureFigures {
    /// The finger.
    pub finger: String,
    /// The angle's column.
    pub angle: String,
    /// Rows in bending, degrees; SD with n - 1.
    #[serde(flatten)]
    pub over_rows: Spread,
    /// The smallest, degrees.
    pub lowest: f64,
    /// The largest, degrees.
    pub highest: f64,
}

/// One person over trials.
#[derive(Debug, Clone, Serialize)]
pub struct PersonFigures {
    /// None where nobody is named.
    pub subject: Option<String>,
    /// The trials.
    pub trials: usize,
    /// Each finger over trials.
    pub fingers: Vec<FingerSpread>,
    /// In how many trials each finger touched first.
    pub first: BTreeMap<String, usize>,
}

/// A finger's figures over trials or people: mean, SD with n - 1, n.
#[derive(Debug, Clone, Serialize)]
pub struct FingerSpread {
    /// The finger.
    pub finger: String,
    /// By figure; none where it is not known in any.
    pub over: BTreeMap<&'static str, Option<Spread>>,
}

/// A figure that is summed up, as tables and pictures call it.
pub(super) struct Measure {
    /// Its column, with the unit.
    pub(super) name: &'static str,
    pub(super) axis: &'static str,
    pub(super) of: fn(&FingerFigures) -> Option<f64>,
}

/// All figures that are summed up over trials and people.
pub(super) const MEASURES: [Measure; 9] = [
    Measure { name: "contact_s", axis: "time in contact, s", of: |one| one.figures.contact_s },
    Measure { name: "presses", axis: "presses", of: |one| one.figures.presses.map(|presses| presses as f64) },
    Measure { name: "peak_N", axis: "peak force, N", of: |one| one.figures.peak_n },
    Measure { name: "mean_N", axis: "mean force in contact, N", of: |one| one.figures.mean_n },
    Measure { name: "impulse_Ns", axis: "impulse, N s", of: |one| one.figures.impulse_ns },
    Measure { name: "peak_rise_N_per_s", axis: "fastest rise, N/s", of: |one| one.figures.peak_rise_n_per_s },
    Measure { name: "smoothness", axis: "spectral arc length", of: |one| one.figures.smoothness },
    Measure { name: "onset_s", axis: "first touch, s", of: |one| one.onset_s },
    Measure { name: "distance_N", axis: "distance from reference, N", of: |one| one.distance_n },
];
