//! One trial's figures, and the trial that others are compared with.

use lunula_live::skill::{Contact, Figures, Force, MOST_POINTS, Thresholds, distance, ranks, resampled};

use super::read::{Recording, Trial, read};
use super::report::{FingerFigures, PostureFigures, TrialFigures};
use super::{SkillInputs, SkillOptions};
use crate::input::same_to_the_byte;
use crate::live::error::LiveError;
use crate::predictor::DataFile;

/// So many trials are named in a message.
const MOST_NAMED: usize = 10;

/// The trial that others are compared with.
#[derive(Debug, Clone)]
pub(super) struct Reference {
    /// What results call it.
    pub(super) name: String,
    trial: Trial,
    /// From the first contact of any finger to the last, seconds; none without contact.
    span_s: Option<[f64; 2]>,
    /// The recordings of which it is a trial, which is not compared with itself.
    within: Vec<String>,
}

impl Reference {
    /// The trial that others are compared with, if one is to be.
    ///
    /// # Errors
    /// A recording that can't be read or holds several trials, or a name that none or several have.
    pub(super) fn find(inputs: &SkillInputs, options: &SkillOptions) -> Result<Option<Self>, LiveError> {
        match (&inputs.reference, &options.reference_trial) {
            (Some(recording), _) => Self::recorded(recording, &inputs.recordings, options).map(Some),
            (None, Some(name)) => Self::named(name, &inputs.recordings, options),
            (None, None) => Ok(None),
        }
    }

    fn recorded(recording: &DataFile, others: &[DataFile], options: &SkillOptions) -> Result<Self, LiveError> {
        let mut trials = read(recording, &options.finger)?.trials;
        let files = std::iter::once(recording).chain(others).map(|one| (one, one.path.as_path()));
        // A file that is named twice is one, and so is its copy.
        let same = same_to_the_byte(files).into_iter().find(|same| std::ptr::eq(same[0].0, recording));
        let within = same.into_iter().flatten().skip(1).map(|(one, _)| one.name.clone()).collect();
        match (trials.len(), trials.pop()) {
            (1, Some(trial)) => Ok(Self::of(recording.name.clone(), trial, within, &options.thresholds())),
            _ => Err(LiveError::Faults(vec![format!(
                "{}: holds several trials; a reference is one: give a recording of it, or name it as \
                 --reference-trial",
                recording.name
            )])),
        }
    }

    fn named(wanted: &str, recordings: &[DataFile], options: &SkillOptions) -> Result<Option<Self>, LiveError> {
        let refused = |what: String| Err(LiveError::Faults(vec![format!("--reference-trial {wanted}: {what}")]));
        let (mut first, mut matching, mut others) = (None, Vec::new(), Vec::new());
        for recording in recordings {
            // What can't be read is reported as such later.
            let Ok(Recording { trials, .. }) = read(recording, &options.finger) else { continue };
            for trial in trials {
                let name = match &trial.subject {
                    Some(subject) => format!("{subject}/{}", trial.trial),
                    None => trial.trial.clone(),
                };
                if wanted == trial.trial || wanted == name {
                    first.get_or_insert((name.clone(), trial, recording.name.clone()));
                    matching.push(name);
                } else if others.len() < MOST_NAMED {
                    others.push(name);
                }
            }
        }
        match (first, matching.len()) {
            (None, _) if others.is_empty() => Ok(None),
            (None, _) => refused(format!("there is no such trial; there are {}", others.join(", "))),
            (Some((name, trial, within)), 1) => Ok(Some(Self::of(name, trial, vec![within], &options.thresholds()))),
            (_, many) => {
                matching.truncate(MOST_NAMED);
                refused(format!("there are {many} of this name ({}); write SUBJECT/TRIAL", matching.join(", ")))
            }
        }
    }

    fn of(name: String, trial: Trial, within: Vec<String>, thresholds: &Thresholds) -> Self {
        let touched: Vec<Vec<Contact>> =
            trial.fingers.iter().map(|finger| Figures::of(&finger.force, thresholds).1).collect();
        Self { name, span_s: span_s(&touched), trial, within }
    }

    /// Whether it touches at all.
    pub(super) fn touches(&self) -> bool {
        self.span_s.is_some()
    }

    /// Whether it is this very trial of a recording.
    fn is(&self, recording: &str, trial: &Trial) -> bool {
        self.within.iter().any(|name| name == recording)
            && self.trial.subject == trial.subject
            && self.trial.trial == trial.trial
    }

    /// How far a finger's force is from the same finger's here.
    fn distance(&self, finger: &str, force: &Force, span_s: Option<[f64; 2]>, band: f64) -> Option<f64> {
        let own = &self.trial.fingers.iter().find(|own| own.name == finger)?.force;
        let (spans, forces) = ([self.span_s?, span_s?], [own, force]);
        let longest_s = spans.iter().map(|[from_s, to_s]| to_s - from_s).fold(0.0, f64::max);
        let period_s = own.period_s()?.max(force.period_s()?).max(longest_s / (MOST_POINTS - 1) as f64);
        let course = |k: usize| resampled(forces[k], spans[k][0], spans[k][1], period_s);
        distance(&course(0)?, &course(1)?, band)
    }
}

/// From the first contact of any finger to the last.
fn span_s(touched: &[Vec<Contact>]) -> Option<[f64; 2]> {
    let all = || touched.iter().flatten();
    let from_s = all().map(|contact| contact.from_s).reduce(f64::min)?;
    Some([from_s, all().map(|contact| contact.to_s).reduce(f64::max)?])
}

/// The figures of a trial, and each finger's contacts.
pub(super) fn figures(
    recording: &str,
    trial: &Trial,
    reference: Option<&Reference>,
    options: &SkillOptions,
) -> (TrialFigures, Vec<Vec<Contact>>) {
    let thresholds = options.thresholds();
    let (figures, touched): (Vec<Figures>, Vec<Vec<Contact>>) =
        trial.fingers.iter().map(|finger| Figures::of(&finger.force, &thresholds)).unzip();
    // Fingers that are recorded row by row begin and end within a step of each other.
    let times_s = || trial.fingers.iter().map(|finger| &finger.force.time_s);
    let from_s = times_s().filter_map(|times_s| times_s.first()).copied().fold(f64::NAN, f64::min);
    let to_s = times_s().filter_map(|times_s| times_s.last()).copied().fold(f64::NAN, f64::max);
    let both: Vec<(&Figures, &[Contact])> = figures.iter().zip(&touched).map(|(a, b)| (a, b.as_slice())).collect();
    let ranks = ranks(&both);
    let span_s = span_s(&touched);
    let band = 0.01 * options.band_percent;
    let reference = reference.filter(|one| !one.is(recording, trial));
    let fingers = trial.fingers.iter().zip(figures).zip(&ranks).map(|((finger, figures), rank)| FingerFigures {
        finger: finger.name.clone(),
        onset_s: figures.first_s.map(|first_s| first_s - from_s),
        rank: *rank,
        distance_n: reference.and_then(|one| one.distance(&finger.name, &finger.force, span_s, band)),
        figures,
    });
    let fingers: Vec<FingerFigures> = fingers.collect();
    let first: Vec<&str> = fingers.iter().filter(|one| one.rank == Some(1)).map(|one| one.finger.as_str()).collect();
    let posture = trial.fingers.iter().flat_map(|finger| {
        finger.angles.iter().map(|(angle, over_rows, [lowest, highest])| PostureFigures {
            finger: finger.name.clone(),
            angle: angle.clone(),
            over_rows: *over_rows,
            lowest: *lowest,
            highest: *highest,
        })
    });
    let figures = TrialFigures {
        recording: recording.to_owned(),
        subject: trial.subject.clone(),
        trial: trial.trial.clone(),
        from_s,
        seconds: to_s - from_s,
        first: (!first.is_empty()).then(|| first.join("+")),
        posture: posture.collect(),
        fingers,
    };
    (figures, touched)
}
