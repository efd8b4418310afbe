//! Files in the making, and their way to their places: all, or none.

use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use super::hidden::{self, BEFORE, Hidden, PLACE};
use super::{WriteError, disk, folder_of, is_same_file, note_placed, pictures_beside};

/// A folder of results in the making.
#[derive(Debug)]
pub struct Staging {
    target: PathBuf,
    /// Folders that did not stand before, to be removed again where nothing is written; outermost first.
    created: Vec<PathBuf>,
    /// None once it is given away.
    hidden: Option<Hidden>,
    at: PathBuf,
    names: Mutex<Vec<PathBuf>>,
}

impl Staging {
    /// Starts results for `target`, which is created where it is missing. What a killed run left there is cleared.
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
        let made = fs::create_dir_all(target).and_then(|()| {
            if !hidden::is_private(target) {
                hidden::clear(target);
            }
            Hidden::within(target)
        });
        match made {
            Ok(hidden) => {
                let at = hidden.path().to_owned();
                Ok(Self { target: target.to_owned(), created, hidden: Some(hidden), at, names: Mutex::default() })
            }
            Err(why) => {
                remove_folders(&created);
                Err(refused(match why.kind() {
                    io::ErrorKind::AlreadyExists if target.is_file() => {
                        io::Error::other("it is a file, and results need a folder")
                    }
                    io::ErrorKind::AlreadyExists => io::Error::other("it is a link to nothing"),
                    _ => why,
                }))
            }
        }
    }

    /// The hidden folder that the results are made in.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.at
    }

    /// The folder that the results are for.
    #[must_use]
    pub fn target(&self) -> &Path {
        &self.target
    }

    /// Where to write the result `name` (relative, with `/`) now; its folder exists.
    ///
    /// # Errors
    /// [`WriteError::File`] where the folder can't be made.
    pub fn place(&self, name: &str) -> Result<PathBuf, WriteError> {
        let path = self.at.join(name);
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder).map_err(|why| self.refused(name, why))?;
        }
        let mut names = self.names.lock().unwrap_or_else(PoisonError::into_inner);
        names.push(PathBuf::from(name));
        Ok(path)
    }

    /// Writes the result `name`.
    ///
    /// # Errors
    /// [`WriteError::File`].
    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<(), WriteError> {
        disk::write(&self.place(name)?, bytes).map_err(|why| self.refused(name, why))
    }

    /// Draws the picture `name`, PNG and SVG; returns where the PNG will be.
    ///
    /// # Errors
    /// As [`Staging::place`], and where it can't be drawn.
    pub fn draw(
        &self,
        name: &str,
        draw: impl FnOnce(&Path, &Path) -> anyhow::Result<()>,
    ) -> Result<PathBuf, WriteError> {
        let [png, svg] = ["png", "svg"].map(|ending| format!("{name}.{ending}"));
        draw(&self.place(&png)?, &self.place(&svg)?).map_err(|why| self.refused(&png, format!("{why:#}")))?;
        Ok(self.target.join(png))
    }

    /// A result written so far.
    ///
    /// # Errors
    /// [`WriteError::File`] where there is none of this name.
    pub fn read(&self, name: &str) -> Result<Vec<u8>, WriteError> {
        fs::read(self.at.join(name)).map_err(|why| self.refused(name, why))
    }

    /// Starts to bring onto the disk what is written so far, and does other work meanwhile: of a commit little is left
    /// to wait for then. What fails here fails there again, and is reported there.
    pub(crate) fn sync_meanwhile<T>(&self, work: impl FnOnce() -> T) -> T {
        std::thread::scope(|scope| {
            if !hidden::is_private(&self.target) {
                let files: Vec<PathBuf> = self.names().iter().map(|name| self.at.join(name)).collect();
                // Its own thread: it waits, and takes no worker's place.
                scope.spawn(move || disk::sync(files.iter(), &self.at));
            }
            work()
        })
    }

    /// The error of a writer that could not write `name`.
    pub fn refused(&self, name: &str, why: impl ToString) -> WriteError {
        WriteError::File { path: self.target.join(name), why: why.to_string() }
    }

    /// Files that are in the folders that results will go to and are none of them: an earlier run's. Sorted. `may`
    /// names the files and folders of results that a run with other options writes.
    pub fn left_from_earlier(&self, may: &[&str]) -> Vec<PathBuf> {
        let names = self.names.lock().unwrap_or_else(PoisonError::into_inner);
        let may = may.iter().map(Path::new);
        let of_results = names.iter().filter_map(|n| n.parent()).filter(|f| !f.as_os_str().is_empty());
        let folders: BTreeSet<&Path> = of_results.chain(may.clone()).collect();
        let written: BTreeSet<&Path> = names.iter().map(PathBuf::as_path).collect();
        let mut left: Vec<PathBuf> = folders
            .into_iter()
            .flat_map(|folder| fs::read_dir(self.target.join(folder)).into_iter().flatten().flatten())
            .map(|entry| entry.path())
            .chain(may.map(|name| self.target.join(name)))
            .filter(|path| path.is_file())
            .filter(|path| path.strip_prefix(&self.target).is_ok_and(|name| !written.contains(name)))
            .collect();
        left.sort();
        left
    }

    /// Puts every result into its place; returns their names, sorted.
    ///
    /// # Errors
    /// [`WriteError`]; all is as it was before, unless it is [`WriteError::Half`].
    pub fn commit(self) -> Result<Vec<String>, WriteError> {
        let names = self.names();
        commit(vec![self], None)?;
        Ok(names.iter().map(|name| name.to_string_lossy().into_owned()).collect())
    }

    /// Puts these results into their places together with others elsewhere: all, or none.
    ///
    /// # Errors
    /// As [`Staging::commit`].
    pub fn commit_with(self, mut others: Places) -> Result<(), WriteError> {
        let others = std::mem::take(&mut others.folders).into_iter().map(|(_, staging)| staging);
        commit(std::iter::once(self).chain(others).collect(), None)
    }

    /// Puts the files and folders `names` of [`Staging::path`] into their places, in this order. They take the places
    /// of whatever stands there; of a name that is not in the hidden folder, what stands in its place goes.
    ///
    /// # Errors
    /// As [`Staging::commit`].
    pub fn commit_exactly(self, names: &[&str]) -> Result<(), WriteError> {
        commit(vec![self], Some(names))
    }

    fn names(&self) -> Vec<PathBuf> {
        let mut names = self.names.lock().unwrap_or_else(PoisonError::into_inner).clone();
        names.sort();
        names
    }
}

impl Drop for Staging {
    fn drop(&mut self) {
        // Best effort: what can't be removed is a hidden folder, which the next run removes.
        drop(self.hidden.take());
        remove_folders(&self.created);
    }
}

/// Removes those that are empty.
fn remove_folders(folders: &[PathBuf]) {
    for folder in folders.iter().rev() {
        let _ = fs::remove_dir(folder);
    }
}

/// Something on its way to its place.
struct Entry {
    staged: PathBuf,
    place: PathBuf,
    /// The place, relative to the results' folder.
    name: PathBuf,
    /// Where what stands in the place is kept meanwhile.
    aside: PathBuf,
    /// Whether it may be missing: then what stands in its place goes.
    may_lack: bool,
}

/// What was done, to be undone.
enum Step {
    Folder(PathBuf),
    /// Nothing stood in the place.
    New {
        staged: PathBuf,
        place: PathBuf,
    },
    /// What stood there is kept aside, under a second name or renamed.
    Aside {
        aside: PathBuf,
        place: PathBuf,
    },
}

impl Step {
    fn undo(&self) -> Result<(), PathBuf> {
        match self {
            // Only where nothing else came into it.
            Self::Folder(folder) => {
                let _ = fs::remove_dir(folder);
                Ok(())
            }
            Self::New { staged, place } => disk::rename(place, staged).map_err(|_| place.clone()),
            Self::Aside { aside, place } => disk::rename(aside, place).map_err(|_| place.clone()),
        }
    }
}

/// Puts everything into its place, or nothing; `exactly` these where it is given.
fn commit(stagings: Vec<Staging>, exactly: Option<&[&str]>) -> Result<(), WriteError> {
    let mut entries = Vec::new();
    for staging in &stagings {
        let names = exactly.map_or_else(|| staging.names(), |names| names.iter().map(PathBuf::from).collect());
        let before = staging.at.join(BEFORE);
        entries.extend(names.into_iter().enumerate().map(|(k, name)| Entry {
            staged: staging.at.join(&name),
            place: staging.target.join(&name),
            aside: before.join(k.to_string()),
            may_lack: exactly.is_some(),
            name,
        }));
    }
    if let Some(entry) = entries.iter().find(|entry| exactly.is_none() && entry.place.is_dir()) {
        return Err(WriteError::FolderInTheWay(entry.place.clone()));
    }
    let mut steps = Vec::new();
    let placed = sync_staged(&stagings, &entries)
        .and_then(|()| entries.iter().try_for_each(|entry| put(entry, &mut steps)))
        .and_then(|()| sync_places(&stagings, &entries));
    let Err((path, why)) = placed else {
        for mut staging in stagings {
            staging.created.clear();
            note_placed(&staging.target);
        }
        return Ok(());
    };
    let changed: Vec<PathBuf> = steps.iter().rev().filter_map(|step| step.undo().err()).collect();
    if changed.is_empty() {
        // The last first: a folder that was made for one result may lie in one that was made for another before.
        stagings.into_iter().rev().for_each(drop);
        return Err(WriteError::File { path, why: why.to_string() });
    }
    let mut kept = Vec::new();
    for mut staging in stagings {
        note_placed(&staging.target);
        kept.extend(staging.hidden.take().map(Hidden::keep));
    }
    Err(WriteError::Half { path, why: why.to_string(), changed, kept })
}

type At<T> = Result<T, (PathBuf, io::Error)>;

/// All that was made is on the disk before the first of it gets its name.
fn sync_staged(stagings: &[Staging], entries: &[Entry]) -> At<()> {
    for staging in stagings.iter().filter(|staging| !hidden::is_private(&staging.target)) {
        let mut files = Vec::new();
        for entry in entries.iter().filter(|entry| entry.staged.starts_with(&staging.at)) {
            let failed = |why| (entry.place.clone(), why);
            match fs::symlink_metadata(&entry.staged) {
                Ok(found) if found.is_dir() => files_below(&entry.staged, &mut files).map_err(failed)?,
                Ok(found) if found.is_file() => files.push(entry.staged.clone()),
                _ => {}
            }
        }
        disk::sync(files.iter(), &staging.at).map_err(|why| (staging.target.clone(), why))?;
    }
    Ok(())
}

fn files_below(folder: &Path, files: &mut Vec<PathBuf>) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let kind = entry.file_type()?;
        if kind.is_dir() {
            files_below(&entry.path(), files)?;
        } else if kind.is_file() {
            files.push(entry.path());
        }
    }
    Ok(())
}

/// The new names are on the disk.
fn sync_places(stagings: &[Staging], entries: &[Entry]) -> At<()> {
    for staging in stagings.iter().filter(|staging| !hidden::is_private(&staging.target)) {
        let own = entries.iter().filter(|entry| entry.staged.starts_with(&staging.at));
        let folders: BTreeSet<PathBuf> = own.map(|entry| folder_of(&entry.place).to_owned()).collect();
        let standing: Vec<PathBuf> = folders.into_iter().filter(|folder| folder.is_dir()).collect();
        disk::sync(standing.iter(), &staging.target).map_err(|why| (staging.target.clone(), why))?;
    }
    Ok(())
}

/// Puts one into its place.
fn put(entry: &Entry, steps: &mut Vec<Step>) -> At<()> {
    let Entry { staged, place, name, aside, may_lack } = entry;
    let failed = |why| (place.clone(), why);
    let made = match fs::symlink_metadata(staged) {
        Err(why) if !may_lack => return Err(failed(why)),
        other => other.ok(),
    };
    let stands = fs::symlink_metadata(place).ok();
    if stands.is_some() {
        let before = folder_of(aside);
        if !before.exists() {
            disk::make_folder(before).map_err(failed)?;
        }
    } else if made.is_some() {
        make_folders(folder_of(place), steps)?;
    }
    let is_file = |found: &Option<fs::Metadata>| found.as_ref().is_some_and(|found| !found.is_dir());
    if is_file(&made) && is_file(&stands) && disk::link(place, aside).is_ok() {
        // The place is never empty.
        disk::rename(staged, place).map_err(failed)?;
        steps.push(Step::Aside { aside: aside.clone(), place: place.clone() });
        return Ok(());
    }
    if stands.is_some() {
        // For whoever clears after this process was killed.
        let mut note = aside.clone().into_os_string();
        note.push(PLACE);
        disk::write(Path::new(&note), name.to_string_lossy().as_bytes()).map_err(failed)?;
        disk::rename(place, aside).map_err(failed)?;
        steps.push(Step::Aside { aside: aside.clone(), place: place.clone() });
    }
    if made.is_some() {
        disk::rename(staged, place).map_err(failed)?;
        steps.push(Step::New { staged: staged.clone(), place: place.clone() });
    }
    Ok(())
}

fn make_folders(folder: &Path, steps: &mut Vec<Step>) -> At<()> {
    if folder.as_os_str().is_empty() || folder.is_dir() {
        return Ok(());
    }
    make_folders(folder_of(folder), steps)?;
    disk::make_folder(folder).map_err(|why| (folder.to_owned(), why))?;
    steps.push(Step::Folder(folder.to_owned()));
    Ok(())
}

/// Results whose places are named one by one, in whatever folders.
#[derive(Debug, Default)]
pub struct Places {
    folders: Vec<(PathBuf, Staging)>,
    asked: BTreeSet<PathBuf>,
    inputs: Vec<PathBuf>,
}

impl Places {
    /// Places that are never one of these inputs.
    #[must_use]
    pub fn not_over<P: AsRef<Path>>(inputs: impl IntoIterator<Item = P>) -> Self {
        let mut places = Self::default();
        places.inputs.extend(inputs.into_iter().map(|input| input.as_ref().to_owned()));
        places
    }

    /// Refuses a result that would replace an input, for a job to say so before its work begins.
    ///
    /// # Errors
    /// [`WriteError::Input`].
    pub fn check<P: AsRef<Path>>(&self, results: impl IntoIterator<Item = P>) -> Result<(), WriteError> {
        let replaces = |result: &P| self.inputs.iter().any(|input| is_same_file(input, result.as_ref()));
        match results.into_iter().find(replaces) {
            Some(result) => Err(WriteError::Input(result.as_ref().to_owned())),
            None => Ok(()),
        }
    }

    /// A folder where results live though this run may have nothing to write there: what killed runs left in it is
    /// cleared, as it is where something is written.
    pub fn look_after(&self, folder: &Path) {
        if !hidden::is_private(folder) {
            hidden::clear(folder);
        }
    }

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
        self.check([path])?;
        let folder = folder_of(path);
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
        disk::write(&at, text.as_bytes())
            .map_err(|why| WriteError::File { path: path.to_owned(), why: why.to_string() })
    }

    /// Draws a picture, PNG and SVG, named after `table`; returns where the PNG will be.
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
        commit(std::mem::take(&mut self.folders).into_iter().map(|(_, staging)| staging).collect(), None)
    }
}

impl Drop for Places {
    fn drop(&mut self) {
        // The last first: a folder that was made for one result may lie in one that was made for another before.
        while self.folders.pop().is_some() {}
    }
}

#[cfg(test)]
mod tests {
    use super::super::disk::faults;
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
        put(dir.path(), &[("mine.txt", "mine"), ("old.txt", "old")]);
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

    #[test]
    fn a_file_or_a_link_to_nothing_where_a_folder_has_to_be_is_named() {
        let dir = tempfile::tempdir().unwrap();
        let [file, link] = ["file", "link"].map(|name| dir.path().join(name));
        fs::write(&file, "mine").unwrap();
        std::os::unix::fs::symlink(dir.path().join("nothing"), &link).unwrap();
        let why = |target: &Path| Staging::new(target).map(drop).unwrap_err().to_string();
        assert!(why(&file).contains("it is a file") && why(&link).contains("a link to nothing"), "{}", why(&file));
        assert_eq!((fs::read_to_string(&file).unwrap(), names_in(dir.path()).len()), ("mine".to_owned(), 2));
    }

    /// Everything below a folder, with its contents.
    fn all_in(folder: &Path) -> Vec<(String, String)> {
        let mut files = Vec::new();
        files_below(folder, &mut files).unwrap();
        let mut all: Vec<(String, String)> = files
            .iter()
            .map(|path| (path.strip_prefix(folder).unwrap().display().to_string(), fs::read_to_string(path).unwrap()))
            .collect();
        all.sort();
        all
    }

    /// Results in two folders, old and new; `fail` is called before the commit.
    fn two_folders(root: &Path, fail: impl FnOnce()) -> Result<(), WriteError> {
        let staging = Staging::new(&root.join("out")).unwrap();
        for name in ["a.csv", "deep/er/b.csv", "c.csv", "d.csv"] {
            staging.write(name, b"new").unwrap();
        }
        let mut others = Places::default();
        for name in ["bids/sub/x.tsv", "bids/y.tsv"] {
            others.write(&root.join(name), "new").unwrap();
        }
        fail();
        staging.commit_with(others)
    }

    fn put(root: &Path, files: &[(&str, &str)]) {
        for (name, text) in files {
            fs::create_dir_all(root.join(name).parent().unwrap()).unwrap();
            fs::write(root.join(name), text).unwrap();
        }
    }

    fn stood(root: &Path) {
        put(root, &[("out/a.csv", "old"), ("out/c.csv", "old"), ("out/mine", "mine"), ("bids/y.tsv", "old")]);
    }

    #[test]
    fn whichever_call_fails_all_is_new_or_all_is_as_it_was() {
        let mut refused = 0;
        for after in 0.. {
            let dir = tempfile::tempdir().unwrap();
            stood(dir.path());
            let before = all_in(dir.path());
            let committed = two_folders(dir.path(), || faults::fail(after, 1));
            let failed = faults::end();
            match committed {
                Ok(()) => {
                    let now = all_in(dir.path());
                    assert_eq!(now.iter().filter(|(_, text)| text == "new").count(), 6, "{after}: {now:?}");
                    assert_eq!(now.len(), 7, "{after}: {now:?}");
                }
                Err(why) => {
                    refused += 1;
                    assert!(matches!(why, WriteError::File { .. }), "{after}: {why}");
                    assert_eq!(all_in(dir.path()), before, "{after}");
                    assert!(!dir.path().join("out/deep").exists() && !dir.path().join("bids/sub").exists(), "{after}");
                }
            }
            if !failed {
                break;
            }
        }
        assert!(refused >= 10, "{refused} calls failed");
    }

    #[test]
    fn where_nothing_can_be_put_back_it_says_what_was_replaced_and_keeps_it() {
        let mut half = 0;
        for after in 0..40 {
            let dir = tempfile::tempdir().unwrap();
            stood(dir.path());
            let committed = two_folders(dir.path(), || faults::fail(after, 1000));
            faults::end();
            let Err(WriteError::Half { changed, kept, .. }) = committed else { continue };
            half += 1;
            for path in &changed {
                assert!(!path.exists() || fs::read_to_string(path).unwrap() == "new", "{after}: {}", path.display());
            }
            let now = all_in(dir.path());
            let new = now.iter().filter(|(name, text)| text == "new" && !name.contains("lunula-")).count();
            assert!(new > 0 && new <= changed.len(), "{after}: {now:?} {changed:?}");
            assert!(kept.iter().all(|folder| folder.is_dir()), "{kept:?}");
            let old = now.iter().filter(|(_, text)| text == "old").count();
            assert!(old >= 3, "{after}: nothing is lost: {now:?}");
        }
        assert!(half >= 4, "{half}");
    }

    #[test]
    fn what_killed_runs_left_is_cleared_and_what_runs_is_not() {
        let dir = tempfile::tempdir().unwrap();
        let running = Staging::new(dir.path()).unwrap();
        running.write("slow.csv", b"x").unwrap();
        let writing = hidden::file_within(dir.path()).unwrap();
        // As a kill leaves them: there, and nobody's.
        let killed = dir.path().join(".lunula-killed");
        put(&killed, &[(".lock", ""), ("half.csv", "half")]);
        for (k, name, stands) in [("0", "taken", false), ("1", "replaced", true)] {
            put(&killed.join(BEFORE), &[(&format!("{k}/old"), name), (&format!("{k}{PLACE}"), name)]);
            if stands {
                fs::create_dir(dir.path().join(name)).unwrap();
            }
        }
        fs::write(dir.path().join(".lunula-file"), "half").unwrap();
        // Just being made.
        fs::create_dir(dir.path().join(".lunula-young")).unwrap();
        let next = Staging::new(dir.path()).unwrap();
        assert!(!killed.exists() && !dir.path().join(".lunula-file").exists());
        assert_eq!(fs::read_to_string(dir.path().join("taken/old")).unwrap(), "taken");
        assert_eq!(fs::read_dir(dir.path().join("replaced")).unwrap().count(), 0);
        assert!(dir.path().join(".lunula-young").exists() && writing.path().exists());
        drop((next, writing));
        running.commit().unwrap();
        assert_eq!(names_in(dir.path()), [".lunula-young", "replaced", "slow.csv", "taken"]);
    }

    #[test]
    fn folders_take_the_places_of_folders_and_what_is_no_longer_made_goes() {
        for after in 0.. {
            let dir = tempfile::tempdir().unwrap();
            put(dir.path(), &[("photos/a", "old"), ("truth/b", "old"), ("clock", "old")]);
            let before = all_in(dir.path());
            let staging = Staging::new(dir.path()).unwrap();
            put(staging.path(), &[("photos/n", "new"), ("truth/b", "new")]);
            faults::fail(after, 1);
            let committed = staging.commit_exactly(&["truth", "photos", "clock"]);
            if !faults::end() {
                committed.unwrap();
                let file = |name: &str, text: &str| (name.to_owned(), text.to_owned());
                assert_eq!(all_in(dir.path()), [file("photos/n", "new"), file("truth/b", "new")]);
                assert!(after > 6, "{after}");
                break;
            }
            assert!(committed.is_err(), "{after}");
            assert_eq!(all_in(dir.path()), before, "{after}");
        }
    }
}
