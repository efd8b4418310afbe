//! What others wrote into a folder stays.

use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

/// Synthetic photographs, whose `truth` is a folder of theirs alone.
pub(in crate::phantom) const PHOTOS_RECORD: &str = "truth/phantom.json";

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
