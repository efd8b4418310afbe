//! The nail's frame: its axis and box (section 4.2.2).
//!
//! Length is the outline's greatest extent along the axis, "from the eponychium to the hyponychium", width the greatest
//! extent across it, "between the lateral nail folds", the centre the middle of that box. Nail coordinates are
//! (across, along) in widths and lengths from the centre: the box is -0.5..0.5 both ways, across to the right and along
//! towards the distal end, not mirrored.

use geo::{Area, BooleanOps, Coord, LineString, Polygon, Rect};
use thiserror::Error;

use crate::photo::outline::{Axis, Outline};

/// The smallest box that can still be distinguished from a speck, pixels.
pub const SMALLEST_EXTENT_PX: f64 = 4.0;

/// Why an outline gives no frame.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum FrameFault {
    /// Too few pixels.
    #[error(
        "the nail is only {length_px:.1} px long and {width_px:.1} px wide; at least {SMALLEST_EXTENT_PX} are needed"
    )]
    TooSmall {
        /// Extent along the axis.
        length_px: f64,
        /// Extent across it.
        width_px: f64,
    },
}

/// A nail's box on the upright photograph.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NailFrame {
    /// Middle of the box, pixels.
    pub center_px: [f64; 2],
    /// Extent along the axis, pixels.
    pub length_px: f64,
    /// Extent across it, pixels.
    pub width_px: f64,
    /// From proximal to distal.
    pub axis: Axis,
}

impl NailFrame {
    /// Measures `outline` along and across `axis`.
    ///
    /// # Errors
    /// [`FrameFault::TooSmall`] under [`SMALLEST_EXTENT_PX`] either way.
    pub fn new(outline: &Outline, axis: Axis) -> Result<Self, FrameFault> {
        let frame = Self::around(&outline.points(), axis);
        let Self { length_px, width_px, .. } = frame;
        if width_px < SMALLEST_EXTENT_PX || length_px < SMALLEST_EXTENT_PX {
            return Err(FrameFault::TooSmall { length_px, width_px });
        }
        Ok(frame)
    }

    /// The box of `points` along and across `axis`, however small it is; NaN and infinite where there is no point.
    pub(crate) fn around(points: &[[f64; 2]], axis: Axis) -> Self {
        let (right, distal) = (axis.right(), axis.distal());
        let mut low = [f64::INFINITY; 2];
        let mut high = [f64::NEG_INFINITY; 2];
        for [x, y] in points {
            let across_along = [x * right[0] + y * right[1], x * distal[0] + y * distal[1]];
            for k in 0..2 {
                low[k] = low[k].min(across_along[k]);
                high[k] = high[k].max(across_along[k]);
            }
        }
        let (width_px, length_px) = (high[0] - low[0], high[1] - low[1]);
        let middle = [(low[0] + high[0]) / 2.0, (low[1] + high[1]) / 2.0];
        let center_px = [middle[0] * right[0] + middle[1] * distal[0], middle[0] * right[1] + middle[1] * distal[1]];
        Self { center_px, length_px, width_px, axis }
    }

    /// What share of the box lies outside of a photograph of `width` x `height` pixels, 0 to 1.
    pub fn share_outside(&self, [width, height]: [u32; 2]) -> f64 {
        let corners = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)].map(|(u, v)| self.photo_from_nail(u, v));
        let ring = LineString::from(corners.to_vec());
        let low = Coord { x: -0.5, y: -0.5 };
        let high = Coord { x: f64::from(width) - 0.5, y: f64::from(height) - 0.5 };
        let seen = Polygon::new(ring, vec![]).intersection(&Rect::new(low, high).to_polygon()).unsigned_area();
        (1.0 - seen / (self.width_px * self.length_px)).clamp(0.0, 1.0)
    }

    /// The photograph's pixel of a point of the nail, `across` in widths and `along` in lengths from the centre.
    pub fn photo_from_nail(&self, across: f64, along: f64) -> [f64; 2] {
        let (right, distal) = (self.axis.right(), self.axis.distal());
        let (u, v) = (across * self.width_px, along * self.length_px);
        [self.center_px[0] + u * right[0] + v * distal[0], self.center_px[1] + u * right[1] + v * distal[1]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounding of a rotation's sines and cosines over some hundred pixels.
    const ROUNDING_PX: f64 = 1e-10;
    /// Polygons are clipped on a grid of 2^-30 of their extent.
    const CLIPPING: f64 = 1e-6;

    #[test]
    fn a_turned_rectangle_keeps_its_measures() {
        for degrees in [0.0, 30.0, -75.0, 90.0, 180.0] {
            let axis = Axis::from_clockwise_rad(f64::to_radians(degrees));
            let straight = NailFrame { center_px: [120.0, 80.0], length_px: 60.0, width_px: 40.0, axis };
            let corners =
                [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)].map(|(u, v)| straight.photo_from_nail(u, v));
            let outline = Outline::new(&corners).expect("a rectangle");
            let measured = NailFrame::new(&outline, axis).expect("large enough");
            assert!((measured.length_px - 60.0).abs() <= ROUNDING_PX, "{degrees}");
            assert!((measured.width_px - 40.0).abs() <= ROUNDING_PX, "{degrees}");
            assert!((measured.center_px[0] - 120.0).abs() <= ROUNDING_PX, "{degrees}");
            assert!((measured.center_px[1] - 80.0).abs() <= ROUNDING_PX, "{degrees}");
        }
    }

    #[test]
    fn the_share_outside_is_that_of_the_turned_box() {
        let share = |x: f64, degrees: f64| {
            let axis = Axis::from_clockwise_rad(degrees.to_radians());
            let frame = NailFrame { center_px: [x, 49.5], length_px: 40.0, width_px: 40.0, axis };
            frame.share_outside([200, 100])
        };
        assert!((share(99.5, 30.0)).abs() <= CLIPPING);
        assert!((share(-0.5, 0.0) - 0.5).abs() <= CLIPPING);
        assert!((share(-0.5, 45.0) - 0.5).abs() <= CLIPPING);
        assert!((share(-10.5, 90.0) - 0.75).abs() <= CLIPPING);
        assert_eq!(share(-500.0, 10.0), 1.0);
    }

    #[test]
    fn distal_to_the_right_puts_the_nail_s_right_down() {
        let axis = Axis::through([0.0, 0.0], [10.0, 0.0]).expect("a direction");
        assert_eq!(axis.clockwise_deg(), 90.0);
        let frame = NailFrame { center_px: [0.0, 0.0], length_px: 2.0, width_px: 2.0, axis };
        let [x, y] = frame.photo_from_nail(0.5, 0.0);
        assert!(x.abs() <= ROUNDING_PX && (y - 1.0).abs() <= ROUNDING_PX);
    }

    #[test]
    fn a_speck_is_no_nail() {
        let speck = Outline::new(&[[0.0, 0.0], [3.0, 0.0], [3.0, 9.0], [0.0, 9.0]]).expect("a rectangle");
        let fault = NailFrame::new(&speck, Axis::from_clockwise_rad(0.0)).expect_err("3 px wide");
        assert_eq!(fault, FrameFault::TooSmall { length_px: 9.0, width_px: 3.0 });
    }
}
