//! Bytes of a stream to rows.
//!
//! In: bytes in pieces of any size. Out: a [`Row`] for each line or frame that is whole, as soon as it is; the same rows
//! however the bytes were cut. A row that is spoilt costs itself.

mod cell;
mod frames;
mod lines;
mod row;
mod spoilt;

pub use cell::{is_missing, led};
pub use frames::{Frame, Frames};
pub use lines::{Cells, Line, LineOptions, Lines, Naming, WireFault};
pub use row::{Meaning, Row, Use};
pub use spoilt::{Spoilt, SpoiltKind, SpoiltRows};
