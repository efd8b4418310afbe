//! Why there is no lens.

use std::path::PathBuf;

use thiserror::Error;

use crate::files::WriteError;
use crate::job::Interrupted;
use crate::video::VideoError;
use crate::vision::VisionError;

/// Why there are no results.
#[derive(Debug, Error)]
pub enum CameraError {
    /// An input can't be used at all.
    #[error("{}: {why}", path.display())]
    Input {
        /// The folder or file.
        path: PathBuf,
        /// What is wrong and what to do.
        why: String,
    },
    /// A file that is no photograph can't be read as a video.
    #[error("{0} (a folder of photographs or a video is needed)")]
    Video(#[from] VideoError),
    /// The views do not determine the lens.
    #[error("{why}{}", listed(failed))]
    Undetermined {
        /// What is wrong and what to do.
        why: String,
        /// What could not be used, each with the reason.
        failed: Vec<String>,
    },
    /// OpenCV gave nothing.
    #[error(transparent)]
    Vision(#[from] VisionError),
    /// A result can't be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// Stopped from outside.
    #[error("stopped")]
    Interrupted(#[from] Interrupted),
}

/// The most failures that an error lists.
const MOST_LISTED: usize = 20;

fn listed(failed: &[String]) -> String {
    let mut lines: Vec<String> = failed.iter().take(MOST_LISTED).map(|what| format!("\n  {what}")).collect();
    if failed.len() > MOST_LISTED {
        lines.push(format!("\n  and {} more", failed.len() - MOST_LISTED));
    }
    lines.concat()
}
