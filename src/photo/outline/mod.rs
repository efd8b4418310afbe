//! Outlines of nails, and the axis that each one is measured along.
//!
//! An [`Outline`] is one simple closed polygon in the pixels of the *upright* photograph: the centre of the top-left
//! pixel is (0, 0), x to the right, y down. An [`Axis`] is a direction on that picture, from the eponychium (proximal)
//! to the hyponychium (distal).

mod annotated;
mod axis;
mod detect;
mod finger;
mod mask;
mod patch;
mod shape;
mod source;

pub use annotated::{
    AXIS, Annotated, AnnotationFault, DOUBTFUL, Drawn, NAIL, ShapeFault, ToDraw, read as read_annotated, to_file,
};
pub use axis::{AxisDoubt, AxisUnknown, FoundAxis, LEAST_CONFIDENCE, Side, axis_towards, find_axes, find_axes_towards};
pub use detect::{DetectOptions, Detected, Detections, NothingFound, detect};
pub use mask::{DroppedRegion, MaskFault, MaskOutlines, outlines_from_mask};
pub use shape::Shape;
pub use source::{Found, Nail, OutlineOptions, Source, SourceFault, Sources};

use geo::{Area, BooleanOps, Coord, Intersects, Line, LineString, Polygon};
use thiserror::Error;

/// Why a list of points is no outline of a nail.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum OutlineFault {
    /// Fewer than three different points.
    #[error("the outline has {0} different point(s); an outline needs at least 3")]
    TooFewPoints(usize),
    /// A coordinate is NaN or infinite.
    #[error("point {0} of the outline is not finite")]
    NotFinite(usize),
    /// The polygon crosses itself.
    #[error("the outline crosses itself; draw it once around the nail")]
    SelfCrossing,
    /// The polygon encloses nothing.
    #[error("the outline encloses no area")]
    NoArea,
}

/// The outline of one nail: a simple polygon in pixels of the upright photograph.
#[derive(Debug, Clone, PartialEq)]
pub struct Outline {
    polygon: Polygon<f64>,
}

impl Outline {
    /// Checks `points` (`[x_px, y_px]`, in order around the nail, the first need not be repeated).
    ///
    /// # Errors
    /// [`OutlineFault`] where the points do not enclose one region once.
    pub fn new(points: &[[f64; 2]]) -> Result<Self, OutlineFault> {
        if let Some(bad) = points.iter().position(|p| !p[0].is_finite() || !p[1].is_finite()) {
            return Err(OutlineFault::NotFinite(bad));
        }
        let mut ring: Vec<Coord<f64>> = Vec::with_capacity(points.len() + 1);
        for &[x, y] in points {
            let point = Coord { x, y };
            if ring.last() != Some(&point) {
                ring.push(point);
            }
        }
        while ring.len() > 1 && ring.first() == ring.last() {
            ring.pop();
        }
        if ring.len() < 3 {
            return Err(OutlineFault::TooFewPoints(ring.len()));
        }
        let polygon = Polygon::new(LineString::new(ring), vec![]);
        if crosses_itself(&polygon) {
            return Err(OutlineFault::SelfCrossing);
        }
        if polygon.unsigned_area() <= 0.0 {
            return Err(OutlineFault::NoArea);
        }
        Ok(Self { polygon })
    }

    /// The polygon, closed.
    pub fn polygon(&self) -> &Polygon<f64> {
        &self.polygon
    }

    /// The corners `[x_px, y_px]`, each once.
    pub fn points(&self) -> Vec<[f64; 2]> {
        let ring = &self.polygon.exterior().0;
        ring[..ring.len() - 1].iter().map(|c| [c.x, c.y]).collect()
    }

    /// Enclosed area, square pixels.
    pub fn area_px2(&self) -> f64 {
        self.polygon.unsigned_area()
    }

    /// Intersection over union with `other`, 0 to 1 (exact, by polygon clipping).
    pub fn iou(&self, other: &Self) -> f64 {
        let both = self.polygon.intersection(&other.polygon).unsigned_area();
        both / (self.area_px2() + other.area_px2() - both)
    }
}

/// Whether two sides that are not neighbours touch, or two neighbours lie on one another. Most pairs are told apart by
/// their extents alone, which makes this ten times faster than a full validation of a drawn outline.
fn crosses_itself(polygon: &Polygon<f64>) -> bool {
    let sides: Vec<(Line<f64>, [f64; 4])> = polygon
        .exterior()
        .lines()
        .map(|l| (l, [l.start.x.min(l.end.x), l.start.x.max(l.end.x), l.start.y.min(l.end.y), l.start.y.max(l.end.y)]))
        .collect();
    let meet = |(a, [left, right, top, bottom]): &(Line<f64>, [f64; 4]), (b, [l, r, t, m]): &(Line<f64>, [f64; 4])| {
        left <= r && l <= right && top <= m && t <= bottom && a.intersects(b)
    };
    (0..sides.len()).any(|k| {
        let next = (k + 1) % sides.len();
        let last = if k == 0 { sides.len() - 1 } else { sides.len() };
        let (here, after) = (&sides[k].0, &sides[next].0);
        let folds_back = orient(here.start, here.end, after.end) == 0.0 && dot(here.delta(), after.delta()) < 0.0;
        folds_back || (k + 2..last).any(|other| meet(&sides[k], &sides[other]))
    })
}

fn dot(a: Coord<f64>, b: Coord<f64>) -> f64 {
    a.x * b.x + a.y * b.y
}

/// Twice the signed area of a triangle.
fn orient(a: Coord<f64>, b: Coord<f64>, c: Coord<f64>) -> f64 {
    (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)
}

/// A direction on the upright photograph, from proximal to distal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axis {
    clockwise_from_up_rad: f64,
}

impl Axis {
    /// The axis turned clockwise from "up" on the picture, any finite angle.
    pub fn from_clockwise_rad(angle: f64) -> Self {
        let turn = std::f64::consts::TAU;
        let wrapped = angle - turn * (angle / turn).round();
        Self { clockwise_from_up_rad: wrapped }
    }

    /// The axis from a proximal to a distal point `[x_px, y_px]`; `None` where they coincide or are not finite.
    pub fn through(proximal: [f64; 2], distal: [f64; 2]) -> Option<Self> {
        let (dx, dy) = (distal[0] - proximal[0], distal[1] - proximal[1]);
        let length = dx.hypot(dy);
        (length.is_finite() && length > 0.0).then(|| Self::from_clockwise_rad(dx.atan2(-dy)))
    }

    /// Clockwise from up, within -pi..=pi.
    pub fn clockwise_rad(self) -> f64 {
        self.clockwise_from_up_rad
    }

    /// Clockwise from up, within -180..=180.
    pub fn clockwise_deg(self) -> f64 {
        self.clockwise_from_up_rad.to_degrees()
    }

    /// Unit vector towards the distal end, `[x, y]` with y down.
    pub fn distal(self) -> [f64; 2] {
        let (sin, cos) = self.clockwise_from_up_rad.sin_cos();
        [sin, -cos]
    }

    /// Unit vector to the right of the nail frame (distal up, not mirrored), `[x, y]` with y down.
    pub fn right(self) -> [f64; 2] {
        let (sin, cos) = self.clockwise_from_up_rad.sin_cos();
        [cos, sin]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use geo::Validation;
    use proptest::prelude::*;

    #[test]
    fn what_is_no_outline_is_refused_with_its_reason() {
        let fault = |points: &[[f64; 2]]| Outline::new(points).expect_err("no outline");
        assert_eq!(fault(&[]), OutlineFault::TooFewPoints(0));
        assert_eq!(fault(&[[0.0, 0.0], [9.0, 9.0]]), OutlineFault::TooFewPoints(2));
        assert_eq!(fault(&[[1.0, 1.0], [1.0, 1.0], [5.0, 5.0], [1.0, 1.0]]), OutlineFault::TooFewPoints(2));
        assert_eq!(fault(&[[0.0, 0.0], [9.0, 0.0], [f64::NAN, 9.0]]), OutlineFault::NotFinite(2));
        assert_eq!(fault(&[[0.0, 0.0], [9.0, 9.0], [9.0, 0.0], [0.0, 9.0]]), OutlineFault::SelfCrossing);
        assert_eq!(fault(&[[0.0, 0.0], [9.0, 0.0], [4.0, 0.0]]), OutlineFault::SelfCrossing);
        // Two triangles that share a corner: the outline touches itself.
        let hourglass = [[0.0, 0.0], [4.0, 4.0], [8.0, 0.0], [8.0, 8.0], [4.0, 4.0], [0.0, 8.0]];
        assert_eq!(fault(&hourglass), OutlineFault::SelfCrossing);
    }

    #[test]
    fn a_square_overlaps_its_shifted_twin_by_a_third() {
        let square = |x: f64| Outline::new(&[[x, 0.0], [x + 4.0, 0.0], [x + 4.0, 4.0], [x, 4.0]]).expect("a square");
        assert_eq!(square(0.0).iou(&square(2.0)), 1.0 / 3.0);
        assert_eq!(square(0.0).iou(&square(5.0)), 0.0);
        assert_eq!(square(0.0).area_px2(), 16.0);
    }

    #[test]
    fn axes_are_clockwise_from_up() {
        let degrees = |to: [f64; 2]| Axis::through([0.0, 0.0], to).expect("a direction").clockwise_deg();
        assert_eq!([degrees([0.0, -1.0]), degrees([1.0, 0.0]), degrees([-1.0, 0.0])], [0.0, 90.0, -90.0]);
        assert!(Axis::through([1.0, 1.0], [1.0, 1.0]).is_none());
        assert!((Axis::from_clockwise_rad(7.0).clockwise_rad() - (7.0 - std::f64::consts::TAU)).abs() <= 1e-12);
    }

    proptest! {
        /// The fast check's twin is geo's full validation.
        #[test]
        fn crossing_is_what_geo_calls_invalid(points in prop::collection::vec((0_i8..12, 0_i8..12), 3..9)) {
            let points: Vec<[f64; 2]> = points.into_iter().map(|(x, y)| [f64::from(x), f64::from(y)]).collect();
            let mut ring: Vec<Coord<f64>> = points.iter().map(|&[x, y]| Coord { x, y }).collect();
            ring.dedup();
            while ring.len() > 1 && ring.first() == ring.last() {
                ring.pop();
            }
            prop_assume!(ring.len() >= 3);
            let polygon = Polygon::new(LineString::new(ring), vec![]);
            prop_assert_eq!(Outline::new(&points).is_ok(), polygon.is_valid() && polygon.unsigned_area() > 0.0);
        }
    }
}
