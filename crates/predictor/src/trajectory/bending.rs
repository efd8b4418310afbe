//! How the finger bends (equation 27), and bending at random within the same range.

use std::f64::consts::TAU;

use super::{Wave, normal, smooth};

const STREAM: u64 = 27 << 32;

/// Equation 27: theta = J2 = 35 - 40 cos(2 pi f_b t) degrees, from -5 to 75.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bending {
    /// f_b, hertz.
    pub hz: f64,
}

impl Default for Bending {
    fn default() -> Self {
        Self { hz: 0.1 }
    }
}

impl Bending {
    /// The middle of the range of 5.2.2a, degrees.
    pub const MIDDLE_DEG: f64 = 35.0;
    /// Half of that range, degrees.
    pub const HALF_DEG: f64 = 40.0;
    /// How long the protocol of 5.2.4 has it bend, seconds: six cycles.
    pub const PROTOCOL_S: f64 = 60.0;

    /// J2 at `t_s`, degrees.
    #[must_use]
    pub fn j2_deg(&self, t_s: f64) -> f64 {
        Self::MIDDLE_DEG - Self::HALF_DEG * (TAU * self.hz * t_s).cos()
    }

    /// The fastest that J2 gets, degrees a second.
    #[must_use]
    pub fn fastest_deg_per_s(&self) -> f64 {
        Self::HALF_DEG * TAU * self.hz.abs()
    }
}

/// Smooth, band-limited bending that covers equation 27's range about evenly (5.2.4, 3i): J2 = -5 + 80 Phi(w / RMS)
/// degrees, w a [`Wave`] with rates of 0.4 to 4 times `hz`, which is about normal. It begins straight out, at -5
/// degrees, and comes into the wave within a soft start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RandomBending {
    soft_s: f64,
    wave: Wave,
}

impl RandomBending {
    /// Bending of `seed`; `soft_s` 0: in the wave from the first moment on.
    #[must_use]
    pub fn new(hz: f64, soft_s: f64, seed: u64) -> Self {
        Self { soft_s, wave: Wave::random(hz, 0.4..4.0, seed, STREAM) }
    }

    /// J2 at `t_s`, degrees.
    #[must_use]
    pub fn j2_deg(&self, t_s: f64) -> f64 {
        let lowest = Bending::MIDDLE_DEG - Bending::HALF_DEG;
        let above = 2.0 * Bending::HALF_DEG * normal(self.wave.at(t_s) / Wave::RMS);
        lowest + if self.soft_s > 0.0 { smooth(t_s / self.soft_s) * above } else { above }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equation_27_bends_from_minus_5_to_75_degrees() {
        let bending = Bending::default();
        assert!((bending.j2_deg(0.0) + 5.0).abs() <= 1e-12 && (bending.j2_deg(5.0) - 75.0).abs() <= 1e-12);
        assert!((bending.j2_deg(2.5) - 35.0).abs() <= 1e-12);
        let fastest = (bending.j2_deg(2.5 + 1e-5) - bending.j2_deg(2.5 - 1e-5)) / 2e-5;
        assert!((fastest - bending.fastest_deg_per_s()).abs() <= 1e-6, "{fastest}");
    }

    #[test]
    fn bending_at_random_begins_at_rest_and_stays_in_the_range() {
        let bending = RandomBending::new(0.1, 2.0, 5);
        assert_eq!((bending.j2_deg(-1.0), bending.j2_deg(0.0)), (-5.0, -5.0));
        assert!((bending.j2_deg(1e-3) + 5.0).abs() <= 1e-3);
        let angles: Vec<f64> = (0..5000).map(|k| bending.j2_deg(f64::from(k) * 0.04)).collect();
        assert!(angles.iter().all(|angle| (-5.0..=75.0).contains(angle)));
        // Of 200 s, eighths of the range; measured 0.100 to 0.143 of the time each.
        for eighth in 0..8 {
            let from = -5.0 + 10.0 * f64::from(eighth);
            let share = angles.iter().filter(|angle| (from..from + 10.0).contains(*angle)).count() as f64 / 5000.0;
            assert!((0.08..=0.17).contains(&share), "{from} {share}");
        }
        assert_ne!(bending, RandomBending::new(0.1, 2.0, 6));
    }
}
