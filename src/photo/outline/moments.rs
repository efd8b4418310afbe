//! The shape of one outline: area moments, and the principal axis that follows from them.
//!
//! In: an [`Outline`]. Out: its centroid and the two principal axes of its area, exact for the polygon (Green's
//! theorem; e.g. <https://en.wikipedia.org/wiki/Second_moment_of_area#Any_polygon>). A mirror-symmetric shape has its
//! symmetry axis along one of the two, but the moments tell neither which one nor which end is distal.

use geo::{Area, ConvexHull};

use super::{Axis, Outline};

/// Area moments of an outline.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moments {
    /// Centroid of the enclosed area, `[x_px, y_px]`.
    pub centroid_px: [f64; 2],
    /// Length of the long axis of the ellipse with the same second moments, pixels.
    pub major_px: f64,
    /// Length of the short axis of that ellipse, pixels.
    pub minor_px: f64,
    /// One of the two directions of the long axis.
    pub major: Axis,
}

/// Area over the area of the convex hull, 1 for a shape without dents.
pub(super) fn solidity(outline: &Outline) -> f64 {
    outline.area_px2() / outline.polygon().convex_hull().unsigned_area()
}

impl Moments {
    /// The moments of `outline`.
    pub fn of(outline: &Outline) -> Self {
        let ring = &outline.polygon().exterior().0;
        let origin = ring[0];
        let (mut area2, mut sx, mut sy) = (0.0, 0.0, 0.0);
        let (mut sxx, mut syy, mut sxy) = (0.0, 0.0, 0.0);
        for pair in ring.windows(2) {
            let (x0, y0) = (pair[0].x - origin.x, pair[0].y - origin.y);
            let (x1, y1) = (pair[1].x - origin.x, pair[1].y - origin.y);
            let cross = x0 * y1 - x1 * y0;
            area2 += cross;
            sx += cross * (x0 + x1);
            sy += cross * (y0 + y1);
            sxx += cross * (x0 * x0 + x0 * x1 + x1 * x1);
            syy += cross * (y0 * y0 + y0 * y1 + y1 * y1);
            sxy += cross * (x0 * (2.0 * y0 + y1) + x1 * (2.0 * y1 + y0));
        }
        let (cx, cy) = (sx / (3.0 * area2), sy / (3.0 * area2));
        let var_x = sxx / (6.0 * area2) - cx * cx;
        let var_y = syy / (6.0 * area2) - cy * cy;
        let cov = sxy / (12.0 * area2) - cx * cy;
        let (mean, half) = (0.5 * (var_x + var_y), (0.5 * (var_x - var_y)).hypot(cov));
        // Angle of the long axis from x towards y; clockwise from up it is a quarter turn more.
        let angle = 0.5 * (2.0 * cov).atan2(var_x - var_y);
        Self {
            centroid_px: [origin.x + cx, origin.y + cy],
            major_px: 4.0 * (mean + half).max(0.0).sqrt(),
            minor_px: 4.0 * (mean - half).max(0.0).sqrt(),
            major: Axis::from_clockwise_rad(angle + std::f64::consts::FRAC_PI_2),
        }
    }

    /// Long axis over short axis, 1 for a round shape.
    pub fn elongation(&self) -> f64 {
        self.major_px / self.minor_px.max(f64::MIN_POSITIVE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turned_rectangle_has_its_own_axes() {
        for turn in [0.0_f64, 0.3, 1.2, -0.9] {
            let (sin, cos) = turn.sin_cos();
            // 30 long, 12 wide, long side at `turn` clockwise from up, far from the origin.
            let corners = [[-6.0, -15.0], [6.0, -15.0], [6.0, 15.0], [-6.0, 15.0]]
                .map(|[u, v]: [f64; 2]| [4000.0 + u * cos - v * sin, 3000.0 + u * sin + v * cos]);
            let moments = Moments::of(&Outline::new(&corners).expect("a rectangle"));
            // A rectangle's side is sqrt(12) standard deviations, the ellipse's axis 4.
            let ratio = 4.0 / 12.0_f64.sqrt();
            assert!((moments.major_px - 30.0 * ratio).abs() <= 1e-9);
            assert!((moments.minor_px - 12.0 * ratio).abs() <= 1e-9);
            assert!((moments.centroid_px[0] - 4000.0).abs() + (moments.centroid_px[1] - 3000.0).abs() <= 1e-9);
            assert!((moments.major.clockwise_rad() - turn).sin().abs() <= 1e-9, "turn {turn}");
        }
    }
}
