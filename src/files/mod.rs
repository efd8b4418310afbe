//! Results appear whole or not at all.
//!
//! Everything that a job writes goes into a hidden folder beside its place, on the same disk (`hidden`). When the job
//! is done and all of it is on the disk, each file is renamed to where it belongs, so that nobody ever sees half of one
//! (`staging`); where one can't be, those before it are put back. A job that fails or is interrupted leaves what stood
//! there before as it was; what one that was killed left is cleared by the next one in that folder.

pub(crate) mod disk;
mod hidden;
mod staging;

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use serde::Serialize;
use thiserror::Error;

pub use hidden::clear as clear_leftovers;
pub use staging::{Places, Staging};

/// A value as the text of a JSON file.
///
/// # Panics
/// Keys that are no text: results are plain data with names as keys.
pub(crate) fn json_text(value: &impl Serialize) -> String {
    serde_json::to_string_pretty(value).expect("plain data with names as keys") + "\n"
}

/// Why results can't be written.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum WriteError {
    #[error(
        "{}: cannot be written to ({why}); choose another --out or make room and permission for it",
        .path.display()
    )]
    Folder { path: PathBuf, why: io::Error },
    #[error("{}: cannot be written ({why}); nothing there was changed", .path.display())]
    File { path: PathBuf, why: String },
    /// Files that were replaced before one could not be, and that could not be put back.
    #[error(
        "{}: cannot be written ({why}), and what stood before could not be put back: {} changed; what was there is \
         kept in {}; make room and run again",
        .path.display(), listed(.changed), listed(.kept)
    )]
    Half {
        path: PathBuf,
        why: String,
        /// The places that are not as before.
        changed: Vec<PathBuf>,
        /// Folders with what stood there.
        kept: Vec<PathBuf>,
    },
    #[error("{}: is an input itself; choose another name for the result", .0.display())]
    Input(PathBuf),
    #[error(
        "{}: is a folder, and a result of this name has to go there; move it or choose another --out",
        .0.display()
    )]
    FolderInTheWay(PathBuf),
}

fn listed(paths: &[PathBuf]) -> String {
    paths.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(", ")
}

/// The folders into which this process put results.
static PLACED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Remembers that results were put into a folder.
pub(crate) fn note_placed(folder: &Path) {
    let mut placed = PLACED.lock().unwrap_or_else(PoisonError::into_inner);
    if !hidden::is_private(folder) && !placed.iter().any(|known| known == folder) {
        placed.push(folder.to_owned());
    }
}

/// Whether this process put results into a folder that stands: whatever fails after that, something was done. (Folders
/// for measuring and trying are gone when their job ends.)
#[must_use]
pub fn results_stand() -> bool {
    PLACED.lock().unwrap_or_else(PoisonError::into_inner).iter().any(|folder| folder.exists())
}

/// Whether both stand and are one file, whatever they are called.
#[must_use]
pub fn is_same_file(one: &Path, other: &Path) -> bool {
    let real = |path: &Path| fs::canonicalize(path).ok();
    real(one).is_some_and(|one| real(other) == Some(one))
}

/// The place of a result that stands beside `table` and is named after it: `joints.csv` and `.run.json` give
/// `joints.run.json`.
#[must_use]
pub fn beside(table: &Path, ending: &str) -> PathBuf {
    let stem = table.file_stem().unwrap_or_default().to_string_lossy();
    table.with_file_name(format!("{stem}{ending}"))
}

/// The places of a picture beside `table`, PNG and SVG: `joints.csv` and `angles` give `joints-angles.png` and `.svg`.
#[must_use]
pub fn pictures_beside(table: &Path, name: &str) -> [PathBuf; 2] {
    ["png", "svg"].map(|ending| beside(table, &format!("-{name}.{ending}")))
}

/// Writes one file whole or not at all: beside its place, then renamed.
///
/// # Errors
/// [`WriteError::File`].
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    let refused = |why: io::Error| WriteError::File { path: path.to_owned(), why: why.to_string() };
    let folder = folder_of(path);
    let mut file = hidden::file_within(folder).map_err(refused)?;
    file.write_all(bytes).map_err(refused)?;
    let is_private = hidden::is_private(folder);
    if !is_private {
        file.as_file().sync_all().map_err(refused)?;
    }
    disk::rename(file.path(), path).map_err(refused)?;
    // It has another name now: there is nothing to remove.
    let _ = file.into_temp_path().keep();
    if !is_private {
        // It is in its place; whether its name is on the disk is all that can be missing.
        let _ = disk::sync_one(folder);
    }
    note_placed(folder);
    Ok(())
}

/// Makes a file that grows in its place, and empties it where it is there and to be replaced. It is locked while it is
/// open: a second program can't write into it.
///
/// # Errors
/// It can't be made, is there and not to be replaced, or another program writes into it.
pub(crate) fn create_growing(path: &Path, replace: bool) -> io::Result<File> {
    fs::create_dir_all(folder_of(path))?;
    let mut options = OpenOptions::new();
    options.write(true).create(replace).create_new(!replace);
    let file = options.open(path)?;
    if is_taken(&file) {
        return Err(io::Error::other("another program is writing it"));
    }
    // A pipe or a device holds nothing.
    if file.metadata()?.is_file() {
        file.set_len(0)?;
    }
    Ok(file)
}

/// Whether another program writes into a file that grows. If not it is this one's until it is closed, where the file
/// system knows locks.
pub(crate) fn is_taken(file: &File) -> bool {
    let is_file = file.metadata().is_ok_and(|data| data.is_file());
    is_file && matches!(file.try_lock(), Err(TryLockError::WouldBlock))
}

/// The folder that a file stands in, or is to.
pub(crate) fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."))
}
