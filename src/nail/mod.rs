//! A nail's outline on a photograph, and the axis that it is measured along.
//!
//! An [`Outline`] is one simple closed polygon in the pixels of the *upright* photograph: the centre of the top-left
//! pixel is (0, 0), x to the right, y down. An [`Axis`] is a direction on that picture, from the eponychium (proximal)
//! to the hyponychium (distal).

mod positions;

pub use positions::{Position, Positions, PositionsFault};

use geo::{
    Area, BooleanOps, BoundingRect, Centroid, ConvexHull, Coord, Distance, Euclidean, Intersects, Line, LineString,
    Point, Polygon, Rect,
};
use thiserror::Error;

/// Why a list of points is no outline of a nail.
#[derive(Debug, Clone, PartialEq, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum OutlineFault {
    #[error("the outline has {0} different point(s); an outline needs at least 3")]
    TooFewPoints(usize),
    #[error("point {0} of the outline is not finite")]
    NotFinite(usize),
    /// More points than any outline needs.
    #[error("the outline has {0} points, more than {MOST_POINTS}; draw it with fewer")]
    TooManyPoints(usize),
    #[error("the outline crosses itself; draw it once around the nail")]
    SelfCrossing,
    #[error("the outline encloses no area")]
    NoArea,
}

/// Points of an outline beyond which it is refused: a nail drawn to the pixel in a photograph of 200 megapixels has a
/// fifth (assumed).
const MOST_POINTS: usize = 200_000;

/// An outline that fills so much of its convex hull has no spike, nor one whose second corner reaches nearly as far as
/// the first (28 drawn ones fill it, 127 masks of real hands 0.98 of it in the median and 0.76 at least; of a nail of
/// 312 x 225 px whose corner is 120 px out it is 0.86).
const FULL: f64 = 0.93;
const ALONE: f64 = 0.2;

/// The outline of one nail: a simple polygon in pixels of the upright photograph.
///
/// ```
/// use lunula::nail::Outline;
///
/// let nail = Outline::new(&[[10.0, 10.0], [50.0, 10.0], [50.0, 70.0], [10.0, 70.0]])?;
/// assert_eq!(nail.area_px2(), 2400.0);
/// // A line that crosses itself encloses no nail.
/// assert!(Outline::new(&[[0.0, 0.0], [9.0, 9.0], [9.0, 0.0], [0.0, 9.0]]).is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
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
        if points.len() > MOST_POINTS {
            return Err(OutlineFault::TooManyPoints(points.len()));
        }
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

    /// The corner `[x_px, y_px]` that stands out alone, as by a slip of the mouse; none where the outline is round, or
    /// another corner reaches nearly as far from its middle.
    #[must_use]
    pub fn spike(&self) -> Option<[f64; 2]> {
        if self.area_px2() > FULL * self.polygon.convex_hull().unsigned_area() {
            return None;
        }
        let middle = self.polygon.centroid()?;
        let far = |point: &[f64; 2]| Euclidean.distance(middle, Point::from(*point));
        let mut points = self.points();
        points.sort_by(|a, b| far(b).total_cmp(&far(a)));
        let [first, second, ..] = points[..] else { return None };
        (far(&second) < (1.0 - ALONE) * far(&first)).then_some(first)
    }

    /// Enclosed area, square pixels.
    pub fn area_px2(&self) -> f64 {
        self.polygon.unsigned_area()
    }

    /// Whether the middle of one lies in the other, as of two outlines of one nail and of no two nails.
    #[must_use]
    pub fn is_around(&self, other: &Self) -> bool {
        let holds = |outer: &Self, inner: &Self| inner.polygon.centroid().is_some_and(|c| outer.polygon.intersects(&c));
        holds(self, other) || holds(other, self)
    }

    /// The share of its border that is no further than `gap_px` from the border of `other`, 0 to 1, to pieces of that
    /// length.
    pub(crate) fn share_beside(&self, other: &Self, gap_px: f64) -> f64 {
        let near = |a: Rect<f64>, b: Rect<f64>| {
            let apart = |low: f64, high: f64| low - high > gap_px;
            !(apart(a.min().x, b.max().x)
                || apart(b.min().x, a.max().x)
                || apart(a.min().y, b.max().y)
                || apart(b.min().y, a.max().y))
        };
        if !self.polygon.bounding_rect().zip(other.polygon.bounding_rect()).is_some_and(|(a, b)| near(a, b)) {
            return 0.0;
        }
        let (mut all, mut beside) = (0.0, 0.0);
        for side in self.polygon.exterior().lines() {
            let length = side.dx().hypot(side.dy());
            let pieces = (length / gap_px).ceil().max(1.0) as u32;
            let part = length / f64::from(pieces);
            for piece in 0..pieces {
                let at = (f64::from(piece) + 0.5) / f64::from(pieces);
                let middle = Point::new(side.start.x + at * side.dx(), side.start.y + at * side.dy());
                all += part;
                if Euclidean.distance(&middle, other.polygon.exterior()) <= gap_px {
                    beside += part;
                }
            }
        }
        if all > 0.0 { beside / all } else { 0.0 }
    }

    /// Intersection over union with `other`, 0 to 1 (exact, by polygon clipping).
    pub fn iou(&self, other: &Self) -> f64 {
        let apart = |a: Option<Rect<f64>>, b: Option<Rect<f64>>| a.zip(b).is_some_and(|(a, b)| !a.intersects(&b));
        if apart(self.polygon.bounding_rect(), other.polygon.bounding_rect()) {
            return 0.0;
        }
        let both = self.polygon.intersection(&other.polygon).unsigned_area();
        both / (self.area_px2() + other.area_px2() - both)
    }
}

/// Whether two sides that are not neighbours touch, or two neighbours lie on one another. Runs of sides whose extents
/// are apart are passed over together, so that the time grows about as the number of sides does.
fn crosses_itself(polygon: &Polygon<f64>) -> bool {
    let sides: Vec<Line<f64>> = polygon.exterior().lines().collect();
    let count = sides.len();
    let folds_back = |k: usize| {
        let (here, after) = (&sides[k], &sides[(k + 1) % count]);
        orient(here.start, here.end, after.end) == 0.0 && dot(here.delta(), after.delta()) < 0.0
    };
    if (0..count).any(folds_back) {
        return true;
    }
    // A binary tree of extents in an array: side k is node `leaves + k`, node n holds nodes 2n and 2n + 1.
    let leaves = count.next_power_of_two();
    let mut extents = vec![Extent::NOTHING; 2 * leaves];
    for (extent, side) in extents[leaves..].iter_mut().zip(&sides) {
        *extent = Extent::of(side);
    }
    for node in (1..leaves).rev() {
        extents[node] = extents[2 * node].with(extents[2 * node + 1]);
    }
    let mut open = vec![(1, 1)];
    while let Some((a, b)) = open.pop() {
        if a == b {
            if a < leaves {
                let (left, right) = (2 * a, 2 * a + 1);
                open.extend([(left, left), (right, right), (left, right)]);
            }
        } else if extents[a].meets(extents[b]) {
            if a < leaves {
                // Both are of one depth.
                open.extend([(2 * a, 2 * b), (2 * a, 2 * b + 1), (2 * a + 1, 2 * b), (2 * a + 1, 2 * b + 1)]);
            } else {
                let (a, b) = (a - leaves, b - leaves);
                let neighbours = b == a + 1 || (a == 0 && b == count - 1);
                if !neighbours && sides[a].intersects(&sides[b]) {
                    return true;
                }
            }
        }
    }
    false
}

/// The extent of sides in x and y.
#[derive(Debug, Clone, Copy)]
struct Extent {
    low: [f64; 2],
    high: [f64; 2],
}

impl Extent {
    const NOTHING: Self = Self { low: [f64::INFINITY; 2], high: [f64::NEG_INFINITY; 2] };

    fn of(side: &Line<f64>) -> Self {
        let (a, b) = (side.start, side.end);
        Self { low: [a.x.min(b.x), a.y.min(b.y)], high: [a.x.max(b.x), a.y.max(b.y)] }
    }

    fn with(self, other: Self) -> Self {
        let both = |k: usize| (self.low[k].min(other.low[k]), self.high[k].max(other.high[k]));
        let [x, y] = [both(0), both(1)];
        Self { low: [x.0, y.0], high: [x.1, y.1] }
    }

    fn meets(self, other: Self) -> bool {
        (0..2).all(|k| self.low[k] <= other.high[k] && other.low[k] <= self.high[k])
    }
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

    /// The angle between two, within 0..=180.
    pub fn apart_deg(self, other: Self) -> f64 {
        Self::from_clockwise_rad(self.clockwise_from_up_rad - other.clockwise_from_up_rad).clockwise_deg().abs()
    }

    /// Turned clockwise.
    #[must_use]
    pub fn turned(self, by_rad: f64) -> Self {
        Self::from_clockwise_rad(self.clockwise_from_up_rad + by_rad)
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
    fn a_corner_that_was_pulled_out_stands_out_and_no_others_do() {
        let nail = |corners: usize, pulled_px: f64, at: usize| {
            let corner = |k: usize| {
                let (sin, cos) = (std::f64::consts::TAU * k as f64 / corners as f64).sin_cos();
                let far = 1.0 + if k == at { pulled_px / (112.0 * sin).hypot(156.0 * cos) } else { 0.0 };
                [300.0 + 112.0 * far * sin, 300.0 - 156.0 * far * cos]
            };
            Outline::new(&(0..corners).map(corner).collect::<Vec<_>>()).expect("an outline")
        };
        for (corners, at) in [(40, 0), (40, 3), (40, 10), (120, 31)] {
            let far = nail(corners, 130.0, at);
            assert_eq!(far.spike(), Some(far.points()[at]), "{corners} {at}");
            assert_eq!([nail(corners, 0.0, at), nail(corners, 20.0, at)].map(|nail| nail.spike()), [None; 2]);
        }
        // A few corners, and a sickle.
        let sickle = [[0.0, 0.0], [100.0, 30.0], [120.0, 100.0], [100.0, 170.0], [0.0, 200.0], [60.0, 100.0]];
        for corners in [&sickle[..], &sickle[..3], &sickle[1..5]] {
            assert_eq!(Outline::new(corners).expect("an outline").spike(), None);
        }
    }

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
    fn a_hundred_thousand_points_are_checked_at_once() {
        let ring = |count: u32| -> Vec<[f64; 2]> {
            let turn = |k: u32| f64::from(k) * std::f64::consts::TAU / f64::from(count);
            (0..count).map(|k| [500.0 + 300.0 * turn(k).cos(), 500.0 + 400.0 * turn(k).sin()]).collect()
        };
        let start = std::time::Instant::now();
        let mut points = ring(100_000);
        assert!(Outline::new(&points).is_ok());
        // The far side touched by one point.
        points[0] = points[50_000];
        assert_eq!(Outline::new(&points), Err(OutlineFault::SelfCrossing));
        // Every pair of sides took 5 s, optimized.
        assert!(start.elapsed().as_secs_f64() < 2.0, "{:?}", start.elapsed());
        assert_eq!(Outline::new(&ring(300_000)), Err(OutlineFault::TooManyPoints(300_000)));
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
