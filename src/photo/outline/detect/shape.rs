//! The template: a nail as a tapered superellipse in a frame.
//!
//! |u / (1 - taper v)|^n + |v|^n = 1, where u runs across in half widths and v along in half lengths, +1 the distal
//! end.

/// Exponent of the superellipse: 2 an ellipse, large a rectangle.
pub(super) const EXPONENT: f64 = 2.5;

/// A nail in units of its frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OutlineShape {
    /// Centre.
    pub x: f64,
    /// Centre.
    pub y: f64,
    /// Length along the nail's axis.
    pub length: f64,
    /// Width across it.
    pub width: f64,
    /// Turn of the nail's axis from the frame's +y, clockwise, radians.
    pub turn: f64,
    /// How much narrower the distal end is than the proximal (half the difference).
    pub taper: f64,
}

/// The taper of a nail of which nothing else is known.
pub(super) const TAPER: f64 = 0.03;

impl OutlineShape {
    pub(super) fn point(&self, u: f64, v: f64) -> [f64; 2] {
        let (sin, cos) = self.turn.sin_cos();
        let (a, b) = (u * self.width / 2.0, v * self.length / 2.0);
        [self.x + a * cos + b * sin, self.y - a * sin + b * cos]
    }

    /// (u, v) of a point of the frame.
    pub(super) fn local(&self, p: [f64; 2]) -> [f64; 2] {
        let (sin, cos) = self.turn.sin_cos();
        let (x, y) = (p[0] - self.x, p[1] - self.y);
        [(x * cos - y * sin) / (self.width / 2.0), (x * sin + y * cos) / (self.length / 2.0)]
    }

    /// Whether a point of the frame lies within.
    pub fn holds(&self, p: [f64; 2]) -> bool {
        let [u, v] = self.local(p);
        (u / (1.0 - self.taper * v)).abs().powf(EXPONENT) + v.abs().powf(EXPONENT) <= 1.0
    }

    /// Boundary point (u, v) at parameter `t` radians: 0 the right side, pi/2 the distal end.
    pub(super) fn rim(&self, t: f64) -> [f64; 2] {
        let (sin, cos) = t.sin_cos();
        let r = (cos.abs().powf(EXPONENT) + sin.abs().powf(EXPONENT)).powf(-1.0 / EXPONENT);
        let v = r * sin;
        [r * cos * (1.0 - self.taper * v), v]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_on_the_template_and_in_its_frame_go_back_and_forth() {
        let shape = OutlineShape { x: 0.3, y: -0.5, length: 0.9, width: 0.6, turn: 0.4, taper: 0.1 };
        for k in 0..40 {
            let [u, v] = shape.rim(f64::from(k) * 0.157);
            let point = shape.point(u, v);
            let back = shape.local(point);
            assert!((back[0] - u).abs() <= 1e-12 && (back[1] - v).abs() <= 1e-12);
            assert!(shape.holds(shape.point(0.99 * u, 0.99 * v)) && !shape.holds(shape.point(1.01 * u, 1.01 * v)));
        }
        // Clockwise: the distal end of a template turned by 90 degrees lies to the right.
        let turned = OutlineShape { turn: std::f64::consts::FRAC_PI_2, x: 0.0, y: 0.0, ..shape };
        let distal = turned.point(0.0, 1.0);
        assert!((distal[0] - 0.45).abs() <= 1e-12 && distal[1].abs() <= 1e-12);
    }
}
