//! Joint angles onto the rows of a log.
//!
//! In: the table of angles over the video's time, the rows' times on the log's clock, ascending, and the [`Tie`] of the
//! two. Out:
//! [`Labels`]: each row's angles at its own time, with standard errors, and why rows have none.
//!
//! An angle is interpolated between frames in which it was really seen, never outside of the video and never over a
//! gap: two seen frames further apart than the longest gap, be it that the marker was hidden or that the camera dropped
//! frames. How it runs between frames, and how sure it is there, is [`curve`]'s. What the tie's error at that time
//! changes the angle by is a share of the label's error, [`share`]'s; it is the same for neighbouring rows, so it does
//! not average out. So is what the row's own stamp changes it by, where stamps lie off even steps ([`stamps`]). A label
//! whose frames' errors are not known has none either.

mod curve;
mod share;
pub(super) mod stamps;

use std::borrow::Cow;

use super::{Posture, Tie};
use crate::log::Samples;
use crate::median::median_of;
use curve::{Curve, SAME_TIME_S};
use share::TieShare;

/// Frame intervals that a gap may have where the user does not say. A gap has as many as its length rounds to, so that
/// frames that come a little irregularly do not make gaps: up to 2.5 median intervals are two.
const MOST_INTERVALS: f64 = 2.5;

/// Why a row has no label, or not all of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Unlabelled {
    /// The video had not begun.
    BeforeTheVideo,
    /// The video was over.
    AfterTheVideo,
    /// A joint was not seen around this time.
    Gap,
}

/// A stretch of the video in which joints were not seen, with rows in it.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Gap {
    /// The log's time of the last frame that was seen before it, or of the first frame, seconds.
    pub from_s: f64,
    /// The log's time of the first frame that was seen after it, or of the last frame, seconds.
    pub to_s: f64,
    /// Which.
    pub joints: Vec<String>,
    /// Rows that lack these labels.
    pub rows: u64,
}

/// How many rows have labels.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize)]
pub struct LabelCounts {
    /// Rows with all joints' labels.
    pub rows_labelled: u64,
    /// Rows that lack at least one.
    pub rows_unlabelled: u64,
    /// Of those, rows before the video.
    pub before_the_video: u64,
    /// Of those, rows after the video.
    pub after_the_video: u64,
    /// Of those, rows in a gap.
    pub in_gaps: u64,
}

/// Labels for the rows of a log.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Labels {
    /// The joints' names.
    pub joints: Vec<String>,
    /// For each joint, its angle at each row's time, degrees; NaN where there is no label.
    pub angles_deg: Vec<Vec<f64>>,
    /// For each joint, the label's standard error, degrees; NaN where it is not known.
    pub sds_deg: Vec<Vec<f64>>,
    /// For each row, why a label is missing; none where all are there.
    pub unlabelled: Vec<Option<Unlabelled>>,
    /// The gaps with rows in them, by time.
    pub gaps: Vec<Gap>,
    /// The longest gap that was bridged, seconds.
    pub max_gap_s: f64,
}

/// Labels each row. `max_gap_s`: seen frames further apart are not interpolated between; none: two frame intervals.
/// `stamp_sd_s`: how far rows' times may be off, each by itself.
#[must_use]
pub(super) fn label(
    posture: &Posture,
    samples: &Samples,
    tie: &Tie,
    max_gap_s: Option<f64>,
    stamp_sd_s: f64,
) -> Labels {
    let max_gap_s = max_gap_s.unwrap_or_else(|| MOST_INTERVALS * median_interval_s(&posture.time_s));
    // A video without frames never begins.
    let ends_s = [posture.time_s.first(), posture.time_s.last()].map(|t| t.copied().unwrap_or(f64::INFINITY));
    let video_s: Vec<f64> = samples.time_s.iter().map(|&t| tie.timebase.own_s(t)).collect();
    let mut unlabelled: Vec<Option<Unlabelled>> = video_s.iter().map(|&t| outside(t, ends_s)).collect();
    let inside = unlabelled
        .iter()
        .position(Option::is_none)
        .map_or(0..0, |first| first..first + unlabelled[first..].iter().take_while(|reason| reason.is_none()).count());
    let (mut angles_deg, mut sds_deg, mut gaps) = (Vec::new(), Vec::new(), Vec::new());
    for (joint, name) in posture.joints.iter().enumerate() {
        let mut curve = Curve::new(&posture.time_s, &posture.angles_deg[joint], &posture.sds_deg[joint], max_gap_s);
        let mut tie_share = TieShare::new(tie, &curve, stamp_sd_s);
        let (mut angles, mut sds) = (vec![f64::NAN; video_s.len()], vec![f64::NAN; video_s.len()]);
        let first_gap = gaps.len();
        for row in inside.clone() {
            match curve.at(video_s[row]) {
                Ok(at) => {
                    angles[row] = at.deg;
                    sds[row] = (at.variance_deg2 + tie_share.deg2(video_s[row], &at)).sqrt();
                }
                Err(hole) => {
                    unlabelled[row] = Some(Unlabelled::Gap);
                    let ends = [hole.after_s.unwrap_or(ends_s[0]), hole.before_s.unwrap_or(ends_s[1])];
                    let [from_s, to_s] = ends.map(|t| tie.timebase.other_s(t));
                    match gaps[first_gap..].last_mut() {
                        Some(Gap { from_s: known_s, rows, .. }) if *known_s == from_s => *rows += 1,
                        _ => gaps.push(Gap { from_s, to_s, joints: vec![name.clone()], rows: 1 }),
                    }
                }
            }
        }
        angles_deg.push(angles);
        sds_deg.push(sds);
    }
    Labels { joints: posture.joints.clone(), angles_deg, sds_deg, unlabelled, gaps: joined(gaps), max_gap_s }
}

impl Labels {
    /// What a row's `label_status` is: `ok`, `before the video`, `after the video`, or `gap:` and the joints.
    #[must_use]
    pub(super) fn status(&self, row: usize) -> Cow<'static, str> {
        match self.unlabelled[row] {
            None => "ok".into(),
            Some(Unlabelled::BeforeTheVideo) => "before the video".into(),
            Some(Unlabelled::AfterTheVideo) => "after the video".into(),
            Some(Unlabelled::Gap) => {
                let missing = self.joints.iter().zip(&self.angles_deg).filter(|(_, angles)| angles[row].is_nan());
                missing.fold("gap:".to_owned(), |text, (joint, _)| text + " " + joint).into()
            }
        }
    }

    /// How many rows have labels, and why others have not.
    #[must_use]
    pub(super) fn counts(&self) -> LabelCounts {
        let count = |why: Option<Unlabelled>| self.unlabelled.iter().filter(|&&reason| reason == why).count() as u64;
        let rows_labelled = count(None);
        LabelCounts {
            rows_labelled,
            rows_unlabelled: self.unlabelled.len() as u64 - rows_labelled,
            before_the_video: count(Some(Unlabelled::BeforeTheVideo)),
            after_the_video: count(Some(Unlabelled::AfterTheVideo)),
            in_gaps: count(Some(Unlabelled::Gap)),
        }
    }
}

fn outside(video_s: f64, [first_s, last_s]: [f64; 2]) -> Option<Unlabelled> {
    if video_s < first_s - SAME_TIME_S {
        Some(Unlabelled::BeforeTheVideo)
    } else if video_s > last_s + SAME_TIME_S {
        Some(Unlabelled::AfterTheVideo)
    } else {
        None
    }
}

/// The median of the times from frame to frame; 0 where there are none.
fn median_interval_s(times_s: &[f64]) -> f64 {
    median_of(times_s.windows(2).map(|pair| pair[1] - pair[0])).unwrap_or(0.0)
}

/// The same gaps of several joints as one, sorted by time.
fn joined(mut gaps: Vec<Gap>) -> Vec<Gap> {
    // Stable: the joints stay in order.
    gaps.sort_by(|a, b| a.from_s.total_cmp(&b.from_s).then(a.to_s.total_cmp(&b.to_s)));
    let mut joined: Vec<Gap> = Vec::with_capacity(gaps.len());
    for gap in gaps {
        match joined.last_mut() {
            Some(last) if last.from_s == gap.from_s && last.to_s == gap.to_s => last.joints.extend(gap.joints),
            _ => joined.push(gap),
        }
    }
    joined
}

#[cfg(test)]
mod tests;
