//! The stored picture and the shown one: quarter turns.

use crate::words::Words;

/// How the stored picture is turned, clockwise, to be shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Turn {
    /// Not at all.
    #[default]
    None,
    /// By 90 degrees.
    Quarter,
    /// By 180 degrees.
    Half,
    /// By 270 degrees.
    ThreeQuarters,
}

/// By degrees clockwise.
impl Words for Turn {
    const WORDS: &'static [(Self, &'static str, &'static str)] =
        &[(Self::None, "0", ""), (Self::Quarter, "90", ""), (Self::Half, "180", ""), (Self::ThreeQuarters, "270", "")];
}

impl Turn {
    /// How many times 90 degrees.
    pub(crate) fn quarters(self) -> usize {
        self as usize
    }

    /// Whether the shown picture's rows are the stored one's columns.
    #[must_use]
    pub fn is_aside(self) -> bool {
        matches!(self, Self::Quarter | Self::ThreeQuarters)
    }

    /// Width and height of the shown picture, of those of the stored one.
    #[must_use]
    pub fn shown_size(self, (width, height): (usize, usize)) -> (usize, usize) {
        if self.is_aside() { (height, width) } else { (width, height) }
    }

    /// The point of the shown picture of a point of the stored one, `size` the stored width and height.
    #[must_use]
    pub fn shown_from_stored(self, [x, y]: [f64; 2], (width, height): (usize, usize)) -> [f64; 2] {
        let (right, bottom) = (width as f64 - 1.0, height as f64 - 1.0);
        match self {
            Self::None => [x, y],
            Self::Quarter => [bottom - y, x],
            Self::Half => [right - x, bottom - y],
            Self::ThreeQuarters => [y, right - x],
        }
    }

    /// The point of the stored picture of a point of the shown one, `size` the *stored* width and height.
    #[must_use]
    pub fn stored_from_shown(self, [x, y]: [f64; 2], (width, height): (usize, usize)) -> [f64; 2] {
        let (right, bottom) = (width as f64 - 1.0, height as f64 - 1.0);
        match self {
            Self::None => [x, y],
            Self::Quarter => [y, bottom - x],
            Self::Half => [right - x, bottom - y],
            Self::ThreeQuarters => [right - y, x],
        }
    }
}
