//! How long things took: histograms that allocate nothing while they record.

use hdrhistogram::Histogram;
use serde::Serialize;

/// The longest time that is known from longer ones, nanoseconds: a minute.
const MOST_NS: u64 = 60_000_000_000;

/// A histogram of times, to three digits.
#[derive(Debug, Clone)]
pub struct Latency {
    histogram: Option<Histogram<u64>>,
}

impl Default for Latency {
    fn default() -> Self {
        // None never: the bounds are good ones.
        Self { histogram: Histogram::new_with_bounds(1, MOST_NS, 3).ok() }
    }
}

/// Percentiles of times, microseconds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LatencySummary {
    /// How many times were recorded.
    pub count: u64,
    /// The median.
    pub p50_us: f64,
    /// Nine of ten are at most as long.
    pub p90_us: f64,
    /// 99 of 100.
    pub p99_us: f64,
    /// 999 of 1000.
    pub p99_9_us: f64,
    /// The longest; a minute at most.
    pub max_us: f64,
}

impl Latency {
    /// Records a time, nanoseconds.
    pub fn record_ns(&mut self, ns: u64) {
        if let Some(histogram) = &mut self.histogram {
            histogram.saturating_record(ns.max(1));
        }
    }

    /// Percentiles; none where nothing was recorded.
    #[must_use]
    pub fn summary(&self) -> Option<LatencySummary> {
        let histogram = self.histogram.as_ref().filter(|histogram| !histogram.is_empty())?;
        let us = |quantile| histogram.value_at_quantile(quantile) as f64 / 1e3;
        Some(LatencySummary {
            count: histogram.len(),
            p50_us: us(0.5),
            p90_us: us(0.9),
            p99_us: us(0.99),
            p99_9_us: us(0.999),
            max_us: histogram.max() as f64 / 1e3,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_those_of_the_times() {
        let mut latency = Latency::default();
        assert_eq!(latency.summary(), None);
        for us in 1..=1000 {
            latency.record_ns(us * 1000);
        }
        let summary = latency.summary().unwrap();
        assert_eq!(summary.count, 1000);
        let found = [summary.p50_us, summary.p90_us, summary.p99_us, summary.p99_9_us, summary.max_us];
        for (found, exact) in found.into_iter().zip([500.0, 900.0, 990.0, 999.0, 1000.0]) {
            // Three digits.
            assert!((found - exact).abs() <= 1e-3 * exact, "{found} for {exact}");
        }
        latency.record_ns(u64::MAX);
        assert!(latency.summary().unwrap().max_us <= 61e6);
    }

    #[test]
    fn recording_allocates_nothing() {
        let mut latency = Latency::default();
        let counted = allocation_counter::measure(|| (0..100_000).for_each(|k| latency.record_ns(k * k)));
        assert_eq!(counted.count_total, 0);
    }
}
