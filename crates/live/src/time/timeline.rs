//! A device's time and counter to seconds that ascend and rows that are lost.
//!
//! In: what rows say of time and counter, in the device's units. Out: seconds, unwrapped; the rows that were lost before
//! each; whether a recording begins. Clocks of 16 and 32 bits wrap (32 bits of microseconds after 71.58 minutes, of
//! milliseconds after 49.7 days), counters of 8, 16 and 32 bits much sooner. A row that comes twice, or later than the
//! one after it, is dropped and counted. A clock that falls back otherwise, or a counter that does, was set back: a
//! recording begins. Without a counter losses are estimated from gaps in time. Nothing is made up for what is lost.

use serde::Serialize;

/// Bits of clocks and of counters that wrap.
const CLOCKS: [f64; 2] = [65_536.0, 4_294_967_296.0];
const COUNTERS: [u64; 3] = [1 << 8, 1 << 16, 1 << 32];
/// Across a wrap so much of the whole range may be lost before it is taken for a start from anew.
const LOST_SHARE: f64 = 0.25;
/// A row with a counter this little behind came late.
const LATE_ROWS: u64 = 64;
/// Steps between rows over which the usual one is taken.
const STEPS: usize = 16;
/// A step of so many usual ones is a gap.
const GAP_STEPS: f64 = 1.5;

/// Time and counter of a stream.
#[derive(Debug, Clone)]
pub struct Timeline {
    per_second: f64,
    /// What wrapped, in the device's units and in rows.
    wrapped: f64,
    rounds: u64,
    last_raw: f64,
    last_s: f64,
    last_counter: Option<u64>,
    steps: [f64; STEPS],
    count: u64,
    begun: bool,
    counts: TimelineCounts,
}

/// What was lost, and what came in disorder.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct TimelineCounts {
    /// Rows that never came: by the counter, or estimated from gaps in time.
    pub lost: u64,
    /// Rows that came twice, or after a later one; they were dropped.
    pub dropped: u64,
    /// Gaps: places where rows are lost.
    pub gaps: u64,
    /// How often the clock or the counter wrapped.
    pub wraps: u64,
    /// How often a recording began: the first row, and after each time that the clock was set back or the source lost.
    pub begins: u64,
    /// Whether losses are counted; otherwise they are estimated from the time.
    pub counted: bool,
}

/// A row's place in time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placed {
    /// Seconds, unwrapped; NaN where the row has none.
    pub time_s: f64,
    /// Rows lost before it.
    pub lost: u64,
    /// Whether a recording begins.
    pub begins: bool,
}

impl Timeline {
    /// Of a device so many of whose units make a second.
    #[must_use]
    pub fn new(per_second: f64) -> Self {
        Self {
            per_second,
            wrapped: 0.0,
            rounds: 0,
            last_raw: f64::NAN,
            last_s: f64::NAN,
            last_counter: None,
            steps: [0.0; STEPS],
            count: 0,
            begun: false,
            counts: TimelineCounts::default(),
        }
    }

    /// What was counted so far.
    #[must_use]
    pub fn counts(&self) -> TimelineCounts {
        self.counts
    }

    /// The usual time between rows, seconds; none of fewer than four rows.
    #[must_use]
    pub fn period_s(&self) -> Option<f64> {
        let known = (self.count as usize).min(STEPS);
        let mut steps = self.steps;
        let steps = &mut steps[..known];
        steps.sort_unstable_by(f64::total_cmp);
        (known >= 3).then(|| steps[known / 2])
    }

    /// The source was lost: the next row begins a recording.
    pub fn cut(&mut self) {
        self.begun = false;
        self.last_counter = None;
    }

    /// A row's time in the device's units and its counter; none where the row is to be dropped.
    pub fn place(&mut self, raw: f64, counter: Option<u64>) -> Option<Placed> {
        let (mut begins, mut lost) = (!self.begun, 0);
        if let Some(counter) = counter {
            self.counts.counted = true;
            match self.counted(counter) {
                Counted::Next(missing) => lost = missing,
                Counted::Dropped => {
                    self.counts.dropped += 1;
                    return None;
                }
                Counted::Begins => begins = true,
            }
        }
        let mut time_s = raw / self.per_second + self.wrapped / self.per_second;
        if raw.is_finite() {
            if raw < self.last_raw && !begins {
                match self.wrap(raw) {
                    Some(by) => {
                        self.wrapped += by;
                        self.counts.wraps += 1;
                        time_s = (raw + self.wrapped) / self.per_second;
                    }
                    None => begins = true,
                }
            }
            if begins {
                // The clock may run on, or have been set back.
                if raw < self.last_raw {
                    self.wrapped = 0.0;
                }
                time_s = (raw + self.wrapped) / self.per_second;
            } else if self.last_s.is_finite() {
                let step_s = time_s - self.last_s;
                if counter.is_none() {
                    lost = self.estimated(step_s);
                }
                if lost == 0 && step_s > 0.0 {
                    self.steps[(self.count % STEPS as u64) as usize] = step_s;
                    self.count += 1;
                }
            }
            (self.last_raw, self.last_s) = (raw, time_s);
        }
        self.begun = true;
        self.counts.lost += lost;
        self.counts.gaps += u64::from(lost > 0);
        self.counts.begins += u64::from(begins);
        Some(Placed { time_s, lost, begins })
    }

    /// By how many units the clock wrapped; none where it was set back.
    fn wrap(&self, raw: f64) -> Option<f64> {
        // Clocks that count whole units wrap, not seconds.
        if self.per_second <= 1.0 {
            return None;
        }
        let wraps = |range: &f64| self.last_raw < *range && raw + range - self.last_raw < LOST_SHARE * range;
        CLOCKS.into_iter().find(wraps)
    }

    fn counted(&mut self, counter: u64) -> Counted {
        let last = self.last_counter.replace(counter);
        let Some(last) = last else { return Counted::Next(0) };
        if counter > last {
            return Counted::Next(counter - last - 1);
        }
        for range in COUNTERS {
            let ahead = (counter + range).wrapping_sub(last);
            if last < range && (1..=(LOST_SHARE * range as f64) as u64).contains(&ahead) {
                self.counts.wraps += 1;
                self.rounds += 1;
                return Counted::Next(ahead - 1);
            }
        }
        if last - counter <= LATE_ROWS && counter > 0 {
            self.last_counter = Some(last);
            return Counted::Dropped;
        }
        Counted::Begins
    }

    /// Rows that a step in time has room for.
    fn estimated(&self, step_s: f64) -> u64 {
        match self.period_s() {
            Some(period_s) if step_s > GAP_STEPS * period_s && period_s > 0.0 => {
                ((step_s / period_s).round() - 1.0).clamp(0.0, 1e15) as u64
            }
            _ => 0,
        }
    }
}

enum Counted {
    Next(u64),
    Dropped,
    Begins,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn microseconds_of_32_bits_wrap_after_71_minutes_and_nothing_is_lost() {
        let mut timeline = Timeline::new(1e6);
        let (mut last_s, mut begins) = (f64::NEG_INFINITY, 0);
        let rows: u32 = 3 * 4295 * 10;
        for k in 0..rows {
            let raw = (u64::from(k) * 100_000 + 4_000_000_000) % (1 << 32);
            let placed = timeline.place(raw as f64, None).unwrap();
            begins += u32::from(placed.begins);
            assert!(placed.lost == 0 && placed.time_s > last_s);
            last_s = placed.time_s;
        }
        assert!((last_s - (4000.0 + 0.1 * f64::from(rows - 1))).abs() <= 1e-6 && begins == 1, "{last_s}");
        assert_eq!((timeline.counts().wraps, timeline.counts().lost), (3, 0));
    }

    #[test]
    fn counters_wrap_and_every_loss_is_counted() {
        for range in [1u64 << 8, 1 << 16, 1 << 32] {
            let mut timeline = Timeline::new(1e3);
            let mut lost = 0;
            for k in 0..3000u64 {
                if k % 97 == 5 || k % 301 < 4 {
                    lost += 1;
                    continue;
                }
                let placed = timeline.place(k as f64, Some((k + 4 * range - 500) % range)).unwrap();
                assert_eq!(placed.begins, k == 4, "{k}");
            }
            // The four before the first row are not known to be.
            assert_eq!(timeline.counts().lost, lost - 4, "{range}");
        }
    }

    #[test]
    fn doubles_and_late_rows_are_dropped_and_a_restart_begins() {
        let mut timeline = Timeline::new(1e3);
        let mut place = |raw: f64, n: u64| timeline.place(raw, Some(n)).map(|placed| (placed.lost, placed.begins));
        assert_eq!(place(5000.0, 1000), Some((0, true)));
        assert_eq!(place(5001.0, 1001), Some((0, false)));
        assert_eq!(place(5001.0, 1001), None);
        assert_eq!(place(5003.0, 1003), Some((1, false)));
        assert_eq!(place(5002.0, 1002), None);
        assert_eq!(place(5004.0, 1004), Some((0, false)));
        // Switched off and on.
        assert_eq!(place(3.0, 0), Some((0, true)));
        assert_eq!(place(4.0, 1), Some((0, false)));
        assert_eq!(timeline.counts().dropped, 2);
    }

    #[test]
    fn without_a_counter_gaps_are_estimated() {
        let mut timeline = Timeline::new(1.0);
        let times = (0..50).map(|k| 0.04 * f64::from(k)).chain([2.12, 2.16]);
        let lost: u64 = times.map(|time| timeline.place(time, None).unwrap().lost).sum();
        assert_eq!((lost, timeline.counts().gaps, timeline.counts().counted), (3, 1, false));
        assert!((timeline.period_s().unwrap() - 0.04).abs() <= 1e-9);
        assert!(timeline.place(f64::NAN, None).unwrap().time_s.is_nan());
        assert!(timeline.place(1.0, None).unwrap().begins, "set back");
    }
}
