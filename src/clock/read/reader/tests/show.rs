//! A clock on a desk, beside a bar that moves, drawn small and fast for the tests.

use crate::clock::{ClockFormat, Half};
use crate::phantom::screen::{Clock, ClockFont};
use crate::video::{Format, Info, Picture, Turn};

/// What is filmed and how.
pub(super) struct Show {
    /// None: no clock in the picture.
    pub(super) clock: Option<Clock>,
    pub(super) panel: [usize; 4],
    pub(super) fps: f64,
    /// How far frames are from an even rate, as a share of their interval.
    pub(super) uneven: f64,
    /// As a share of a frame's interval.
    pub(super) exposure: f64,
    /// Largest deviation of a sample, levels.
    pub(super) noise: f32,
    /// Half the range of the light's brightness, as a share; it does not fall on the clock's screen.
    pub(super) flicker: f64,
    /// Draws digits one behind the other without regard to a pitch.
    pub(super) moving: bool,
    /// What becomes of the clock's text before it is drawn.
    pub(super) restyle: fn(&str) -> String,
    /// Left, top, width, height on the panel of what else is lit there.
    pub(super) lines: Vec<[usize; 4]>,
    pub(super) turn: Turn,
}

pub(super) const WIDTH: usize = 400;
pub(super) const HEIGHT: usize = 160;
const DESK: f64 = 140.0;

impl Show {
    pub(super) fn new(font: ClockFont, light_digits: bool) -> Self {
        // A frame's exposure begins at no change of the clock's.
        let clock = Clock { offset_s: 1796.017, font, light_digits, ..Clock::default() };
        Self {
            clock: Some(clock),
            panel: [200, 30, 160, 40],
            fps: 30.0,
            uneven: 0.0,
            exposure: 0.0,
            noise: 4.0,
            flicker: 0.0,
            moving: false,
            restyle: str::to_owned,
            lines: Vec::new(),
            turn: Turn::None,
        }
    }

    pub(super) fn time_s(&self, frame: usize) -> f64 {
        (frame as f64 + self.uneven * (12.9898 * frame as f64).sin()) / self.fps
    }

    /// What the clock's digits mean in the middle of the exposure.
    pub(super) fn shown_s(&self, frame: usize) -> f64 {
        let Some(clock) = &self.clock else { return f64::NAN };
        let (text, _) = clock.shown(self.time_s(frame));
        let digits: Vec<u8> = text.bytes().filter(u8::is_ascii_digit).map(|byte| byte - b'0').collect();
        let half = if text.contains('P') { Half::Pm } else { Half::Am };
        ClockFormat::parse(&clock.format).unwrap().seconds(&digits, Some(half)).unwrap()
    }

    pub(super) fn info(&self) -> Info {
        Info { turn: self.turn, ..Info::plain(self.format()) }
    }

    fn format(&self) -> Format {
        let aside = matches!(self.turn, Turn::Quarter | Turn::ThreeQuarters);
        let (width, height) = if aside { (HEIGHT, WIDTH) } else { (WIDTH, HEIGHT) };
        Format { width, height, subsampling: None, depth: 8 }
    }

    pub(super) fn picture(&self, frame: usize) -> Picture {
        let time_s = self.time_s(frame);
        let light = 1.0 + self.flicker * (std::f64::consts::TAU * 100.0 * time_s + 0.8).sin();
        let mut luma = vec![(DESK * light) as f32; WIDTH * HEIGHT];
        let bar = 40 + (30.0 * (2.0 * time_s).sin()) as usize;
        for row in luma.chunks_exact_mut(WIDTH) {
            row[bar..bar + 60].fill((190.0 * light) as f32);
        }
        if let Some(clock) = &self.clock {
            self.draw(clock, time_s, &mut luma);
        }
        let mut state = 0x9e37_79b9_7f4a_7c15_u64.wrapping_mul(frame as u64 + 1);
        let format = self.format();
        let mut picture = Picture::new(format);
        for (k, value) in luma.iter().enumerate() {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let noise = self.noise * ((state >> 40) as f32 / (1u32 << 23) as f32 - 1.0);
            let shown = [(k % WIDTH) as f64, (k / WIDTH) as f64];
            let [x, y] = self.turn.stored_from_shown(shown, (format.width, format.height)).map(|v| v as usize);
            picture.planes[0][y * format.width + x] = (value + noise + 0.5).clamp(0.0, 255.0) as u8;
        }
        picture
    }

    fn draw(&self, clock: &Clock, time_s: f64, luma: &mut [f32]) {
        const LOOKS: usize = 8;
        let [left, top, width, height] = self.panel;
        let mut lit = vec![0.0; width * height];
        let mut texts: Vec<(String, u8)> = Vec::new();
        for look in 0..LOOKS {
            let share = (look as f64 + 0.5) / LOOKS as f64 - 0.5;
            let (text, _) = clock.shown(time_s + share * self.exposure / self.fps);
            let text = (self.restyle)(&text);
            match texts.last_mut() {
                Some((last, looks)) if *last == text => *looks += 1,
                _ => texts.push((text, 1)),
            }
        }
        for (text, looks) in &texts {
            let one =
                if self.moving { side_by_side(clock, text, width, height) } else { clock.panel(text, width, height) };
            let share = f32::from(*looks) / LOOKS as f32;
            lit.iter_mut().zip(one).for_each(|(sum, one)| *sum += share * one);
        }
        for &[x, y, wide, tall] in &self.lines {
            (y..y + tall).for_each(|y| lit[y * width + x..y * width + x + wide].fill(1.0));
        }
        let (back, front) = if clock.light_digits { (25.0, 215.0) } else { (190.0, 40.0) };
        for y in top - 3..top + height + 3 {
            luma[y * WIDTH + left - 3..y * WIDTH + left + width + 3].fill(35.0);
        }
        for (row, lit) in lit.chunks_exact(width).enumerate() {
            for (x, lit) in lit.iter().enumerate() {
                luma[(top + row) * WIDTH + left + x] = back + lit * (front - back);
            }
        }
    }
}

/// Glyphs with equal gaps between their ink.
fn side_by_side(clock: &Clock, text: &str, width: usize, height: usize) -> Vec<f32> {
    const GAP: usize = 4;
    let one = Clock { format: "s".into(), ..clock.clone() };
    let mut lit = vec![0.0; width * height];
    let mut at = 8;
    for letter in text.chars() {
        let cell = one.panel(&letter.to_string(), height, height);
        let inked = |x: usize| (0..height).any(|y| cell[y * height + x] > 0.1);
        for x in (0..height).filter(|&x| inked(x)) {
            for y in 0..height {
                lit[y * width + at] = cell[y * height + x];
            }
            at += 1;
        }
        at += GAP;
    }
    lit
}
