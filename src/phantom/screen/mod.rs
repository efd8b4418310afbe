//! A digital clock on a screen in the picture.
//!
//! In: what the clock counts and how it is written. Out: what it shows at a time, and the share of each pixel of its
//! panel that is lit. Formats are the marker file's: `h`, `m`, `s` are digits of hours, minutes, seconds, `t` tenths
//! and finer, `a` AM or PM; all else stands as it is. One or two digits of hours are of a day: 23:59:59 is followed by
//! 00:00:00, or, of twelve hours, 11:59:59 PM by 12:00:00 AM. One `h` becomes two digits where it has to: 9:59:59 is
//! followed by 10:00:00.
//!
//! The clock counts evenly. Its screen shows it at once, or at the last of its refreshes; it may stop or jump while the
//! clock counts on.

mod digits;

use serde::Serialize;

use crate::phantom::scene::place::is_default;

/// The clock's digits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum ClockFont {
    /// Hack: all letters equally wide.
    Mono,
    /// Ubuntu Light.
    Proportional,
    /// DejaVu Serif Bold.
    Serif,
    /// Seven segments a digit.
    Segments,
}

impl ClockFont {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Mono, Self::Proportional, Self::Serif, Self::Segments];
}

/// The screen jumps: from a time on it shows more, or less, than the clock counts.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Jump {
    /// The video's time.
    pub at_s: f64,
    /// By how much.
    pub by_s: f64,
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
    /// Refreshes of the screen a second; none: it changes at once.
    pub refresh_hz: Option<f64>,
    /// How long the display takes from the program to its light, beside its refreshes, seconds.
    #[serde(skip_serializing_if = "is_default")]
    pub delay_s: f64,
    /// How its digits are drawn.
    pub font: ClockFont,
    /// Light digits on a dark panel; dark ones on a light panel otherwise.
    pub light_digits: bool,
    /// Left, top, width and height of the panel; none: at the picture's top right.
    pub roi_px: Option<[usize; 4]>,
    /// The video's time from which on the screen stands still.
    pub stop_s: Option<f64>,
    /// The screen jumps.
    pub jump: Option<Jump>,
}

impl Default for Clock {
    fn default() -> Self {
        Self {
            format: "mm:ss.t".to_owned(),
            offset_s: 60.0,
            drift_ppm: 0.0,
            refresh_hz: None,
            delay_s: 0.0,
            font: ClockFont::Mono,
            light_digits: true,
            roi_px: None,
            stop_s: None,
            jump: None,
        }
    }
}

/// When the screen first refreshes after time 0, as a share of its interval.
const FIRST_REFRESH: f64 = 0.37;

/// Hours that a clock with one or two digits of them counts.
const DAY_H: i64 = 24;

impl Clock {
    /// What is wrong with the format, if anything.
    #[must_use]
    pub fn fault(&self) -> Option<&'static str> {
        let known = |c: char| "hmsta".contains(c) || !c.is_alphanumeric();
        let letters: Vec<char> = self.format.chars().collect();
        let begins =
            |c: char| (0..letters.len()).filter(|&k| letters[k] == c && (k == 0 || letters[k - 1] != c)).count();
        let runs = "hmsta".chars().any(|c| begins(c) > 1);
        let [hours, halves] = ['h', 'a'].map(|c| self.format.matches(c).count());
        if self.format.is_empty() || !self.format.chars().all(known) {
            Some("only h, m, s, t, a and marks between them can be written")
        } else if !self.format.contains('s') {
            Some("a clock without seconds ties no times")
        } else if runs || self.format.matches('t').count() > 6 || self.format.len() > 24 {
            Some("each of h, m, s, t, a may stand in one place, t up to six times")
        } else if halves > 1 || halves == 1 && !(1..=2).contains(&hours) {
            Some("a, AM or PM, stands once, with one or two h")
        } else {
            None
        }
    }

    /// What the clock counts at the video's time `t_s`, seconds.
    #[must_use]
    pub fn counts_s(&self, t_s: f64) -> f64 {
        self.offset_s + (1.0 + 1e-6 * self.drift_ppm) * t_s
    }

    /// What the screen shows at `t_s`: the text, and the seconds that it means with the days and hours that it has no
    /// digits for.
    #[must_use]
    pub fn shown(&self, t_s: f64) -> (String, f64) {
        let t_s = t_s - self.delay_s;
        let t_s = self.stop_s.map_or(t_s, |stop_s| t_s.min(stop_s));
        let drawn_s = self.refresh_hz.map_or(t_s, |hz| ((t_s * hz - FIRST_REFRESH).floor() + FIRST_REFRESH) / hz);
        let jump_s = self.jump.filter(|jump| drawn_s >= jump.at_s).map_or(0.0, |jump| jump.by_s);
        let counted_s = self.counts_s(drawn_s) + jump_s;
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
            _ if has('a') => (seconds.div_euclid(3600) - 1).rem_euclid(DAY_H / 2) + 1,
            _ if self.format.matches('h').count() <= 2 => seconds.div_euclid(3600).rem_euclid(DAY_H),
            _ => seconds.div_euclid(3600),
        };
        let mut text = String::new();
        let mut letters = self.format.chars().peekable();
        while let Some(letter) = letters.next() {
            if letter == 'a' {
                let late = seconds.div_euclid(3600).rem_euclid(DAY_H) >= DAY_H / 2;
                text.push_str(if late { "PM" } else { "AM" });
                continue;
            }
            if !"hmst".contains(letter) {
                text.push(letter);
                continue;
            }
            let mut digits = 1;
            while letters.next_if_eq(&letter).is_some() {
                digits += 1;
            }
            let most = if (letter, digits) == ('h', 1) { 2 } else { digits };
            let value = part(letter).rem_euclid(10i64.pow(most));
            text.push_str(&format!("{value:0width$}", width = digits as usize));
        }
        text
    }

    /// The lit share, 0 to 1, of each pixel of a panel of this size that shows `text`, row after row.
    #[must_use]
    pub fn panel(&self, text: &str, width: usize, height: usize) -> Vec<f32> {
        let alone = self.format.matches('h').count() == 1;
        let mut widest = String::new();
        for c in self.format.chars() {
            match c {
                'h' if alone => widest.push_str("00"),
                'h' | 'm' | 's' | 't' => widest.push('0'),
                'a' => widest.push_str("AM"),
                mark => widest.push(mark),
            }
        }
        digits::panel(self.font, text, &widest, width, height)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn clock(format: &str) -> Clock {
        Clock { format: format.to_owned(), offset_s: 3723.0, ..Clock::default() }
    }

    #[test]
    fn the_format_takes_the_time_apart() {
        let at = 0.501;
        assert_eq!(clock("h:mm:ss.tt").shown(at).0, "1:02:03.50");
        assert_eq!(clock("mm:ss.t").shown(at).0, "62:03.5");
        assert_eq!(clock("ssss").shown(at).0, "3723");
        assert!((clock("mm:ss.t").shown(at).1 - 3723.5).abs() < 1e-9);
    }

    #[test]
    fn the_screen_shows_the_last_refresh() {
        let slow = Clock { refresh_hz: Some(2.0), ..clock("ss.tt") };
        let first = FIRST_REFRESH / 2.0;
        assert_eq!(slow.shown(first + 0.001).0, slow.shown(first + 0.499).0);
        assert_ne!(slow.shown(first + 0.001).0, slow.shown(first + 0.501).0);
    }

    #[test]
    fn a_screen_that_changes_at_once_cuts_what_is_counted() {
        let at_once = clock("ss.tt");
        assert_eq!((at_once.shown(0.009).0, at_once.shown(0.01).0), ("23.00".to_owned(), "23.01".to_owned()));
    }

    #[test]
    fn a_day_ends_at_midnight_and_a_timer_counts_on() {
        let late = |format: &str| Clock { offset_s: 86_390.0, ..clock(format) };
        assert_eq!(late("hh:mm:ss.t").shown(9.95).0, "23:59:59.9");
        assert_eq!(late("hh:mm:ss.t").shown(10.0).0, "00:00:00.0");
        assert_eq!(late("h:mm:ss").shown(10.0).0, "0:00:00");
        assert_eq!(late("hhh:mm:ss").shown(10.0).0, "024:00:00");
        assert!((late("hh:mm:ss.t").shown(10.0).1 - 86_400.0).abs() <= 1e-9);
        let before = Clock { offset_s: -1.5, ..late("hh:mm:ss.t") };
        assert_eq!(before.shown(0.0).0, "23:59:58.5");
    }

    #[test]
    fn twelve_hours_go_over_noon_and_midnight() {
        let at = |format: &str, offset_s: f64| Clock { offset_s, ..clock(format) }.shown(0.0).0;
        assert_eq!(at("hh:mm:ss a", 43_199.0), "11:59:59 AM");
        assert_eq!(at("hh:mm:ss a", 43_200.0), "12:00:00 PM");
        assert_eq!(at("hh:mm:ss a", 46_800.0), "01:00:00 PM");
        assert_eq!(at("h:mm:ss a", 46_800.0), "1:00:00 PM");
        assert_eq!(at("a h:mm:ss", 46_799.0), "PM 12:59:59");
        assert_eq!(at("hh:mm:ss a", 86_400.0), "12:00:00 AM");
        assert_eq!(at("h:mm:ss", 36_000.0), "10:00:00");
    }

    #[test]
    fn a_screen_stops_and_jumps_while_the_clock_counts_on() {
        let stopped = Clock { stop_s: Some(2.0), ..clock("ss.t") };
        assert_eq!((stopped.shown(1.5).0, stopped.shown(9.0).0), ("24.5".to_owned(), "25.0".to_owned()));
        assert_eq!(stopped.counts_s(9.0), 3732.0);
        let jumped = Clock { jump: Some(Jump { at_s: 2.0, by_s: -1.2 }), ..clock("ss.t") };
        assert_eq!((jumped.shown(1.99).0, jumped.shown(2.0).0), ("24.9".to_owned(), "23.8".to_owned()));
    }

    #[test]
    fn drift_adds_up() {
        let clock = Clock { drift_ppm: 100.0, ..clock("ss") };
        assert!((clock.counts_s(1000.0) - (3723.0 + 1000.1)).abs() < 1e-9);
    }

    #[test]
    fn bad_formats_are_refused() {
        for format in ["", "mm", "mm:ss.x", "ss:mm:ss", "ss.ttttttt", "mm:ss a", "hh:mm:ss aa"] {
            assert!(clock(format).fault().is_some(), "{format}");
        }
        for format in ["s", "mm:ss.t", "hh:mm:ss,ttt", "ss tt", "hh:mm:ss a"] {
            assert_eq!(clock(format).fault(), None, "{format}");
        }
    }

    #[test]
    fn each_font_lights_a_share_of_the_panel_that_differs_with_the_digits() {
        for font in ClockFont::ALL {
            let clock = Clock { font, ..clock("mm:ss.t") };
            let sum = |text: &str| clock.panel(text, 300, 70).iter().sum::<f32>();
            let (ones, eights) = (sum("11:11.1"), sum("88:88.8"));
            assert!(ones > 300.0 && eights > 1.2 * ones && eights < 0.6 * 21000.0, "{font:?} {ones} {eights}");
        }
    }
}
