//! Lines, circles and texts on a picture's Y', Cb and Cr themselves. White with a dark rim, so that they stand out
//! wherever they lie.

use crate::figure::text_coverage;
use crate::video::{Format, Picture};
use crate::vision::Stroke;

/// An 8-bit 4:2:0 picture to draw on.
pub(super) struct Canvas<'a> {
    pub(super) picture: &'a mut Picture,
    /// Luma of white and of black.
    pub(super) white: u8,
    pub(super) black: u8,
    /// Thickness of lines, pixels.
    pub(super) line_px: u8,
}

impl Canvas<'_> {
    /// Takes a pixel towards a grey: by its `cover` of it, from 0 to 1.
    fn blend(&mut self, x: usize, y: usize, cover: f32, grey: u8) {
        let towards = |value: &mut u8, aim: f32, cover: f32| {
            *value = (f32::from(*value) + (aim - f32::from(*value)) * cover).round() as u8;
        };
        let width = self.picture.format.width;
        towards(&mut self.picture.planes[0][y * width + x], f32::from(grey), cover);
        let at = y / 2 * (width / 2) + x / 2;
        // Four pixels share a chroma sample.
        for plane in &mut self.picture.planes[1..] {
            towards(&mut plane[at], 128.0, 0.4 * cover);
        }
    }

    /// Draws strokes as one: their rim, then themselves.
    fn strokes(&mut self, strokes: &[Stroke]) {
        let Format { width, height, .. } = self.picture.format;
        let all = strokes.iter().map(Stroke::bounds);
        let all = all.reduce(|a, b| [a[0].min(b[0]), a[1].min(b[1]), a[2].max(b[2]), a[3].max(b[3])]);
        let [left, top, right, bottom] = all.unwrap_or_default();
        let reach = f64::from(self.line_px) + 4.0;
        let from = |low: f64| (low - reach).max(0.0) as usize;
        let to = |high: f64, end: usize| ((high + reach).max(-1.0) + 1.0).min(end as f64) as usize;
        let (left, right, top, bottom) = (from(left), to(right, width), from(top), to(bottom, height));
        let size = [right.saturating_sub(left), bottom.saturating_sub(top)];
        for (wide, share, grey) in [(self.line_px + 2, 0.6, self.black), (self.line_px, 1.0, self.white)] {
            let mut cover = vec![0; size[0] * size[1]];
            let moved = strokes.iter().map(|stroke| stroke.moved([-(left as f64), -(top as f64)]));
            moved.for_each(|stroke| stroke.draw(&mut cover, size, u8::MAX, wide));
            for (k, &cover) in cover.iter().enumerate().filter(|(_, cover)| **cover > 0) {
                self.blend(left + k % size[0], top + k / size[0], share * f32::from(cover) / 255.0, grey);
            }
        }
    }

    pub(super) fn circle(&mut self, at: [f64; 2], radius: f64) {
        self.strokes(&[Stroke::Circle { at, radius }]);
    }

    pub(super) fn line(&mut self, from: [f64; 2], to: [f64; 2]) {
        self.strokes(&[Stroke::Line([from, to])]);
    }

    /// An upright cross of arms `arm` long.
    pub(super) fn plus(&mut self, [x, y]: [f64; 2], arm: f64) {
        self.strokes(&[Stroke::Line([[x - arm, y], [x + arm, y]]), Stroke::Line([[x, y - arm], [x, y + arm]])]);
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
