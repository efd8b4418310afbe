//! Where a scene is written: what others wrote into a folder stays.

use std::io;
use std::path::{Path, PathBuf};

use serde::Serialize;
use thiserror::Error;

use crate::files::{Staging, WriteError};
use crate::job::Interrupted;
use crate::labelme;
use crate::phantom::nail::SceneFault;
use crate::phantom::scene::faults::Faults;
use crate::table::TableError;
use crate::video::VideoError;

/// Synthetic photographs, whose `truth` is a folder of theirs alone.
pub(in crate::phantom) const PHOTOS_RECORD: &str = "truth/phantom.json";

/// Why a scene was not written.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum Error {
    #[error(transparent)]
    Options(#[from] Faults),
    #[error(transparent)]
    Scene(#[from] SceneFault),
    #[error("{} stands already and is not {whose}; choose another --out", place.display())]
    InTheWay {
        place: PathBuf,
        /// Whose it would have to be.
        whose: &'static str,
    },
    #[error(transparent)]
    Write(#[from] Unwritten),
    #[error(transparent)]
    Place(#[from] WriteError),
    #[error(transparent)]
    Table(#[from] TableError),
    #[error("{}: cannot be encoded: {source}", path.display())]
    Encode { path: PathBuf, source: image::ImageError },
    #[error(transparent)]
    Annotation(#[from] labelme::Error),
    #[error(transparent)]
    Video(#[from] VideoError),
    /// Stopped from outside; nothing was left behind.
    #[error("stopped")]
    Interrupted(#[from] Interrupted),
    /// Of what other crates generate.
    #[error(transparent)]
    Other(#[from] anyhow::Error),
}

/// A file or folder that could not be written.
#[derive(Debug, Error)]
#[error("{}: cannot be written: {source}", path.display())]
pub struct Unwritten {
    path: PathBuf,
    source: io::Error,
}

/// Says of an error that it is of this path.
pub fn refused(path: &Path) -> impl FnOnce(io::Error) -> Unwritten {
    let path = path.to_owned();
    move |source| Unwritten { path, source }
}

/// Writes a record as JSON.
pub fn write_record(path: &Path, record: &impl Serialize) -> Result<(), Unwritten> {
    let text = serde_json::to_vec_pretty(record).map_err(|why| refused(path)(why.into()))?;
    std::fs::write(path, text).map_err(refused(path))
}

/// Whether a record leaves a choice out, as before there was one.
pub(in crate::phantom) fn is_default<C: Default + PartialEq>(choice: &C) -> bool {
    *choice == C::default()
}

/// A hidden folder beside `out` for `names`, with its `truth`, unless some of them are there and not `whose`: as
/// [`in_the_way`].
///
/// # Errors
/// [`Error::InTheWay`], or the folder can't be made.
pub fn staged(out: &Path, names: &[&str], record: &str, whose: &'static str) -> Result<Staging, Error> {
    let staging = Staging::new(out)?;
    if let Some(place) = in_the_way(out, names, record) {
        return Err(Error::InTheWay { place, whose });
    }
    let truth = staging.path().join("truth");
    std::fs::create_dir(&truth).map_err(refused(&truth))?;
    Ok(staging)
}

/// What stands under `out`, is one of `names`, and was not written by whoever writes `record`; or belongs to
/// photographs.
pub fn in_the_way(out: &Path, names: &[&str], record: &str) -> Option<PathBuf> {
    let photographs = Some(out.join(PHOTOS_RECORD)).filter(|place| record != PHOTOS_RECORD && place.exists());
    let stands = || names.iter().map(|name| out.join(name)).find(|place| place.exists());
    photographs.or_else(|| if out.join(record).is_file() { None } else { stands() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_own_files_are_not_in_the_way() {
        let dir = tempfile::tempdir().unwrap();
        std::fs::create_dir_all(dir.path().join("truth")).unwrap();
        std::fs::write(dir.path().join("truth/a"), "").unwrap();
        let names = ["truth/record", "truth/a"];
        assert_eq!(in_the_way(dir.path(), &names, "truth/record"), Some(dir.path().join("truth/a")));
        assert_eq!(in_the_way(dir.path(), &names, "truth/a"), None);
        assert_eq!(in_the_way(dir.path(), &["b"], "truth/record"), None);
    }
}
