//! Other programs on the curves: their figures come from tables, each row with its scene, machine, version and date.
//!
//! `make peers` of the repository (`bench/peers`) measures them on the scenes of [`Plan`](crate::tradeoff::Plan). A row
//! of another scene stays off the curves, which is reported.

mod join;
mod report;
mod table;

pub(super) use join::join;
pub use report::PeerReport;
pub(super) use report::program;
pub use table::{PeerRow, read_peers, write_peers};
