//! From a task's private folder to its place: whole, whenever the process is killed.
//!
//! A task at work has a folder with `files/`, what it makes, and at last `record.json`, what will be kept of it,
//! renamed into place whole. From then on the task counts as done: its files are renamed into `OUT/<task>/`, and the
//! record to the others as the last step. Killed between, the next run goes on where this one stopped ([`recover`]);
//! killed before, it removes the folder. Moving needs no room on the disk.
//!
//! What stands in the way and is not as this program left it was edited by hand: it is kept beside as `NAME.edited`.

use std::collections::HashMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::files::disk::{rename, sync};
use crate::files::{clear_leftovers, note_placed, write_whole};
use crate::pipeline::store::hashes::{ContentHash, FileFault, Hashes, files_in};
use crate::pipeline::store::record::{Output, Record};
use crate::pipeline::store::{Store, read_record};

/// Why results did not come to their place.
#[derive(Debug, Error)]
pub(in crate::pipeline) enum CommitFault {
    #[error("{}: cannot be written ({why})", .path.display())]
    Io { path: PathBuf, why: io::Error },
    #[error(
        "{}: is a folder that is none of the results, and a result of this name has to go there; move it away",
        .0.display()
    )]
    FolderInTheWay(PathBuf),
    #[error(
        "{}: is a file that is none of the results, and a folder of results has to go there; move it away",
        .0.display()
    )]
    FileInTheWay(PathBuf),
    #[error(transparent)]
    File(#[from] FileFault),
    #[error("the record of what the task made: {0}")]
    Record(String),
}

fn io_fault(path: &Path) -> impl FnOnce(io::Error) -> CommitFault + '_ {
    |why| CommitFault::Io { path: path.to_owned(), why }
}

/// Where a task puts its files while it works.
pub(in crate::pipeline) fn files(work: &Path) -> PathBuf {
    work.join("files")
}

/// What a task made, with what it holds, sorted by name.
pub(in crate::pipeline) fn outputs(work: &Path, hashes: &Hashes) -> Result<Vec<Output>, FileFault> {
    let folder = files(work);
    // A hidden folder that the job could not remove is no result.
    clear_leftovers(&folder);
    let output = |name: String| {
        let (sha256, size) = hashes.of_file(&folder.join(&name))?;
        Ok(Output { name, size, sha256 })
    };
    files_in(&folder)?.into_iter().map(output).collect()
}

/// Puts a task's files and its record into place; returns what a user should know.
pub(in crate::pipeline) fn commit(
    store: &Store,
    hashes: &Hashes,
    work: &Path,
    record: &Record,
) -> Result<Vec<String>, CommitFault> {
    let place = work.join("record.json");
    let text = serde_json::to_vec(record).map_err(|why| CommitFault::Record(why.to_string()))?;
    write_whole(&place, &text).map_err(|why| CommitFault::Record(why.to_string()))?;
    // On the disk before anything says that it is done.
    let folder = files(work);
    let made: Vec<PathBuf> = record.outputs.iter().map(|output| folder.join(&output.name)).chain([place]).collect();
    sync(made.iter(), work).map_err(io_fault(work))?;
    put(store, hashes, work, record)
}

/// Finishes what runs that were killed had made, and removes what they had not.
pub(in crate::pipeline) fn recover(store: &Store, hashes: &Hashes) -> io::Result<Vec<String>> {
    let mut notices = Vec::new();
    for entry in fs::read_dir(store.work())? {
        let work = entry?.path();
        if let Some(record) = read_record(&work.join("record.json")) {
            match put(store, hashes, &work, &record) {
                Ok(warnings) => notices.extend(warnings),
                Err(why) => notices.push(format!("{}: what an earlier run made was not put there: {why}", record.task)),
            }
        }
        let gone = if work.is_dir() { fs::remove_dir_all(&work) } else { fs::remove_file(&work) };
        if let Err(why) = gone {
            notices.push(format!("{}: what an earlier run left cannot be removed ({why})", work.display()));
        }
    }
    Ok(notices)
}

/// The second half of [`commit`]; done again it does nothing.
fn put(store: &Store, hashes: &Hashes, work: &Path, record: &Record) -> Result<Vec<String>, CommitFault> {
    note_placed(&store.out);
    let folder = store.folder(&record.task);
    let old = store.record(&record.task);
    let ours: HashMap<&str, ContentHash> =
        old.iter().flat_map(|old| &old.outputs).map(|output| (output.name.as_str(), output.sha256)).collect();
    let made: HashMap<&str, ContentHash> =
        record.outputs.iter().map(|output| (output.name.as_str(), output.sha256)).collect();
    let mut warnings = Vec::new();
    for (name, sha256) in &ours {
        if !made.contains_key(name) {
            warnings.extend(remove(hashes, &folder, name, *sha256)?);
        }
    }
    if !folder.exists() && files(work).exists() {
        let parent = folder.parent().unwrap_or(&store.out);
        fs::create_dir_all(parent).map_err(io_fault(parent))?;
        rename(&files(work), &folder).map_err(io_fault(&folder))?;
    }
    if folder.is_file() {
        return Err(CommitFault::FileInTheWay(folder));
    }
    fs::create_dir_all(&folder).map_err(io_fault(&folder))?;
    for output in &record.outputs {
        let from = files(work).join(&output.name);
        if fs::symlink_metadata(&from).is_err() {
            // It is in its place: a run that was killed had come so far.
            continue;
        }
        let to = folder.join(&output.name);
        warnings.extend(clear(hashes, &folder, &to, &[Some(output.sha256), ours.get(output.name.as_str()).copied()])?);
        rename(&from, &to).map_err(io_fault(&to))?;
    }
    let place = store.record_place(&record.task);
    rename(&work.join("record.json"), &place).map_err(io_fault(&place))?;
    store.forget_failure(&record.task);
    Ok(warnings)
}

/// Removes what a pipeline of before made, where a task of now needs its place, and its record.
pub(in crate::pipeline) fn retire(store: &Store, hashes: &Hashes, stray: &Record) -> Result<Vec<String>, CommitFault> {
    let folder = store.folder(&stray.task);
    let mut warnings = Vec::new();
    for output in &stray.outputs {
        warnings.extend(remove(hashes, &folder, &output.name, output.sha256)?);
    }
    // Only where nothing else is in it.
    let _ = fs::remove_dir(&folder);
    let record = store.record_place(&stray.task);
    fs::remove_file(&record).map_err(io_fault(&record))?;
    Ok(warnings)
}

/// Removes a result that is not made any more, unless somebody edited it.
fn remove(hashes: &Hashes, folder: &Path, name: &str, sha256: ContentHash) -> Result<Option<String>, CommitFault> {
    let path = folder.join(name);
    match hashes.of_file(&path) {
        Ok((found, _)) if found == sha256 => fs::remove_file(&path).map_err(io_fault(&path))?,
        Ok(_) => {
            return Ok(Some(format!("{}: is not made any more; it was edited by hand and is left", path.display())));
        }
        // Gone, or something else stands there.
        Err(_) => return Ok(None),
    }
    let mut above = path.parent();
    while let Some(inner) = above.filter(|inner| *inner != folder) {
        if fs::remove_dir(inner).is_err() {
            break;
        }
        above = inner.parent();
    }
    Ok(None)
}

/// Makes room for a result: what stands there and is not among `ours` is kept under another name.
fn clear(
    hashes: &Hashes,
    folder: &Path,
    to: &Path,
    ours: &[Option<ContentHash>],
) -> Result<Option<String>, CommitFault> {
    if let Some(parent) = to.parent().filter(|parent| *parent != folder) {
        let file = parent.ancestors().take_while(|above| *above != folder).find(|above| above.is_file());
        if let Some(file) = file {
            return Err(CommitFault::FileInTheWay(file.to_owned()));
        }
        fs::create_dir_all(parent).map_err(io_fault(parent))?;
    }
    let Ok(there) = fs::symlink_metadata(to) else { return Ok(None) };
    if there.is_dir() {
        // An empty one is nobody's.
        return match fs::remove_dir(to) {
            Ok(()) => Ok(None),
            Err(_) => Err(CommitFault::FolderInTheWay(to.to_owned())),
        };
    }
    let found = hashes.of_file(to).ok().map(|(found, _)| found);
    if found.is_some() && ours.contains(&found) {
        return Ok(None);
    }
    let kept = free_name(to);
    rename(to, &kept).map_err(io_fault(&kept))?;
    Ok(Some(format!(
        "{}: was edited by hand; it is kept as {}, and the result was made again",
        to.display(),
        kept.display()
    )))
}

/// `NAME.edited`, numbered where that stands.
fn free_name(of: &Path) -> PathBuf {
    let name = of.file_name().unwrap_or_default().to_string_lossy();
    let numbered =
        (1..).map(|k| of.with_file_name(if k == 1 { format!("{name}.edited") } else { format!("{name}.edited.{k}") }));
    let mut free = numbered.filter(|path| fs::symlink_metadata(path).is_err());
    free.next().unwrap_or_else(|| of.to_owned())
}

/// Whether a file is one that [`commit`] kept aside.
pub(in crate::pipeline) fn is_kept_aside(name: &str) -> bool {
    name.rsplit_once(".edited").is_some_and(|(_, number)| {
        number.is_empty()
            || number.strip_prefix('.').is_some_and(|digits| digits.bytes().all(|byte| byte.is_ascii_digit()))
    })
}
