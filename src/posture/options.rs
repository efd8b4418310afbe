//! How a video is worked on, and where results go.

use std::path::PathBuf;

use clap::Args;

use super::marker::method::Method;
use crate::job;

/// How to work: the options of `lunula posture` and of a pipeline's stage.
#[derive(Debug, Clone, Args)]
pub struct PostureOptions {
    /// Only these joints of the marker file, with the markers that they need
    #[arg(long, value_name = "J1,J2", value_delimiter = ',')]
    pub joints: Vec<String>,
    /// Do not read the clock in the picture
    #[arg(long)]
    pub no_clock: bool,
    /// Smooth the angles over time (forward and backward); what is missing stays missing
    #[arg(long)]
    pub smooth: bool,
    /// How centres are found.
    #[arg(skip)]
    pub method: Method,
    /// The clock is read in one of so many frames, after the first second and a half, in which its digits are learnt
    /// from all.
    #[arg(skip = 1_u64)]
    pub clock_every: u64,
    /// Threads that decode (0: all cores).
    #[arg(skip)]
    pub threads: usize,
}

impl PostureOptions {
    /// Whether the clock that a marker file names is read.
    #[must_use]
    pub fn reads_clock(&self) -> bool {
        !self.no_clock && self.clock_every > 0
    }
}

impl Default for PostureOptions {
    fn default() -> Self {
        job::defaults()
    }
}

/// Where results go.
#[derive(Debug, Clone)]
pub struct Outputs {
    /// The table of angles; report and pictures stand beside it, named after it.
    pub joints: PathBuf,
    /// The table of markers.
    pub tracks: Option<PathBuf>,
    /// The video with what was tracked.
    pub overlay: Option<PathBuf>,
    /// Whether pictures are drawn.
    pub figures: bool,
    /// Whether the report is written beside the table.
    pub report: bool,
}
