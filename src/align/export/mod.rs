//! Angles and markers in the formats of others: OpenSim's motion file, BIDS Motion, DeepLabCut's table.
//!
//! Angles stand at the frames in which they were seen, on the log's clock by the [`Tie`](super::Tie); nothing is
//! interpolated. Whole files or none is the caller's business ([`crate::files`]).

mod bids;
mod dlc;
mod mot;

use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::files::WriteError;
use crate::table::TableError;

pub(super) use bids::{BidsNames, bids};
pub(super) use dlc::dlc;
pub(super) use mot::mot;

/// Why there is no export.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum ExportError {
    #[error(transparent)]
    Table(#[from] TableError),
    #[error(transparent)]
    Write(#[from] WriteError),
    #[error(
        "the {entity} {}; BIDS allows letters and digits only: name it so",
        .label.as_ref().map_or("is not named".to_owned(), |l| format!("is named `{l}`"))
    )]
    Label {
        /// Of what: `subject`, `session`, `task`, `tracksys`.
        entity: &'static str,
        label: Option<String>,
    },
    #[error("{}: {what}", path.display())]
    Unfit { path: PathBuf, what: String },
}

/// Decimals of a time in seconds: as many as the table of angles has.
const TIME_DECIMALS: usize = 6;
/// Decimals of an angle in degrees: as many as the table of angles has.
const ANGLE_DECIMALS: usize = 5;

/// A number of fixed decimals, `missing` where it is not known; never a negative zero.
fn fixed(number: f64, decimals: usize, missing: &str) -> String {
    if !number.is_finite() {
        return missing.to_owned();
    }
    crate::words::fixed(number, decimals)
}

/// Writes what is to stand at `path` into the file `at`.
fn write(at: &Path, path: &Path, text: &str) -> Result<(), ExportError> {
    let refused = |why: std::io::Error| WriteError::File { path: path.to_owned(), why: why.to_string() };
    Ok(std::fs::write(at, text).map_err(refused)?)
}

#[cfg(test)]
mod tests;
