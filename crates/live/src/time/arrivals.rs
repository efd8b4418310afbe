//! Times of rows without a clock, by their arrival.
//!
//! In: when rows arrive, and how many do at once. Out: a time for each. Bridges hold rows back and hand them on in
//! bursts; rows of one arrival were made since the one before, so they are spread over that time, the last at the
//! arrival. Where an arrival is only the beginning of a burst, as many of its rows are a period apart and the rest is
//! still to come; after a silence they are a period apart and end at the arrival.

use crate::time::period::Period;

/// Rows that are further apart than so many periods are not spread: rows were lost, or are still to come. The tenth is
/// for arrivals that are late at times.
const APART: f64 = 1.1;

/// Rows come in bursts where arrivals are further apart than so many periods.
const BURST: f64 = 1.5;

/// An arrival that is later than so many usual ones comes after a silence.
const SILENCE: f64 = 1.5;

/// An arrival earlier than this part of its rows' periods goes on with the burst before it.
const GOES_ON: f64 = 0.5;

/// The period is learned from so many rows or more, of two arrivals: one alone may be the second part of a burst.
const BLOCK: u32 = 8;
const PARTS: u32 = 2;

/// The times of rows by their arrival.
#[derive(Debug, Clone, Default)]
pub struct Arrivals {
    /// Rows of the next arrival, where that is known.
    announced: u32,
    arrival_s: Option<f64>,
    /// The time of the last of its rows, the step between them, how many there are, and how many of them came.
    end_s: f64,
    step_s: f64,
    rows: u32,
    came: u32,
    latest_s: f64,
    /// From row to row, and from arrival to arrival.
    pub(crate) period: Period,
    between: Period,
    block: Block,
}

/// Rows and arrivals since one.
#[derive(Debug, Clone, Default)]
struct Block {
    since_s: f64,
    rows: u32,
    arrivals: u32,
}

impl Block {
    fn since(since_s: f64) -> Self {
        Self { since_s, ..Self::default() }
    }
}

impl Arrivals {
    /// So many rows arrive next, at once.
    pub fn announce(&mut self, rows: usize) {
        self.announced = u32::try_from(rows).unwrap_or(u32::MAX);
    }

    /// The time of a row that arrived at `arrival_s`, seconds; it never falls.
    pub fn time_s(&mut self, arrival_s: f64) -> f64 {
        if self.arrival_s != Some(arrival_s) {
            self.arrive(arrival_s);
        }
        self.came += 1;
        let left = self.rows.saturating_sub(self.came);
        let time_s = self.end_s - self.step_s * f64::from(left);
        self.latest_s = if self.latest_s > time_s { self.latest_s } else { time_s };
        self.latest_s
    }

    /// The latest time that was given, seconds.
    #[must_use]
    pub fn latest_s(&self) -> f64 {
        self.latest_s
    }

    /// How long bursts are, seconds; none where rows come one by one, or too few came.
    #[must_use]
    pub fn burst_s(&self) -> Option<f64> {
        let (period_s, between_s) = (self.period.mean_s?, self.between.mean_s?);
        (between_s > BURST * period_s).then_some(between_s)
    }

    fn arrive(&mut self, arrival_s: f64) {
        let came = std::mem::take(&mut self.came);
        self.rows = std::mem::take(&mut self.announced).max(1);
        let rows = f64::from(self.rows);
        let Some(before_s) = self.arrival_s.replace(arrival_s) else {
            // Nothing is known of the time before.
            (self.end_s, self.step_s, self.latest_s) = (arrival_s, 0.0, arrival_s);
            self.block = Block::since(arrival_s);
            return;
        };
        self.learn(came, before_s);
        let period_s = self.period.mean_s;
        let goes_on = period_s.is_some_and(|period_s| arrival_s - before_s < GOES_ON * rows * period_s);
        // Before the period is known, parts of a burst look like bursts.
        if period_s.is_some() && !goes_on {
            self.between.push(arrival_s - before_s, 0.0);
        }
        let begin_s = if goes_on { self.latest_s } else { before_s };
        let step_s = (arrival_s - begin_s) / rows;
        // Only the beginning of a burst came, or some of its rows were lost.
        let is_part = self.burst_s().is_some_and(|burst_s| arrival_s - begin_s <= SILENCE * burst_s);
        (self.step_s, self.end_s) = match period_s.filter(|period_s| step_s > APART * period_s) {
            None => (step_s, arrival_s),
            Some(period_s) if is_part => (period_s, begin_s + rows * period_s),
            Some(period_s) => (period_s, arrival_s),
        };
    }

    /// Learns the period from the rows of an arrival.
    fn learn(&mut self, came: u32, arrival_s: f64) {
        let block = &mut self.block;
        if arrival_s <= block.since_s {
            return;
        }
        block.rows += came;
        block.arrivals += 1;
        if block.rows >= BLOCK && block.arrivals >= PARTS {
            self.period.push((arrival_s - block.since_s) / f64::from(block.rows), 0.0);
            self.block = Block::since(arrival_s);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The largest error of rows behind the first second, seconds: 200 rows a second, that arrive when `arrival` says.
    fn error_s(arrival: impl Fn(u32) -> f64, left_out: impl Fn(u32) -> bool) -> (f64, Arrivals) {
        let mut arrivals = Arrivals::default();
        let all: Vec<(f64, f64)> =
            (1..=2000).filter(|n| !left_out(*n)).map(|n| (0.005 * f64::from(n), arrival(n))).collect();
        let (mut worst_s, mut last_s) = (0.0_f64, 0.0);
        for burst in all.chunk_by(|a, b| a.1 == b.1) {
            arrivals.announce(burst.len());
            for &(true_s, arrival_s) in burst {
                let time_s = arrivals.time_s(arrival_s);
                assert!(time_s >= last_s && time_s <= arrival_s + 1e-9, "{time_s} after {last_s}");
                last_s = time_s;
                if true_s > 1.0 {
                    worst_s = worst_s.max((time_s - true_s).abs());
                }
            }
        }
        (worst_s, arrivals)
    }

    fn burst_of(n: u32, rows: u32) -> f64 {
        0.005 * f64::from(n.div_ceil(rows) * rows)
    }

    #[test]
    fn rows_of_a_burst_are_spread_over_it() {
        for rows in [2, 4, 20] {
            let (worst_s, arrivals) = error_s(|n| burst_of(n, rows), |_| false);
            assert!(worst_s <= 1e-9, "{rows}: {worst_s}");
            assert!((arrivals.burst_s().unwrap() - 0.005 * f64::from(rows)).abs() <= 1e-9);
            assert!((arrivals.period.mean_s.unwrap() - 0.005).abs() <= 1e-9);
        }
    }

    #[test]
    fn a_burst_in_two_parts_is_one() {
        // Its last rows are read a tenth of a millisecond later.
        for first in [1, 7, 10, 15, 19] {
            let late = |n: u32| if (n - 1) % 20 < first { 0.0 } else { 1e-4 };
            let (worst_s, _) = error_s(|n| burst_of(n, 20) + late(n), |_| false);
            assert!(worst_s <= 0.006, "{first}: {worst_s}");
        }
    }

    #[test]
    fn rows_one_by_one_have_the_time_of_their_arrival() {
        let jitter = |n: u32| 0.004 * f64::from(n.wrapping_mul(2_654_435_761) >> 16) / 65_536.0;
        let mut arrivals = Arrivals::default();
        for n in 1..2000 {
            let arrival_s = 0.005 * f64::from(n) + jitter(n);
            arrivals.announce(1);
            assert!((arrivals.time_s(arrival_s) - arrival_s).abs() <= 1e-12, "{n}");
        }
        assert_eq!(arrivals.burst_s(), None);
    }

    #[test]
    fn after_a_silence_rows_end_at_their_arrival() {
        // Three seconds in which nothing is made, and later a burst that is lost.
        let (worst_s, _) = error_s(|n| burst_of(n, 20), |n| (500..1100).contains(&n) || (1501..=1520).contains(&n));
        assert!(worst_s <= 0.011, "{worst_s}");
    }

    #[test]
    fn drawn_arrivals_of_a_bridge_are_within_their_jitter() {
        // Sixteen milliseconds and as much as three more: three or four rows each.
        let at = |k: u32| 0.016 * f64::from(k) + 0.003 * f64::from(k.wrapping_mul(2_654_435_761) >> 16) / 65_536.0;
        let arrival = |n: u32| {
            let made_s = 0.005 * f64::from(n);
            (0..).map(at).find(|at_s| *at_s >= made_s).unwrap()
        };
        let (worst_s, _) = error_s(arrival, |_| false);
        assert!(worst_s <= 0.010, "{worst_s}");
    }
}
