//! What a session reports.

use std::path::PathBuf;

use lunula_live::latency::Percentiles;
use lunula_live::source::StreamCertificate;
use serde::Serialize;

use crate::job::Report;

/// How a session went.
pub type SessionReport = Report<SessionFigures>;

/// The figures of a session.
#[derive(Debug, Clone, Serialize)]
pub struct SessionFigures {
    /// The recording.
    pub out: Option<PathBuf>,
    /// What came, what was lost, how its clock ran.
    pub stream: StreamCertificate,
    /// The columns of the rows of answers.
    pub columns: Vec<String>,
    /// Rows that came.
    pub rows: u64,
    /// Rows that were answered: those with the LED on.
    pub answered: u64,
    /// Of these, rows of which something is not known.
    pub rows_not_known: u64,
    /// Of these, rows outside of the voltages that a model was trained on.
    pub rows_outside: u64,
    /// Rows in touch and bending, where the two are gated.
    pub touch: u64,
    /// See `touch`.
    pub bending: u64,
    /// What the switch did.
    pub switch: Option<SwitchCounts>,
    /// How long rows took.
    pub latency: Latency,
    /// Rows that readers lost, as they were too slow.
    pub lost_by_readers: u64,
    /// Rows that the recording lost, as the disk was too slow.
    pub lost_by_disk: u64,
}

/// What a switch did in a session.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct SwitchCounts {
    /// Presses.
    pub presses: u64,
    /// Releases.
    pub releases: u64,
    /// Of these, those by the watchdog, a clock set back, a lost source or the session's end.
    pub let_go: u64,
}

/// How long a row took on its way, microseconds; none where it can't be known.
#[derive(Debug, Clone, Serialize)]
pub struct Latency {
    /// From the device's time, by the earliest that rows ever came, to the host: what the link adds at times.
    pub arrival_us: Option<Percentiles>,
    /// From the row's last byte in our hands to the end of what follows from it.
    pub work_us: Option<Percentiles>,
    /// How late the host wakes this program up: what the machine adds.
    pub wake_up_us: Option<Percentiles>,
}
