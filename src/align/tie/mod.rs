//! How the log's time follows from the video's: by the clock in the picture, by an offset that the user knows, or by
//! the lag at which the angles best explain the photodiodes.

mod agree;
mod clock;
mod correlate;
mod correlation;
mod offset;
mod zero;

pub(super) use agree::{Agreement, compare};
pub(super) use clock::{by_clock, resolution_s};
pub use correlate::{LagPeak, LagSearch, Recording};
pub use correlation::LagTie;
pub(super) use correlation::by_correlation;
pub(super) use offset::by_offset;

use crate::timebase::Timebase;

/// How two clocks were tied.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum TieMethod {
    /// By the clock in the picture.
    Clock,
    /// By an offset that the user gave.
    Offset,
    /// By the lag at which the angles best explain the photodiodes.
    Correlate,
}

/// How the log's time follows from the video's, and how surely.
#[derive(Debug, Clone, PartialEq)]
pub struct Tie {
    /// How it was found.
    pub method: TieMethod,
    /// The log's time in the video's.
    pub timebase: Timebase,
    /// The least and the greatest offset (the log's time at the video's time 0) that agree with what was seen, seconds.
    pub offset_interval_s: Option<[f64; 2]>,
    /// Root mean square of what the tie leaves over, seconds; none where there is nothing to compare.
    pub residual_rms_s: Option<f64>,
    /// For a picture: the video's time and what the tie leaves over there, seconds.
    pub residuals_s: Vec<[f64; 2]>,
    /// How sure it is that this is the right tie and no other, 0 to 1; `None` where not known.
    pub confidence: Option<f64>,
    /// Frames in which the clock was read and agrees with the rest.
    pub frames_read: u64,
    /// Frames in which it was not, or was not believed.
    pub frames_abstained: u64,
    /// What has to be known before the labels are used.
    pub warnings: Vec<String>,
    /// What was chosen or counted, and needs no action.
    pub notes: Vec<String>,
}

impl Tie {
    /// A tie of which no more is known than its timebase.
    pub(in crate::align) fn of(method: TieMethod, timebase: Timebase) -> Self {
        Self {
            method,
            timebase,
            offset_interval_s: None,
            residual_rms_s: None,
            residuals_s: Vec::new(),
            confidence: None,
            frames_read: 0,
            frames_abstained: 0,
            warnings: Vec::new(),
            notes: Vec::new(),
        }
    }

    /// Keeps what it leaves over in the frames in which the clock was read, of so many.
    fn leave_over(&mut self, residuals_s: Vec<[f64; 2]>, frames: usize) {
        let squares: f64 = residuals_s.iter().map(|p| p[1] * p[1]).sum();
        self.frames_read = residuals_s.len() as u64;
        self.frames_abstained = frames as u64 - self.frames_read;
        self.residual_rms_s = (self.frames_read > 0).then(|| (squares / self.frames_read as f64).sqrt());
        self.residuals_s = residuals_s;
    }
}
