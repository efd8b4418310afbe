//! On what and how jobs are measured.

use std::path::PathBuf;

use super::timing::Effort;
use crate::phantom::video::Preset;

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
    /// Tables of other programs' figures.
    pub peers: Vec<PathBuf>,
}

impl Plan {
    /// Synthetic scenes of `seed`; in a hurry small ones.
    #[must_use]
    pub fn new(seed: u64, effort: Effort, peers: Vec<PathBuf>) -> Self {
        let (subjects, seconds) = if effort.quick { (4, 20.0) } else { (16, 60.0) };
        Self { seed, input: None, subjects, preset: Preset::Clean, seconds, effort, peers }
    }
}
