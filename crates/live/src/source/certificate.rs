//! What came of a stream: its states, losses, and how its clock ran.

use serde::Serialize;

use crate::time::{ClockFit, TimelineCounts};
use crate::wire::SpoiltRows;

/// How a stream is doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum StreamState {
    /// Rows come.
    Ok,
    /// Rows come at less than nine tenths of the rate.
    Slow,
    /// No row came for three periods, and a tenth of a second at least.
    Stalled,
    /// The source has gone away.
    Lost,
    /// It is being looked for.
    Reconnecting,
}

impl StreamState {
    /// In a word.
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

/// A state and when it began.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Span {
    /// The state.
    pub state: StreamState,
    /// Seconds of the host's clock since the session began.
    pub since_s: f64,
}

/// What came of a stream.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StreamCertificate {
    /// The source, as written.
    pub source: String,
    /// Rows that came whole, unlit ones included.
    pub rows: u64,
    /// Rows a second, by the stream's own clock; none of fewer than two rows.
    pub rate_hz: Option<f64>,
    /// Whether rows have a time of the device; otherwise it is that of their arrival.
    pub device_time: bool,
    /// What was lost or dropped.
    #[serde(flatten)]
    pub losses: TimelineCounts,
    /// Rows that were spoilt.
    pub spoilt: u64,
    /// By kind.
    pub spoilt_kinds: Vec<SpoiltRows>,
    /// The device's clock against the host's; none of a recording, or of less than 2 s.
    pub clock: Option<ClockFit>,
    /// The states, from the first on; of more than 100 the first.
    pub states: Vec<Span>,
    /// How often the state changed.
    pub changes: u64,
}
