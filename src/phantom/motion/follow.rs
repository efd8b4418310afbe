//! How a finger departs from what it is prompted to do (assumed; section 5.2.2a).
//!
//! What is prompted is done about 0.3 s later, the lag itself moving by up to 30 %, and with smooth errors: of the
//! pressing and of the angles a share of what is prompted, of the shear's components the same share of what friction
//! holds. The share is given by its standard deviation; 5.2.2a quotes 6 % for people who watch a picture of their force
//! (Jones 1998). A shear that friction would not hold slips: it is cut at the cone. The errors are the seed's: a log
//! and a video of the same seed are of the same movement.

use crate::phantom::motion::wave::{Wave, random_wave};

pub(in crate::phantom) const KIND_FOLLOW: u32 = 28;
/// Rates of the errors lie between 0.4 and 4 times this, hertz.
const FOLLOW_HZ: f64 = 0.3;
/// How late a finger follows, seconds, and how far that moves as a share.
pub(in crate::phantom) const LATE_S: f64 = 0.3;
const LATE_SWING: f64 = 0.3;

/// A finger's lateness and errors.
#[derive(Debug, Clone)]
pub(in crate::phantom) struct Follow {
    /// What waves are multiplied by.
    size: f64,
    late: Wave,
    /// Of the pressing, Fx, Fy, the angles.
    errors: [Wave; 4],
}

impl Follow {
    /// Errors with this standard deviation, as a share; none where it is 0.
    pub(in crate::phantom) fn new(share: f64, seed: u64) -> Option<Self> {
        let wave = |index: u32| random_wave(FOLLOW_HZ, 0.4..4.0, seed, KIND_FOLLOW, index);
        (share > 0.0).then(|| Self { size: share / Wave::RMS, late: wave(1), errors: [2, 3, 4, 5].map(wave) })
    }

    pub(in crate::phantom) fn late_s(&self, t_s: f64) -> f64 {
        LATE_S * (1.0 + LATE_SWING * self.late.at(t_s))
    }

    fn error(&self, which: usize, t_s: f64) -> f64 {
        self.size * self.errors[which].at(t_s)
    }

    /// What becomes of angles that were prompted.
    pub(in crate::phantom) fn angles_rad(&self, angles_rad: [f64; 3], t_s: f64) -> [f64; 3] {
        let bending = self.error(3, t_s);
        angles_rad.map(|angle| angle * (1.0 + bending))
    }

    /// What becomes of forces that were prompted, newtons, where friction holds `mu` times the pressing.
    pub(in crate::phantom) fn forces_n(&self, [fx_n, fy_n, fz_n]: [f64; 3], t_s: f64, mu: f64) -> [f64; 3] {
        let pressing_n = -fz_n * (1.0 + self.error(0, t_s));
        let most_n = mu * pressing_n;
        let (fx_n, fy_n) = (fx_n + self.error(1, t_s) * most_n, fy_n + self.error(2, t_s) * most_n);
        let held = if fx_n.hypot(fy_n) > most_n { most_n / fx_n.hypot(fy_n) } else { 1.0 };
        [held * fx_n, held * fy_n, -pressing_n]
    }
}
