//! Why there are no figures of skill.

use std::path::Path;

use thiserror::Error;

use crate::files::WriteError;
use crate::job::Interrupted;
use crate::log::LogError;
use crate::table::TableError;

/// Why there are no results; nothing that existed before was touched.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum SkillError {
    #[error("{}", .0.join("; "))]
    Options(Vec<String>),
    #[error(transparent)]
    Table(#[from] TableError),
    #[error(transparent)]
    Log(#[from] LogError),
    /// Recordings that can't be used; a fault a line, each with its place.
    #[error("{}", .0.join("\n"))]
    Recordings(Vec<String>),
    #[error(transparent)]
    Write(#[from] WriteError),
    #[error("stopped")]
    Interrupted(#[from] Interrupted),
}

impl SkillError {
    /// What is wrong with a recording as a whole.
    pub(super) fn recording(path: &Path, what: &str) -> Self {
        Self::Recordings(vec![format!("{}: {what}", path.display())])
    }
}
