//! One character's picture, always of the same size, contrast and polarity.
//!
//! In: a plane, the [`InkBox`] of the character on it, and what background and ink are worth there. Out: a [`Patch`],
//! background 0 and ink 1 whichever of them is lighter. The box's height fills 20 of 24 rows, two are left above and
//! below; its width keeps the picture's proportions and is centred, so that a `1` stays narrow, unless it is wider than
//! the patch has room for.
//!
//! OpenCV's `warpAffine` rounds places to 1/32 of a sample and averages nothing; it was not measured here.

use crate::video::Plane;

/// The upright box of a character's ink: left, top, right, bottom. Coordinates are those of the plane's samples: the
/// centre of the top-left one is (0, 0), x right, y down; ink on the columns 3 to 5 reaches from 2.5 to 5.5.
pub type InkBox = [f64; 4];

/// Columns of a patch.
pub const WIDTH: usize = 16;
/// Rows of a patch.
pub const HEIGHT: usize = 24;
/// Rows that the box fills.
pub(super) const BODY: usize = 20;
/// Rows above and below the box.
const MARGIN: usize = (HEIGHT - BODY) / 2;
/// Most columns that the box fills; a wider one is squeezed.
const WIDEST: f64 = 14.0;
/// What is darker than the background or fuller than ink is cut off this far out.
const OUTSIDE: f32 = 0.3;
/// Most samples a side that one cell of the patch is averaged from.
const MOST_LOOKS: f64 = 6.0;

/// What background and ink are worth, on the scale of 8 bits. Ink may be lighter or darker than the background.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Levels {
    /// Of the background.
    pub background: f32,
    /// Of ink that covers a sample wholly.
    pub ink: f32,
}

/// A contrast-normalized picture of one character.
#[derive(Debug, Clone, PartialEq)]
pub struct Patch {
    /// Ink of each cell, row after row.
    pub(super) ink: [f32; WIDTH * HEIGHT],
    /// The box's width by its height.
    pub(super) aspect: f32,
}

impl Patch {
    /// Cuts the character in a box out of a plane. What lies outside of the plane counts as background; so does all of
    /// it where the box is empty or background and ink are worth the same.
    #[must_use]
    pub fn cut(plane: &Plane<'_>, [left, top, right, bottom]: InkBox, levels: Levels) -> Self {
        let mut patch = Self { ink: [0.0; WIDTH * HEIGHT], aspect: 0.0 };
        let (width, height) = (right - left, bottom - top);
        let contrast = levels.ink - levels.background;
        let whole = width > 0.0 && height > 0.0 && width.is_finite() && height.is_finite();
        if !whole || !contrast.is_finite() || contrast == 0.0 || plane.width == 0 || plane.height == 0 {
            return patch;
        }
        patch.aspect = (width / height).min(2.0) as f32;
        // Shares of the box that one cell takes.
        let tall = 1.0 / BODY as f64;
        let wide = (tall * height / width).max(1.0 / WIDEST);
        let looks = |size: f64| size.ceil().clamp(1.0, MOST_LOOKS) as usize;
        let (columns, rows) = (looks(wide * width), looks(tall * height));
        let scale = 1.0 / ((columns * rows) as f32 * contrast);
        for (k, cell) in patch.ink.iter_mut().enumerate() {
            let (x, y) = ((k % WIDTH) as f64, (k / WIDTH) as f64);
            let mut sum = 0.0;
            for i in 0..rows {
                let v = (y - MARGIN as f64 + (i as f64 + 0.5) / rows as f64) * tall;
                for j in 0..columns {
                    let u = 0.5 + (x - 0.5 * WIDTH as f64 + (j as f64 + 0.5) / columns as f64) * wide;
                    sum += between(plane, [left + u * width, top + v * height])
                        .map_or(0.0, |value| value - levels.background);
                }
            }
            *cell = (sum * scale).clamp(-OUTSIDE, 1.0 + OUTSIDE);
        }
        patch
    }

    /// Ink of each cell, 0 to 1 and a little beyond, 16 x 24, row after row.
    #[must_use]
    pub fn ink(&self) -> &[f32] {
        &self.ink
    }
}

/// The value between the samples around a point; none more than half a sample outside of the plane.
fn between(plane: &Plane<'_>, [x, y]: [f64; 2]) -> Option<f32> {
    let (right, bottom) = ((plane.width - 1) as f64, (plane.height - 1) as f64);
    if !((-0.5..=right + 0.5).contains(&x) && (-0.5..=bottom + 0.5).contains(&y)) {
        return None;
    }
    let (x, y) = (x.clamp(0.0, right), y.clamp(0.0, bottom));
    let (x0, y0) = (x as usize, y as usize);
    let (x1, y1) = ((x0 + 1).min(plane.width - 1), (y0 + 1).min(plane.height - 1));
    let (fx, fy) = ((x - x0 as f64) as f32, (y - y0 as f64) as f32);
    let row = |y| (1.0 - fx) * plane.sample(x0, y) + fx * plane.sample(x1, y);
    Some((1.0 - fy) * row(y0) + fy * row(y1))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A bar from column 20 to 29 and row 10 to 49 on a plane of 60 x 60.
    fn bar(background: u8, ink: u8) -> Vec<u8> {
        let inside = |k: usize| (20..30).contains(&(k % 60)) && (10..50).contains(&(k / 60));
        (0..3600).map(|k| if inside(k) { ink } else { background }).collect()
    }

    fn plane(data: &[u8]) -> Plane<'_> {
        Plane { width: 60, height: 60, stride: 60, depth: 8, data }
    }

    const BAR: [f64; 4] = [19.5, 9.5, 29.5, 49.5];

    #[test]
    fn a_bar_stays_narrow_and_is_ink_whatever_the_polarity() {
        for (background, ink) in [(30, 220), (220, 30)] {
            let data = bar(background, ink);
            let levels = Levels { background: f32::from(background), ink: f32::from(ink) };
            let patch = Patch::cut(&plane(&data), BAR, levels);
            // 10 of 40 samples wide: 5 of 20 columns around the middle; edges are smooth over a sample, half a cell.
            for (k, &cell) in patch.ink().iter().enumerate() {
                let (x, y) = (k % WIDTH, k / WIDTH);
                let inside = (6..10).contains(&x) && (3..21).contains(&y);
                let outside = !(5..11).contains(&x) || !(2..22).contains(&y);
                assert!(!inside || cell == 1.0, "{x} {y} {cell}");
                assert!(!outside || cell.abs() <= 0.13, "{x} {y} {cell}");
            }
            assert_eq!(patch.aspect, 0.25);
        }
    }

    #[test]
    fn what_cannot_be_cut_is_background() {
        let data = bar(10, 200);
        let levels = Levels { background: 10.0, ink: 200.0 };
        let none =
            |place: [f64; 4], levels: Levels| Patch::cut(&plane(&data), place, levels).ink().iter().all(|&c| c == 0.0);
        assert!(none(BAR, Levels { background: 10.0, ink: 10.0 }));
        assert!(none(BAR, Levels { background: f32::NAN, ink: 10.0 }));
        assert!(none([20.0, 10.0, 20.0, 50.0], levels));
        assert!(none([20.0, f64::NAN, 30.0, 50.0], levels));
        assert!(none([200.0, 200.0, 240.0, 290.0], levels));
        assert!(!none(BAR, levels));
    }
}
