//! Where a character is on the stored picture: a box, upright or turned, or any parallelogram.

use crate::video::Turn;

/// The box of a digit's ink as a parallelogram on the stored picture. Coordinates are those of its samples: the centre
/// of the top-left one is (0, 0), x right, y down; ink on the columns 3 to 5 reaches from 2.5 to 5.5.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// The box's corner at the digit's top left, samples.
    pub corner: [f64; 2],
    /// From there to the digit's top right, samples.
    pub across: [f64; 2],
    /// From there to the digit's bottom left, samples.
    pub down: [f64; 2],
}

impl Place {
    /// An upright box: left, top, right, bottom, samples.
    #[must_use]
    pub fn upright([x0, y0, x1, y1]: [f64; 4]) -> Self {
        Self { corner: [x0, y0], across: [x1 - x0, 0.0], down: [0.0, y1 - y0] }
    }

    /// An upright box of the *shown* picture (left, top, right, bottom), `size` the stored width and height.
    #[must_use]
    pub fn shown([x0, y0, x1, y1]: [f64; 4], turn: Turn, size: (usize, usize)) -> Self {
        let corner = turn.stored_from_shown([x0, y0], size);
        let [right, low] = [[x1, y0], [x0, y1]].map(|p| turn.stored_from_shown(p, size));
        let from_corner = |p: [f64; 2]| [p[0] - corner[0], p[1] - corner[1]];
        Self { corner, across: from_corner(right), down: from_corner(low) }
    }

    /// Lengths of its sides, samples: width and height as the digit stands.
    #[must_use]
    pub fn size(&self) -> [f64; 2] {
        [self.across, self.down].map(|side| side[0].hypot(side[1]))
    }

    /// The stored point of a point in shares of the box: (0, 0) its top left, (1, 1) its bottom right.
    #[must_use]
    pub fn point(&self, u: f64, v: f64) -> [f64; 2] {
        [0, 1].map(|i| self.corner[i] + u * self.across[i] + v * self.down[i])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_of_a_turned_picture_stands_as_it_is_shown() {
        // Stored 40 x 20, shown 20 x 40: the shown point (x, y) is stored at (y, 19 - x).
        let place = Place::shown([4.0, 10.0, 9.0, 18.0], Turn::Quarter, (40, 20));
        assert_eq!(place.corner, [10.0, 15.0]);
        assert_eq!(place.size(), [5.0, 8.0]);
        assert_eq!(place.point(1.0, 1.0), [18.0, 10.0]);
        let upright = Place::upright([4.0, 10.0, 9.0, 18.0]);
        assert_eq!(Place::shown([4.0, 10.0, 9.0, 18.0], Turn::None, (40, 20)), upright);
        assert_eq!(upright.point(1.0, 0.5), [9.0, 14.0]);
    }
}
