//! The light on a scene: how bright, of which tint, from where, and its reflections on the plate.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use crate::phantom::nail::smooth::bell;

/// Encoded values in the thesis' chamber over those in full light: it puts the nail bed's green at 30 to 50 % of full
/// scale.
pub(in crate::phantom::nail) const CHAMBER: f64 = 0.60;

/// A streak of light mirrored by the plate, on the nail's own coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Glare {
    /// Middle across (`u`).
    pub u: f64,
    /// Middle along (`v`).
    pub v: f64,
    /// Standard deviation across, in `u`.
    pub half_width: f64,
    /// Standard deviation along, in `v`.
    pub half_length: f64,
    /// How much `u` moves per `v`.
    pub tilt: f64,
    /// 0 none, 1 just saturated in the middle, more: saturated over a wider area.
    pub strength: f64,
}

/// The light of one photograph.
#[derive(Debug, Clone, PartialEq)]
pub struct Light {
    /// Encoded values relative to the chamber's light, 1 in the chamber.
    pub brightness: f64,
    /// Factors of red, green and blue, about 1.
    pub tint: [f64; 3],
    /// Relative change of the encoded values from the picture's middle to its right and to its lower border.
    pub gradient: [f64; 2],
    /// How far from the finger's ridge the lightest place lies, in finger half widths to the right.
    pub side: f64,
    /// Reflections on the plate.
    pub glare: Vec<Glare>,
}

impl Light {
    /// The thesis' chamber: from behind the hand, even, without glare.
    pub fn chamber() -> Self {
        Self { brightness: 1.0, tint: [1.0; 3], gradient: [0.0, 0.04], side: 0.0, glare: Vec::new() }
    }

    /// The chamber with what varies in it from photograph to photograph.
    pub fn random_chamber(rng: &mut ChaCha8Rng) -> Self {
        Self {
            brightness: rng.random_range(0.96..1.04),
            gradient: [rng.random_range(-0.02..0.02), rng.random_range(0.0..0.06)],
            side: rng.random_range(-0.1..0.1),
            ..Self::chamber()
        }
    }

    /// Any light a photograph of a nail is taken in: dim to bright, neutral, warm or greenish, from any side, half of
    /// them with glare.
    pub fn random(rng: &mut ChaCha8Rng) -> Self {
        let base: [f64; 3] = match rng.random_range(0..4u32) {
            0 => [1.06, 0.98, 0.82],
            1 => [0.88, 1.05, 0.86],
            2 => [0.95, 1.0, 1.08],
            _ => [1.0; 3],
        };
        let tint = base.map(|c| c * rng.random_range(0.97..1.03));
        let brightness = 0.6 * 2.9_f64.powf(rng.random_range(0.0..1.0));
        let gradient = [rng.random_range(-0.14..0.14), rng.random_range(-0.14..0.14)];
        let side = rng.random_range(-0.4..0.4);
        let spots = if rng.random_bool(0.5) { rng.random_range(1..3usize) } else { 0 };
        let glare = (0..spots)
            .map(|_| Glare {
                u: rng.random_range(-0.7..0.7),
                v: rng.random_range(-0.5..0.6),
                half_width: rng.random_range(0.03..0.11),
                half_length: rng.random_range(0.10..0.5),
                tilt: rng.random_range(-0.15..0.15),
                strength: rng.random_range(0.35..1.3),
            })
            .collect();
        Self { brightness, tint, gradient, side, glare }
    }

    /// How much of full white the plate mirrors at (`u`, `v`), 0 to 1.
    pub(in crate::phantom::nail) fn mirrored(&self, u: f64, v: f64) -> f64 {
        self.glare.iter().fold(0.0, |sum, spot| {
            let along = v - spot.v;
            // The plate's curvature bends the streak outward towards its ends.
            let across = u - spot.u - spot.tilt * along - 0.12 * spot.u * along * along;
            let t2 = (across / spot.half_width).powi(2) + (along / spot.half_length).powi(2);
            let peak = spot.strength * bell(t2);
            let bounded = peak / (1.0 + peak.powi(4)).sqrt().sqrt();
            sum + bounded * (1.0 - sum)
        })
    }
}
