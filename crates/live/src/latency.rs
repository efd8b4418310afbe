//! How long things took, as percentiles; nothing is allocated once it exists.

use hdrhistogram::Histogram;
use serde::Serialize;

/// Longer ones count as this long: a minute, nanoseconds.
const MOST_NS: u64 = 60_000_000_000;

/// Durations.
#[derive(Debug, Clone)]
pub struct Latencies(Histogram<u64>);

/// Percentiles of durations, microseconds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Percentiles {
    /// How many.
    pub count: u64,
    /// Half were shorter.
    pub p50: f64,
    /// 90 in 100 were.
    pub p90: f64,
    /// 99 in 100 were.
    pub p99: f64,
    /// 999 in 1000 were.
    pub p99_9: f64,
    /// The longest.
    pub max: f64,
}

impl Default for Latencies {
    fn default() -> Self {
        // Two digits: to 1 %. Bounds that are constants are always valid.
        Self(Histogram::new_with_bounds(1, MOST_NS, 2).unwrap_or_else(|_| unreachable!("constant bounds")))
    }
}

impl Latencies {
    /// Adds one, nanoseconds.
    pub fn record(&mut self, ns: u64) {
        self.0.saturating_record(ns);
    }

    /// The percentiles; none of none.
    #[must_use]
    pub fn percentiles(&self) -> Option<Percentiles> {
        let at = |percent: f64| 1e-3 * self.0.value_at_percentile(percent) as f64;
        (!self.0.is_empty()).then(|| Percentiles {
            count: self.0.len(),
            p50: at(50.0),
            p90: at(90.0),
            p99: at(99.0),
            p99_9: at(99.9),
            max: 1e-3 * self.0.max() as f64,
        })
    }
}
