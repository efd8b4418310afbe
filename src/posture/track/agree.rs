//! Whether what markers were found to be fits together: no two at one place, segments as long as they were, and markers
//! of one colour each where they were going.

use super::target::Target;
use crate::posture::marker::sight::Loss;
use crate::posture::survey::find::distance;
use crate::posture::survey::naming::{LENGTH_FREE_PX, LENGTH_SHARE};

/// A naming of two markers must be better than the other way round by this.
const MARGIN: f64 = 4.0;
/// A blob may cost this more than a missing marker if the others then fit the better.
pub(super) const LOOSE: f64 = 3.0;
/// What is learnt of a segment's length from a frame.
const LENGTH_LEARNT: f64 = 0.02;

/// Two markers on a rigid part.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rod {
    pub(super) ends: [usize; 2],
    pub(super) length_px: Option<f64>,
}

impl Rod {
    fn seen_px(&self, targets: &[Target]) -> Option<f64> {
        let [a, b] = self.ends.map(|end| targets[end].fit.as_ref().map(|fit| fit.centre.at_px));
        Some(distance(a?, b?))
    }

    pub(super) fn other(&self, end: usize) -> usize {
        if self.ends[0] == end { self.ends[1] } else { self.ends[0] }
    }

    /// Whether it can be as long as this.
    pub(super) fn can_be(&self, seen_px: f64) -> bool {
        self.length_px.is_none_or(|length| (seen_px - length).abs() <= LENGTH_SHARE * length + LENGTH_FREE_PX)
    }
}

/// Drops what can't be. `alike[a][b]` says that two markers may be taken for one another.
pub(super) fn settle(targets: &mut [Target], rods: &[Rod], alike: &[Vec<bool>]) {
    for a in 0..targets.len() {
        for b in a + 1..targets.len() {
            if let (Some(fit_a), Some(fit_b)) = (&targets[a].fit, &targets[b].fit) {
                let (at_a, at_b) = (fit_a.centre.at_px, fit_b.centre.at_px);
                let near = 0.5 * (targets[a].radius_px() + targets[b].radius_px());
                if distance(at_a, at_b) < near {
                    one_place(targets, rods, a, b);
                } else if alike[a][b] && distance(at_a, at_b) < 8.0 * near {
                    two_places(targets, rods, a, b);
                }
            }
        }
    }
    for rod in rods {
        if let Some(seen) = rod.seen_px(targets)
            && !rod.can_be(seen)
        {
            let [a, b] = rod.ends;
            let (off_a, off_b) = (surprise(&targets[a]), surprise(&targets[b]));
            if off_a >= 0.5 * off_b {
                targets[a].drop(Loss::Ambiguous);
            }
            if off_b >= 0.5 * off_a {
                targets[b].drop(Loss::Ambiguous);
            }
        }
    }
}

/// Learns the lengths of the segments seen.
pub(super) fn learn(targets: &[Target], rods: &mut [Rod]) {
    for rod in rods {
        if let Some(seen) = rod.seen_px(targets) {
            rod.length_px = Some(rod.length_px.map_or(seen, |length| length + LENGTH_LEARNT * (seen - length)));
        }
    }
}

/// Two markers found at one place: the one that fits by far better has it, else none.
fn one_place(targets: &mut [Target], rods: &[Rod], a: usize, b: usize) {
    let cost_a = misfit(targets, rods, a, own(targets, a), b);
    let cost_b = misfit(targets, rods, b, own(targets, b), a);
    if cost_a >= cost_b - MARGIN {
        targets[a].drop(Loss::Ambiguous);
    }
    if cost_b >= cost_a - MARGIN {
        targets[b].drop(Loss::Ambiguous);
    }
}

/// Two markers of one colour near one another: each has its own, or the other's if that fits by far better, else none.
fn two_places(targets: &mut [Target], rods: &[Rod], a: usize, b: usize) {
    let (at_a, at_b) = (own(targets, a), own(targets, b));
    let kept = misfit(targets, rods, a, at_a, b) + misfit(targets, rods, b, at_b, a);
    let swapped = misfit(targets, rods, a, at_b, b) + misfit(targets, rods, b, at_a, a);
    if swapped < kept - MARGIN {
        let fit = targets[a].fit.take();
        targets[a].fit = targets[b].fit.take();
        targets[b].fit = fit;
    } else if swapped < kept + MARGIN {
        targets[a].drop(Loss::Ambiguous);
        targets[b].drop(Loss::Ambiguous);
    }
}

fn own(targets: &[Target], index: usize) -> [f64; 2] {
    targets[index].fit.as_ref().map_or(targets[index].expected_px, |fit| fit.centre.at_px)
}

/// How badly a place suits a marker: by where it was expected and by its segments, those to `not` left out.
fn misfit(targets: &[Target], rods: &[Rod], index: usize, at: [f64; 2], not: usize) -> f64 {
    let target = &targets[index];
    let scale =
        0.3 * target.radius_px() + 1.0 + 0.3 * target.speed_px() + 0.3 * (target.reach_px() - 1.5 * target.radius_px());
    let mut cost = 0.5 * (distance(at, target.expected_px) / scale).powi(2).min(40.0);
    for rod in rods.iter().filter(|rod| rod.ends.contains(&index) && !rod.ends.contains(&not)) {
        if let (Some(length), Some(fit)) = (rod.length_px, &targets[rod.other(index)].fit) {
            let off = distance(at, fit.centre.at_px) - length;
            cost += 0.5 * (off / (0.03 * length + 1.0)).powi(2).min(40.0);
        }
    }
    cost
}

/// How far a marker is from where it was expected, in what it could well be off.
fn surprise(target: &Target) -> f64 {
    target.fit.as_ref().map_or(0.0, |fit| {
        let certain = if target.absent == 0 { 1.0 } else { 3.0 };
        certain * (0.1 + distance(fit.centre.at_px, target.expected_px) / target.reach_px())
    })
}
