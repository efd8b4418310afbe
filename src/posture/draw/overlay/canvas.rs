//! Lines, circles and texts on a picture's Y', Cb and Cr themselves. White with a dark rim, so that they stand out
//! wherever they lie.

use crate::figure::text_coverage;
use crate::video::Picture;

/// An 8-bit 4:2:0 picture to draw on.
pub(super) struct Canvas<'a> {
    pub(super) picture: &'a mut Picture,
    /// Luma of white and of black.
    pub(super) white: f32,
    pub(super) black: f32,
    /// Thickness of lines, pixels.
    pub(super) line_px: f64,
}

impl Canvas<'_> {
    /// Takes a pixel towards a grey: by its `cover` of it, from 0 to 1.
    fn blend(&mut self, x: usize, y: usize, cover: f32, grey: f32) {
        let towards = |value: &mut u8, aim: f32, cover: f32| {
            *value = (f32::from(*value) + (aim - f32::from(*value)) * cover).round() as u8;
        };
        let width = self.picture.format.width;
        towards(&mut self.picture.planes[0][y * width + x], grey, cover);
        let at = y / 2 * (width / 2) + x / 2;
        // Four pixels share a chroma sample.
        for plane in &mut self.picture.planes[1..] {
            towards(&mut plane[at], 128.0, 0.4 * cover);
        }
    }

    /// Draws what lies within half a line's thickness of zero `distance`, in the box around `(x, y)` pairs.
    fn stroke(&mut self, [left, top, right, bottom]: [f64; 4], distance: impl Fn(f64, f64) -> f64) {
        let (width, height) = (self.picture.format.width, self.picture.format.height);
        let reach = self.line_px + 2.0;
        let from = |low: f64| (low - reach).floor().max(0.0) as usize;
        let to = |high: f64, end: usize| ((high + reach).ceil().max(-1.0) + 1.0).min(end as f64) as usize;
        for y in from(top)..to(bottom, height) {
            for x in from(left)..to(right, width) {
                let away = distance(x as f64, y as f64).abs();
                let cover = |half: f64| (half + 0.5 - away).clamp(0.0, 1.0) as f32;
                let rim = cover(0.5 * self.line_px + 1.0);
                if rim > 0.0 {
                    self.blend(x, y, 0.6 * rim, self.black);
                    self.blend(x, y, cover(0.5 * self.line_px), self.white);
                }
            }
        }
    }

    pub(super) fn circle(&mut self, [x, y]: [f64; 2], radius: f64) {
        let around = [x - radius, y - radius, x + radius, y + radius];
        self.stroke(around, |at_x, at_y| (at_x - x).hypot(at_y - y) - radius);
    }

    pub(super) fn line(&mut self, [x0, y0]: [f64; 2], [x1, y1]: [f64; 2]) {
        let around = [x0.min(x1), y0.min(y1), x0.max(x1), y0.max(y1)];
        let (dx, dy) = (x1 - x0, y1 - y0);
        let length2 = (dx * dx + dy * dy).max(f64::MIN_POSITIVE);
        self.stroke(around, |x, y| {
            let along = (((x - x0) * dx + (y - y0) * dy) / length2).clamp(0.0, 1.0);
            (x - x0 - along * dx).hypot(y - y0 - along * dy)
        });
    }

    /// An upright cross of arms `arm` long.
    pub(super) fn plus(&mut self, [x, y]: [f64; 2], arm: f64) {
        self.line([x - arm, y], [x + arm, y]);
        self.line([x, y - arm], [x, y + arm]);
    }

    /// A slanted cross of arms `arm` long.
    pub(super) fn cross(&mut self, [x, y]: [f64; 2], arm: f64) {
        self.line([x - arm, y - arm], [x + arm, y + arm]);
        self.line([x - arm, y + arm], [x + arm, y - arm]);
    }

    /// Text on a darkened box with its top left corner at a place.
    pub(super) fn text(&mut self, text: &Text, [x, y]: [f64; 2]) {
        let format = self.picture.format;
        let (left, top) = (x.max(0.0) as usize, y.max(0.0) as usize);
        for (x, y, cover) in text.covered.enumerate_pixels() {
            let (x, y) = (left + x as usize, top + y as usize);
            if x < format.width && y < format.height {
                self.blend(x, y, 0.45, self.black);
                self.blend(x, y, f32::from(cover.0[0]) / 255.0, self.white);
            }
        }
    }
}

/// A text's pixels.
pub(super) struct Text {
    covered: image::GrayImage,
}

impl Text {
    pub(super) fn new(text: &str, height_px: f64) -> Self {
        Self { covered: text_coverage(text, height_px as f32) }
    }

    /// Width and height.
    pub(super) fn size(&self) -> (f64, f64) {
        (f64::from(self.covered.width()), f64::from(self.covered.height()))
    }
}
