//! Hidden folders and files beside results, in which these are made: `.lunula-*`, each locked by its maker.
//!
//! The lock is the process's: it is free as soon as that has ended, however it ended. So what a killed run left is
//! known from what another run is at work on, and the next run in that folder clears it. Where the file system knows no
//! locks, nothing is cleared.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;

use tempfile::{NamedTempFile, TempDir};

/// What their names begin with; that of synthetic recordings was another in earlier versions.
const PREFIX: &str = ".lunula-";
const PREFIXES: [&str; 2] = [PREFIX, ".phantom-"];
/// In a hidden folder: what is locked, and what stood in the results' places.
const LOCK: &str = ".lock";
pub(super) const BEFORE: &str = ".before";
/// A file there `N.place` names the place from which `N` was taken.
pub(super) const PLACE: &str = ".place";
/// A hidden folder without a lock is of an earlier version, or is being made: after so long it is nobody's (assumed).
const NOBODYS: Duration = Duration::from_secs(24 * 3600);
/// Attempts at a name that nobody takes for a leftover meanwhile.
const ATTEMPTS: usize = 20;

/// A hidden folder, locked; it is removed when this goes.
#[derive(Debug)]
pub(super) struct Hidden {
    // In this order: it is removed before the lock is free.
    folder: TempDir,
    _lock: File,
}

impl Hidden {
    pub(super) fn within(folder: &Path) -> io::Result<Self> {
        for _ in 0..ATTEMPTS {
            let folder = tempfile::Builder::new().prefix(PREFIX).tempdir_in(folder)?;
            let place = folder.path().join(LOCK);
            let file = OpenOptions::new().create(true).truncate(false).write(true).open(&place)?;
            if is_ours(&file, &place) {
                return Ok(Self { folder, _lock: file });
            }
        }
        Err(io::Error::other("another program takes its hidden folders away"))
    }

    pub(super) fn path(&self) -> &Path {
        self.folder.path()
    }

    /// Leaves the folder where it is, under a name that no run clears; returns it.
    pub(super) fn keep(self) -> PathBuf {
        let hidden = self.folder.keep();
        let name = hidden.file_name().unwrap_or_default().to_string_lossy();
        let seen = hidden.with_file_name(name.trim_start_matches('.').replace("lunula-", "lunula-before-"));
        match fs::rename(&hidden, &seen) {
            Ok(()) => seen,
            Err(_) => hidden,
        }
    }
}

/// A hidden file, locked.
pub(super) fn file_within(folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(PREFIX);
    // As any new file: a temporary one is its owner's alone.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    for _ in 0..ATTEMPTS {
        let file = builder.tempfile_in(folder)?;
        if is_ours(file.as_file(), file.path()) {
            return Ok(file);
        }
    }
    Err(io::Error::other("another program takes its hidden files away"))
}

/// Locks a file that was just made; not where somebody took it for a leftover between.
fn is_ours(file: &File, place: &Path) -> bool {
    match file.try_lock() {
        // Where there are no locks nobody can take it for a leftover.
        Ok(()) | Err(TryLockError::Error(_)) => place.exists(),
        Err(TryLockError::WouldBlock) => false,
    }
}

/// Whether a folder lies in a hidden one of ours, or in that of a pipeline: it is nobody's business but this run's,
/// which brings what it makes there onto the disk when it takes it out.
pub(super) fn is_private(folder: &Path) -> bool {
    folder.components().any(|part| part.as_os_str().to_string_lossy().starts_with(".lunula"))
}

/// Removes what killed runs left in `folder`. What they had taken from its place, to put theirs there, goes back where
/// that is free.
///
/// What can't be removed now, the next run tries again.
pub fn clear(folder: &Path) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        if !PREFIXES.iter().any(|prefix| entry.file_name().to_string_lossy().starts_with(prefix)) {
            continue;
        }
        let path = entry.path();
        let is_folder = entry.file_type().is_ok_and(|kind| kind.is_dir());
        let lock = if is_folder { path.join(LOCK) } else { path.clone() };
        let held = match OpenOptions::new().write(true).open(&lock) {
            Ok(file) => file.try_lock().is_ok().then_some(Some(file)),
            Err(why) if why.kind() == io::ErrorKind::NotFound => is_old(&path).then_some(None),
            Err(_) => None,
        };
        // Bound, so that the lock is held until it is gone.
        let Some(_lock) = held else { continue };
        if is_folder {
            put_back(&path.join(BEFORE), folder);
            let _ = fs::remove_dir_all(&path);
        } else {
            let _ = fs::remove_file(&path);
        }
    }
}

fn is_old(path: &Path) -> bool {
    let modified = fs::metadata(path).and_then(|data| data.modified());
    modified.is_ok_and(|at| at.elapsed().is_ok_and(|age| age > NOBODYS))
}

fn put_back(before: &Path, folder: &Path) {
    for entry in fs::read_dir(before).into_iter().flatten().flatten() {
        let (note, name) = (entry.path(), entry.file_name());
        let Some(number) = name.to_str().and_then(|name| name.strip_suffix(PLACE)) else { continue };
        let Ok(place) = fs::read_to_string(&note) else { continue };
        let place = folder.join(place);
        if fs::symlink_metadata(&place).is_err() {
            let _ = fs::rename(before.join(number), place);
        }
    }
}
