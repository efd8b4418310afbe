//! Which photographs: a folder of poses, or a manifest, to a sorted list.
//!
//! In: `SET/<pose>/<subject>.<png|jpg|tif|bmp>`, or a flat folder (one pose, named after it), or a folder with
//! `photos.csv` (`file,subject,pose` and optionally `outline` and `tone`, paths relative to it; other columns are
//! allowed, unless they seem to be meant for one of these). Out: a [`PhotoSet`], its photographs sorted by pose
//! ([`THESIS_POSES`](super::pose::THESIS_POSES) first), subject and file, and the [`SetFault`]s: entries that cannot be
//! used, each with its place; the others go on. A subject counts once per pose, so subjects that a pose has twice are
//! all left out.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Component, Path, PathBuf};

use thiserror::Error;

use crate::input;
use crate::photo::pose::sort_by_pose;
use crate::photograph::{PICTURES, extension, is_picture};
use crate::table::{delimiter_of, line_of_row};
use crate::words::{COMPOSE, composed, shown};

/// Photographs in formats that lunula does not read: said, not passed over.
const OTHER_PICTURES: [&str; 14] =
    ["heic", "heif", "webp", "gif", "avif", "jxl", "jp2", "cr2", "cr3", "nef", "arw", "dng", "raf", "orf"];

/// What folders of masks, and the ends of masks' names, are called.
pub(crate) const MASKS: [&str; 4] = ["mask", "masks", "label", "labels"];

/// One photograph of a set.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Photo {
    /// The force or posture, as "nominal" or "extension".
    pub pose: String,
    /// Whose finger.
    pub subject: String,
    /// As the set names it, with `/`: what tables and messages show.
    pub file: String,
    /// Where it is.
    pub path: PathBuf,
    /// The manifest's outline: a LabelMe file or a mask.
    pub outline: Option<PathBuf>,
    /// The manifest's skin tone, in the words of whoever wrote it.
    pub tone: Option<String>,
}

/// An entry that cannot be used.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct SetFault {
    /// File, and line in the manifest.
    pub place: String,
    /// What is wrong and what to do.
    pub what: String,
}

impl std::fmt::Display for SetFault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: {}", shown(&self.place), self.what)
    }
}

/// Why there is no set at all.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum SetError {
    #[error("{}: {why} (a folder of photographs is needed)", .folder.display())]
    Unreadable { folder: PathBuf, why: std::io::Error },
    #[error("{}: {why}", .file.display())]
    Manifest { file: PathBuf, why: String },
    #[error(
        "{}: no photographs here (looked for {place}){also}", .folder.display()
    )]
    Empty { folder: PathBuf, place: &'static str, also: String },
}

/// A checked list of photographs.
///
/// ```
/// use std::path::Path;
///
/// use lunula::job::Watch;
/// use lunula::photo::{Outputs, PhotoSet, PhotosOptions, run};
///
/// let set = PhotoSet::open(Path::new("fixtures/photos"), &[])?;
/// assert_eq!((set.poses(), set.photos.len()), (vec!["normal", "extension"], 4));
/// let out = tempfile::tempdir()?;
/// let report = run(&set, &PhotosOptions::default(), &Outputs::maps(out.path()), &Watch::nobody())?;
/// assert!(report.failed.is_empty() && report.figures.poses[0].subjects == 2);
/// assert!(out.path().join("maps/extension-mean.npy").exists());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct PhotoSet {
    /// The set's folder.
    pub folder: PathBuf,
    /// Sorted by pose (as [`PhotoSet::poses`]), subject, file.
    pub photos: Vec<Photo>,
    /// Entries left out, sorted.
    pub faults: Vec<SetFault>,
    /// Photographs beside those that a manifest names, sorted.
    pub unlisted: Vec<String>,
    /// Folders within those of poses that hold photographs, which are not used, and how many, sorted.
    pub deeper: Vec<(String, usize)>,
    /// JSON and XML files beside photographs that are called as none of them, and that no manifest names, sorted.
    pub alone: Vec<PathBuf>,
}

impl PhotoSet {
    /// Lists `folder`; folders of `apart` (results, masks) inside of it are no poses.
    ///
    /// # Errors
    /// [`SetError`] where there is no list: folder or manifest unreadable, or nothing in it.
    pub fn open(folder: &Path, apart: &[&Path]) -> Result<Self, SetError> {
        let manifest = folder.join("photos.csv");
        let mut set = Self { folder: folder.to_owned(), ..Self::default() };
        if manifest.is_file() {
            set.read_manifest(&manifest)?
        } else {
            set.list_folder(apart)?
        }
        set.settle();
        if set.photos.is_empty() {
            let also = set.faults.iter().map(|fault| format!("\n  {fault}")).collect();
            let place = if manifest.is_file() {
                "those that photos.csv names"
            } else {
                ".png, .jpg, .tif and .bmp in it and in the folders of poses within it"
            };
            return Err(SetError::Empty { folder: folder.to_owned(), place, also });
        }
        Ok(set)
    }

    /// Whether results in `out` would be taken for photographs of the set in `folder` by a later run, or photographs
    /// there be passed over as results: where `out` is that folder, or one within it that holds pictures.
    #[must_use]
    pub fn would_take_results(folder: &Path, out: &Path) -> bool {
        let (Ok(folder), Ok(out)) = (folder.canonicalize(), out.canonicalize()) else { return false };
        if folder.join("photos.csv").is_file() {
            return false;
        }
        let pictures = || list(&out).is_ok_and(|(files, _)| files.iter().any(|file| is_picture(file)));
        out == folder || (out.starts_with(&folder) && pictures())
    }

    /// A set of photographs that are known one by one; those that can't be used are among its faults.
    #[must_use]
    pub fn of(photos: Vec<Photo>) -> Self {
        let mut set = Self::default();
        for photo in photos {
            match names_fault(&photo.subject, &photo.pose) {
                Some(what) => set.fault(photo.file, what),
                None if !is_picture(&photo.path) => set.fault(photo.file, NO_PICTURE),
                None => set.photos.push(photo),
            }
        }
        set.settle();
        set
    }

    /// Sorts, and leaves out what can't be distinguished.
    fn settle(&mut self) {
        self.photos.sort();
        self.leave_out_doubles();
        self.leave_out_clashing_names();
        self.photos.sort();
        sort_by_pose(&mut self.photos, |photo| &photo.pose);
        self.faults.sort();
        self.alone.sort();
    }

    /// The poses, the thesis' first and in its order, then by name.
    pub fn poses(&self) -> Vec<&str> {
        let mut poses: Vec<&str> = self.photos.iter().map(|p| p.pose.as_str()).collect();
        poses.dedup();
        poses
    }

    fn fault(&mut self, place: impl Into<String>, what: impl Into<String>) {
        self.faults.push(SetFault { place: place.into(), what: what.into() });
    }

    fn list_folder(&mut self, apart: &[&Path]) -> Result<(), SetError> {
        let apart: Vec<PathBuf> = apart.iter().filter_map(|p| p.canonicalize().ok()).collect();
        let is_apart = |path: &Path| path.canonicalize().is_ok_and(|p| apart.contains(&p));
        let (files, folders) = list(&self.folder)?;
        let before = self.photos.len();
        for pose_folder in folders.iter().filter(|f| !is_apart(f)) {
            let pose = name_of(pose_folder);
            let (files, within) = list(pose_folder)?;
            for file in &files {
                self.consider(file, &pose, format!("{pose}/{}", name_of(file)));
            }
            self.alone.extend(called_as_no_picture(&files));
            let is_of_set = |folder: &&PathBuf| {
                let name = name_of(folder).to_lowercase();
                !(is_apart(folder) || MASKS.contains(&name.as_str()) || name.starts_with('@'))
            };
            for folder in within.iter().filter(is_of_set) {
                let pictures =
                    list(folder).map_or(0, |(files, _)| files.iter().filter(|file| is_picture(file)).count());
                if pictures > 0 {
                    self.deeper.push((format!("{pose}/{}", name_of(folder)), pictures));
                }
            }
        }
        let has_poses = self.photos.len() > before;
        self.alone.extend(called_as_no_picture(&files));
        let flat_name = self.folder.canonicalize().map_or_else(|_| "photos".into(), |f| name_of(&f));
        for file in files {
            let name = name_of(&file);
            if has_poses && is_picture(&file) {
                self.fault(name, "lies beside the folders of poses; move it into one, or list all in photos.csv");
            } else {
                self.consider(&file, &flat_name, name);
            }
        }
        Ok(())
    }

    fn consider(&mut self, path: &Path, pose: &str, file: String) {
        if is_picture(path) {
            let subject = path.file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned());
            if let Some(what) = names_fault(&subject, pose) {
                self.fault(file, what);
                return;
            }
            if let Some(photo) = mask_of(path, &subject) {
                self.fault(
                    file,
                    format!("looks like the mask of {photo}; put masks into a folder, and say --masks FOLDER"),
                );
                return;
            }
            let (pose, path) = (pose.to_owned(), path.to_owned());
            self.photos.push(Photo { pose, subject, file, path, outline: None, tone: None });
        } else if let Some(kind) = extension(path).filter(|e| OTHER_PICTURES.contains(&e.as_str())) {
            self.fault(file, format!(".{kind} is not read; export it as PNG, TIFF, BMP or JPEG"));
        }
    }

    fn read_manifest(&mut self, path: &Path) -> Result<(), SetError> {
        let wrong = |why: String| SetError::Manifest { file: path.to_owned(), why };
        let text = input::read_text(path).map_err(|e| match e.kind() {
            std::io::ErrorKind::InvalidData => wrong("is not UTF-8; save it as CSV in UTF-8".into()),
            _ => wrong(e.to_string()),
        })?;
        let rows = text.trim_start_matches('\u{feff}').as_bytes();
        let mut reader = csv::ReaderBuilder::new()
            .delimiter(delimiter_of(&text))
            .trim(csv::Trim::All)
            .flexible(true)
            .from_reader(rows);
        let header = reader.headers().map_err(|e| wrong(e.to_string()))?.clone();
        let column = |name: &str| header.iter().position(|h| h == name);
        let (Some(file), Some(subject), Some(pose)) = (column("file"), column("subject"), column("pose")) else {
            let found = header.iter().collect::<Vec<_>>().join(",");
            return Err(wrong(format!(
                "line 1: the columns are `{found}`; it needs file,subject,pose and may have outline and tone, \
                 separated by commas, semicolons or tabs"
            )));
        };
        let meant = OPTIONAL.iter().filter(|optional| column(optional.name).is_none());
        if let Some((own, meant)) = meant.flat_map(|one| header.iter().map(move |own| (own, one))).find(is_meant) {
            return Err(wrong(format!(
                "line 1: the column `{own}` would not be read; did you mean `{}`? Rename it, or call it something else",
                meant.name
            )));
        }
        let (outline, tone) = (column("outline"), column("tone"));
        let mut named: BTreeSet<PathBuf> = BTreeSet::new();
        for record in reader.records() {
            let record = record.map_err(|e| wrong(e.to_string()))?;
            let line = record.position().map_or(0, |position| line_of_row(rows, position));
            let place = format!("photos.csv, line {line}");
            let cell = |at: usize| record.get(at).unwrap_or_default().to_owned();
            if record.iter().all(str::is_empty) {
                continue;
            }
            let (file, subject, pose) = (self.with_slashes(cell(file)), cell(subject), cell(pose));
            named.insert(self.folder.join(&file));
            if let Some(what) = row_fault(&self.folder, &file, &subject, &pose) {
                self.fault(place, what);
                continue;
            }
            let outline = outline.map(cell).filter(|o| !o.is_empty());
            let outline = outline.map(|outline| self.folder.join(self.with_slashes(outline)));
            if let Some(missing) = outline.as_ref().filter(|o| !o.is_file()) {
                self.fault(place, format!("the outline {} does not exist{}", missing.display(), accents(missing)));
                continue;
            }
            let tone = tone.map(cell).filter(|tone| !tone.is_empty());
            named.extend(outline.clone());
            self.photos.push(Photo { pose, subject, path: self.folder.join(&file), file, outline, tone });
        }
        let folders: BTreeSet<&Path> = named.iter().filter_map(|path| path.parent()).collect();
        for (files, _) in folders.into_iter().filter_map(|folder| list(folder).ok()) {
            self.alone.extend(called_as_no_picture(&files).into_iter().filter(|file| !named.contains(file)));
            let unlisted = files.into_iter().filter(|path| is_picture(path) && !named.contains(path));
            self.unlisted.extend(unlisted.map(|path| path.display().to_string()));
        }
        self.unlisted.sort();
        Ok(())
    }

    /// A file of a manifest as it is there: Windows writes `\` where folders end.
    fn with_slashes(&self, file: String) -> String {
        let slashed = file.replace('\\', "/");
        let is_meant = slashed != file && !self.folder.join(&file).exists() && self.folder.join(&slashed).is_file();
        if is_meant { slashed } else { file }
    }

    /// A subject counts once per pose: none of several is better than the others.
    fn leave_out_doubles(&mut self) {
        let mut by_key: BTreeMap<(String, String), Vec<Photo>> = BTreeMap::new();
        let mut by_file: BTreeMap<(String, PathBuf), usize> = BTreeMap::new();
        for photo in self.photos.drain(..) {
            *by_file.entry((photo.pose.clone(), photo.path.clone())).or_default() += 1;
            by_key.entry((photo.pose.clone(), photo.subject.clone())).or_default().push(photo);
        }
        for ((pose, subject), photos) in by_key {
            let files = photos.iter().map(|p| p.file.as_str()).collect::<Vec<_>>().join(", ");
            if photos.len() > 1 {
                self.fault(
                    files,
                    format!(
                        "subject `{subject}` is there {} times in pose `{pose}`, and a subject counts once: remove all \
                         but one, or give each its own subject in photos.csv (in a pipeline: by {{pose}} and \
                         {{subject}} in the pattern)",
                        photos.len()
                    ),
                );
                continue;
            }
            for photo in photos {
                if by_file[&(pose.clone(), photo.path.clone())] > 1 {
                    self.fault(
                        photo.file,
                        format!("is listed for several subjects of pose `{pose}`; one photograph is one subject's"),
                    );
                } else {
                    self.photos.push(photo);
                }
            }
        }
    }

    /// Nail 2 of subject `a` is written as `a-2.png`: another subject of that name could overwrite it.
    fn leave_out_clashing_names(&mut self) {
        let names: BTreeSet<(String, String)> =
            self.photos.iter().map(|p| (p.pose.clone(), p.subject.clone())).collect();
        let clashes = |photo: &Photo| {
            let (stem, number) = photo.subject.rsplit_once('-')?;
            number.parse::<u32>().ok().filter(|_| names.contains(&(photo.pose.clone(), stem.to_owned())))?;
            Some(stem.to_owned())
        };
        for photo in std::mem::take(&mut self.photos) {
            let Some(stem) = clashes(&photo) else {
                self.photos.push(photo);
                continue;
            };
            let Photo { subject, file, .. } = photo;
            self.fault(
                file,
                format!("subject `{subject}` could be taken for a nail of subject `{stem}`; rename one of them"),
            );
        }
    }
}

/// A column that a manifest may have.
struct Optional {
    name: &'static str,
    /// What others call it.
    also: &'static str,
    /// How many letters may be wrong: a short name has other words beside it, as `tone` has `toe` and `zone`.
    slips: usize,
}

const OPTIONAL: [Optional; 2] =
    [Optional { name: "outline", also: "mask", slips: 1 }, Optional { name: "tone", also: "skintone", slips: 0 }];

/// Whether a column that is not read was meant to be this one: a word of it is, whatever its case and number.
fn is_meant((own, optional): &(&str, &Optional)) -> bool {
    let own = own.to_lowercase();
    let mut words = own.split(|c: char| !c.is_alphanumeric()).map(|word| word.strip_suffix('s').unwrap_or(word));
    words.any(|word| word == optional.also || strsim::osa_distance(word, optional.name) <= optional.slips)
}

fn row_fault(folder: &Path, file: &str, subject: &str, pose: &str) -> Option<String> {
    let cells = [("file", file), ("subject", subject), ("pose", pose)];
    if let Some((name, _)) = cells.iter().find(|(_, value)| value.is_empty()) {
        return Some(format!("the cell `{name}` is empty"));
    }
    let path = folder.join(file);
    let missing = || (!path.is_file()).then(|| format!("{file} does not exist beside photos.csv{}", accents(&path)));
    names_fault(subject, pose).or_else(missing)
}

/// What to say of a file that is missing where one of its name is there that only looks the same.
fn accents(missing: &Path) -> String {
    let there = input::encoded_otherwise(missing, |other| other.extension() == missing.extension());
    there.map_or_else(String::new, |_| {
        format!("; one is there whose name only looks the same, its accents are encoded in another way: {COMPOSE}")
    })
}

const NO_PICTURE: &str = "is not a photograph that lunula reads; export it as PNG, TIFF, BMP or JPEG";

/// Bytes of a subject or pose: file systems take names of 255, and results add to it.
const LONGEST_NAME: usize = 200;

/// What is wrong with the names that files of the results will have.
fn names_fault(subject: &str, pose: &str) -> Option<String> {
    name_fault("subject", subject).or_else(|| name_fault("pose", pose))
}

fn name_fault(name: &str, value: &str) -> Option<String> {
    let mut parts = Path::new(value).components();
    let plain = matches!((parts.next(), parts.next()), (Some(Component::Normal(_)), None));
    let sound = plain && !value.contains(['/', '\\', '\0']);
    if value.len() > LONGEST_NAME {
        return Some(format!(
            "a {name} of {} bytes makes names of results that are too long; shorten it to {LONGEST_NAME} (in \
             photos.csv it may differ from the file's name)",
            value.len()
        ));
    }
    (!sound).then(|| format!("`{value}` names files of the results, so a {name} cannot hold a path"))
}

/// The photograph's name of which a mask's, such as `s01_mask`, is made.
pub(crate) fn stem_of_mask(stem: &str) -> Option<&str> {
    let (photo, word) = stem.rsplit_once(['_', '-'])?;
    MASKS.contains(&word.to_lowercase().as_str()).then_some(photo)
}

/// The photograph of whose name and a word for masks a picture's name is made, if it lies beside it.
fn mask_of(path: &Path, stem: &str) -> Option<String> {
    let photo = stem_of_mask(stem)?;
    let mut names = PICTURES.iter().map(|ending| format!("{photo}.{ending}"));
    names.find(|name| path.with_file_name(name).is_file())
}

/// Files and folders of a folder, hidden ones left out, sorted by name.
fn list(folder: &Path) -> Result<(Vec<PathBuf>, Vec<PathBuf>), SetError> {
    let unreadable = |why| SetError::Unreadable { folder: folder.to_owned(), why };
    let mut paths = input::list(folder).map_err(unreadable)?;
    paths.retain(|p| !name_of(p).starts_with('.'));
    Ok(paths.into_iter().partition(|p| !p.is_dir()))
}

/// JSON and XML files of a folder's files that are called as none of its pictures, whatever the encoding of accents.
fn called_as_no_picture(files: &[PathBuf]) -> Vec<PathBuf> {
    let stem = |path: &Path| composed(&path.file_stem().unwrap_or_default().to_string_lossy());
    let is_any_picture =
        |path: &&PathBuf| is_picture(path) || extension(path).is_some_and(|e| OTHER_PICTURES.contains(&e.as_str()));
    let pictures: BTreeSet<String> = files.iter().filter(is_any_picture).map(|path| stem(path)).collect();
    let may_annotate = |path: &&PathBuf| extension(path).is_some_and(|ending| ending == "json" || ending == "xml");
    files.iter().filter(may_annotate).filter(|path| !pictures.contains(&stem(path))).cloned().collect()
}

fn name_of(path: &Path) -> String {
    path.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned())
}
