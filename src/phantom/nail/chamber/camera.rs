//! The camera: size of the picture, where and how large the nail is on it, how sharp, and what lies behind the finger.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use crate::nail::Axis;

/// What is seen beside the finger.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Background {
    /// Its colour in full light, encoded.
    pub colour: [f64; 3],
    /// Relative strength of its grain.
    pub grain: f64,
    /// How much darker it is close to the finger, 0 to 1.
    pub shadow: f64,
}

/// The camera of one photograph.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Width of the picture in pixels.
    pub width: u32,
    /// Height of the picture in pixels.
    pub height: u32,
    /// The middle of the nail's box, `[x_px, y_px]`.
    pub centre_px: [f64; 2],
    /// The nail's width in pixels.
    pub nail_width_px: f64,
    /// The nail's axis.
    pub axis: Axis,
    /// Standard deviation of the optics' blur in pixels, 0.7 to 1 for a good camera.
    pub blur_px: f64,
    /// What is seen beside the finger.
    pub background: Background,
}

impl Background {
    /// The chamber's dark inside.
    pub fn chamber() -> Self {
        Self { colour: [0.085, 0.085, 0.09], grain: 0.1, shadow: 0.0 }
    }

    /// The chamber, or a surface of any grey or muted colour.
    pub fn random(rng: &mut ChaCha8Rng) -> Self {
        if rng.random_bool(0.3) {
            return Self::chamber();
        }
        let grey: f64 = rng.random_range(0.12..0.85);
        let colour = std::array::from_fn(|_| (grey + rng.random_range(-0.12..0.12)).clamp(0.03, 0.95));
        Self { colour, grain: rng.random_range(0.01..0.12), shadow: rng.random_range(0.05..0.35) }
    }
}

impl Camera {
    /// A good camera of which the picture has this width and height, upright, before the chamber's inside.
    pub fn upright([width, height]: [u32; 2], centre_px: [f64; 2], nail_width_px: f64) -> Self {
        let (axis, background) = (Axis::from_clockwise_rad(0.0), Background::chamber());
        Self { width, height, centre_px, nail_width_px, axis, blur_px: 1.0, background }
    }

    /// A close-up of a nail of length over width `aspect`: the nail's length is `filling` of the picture's height (less
    /// where its width would not fit), the axis within `turn_deg` of
    /// upright, the middle within what the picture leaves free.
    pub fn close_up(rng: &mut ChaCha8Rng, size: [u32; 2], aspect: f64, filling: f64, turn_deg: f64) -> Self {
        let [width, height] = size.map(f64::from);
        let filling = filling.min(0.75 * aspect * width / height);
        let nail_width_px = filling * height / aspect;
        let free = |side: f64, used: f64| (0.5 * (side - 1.25 * used)).max(0.0).min(0.08 * side);
        let (fx, fy) = (free(width, nail_width_px), free(height, filling * height));
        let centre_px = [
            0.5 * (width - 1.0) + fx * rng.random_range(-1.0..1.0),
            0.5 * (height - 1.0) + fy * rng.random_range(-1.0..1.0),
        ];
        let axis = Axis::from_clockwise_rad((turn_deg * rng.random_range(-1.0..1.0)).to_radians());
        let blur_px = rng.random_range(0.7..1.0);
        Self { axis, blur_px, ..Self::upright(size, centre_px, nail_width_px) }
    }
}
