//! Other programs on the curves: Python scripts that are compiled in, run on the same scenes where `python3` has what
//! they need; and figures measured elsewhere, from a table.
//!
//! What is not measured is reported, with how to get it. Packages are those of `benches/peers/requirements.txt`, from
//! PyPI.

mod python;
pub(in crate::tradeoff) mod report;
mod table;

use std::path::PathBuf;

pub(super) use python::Answer;
pub use python::{Python, Script};
pub use report::PeerReport;
pub(super) use table::join;
pub use table::read_peers;

use crate::tradeoff::measure::rows::Row;

/// How to get the packages.
pub(super) const REQUIREMENTS: &str = include_str!("../../../benches/peers/requirements.txt");

/// Which other programs are wanted.
#[derive(Debug, Clone, Default)]
pub struct Peers {
    /// Whether to measure them here.
    pub measured: bool,
    /// Tables of figures measured elsewhere.
    pub tables: Vec<PathBuf>,
}

impl Peers {
    /// All rows of the tables.
    ///
    /// # Errors
    /// A table that can't be read, with its place.
    pub fn read(&self) -> anyhow::Result<Vec<Row>> {
        let tables = self.tables.iter().map(|path| read_peers(path)).collect::<anyhow::Result<Vec<_>>>()?;
        Ok(tables.into_iter().flatten().collect())
    }
}
