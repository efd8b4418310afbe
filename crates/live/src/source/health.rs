//! How a stream is: whether rows come as they should, and since when.

use serde::Serialize;

/// Rows that are at most so late are no stall, nanoseconds: more than the 16 ms for which USB bridges hold bytes, and
/// than a loaded machine sleeps (*assumed*).
const SILENCE_NS: u64 = 50_000_000;

/// So many periods without a row are a stall where they are longer.
const SILENT_PERIODS: f64 = 3.0;

/// A stream without any row, or whose period is not known yet, is stalled after this, nanoseconds.
pub(in crate::source) const FIRST_ROW_NS: u64 = 1_000_000_000;

/// Rows are counted over so long, nanoseconds.
const WINDOW_NS: u64 = 1_000_000_000;

/// A stream is slow where fewer than this part of its rows came, and no longer where more than that did (*assumed*).
const SLOW_BELOW: f64 = 0.7;
const SLOW_UNTIL: f64 = 0.9;

const MOST_CHANGES: usize = 1000;

/// How a stream is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Condition {
    /// Rows come as they should.
    Ok,
    /// Fewer rows come than the device's clock says there are: the link is too slow, or loses them.
    Slow,
    /// The source is open and silent.
    Stalled,
    /// The source is gone.
    Lost,
    /// It is gone and looked for.
    Reconnecting,
}

impl Condition {
    /// As it is written.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Ok => "ok",
            Self::Slow => "slow",
            Self::Stalled => "stalled",
            Self::Lost => "lost",
            Self::Reconnecting => "reconnecting",
        }
    }
}

/// A condition and since when it is so.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct State {
    /// How the stream is.
    pub condition: Condition,
    /// Since when, nanoseconds of the host's clock.
    pub since_ns: u64,
}

/// Watches a stream that comes live.
#[derive(Debug, Clone)]
pub(in crate::source) struct Health {
    pub(in crate::source) state: State,
    history: Vec<State>,
    changes: u64,
    /// When bytes could come first, or the latest row came.
    alive_ns: u64,
    pub(in crate::source) any: bool,
    /// Rows since the window's begin.
    window: (u32, u64),
}

impl Health {
    pub(in crate::source) fn new(condition: Condition, now_ns: u64) -> Self {
        let state = State { condition, since_ns: now_ns };
        Self { state, history: vec![state], changes: 0, alive_ns: now_ns, any: false, window: (0, now_ns) }
    }

    /// Every state up to now, and how many changes were too many to keep.
    pub(in crate::source) fn history(&self) -> (&[State], u64) {
        (&self.history, self.changes.saturating_sub(self.history.len() as u64 - 1))
    }

    /// Changes the condition; none where it is so already.
    pub(in crate::source) fn set(&mut self, condition: Condition, since_ns: u64) -> Option<State> {
        if self.state.condition == condition {
            return None;
        }
        self.state = State { condition, since_ns };
        self.changes += 1;
        if self.history.len() < MOST_CHANGES {
            self.history.push(self.state);
        }
        Some(self.state)
    }

    pub(in crate::source) fn opened(&mut self, now_ns: u64) {
        (self.alive_ns, self.window) = (now_ns, (0, now_ns));
    }

    /// A row came.
    pub(in crate::source) fn row(&mut self, now_ns: u64) -> Option<State> {
        if !self.any || self.state.condition == Condition::Stalled {
            self.window = (0, now_ns);
        }
        (self.alive_ns, self.any) = (now_ns, true);
        self.window.0 += 1;
        if self.state.condition == Condition::Slow { None } else { self.set(Condition::Ok, now_ns) }
    }

    /// When silence becomes a stall; none where it is one, or the source is gone.
    /// Then it is `otherwise_ns`.
    pub(in crate::source) fn due_ns(&self, step_s: Option<f64>, otherwise_ns: Option<u64>) -> Option<u64> {
        let waits = matches!(self.state.condition, Condition::Ok | Condition::Slow);
        let stall_ns = waits.then(|| self.alive_ns + self.silence_ns(step_s) + 1);
        stall_ns.into_iter().chain(otherwise_ns).min()
    }

    fn silence_ns(&self, step_s: Option<f64>) -> u64 {
        match step_s.filter(|_| self.any) {
            Some(step_s) => SILENCE_NS.max((SILENT_PERIODS * step_s * 1e9) as u64),
            None => FIRST_ROW_NS,
        }
    }

    /// What silence, by the step from stamp to stamp, or a lack of rows, by the period of the device's own clock, has
    /// changed.
    pub(in crate::source) fn look(&mut self, now_ns: u64, step_s: Option<f64>, period_s: Option<f64>) -> Option<State> {
        if !matches!(self.state.condition, Condition::Ok | Condition::Slow) {
            self.window = (0, now_ns);
            return None;
        }
        if now_ns > self.alive_ns + self.silence_ns(step_s) {
            return self.set(Condition::Stalled, self.alive_ns);
        }
        let (rows, since_ns) = self.window;
        if now_ns < since_ns + WINDOW_NS {
            return None;
        }
        self.window = (0, now_ns);
        let due = (now_ns - since_ns) as f64 / 1e9 / period_s?;
        match self.state.condition {
            // Few rows a second say nothing about a rate.
            Condition::Ok if due >= 10.0 && f64::from(rows) < SLOW_BELOW * due => self.set(Condition::Slow, since_ns),
            Condition::Slow if f64::from(rows) > SLOW_UNTIL * due => self.set(Condition::Ok, now_ns),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: u64 = 1_000_000;

    #[test]
    fn silence_is_a_stall_after_three_periods_or_fifty_milliseconds() {
        for (period_s, silence_ms) in [(0.001, 50), (0.04, 120), (1.0, 3000)] {
            let mut health = Health::new(Condition::Ok, 0);
            assert_eq!(health.due_ns(None, None), Some(1000 * MS + 1), "a stream without samples");
            health.row(2000 * MS);
            assert_eq!(health.look((2000 + silence_ms) * MS, Some(period_s), Some(period_s)), None);
            let stalled = health.look((2000 + silence_ms) * MS + 1, Some(period_s), Some(period_s)).unwrap();
            assert_eq!((stalled.condition, stalled.since_ns), (Condition::Stalled, 2000 * MS));
            assert_eq!(health.due_ns(Some(period_s), None), None);
            assert_eq!(health.row(5000 * MS).unwrap().condition, Condition::Ok);
        }
    }

    #[test]
    fn half_of_the_rows_are_slow() {
        let mut health = Health::new(Condition::Ok, 0);
        let mut changes = Vec::new();
        for ms in 0..6000 {
            let slow = (1500..3500).contains(&ms);
            if !slow || ms % 2 == 0 {
                health.row(ms * MS);
            }
            changes.extend(health.look(ms * MS, Some(0.001), Some(0.001)).map(|state| state.condition));
        }
        assert_eq!(changes, [Condition::Slow, Condition::Ok]);
        assert_eq!(health.history().0.len(), 3);
    }
}
