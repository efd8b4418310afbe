//! What became of another program.

use serde::Serialize;

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
    pub(in crate::tradeoff) fn measured(peer: &str, what: impl Into<String>) -> Self {
        Self { peer: peer.to_owned(), measured: true, what: what.into() }
    }

    pub(in crate::tradeoff) fn missing(peer: &str, why: impl Into<String>) -> Self {
        Self { peer: peer.to_owned(), measured: false, what: why.into() }
    }
}
