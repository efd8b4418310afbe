//! Why there are no results.

use std::path::PathBuf;

use thiserror::Error;

use super::outline::SavedOutlines;
use super::set::SetFault;
use super::sums::PartialFault;
use crate::files::WriteError;
use crate::job::Interrupted;

/// Why a set gave no results.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum PhotosError {
    #[error(transparent)]
    Write(#[from] WriteError),
    #[error("not one nail could be used, so there are no maps{}:{}", look_at(.report), list(.failed))]
    NothingUsable {
        /// The report of what was found and why it is not used, where there is something to see.
        report: Option<PathBuf>,
        failed: Vec<SetFault>,
        /// What was detected but not trusted and was saved, where that was requested: a person may correct it.
        outlines: Option<SavedOutlines>,
    },
    #[error("stopped")]
    Interrupted(#[from] Interrupted),
}

fn look_at(report: &Option<PathBuf>) -> String {
    report.as_ref().map_or_else(String::new, |report| format!("; {} shows what was found", report.display()))
}

fn list(failed: &[SetFault]) -> String {
    failed.iter().map(|fault| format!("\n  {fault}")).collect()
}

/// Why results were not joined; nothing is written then.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum MergeError {
    #[error(transparent)]
    Partial(#[from] PartialFault),
    #[error("{}: {why}; make that part again", .file.display())]
    Nails { file: PathBuf, why: String },
    /// The exact maps that results are compared with.
    #[error("{}: {why}", .file.display())]
    Truth { file: PathBuf, why: String },
    #[error(transparent)]
    Write(#[from] WriteError),
    #[error("stopped")]
    Interrupted(#[from] Interrupted),
}
