//! What lies in a folder.

use std::collections::BTreeSet;
use std::io;
use std::path::Path;

use super::results::JobResults;
use crate::input;
use crate::input::is_special;
use crate::log::{Columns, LogHeader};
use crate::photo::{MASKS, PhotoSet, stem_of_mask};
use crate::photograph::PICTURES;
use crate::pipeline::store::MadeBefore;
use crate::table::{Table, column_names};
use crate::video::FILMS;

/// How deep is looked (assumed: recordings are in folders of a person, a day, a session, a camera).
const DEEPEST: usize = 6;
/// What `lunula phantom` writes into its folders `truth`.
const RECORDS: [&str; 6] = ["board.json", "log.json", "nailvideo.json", "phantom.json", "press.json", "scene.json"];

/// What was found, by sort; paths are relative to the folder, with `/`, sorted.
#[derive(Debug, Default)]
pub(super) struct Inventory {
    /// All files, those that are passed over too: a pattern finds them all the same.
    pub(super) all: Vec<String>,
    /// Those of `all` that are results, or in folders that are passed over.
    not_own: BTreeSet<String>,
    /// What jobs wrote beside own files; folders end in `/`.
    pub(super) results: Vec<String>,
    /// Folders of runs' results.
    pub(super) runs: Vec<String>,
    /// The folders of these runs' tasks.
    tasks: BTreeSet<String>,
    pub(super) passed: Vec<Passed>,
    /// How many names are not UTF-8, which no pattern has.
    pub(super) unnamed: usize,
    /// Those that `photo_table` doesn't name.
    pub(super) photos: Vec<String>,
    pub(super) photo_table: Option<PhotoTable>,
    /// Files called as such a table that are none, or further ones, and why.
    pub(super) other_photo_tables: Vec<String>,
    /// Pictures that are masks of photographs, by their names.
    pub(super) masks: Vec<String>,
    pub(super) videos: Vec<String>,
    pub(super) markers: Vec<String>,
    /// Whether a marker file names a clock.
    pub(super) clock: bool,
    pub(super) logs: Vec<String>,
    /// Whether logs hold forces.
    pub(super) forces: bool,
    pub(super) joints: Vec<String>,
    /// Whether tables of angles hold the clock's time.
    pub(super) joints_clock: bool,
    pub(super) sets: Vec<String>,
    pub(super) sessions: Option<Sessions>,
    pub(super) unknown: Vec<String>,
}

/// A folder that is not looked at.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Passed {
    pub(super) path: String,
    pub(super) reason: Reason,
    /// Whether files in it are of a sort that would be used.
    pub(super) is_missed: bool,
}

/// Why a folder is not looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Reason {
    /// The truth of generated recordings.
    GeneratedTruth,
    /// It is called as that.
    Truth,
    /// It is below too many folders.
    Deep,
    /// A run worked there, and nothing says which results are its.
    NoRecords,
}

/// A `photos.csv`, which says whose photographs are, and in which pose.
#[derive(Debug)]
pub(super) struct PhotoTable {
    pub(super) path: String,
    pub(super) photos: usize,
    /// Whether it names outlines.
    pub(super) outlines: bool,
}

/// A table that names files.
#[derive(Debug, Default)]
pub(super) struct Sessions {
    pub(super) path: String,
    pub(super) rows: usize,
    pub(super) keys: Vec<String>,
    pub(super) video: Option<String>,
    pub(super) markers: Option<String>,
    pub(super) log: Option<String>,
    pub(super) joints: Option<String>,
}

/// What a file is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Sort {
    Photo,
    Video,
    Markers {
        clock: bool,
    },
    Log {
        forces: bool,
    },
    Joints {
        clock: bool,
    },
    Set,
    Other,
    /// Of no interest, and not worth a word.
    Silent,
}

/// Looks at a folder.
pub(super) fn look(folder: &Path) -> io::Result<Inventory> {
    input::list(folder)?;
    let mut found = Inventory::default();
    walk(folder, "", 0, false, &mut found);
    let (mut tables, mut photo_tables) = (Vec::new(), Vec::new());
    let own: Vec<String> = found.all.iter().filter(|path| !found.not_own.contains(*path)).cloned().collect();
    for path in own {
        match sort(&folder.join(&path)) {
            Sort::Photo => found.photos.push(path),
            Sort::Video => found.videos.push(path),
            Sort::Markers { clock } => {
                found.clock |= clock;
                found.markers.push(path);
            }
            Sort::Log { forces } => {
                found.forces |= forces;
                found.logs.push(path);
            }
            Sort::Joints { clock } => {
                found.joints_clock |= clock;
                found.joints.push(path);
            }
            Sort::Set => found.sets.push(path),
            Sort::Silent => {}
            Sort::Other if folder_and_name(&path).1 == "photos.csv" => photo_tables.push(path),
            Sort::Other if is_table(&path) => tables.push(path),
            Sort::Other => found.unknown.push(path),
        }
    }
    for path in photo_tables {
        name_photographs(folder, path, &mut found);
    }
    let photos = found.photos.iter().filter(|path| of_mask(path).is_none());
    let stems: BTreeSet<String> = photos.map(|path| folder_and_stem(path).1).collect();
    let is_mask = |path: &String| of_mask(path).is_some_and(|of| stems.contains(&of));
    (found.masks, found.photos) = found.photos.into_iter().partition(is_mask);
    for path in tables {
        match sessions(folder, &path) {
            Some(sessions) if found.sessions.is_none() => found.sessions = Some(sessions),
            _ => found.unknown.push(path),
        }
    }
    Ok(found)
}

/// Takes what a `photos.csv` names out of the photographs whose names are to say what they are.
fn name_photographs(folder: &Path, path: String, found: &mut Inventory) {
    let beside = folder.join(folder_and_name(&path).0);
    let set = match PhotoSet::open(&beside, &[]) {
        Ok(_) if found.photo_table.is_some() => {
            found.other_photo_tables.push(format!("{path}: one such table is used; write an input for this one"));
            return;
        }
        Ok(set) => set,
        Err(why) => {
            found.other_photo_tables.push(why.to_string());
            return;
        }
    };
    let whole = |file: &Path| file.canonicalize().ok();
    let outlines = || set.photos.iter().filter_map(|photo| photo.outline.as_deref());
    let named: BTreeSet<_> = set.photos.iter().map(|photo| &*photo.path).chain(outlines()).filter_map(whole).collect();
    found.photos.retain(|photo| whole(&folder.join(photo)).is_none_or(|photo| !named.contains(&photo)));
    let outlines = outlines().next().is_some();
    found.photo_table = Some(PhotoTable { path, photos: set.photos.len(), outlines });
}

/// Walks a folder; of one that is passed over only the names are taken.
fn walk(folder: &Path, at: &str, depth: usize, is_passed: bool, found: &mut Inventory) {
    let here = folder.join(at);
    let above = here.canonicalize().ok();
    let mut entries: Vec<(String, bool)> = std::fs::read_dir(&here)
        .into_iter()
        .flatten()
        .flatten()
        .filter_map(|entry| {
            let (name, path) = (entry.file_name(), entry.path());
            // A link to a folder above has all of it once more.
            let is_loop = || {
                path.is_symlink()
                    && above.as_ref().zip(path.canonicalize().ok()).is_some_and(|(above, to)| above.starts_with(to))
            };
            if is_special(&path) || path.is_dir() && is_loop() {
                return None;
            }
            let name = name.into_string().inspect_err(|_| found.unnamed += 1).ok()?;
            Some((name, path.is_dir()))
        })
        .filter(|(name, _)| !name.starts_with('.'))
        .collect();
    entries.sort();
    let names = entries.iter().filter(|(_, is_folder)| !is_folder).map(|(name, _)| name.as_str());
    let of_jobs = if is_passed { JobResults::default() } else { JobResults::of(&here, names) };
    if !is_passed && here.join(".lunula").is_dir() {
        let tasks = MadeBefore::of(&here).tasks;
        if tasks.is_empty() && !at.is_empty() {
            pass(folder, at, depth, Reason::NoRecords, found);
            return;
        }
        found.tasks.extend(tasks.iter().map(|task| joined(at, task)));
        found.runs.push(if at.is_empty() { ".".to_owned() } else { at.to_owned() });
    }
    for (name, is_folder) in entries {
        let path = joined(at, &name);
        let is_result = of_jobs.holds(&name, is_folder);
        if is_result {
            found.results.push(if is_folder { format!("{path}/") } else { path.clone() });
        }
        if !is_folder {
            if is_result || is_passed {
                found.not_own.insert(path.clone());
            }
            found.all.push(path);
        } else if is_passed || is_result || found.tasks.contains(&path) {
            if depth < 2 * DEEPEST {
                walk(folder, &path, depth + 1, true, found);
            }
        } else if name == "truth" {
            let is_generated = RECORDS.iter().any(|record| folder.join(&path).join(record).is_file());
            let reason = if is_generated { Reason::GeneratedTruth } else { Reason::Truth };
            pass(folder, &path, depth + 1, reason, found);
        } else if depth == DEEPEST {
            pass(folder, &path, depth + 1, Reason::Deep, found);
        } else {
            walk(folder, &path, depth + 1, false, found);
        }
    }
}

/// Passes over a folder, but for the names in it.
fn pass(folder: &Path, at: &str, depth: usize, reason: Reason, found: &mut Inventory) {
    let before = found.all.len();
    walk(folder, at, depth, true, found);
    let is_of_use = |path: &String| match sort(&folder.join(path)) {
        Sort::Photo | Sort::Video | Sort::Markers { .. } | Sort::Log { .. } => true,
        // Of true angles there are tables too.
        Sort::Joints { .. } => reason != Reason::Truth,
        Sort::Set | Sort::Other | Sort::Silent => false,
    };
    let is_missed = reason != Reason::GeneratedTruth && found.all[before..].iter().any(is_of_use);
    found.passed.push(Passed { path: at.to_owned(), reason, is_missed });
}

fn joined(folder: &str, name: &str) -> String {
    if folder.is_empty() { name.to_owned() } else { format!("{folder}/{name}") }
}

fn is_table(name: &str) -> bool {
    name.ends_with(".csv") || name.ends_with(".parquet")
}

/// A path's folder, and its name.
fn folder_and_name(path: &str) -> (&str, &str) {
    path.rsplit_once('/').unwrap_or(("", path))
}

/// A path's folder, and its name without ending, in small letters.
fn folder_and_stem(path: &str) -> (String, String) {
    let (folder, name) = folder_and_name(path);
    let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
    (folder.to_lowercase(), stem.to_lowercase())
}

/// The photograph of which a picture is a mask, by their names without endings: `s01_mask` of `s01`, `masks/s01`.
fn of_mask(path: &str) -> Option<String> {
    let (folder, stem) = folder_and_stem(path);
    let in_masks = folder.split('/').any(|part| MASKS.contains(&part));
    stem_of_mask(&stem).map(str::to_owned).or_else(|| in_masks.then_some(stem))
}

fn sort(path: &Path) -> Sort {
    let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default().to_ascii_lowercase();
    let ending = name.rsplit_once('.').map_or("", |(_, ending)| ending);
    match ending {
        photo if PICTURES.contains(&photo) => Sort::Photo,
        film if FILMS.contains(&film) => Sort::Video,
        "toml" => toml_file(path),
        "csv" | "parquet" => table(path),
        "gz" if name.ends_with(".csv.gz") => log(path),
        "xdf" => Sort::Log { forces: false },
        "tsv" | "dat" | "asc" | "lvm" => log(path),
        "txt" => match log(path) {
            Sort::Other => Sort::Silent,
            of_text => of_text,
        },
        // Outlines lie beside photographs, reports beside results.
        "json" | "html" | "md" => Sort::Silent,
        _ => Sort::Other,
    }
}

fn toml_file(path: &Path) -> Sort {
    let text = std::fs::read_to_string(path).unwrap_or_default();
    let document: toml::Table = text.parse().unwrap_or_default();
    if document.contains_key("markers") && document.contains_key("joints") {
        Sort::Markers { clock: document.contains_key("clock") }
    } else if document.contains_key("stage") {
        Sort::Silent
    } else {
        Sort::Other
    }
}

fn table(path: &Path) -> Sort {
    let Ok(names) = column_names(path) else { return log(path) };
    let has = |name: &str| names.iter().any(|known| known == name);
    let angles = names.iter().any(|name| name.ends_with("_deg") && !name.ends_with("_sd_deg"));
    if has("label_status") && has("time_s") {
        Sort::Set
    } else if has("frame") && has("time_s") && angles {
        Sort::Joints { clock: has("clock_s") }
    } else {
        log(path)
    }
}

fn log(path: &Path) -> Sort {
    match LogHeader::read(path, &Columns::default()) {
        Ok(header) if header.photodiodes > 0 => Sort::Log { forces: header.forces > 0 },
        _ => Sort::Other,
    }
}

/// A table whose columns name files, most of which stand.
fn sessions(folder: &Path, path: &str) -> Option<Sessions> {
    let table = Table::read(&folder.join(path)).ok()?;
    let beside = folder.join(path).parent()?.to_owned();
    let mut sessions = Sessions { path: path.to_owned(), rows: table.rows(), ..Sessions::default() };
    let mut any = false;
    for name in table.names() {
        let cells = table.texts(name).ok()?;
        let standing = cells.iter().flatten().map(|cell| beside.join(cell)).find(|file| file.is_file());
        let Some(file) = standing.filter(|_| !name.starts_with("truth")) else {
            let is_file = cells.iter().flatten().any(|cell| cell.contains('/'));
            if !is_file {
                sessions.keys.push(name.clone());
            }
            continue;
        };
        let place = match sort(&file) {
            Sort::Video => &mut sessions.video,
            Sort::Markers { .. } => &mut sessions.markers,
            Sort::Log { .. } => &mut sessions.log,
            Sort::Joints { .. } => &mut sessions.joints,
            _ => continue,
        };
        any |= place.is_none();
        place.get_or_insert_with(|| name.clone());
    }
    (any && !sessions.keys.is_empty()).then_some(sessions)
}
