//! What a run says of itself.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::job::Report;
use crate::nailvideo::options::{Light, Window};

/// The report of a run.
pub type NailVideoReport = Report<NailVideoFigures>;

/// The job's own figures.
#[derive(Debug, Clone, Serialize)]
pub struct NailVideoFigures {
    /// Frames of the video.
    pub frames: FrameCounts,
    /// The nail in the first good frame.
    pub nail: NailFigures,
    /// What of the light is taken off.
    pub light: Light,
    /// The unit of the photodiodes' values.
    pub unit: &'static str,
    /// Where the photodiodes are from, in words.
    pub positions: String,
    /// Each photodiode.
    pub photodiodes: Vec<PhotodiodeFigures>,
    /// Standard error of the nail's place, median over frames, pixels.
    pub se_px: Option<f64>,
    /// Correlation with the first good frame, median over frames.
    pub correlation: Option<f64>,
    /// How coarsely the video is encoded: H.264's quantization parameter, median over frames; other codecs don't tell.
    pub quantizer: Option<f64>,
    /// Presses found, each with its release or not.
    pub presses: usize,
    /// Courses of presses and releases that have figures, and those that are refused, by reason.
    pub courses: BTreeMap<String, usize>,
    /// What the figures on presses may be used for.
    pub presses_are_for: &'static str,
    /// Maps over times.
    pub maps: Vec<MapFigures>,
    /// Share of the wall time that went into decoding.
    pub decoding_share: f64,
}

/// Frames by what became of them.
#[derive(Debug, Clone, Default, Serialize)]
pub struct FrameCounts {
    /// All.
    pub all: u64,
    /// Those in which the nail was followed.
    pub followed: u64,
    /// The others, by reason.
    pub lost: BTreeMap<String, u64>,
    /// The first good frame.
    pub first: u64,
}

/// The nail in the first good frame.
#[derive(Debug, Clone, Serialize)]
pub struct NailFigures {
    /// Where its outline came from.
    pub outline: &'static str,
    /// Extent across, pixels.
    pub width_px: f64,
    /// Extent along the axis, pixels.
    pub length_px: f64,
    /// Clockwise from up.
    pub axis_deg: f64,
}

/// One photodiode over the video.
#[derive(Debug, Clone, Serialize)]
pub struct PhotodiodeFigures {
    /// Its name.
    pub name: String,
    /// Frames with a value.
    pub frames: u64,
    /// Frames in which the nail was followed and this had no value, by reason.
    pub absent: BTreeMap<String, u64>,
    /// Noise of one sample: SD of what changes from frame to frame, in the unit of the values.
    pub noise_sd: Option<f64>,
}

/// A map over some time.
#[derive(Debug, Clone, Serialize)]
pub struct MapFigures {
    /// The time.
    pub window: Window,
    /// Frames in it in which the nail was followed.
    pub frames: u64,
}
