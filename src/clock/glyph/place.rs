//! Where a character is on the stored picture: a box, upright or turned, or any parallelogram.

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
