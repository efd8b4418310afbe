//! Which zones of the nail bed redden and which whiten in each pose (sections 4.2.3 to 4.2.6, Fig. 57-68), and
//! ([`moment`]) while the finger presses, shears and bends.
//!
//! Red and white zones differ mainly in their green component (4.2.2). In: a place (`u`, `v`) on the nail; out: by how
//! much the bed is lighter (white, positive) or darker (red, negative) there, about -1 to 1. The pattern is fixed to
//! the nail; the thesis shows pictures, not numbers, so places and sizes are read off its descriptions.

mod moment;

pub use moment::{Blood, ColourWeights, PATTERNS};
pub(in crate::phantom::nail) use moment::{DEPTH, distal_share, patterns, whitening};

use crate::phantom::nail::{
    Pose,
    smooth::{bell, step},
};

/// How one subject's nail bed shows the patterns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::phantom::nail) struct Habit {
    /// Change of the encoded green of full light at full whitening or reddening.
    pub(in crate::phantom::nail) amplitude: f64,
    /// Where the pattern's middle lies on the nail, (`u`, `v`).
    pub(in crate::phantom::nail) shift: [f64; 2],
    /// Size of the pattern relative to the common one.
    pub(in crate::phantom::nail) size: f64,
}

impl Habit {
    /// The place of the common pattern that this subject has at (`u`, `v`).
    fn at(&self, u: f64, v: f64) -> [f64; 2] {
        [(u - self.shift[0]) / self.size, (v - self.shift[1]) / self.size]
    }
}

/// A blob about (`u`, `v`) with standard deviations (`su`, `sv`).
fn blob(at: [f64; 2], middle: [f64; 2], sd: [f64; 2]) -> f64 {
    let (du, dv) = ((at[0] - middle[0]) / sd[0], (at[1] - middle[1]) / sd[1]);
    bell(du * du + dv * dv)
}

/// How far out from over the bone: under 1 above it, over 1 around it.
fn from_bone(at: [f64; 2], scale: f64) -> f64 {
    (at[0] / (0.72 * scale)).hypot((at[1] + 0.35) / (0.86 * scale))
}

/// The distal zone around the bone, beyond its arrowhead.
fn around(at: [f64; 2], scale: f64) -> f64 {
    step(0.80, 1.20, from_bone(at, scale)) * step(-0.45, 0.35, at[1])
}

/// Sliding to the subject's left, whose far side is to the right.
fn lateral(at: [f64; 2]) -> f64 {
    let far = step(0.72, 1.15, from_bone(at, 0.92)) * step(-0.05, 0.45, at[0]) * step(-0.9, -0.2, at[1]);
    let over_near = 0.85 * blob(at, [-0.30, -0.12], [0.20, 0.42]);
    let red_near = 0.95 * blob(at, [-0.88, 0.15], [0.22, 0.60]);
    let red_over = 0.75 * blob(at, [0.20, -0.25], [0.20, 0.42]);
    far + over_near - red_near - red_over
}

/// The red zone over the bone while the finger presses.
fn over(at: [f64; 2]) -> f64 {
    0.95 * blob(at, [0.0, -0.38], [0.46, 0.40])
}

/// Whitening (positive) or reddening (negative) at (`u`, `v`), about -1 to 1.
pub(in crate::phantom::nail) fn zones(pose: Pose, habit: &Habit, u: f64, v: f64) -> f64 {
    of_pose(pose, habit.at(u, v))
}

fn of_pose(pose: Pose, at: [f64; 2]) -> f64 {
    match pose {
        Pose::Nominal => 0.55 * blob(at, [0.0, 0.02], [0.36, 0.42]) - 0.05,
        Pose::Normal => around(at, 1.0) - over(at),
        Pose::LongitudinalNegative => 1.08 * around(at, 0.90) - 0.95 * blob(at, [0.0, -0.45], [0.42, 0.36]),
        Pose::Extension => {
            let white = 0.75 * blob(at, [0.0, -0.35], [0.36, 0.42]) + 0.70 * blob(at, [0.0, 0.16], [0.40, 0.17]);
            white - 0.95 * step(0.30, 0.70, at[1])
        }
        Pose::LongitudinalPositive => {
            0.95 * blob(at, [0.0, -0.42], [0.58, 0.30]) - 1.0 * around([at[0], at[1] + 0.05], 0.95)
        }
        Pose::Flexion => -0.80 - 0.2 * blob(at, [0.0, 0.2], [0.6, 0.6]),
        Pose::LateralNegative => lateral(at),
        Pose::LateralPositive => 0.94 * lateral([-at[0] * 1.03 + 0.02, at[1] + 0.03]),
    }
}
