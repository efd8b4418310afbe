//! Results appear whole or not at all.
//!
//! Everything that a job writes goes into a hidden folder beside its place, on the same disk; when the job is done, each file
//! is renamed to where it belongs, one rename a file, so that nobody ever sees half of one. A job that fails or is
//! interrupted leaves what stood there before as it was.

use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use tempfile::TempDir;
use thiserror::Error;

/// Why results can't be written.
#[derive(Debug, Error)]
pub enum WriteError {
    /// The folder for the results.
    #[error("{}: cannot be written to ({why}); choose another --out or make room and permission for it", .path.display())]
    Folder {
        /// Which folder.
        path: PathBuf,
        /// The system's words.
        why: io::Error,
    },
    /// One file of the results.
    #[error("{}: cannot be written ({why}); nothing there was changed", .path.display())]
    File {
        /// Where it would have gone.
        path: PathBuf,
        /// The system's or the encoder's words.
        why: String,
    },
    /// A folder stands where a file has to go.
    #[error("{}: is a folder, and a result of this name has to go there; move it or choose another --out", .0.display())]
    FolderInTheWay(PathBuf),
}

/// A folder of results in the making.
#[derive(Debug)]
pub struct Staging {
    target: PathBuf,
    /// Folders that did not stand before, to be removed again where nothing is written; outermost first.
    created: Vec<PathBuf>,
    held: TempDir,
    names: Mutex<Vec<PathBuf>>,
    committed: bool,
}

impl Staging {
    /// Starts results for `target`, which is created where it is missing.
    ///
    /// # Errors
    /// [`WriteError::Folder`] where it can't be created or written to.
    pub fn new(target: &Path) -> Result<Self, WriteError> {
        let refused = |why| WriteError::Folder { path: target.to_owned(), why };
        let mut created = Vec::new();
        let mut missing = target;
        while !missing.as_os_str().is_empty() && !missing.exists() {
            created.insert(0, missing.to_owned());
            let Some(parent) = missing.parent() else { break };
            missing = parent;
        }
        fs::create_dir_all(target).map_err(refused)?;
        let held = tempfile::Builder::new().prefix(".lunula-").tempdir_in(target).map_err(refused)?;
        Ok(Self { target: target.to_owned(), created, held, names: Mutex::new(Vec::new()), committed: false })
    }

    /// Where to write the result `name` (relative, with `/`) now; its folder exists.
    ///
    /// # Errors
    /// [`WriteError::File`] where the folder can't be made.
    pub fn place(&self, name: &str) -> Result<PathBuf, WriteError> {
        let path = self.held.path().join(name);
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder).map_err(|why| self.refused(name, why))?;
        }
        let mut names = self.names.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        names.push(PathBuf::from(name));
        Ok(path)
    }

    /// Writes the result `name`.
    ///
    /// # Errors
    /// [`WriteError::File`].
    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<(), WriteError> {
        fs::write(self.place(name)?, bytes).map_err(|why| self.refused(name, why))
    }

    /// A result written so far.
    ///
    /// # Errors
    /// [`WriteError::File`] where there is none of this name.
    pub fn read(&self, name: &str) -> Result<Vec<u8>, WriteError> {
        fs::read(self.held.path().join(name)).map_err(|why| self.refused(name, why))
    }

    /// The error of a writer that could not write `name`.
    pub fn refused(&self, name: &str, why: impl ToString) -> WriteError {
        WriteError::File { path: self.target.join(name), why: why.to_string() }
    }

    /// Files that stand in the folders that results will go to and are none of them: an earlier run's. Sorted.
    pub fn left_from_earlier(&self) -> Vec<String> {
        let names = self.names.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let folders: BTreeSet<&Path> =
            names.iter().filter_map(|n| n.parent()).filter(|f| !f.as_os_str().is_empty()).collect();
        let written: BTreeSet<&Path> = names.iter().map(PathBuf::as_path).collect();
        let mut left: Vec<String> = folders
            .into_iter()
            .flat_map(|folder| fs::read_dir(self.target.join(folder)).into_iter().flatten().flatten())
            .filter(|entry| entry.path().is_file())
            .filter_map(|entry| entry.path().strip_prefix(&self.target).map(Path::to_owned).ok())
            .filter(|name| !written.contains(name.as_path()))
            .map(|name| name.to_string_lossy().into_owned())
            .collect();
        left.sort();
        left
    }

    /// Puts every result into its place; returns their names, sorted.
    ///
    /// # Errors
    /// Where a folder is in a file's way, nothing has been moved; a rename that fails after that names its file.
    pub fn commit(mut self) -> Result<Vec<String>, WriteError> {
        let mut names = std::mem::take(self.names.get_mut().unwrap_or_else(std::sync::PoisonError::into_inner));
        names.sort();
        for name in &names {
            let to = self.target.join(name);
            if to.is_dir() {
                return Err(WriteError::FolderInTheWay(to));
            }
            if let Some(folder) = to.parent() {
                fs::create_dir_all(folder).map_err(|why| WriteError::Folder { path: folder.to_owned(), why })?;
            }
        }
        for name in &names {
            let to = self.target.join(name);
            fs::rename(self.held.path().join(name), &to)
                .map_err(|why| WriteError::File { path: to, why: why.to_string() })?;
        }
        self.committed = true;
        Ok(names.iter().map(|n| n.to_string_lossy().into_owned()).collect())
    }
}

impl Drop for Staging {
    fn drop(&mut self) {
        if !self.committed {
            // Best effort: what can't be removed is an empty hidden folder.
            let _ = fs::remove_dir_all(self.held.path());
            for folder in self.created.iter().rev() {
                let _ = fs::remove_dir(folder);
            }
        }
    }
}

/// Results whose places are named one by one, in whatever folders.
#[derive(Debug, Default)]
pub struct Places {
    folders: Vec<(PathBuf, Staging)>,
    asked: BTreeSet<PathBuf>,
}

impl Places {
    /// Where to write the result that is to stand at `path`.
    ///
    /// # Errors
    /// [`WriteError`] where its folder can't be written to, a folder has its name, or it was asked for before.
    pub fn place(&mut self, path: &Path) -> Result<PathBuf, WriteError> {
        let refused = |why: &str| WriteError::File { path: path.to_owned(), why: why.to_owned() };
        let name = path.file_name().and_then(|name| name.to_str()).ok_or_else(|| refused("it is no file's name"))?;
        if path.is_dir() {
            return Err(WriteError::FolderInTheWay(path.to_owned()));
        }
        let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let at = match self.folders.iter().position(|(known, _)| known == folder) {
            Some(at) => at,
            None => {
                self.folders.push((folder.to_owned(), Staging::new(folder)?));
                self.folders.len() - 1
            }
        };
        let real = fs::canonicalize(folder).unwrap_or_else(|_| folder.to_owned()).join(name);
        if !self.asked.insert(real) {
            return Err(refused("two results have this name"));
        }
        self.folders[at].1.place(name)
    }

    /// Writes the result that is to stand at `path`.
    ///
    /// # Errors
    /// As [`Places::place`], and where it can't be written.
    pub fn write(&mut self, path: &Path, text: &str) -> Result<(), WriteError> {
        let at = self.place(path)?;
        fs::write(at, text).map_err(|why| WriteError::File { path: path.to_owned(), why: why.to_string() })
    }

    /// Draws a picture, PNG and SVG, named after `table`; tells where the PNG will stand.
    ///
    /// # Errors
    /// As [`Places::place`], and where it can't be drawn.
    pub fn draw(
        &mut self,
        table: &Path,
        name: &str,
        draw: impl FnOnce(&Path, &Path) -> anyhow::Result<()>,
    ) -> Result<PathBuf, WriteError> {
        let [png, svg] = pictures_beside(table, name);
        draw(&self.place(&png)?, &self.place(&svg)?)
            .map_err(|why| WriteError::File { path: png.clone(), why: format!("{why:#}") })?;
        Ok(png)
    }

    /// Puts every result into its place.
    ///
    /// # Errors
    /// As [`Staging::commit`].
    pub fn commit(mut self) -> Result<(), WriteError> {
        std::mem::take(&mut self.folders).into_iter().try_for_each(|(_, staging)| staging.commit().map(|_| ()))
    }
}

impl Drop for Places {
    fn drop(&mut self) {
        // The last first: a folder that was made for one result may lie in one that was made for another before.
        while self.folders.pop().is_some() {}
    }
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
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut builder = tempfile::Builder::new();
    builder.prefix(".lunula-");
    // As any new file: a temporary one is its owner's alone.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut file = builder.tempfile_in(folder).map_err(refused)?;
    io::Write::write_all(&mut file, bytes).map_err(refused)?;
    file.persist(path).map_err(|e| refused(e.error))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names_in(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> =
            fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn results_appear_at_the_commit_and_replace_only_their_own() {
        let dir = tempfile::tempdir().unwrap();
        fs::write(dir.path().join("mine.txt"), "mine").unwrap();
        fs::write(dir.path().join("old.txt"), "old").unwrap();
        let staging = Staging::new(dir.path()).unwrap();
        staging.write("old.txt", b"new").unwrap();
        staging.write("deep/er.txt", b"deep").unwrap();
        assert_eq!(fs::read(dir.path().join("old.txt")).unwrap(), b"old");
        assert_eq!(staging.commit().unwrap(), ["deep/er.txt", "old.txt"]);
        assert_eq!(names_in(dir.path()), ["deep", "mine.txt", "old.txt"]);
        assert_eq!(fs::read(dir.path().join("old.txt")).unwrap(), b"new");
    }

    #[test]
    fn a_dropped_job_leaves_no_trace() {
        let dir = tempfile::tempdir().unwrap();
        let target = dir.path().join("a/b");
        let staging = Staging::new(&target).unwrap();
        staging.write("x.txt", b"x").unwrap();
        drop(staging);
        assert!(names_in(dir.path()).is_empty());
    }

    #[test]
    fn results_of_several_folders_appear_together_and_none_twice() {
        let dir = tempfile::tempdir().unwrap();
        let (first, second) = (dir.path().join("a/x.csv"), dir.path().join("b/x.csv"));
        let mut places = Places::default();
        for path in [&first, &second] {
            fs::write(places.place(path).unwrap(), "x").unwrap();
        }
        let again = dir.path().join("b/../a/x.csv");
        assert!(places.place(&again).unwrap_err().to_string().contains("two results"));
        assert!(matches!(places.place(dir.path()), Err(WriteError::FolderInTheWay(_))));
        assert!(!first.exists() && !second.exists());
        places.commit().unwrap();
        assert_eq!(
            (names_in(&dir.path().join("a")), names_in(&dir.path().join("b"))),
            (vec!["x.csv".into()], vec!["x.csv".into()])
        );
    }

    #[test]
    fn a_folder_in_the_way_stops_everything() {
        let dir = tempfile::tempdir().unwrap();
        fs::create_dir(dir.path().join("b.txt")).unwrap();
        let staging = Staging::new(dir.path()).unwrap();
        staging.write("a.txt", b"a").unwrap();
        staging.write("b.txt", b"b").unwrap();
        assert!(matches!(staging.commit(), Err(WriteError::FolderInTheWay(path)) if path.ends_with("b.txt")));
        assert_eq!(names_in(dir.path()), ["b.txt"]);
    }
}
