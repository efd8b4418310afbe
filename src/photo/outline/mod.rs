//! Outlines of nails, and the axis that each one is measured along.
//!
//! An [`Outline`] is one simple closed polygon in the pixels of the *upright* photograph: the centre of the top-left
//! pixel is (0, 0), x to the right, y down. An [`Axis`] is a direction on that picture, from the eponychium (proximal)
//! to the hyponychium (distal).

pub mod detect;

use geo::{Area, BooleanOps, Coord, LineString, Polygon, Validation};
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
        if !polygon.is_valid() {
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
