//! Where samples come from, lost and found again.
//!
//! In: a [`Source`], one grammar for every command. Out: a [`Stream`] of rows with their time, its state, and a
//! [`StreamCertificate`] of what came. One thread reads: it waits for bytes or for the next deadline ([`Stream::wait`]),
//! takes what is there ([`Stream::poll`]), and allocates nothing for a row.

mod address;
mod certificate;
mod host;
mod input;
mod stream;
#[cfg(test)]
mod tests;

pub use address::{Form, Place, Rate, Source};
pub use certificate::{Span, StreamCertificate, StreamState};
pub use host::HostClock;
pub use input::{Rows, SourceFault};
pub use stream::{Event, Stream, StreamOptions};
