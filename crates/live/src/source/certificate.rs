//! What is known of a stream when it ends.

use serde::Serialize;

use crate::source::address::Form;
use crate::source::health::State;
use crate::time::{ClockFit, RowCounts};
use crate::wire::SpoiltRows;

/// What is known of a stream: what came, what did not, and by which clock.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StreamCertificate {
    /// The source.
    pub source: String,
    /// How its rows are written; none of rows that a program made.
    pub form: Option<Form>,
    /// Its columns.
    pub columns: Vec<String>,
    /// Whose clock the rows' times are of; none where the columns never became known.
    pub times: Option<StreamTimes>,
    /// When the host's clock was zero, seconds since 1970, as the caller gave it.
    pub host_start_unix_s: Option<f64>,
    /// Rows that came, and rows that did not.
    #[serde(flatten)]
    pub counts: RowCounts,
    /// Rows in a second, by the mean step without gaps; none where it is not known.
    pub rate_hz: Option<f64>,
    /// How long the bursts are in which rows without a clock arrive, seconds; none where they have one, or come one by
    /// one.
    pub burst_s: Option<f64>,
    /// Spoilt rows by kind, with the first of each.
    pub spoilt: Vec<SpoiltRows>,
    /// Gaps of more than five periods, the first hundred.
    pub gaps: Vec<StreamGap>,
    /// How many there were.
    pub gaps_count: u64,
    /// The longest, seconds; none where there was no gap.
    pub longest_gap_s: Option<f64>,
    /// How the stream was, and since when.
    pub states: Vec<State>,
    /// States that were too many to list.
    pub states_left_out: u64,
    /// The line between the device's clock and the host's; none where it has none, or rows do not come live.
    pub clock: Option<ClockFit>,
    /// What is unusual, and what to do about it.
    pub notes: Vec<String>,
}

/// Whose clock the rows' times are of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum StreamTimes {
    /// The device's own.
    Device,
    /// The host's, when rows arrived, spread over the time since the arrival before: the device sends none.
    Arrival,
}

/// A time without rows.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct StreamGap {
    /// The stream's time of the last row before it, seconds.
    pub after_s: f64,
    /// How long it was, seconds.
    pub length_s: f64,
    /// Whether a recording begins after it.
    pub begins: bool,
}

/// A gap has more periods than this, as in logs.
const GAP_PERIODS: f64 = 5.0;

const MOST_GAPS: usize = 100;

/// Finds gaps between rows.
#[derive(Debug, Clone)]
pub(in crate::source) struct Gaps {
    pub(in crate::source) first: Vec<StreamGap>,
    pub(in crate::source) count: u64,
    pub(in crate::source) longest_s: Option<f64>,
    last_s: f64,
}

impl Default for Gaps {
    fn default() -> Self {
        Self { first: Vec::with_capacity(MOST_GAPS), count: 0, longest_s: None, last_s: f64::NAN }
    }
}

impl Gaps {
    pub(in crate::source) fn row(&mut self, time_s: f64, begins: bool, period_s: Option<f64>) {
        if time_s.is_nan() {
            return;
        }
        let (after_s, length_s) = (self.last_s, time_s - self.last_s);
        self.last_s = time_s;
        let long = period_s.is_some_and(|period_s| length_s > GAP_PERIODS * period_s);
        // The first row follows nothing.
        if after_s.is_nan() || !(begins || long) {
            return;
        }
        self.count += 1;
        self.longest_s = Some(self.longest_s.map_or(length_s, |longest_s| longest_s.max(length_s)));
        if self.first.len() < MOST_GAPS {
            self.first.push(StreamGap { after_s, length_s, begins });
        }
    }
}
