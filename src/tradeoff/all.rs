//! A job, or all of them, measured and judged: the one entry of command line and pipelines.

use std::path::Path;
use std::time::Instant;

use super::choices::Job;
use super::judge::{Tradeoff, judge};
use super::peers::{PeerRow, read_peers};
use super::predictor::switch;
use super::{align, hemodynamics, photos, posture, predictor};
use crate::job::Interrupted;
use crate::tradeoff::measure::plan::Plan;
use crate::tradeoff::measure::scenes;

impl Plan {
    /// The rows of all tables.
    ///
    /// # Errors
    /// A table that can't be read, or a cell that is wrong, with its place.
    pub fn others(&self) -> anyhow::Result<Vec<PeerRow>> {
        let tables = self.peers.iter().map(|path| read_peers(path)).collect::<anyhow::Result<Vec<_>>>()?;
        Ok(tables.into_iter().flatten().collect())
    }

    /// On what a job is measured: figures of another scene are not compared.
    #[must_use]
    pub fn scene(&self, job: Job) -> String {
        let seed = self.seed;
        match (job, &self.input) {
            (Job::Hemodynamics, _) => hemodynamics::SCENE.to_owned(),
            (_, Some((input, _))) => input.display().to_string(),
            (Job::Photos, None) => format!("seed {seed}: {} subjects", self.subjects),
            (Job::Posture, None) => {
                let preset = format!("{:?}", self.preset).to_lowercase();
                format!("seed {seed}: {preset} {} s", scenes::seconds(self))
            }
            (Job::Align, None) => format!("seed {seed}: {} s", self.seconds),
            (Job::Predictor, None) => format!("seed {seed}: two spirals and random movement"),
            (Job::Switch, None) => format!("seed {seed}: presses and rest"),
        }
    }

    /// What photographs are measured on; made in `folder` where none are given.
    ///
    /// # Errors
    /// A scene that can't be made.
    pub fn photos(&self, folder: &Path) -> anyhow::Result<photos::Settings> {
        match self.given() {
            Some((set, truth)) => {
                let (set, truth) = (set.to_owned(), truth.to_owned());
                Ok(photos::Settings { set, truth, small: None, effort: self.effort.clone() })
            }
            None => scenes::photos(self, folder),
        }
    }

    /// What tracking is measured on; made in `folder` where no video is given.
    ///
    /// # Errors
    /// A scene that can't be made.
    pub fn posture(&self, folder: &Path) -> anyhow::Result<posture::Settings> {
        match self.given() {
            Some((input, truth)) => Ok(scenes::posture_of(input, truth.to_owned(), self)),
            None => scenes::posture(self, folder),
        }
    }

    /// What alignment is measured on; made in `folder` where no video and log are given.
    ///
    /// # Errors
    /// A scene that can't be made.
    pub fn align(&self, folder: &Path) -> anyhow::Result<align::Settings> {
        match self.given() {
            Some((input, truth)) => Ok(scenes::align_of(input, truth.to_owned(), self)),
            None => scenes::align(self, folder),
        }
    }

    /// What predictors are measured on; made in `folder` where no recordings are given.
    ///
    /// # Errors
    /// A scene that can't be made, a folder without recordings.
    pub fn predictor(&self, folder: &Path) -> anyhow::Result<predictor::Settings> {
        match self.given() {
            Some((train, test)) => scenes::predictor_of(train, test, self),
            None => scenes::predictor(self, folder),
        }
    }

    /// What the switch is measured on; made in `folder` where no recordings are given.
    ///
    /// # Errors
    /// A scene that can't be made, a folder without recordings.
    pub fn switch(&self, folder: &Path) -> anyhow::Result<switch::Settings> {
        match self.given() {
            Some((train, test)) => scenes::switch_of(train, test, self),
            None => scenes::switch(self, folder),
        }
    }

    fn given(&self) -> Option<(&Path, &Path)> {
        self.input.as_ref().map(|(input, truth)| (input.as_path(), truth.as_path()))
    }

    /// Measures and judges one job; `others` are those of [`Plan::others`].
    ///
    /// # Errors
    /// A scene that can't be made or read, a row of `others` that fits no curve, [`Interrupted`].
    pub fn run(&self, job: Job, others: &[PeerRow]) -> anyhow::Result<Tradeoff> {
        let begun = Instant::now();
        let folder = tempfile::tempdir()?;
        let folder = folder.path();
        let measured = match job {
            Job::Photos => photos::measure(&self.photos(folder)?)?,
            Job::Posture => posture::measure(&self.posture(folder)?)?,
            Job::Align => align::measure(&self.align(folder)?)?,
            Job::Predictor => predictor::measure(&self.predictor(folder)?)?,
            Job::Switch => switch::measure(&self.switch(folder)?)?,
            Job::Hemodynamics => hemodynamics::measure(&self.effort)?,
        };
        let others: Vec<&PeerRow> = others.iter().filter(|row| row.stage == job).collect();
        judge(job.name(), measured, (&self.scene(job), &others), begun)
    }
}

/// What became of each job, in the order of [`Job::ALL`].
pub type Outcomes = Vec<(Job, anyhow::Result<Tradeoff>)>;

/// Measures and judges every job, one after the other; one that fails leaves the others. `tell` is called before each.
///
/// # Errors
/// A table of other programs that can't be read; [`Interrupted`].
pub fn all(plan: &Plan, mut tell: impl FnMut(Job)) -> anyhow::Result<Outcomes> {
    let others = plan.others()?;
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
