//! A rectangle of a frame's luma, upright.
//!
//! In: a frame and a rectangle of whole pixels of the *shown* picture. Out: its luma as the shown picture has it, on
//! the scale of 8 bits, averaged over blocks where it holds more pixels than digits need.

use crate::video::{Info, Plane, Turn};
use crate::vision::Samples;

/// A rectangle of whole pixels of the shown picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::clock) struct Rect {
    pub(in crate::clock) x: usize,
    pub(in crate::clock) y: usize,
    pub(in crate::clock) width: usize,
    pub(in crate::clock) height: usize,
}

/// A grey picture, row after row.
#[derive(Debug, Clone, PartialEq, Default)]
pub(in crate::clock) struct Gray {
    pub(in crate::clock) width: usize,
    pub(in crate::clock) height: usize,
    pub(in crate::clock) values: Vec<f32>,
}

impl Gray {
    pub(in crate::clock) fn row(&self, y: usize) -> &[f32] {
        &self.values[y * self.width..(y + 1) * self.width]
    }
}

/// How the shown picture lies in the stored one.
#[derive(Debug, Clone, Copy)]
pub(in crate::clock) struct Eye {
    turn: Turn,
    stored: (usize, usize),
}

impl Eye {
    pub(in crate::clock) fn new(info: &Info) -> Self {
        Self { turn: info.turn, stored: (info.format.width, info.format.height) }
    }

    /// Width and height of the shown picture.
    pub(in crate::clock) fn size(&self) -> (usize, usize) {
        self.turn.shown_size(self.stored)
    }

    /// Whether this plane is of the size that the video said.
    pub(in crate::clock) fn fits(&self, luma: &Plane<'_>) -> bool {
        (luma.width, luma.height) == self.stored
    }

    /// The means over blocks of `step` x `step` pixels of `rect`; pixels that fill no block are left out.
    pub(in crate::clock) fn cut(&self, luma: &Plane<'_>, rect: Rect, step: usize) -> Gray {
        let (width, height) = (rect.width / step, rect.height / step);
        let &Plane { width: across, height: down, stride, depth, data } = luma;
        let samples = Samples { width: across, height: down, stride, depth, data, quarters: self.turn.quarters() };
        Gray { width, height, values: samples.means([rect.x, rect.y], [width, height], step) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::video::{Format, Picture};

    #[test]
    fn what_is_cut_is_what_is_shown_however_the_picture_is_turned() {
        let format = Format { width: 6, height: 4, subsampling: None, depth: 8 };
        let mut picture = Picture::new(format);
        for (k, value) in picture.planes[0].iter_mut().enumerate() {
            *value = k as u8;
        }
        let luma = picture.frame(0, 0.0).luma;
        for turn in [Turn::None, Turn::Quarter, Turn::Half, Turn::ThreeQuarters] {
            let eye = Eye::new(&Info { turn, ..Info::plain(format) });
            let (width, height) = eye.size();
            let rect = Rect { x: 1, y: 2, width: width - 1, height: height - 2 };
            let gray = eye.cut(&luma, rect, 1);
            for y in 0..rect.height {
                for x in 0..rect.width {
                    let shown = [(x + rect.x) as f64, (y + rect.y) as f64];
                    let [column, row] = turn.stored_from_shown(shown, (6, 4)).map(|v| v as usize);
                    assert_eq!(gray.row(y)[x], (6 * row + column) as f32, "{turn:?}");
                }
            }
        }
    }

    #[test]
    fn blocks_are_averaged() {
        let format = Format { width: 5, height: 5, subsampling: None, depth: 8 };
        let mut picture = Picture::new(format);
        picture.planes[0][6] = 100;
        let eye = Eye::new(&Info::plain(format));
        let gray = eye.cut(&picture.frame(0, 0.0).luma, Rect { x: 1, y: 1, width: 4, height: 3 }, 2);
        assert_eq!((gray.width, gray.height, &gray.values[..]), (2, 1, &[25.0, 0.0][..]));
    }
}
