//! A device's clock: unwrapped, its losses counted, tied to the host's.

mod envelope;
mod timeline;

pub use envelope::{ClockFit, Envelope};
pub use timeline::{Placed, Timeline, TimelineCounts};
