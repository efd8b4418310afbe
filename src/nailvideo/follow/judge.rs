//! Whether a fit is the nail: what is doubtful is lost, never guessed.
//!
//! How well the nail itself fits differs from video to video: pressing, turning and the encoder take as much off the
//! correlation of one as another person's nail has in the next. So a fit is compared with what this nail's fits were
//! like while it was followed from frame to frame: right before for a frame that goes on from the last, over the last
//! 20 s for one that is found again.

use std::collections::VecDeque;

use super::cover::Rim;
use super::register::{Fit, MOST_LAST_STEP_PX};
use super::template::Template;
use crate::median::median_of;
use crate::nailvideo::affine::Affine;

/// Correlation below which it is another place (section 2.4 of the design), absolute and as a share of what the
/// first frames had.
const LEAST_NCC: f64 = 0.6;
const LEAST_NCC_SHARE: f64 = 0.8;
/// Correlation of the texture within blocks, as a share of what the frames right before had, and of what the first had
/// (measured on 32 of the phantom's persons, 9353 frames with jerks, blur and presses: the nail itself has 0.80 and
/// more in 99 of 100 sharp frames; at 43 cuts another person's has 0.74 and less, and 0.80 to 0.83 in four).
const LEAST_TEXTURE_SHARE: f64 = 0.7;
const LEAST_FIRST_TEXTURE_SHARE: f64 = 0.4;
/// Those four are another nail as well by what else changes: residuals grow by the first over the largest of the last
/// frames, or the correlation of a sharp frame falls below a share of that before (of the nail itself in 6 of 1000
/// frames).
const MOST_SD_SHARE: f64 = 1.4;
const LEAST_TEXTURE_SHARE_AT_SD: f64 = 0.9;
const NCC_SHARE: f64 = 0.976;
const LEAST_TEXTURE_SHARE_AT_NCC: f64 = 0.84;
const SHARP_GAIN_SHARE: f64 = 0.88;
/// Where something lies over the nail, of what is bare (144 videos: the nail itself has 0.912 and more in nine of ten
/// such frames, another's nail, of which what is alike is taken for bare, at most 0.910).
const LEAST_TEXTURE_SHARE_COVERED: f64 = 0.93;
/// Of a nail found again: shares of what the first frames had, or of what nine of ten frames had in which it was
/// followed, the lower one (the same persons: the nail itself had correlations of 0.85 to 0.98 of the first frames' in
/// nine of ten; those most like another one 0.93 and 0.96 where it had 0.98 and 0.98 itself, and texture of 0.82 and
/// 0.75 where it had 0.93 and 0.75).
const AGAIN_NCC: [f64; 2] = [0.94, 0.98];
const AGAIN_TEXTURE: [f64; 2] = [0.85, 0.93];
/// Share of the pixels that fit.
const LEAST_INLIERS: f64 = 0.6;
/// Standard error of the nail's place, pixels: a quarter of a photodiode's disc on the smallest nail.
const MOST_SE_PX: f64 = 1.0;
/// Way from where the nail was expected, of its width.
const MOST_JUMP_WIDTHS: f64 = 0.1;
/// By how much areas may change, and one direction against the other: a finger that tilts by 35 degrees (assumed).
const AREAS: std::ops::RangeInclusive<f64> = 0.64..=1.5;
const MOST_STRETCH: f64 = 1.25;
/// Share of the nail's box beyond the picture.
const MOST_OUTSIDE: f64 = 0.2;
/// The normalized luma against the template's, of what the first frames had: less is blur (0.4 of the gradient's
/// energy), more is another thing.
const GAINS: std::ops::RangeInclusive<f64> = 0.63..=1.6;
/// A fit that did not come to rest is not believed below this gain (of the first frames): it was still on its way
/// (measured on a real nail of 45 px before a dark table: at gains of 0.6 to 0.8 places were up to 3.1 px off; with
/// 0.85 a phantom person in jerks is lost for half of the video).
const LEAST_CREEPING_GAIN: f64 = 0.8;
/// What standard errors are enlarged by: the nail shown by an encoder is off as a whole, which no residual shows
/// (measured on the phantom: errors are 1.9 times what blocks alone say at rest, 3.2 under pressing up to a
/// quantization parameter of 19, 4.2 at 26 and 7.3 at 32).
const AS_A_WHOLE: f64 = 3.0;
/// .. up to this quantization parameter, and twice as much for each so many more.
const FINE: f64 = 21.6;
const DOUBLED_BY: f64 = 7.5;

/// Why the nail is not followed in a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::nailvideo) enum Lost {
    /// It was not found before.
    NotYet,
    /// The frame could not be decoded.
    Undecoded,
    /// Beyond the picture's border.
    Outside,
    /// The picture there is another.
    Unlike,
    /// Too much of it is hidden or changed.
    Hidden,
    /// Motion blur or out of focus.
    Blurred,
    /// It can't be as far from where it was.
    Jumped,
    /// Its shape can't change as much.
    Bent,
    /// The place is too uncertain.
    Unsure,
    /// Found again, and not yet confirmed by the frames after.
    Trial,
}

impl Lost {
    /// In tables: `lost: blurred`.
    pub(in crate::nailvideo) fn name(self) -> &'static str {
        match self {
            Self::NotYet => "lost: no nail yet",
            Self::Undecoded => "lost: undecoded",
            Self::Outside => "lost: outside",
            Self::Unlike => "lost: unlike",
            Self::Hidden => "lost: hidden",
            Self::Blurred => "lost: blurred",
            Self::Jumped => "lost: jumped",
            Self::Bent => "lost: bent",
            Self::Unsure => "lost: unsure",
            Self::Trial => "lost: being confirmed",
        }
    }
}

/// What a fit comes after.
#[derive(Debug, Clone, Copy)]
pub(super) enum After {
    /// The frame before, in which the nail was followed.
    Frame,
    /// A loss: what is found may be another nail.
    Loss,
}

/// What fits of this video are like.
#[derive(Debug, Clone, Default)]
pub(super) struct Usual {
    /// Of the first accepted frames, medians.
    first: Option<Like>,
    /// Of the last accepted ones, the latest at the end.
    last: VecDeque<Like>,
}

/// What a fit is like.
#[derive(Debug, Clone, Copy)]
struct Like {
    ncc: f64,
    texture: f64,
    gain: f64,
    sd: f64,
}

/// Accepted frames that say what fits are like: the first, those right before, and those that are remembered (20 s of
/// 30 a second).
const FIRST: usize = 15;
const BEFORE: usize = 15;
const JUST_BEFORE: usize = 5;
/// Frames after which it is known how much fits differ (assumed: two seconds).
const KNOWN: usize = 60;
const REMEMBERED: usize = 600;
/// Where less fits, something lies over the nail: such frames say nothing of the nail's own.
const BARE: f64 = 0.9;
/// This share of the frames is below what is asked of a nail found again.
const LOW: f64 = 0.1;

/// A quantile of some numbers; `None` of none.
fn quantile(all: impl Iterator<Item = f64>, share: f64) -> Option<f64> {
    let mut all: Vec<f64> = all.collect();
    let at = ((share * all.len() as f64) as usize).min(all.len().checked_sub(1)?);
    Some(*all.select_nth_unstable_by(at, f64::total_cmp).1)
}

impl Usual {
    /// Learns from an accepted fit; the template's own frame fits itself and says nothing.
    pub(super) fn learn(&mut self, fit: &Fit) {
        if (fit.rim.is_some() || fit.inliers < BARE) && self.last.len() >= FIRST {
            return;
        }
        if self.last.len() == REMEMBERED {
            self.last.pop_front();
        }
        self.last.push_back(Like { ncc: fit.ncc, texture: fit.texture, gain: fit.gain, sd: fit.sd });
        if self.last.len() <= FIRST {
            let median = |part: fn(&Like) -> f64| median_of(self.last.iter().map(part)).unwrap_or(f64::NAN);
            let [ncc, texture, gain] = [median(|l| l.ncc), median(|l| l.texture), median(|l| l.gain)];
            self.first = Some(Like { ncc, texture, gain, sd: median(|l| l.sd) });
        }
    }

    /// The median of the frames right before.
    fn before(&self, part: fn(&Like) -> f64) -> Option<f64> {
        median_of(self.last.iter().rev().take(BEFORE).map(part))
    }

    /// The correlation of the frames right before.
    pub(super) fn ncc(&self) -> Option<f64> {
        self.before(|like| like.ncc)
    }

    /// Whether a fit is like the nail's.
    fn is_like(&self, fit: &Fit, after: After) -> bool {
        // What is NaN is not alike.
        let Some(first) = self.first else { return fit.ncc >= LEAST_NCC };
        let least = |first: f64, part: fn(&Like) -> f64, [of_first, of_low]: [f64; 2]| {
            let low = quantile(self.last.iter().map(part), LOW).unwrap_or(first);
            (of_first * first).min(of_low * low)
        };
        let (least_ncc, least_texture) = match after {
            After::Frame => {
                let before = |part: fn(&Like) -> f64, first: f64| self.before(part).unwrap_or(first);
                let texture = before(|like| like.texture, first.texture);
                let just_before = self.last.iter().rev().take(JUST_BEFORE).map(|like| like.sd);
                let sd = just_before.fold(0.0, f64::max);
                let is_sharp = fit.gain > SHARP_GAIN_SHARE * before(|like| like.gain, first.gain);
                // The first frames repeat the very first: their residuals are next to nothing.
                let share = if fit.rim.is_some() {
                    LEAST_TEXTURE_SHARE_COVERED
                } else if self.last.len() >= FIRST && fit.sd > MOST_SD_SHARE * sd {
                    LEAST_TEXTURE_SHARE_AT_SD
                } else if self.last.len() >= KNOWN
                    && is_sharp
                    && fit.ncc < NCC_SHARE * before(|like| like.ncc, first.ncc)
                {
                    LEAST_TEXTURE_SHARE_AT_NCC
                } else {
                    LEAST_TEXTURE_SHARE
                };
                (LEAST_NCC_SHARE * first.ncc, share * texture)
            }
            After::Loss => {
                let ncc = least(first.ncc, |like| like.ncc, AGAIN_NCC);
                (ncc.max(LEAST_NCC_SHARE * first.ncc), least(first.texture, |like| like.texture, AGAIN_TEXTURE))
            }
        };
        fit.ncc >= LEAST_NCC.max(least_ncc)
            && fit.texture >= least_texture.max(LEAST_FIRST_TEXTURE_SHARE * first.texture)
    }
}

/// The nail's place in a frame.
#[derive(Debug, Clone, Copy)]
pub(in crate::nailvideo) struct Place {
    /// From the template's pixels to the frame's.
    pub(in crate::nailvideo) motion: Affine,
    /// Standard error of the place, root mean square over the nail, pixels.
    pub(in crate::nailvideo) se_px: f64,
    /// Correlation of the pixels that fit.
    pub(in crate::nailvideo) ncc: f64,
    /// Share of the pixels that fit.
    pub(in crate::nailvideo) inliers: f64,
    /// Of what lies over it.
    pub(in crate::nailvideo) rim: Option<Rim>,
}

/// Judges a fit; `expected` is where the nail was expected, `width_px` the nail's width, `quantizer` the frame's
/// quantization parameter.
pub(super) fn judge(
    fit: &Fit,
    template: &Template,
    quantizer: Option<f64>,
    usual: &Usual,
    after: After,
    expected: Option<&Affine>,
    width_px: f64,
) -> Result<Place, Lost> {
    let [a, b, _, d, e, _] = fit.motion.0;
    let (det, squares) = (fit.motion.determinant(), a * a + b * b + d * d + e * e);
    // The singular values' ratio r: squares / det = r + 1 / r.
    let ratio = squares / det.max(1e-9);
    if !AREAS.contains(&det) || ratio > MOST_STRETCH + 1.0 / MOST_STRETCH {
        return Err(Lost::Bent);
    }
    if fit.outside > MOST_OUTSIDE {
        return Err(Lost::Outside);
    }
    if !usual.is_like(fit, after) {
        return Err(Lost::Unlike);
    }
    let is_seen = fit.inliers >= LEAST_INLIERS;
    if !is_seen {
        return Err(Lost::Hidden);
    }
    let gain = fit.gain / usual.first.map_or(1.0, |first| first.gain);
    if !GAINS.contains(&gain) {
        return Err(if gain < 1.0 { Lost::Blurred } else { Lost::Unlike });
    }
    let se_px = se_px(fit, quantizer);
    let is_on_its_way = !fit.is_at_rest() && gain < LEAST_CREEPING_GAIN;
    let is_sure = se_px <= MOST_SE_PX && fit.last_step_px <= MOST_LAST_STEP_PX && !is_on_its_way;
    if !is_sure {
        return Err(Lost::Unsure);
    }
    if let Some(expected) = expected {
        let ([x, y], [p, q]) = (fit.motion.of(template.middle), expected.of(template.middle));
        if (x - p).hypot(y - q) > MOST_JUMP_WIDTHS * width_px {
            return Err(Lost::Jumped);
        }
    }
    Ok(Place { motion: fit.motion, se_px, ncc: fit.ncc, inliers: fit.inliers, rim: fit.rim })
}

/// By how much a quantization parameter is above the one up to which errors do not grow; where it isn't known, not.
pub(in crate::nailvideo) fn beyond_fine(quantizer: Option<f64>) -> f64 {
    quantizer.map_or(0.0, |parameter| (parameter - FINE).max(0.0))
}

/// Root mean square over the nail of the place's standard error.
fn se_px(fit: &Fit, quantizer: Option<f64>) -> f64 {
    // The mean square of local coordinates over a box; cross terms cancel about the middle.
    let c = &fit.covariance;
    let one = |k: usize| (c[(k, k)] + c[(k + 1, k + 1)]) / 3.0 + c[(k + 2, k + 2)];
    AS_A_WHOLE * (beyond_fine(quantizer) / DOUBLED_BY).exp2() * (one(0) + one(3)).sqrt()
}
