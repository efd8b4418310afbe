//! The host's clock of a session.

use std::time::{Duration, Instant};

/// Nanoseconds since a session began, of the host's monotonic clock.
#[derive(Debug, Clone, Copy)]
pub struct HostClock(Instant);

impl HostClock {
    /// Begins now.
    #[must_use]
    pub fn start() -> Self {
        Self(Instant::now())
    }

    /// Nanoseconds since it began.
    #[must_use]
    pub fn now_ns(self) -> u64 {
        u64::try_from(self.0.elapsed().as_nanos()).unwrap_or(u64::MAX)
    }

    /// How long it is until a moment; none where it has passed.
    #[must_use]
    pub fn until(self, moment_ns: u64) -> Duration {
        Duration::from_nanos(moment_ns.saturating_sub(self.now_ns()))
    }
}
