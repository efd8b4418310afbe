//! What a second device says of the samples of a first: the force transducer beside the photodiodes.
//!
//! In: the second device's samples with their times, and then the times of the first one's, both ascending and on one
//! clock. Out: the second one's values at each of these times, on the straight line between the two samples around it;
//! nothing is held or extended: before the first sample, after the last, and in a gap of more than five periods no
//! value is known.

use std::collections::VecDeque;

use crate::time::Period;

/// A gap has more periods than this, as in logs.
const GAP_PERIODS: f64 = 5.0;
/// The longest step that is no gap while the period is not known, seconds (*assumed*: transducers are read at 10 Hz or
/// more).
const UNKNOWN_GAP_S: f64 = 0.5;
/// The most samples that are kept: ten minutes at 10 kHz would be a hundred times a session's wait of a second.
const MOST: usize = 1 << 16;

/// Whether the values at a time are known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Known {
    /// They are.
    Yes,
    /// A sample behind that time has to come first.
    NotYet,
    /// They are not, and never will be.
    Never,
}

/// The samples of a second device.
#[derive(Debug, Clone)]
pub struct Companion {
    width: usize,
    period: Period,
    /// Times, and `width` values for each.
    times_s: VecDeque<f64>,
    values: VecDeque<f64>,
    /// Where a recording begins, no line is drawn to the sample before.
    begins: VecDeque<bool>,
    ended: bool,
}

impl Companion {
    /// Of samples of so many values.
    #[must_use]
    pub fn new(width: usize) -> Self {
        Self {
            width,
            period: Period::default(),
            times_s: VecDeque::new(),
            values: VecDeque::new(),
            begins: VecDeque::new(),
            ended: false,
        }
    }

    /// Adds a sample; `begins` where nothing is known of the time between it and the one before. Samples without a
    /// time, and behind others, are passed over; of several at one time the last counts.
    pub fn push(&mut self, time_s: f64, values: &[f64], begins: bool) {
        let late = self.times_s.back().is_some_and(|last_s| time_s < *last_s);
        if time_s.is_nan() || late || values.len() != self.width {
            return;
        }
        if self.times_s.back() == Some(&time_s) {
            let first = self.values.len() - self.width;
            self.values.iter_mut().skip(first).zip(values).for_each(|(last, value)| *last = *value);
            return;
        }
        if let Some(last_s) = self.times_s.back().filter(|_| !begins) {
            self.period.push(time_s - last_s, 0.0);
        }
        if self.times_s.len() == MOST {
            self.drop_first();
        }
        self.times_s.push_back(time_s);
        self.values.extend(values);
        self.begins.push_back(begins);
    }

    /// Nothing more comes.
    pub fn end(&mut self) {
        self.ended = true;
    }

    /// The values at `time_s`, into `values`: NaN where not known. Times that are asked for ascend.
    pub fn at(&mut self, time_s: f64, values: &mut [f64]) -> Known {
        values.fill(f64::NAN);
        while self.times_s.get(1).is_some_and(|second_s| *second_s <= time_s) {
            self.drop_first();
        }
        let (Some(&before_s), false) = (self.times_s.front(), time_s.is_nan()) else {
            return if self.ended || time_s.is_nan() { Known::Never } else { Known::NotYet };
        };
        if before_s > time_s {
            return Known::Never;
        }
        let first = self.values.iter().take(self.width);
        if before_s == time_s {
            values.iter_mut().zip(first).for_each(|(value, one)| *value = *one);
            return Known::Yes;
        }
        let Some(&after_s) = self.times_s.get(1) else {
            return if self.ended { Known::Never } else { Known::NotYet };
        };
        let most_s = self.period.mean_s.map_or(UNKNOWN_GAP_S, |period_s| GAP_PERIODS * period_s);
        if after_s - before_s > most_s || self.begins[1] {
            return Known::Never;
        }
        let part = (time_s - before_s) / (after_s - before_s);
        let second = self.values.iter().skip(self.width);
        for ((value, one), two) in values.iter_mut().zip(first).zip(second) {
            *value = one + part * (two - one);
        }
        Known::Yes
    }

    fn drop_first(&mut self) {
        self.times_s.pop_front();
        self.begins.pop_front();
        self.values.drain(..self.width);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn asked(companion: &mut Companion, time_s: f64) -> (Known, f64) {
        let mut value = [0.0];
        let known = companion.at(time_s, &mut value);
        (known, value[0])
    }

    #[test]
    fn a_line_through_the_samples_is_met_exactly_and_nothing_is_extended() {
        let mut forces = Companion::new(1);
        assert_eq!(asked(&mut forces, 0.0).0, Known::NotYet);
        (1..=4).for_each(|k| forces.push(0.1 * f64::from(k), &[f64::from(k)], k == 1));
        assert_eq!(asked(&mut forces, 0.05).0, Known::Never);
        assert_eq!(asked(&mut forces, 0.1), (Known::Yes, 1.0));
        let (known, value) = asked(&mut forces, 0.25);
        assert!(known == Known::Yes && (value - 2.5).abs() <= 1e-12);
        assert_eq!(asked(&mut forces, 0.4), (Known::Yes, 4.0));
        assert_eq!(asked(&mut forces, 0.41).0, Known::NotYet);
        forces.end();
        let (known, value) = asked(&mut forces, 0.41);
        assert!(known == Known::Never && value.is_nan());
    }

    #[test]
    fn no_line_is_drawn_over_a_gap_or_into_another_recording() {
        let mut forces = Companion::new(1);
        for (t_s, value, begins) in [(0.0, 1.0, true), (0.1, 1.0, false), (0.7, 2.0, false), (0.8, 2.0, true)] {
            forces.push(t_s, &[value], begins);
        }
        assert_eq!(asked(&mut forces, 0.05), (Known::Yes, 1.0));
        assert_eq!(asked(&mut forces, 0.4).0, Known::Never);
        assert_eq!(asked(&mut forces, 0.75).0, Known::Never);
        assert_eq!(asked(&mut forces, 0.8), (Known::Yes, 2.0));
        assert_eq!(asked(&mut forces, f64::NAN).0, Known::Never);
    }

    #[test]
    fn samples_that_are_not_known_stay_so_and_late_ones_are_passed_over() {
        let mut forces = Companion::new(1);
        for (t_s, value) in [(0.0, 1.0), (0.1, f64::NAN), (0.05, 9.0), (f64::NAN, 9.0), (0.2, 3.0)] {
            forces.push(t_s, &[value], false);
        }
        assert!(asked(&mut forces, 0.05).1.is_nan());
        assert!(asked(&mut forces, 0.15).1.is_nan());
        assert_eq!(asked(&mut forces, 0.2), (Known::Yes, 3.0));
    }

    #[test]
    fn of_several_samples_at_one_time_the_last_counts() {
        let mut forces = Companion::new(1);
        for (t_s, value) in [(0.1, 1.0), (0.1, 2.0), (0.1, 3.0), (0.2, 5.0)] {
            forces.push(t_s, &[value], false);
        }
        assert_eq!(asked(&mut forces, 0.1), (Known::Yes, 3.0));
        let (known, value) = asked(&mut forces, 0.15);
        assert!(known == Known::Yes && (value - 4.0).abs() <= 1e-9);
    }

    #[test]
    fn what_nobody_asks_for_does_not_grow() {
        let mut forces = Companion::new(3);
        (0..200_000).for_each(|k| forces.push(f64::from(k), &[0.0; 3], false));
        assert!(forces.times_s.len() == MOST && forces.values.len() == 3 * MOST && forces.begins.len() == MOST);
    }
}
