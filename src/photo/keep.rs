//! Detected outlines saved as LabelMe files for a person to correct; the next run uses the corrected ones.
//!
//! Beside each photograph (`<stem>.json`), or in a folder of their own with a `photos.csv` that ties them to the
//! photographs:
//! that folder is then the set of the next run. A file that stands is never overwritten: it may be a person's work.
//! Outlines that are not trusted are labelled `nail?`, which no run reads until somebody relabels them.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use super::job::DetectedOutline;
use super::outline::to_file;
use super::set::{Photo, PhotoSet};
use crate::files::{Places, WriteError};

/// What was saved.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Kept {
    /// New LabelMe files; they get to their places with the others.
    pub written: Vec<PathBuf>,
    /// Files that stood and stay as they are.
    pub stood: Vec<PathBuf>,
}

/// Saves detected outlines of the photographs of `set`, in `folder` or beside them, as far as `places`.
///
/// # Errors
/// [`WriteError`] where a file can't be written.
pub fn keep_outlines(
    detected: &[DetectedOutline],
    set: &PhotoSet,
    folder: Option<&Path>,
    places: &mut Places,
) -> Result<Kept, WriteError> {
    let mut kept = Kept::default();
    let mut new = BTreeSet::new();
    // Also where all outlines stand, or where none is detected any more because they do.
    let homes: BTreeSet<PathBuf> =
        set.photos.iter().filter_map(|photo| Some(place(photo, folder).parent()?.to_owned())).collect();
    homes.iter().for_each(|home| places.look_after(home));
    for detected in detected {
        let photo = &set.photos[detected.photo];
        let path = place(photo, folder);
        if path.exists() || !new.insert(path.clone()) {
            kept.stood.push(path);
            continue;
        }
        // Its folder is there from here on, and paths relative to it can be written.
        let at = places.place(&path)?;
        let file = to_file(&relative(&photo.path, path.parent()), detected.size, &detected.nails);
        let refused = |why: String| WriteError::File { path: path.clone(), why };
        let text = file.to_text().map_err(|why| refused(why.to_string()))?;
        std::fs::write(at, text).map_err(|why| refused(why.to_string()))?;
        kept.written.push(path);
    }
    if let Some(folder) = folder {
        write_manifest(set, folder, &new, places)?;
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
fn write_manifest(
    set: &PhotoSet,
    folder: &Path,
    new: &BTreeSet<PathBuf>,
    places: &mut Places,
) -> Result<(), WriteError> {
    let path = folder.join("photos.csv");
    let refused = |why: String| WriteError::File { path: path.clone(), why };
    let at = places.place(&path)?;
    let mut table = csv::Writer::from_writer(Vec::new());
    table.write_record(["file", "subject", "pose", "outline"]).map_err(|e| refused(e.to_string()))?;
    for photo in &set.photos {
        let outline =
            [Some(place(photo, Some(folder))), photo.outline.clone(), Some(photo.path.with_extension("json"))]
                .into_iter()
                .flatten()
                .find(|path| path.is_file() || new.contains(path));
        let outline = outline.map_or_else(String::new, |path| relative(&path, Some(folder)));
        let file = relative(&photo.path, Some(folder));
        table.write_record([&file, &photo.subject, &photo.pose, &outline]).map_err(|e| refused(e.to_string()))?;
    }
    let text = table.into_inner().map_err(|e| refused(e.to_string()))?;
    std::fs::write(at, text).map_err(|e| refused(e.to_string()))
}

/// `path` as seen from `folder`, both made absolute first; as it is where that can't be told.
fn relative(path: &Path, folder: Option<&Path>) -> String {
    // A file that is on its way has its folder already.
    let real = |path: &Path| {
        path.canonicalize().ok().or_else(|| Some(path.parent()?.canonicalize().ok()?.join(path.file_name()?)))
    };
    let seen = folder.and_then(|folder| pathdiff::diff_paths(real(path)?, folder.canonicalize().ok()?));
    seen.unwrap_or_else(|| path.to_owned()).to_string_lossy().into_owned()
}
