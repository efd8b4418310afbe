//! Smooth lines and circles on a plane of 8 bits; what lies beyond its borders is left out.
//!
//! Places are good to a sixteenth of a sample.

use opencv::core::{Point, Scalar};
use opencv::imgproc::{self, LINE_AA};

use super::{VisionError, answered, pixels_mut};

const BITS: i32 = 4;

/// What to draw.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Stroke {
    /// From one place to another.
    Line([[f64; 2]; 2]),
    /// About a place.
    Circle { at: [f64; 2], radius: f64 },
}

impl Stroke {
    /// The same, moved.
    pub(crate) fn moved(&self, by: [f64; 2]) -> Self {
        let place = |[x, y]: [f64; 2]| [x + by[0], y + by[1]];
        match *self {
            Self::Line(ends) => Self::Line(ends.map(place)),
            Self::Circle { at, radius } => Self::Circle { at: place(at), radius },
        }
    }

    /// Its least and greatest places: left, top, right, bottom.
    pub(crate) fn bounds(&self) -> [f64; 4] {
        match *self {
            Self::Line([[x, y], [u, v]]) => [x.min(u), y.min(v), x.max(u), y.max(v)],
            Self::Circle { at: [x, y], radius } => [x - radius, y - radius, x + radius, y + radius],
        }
    }

    /// Draws it `wide` samples wide.
    pub(crate) fn draw(&self, plane: &mut [u8], size: [usize; 2], value: u8, wide: u8) {
        answered(self.try_draw(plane, size, value, wide));
    }

    fn try_draw(&self, plane: &mut [u8], [width, height]: [usize; 2], value: u8, wide: u8) -> Result<(), VisionError> {
        let mut plane = pixels_mut::<u8>(height, width, plane)?;
        // From 2 on OpenCV's lines are one wider than their thickness.
        let (value, thickness) = (Scalar::all(f64::from(value)), i32::from(wide.max(2)) - 1);
        // So far away nothing is seen, and OpenCV's numbers suffice.
        let fixed = |at: f64| (at.clamp(-1e5, 1e5) * f64::from(1 << BITS)).round() as i32;
        let point = |[x, y]: [f64; 2]| Point::new(fixed(x), fixed(y));
        match *self {
            Self::Line([from, to]) => {
                imgproc::line(&mut plane, point(from), point(to), value, thickness, LINE_AA, BITS)
                    .map_err(VisionError::of("line"))
            }
            Self::Circle { at, radius } => {
                imgproc::circle(&mut plane, point(at), fixed(radius.max(0.0)), value, thickness, LINE_AA, BITS)
                    .map_err(VisionError::of("circle"))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strokes_lie_where_they_should() {
        let drawn = |stroke: Stroke| {
            let mut plane = vec![0; 40 * 30];
            stroke.draw(&mut plane, [40, 30], 200, 1);
            plane
        };
        let line = drawn(Stroke::Line([[-1e9, 10.0], [20.5, 10.0]]));
        assert!((1..19).all(|x| line[40 * 10 + x] > 150 && line[40 * 12 + x] == 0) && line[40 * 10 + 23] == 0);
        // Between two rows it lies on both.
        let line = drawn(Stroke::Line([[5.0, 10.5], [20.0, 10.5]]));
        assert!(line[410].abs_diff(line[450]) <= 10 && line[410] > 60, "{} {}", line[410], line[450]);
        let circle = drawn(Stroke::Circle { at: [19.0, 15.0], radius: 8.0 });
        let at = |x: usize, y: usize| circle[40 * y + x];
        assert!([(27, 15), (11, 15), (19, 23), (19, 7)].iter().all(|&(x, y)| at(x, y) > 150));
        assert_eq!(at(19, 15), 0);
        assert!(drawn(Stroke::Circle { at: [900.0, f64::NAN], radius: 8.0 }).iter().all(|&value| value == 0));
        assert!(Stroke::Line([[0.0; 2]; 2]).try_draw(&mut [0; 7], [4, 2], 1, 1).is_err());
    }
}
