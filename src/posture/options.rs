//! How a video is worked on, and where results go.

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

use super::marker::method::Method;

/// How to work.
#[derive(Debug, Clone)]
pub struct PostureOptions {
    /// Threads that decode (0: all cores).
    pub threads: usize,
    /// Smooth the angles over time.
    pub smooth: bool,
    /// How centres are found.
    pub method: Method,
    /// Every so many frames the clock of the layout is read, after the first second and a half, in which its digits are
    /// learnt from all; 0: it is not read.
    pub clock_every: u64,
}

impl Default for PostureOptions {
    fn default() -> Self {
        Self { threads: 0, smooth: false, method: Method::default(), clock_every: 1 }
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
}

/// A caller's view of a running job.
pub struct Watch<'a> {
    /// Becomes true where the job is to stop.
    pub stop: &'a AtomicBool,
    /// Called with the frames done, and with all of them where the container tells.
    pub tick: &'a dyn Fn(u64, Option<u64>),
}
