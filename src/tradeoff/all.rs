//! A job, or all of them, measured and judged: the one entry of command line and pipelines.

use std::path::PathBuf;
use std::time::Instant;

use super::judge::{Tradeoff, judge};
use super::peers::{Peers, Python};
use super::{align, hemodynamics, photos, posture, predictor};
use crate::job::Interrupted;
use crate::phantom::video::Preset;
use crate::tradeoff::measure::rows::Row;
use crate::tradeoff::measure::scenes::{self, Wanted};
use crate::tradeoff::measure::timing::Effort;

/// What can be measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Job {
    /// Photographs to maps.
    Photos,
    /// Video to joint angles.
    Posture,
    /// Angles onto logs.
    Align,
    /// Photodiodes to force.
    Predictor,
    /// Pressure to blood flow.
    Hemodynamics,
}

impl Job {
    /// In the order of the page.
    pub const ALL: [Self; 5] = [Self::Photos, Self::Posture, Self::Align, Self::Predictor, Self::Hemodynamics];

    /// As on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Photos => photos::RESAMPLING.0,
            Self::Posture => posture::TRACKING.0,
            Self::Align => align::TYING.0,
            Self::Predictor => predictor::MODEL.0,
            Self::Hemodynamics => hemodynamics::SOLVING.0,
        }
    }
}

/// On what and how is measured.
#[derive(Debug, Clone)]
pub struct Plan {
    /// Seed of the synthetic scenes.
    pub seed: u64,
    /// A folder to measure on, with its truth, as `lunula phantom` writes them; none: synthetic scenes.
    pub input: Option<(PathBuf, PathBuf)>,
    /// Subjects of the synthetic photographs, in four poses.
    pub subjects: u32,
    /// The synthetic video of a finger.
    pub preset: Preset,
    /// Length of the synthetic video and log that are aligned, seconds.
    pub seconds: f64,
    /// How much.
    pub effort: Effort,
    /// Other programs.
    pub peers: Peers,
}

impl Plan {
    /// Synthetic scenes of `seed`; in a hurry small ones.
    #[must_use]
    pub fn new(seed: u64, effort: Effort, peers: Peers) -> Self {
        let (subjects, seconds) = if effort.quick { (4, 20.0) } else { (16, 60.0) };
        Self { seed, input: None, subjects, preset: Preset::Clean, seconds, effort, peers }
    }

    /// Measures and judges one job; `others` are the rows of [`Peers::read`].
    ///
    /// # Errors
    /// A scene that can't be made or read, a row of `others` that fits no curve, [`Interrupted`].
    pub fn run(&self, job: Job, others: &[Row]) -> anyhow::Result<Tradeoff> {
        let begun = Instant::now();
        let python = Python::new(self.peers.measured);
        let wanted = Wanted { seed: self.seed, effort: self.effort.clone(), python };
        let folder = tempfile::tempdir()?;
        let folder = folder.path();
        let given = self.input.as_ref().map(|(input, truth)| (input.as_path(), truth.clone()));
        let (measured, maps) = match job {
            Job::Photos => {
                let settings = match given {
                    Some((set, truth)) => photos::Settings {
                        set: set.to_owned(),
                        truth,
                        small: None,
                        effort: wanted.effort,
                        python: wanted.python,
                    },
                    None => scenes::photos(&wanted, self.subjects, folder)?,
                };
                (photos::measure(&settings)?, Vec::new())
            }
            Job::Posture => {
                let settings = match given {
                    Some((input, truth)) => scenes::posture_of(input, truth, &wanted),
                    None => scenes::posture(&wanted, self.preset, folder)?,
                };
                (posture::measure(&settings)?, Vec::new())
            }
            Job::Align => {
                let settings = match given {
                    Some((input, truth)) => scenes::align_of(input, truth, &wanted),
                    None => scenes::align(&wanted, self.seconds, folder)?,
                };
                (align::measure(&settings)?, Vec::new())
            }
            Job::Predictor => {
                let settings = match given {
                    Some((train, test)) => scenes::predictor_of(train, &test, &wanted)?,
                    None => scenes::predictor(&wanted, folder)?,
                };
                (predictor::measure(&settings)?, Vec::new())
            }
            Job::Hemodynamics => {
                let settings = hemodynamics::Settings { effort: wanted.effort, python: wanted.python };
                (hemodynamics::measure(&settings)?, hemodynamics::stability()?)
            }
        };
        Ok(Tradeoff { maps, ..judge(job.name(), measured, others, begun)? })
    }
}

/// What became of each job, in the order of [`Job::ALL`].
pub type Outcomes = Vec<(Job, anyhow::Result<Tradeoff>)>;

/// Measures and judges every job, one after the other; one that fails leaves the others. `tell` is called before each.
///
/// # Errors
/// A table of other programs that can't be read; [`Interrupted`].
pub fn all(plan: &Plan, mut tell: impl FnMut(Job)) -> anyhow::Result<Outcomes> {
    let others = plan.peers.read()?;
    let mut done = Vec::new();
    for job in Job::ALL {
        tell(job);
        let mut own = plan.clone();
        if job == Job::Hemodynamics {
            // A response takes a tenth of a millisecond.
            own.effort.repeats *= HEMODYNAMICS;
        }
        let found = own.run(job, &others);
        if found.as_ref().is_err_and(|why| why.chain().any(|one| one.is::<Interrupted>())) {
            found?;
            continue;
        }
        done.push((job, found));
    }
    Ok(done)
}

/// So many times the repeats.
const HEMODYNAMICS: usize = 3;
