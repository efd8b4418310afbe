//! The lit share of each pixel of a clock's panel: digits of typefaces and of seven segments.

use std::sync::LazyLock;

use ab_glyph::{Font, FontRef, GlyphId, PxScale, ScaleFont};

use super::ClockFont;

/// The lit share of each pixel of a panel, row after row, that shows `text` in the size in which `widest` fits.
pub(super) fn panel(font: ClockFont, text: &str, widest: &str, width: usize, height: usize) -> Vec<f32> {
    let mut lit = vec![0.0; width * height];
    match font {
        ClockFont::Mono => typeset(&MONO, text, widest, width, height, &mut lit),
        ClockFont::Proportional => typeset(&PROPORTIONAL, text, widest, width, height, &mut lit),
        ClockFont::Serif => typeset(&SERIF, text, widest, width, height, &mut lit),
        ClockFont::Segments => segments(text, width, height, &mut lit),
    }
    lit
}

static MONO: LazyLock<FontRef<'static>> = LazyLock::new(|| typeface(epaint_default_fonts::HACK_REGULAR));
static PROPORTIONAL: LazyLock<FontRef<'static>> = LazyLock::new(|| typeface(epaint_default_fonts::UBUNTU_LIGHT));
static SERIF: LazyLock<FontRef<'static>> = LazyLock::new(|| typeface(dejavu::serif::bold()));

fn typeface(bytes: &'static [u8]) -> FontRef<'static> {
    FontRef::try_from_slice(bytes).expect("the typeface that is compiled in is a typeface")
}

/// Draws `text` with the size at which `widest` fits, from the same left edge whatever the text.
fn typeset(font: &FontRef<'static>, text: &str, widest: &str, width: usize, height: usize, lit: &mut [f32]) {
    let advance = |text: &str, size: f32| {
        let scaled = font.as_scaled(PxScale::from(size));
        let mut last: Option<GlyphId> = None;
        text.chars().fold(0.0, |x, c| {
            let glyph = scaled.glyph_id(c);
            let kern = last.replace(glyph).map_or(0.0, |before| scaled.kern(before, glyph));
            x + kern + scaled.h_advance(glyph)
        })
    };
    let full = 0.95 * height as f32;
    let size = full.min(full * 0.92 * width as f32 / advance(widest, full).max(1.0));
    let scaled = font.as_scaled(PxScale::from(size));
    let left = 0.5 * (width as f32 - advance(widest, size));
    let baseline = 0.5 * (height as f32 + scaled.ascent() + scaled.descent());
    let mut so_far = String::new();
    for c in text.chars() {
        let x = left + advance(&so_far, size);
        so_far.push(c);
        let glyph = scaled.glyph_id(c).with_scale_and_position(size, ab_glyph::point(x, baseline));
        let Some(outline) = font.outline_glyph(glyph) else { continue };
        ink(&outline, width, height, lit);
    }
}

/// Which of the segments a (top), b, c, d (bottom), e, f, g (middle) are lit for a digit.
const LIT: [[bool; 7]; 10] = {
    const fn of(bits: u8) -> [bool; 7] {
        let mut lit = [false; 7];
        let mut k = 0;
        while k < 7 {
            lit[k] = bits >> (6 - k) & 1 == 1;
            k += 1;
        }
        lit
    }
    [
        of(0b111_1110),
        of(0b011_0000),
        of(0b110_1101),
        of(0b111_1001),
        of(0b011_0011),
        of(0b101_1011),
        of(0b101_1111),
        of(0b111_0000),
        of(0b111_1111),
        of(0b111_1011),
    ]
};
/// A segment that is not lit still shows a little.
const UNLIT: f32 = 0.05;
/// A digit's middle lines are 1 wide and 2 high; half a segment's breadth, and what a digit and a mark take of the
/// line.
const STROKE: f32 = 0.14;
const DIGIT_ADVANCE: f32 = 1.62;
const MARK_ADVANCE: f32 = 0.7;
const SLANT: f32 = 0.1;
/// Letters are printed on such a display, half as high as the digits.
const LETTER_ADVANCE: f32 = 1.15;
const LETTER_HEIGHT: f32 = 1.0;

/// Adds a glyph where it lies.
fn ink(outline: &ab_glyph::OutlinedGlyph, width: usize, height: usize, lit: &mut [f32]) {
    let bounds = outline.px_bounds();
    outline.draw(|column, row, share| {
        let (x, y) = (bounds.min.x as i64 + i64::from(column), bounds.min.y as i64 + i64::from(row));
        if (0..width as i64).contains(&x) && (0..height as i64).contains(&y) {
            let at = y as usize * width + x as usize;
            lit[at] = (lit[at] + share).min(1.0);
        }
    });
}

/// Draws a letter, its height and the lower end of its left side given.
fn printed(c: char, tall: f32, [x, y]: [f32; 2], width: usize, height: usize, lit: &mut [f32]) {
    let of_size =
        |size: f32| MONO.outline_glyph(MONO.glyph_id('M').with_scale(size)).map(|outline| outline.px_bounds().height());
    let Some(hundred) = of_size(100.0).filter(|&tall| tall > 0.0) else { return };
    let size = 100.0 * tall / hundred;
    let Some(outline) = MONO.outline_glyph(MONO.glyph_id(c).with_scale_and_position(size, ab_glyph::point(x, y)))
    else {
        return;
    };
    ink(&outline, width, height, lit);
}

/// Draws seven-segment digits and dots by the distance from the segments' middle lines.
fn segments(text: &str, width: usize, height: usize, lit: &mut [f32]) {
    let advance = |c: char| match c {
        '0'..='9' => DIGIT_ADVANCE,
        c if c.is_alphabetic() => LETTER_ADVANCE,
        _ => MARK_ADVANCE,
    };
    let total: f32 = text.chars().map(advance).sum();
    let unit = (0.92 * width as f32 / total).min(0.84 * height as f32 / (2.0 + 2.0 * STROKE));
    let left = 0.5 * (width as f32 - unit * total);
    let middle = 0.5 * height as f32;
    let mut at = 0.0;
    for c in text.chars() {
        let mut lines: Vec<([f32; 4], f32)> = Vec::new();
        if let Some(digit) = c.to_digit(10) {
            let ends: [[f32; 4]; 7] = [
                [0.0, -1.0, 1.0, -1.0],
                [1.0, -1.0, 1.0, 0.0],
                [1.0, 0.0, 1.0, 1.0],
                [0.0, 1.0, 1.0, 1.0],
                [0.0, 0.0, 0.0, 1.0],
                [0.0, -1.0, 0.0, 0.0],
                [0.0, 0.0, 1.0, 0.0],
            ];
            for (end, on) in ends.into_iter().zip(LIT[digit as usize]) {
                // Segments stop short of the corners, so that gaps show between them.
                let [x0, y0, x1, y1] = end;
                let (dx, dy) = (0.19 * (x1 - x0), 0.19 * (y1 - y0));
                lines.push(([x0 + dx, y0 + dy, x1 - dx, y1 - dy], if on { 1.0 } else { UNLIT }));
            }
        } else if c == ':' {
            lines.push(([0.0, -0.45, 0.0, -0.45], 1.0));
            lines.push(([0.0, 0.45, 0.0, 0.45], 1.0));
        } else if c == '.' || c == ',' {
            lines.push(([0.0, 1.0, 0.0, 1.0], 1.0));
        } else if c.is_alphabetic() {
            let foot = [left + unit * at, middle + unit * (1.0 + STROKE)];
            printed(c, LETTER_HEIGHT * unit, foot, width, height, lit);
        }
        let origin = at + 0.5 * (advance(c) - if c.is_ascii_digit() { 1.0 } else { 0.0 });
        for (row, pixels) in lit.chunks_exact_mut(width).enumerate() {
            let y = (row as f32 + 0.5 - middle) / unit;
            let first = ((left + unit * (at - 0.3)).max(0.0) as usize).min(width);
            let last = ((left + unit * (at + advance(c) + 0.3)).max(0.0) as usize).min(width);
            for (column, pixel) in pixels.iter_mut().enumerate().take(last).skip(first) {
                let x = (column as f32 + 0.5 - left) / unit - origin + SLANT * y;
                for &([x0, y0, x1, y1], share) in &lines {
                    let (dx, dy) = (x1 - x0, y1 - y0);
                    let along = ((x - x0) * dx + (y - y0) * dy) / (dx * dx + dy * dy).max(1e-9);
                    let along = along.clamp(0.0, 1.0);
                    let away = (x - x0 - along * dx).hypot(y - y0 - along * dy);
                    let covered = ((STROKE - away) * unit + 0.5).clamp(0.0, 1.0);
                    *pixel = pixel.max(share * covered);
                }
            }
        }
        at += advance(c);
    }
}
