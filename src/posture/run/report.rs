//! What a run of the posture job did, saw and left out: the JSON beside the table of angles.

use std::path::PathBuf;

use serde::Serialize;

use crate::job::Report;
use crate::posture::angle::joints::Angle;
use crate::posture::angle::smooth::SmoothModel;
use crate::posture::layout::MarkerShape;
use crate::posture::marker::sight::{Loss, Sight};
use crate::posture::run::filmed_clock::ClockReport;

/// What a run did.
pub type PostureReport = Report<PostureFigures>;

/// The figures of a run.
#[derive(Debug, Clone, Serialize)]
pub struct PostureFigures {
    /// The video.
    pub video: VideoReport,
    /// How many frames there were.
    pub frames: FrameCounts,
    /// The markers that were tracked, in the marker file's order.
    pub markers: Vec<MarkerReport>,
    /// The joints, in the marker file's order.
    pub joints: Vec<JointReport>,
    /// The last joint against the one before (Fig. 33); none where there are no two joints or too few angles.
    pub coupling: Option<CouplingReport>,
    /// The clock in the picture; none where it was not read.
    pub clock: Option<ClockReport>,
    /// How long a rolling shutter takes, by segments that move along themselves, and its standard error, milliseconds;
    /// none where no segment shows it.
    pub readout_ms: Option<[f64; 2]>,
    /// What was searched.
    pub searches: SearchReport,
    /// Threads that decoded.
    pub threads: usize,
    /// The share of the whole time that was spent waiting for the decoder.
    pub decoding_share: f64,
}

/// What the video is.
#[derive(Debug, Clone, Serialize)]
pub struct VideoReport {
    /// The file.
    pub file: PathBuf,
    /// Width and height as shown.
    pub shown_px: [usize; 2],
    /// The codec's name.
    pub codec: String,
    /// Bits a sample.
    pub depth: u32,
    /// Luma columns and rows for one chroma sample; none for grey video.
    pub subsampling: Option<[usize; 2]>,
    /// Where chroma samples lie in their block, right of and below its first luma sample.
    pub chroma_site_px: Option<[f64; 2]>,
    /// Seconds from the first frame to the last.
    pub duration_s: f64,
    /// The shortest and the longest time from frame to frame.
    pub interval_s: Option<[f64; 2]>,
}

/// Frames by their fate.
#[derive(Debug, Clone, Copy, Default, Serialize)]
pub struct FrameCounts {
    /// Of the container, as far as it could be read.
    pub all: u64,
    /// That could not be decoded.
    pub undecoded: u64,
    /// With every marker seen.
    pub complete: u64,
}

/// How a marker fared.
#[derive(Debug, Clone, Serialize)]
pub struct MarkerReport {
    /// Its name.
    pub marker: String,
    /// What it was taken for, `disc` or `blot`; none where it was never seen.
    pub shape: Option<&'static str>,
    /// Frames with its centre.
    pub seen: u64,
    /// Frames without, by reason; reasons that never came up are left out.
    pub lost: Vec<(&'static str, u64)>,
    /// Its radius, the mean over the frames that show it.
    pub radius_px: Option<f64>,
    /// The standard error of a coordinate, the root mean square over these frames.
    pub sd_px: Option<f64>,
}

impl MarkerReport {
    /// Why it was lost, in words; empty where it never was.
    #[must_use]
    pub fn reasons(&self) -> String {
        let parts: Vec<String> = self.lost.iter().map(|(reason, count)| format!("{reason} in {count}")).collect();
        if parts.is_empty() { String::new() } else { format!(" ({})", parts.join(", ")) }
    }
}

/// How a joint fared.
#[derive(Debug, Clone, Serialize)]
pub struct JointReport {
    /// Its name.
    pub joint: String,
    /// Frames with its angle.
    pub frames: u64,
    /// The smallest angle.
    pub min_deg: Option<f64>,
    /// The largest angle.
    pub max_deg: Option<f64>,
    /// The root mean square of the standard errors.
    pub sd_deg: Option<f64>,
    /// Frames whose angle a finger can't have.
    pub outside: u64,
    /// What the smoother took the angles for; none where it did not run or had too few.
    pub smoothing: Option<SmoothModel>,
}

/// A joint's angle as a line in another's.
#[derive(Debug, Clone, Serialize)]
pub struct CouplingReport {
    /// The joint on the right of the equation.
    pub from: String,
    /// The joint on its left.
    pub to: String,
    /// Frames with both angles.
    pub frames: u64,
    /// Degrees a degree.
    pub slope: f64,
    /// Degrees at zero.
    pub intercept_deg: f64,
    /// Pearson's correlation.
    pub correlation: f64,
}

/// What was searched for markers.
#[derive(Debug, Clone, Copy, Default, Serialize)]
pub struct SearchReport {
    /// First frames looked at until every marker had its name.
    pub surveyed_frames: u64,
    /// Neighbourhoods of where one marker was expected.
    pub neighbourhoods: u64,
    /// Wider places where a lost marker can be.
    pub wider: u64,
    /// Whole frames, after the first ones.
    pub whole_frames: u64,
    /// Samples looked at after the first frames, as a share of the luma samples of all frames.
    pub share_of_samples: f64,
}

/// Adds up how a marker fares.
#[derive(Debug, Clone, Default)]
pub(in crate::posture) struct MarkerSums {
    seen: u64,
    pub(in crate::posture) first_frame: Option<u64>,
    lost: [u64; LOSSES.len()],
    radius_px: f64,
    variance_px2: f64,
}

/// Adds up how a joint fares.
#[derive(Debug, Clone, Copy)]
pub(in crate::posture) struct JointSums {
    frames: u64,
    min_rad: f64,
    max_rad: f64,
    variance_rad2: f64,
    pub(in crate::posture) smoothing: Option<SmoothModel>,
}

impl Default for JointSums {
    fn default() -> Self {
        Self { frames: 0, min_rad: f64::INFINITY, max_rad: f64::NEG_INFINITY, variance_rad2: 0.0, smoothing: None }
    }
}

impl JointSums {
    pub(in crate::posture) fn add(&mut self, angle: Option<&Angle>) {
        let Some(angle) = angle else { return };
        self.frames += 1;
        self.min_rad = self.min_rad.min(angle.rad);
        self.max_rad = self.max_rad.max(angle.rad);
        self.variance_rad2 += angle.sd_rad.powi(2);
    }

    pub(in crate::posture) fn report(&self, name: &str, outside: u64) -> JointReport {
        let known = |rad: f64| (self.frames > 0).then(|| rad.to_degrees());
        JointReport {
            joint: name.to_owned(),
            frames: self.frames,
            min_deg: known(self.min_rad),
            max_deg: known(self.max_rad),
            sd_deg: known((self.variance_rad2 / self.frames as f64).sqrt()),
            outside,
            smoothing: self.smoothing,
        }
    }
}

/// Reasons in words, in the order in which they are listed.
const LOSSES: [(Loss, &str); 5] = [
    (Loss::NotFound, "not found"),
    (Loss::Hidden, "hidden"),
    (Loss::AtTheBorder, "at the border"),
    (Loss::Ambiguous, "ambiguous"),
    (Loss::Undecoded, "not decoded"),
];

impl MarkerSums {
    pub(in crate::posture) fn add(&mut self, frame: u64, sight: &Sight) {
        match sight {
            Sight::Seen(centre) => {
                self.first_frame.get_or_insert(frame);
                self.seen += 1;
                self.radius_px += centre.radius_px;
                self.variance_px2 += centre.sd_px().powi(2);
            }
            Sight::Lost(why) => {
                if let Some(at) = LOSSES.iter().position(|(loss, _)| loss == why) {
                    self.lost[at] += 1;
                }
            }
        }
    }

    pub(in crate::posture) fn report(&self, name: &str, shape: Option<MarkerShape>) -> MarkerReport {
        let mean = |sum: f64| (self.seen > 0).then(|| sum / self.seen as f64);
        let lost = LOSSES.iter().zip(self.lost).filter(|(_, count)| *count > 0);
        MarkerReport {
            marker: name.to_owned(),
            shape: shape.map(MarkerShape::name),
            seen: self.seen,
            lost: lost.map(|((_, words), count)| (*words, count)).collect(),
            radius_px: mean(self.radius_px),
            sd_px: mean(self.variance_px2).map(f64::sqrt),
        }
    }
}

/// The word of a marker's loss, as tables tell it.
pub(in crate::posture) fn in_words(loss: Loss) -> &'static str {
    LOSSES.iter().find(|(known, _)| *known == loss).map_or("lost", |(_, words)| words)
}
