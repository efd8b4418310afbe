//! A session: samples as they come, to a recording, to answers, to a switch.
//!
//! In: a source for each finger ([`lane`]) and what is to be done with its rows ([`decide`]). Out: rows of answers to
//! readers and files, events, and a [`SessionReport`] with each stream's certificate and how long each row took.
//!
//! One loop in one thread, without a queue: wait for bytes or for the next deadline, decode what is there, decide row
//! by row, hand the rows out. Readers that are slow are never waited for ([`outputs::pipe`]); the recording has a
//! thread of its own ([`outputs::recording`]). Of a file the clock that ends holds and watchdogs is the file's own, so
//! that a recording played back at any speed gives the same decisions; of a live source it is the host's since its
//! last row. Several files are played in the order of their rows.

mod columns;
mod decide;
mod feed;
mod fingers;
mod lane;
mod open;
mod outputs;
mod replay;
mod report;
mod run;
mod sensor;

pub(crate) use columns::StreamColumns;
pub(crate) use open::PhantomRows;
pub use outputs::pointer::PointerCounts;
pub(crate) use outputs::recording::Recording as Growing;
pub use outputs::switch::SwitchCounts;
pub(crate) use replay::each_row;
pub use report::{Latency, SessionFigures, SessionReport, SourceFigures, SourceRole};
pub(crate) use run::attend;
pub use run::{Readers, live, record};
pub(crate) use sensor::Sensor;
