//! Bytes of a stream to rows.
//!
//! In: bytes in pieces of any size. Out: a [`Step`] for each line or frame that is whole, as soon as it is; the same
//! steps however the bytes were cut. A row that is spoilt costs itself.

mod cell;
mod checksum;
mod fault;
mod frames;
mod lines;
mod row;
mod spoilt;
#[cfg(test)]
pub(crate) mod testing;

pub use cell::{bare, is_missing, is_name, led, led_of, with_decimal_comma};
pub use checksum::{Checksum, crc16, xor8};
pub use fault::WireFault;
pub use frames::{FRAME_NAMES, Frame, Frames, WIRE_BYTES};
pub use lines::{LineOptions, Lines};
pub use row::{Decoded, Meaning, Naming, Row, Sample, Step, Use};
pub use spoilt::{Spoil, SpoiltRows, Tally};
