//! An affine motion of the picture plane.
//!
//! (x, y) goes to (a x + b y + c, d x + e y + f), pixels of the shown picture; the six numbers in that order, as
//! `truth/frames.csv` of the phantom has them.

/// The motion, with its six numbers in the order of the module's head.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::nailvideo) struct Affine(pub(in crate::nailvideo) [f64; 6]);

impl Affine {
    /// Nothing moves.
    pub(in crate::nailvideo) const IDENTITY: Self = Self([1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);

    /// Where a point goes.
    #[must_use]
    pub(in crate::nailvideo) fn of(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [a, b, c, d, e, f] = self.0;
        [a * x + b * y + c, d * x + e * y + f]
    }

    /// First `first`, then this one.
    #[must_use]
    pub(in crate::nailvideo) fn after(&self, first: &Self) -> Self {
        let ([a, b, c, d, e, f], [k, l, m, n, o, p]) = (self.0, first.0);
        Self([a * k + b * n, a * l + b * o, a * m + b * p + c, d * k + e * n, d * l + e * o, d * m + e * p + f])
    }

    /// The way back; `None` where all falls onto a line.
    #[must_use]
    pub(in crate::nailvideo) fn inverse(&self) -> Option<Self> {
        let [a, b, c, d, e, f] = self.0;
        let det = self.determinant();
        let back = [e / det, -b / det, (b * f - e * c) / det, -d / det, a / det, (d * c - a * f) / det];
        back.iter().all(|part| part.is_finite()).then_some(Self(back))
    }

    /// By how much areas grow.
    #[must_use]
    pub(in crate::nailvideo) fn determinant(&self) -> f64 {
        let [a, b, _, d, e, _] = self.0;
        a * e - b * d
    }

    /// A turn (clockwise as seen, y down), a scale and a shift that leave `about` where `to` is.
    #[must_use]
    pub(in crate::nailvideo) fn similarity(about: [f64; 2], to: [f64; 2], turn_rad: f64, scale: f64) -> Self {
        let (sin, cos) = turn_rad.sin_cos();
        let (p, q) = (scale * cos, scale * sin);
        Self([p, -q, to[0] - p * about[0] + q * about[1], q, p, to[1] - q * about[0] - p * about[1]])
    }
}

/// [`Affine::of`] in single precision, for many points.
#[inline(always)]
pub(in crate::nailvideo) fn moved([a, b, c, d, e, f]: [f32; 6], [x, y]: [f32; 2]) -> [f32; 2] {
    [a * x + b * y + c, d * x + e * y + f]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_and_back_is_nowhere() {
        let motion = Affine([1.02, -0.05, 31.0, 0.04, 0.97, -12.0]);
        let back = motion.inverse().unwrap().after(&motion);
        // Rounding: measured 4e-15.
        assert!(back.0.iter().zip(Affine::IDENTITY.0).all(|(a, b)| (a - b).abs() <= 1e-13), "{back:?}");
        assert_eq!(Affine([1.0, 2.0, 0.0, 2.0, 4.0, 0.0]).inverse(), None);
    }

    #[test]
    fn a_similarity_keeps_its_middle() {
        let turned = Affine::similarity([10.0, 20.0], [13.0, 18.0], 0.3, 1.1);
        let [x, y] = turned.of([10.0, 20.0]);
        assert!((x - 13.0).abs() <= 1e-12 && (y - 18.0).abs() <= 1e-12);
        assert!((turned.determinant() - 1.21).abs() <= 1e-12);
        // Clockwise with y down: what was to the right goes down.
        assert!(turned.of([11.0, 20.0])[1] > 18.0);
    }
}
