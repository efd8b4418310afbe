//! How well a finger lies behind a nail, for each direction that it could point to.
//!
//! In: the nail's surroundings ([`Surroundings`]) and a candidate axis. Out: a log-likelihood up to a constant. The
//! model is a finger seen from any side: two sides parallel to the axis on both sides of the nail and of the skin
//! behind it, a round tip just beyond the distal end, skin of the same colour behind the proximal end, and a nail that
//! is mirror-symmetric about the axis. In the nail's own frame (distal up) the edges of 127 nails in real photographs,
//! averaged, show exactly this: an arch over the nail, open below.
//!
//! The four weights were fitted (conditional logit over 72 directions) on half of those photographs and rounded.

use std::sync::LazyLock;

use super::surroundings::{NAIL_CELLS, Surroundings};

/// Weight of the two sides (their evidence is 0 to 2).
const SIDES: f32 = 7.5;
/// Weight of the tip (0 to 1).
const TIP: f32 = 7.0;
/// Weight of the likeness of what lies behind the nail to the skin around it (0 to 1).
const SKIN: f32 = 3.5;
/// Weight of the outline's mirror symmetry (0 to 1).
const SYMMETRY: f32 = 3.5;
/// Evidence where the photograph ends: that of an average place, so that it speaks neither for nor against.
const UNSEEN_EDGE: f32 = 0.25;
const UNSEEN_SKIN: f32 = 0.5;
/// Weight of an unseen place against a seen one.
const UNSEEN_WEIGHT: f32 = 0.3;
const LENGTH: f32 = NAIL_CELLS as f32;

/// A candidate: the nail's frame in the patch.
struct Frame<'a> {
    patch: &'a Surroundings,
    centre: [f32; 2],
    distal: [f32; 2],
    right: [f32; 2],
    /// Extent of the nail across, left and right.
    across: [f32; 2],
    /// Extent of the nail along, proximal and distal.
    along: [f32; 2],
}

/// Log-likelihood, up to a constant, that the finger's axis is `clockwise_rad` from up.
pub(super) fn evidence(patch: &Surroundings, clockwise_rad: f64) -> f64 {
    evidence_above(patch, clockwise_rad, f64::NEG_INFINITY).unwrap_or(f64::NEG_INFINITY)
}

/// The [`evidence`] where it is above `floor`; `None`, mostly in less time, where it can't be.
pub(super) fn evidence_above(patch: &Surroundings, clockwise_rad: f64, floor: f64) -> Option<f64> {
    let (sin, cos) = (clockwise_rad as f32).sin_cos();
    let mut frame = Frame {
        patch,
        centre: patch.centre,
        distal: [sin, -cos],
        right: [cos, sin],
        across: [f32::MAX, f32::MIN],
        along: [f32::MAX, f32::MIN],
    };
    for p in &patch.rim {
        let [u, v] = frame.inverse(*p);
        // Half a cell to the nail's edge.
        frame.across = [frame.across[0].min(u - 0.5), frame.across[1].max(u + 0.5)];
        frame.along = [frame.along[0].min(v - 0.5), frame.along[1].max(v + 0.5)];
    }
    let (tip, unlike, symmetry) = (frame.tip(), frame.unlike_skin_behind(), frame.symmetry());
    // The sides cost most, and are at most 1 each.
    let least = (floor as f32 - (TIP * tip - SKIN * unlike + SYMMETRY * symmetry)) / SIDES - ROUNDING;
    let one = frame.side_above(1.0, least - 1.0)?;
    let other = frame.side_above(-1.0, least - one)?;
    let sides = one + other;
    let score = SIDES * sides + TIP * tip - SKIN * unlike + SYMMETRY * symmetry;
    Some(f64::from(score))
}

impl Frame<'_> {
    fn at(&self, u: f32, v: f32) -> [f32; 2] {
        let ([cx, cy], [rx, ry], [dx, dy]) = (self.centre, self.right, self.distal);
        [cx + u * rx + v * dx, cy + u * ry + v * dy]
    }

    fn inverse(&self, p: [f32; 2]) -> [f32; 2] {
        let (x, y) = (p[0] - self.centre[0], p[1] - self.centre[1]);
        [x * self.right[0] + y * self.right[1], x * self.distal[0] + y * self.distal[1]]
    }

    fn middle(&self) -> f32 {
        0.5 * (self.across[0] + self.across[1])
    }

    /// The best line parallel to the axis, from the nail's side to 0.95 nail lengths beyond: mean edge across it, from
    /// a quarter length below the distal end to 0.8 lengths behind the nail. `None` where it is below `floor`.
    fn side_above(&self, sign: f32, floor: f32) -> Option<f32> {
        if floor > 1.0 {
            return None;
        }
        let edge = if sign > 0.0 { self.across[1] } else { self.across[0] };
        let (top, bottom) = (self.along[1] - 0.25 * LENGTH, self.along[0] - 0.8 * LENGTH);
        let steps = ((top - bottom).ceil() as usize).max(1);
        let mut best = 0.0_f32;
        for offset in 0..(0.95 * LENGTH) as usize {
            let u = edge + sign * offset as f32;
            let line = (0..steps).map(|k| self.patch.edge(self.at(u, top - k as f32), self.right));
            best = best.max(mean_above(best.max(floor), line, UNSEEN_EDGE));
        }
        (best >= floor).then_some(best)
    }

    /// The best arch of 120 degrees over the distal end, up to half a nail length beyond it.
    fn tip(&self) -> f32 {
        let half_width = 0.5 * (self.across[1] - self.across[0]) + 0.15 * LENGTH;
        let height = 0.6 * LENGTH;
        let mut best = 0.0_f32;
        for offset in 0..(0.5 * LENGTH) as usize {
            let centre = self.along[1] + offset as f32 - height;
            let arch = ARCH.iter().map(|[sin, cos]| {
                let normal = [sin * self.right[0] + cos * self.distal[0], sin * self.right[1] + cos * self.distal[1]];
                self.patch.edge(self.at(self.middle() + half_width * sin, centre + height * cos), normal)
            });
            best = best.max(mean_above(best, arch, UNSEEN_EDGE));
        }
        best
    }

    /// Mean difference from skin in a strip from 0.1 to 0.6 nail lengths behind the proximal end.
    fn unlike_skin_behind(&self) -> f32 {
        let cells = (0..30).map(|k: i32| {
            let (i, j) = (k % 5 - 2, k / 5 + 1);
            let (u, v) = (self.middle() + 0.15 * LENGTH * i as f32, self.along[0] - 0.1 * LENGTH * j as f32);
            self.patch.unlike_skin(self.at(u, v))
        });
        mean_above(f32::NEG_INFINITY, cells, UNSEEN_SKIN)
    }

    /// The part of the nail that stays on it when mirrored about the axis.
    fn symmetry(&self) -> f32 {
        let stays = self.patch.nail.iter().filter(|p| {
            let [u, v] = self.inverse(**p);
            self.patch.is_nail(self.at(-u, v))
        });
        stays.count() as f32 / self.patch.nail.len() as f32
    }
}

/// The arch of a tip: sine and cosine of every 10 degrees of 120.
static ARCH: LazyLock<[[f32; 2]; 13]> =
    LazyLock::new(|| std::array::from_fn(|k| (10.0 * (k as f32 - 6.0)).to_radians().sin_cos().into()));

/// Values after which [`mean_above`] looks whether to go on.
const AT_A_TIME: usize = 4;
/// Rounding of a mean of some dozen values, and much more.
const ROUNDING: f32 = 1e-4;

/// The mean of values of 0 to 1, in which what is missing counts as `unseen`, but less than what is seen. Where it
/// can't be above `best`, 0, and not all of them are looked at.
fn mean_above(best: f32, mut values: impl ExactSizeIterator<Item = Option<f32>>, unseen: f32) -> f32 {
    let (mut sum, mut weights) = (0.0, 0.0);
    while values.len() > 0 {
        for value in values.by_ref().take(AT_A_TIME) {
            let weight = if value.is_some() { 1.0 } else { UNSEEN_WEIGHT };
            sum += weight * value.unwrap_or(unseen);
            weights += weight;
        }
        // Were all others seen and 1.
        let left = values.len() as f32;
        if sum + left < (best - ROUNDING) * (weights + left) {
            return 0.0;
        }
    }
    if weights > 0.0 { sum / weights } else { unseen }
}
