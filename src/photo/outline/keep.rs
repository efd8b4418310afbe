//! Detected outlines saved as LabelMe files for a person to correct; the next run uses the corrected ones.
//!
//! Beside each photograph (`<stem>.json`), or in a folder of their own with a `photos.csv` that ties them to the
//! photographs:
//! that folder is then the set of the next run. A file that exists is never overwritten: it may be a person's work.
//! Outlines that are not trusted are labelled `nail?`, which no run reads until somebody relabels them.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use super::annotated::{ToDraw, to_file};
use super::source::{Nail, Source};
use crate::files::{Places, WriteError};
use crate::labelme::LabelMe;
use crate::photo::set::{Photo, PhotoSet};
use crate::photograph::Photograph;
use crate::table::csv_bytes;

#[derive(Debug, Clone)]
pub(in crate::photo) struct DetectedOutline {
    /// Index of its photograph in the set.
    photo: usize,
    /// Trusted and doubtful ones, as a file without its photograph's path.
    file: LabelMe,
}

impl DetectedOutline {
    /// What was detected on a photograph; `None` where that is nothing.
    pub(in crate::photo) fn of(photo: usize, picture: &Photograph, nails: &[Nail]) -> Option<Self> {
        let found = to_draw(nails);
        (!found.is_empty()).then(|| Self { photo, file: to_file("", picture, &found) })
    }
}

/// Those of `nails` that were detected, trusted and doubtful ones, for a person to correct.
pub(crate) fn to_draw(nails: &[Nail]) -> Vec<ToDraw> {
    let detected = nails.iter().filter(|nail| nail.source == Source::Detected);
    let one = |nail: &Nail| {
        let confidence = nail.confidence.unwrap_or(0.0);
        let (outline, axis) = (nail.outline.clone()?, nail.axis?);
        Some(ToDraw { outline, axis, confidence, trusted: nail.reason.is_empty() })
    };
    detected.filter_map(one).collect()
}

/// The LabelMe files of detected outlines.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct SavedOutlines {
    /// The folder that they are in; `None`: beside the photographs.
    pub folder: Option<PathBuf>,
    /// New files.
    pub written: Vec<PathBuf>,
    /// Files that exist and stay as they are.
    pub kept: Vec<PathBuf>,
}

impl SavedOutlines {
    /// What a person should know of them, a line each.
    #[must_use]
    pub fn notes(&self) -> Vec<String> {
        let place =
            self.folder.as_ref().map_or_else(|| "beside the photographs".into(), |f| format!("in {}", f.display()));
        let mut notes = vec![format!("{} outlines saved {place} for LabelMe", self.written.len())];
        match &self.kept[..] {
            [] => {}
            [only] => notes.push(format!("{} exists and stays as it is", only.display())),
            [first, .., last] => notes.push(format!(
                "{} files of outlines exist and stay as they are: {} to {}",
                self.kept.len(),
                first.display(),
                last.display()
            )),
        }
        notes
    }
}

/// Saves detected outlines of the photographs of `set`, in `folder` or beside them, as far as `places`.
pub(in crate::photo) fn keep_outlines(
    detected: &[DetectedOutline],
    set: &PhotoSet,
    folder: Option<&Path>,
    places: &mut Places,
) -> Result<SavedOutlines, WriteError> {
    let mut saved = SavedOutlines { folder: folder.map(Path::to_owned), ..SavedOutlines::default() };
    let mut new = BTreeSet::new();
    // Also where all outlines exist, or where none is detected any more because they do.
    let homes: BTreeSet<PathBuf> =
        set.photos.iter().filter_map(|photo| Some(place(photo, folder).parent()?.to_owned())).collect();
    homes.iter().for_each(|home| places.look_after(home));
    for detected in detected {
        let photo = &set.photos[detected.photo];
        let path = place(photo, folder);
        if path.exists() || !new.insert(path.clone()) {
            saved.kept.push(path);
            continue;
        }
        // Its folder is there from here on, and paths relative to it can be written.
        let at = places.place(&path)?;
        let file = LabelMe { image_path: relative(&photo.path, path.parent()), ..detected.file.clone() };
        let refused = |why: String| WriteError::File { path: path.clone(), why };
        let text = file.to_text().map_err(|why| refused(why.to_string()))?;
        std::fs::write(at, text).map_err(|why| refused(why.to_string()))?;
        saved.written.push(path);
    }
    if let Some(folder) = folder {
        write_manifest(set, folder, &new, places)?;
    }
    Ok(saved)
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
    let with_tone = set.photos.iter().any(|photo| photo.tone.is_some());
    let header = ["file", "subject", "pose", "outline"].into_iter().chain(with_tone.then_some("tone"));
    let row = |photo: &Photo| {
        let outline =
            [Some(place(photo, Some(folder))), photo.outline.clone(), Some(photo.path.with_extension("json"))]
                .into_iter()
                .flatten()
                .find(|path| path.is_file() || new.contains(path));
        let outline = outline.map_or_else(String::new, |path| relative(&path, Some(folder)));
        let file = relative(&photo.path, Some(folder));
        let tone = with_tone.then(|| photo.tone.clone().unwrap_or_default());
        [file, photo.subject.clone(), photo.pose.clone(), outline].into_iter().chain(tone)
    };
    let text = csv_bytes(header, set.photos.iter().map(row)).map_err(refused)?;
    std::fs::write(at, text).map_err(|why| refused(why.to_string()))
}

/// `path` as seen from `folder`, both made absolute first; as it is where that can't be known.
pub(crate) fn relative(path: &Path, folder: Option<&Path>) -> String {
    // A file that is on its way has its folder already.
    let real = |path: &Path| {
        path.canonicalize().ok().or_else(|| Some(path.parent()?.canonicalize().ok()?.join(path.file_name()?)))
    };
    let seen = folder.and_then(|folder| pathdiff::diff_paths(real(path)?, folder.canonicalize().ok()?));
    seen.unwrap_or_else(|| path.to_owned()).to_string_lossy().into_owned()
}
