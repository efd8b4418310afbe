//! Rows one by one, with what the last ones said: a ring of the rows of the longest lag.

use std::collections::VecDeque;

use super::Lags;

/// A moment this near to a row's time, as a share of the longest gap, is that row's.
pub(super) const SAME_MOMENT: f64 = 1e-5;

/// Rows that come one by one: it keeps those of the longest lag.
#[derive(Debug, Clone)]
pub struct LagStream {
    lags: Lags,
    inputs: usize,
    time_s: VecDeque<f64>,
    /// The voltages of `time_s`' rows, one row after the other.
    rows: VecDeque<f64>,
}

impl LagStream {
    pub(super) fn new(lags: Lags, inputs: usize) -> Self {
        Self { lags, inputs, time_s: VecDeque::new(), rows: VecDeque::new() }
    }

    /// How many rows it keeps.
    #[must_use]
    pub fn kept(&self) -> usize {
        self.time_s.len()
    }

    /// Takes a row, its time in seconds and its voltages, and writes it with its lags into `out`; whether it could.
    /// Where it could not, `out` holds nothing of use.
    ///
    /// # Panics
    /// Where the lengths are not the stream's.
    pub fn push(&mut self, time_s: f64, x: &[f64], out: &mut [f64]) -> bool {
        let width = self.inputs * (1 + self.lags.lags_s.len());
        assert!(x.len() == self.inputs && out.len() == width, "a row of the stream's size");
        if !time_s.is_finite() || x.iter().any(|value| !value.is_finite()) {
            return false;
        }
        if self.time_s.back().is_some_and(|&last| time_s < last) {
            self.reset();
        }
        if self.time_s.back() != Some(&time_s) {
            self.time_s.push_back(time_s);
            self.rows.extend(x);
        }
        self.forget(time_s);
        let (now, before) = out.split_at_mut(self.inputs);
        now.copy_from_slice(x);
        (0..self.lags.lags_s.len()).all(|k| {
            let part = &mut before[k * self.inputs..(k + 1) * self.inputs];
            self.at(time_s - self.lags.lags_s[k], part)
        })
    }

    /// Forgets all: the next row begins a new recording.
    pub fn reset(&mut self) {
        self.time_s.clear();
        self.rows.clear();
    }

    /// Drops rows that no lag reaches any more: the first, while the second is before the longest lag.
    fn forget(&mut self, time_s: f64) {
        let from = time_s - self.lags.longest_s() - self.near();
        while self.time_s.get(1).is_some_and(|&second| second < from) {
            self.time_s.pop_front();
            self.rows.drain(..self.inputs);
        }
    }

    fn near(&self) -> f64 {
        SAME_MOMENT * self.lags.longest_gap_s
    }

    /// The voltages at a moment; whether they are known.
    fn at(&self, moment_s: f64, out: &mut [f64]) -> bool {
        let after = self.time_s.partition_point(|&time| time < moment_s - self.near());
        let Some(&right) = self.time_s.get(after) else { return false };
        let row = |k: usize| self.rows.range(k * self.inputs..(k + 1) * self.inputs);
        if right <= moment_s + self.near() {
            out.iter_mut().zip(row(after)).for_each(|(out, value)| *out = *value);
            return true;
        }
        let Some(left) = after.checked_sub(1).map(|k| self.time_s[k]) else { return false };
        // The slack lets steps of exactly the longest gap through, whatever their last digits.
        if right - left > self.lags.longest_gap_s + self.near() {
            return false;
        }
        let share = (moment_s - left) / (right - left);
        for (out, (a, b)) in out.iter_mut().zip(row(after - 1).zip(row(after))) {
            // Of both sides, as a difference could overflow.
            *out = a * (1.0 - share) + b * share;
        }
        true
    }
}
