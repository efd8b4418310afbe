//! Where bytes come from: serial ports, TCP, UDP, standard input, files played back.
//!
//! In: an [`Address`] such as `serial:/dev/ttyACM0?baud=921600`. Out: a [`Stream`] of [`Event`]s, read without blocking
//! in a loop of [`wait`] and [`Stream::poll`], on one thread. A port that is lost is looked for and opened again. Times
//! named `_ns` are nanoseconds of a [`HostClock`].

mod address;
mod certificate;
mod decoder;
mod fault;
mod health;
mod play;
mod port;
mod stream;
#[cfg(test)]
mod tests;
mod wait;

pub use address::{Address, Form, LslQuery, OfFinger, Pace, Place};
pub use certificate::{StreamCertificate, StreamGap, StreamTimes};
pub use decoder::Rows;
pub use fault::SourceFault;
pub use health::{Condition, State};
#[cfg(feature = "lsl")]
pub use port::lsl::LslOutlet;
pub use stream::{Event, Stream, StreamOptions};
pub use wait::{HostClock, MOST_WAITED, Ready, wait};
