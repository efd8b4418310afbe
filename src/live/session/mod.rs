//! A session: samples as they come, to a recording, to answers, to a switch.
//!
//! In: a [`Source`] and what is to be done with its rows. Out: rows of answers to readers and files, events, and a
//! [`SessionReport`] with the stream's certificate and how long each row took.
//!
//! One loop in one thread, without a queue: wait for bytes or for the next deadline, decode what is there, decide row
//! by row, hand the rows out. Readers that are slow are never waited for ([`pipe`]); the recording has a thread of its
//! own ([`recording`]). Of a file the clock that ends holds and watchdogs is the file's own, so that a recording played
//! back at any speed gives the same decisions; of a live source it is the host's since its last row.

mod columns;
mod decide;
mod open;
mod pipe;
mod pointer;
mod recording;
mod report;
mod run;
mod sensor;

pub(crate) use columns::StreamColumns;
pub use pointer::PointerCounts;
pub use report::{Latency, SessionFigures, SessionReport};
pub(crate) use run::each_row;
pub use run::{Readers, live, record};
pub(crate) use sensor::Sensor;
