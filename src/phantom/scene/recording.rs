//! Anything that a phantom writes into one folder: what files it will be, what is known of each, about what it costs,
//! and how it is made.
//!
//! All files are known before one of them stands, so that others can plan with them.

use std::path::Path;

use serde_json::Value;

use super::faults::Faults;
use super::place::Error;
use crate::job::{Facts, Watch};

/// What is written into one folder.
pub trait Generated: Send + Sync {
    /// Can it be made?
    ///
    /// # Errors
    /// What is wrong with the options, in the command line's words.
    fn check(&self) -> Result<(), Faults>;

    /// All that its bytes depend on.
    fn options(&self) -> Value;

    /// The files that it will be, with `/`, sorted.
    fn files(&self) -> Vec<String>;

    /// What is known of one of its files.
    fn facts(&self, _file: &str) -> Facts {
        Facts::default()
    }

    /// About what it costs.
    fn cost(&self) -> Cost;

    /// Makes it in `folder`; what a phantom of this kind wrote there before is replaced. The ticks count photographs,
    /// frames or views. The bytes are the same whatever the number of threads.
    ///
    /// # Errors
    /// Why it was not made; of each of its parts what stood before is as it was.
    fn write_watched(&self, folder: &Path, watch: &Watch<'_>) -> Result<Written, Error>;

    /// The same, watched by nobody.
    ///
    /// # Errors
    /// As [`write_watched`](Self::write_watched).
    fn write(&self, folder: &Path) -> Result<Written, Error> {
        self.write_watched(folder, &Watch::nobody())
    }
}

/// What was written.
#[derive(Debug, Default)]
pub struct Written {
    /// How many photographs, frames, views or rows.
    pub count: usize,
    /// The options as they were settled, figures and times, as a report has them.
    pub figures: Value,
    /// From beginning to end, seconds.
    pub total_s: f64,
    /// What a person has to know before using it.
    pub warnings: Vec<String>,
}

/// About what something generated costs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cost {
    /// Memory, bytes.
    pub memory: u64,
    /// Seconds on one thread.
    pub seconds: f64,
}

/// Bytes that everything takes, and a pixel of the photographs and frames under way.
const LEAST: f64 = 3e7;
const BYTES_PER_PX: f64 = 250.0;

impl Cost {
    /// Of so much memory beyond what everything takes, bytes, and of so many seconds.
    #[must_use]
    pub fn of(memory: f64, seconds: f64) -> Self {
        Self { memory: (LEAST + memory) as u64, seconds }
    }

    /// Of so many pictures of this size, of which each takes so many seconds a pixel.
    pub(in crate::phantom) fn of_pictures([width, height]: [f64; 2], pictures: f64, s_per_px: f64) -> Self {
        let pixels = width * height;
        Self::of(BYTES_PER_PX * pixels, s_per_px * pixels * pictures)
    }
}

/// Names of files, sorted.
pub(in crate::phantom) fn sorted(files: impl IntoIterator<Item: Into<String>>) -> Vec<String> {
    let mut files: Vec<String> = files.into_iter().map(Into::into).collect();
    files.sort();
    files
}
