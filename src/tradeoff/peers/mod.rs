//! Other programs on the curves: Python scripts that are compiled in, run on the same scenes where `python3` has what they need; and figures
//! measured elsewhere, from a table.
//!
//! What is not measured is told, with how to get it. Packages are those of `benches/peers/requirements.txt`, from PyPI.

mod python;
mod table;

use std::path::PathBuf;

use serde::Serialize;

pub(super) use python::Answer;
pub use python::{Python, Script};
pub(super) use table::join;
pub use table::read_peers;

use super::rows::Row;

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

/// What became of another program.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct PeerReport {
    /// What it is.
    pub peer: String,
    /// Whether it is on the curves.
    pub measured: bool,
    /// What was done, or why it is missing and how to get it.
    pub what: String,
}

impl PeerReport {
    pub(super) fn measured(peer: &str, what: impl Into<String>) -> Self {
        Self { peer: peer.to_owned(), measured: true, what: what.into() }
    }

    pub(super) fn missing(peer: &str, why: impl Into<String>) -> Self {
        Self { peer: peer.to_owned(), measured: false, what: why.into() }
    }
}
