//! The nail's frame: its axis and box (section 4.2.2).
//!
//! Length is the outline's greatest extent along the axis, "from the eponychium to the hyponychium", width the greatest
//! extent across it, "between the lateral nail folds", the centre the middle of that box. Nail coordinates are
//! (across, along) in widths and lengths from the centre: the box is -0.5..0.5 both ways, across to the right and along
//! towards the distal end, not mirrored.

use geo::{Area, BooleanOps, Coord, LineString, Polygon, Rect};
use thiserror::Error;

use crate::median::ends;
use crate::photo::outline::{Axis, Outline, Unlike};

/// The smallest box that can still be distinguished from a speck, pixels.
pub const SMALLEST_EXTENT_PX: f64 = 4.0;

/// A nail is no more times as wide as it is long (measured: 122 nails of 26 real photographs up to 1.28, seen in
/// perspective; two nails in one outline 2 and more).
const WIDEST: f64 = 1.8;
/// The part of its lesser extent over which an edge of the photograph may cut an outline off, how near to the edge that
/// is seen, pixels, and the part of what an oval would have beyond the edge that an outline needs to be a whole one
/// (assumed).
const CUT: f64 = 0.5;
const AT_EDGE_PX: f64 = 1.0;
const GOES_ON: f64 = 0.5;
/// An outline that only touches the edge grows at once: so far within it, as a share of its extent, it is wider by more
/// than this (an oval of which less than a tenth is cut off, and a square one that touches).
const WITHIN: f64 = 0.06;
const GROWS: f64 = 0.8;
/// Less of a move or a change of size is not worth a word (assumed).
const SLIGHT: f64 = 0.05;

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
        let extents = [right, distal].map(|to| ends(points.iter().map(|[x, y]| x * to[0] + y * to[1])));
        let [width_px, length_px] = extents.map(|[low, high]| high - low);
        let middle = extents.map(|[low, high]| (low + high) / 2.0);
        let center_px = [middle[0] * right[0] + middle[1] * distal[0], middle[0] * right[1] + middle[1] * distal[1]];
        Self { center_px, length_px, width_px, axis }
    }

    /// What its shape says against one whole nail in a photograph of `width` x `height` pixels.
    pub(crate) fn doubt(&self, outline: &Outline, size: [u32; 2]) -> Option<String> {
        let (width, length) = (self.width_px, self.length_px);
        if width > WIDEST * length {
            return Some(format!(
                "it is {:.1} times as wide as long: are several nails in one outline, or is its axis another one?",
                width / length
            ));
        }
        let points = outline.points();
        let edges = [0, 1].into_iter().flat_map(|k| [(k, 1.0, 0.5), (k, -1.0, f64::from(size[k]) - 0.5)]);
        let longest =
            edges.filter_map(|(k, sign, edge)| cut_off(&points, k, |at| sign * at + edge)).fold(0.0, f64::max);
        (longest > CUT * width.min(length)).then(|| {
            format!(
                "it is cut off by the edge of the picture, over {longest:.0} px: its length and width are not known; \
                 where you know the rest, draw it beyond the edge"
            )
        })
    }

    /// What is seen instead of the outline that this is the box of, in words.
    pub(crate) fn instead(&self, seen: &Unlike) -> String {
        let Unlike::Elsewhere(outline) = seen else { return "no nail is seen there".to_owned() };
        let other = Self::around(&outline.points(), self.axis);
        let away = [0, 1].map(|k| other.center_px[k] - self.center_px[k]);
        let along = |way: [f64; 2], unit_px: f64| (away[0] * way[0] + away[1] * way[1]) / unit_px;
        let moved = [
            (along(self.axis.distal(), self.length_px), ["lengths further distal", "lengths further proximal"]),
            (along(self.axis.right(), self.width_px), ["widths further right", "widths further left"]),
        ];
        let moved = moved.into_iter().filter(|(by, _)| by.abs() >= SLIGHT);
        let mut words: Vec<String> =
            moved.map(|(by, [more, less])| format!("{:.2} {}", by.abs(), if by > 0.0 { more } else { less })).collect();
        let times = ((other.length_px * other.width_px) / (self.length_px * self.width_px)).sqrt();
        words.extend((times.ln().abs() >= SLIGHT).then(|| format!("{times:.2} times as large")));
        format!("the nail is seen {}", if words.is_empty() { "in another shape".to_owned() } else { words.join(", ") })
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

/// Over how many pixels an outline is cut off by an edge, of which `inside` says how far within a coordinate `k` is;
/// none where it is not, or goes on beyond the edge as far as an oval does.
fn cut_off(outline: &[[f64; 2]], k: usize, inside: impl Fn(f64) -> f64) -> Option<f64> {
    let points: Vec<[f64; 2]> = outline.iter().map(|point| [inside(point[k]), point[1 - k]]).collect();
    let [[nearest, farthest], [low, high]] = [0, 1].map(|axis| ends(points.iter().map(|point| point[axis])));
    if nearest > AT_EDGE_PX {
        return None;
    }
    let width_at = |within: f64| -> f64 {
        let sides = points.iter().zip(points.iter().cycle().skip(1));
        let mut crossings: Vec<f64> = sides
            .filter(|(a, b)| (a[0] > within) != (b[0] > within))
            .map(|(a, b)| a[1] + (within - a[0]) / (b[0] - a[0]) * (b[1] - a[1]))
            .collect();
        crossings.sort_by(f64::total_cmp);
        crossings.chunks_exact(2).map(|pair| pair[1] - pair[0]).sum()
    };
    let chord = width_at(AT_EDGE_PX);
    if chord < GROWS * width_at(AT_EDGE_PX + WITHIN * (farthest - nearest)) {
        return None;
    }
    let share = (chord / (high - low)).min(1.0);
    let beyond = (farthest - nearest) / 2.0 * (1.0 - (1.0 - share * share).sqrt());
    (-nearest < GOES_ON * beyond).then_some(chord)
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
    fn a_nail_that_an_edge_cuts_off_and_several_in_one_outline_are_doubted() {
        let up = Axis::from_clockwise_rad(0.0);
        let around = |at: &dyn Fn(f64, f64) -> [f64; 2]| {
            let angles = (0..90).map(|k| f64::from(k) * std::f64::consts::TAU / 90.0);
            let points: Vec<[f64; 2]> = angles.map(|angle| at(angle.cos(), angle.sin())).collect();
            Outline::new(&points).expect("an outline")
        };
        let oval = |center: [f64; 2], radii: [f64; 2], low: f64| {
            around(&|cos, sin| [center[0] + radii[0] * cos, (center[1] + radii[1] * sin).max(low)])
        };
        let doubt = |outline: &Outline, picture: [u32; 2]| {
            NailFrame::new(outline, up).expect("large enough").doubt(outline, picture)
        };
        let said = |outline: &Outline| doubt(outline, [200, 150]).unwrap_or_default();
        // A square nail that fills its picture only touches the edges.
        let rounded = |c: f64| c.signum() * c.abs().sqrt();
        let square = around(&|cos, sin| [29.5 + 30.0 * rounded(cos), 39.5 + 40.0 * rounded(sin)]);
        assert_eq!(doubt(&square, [60, 80]), None);
        // Whole, also at the edge; cut off by it, as masks are, and as a detected outline ends some pixels beyond it.
        for y in [75.0, 39.6, 38.8] {
            assert_eq!(said(&oval([100.0, y], [30.0, 40.0], -0.5)), "", "{y}");
        }
        for (y, low) in [(30.0, -0.5), (0.0, -0.5), (0.0, -3.0), (30.0, 0.4)] {
            assert!(said(&oval([100.0, y], [30.0, 40.0], low)).contains("cut off by the edge"), "{y} {low}");
        }
        assert!(said(&oval([199.0, 75.0], [30.0, 40.0], -0.5)).is_empty(), "drawn beyond the edge");
        let turned = oval([0.0, 100.0], [40.0, 30.0], -0.5);
        let cut: Vec<[f64; 2]> = turned.points().iter().map(|[y, x]| [x.min(199.0 - 80.0), *y + 60.0]).collect();
        let outline = Outline::new(&cut).expect("an outline");
        assert!(doubt(&outline, [120, 150]).is_some_and(|said| said.contains("cut off")), "to the right");
        assert_eq!(doubt(&outline, [200, 150]), None);
        assert!(said(&oval([100.0, 75.0], [80.0, 35.0], -0.5)).contains("2.3 times as wide as long"));
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
