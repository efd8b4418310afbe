//! Detected outlines saved as LabelMe files for a person to correct; the next run uses the corrected ones.
//!
//! Beside each photograph (`<stem>.json`), or in a folder of their own with a `photos.csv` that ties them to the photographs:
//! that folder is then the set of the next run. A file that stands is never overwritten: it may be a person's work.
//! Outlines that are not trusted are labelled `nail?`, which no run reads until somebody relabels them.

use std::path::{Path, PathBuf};

use super::job::DetectedOutline;
use super::outline::to_file;
use super::set::{Photo, PhotoSet};
use crate::files::{WriteError, write_whole};

/// What was saved.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Kept {
    /// New LabelMe files.
    pub written: Vec<PathBuf>,
    /// Files that stood and stay as they are.
    pub stood: Vec<PathBuf>,
}

/// Saves detected outlines of the photographs of `set`, in `folder` or beside them.
///
/// # Errors
/// [`WriteError`] where a file can't be written.
pub fn keep_outlines(detected: &[DetectedOutline], set: &PhotoSet, folder: Option<&Path>) -> Result<Kept, WriteError> {
    let mut kept = Kept::default();
    for detected in detected {
        let photo = &set.photos[detected.photo];
        let path = place(photo, folder);
        if path.exists() {
            kept.stood.push(path);
            continue;
        }
        if let Some(parent) = path.parent() {
            std::fs::create_dir_all(parent).map_err(|why| WriteError::Folder { path: parent.to_owned(), why })?;
        }
        let file = to_file(&relative(&photo.path, path.parent()), detected.size, &detected.nails);
        let text = file.to_text().map_err(|why| WriteError::File { path: path.clone(), why: why.to_string() })?;
        write_whole(&path, &text)?;
        kept.written.push(path);
    }
    if let Some(folder) = folder {
        write_manifest(set, folder)?;
    }
    Ok(kept)
}

fn place(photo: &Photo, folder: Option<&Path>) -> PathBuf {
    match folder {
        Some(folder) => folder.join(&photo.pose).join(format!("{}.json", photo.subject)),
        None => photo.path.with_extension("json"),
    }
}

/// `photos.csv` of every photograph of the set, so that the folder can be the next run's set.
fn write_manifest(set: &PhotoSet, folder: &Path) -> Result<(), WriteError> {
    let path = folder.join("photos.csv");
    let refused = |why: String| WriteError::File { path: path.clone(), why };
    std::fs::create_dir_all(folder).map_err(|why| WriteError::Folder { path: folder.to_owned(), why })?;
    let mut table = csv::Writer::from_writer(Vec::new());
    table.write_record(["file", "subject", "pose", "outline"]).map_err(|e| refused(e.to_string()))?;
    for photo in &set.photos {
        let outline =
            [Some(place(photo, Some(folder))), photo.outline.clone(), Some(photo.path.with_extension("json"))]
                .into_iter()
                .flatten()
                .find(|path| path.is_file());
        let outline = outline.map_or_else(String::new, |path| relative(&path, Some(folder)));
        let file = relative(&photo.path, Some(folder));
        table.write_record([&file, &photo.subject, &photo.pose, &outline]).map_err(|e| refused(e.to_string()))?;
    }
    write_whole(&path, &table.into_inner().map_err(|e| refused(e.to_string()))?)
}

/// `path` as seen from `folder`, both made absolute first; as it is where that can't be told.
fn relative(path: &Path, folder: Option<&Path>) -> String {
    let seen = folder.and_then(|folder| pathdiff::diff_paths(path.canonicalize().ok()?, folder.canonicalize().ok()?));
    seen.unwrap_or_else(|| path.to_owned()).to_string_lossy().into_owned()
}
