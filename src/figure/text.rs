//! Captions on pictures, with the one typeface that comes along.

use std::sync::LazyLock;

use ab_glyph::{FontRef, PxScale};
use image::{GrayImage, ImageBuffer, Pixel};
use imageproc::drawing::{draw_text_mut, text_size};

/// The typeface of every figure (Ubuntu Light, Ubuntu font licence).
pub(super) const TYPEFACE: &[u8] = epaint_default_fonts::UBUNTU_LIGHT;

/// The typeface, to draw with.
pub(super) static FONT: LazyLock<FontRef<'static>> =
    LazyLock::new(|| FontRef::try_from_slice(TYPEFACE).expect("the typeface that is compiled in is a typeface"));

/// Draws `text` with the middle of its top at `x` and `y`, shortened with an ellipsis to fit `width` pixels.
pub(super) fn centred<P>(picture: &mut Pixels<P>, ink: P, text: &str, [x, y]: [i32; 2], height: f32, width: u32)
where
    P: Pixel<Subpixel = u8>,
{
    let text = shortened(text, height, width);
    let (drawn, _) = text_size(PxScale::from(height), &*FONT, &text);
    left(picture, ink, &text, [x - drawn as i32 / 2, y], height);
}

/// Draws `text` from (`x`, `y`), its top left corner.
pub(super) fn left<P>(picture: &mut Pixels<P>, ink: P, text: &str, [x, y]: [i32; 2], height: f32)
where
    P: Pixel<Subpixel = u8>,
{
    draw_text_mut(picture, ink, x, y, PxScale::from(height), &*FONT, text);
}

type Pixels<P> = ImageBuffer<P, Vec<u8>>;

/// How much of each pixel `text` covers (0 to 255), `height` pixels high: to draw on pictures that are not RGB.
#[must_use]
pub fn text_coverage(text: &str, height: f32) -> GrayImage {
    let (width, drawn) = text_size(PxScale::from(height), &*FONT, text);
    // Tails reach below the measured box.
    let mut covered = GrayImage::new(width + 2, drawn.max(height.ceil() as u32) + 1);
    draw_text_mut(&mut covered, image::Luma([255]), 0, 0, PxScale::from(height), &*FONT, text);
    covered
}

/// `text`, shortened with an ellipsis to fit `width` pixels.
pub(super) fn shortened(text: &str, height: f32, width: u32) -> String {
    let fits = |t: &str| text_size(PxScale::from(height), &*FONT, t).0 <= width;
    if fits(text) {
        return text.to_owned();
    }
    let letters: Vec<char> = text.chars().collect();
    (0..letters.len())
        .rev()
        .map(|keep| letters[..keep].iter().chain(std::iter::once(&'\u{2026}')).collect::<String>())
        .find(|t| fits(t))
        .unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_caption_is_shortened_to_fit() {
        let short = shortened("longitudinal_negative of a subject with a very long name", 16.0, 100);
        assert!(short.ends_with('\u{2026}') && short.starts_with("long"));
        assert!(text_size(PxScale::from(16.0), &*FONT, &short).0 <= 100);
        assert_eq!(shortened("a", 16.0, 100), "a");
    }
}
