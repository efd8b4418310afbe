//! The nail bed's colour at a moment: how much of each zone there is while the finger presses, shears and bends.
//!
//! In: what the fingertip does, `[N, Fx, Fy, J2]` (pressing N = -Fz, newtons; radians). Out: a weight of each of
//! [`PATTERNS`] zones, those of the eight poses; the bed's whitening at a place is their sum. With
//!
//! - white(N) = 1 - exp(-N / 1.2), red(N) = 1 - exp(-N / 0.45), more(N) = 1 - exp(-(N / 2.5)^2), each over its value at
//!   3 N (w, r, m), and F = hypot(Fx, Fy), even(F) = 1 - exp(-(F / 1.2)^2), odd(F) = tanh(F / 1.5), each over its value
//!   at 2 N (e, o): the saturations of [`sensor`](crate::phantom::sensor), all of them assumed;
//! - the shears of one pose each: to the right w (e Fx^2 / F^2 + o Fx / F) / 2, to the left, forward and backward
//!   alike; together s = w e;
//! - the pressing's white zone w - s; its red zone 1.25 r - 0.25 m - s, which pales a little at greater pressing: the
//!   "encroaching whitening zone" of 3.3.2 (its size assumed);
//! - bending b = (1 - x)^2 with x = (J2 + 10) / (flat + 10) degrees held to 0..1 (3.3.5): the parabola through flexion
//!   at b = 0, nominal at straight, extension at b = 1; pressing takes the nominal pattern away by r.
//!
//! So each of the eight poses of [`Pose`] (3 N; 3 N with 2 N of shear; straight, extended to -10 degrees, flexed) has
//! exactly the zones of its photograph; everything between them is assumed. Colours go further than in photographs:
//! where a press whitens them, real nails have green 17 to 22 % up, blue 12 to 21 % and red 0 to 5 % (*measured* on
//! recordings in colour), where 4.2.2 says that red and blue are "almost identical".
//!
//! What the blood does late is of [`sensor`](crate::phantom::sensor): places that are distal follow another lag than
//! proximal ones (4.3), so weights come for both, and a place has a share of each: distal from v = 0.2 on, proximal to
//! v = -0.05, as the photodiodes of 3.2.2 lie.

use rand::RngExt;

use super::{Habit, Pose, around, of_pose, over};
use crate::phantom::nail::Subject;
use crate::phantom::nail::smooth::step;
use crate::phantom::nail::subject::numbers;

/// How many zones there are: nominal, the pressing's white and red, four shears, extension, flexion.
pub const PATTERNS: usize = 9;

const KIND_BLOOD: u32 = 40;

/// Where pressing and shear have the photographs' zones, newtons.
const POSE_N: [f64; 2] = [3.0, 2.0];
/// How much of the red zone comes before the encroaching whitening takes it away at the pose's pressing (assumed).
const ENCROACHING: f64 = 0.25;
/// The J2 of full extension (Fig. 34), degrees.
const EXTENDED_DEG: f64 = -10.0;

/// Change of red, green and blue with the zones over the photographs' change of green.
pub(in crate::phantom::nail) const DEPTH: [f64; 3] = [0.22, 1.2, 0.82];

/// How much of each zone there is: at distal places, at proximal ones.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ColourWeights {
    /// From v = 0.2 on.
    pub distal: [f64; PATTERNS],
    /// To v = -0.05.
    pub proximal: [f64; PATTERNS],
}

/// What is one person's of the blood below the nail, beside the zones' places and sizes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Blood {
    /// The J2 beyond which nothing changes, radians.
    pub flat_rad: f64,
    /// The lags over the common ones.
    pub lag: f64,
}

impl Blood {
    /// That of a subject.
    #[must_use]
    pub fn of(subject: &Subject) -> Self {
        let mut rng = numbers(u64::from(subject.seed), KIND_BLOOD, 0);
        // As far as the people of `sensor` differ.
        Self {
            flat_rad: (27.5 + rng.random_range(-2.5..=2.5f64)).to_radians(),
            lag: 1.0 + rng.random_range(-0.15..=0.15),
        }
    }

    /// The zones that forces make, of `[N, Fx, Fy]` newtons; of the nominal zone what pressing takes away.
    #[must_use]
    pub fn touched(&self, [pressing_n, fx_n, fy_n]: [f64; 3]) -> [f64; PATTERNS] {
        let risen = |x: f64| 1.0 - (-x).exp();
        let pressing_n = pressing_n.max(0.0);
        let of_pose = |map: &dyn Fn(f64) -> f64, is: f64, pose: f64| map(is) / map(pose);
        let [pressed, sheared] = POSE_N;
        let white = of_pose(&|n| risen(n / 1.2), pressing_n, pressed);
        let red = of_pose(&|n| risen(n / 0.45), pressing_n, pressed);
        let more = of_pose(&|n| risen((n / 2.5).powi(2)), pressing_n, pressed);
        let shear_n = fx_n.hypot(fy_n);
        let even = white * of_pose(&|f| risen((f / 1.2).powi(2)), shear_n, sheared);
        let odd = white * of_pose(&|f| (f / 1.5).tanh(), shear_n, sheared);
        let towards = |component_n: f64| {
            let share = if shear_n > 0.0 { component_n / shear_n } else { 0.0 };
            0.5 * (even * share * share + odd * share)
        };
        let opposite = |component_n: f64| towards(-component_n);
        [
            -red,
            white - even,
            (1.0 + ENCROACHING) * red - ENCROACHING * more - even,
            opposite(fx_n),
            towards(fx_n),
            opposite(fy_n),
            towards(fy_n),
            0.0,
            0.0,
        ]
    }

    /// The zones that bending makes: nominal, extension, flexion.
    #[must_use]
    pub fn bent(&self, j2_rad: f64) -> [f64; 3] {
        let extended_rad = EXTENDED_DEG.to_radians();
        let at = |j2_rad: f64| {
            let flexed = ((j2_rad - extended_rad) / (self.flat_rad - extended_rad)).clamp(0.0, 1.0);
            (1.0 - flexed).powi(2)
        };
        let (b, straight) = (at(j2_rad), at(0.0));
        [
            b * (1.0 - b) / (straight * (1.0 - straight)),
            b * (b - straight) / (1.0 - straight),
            (b - straight) * (b - 1.0) / straight,
        ]
    }
}

impl ColourWeights {
    /// Of forces' zones, distal and proximal, and bending's.
    #[must_use]
    pub fn of(distal: [f64; PATTERNS], proximal: [f64; PATTERNS], [nominal, extended, flexed]: [f64; 3]) -> Self {
        let both = |mut touched: [f64; PATTERNS]| {
            touched[0] += nominal;
            touched[PATTERNS - 2] += extended;
            touched[PATTERNS - 1] += flexed;
            touched
        };
        Self { distal: both(distal), proximal: both(proximal) }
    }

    /// What a subject's nail has when it does this for long: `[Fx, Fy, Fz]` newtons, J1, J2, J3 radians.
    #[must_use]
    pub fn resting(subject: &Subject, forces_n: [f64; 3], angles_rad: [f64; 3]) -> Self {
        let blood = Blood::of(subject);
        let touched = blood.touched([-forces_n[2], forces_n[0], forces_n[1]]);
        Self::of(touched, touched, blood.bent(angles_rad[1]))
    }
}

/// The share of the distal blood's lag at `v`.
pub(in crate::phantom::nail) fn distal_share(v: f64) -> f64 {
    step(-0.05, 0.20, v)
}

/// Each zone's whitening at (`u`, `v`).
pub(in crate::phantom::nail) fn patterns(habit: &Habit, u: f64, v: f64) -> [f64; PATTERNS] {
    let at = habit.at(u, v);
    [
        of_pose(Pose::Nominal, at),
        around(at, 1.0),
        -over(at),
        of_pose(Pose::LateralNegative, at),
        of_pose(Pose::LateralPositive, at),
        of_pose(Pose::LongitudinalNegative, at),
        of_pose(Pose::LongitudinalPositive, at),
        of_pose(Pose::Extension, at),
        of_pose(Pose::Flexion, at),
    ]
}

/// The zones' sum at (`u`, `v`).
pub(in crate::phantom::nail) fn whitening(weights: &ColourWeights, habit: &Habit, u: f64, v: f64) -> f64 {
    let share = distal_share(v);
    let all = weights.distal.iter().zip(&weights.proximal).zip(patterns(habit, u, v));
    all.map(|((distal, proximal), zone)| (proximal + share * (distal - proximal)) * zone).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::phantom::nail::coloration::zones;

    /// What the finger does in a pose, as 4.2.2 has it.
    fn moment(pose: Pose) -> ([f64; 3], f64) {
        let [pressing_n, shear_n] = POSE_N;
        match pose {
            Pose::Nominal => ([0.0; 3], 0.0),
            Pose::Normal => ([0.0, 0.0, -pressing_n], 0.0),
            Pose::LateralNegative => ([-shear_n, 0.0, -pressing_n], 0.0),
            Pose::LateralPositive => ([shear_n, 0.0, -pressing_n], 0.0),
            Pose::LongitudinalNegative => ([0.0, -shear_n, -pressing_n], 0.0),
            Pose::LongitudinalPositive => ([0.0, shear_n, -pressing_n], 0.0),
            Pose::Extension => ([0.0; 3], EXTENDED_DEG.to_radians()),
            Pose::Flexion => ([0.0; 3], 75f64.to_radians()),
        }
    }

    #[test]
    fn each_pose_has_the_zones_of_its_photograph() {
        for subject in (0..8).map(|k| Subject::random(0, k)) {
            for pose in Pose::ALL {
                let (forces_n, j2_rad) = moment(pose);
                let weights = ColourWeights::resting(&subject, forces_n, [0.3, j2_rad, 0.2]);
                for k in 0..400 {
                    let (u, v) = (-1.0 + 0.1 * f64::from(k % 20), -1.0 + 0.1 * f64::from(k / 20));
                    let gap = whitening(&weights, &subject.habit, u, v) - zones(pose, &subject.habit, u, v);
                    assert!(gap.abs() <= 1e-12, "{pose} at {u} {v}: {gap}");
                }
            }
        }
    }

    #[test]
    fn weights_are_bounded_and_smooth_all_over_the_cone_of_friction() {
        let blood = Blood { flat_rad: 0.48, lag: 1.0 };
        let mut before: Option<[f64; PATTERNS]> = None;
        for k in 0..20_000 {
            let turn = 0.001 * f64::from(k);
            let pressing_n = 2.5 - 2.5 * (0.37 * turn).cos();
            let shear_n = 0.75 * pressing_n * (0.53 * turn).sin();
            let weights = blood.touched([pressing_n, shear_n * turn.cos(), shear_n * turn.sin()]);
            assert!(weights.iter().all(|weight| weight.abs() <= 1.4), "{weights:?}");
            if let Some(before) = before {
                assert!(before.iter().zip(weights).all(|(a, b)| (a - b).abs() <= 0.01), "{turn}: {weights:?}");
            }
            before = Some(weights);
        }
        assert_eq!(blood.touched([-0.1, 0.0, 0.0]), [0.0; PATTERNS].map(|zero: f64| -zero + 0.0));
    }
}
