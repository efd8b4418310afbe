//! A digital clock on a screen in the picture.
//!
//! In: what the clock counts and how it is written. Out: what it shows at a time, and the share of each pixel of its panel that
//! is lit. The screen changes at its refresh rate only: what it shows is the clock at the last refresh. Formats are the marker
//! file's: `h`, `m`, `s` are digits of hours, minutes, seconds, `t` tenths and finer; all else stands as it is.

use std::sync::LazyLock;

use ab_glyph::{Font, FontRef, GlyphId, PxScale, ScaleFont};
use serde::Serialize;

/// The clock's digits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum ClockFont {
    /// Hack: all letters equally wide.
    Mono,
    /// Ubuntu Light.
    Proportional,
    /// Seven segments a digit.
    Segments,
}

/// A clock on a screen.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Clock {
    /// How it is written, as `mm:ss.t`.
    pub format: String,
    /// What it counts at the video's time 0, seconds.
    pub offset_s: f64,
    /// How much faster than the video's time it runs, millionths.
    pub drift_ppm: f64,
    /// Refreshes of the screen a second.
    pub refresh_hz: f64,
    /// Its digits.
    pub font: ClockFont,
    /// Light digits on a dark panel; dark ones on a light panel otherwise.
    pub light_digits: bool,
    /// Left, top, width and height of the panel; none: at the picture's top right.
    pub roi_px: Option<[usize; 4]>,
}

impl Default for Clock {
    fn default() -> Self {
        Self {
            format: "mm:ss.t".to_owned(),
            offset_s: 60.0,
            drift_ppm: 0.0,
            refresh_hz: 60.0,
            font: ClockFont::Mono,
            light_digits: true,
            roi_px: None,
        }
    }
}

/// When the screen first refreshes after time 0, as a share of its interval.
const FIRST_REFRESH: f64 = 0.37;

impl Clock {
    /// What is wrong with the format, if anything.
    #[must_use]
    pub fn fault(&self) -> Option<&'static str> {
        let known = |c: char| "hmst".contains(c) || !c.is_alphanumeric();
        let letters: Vec<char> = self.format.chars().collect();
        let begins =
            |c: char| (0..letters.len()).filter(|&k| letters[k] == c && (k == 0 || letters[k - 1] != c)).count();
        let runs = "hmst".chars().any(|c| begins(c) > 1);
        if self.format.is_empty() || !self.format.chars().all(known) {
            Some("only h, m, s, t and marks between them can be written")
        } else if !self.format.contains('s') {
            Some("a clock without seconds ties no times")
        } else if runs || self.format.matches('t').count() > 6 || self.format.len() > 24 {
            Some("each of h, m, s, t may stand in one place, t up to six times")
        } else {
            None
        }
    }

    /// What the clock counts at the video's time `t_s`, seconds.
    #[must_use]
    pub fn counts_s(&self, t_s: f64) -> f64 {
        self.offset_s + (1.0 + 1e-6 * self.drift_ppm) * t_s
    }

    /// What the screen shows at `t_s`: the text and the seconds that it means.
    #[must_use]
    pub fn shown(&self, t_s: f64) -> (String, f64) {
        let refresh = ((t_s * self.refresh_hz) - FIRST_REFRESH).floor();
        let counted_s = self.counts_s((refresh + FIRST_REFRESH) / self.refresh_hz);
        let places = self.format.matches('t').count() as u32;
        let units = 10i64.pow(places);
        // A sliver more: a tenth that is reached is shown, whatever the rounding of the last bit.
        let total = (counted_s * units as f64 + 1e-6).floor() as i64;
        (self.text(total, units), total as f64 / units as f64)
    }

    fn text(&self, total: i64, units: i64) -> String {
        let seconds = total.div_euclid(units);
        let has = |letter| self.format.contains(letter);
        let part = |letter| match letter {
            't' => total.rem_euclid(units),
            's' if has('m') => seconds.rem_euclid(60),
            's' if has('h') => seconds.rem_euclid(3600),
            's' => seconds,
            'm' if has('h') => seconds.div_euclid(60).rem_euclid(60),
            'm' => seconds.div_euclid(60),
            _ => seconds.div_euclid(3600),
        };
        let mut text = String::new();
        let mut letters = self.format.chars().peekable();
        while let Some(letter) = letters.next() {
            if !"hmst".contains(letter) {
                text.push(letter);
                continue;
            }
            let mut digits = 1;
            while letters.next_if_eq(&letter).is_some() {
                digits += 1;
            }
            let value = part(letter).rem_euclid(10i64.pow(digits));
            text.push_str(&format!("{value:0width$}", width = digits as usize));
        }
        text
    }

    /// The lit share, 0 to 1, of each pixel of a panel of this size that shows `text`, row after row.
    #[must_use]
    pub fn panel(&self, text: &str, width: usize, height: usize) -> Vec<f32> {
        let widest: String = self.format.chars().map(|c| if "hmst".contains(c) { '0' } else { c }).collect();
        let mut lit = vec![0.0; width * height];
        match self.font {
            ClockFont::Mono => typeset(&MONO, text, &widest, width, height, &mut lit),
            ClockFont::Proportional => typeset(&PROPORTIONAL, text, &widest, width, height, &mut lit),
            ClockFont::Segments => segments(text, width, height, &mut lit),
        }
        lit
    }
}

static MONO: LazyLock<FontRef<'static>> = LazyLock::new(|| typeface(epaint_default_fonts::HACK_REGULAR));
static PROPORTIONAL: LazyLock<FontRef<'static>> = LazyLock::new(|| typeface(epaint_default_fonts::UBUNTU_LIGHT));

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
        let bounds = outline.px_bounds();
        outline.draw(|column, row, share| {
            let (x, y) = (bounds.min.x as i64 + i64::from(column), bounds.min.y as i64 + i64::from(row));
            if (0..width as i64).contains(&x) && (0..height as i64).contains(&y) {
                let at = y as usize * width + x as usize;
                lit[at] = (lit[at] + share).min(1.0);
            }
        });
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
/// A digit's middle lines are 1 wide and 2 high; half a segment's breadth, and what a digit and a mark take of the line.
const STROKE: f32 = 0.14;
const DIGIT_ADVANCE: f32 = 1.62;
const MARK_ADVANCE: f32 = 0.7;
const SLANT: f32 = 0.1;

/// Draws seven-segment digits and dots by the distance from the segments' middle lines.
fn segments(text: &str, width: usize, height: usize, lit: &mut [f32]) {
    let advance = |c: char| if c.is_ascii_digit() { DIGIT_ADVANCE } else { MARK_ADVANCE };
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

#[cfg(test)]
mod tests {
    use super::*;

    fn clock(format: &str) -> Clock {
        Clock { format: format.to_owned(), offset_s: 3723.0, refresh_hz: 60.0, ..Clock::default() }
    }

    #[test]
    fn the_format_takes_the_time_apart() {
        let at = 0.501 + FIRST_REFRESH / 60.0;
        assert_eq!(clock("h:mm:ss.tt").shown(at).0, "1:02:03.50");
        assert_eq!(clock("mm:ss.t").shown(at).0, "62:03.5");
        assert_eq!(clock("ssss").shown(at).0, "3723");
        assert!((clock("mm:ss.t").shown(at).1 - 3723.5).abs() < 1e-9);
    }

    #[test]
    fn the_screen_shows_the_last_refresh() {
        let slow = Clock { refresh_hz: 2.0, ..clock("ss.tt") };
        let first = FIRST_REFRESH / 2.0;
        assert_eq!(slow.shown(first + 0.001).0, slow.shown(first + 0.499).0);
        assert_ne!(slow.shown(first + 0.001).0, slow.shown(first + 0.501).0);
    }

    #[test]
    fn drift_adds_up() {
        let clock = Clock { drift_ppm: 100.0, ..clock("ss") };
        assert!((clock.counts_s(1000.0) - (3723.0 + 1000.1)).abs() < 1e-9);
    }

    #[test]
    fn bad_formats_are_refused() {
        for format in ["", "mm", "mm:ss.x", "ss:mm:ss", "ss.ttttttt"] {
            assert!(clock(format).fault().is_some(), "{format}");
        }
        for format in ["s", "mm:ss.t", "hh:mm:ss,ttt", "ss tt"] {
            assert_eq!(clock(format).fault(), None, "{format}");
        }
    }

    #[test]
    fn each_font_lights_a_share_of_the_panel_that_differs_with_the_digits() {
        for font in [ClockFont::Mono, ClockFont::Proportional, ClockFont::Segments] {
            let clock = Clock { font, ..clock("mm:ss.t") };
            let sum = |text: &str| clock.panel(text, 300, 70).iter().sum::<f32>();
            let (ones, eights) = (sum("11:11.1"), sum("88:88.8"));
            assert!(ones > 300.0 && eights > 1.2 * ones && eights < 0.6 * 21000.0, "{font:?} {ones} {eights}");
        }
    }
}
