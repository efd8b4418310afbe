//! Whether a fit is the nail: what is doubtful is lost, never guessed.

use super::register::Fit;
use super::template::Template;
use crate::nailvideo::affine::Affine;

/// Correlation below which it is another place (section 2.4 of the design), absolute and as a share of what the
/// first frames had.
const LEAST_NCC: f64 = 0.6;
pub(super) const LEAST_NCC_SHARE: f64 = 0.8;
/// The same share where the nail was lost and may be another (measured on the phantom: the nail itself pressed, under a
/// rod, in uneven light or of 40 px 0.95 and more; another person's, of 70 px, 0.92). Blurred by jerks the nail itself
/// has less on some persons and stays lost for long: the accuracy page counts how often.
pub(super) const LEAST_NCC_SHARE_AGAIN: f64 = 0.94;
/// Correlation of the texture within blocks, as a share of what the first frames had (measured on the phantom: the nail
/// itself pressed, under a rod, blurred or of 40 px 0.75 and more; another person's nail in the same place 0.59).
const LEAST_TEXTURE_SHARE: f64 = 0.7;
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
/// The last step of a fit that has not ended, pixels.
const MOST_LAST_STEP_PX: f64 = 0.1;
/// Residuals of a fit go together: the covariance of independent ones is enlarged by the first factor, and by the
/// second so far as residuals are larger than those of the first frames: what changed is no noise (measured on the
/// phantom, so that errors are covered).
const TOGETHER: f64 = 24.0;
const CHANGED: f64 = 40.0;

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

/// What fits of this video are like.
#[derive(Debug, Clone, Default)]
pub(super) struct Usual {
    first: Vec<[f64; 4]>,
    ncc: Option<f64>,
    texture: Option<f64>,
    gain: Option<f64>,
    sd: Option<f64>,
}

/// Accepted frames that say what fits are like.
const FIRST: usize = 15;

impl Usual {
    /// Learns from the first accepted fits; the template's own frame fits itself and says nothing.
    pub(super) fn learn(&mut self, fit: &Fit) {
        if self.first.len() >= FIRST {
            return;
        }
        self.first.push([fit.ncc, fit.texture, fit.gain, fit.sd]);
        let median = |k: usize| {
            let mut all: Vec<f64> = self.first.iter().map(|one| one[k]).collect();
            all.sort_by(f64::total_cmp);
            all[all.len() / 2]
        };
        [self.ncc, self.texture, self.gain, self.sd] = [0, 1, 2, 3].map(|k| Some(median(k)));
    }

    pub(super) fn ncc(&self) -> Option<f64> {
        self.ncc
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
}

/// Judges a fit; `expected` is where the nail was expected, `least_share` the least of the usual correlation, and
/// `width_px` the nail's width.
pub(super) fn judge(
    fit: &Fit,
    template: &Template,
    usual: &Usual,
    expected: Option<&Affine>,
    least_share: f64,
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
    // What is NaN is not alike.
    let is_alike = fit.ncc >= LEAST_NCC.max(least_share * usual.ncc.unwrap_or(0.0))
        && fit.texture >= LEAST_TEXTURE_SHARE * usual.texture.unwrap_or(0.0);
    if !is_alike {
        return Err(Lost::Unlike);
    }
    let is_seen = fit.inliers >= LEAST_INLIERS;
    if !is_seen {
        return Err(Lost::Hidden);
    }
    let gain = fit.gain / usual.gain.unwrap_or(1.0);
    if !GAINS.contains(&gain) {
        return Err(if gain < 1.0 { Lost::Blurred } else { Lost::Unlike });
    }
    let se_px = se_px(fit, usual);
    let is_sure = se_px <= MOST_SE_PX && fit.last_step_px <= MOST_LAST_STEP_PX;
    if !is_sure {
        return Err(Lost::Unsure);
    }
    if let Some(expected) = expected {
        let ([x, y], [p, q]) = (fit.motion.of(template.middle), expected.of(template.middle));
        if (x - p).hypot(y - q) > MOST_JUMP_WIDTHS * width_px {
            return Err(Lost::Jumped);
        }
    }
    Ok(Place { motion: fit.motion, se_px, ncc: fit.ncc, inliers: fit.inliers })
}

/// Root mean square over the nail of the place's standard error.
fn se_px(fit: &Fit, usual: &Usual) -> f64 {
    // The mean square of local coordinates over a box; cross terms cancel about the middle.
    let c = &fit.covariance;
    let one = |k: usize| (c[(k, k)] + c[(k + 1, k + 1)]) / 3.0 + c[(k + 2, k + 2)];
    let changed = 1.0 - (usual.sd.unwrap_or(fit.sd) / fit.sd).min(1.0).powi(2);
    ((TOGETHER + CHANGED * changed) * (one(0) + one(3))).sqrt()
}
