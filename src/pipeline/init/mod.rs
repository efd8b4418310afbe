//! A pipeline for a folder: what lies there is looked at, and a file is written that runs as it stands, saying what was
//! taken for what.
//!
//! In: a folder; out: the text of a pipeline file. Files are known by their ending and tables by their columns; what
//! jobs and runs of lunula made, hidden files, `truth` folders and what is below too many folders are not looked at.

mod look;
mod results;
mod shape;
#[cfg(test)]
mod tests;
mod write;

pub use write::Proposal;

use std::path::{Path, PathBuf};

/// Why there is no pipeline for a folder.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum InitError {
    #[error("{}: {why} (a folder with recordings is needed)", path.display())]
    Unreadable { path: PathBuf, why: std::io::Error },
    #[error("{}: {what}; photographs of nails, videos with a marker file, logs of photodiodes (time_s, P1, ..) or \
             tables of angles are looked for", path.display())]
    Nothing { path: PathBuf, what: String },
}

/// Writes a pipeline for what lies in `folder`; `from` is that folder as the pipeline file will name it, with `/`,
/// empty for its own.
pub fn propose(folder: &Path, from: &str) -> Result<Proposal, InitError> {
    let found = look::look(folder).map_err(|why| InitError::Unreadable { path: folder.to_owned(), why })?;
    write::pipeline(&found, from).ok_or_else(|| {
        let what = if found.all.is_empty() {
            "holds no files".to_owned()
        } else {
            format!("nothing that is known among {} file(s)", found.all.len())
        };
        let missed = write::passed_over(&found).into_iter().filter(|(_, is_missed)| *is_missed);
        let what = missed.fold(what, |what, (said, _)| format!("{what}; {said}"));
        InitError::Nothing { path: folder.to_owned(), what }
    })
}
