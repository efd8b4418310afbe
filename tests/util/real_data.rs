//! Real recordings, which don't come with the repository.
//!
//! Tests that need them are in modules called `real_data` and ignored, so that a run without the recordings says how
//! many it left out; `make test` runs them where the recordings are.

use std::path::{Path, PathBuf};

/// A file or folder of the real recordings: under `$LUNULA_REAL_DATA`, or else `shared/data` beside the repository.
///
/// # Panics
/// Where it is missing: whoever runs an ignored test wants it run.
pub(crate) fn real_data(name: &str) -> PathBuf {
    let path = std::env::var_os("LUNULA_REAL_DATA").map_or_else(|| repository().join("../shared/data"), PathBuf::from);
    let path = path.join(name);
    assert!(path.exists(), "{} is missing: LUNULA_REAL_DATA names the folder of the real recordings", path.display());
    path
}

/// The folder of the lock file.
pub(crate) fn repository() -> &'static Path {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.ancestors().find(|folder| folder.join("Cargo.lock").is_file()).expect("a checkout")
}
