//! What became of another program.

use serde::Serialize;

/// What became of another program.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct PeerReport {
    /// What it is.
    pub peer: String,
    /// Whether it is on the curves.
    pub measured: bool,
    /// Its version and where and when it was measured, or why it is missing and how to get it.
    pub what: String,
}

/// The program that a setting of another program begins with.
pub(in crate::tradeoff) fn program(setting: &str) -> &str {
    setting.split([',', ':']).next().unwrap_or(setting)
}
