//! Whether a blot is seen whole. What comes over it slowly changes its outline by less from one frame to the next than
//! light does; over many frames it becomes smaller while the others keep their size.
//!
//! In: the fits of a frame. What grows or shrinks with the others, as where the camera zooms, is whole; what differs
//! from them has a larger standard error, or is lost.

use super::target::Target;
use crate::median::median;
use crate::posture::marker::blot::cut_px;
use crate::posture::marker::sight::Loss;

/// Area over what it would be had the blot grown like the others; beyond, it is lost (0.55: half hidden; both assumed).
const AREA_RANGE: (f64, f64) = (0.55, 2.0);

/// The area of a whole blot changes, against the others, by what moves its edge by this much: on six phantoms of seed 1
/// (`--layout row` as it is and with `--scene clean`, `hard`, `fast`, `small`; `--layout paint`; radii of 2.9 to 16 px)
/// 99 % of a mark's frames are within 0.06 to 0.25 px.
const EDGE_FREE_PX: f64 = 0.2;
/// ... and by this logarithm, as skin stretches (assumed).
const STRETCH_FREE: f64 = 0.05;

/// Drops the blots that are hidden by half, and doubts the places of those that may be hidden in part. Those that are
/// `lone` may be things that come nearer.
pub(super) fn doubt(targets: &mut [Target], lone: &[bool]) {
    let growths: Vec<Option<f64>> =
        (targets.iter().zip(lone)).map(|(target, lone)| growth(target).filter(|_| !lone)).collect();
    let common = common(growths.iter().flatten().copied().collect());
    for (target, growth) in targets.iter_mut().zip(growths) {
        let (Some(fit), Some(growth)) = (&mut target.fit, growth) else { continue };
        let change = growth - common;
        let whole_px = fit.centre.radius_px * (-0.5 * change).exp();
        let free = STRETCH_FREE.max(2.0 * EDGE_FREE_PX / whole_px);
        fit.doubt(cut_px(change.abs() - free, whole_px));
        if change < AREA_RANGE.0.ln() || change > AREA_RANGE.1.ln() {
            target.drop(Loss::Hidden);
        }
    }
}

/// How much larger a blot is than it was at first, as the logarithm of its area.
fn growth(target: &Target) -> Option<f64> {
    let blot = target.look.as_ref()?.blot.as_ref()?;
    Some(blot.growth(target.fit.as_ref()?.outline.as_ref()?))
}

/// By how much all have grown: the middle, where half of them count as unchanged if the others are.
fn common(mut growths: Vec<f64>) -> f64 {
    if growths.len() < 2 {
        return 0.0;
    }
    growths.push(0.0);
    median(&mut growths).unwrap_or(0.0)
}
