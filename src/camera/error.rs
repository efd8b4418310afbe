//! Why there is no lens.

use std::path::PathBuf;

use thiserror::Error;

use crate::files::WriteError;
use crate::job::Interrupted;
use crate::video::VideoError;
use crate::vision::VisionError;

/// Why there are no results.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum CameraError {
    #[error("{}: {why}", path.display())]
    Input { path: PathBuf, why: String },
    #[error("{0} (a folder of photographs or a video is needed)")]
    Video(#[from] VideoError),
    #[error("{why}{}", listed(failed))]
    Undetermined { why: String, failed: Vec<String> },
    #[error(transparent)]
    Vision(#[from] VisionError),
    #[error(transparent)]
    Write(#[from] WriteError),
    #[error("stopped")]
    Interrupted(#[from] Interrupted),
}

const MOST_LISTED: usize = 20;

fn listed(failed: &[String]) -> String {
    let mut lines: Vec<String> = failed.iter().take(MOST_LISTED).map(|what| format!("\n  {what}")).collect();
    if failed.len() > MOST_LISTED {
        lines.push(format!("\n  and {} more", failed.len() - MOST_LISTED));
    }
    lines.concat()
}
