//! A device's clock unwrapped, its rows counted, and its clock tied to the host's.
//!
//! In: rows as their device numbers them, and when they came. Out: seconds that ascend, what was lost, came twice or
//! late, and where a recording begins; the line between both clocks with its drift.

mod arrivals;
mod counter;
mod envelope;
mod period;
mod resolution;
mod sequence;
#[cfg(test)]
pub(crate) mod testing;
#[cfg(test)]
mod tests;
mod unwrap;

pub use arrivals::Arrivals;
pub use counter::{Count, Counter};
pub use envelope::{ClockFit, Envelope};
pub use period::Period;
pub use resolution::Resolution;
pub use sequence::{Link, RowCounts, Sequence, Verdict};
pub use unwrap::{Reading, Unwrap};
