//! A study to files: recordings side by side, everything put in its place at the end.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use rayon::prelude::*;
use serde::Serialize;
use thiserror::Error;

use super::{RECORD, Recording, Study, StudyOptions, TABLES};
use lunula::files::{Staging, WriteError};
use lunula::job::{Interrupted, Watch};
use lunula::phantom::{Generated as _, Unwritten, in_the_way, refused};
use lunula::stages::{Stage, Stages};

/// Why a study was not written.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum StudyError {
    #[error("{} stands already and is no synthetic study's; choose another --out", .0.display())]
    InTheWay(PathBuf),
    #[error(transparent)]
    Write(#[from] Unwritten),
    #[error(transparent)]
    Place(#[from] WriteError),
    #[error("{name}: {why}")]
    Recording { name: String, why: lunula::phantom::Error },
    /// Stopped from outside; nothing was left behind.
    #[error("stopped")]
    Interrupted(#[from] Interrupted),
}

/// A study that was written.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StudySummary {
    /// Recordings, the tables among them.
    pub recordings: usize,
    /// Files.
    pub files: usize,
    /// Bytes of them.
    pub bytes: u64,
    /// Where the time went, seconds from a recording's beginning to its end, summed: several are made at a time.
    pub stages: Vec<Stage>,
    /// From beginning to end.
    pub total_s: f64,
}

/// Writes a study under `out`; a study written there before is replaced, unless somebody put files of their own into
/// its folders. The ticks count recordings.
///
/// # Errors
/// [`StudyError`]; what stood under `out` before is as it was.
pub fn write_watched(study: &Study, out: &Path, watch: &Watch<'_>) -> Result<StudySummary, StudyError> {
    let begin = Instant::now();
    let recordings = study.recordings();
    let before = stands(out);
    let folders: BTreeSet<String> = folders(study).into_iter().chain(before.iter().flat_map(folders)).collect();
    let mut folders: Vec<&str> = folders.iter().map(String::as_str).collect();
    // The record's folder first: where it stands, what is of one run and what of another is made again.
    folders.sort_by_key(|folder| *folder != TABLES);
    let staging = Staging::new(out)?;
    if let Some(place) = in_the_way(out, &folders, &format!("{TABLES}/{RECORD}")).or_else(|| foreign(out, &before)) {
        return Err(StudyError::InTheWay(place));
    }
    let stages = Stages::default();
    let done = AtomicU64::new(0);
    let within = Watch { tick: &|_, _| {}, ..*watch };
    // The longest first, so that none is left over at the end.
    let mut order: Vec<usize> = (0..recordings.len()).collect();
    order.sort_by(|&a, &b| {
        let cost = |k: usize| recordings[k].recording.cost().seconds;
        cost(b).total_cmp(&cost(a)).then(a.cmp(&b))
    });
    let made = order.into_par_iter().with_max_len(1).try_for_each(|k| -> Result<(), StudyError> {
        let one = &recordings[k];
        watch.go_on()?;
        let folder = staging.path().join(&one.name);
        fs::create_dir_all(&folder).map_err(refused(&folder))?;
        let written = stages.time(stage_of(&one.recording), || one.recording.write_watched(&folder, &within));
        watch.go_on()?;
        written.map_err(|why| StudyError::Recording { name: one.name.clone(), why })?;
        (watch.tick)(1 + done.fetch_add(1, Ordering::Relaxed), Some(recordings.len() as u64));
        Ok(())
    });
    made?;
    let (mut files, mut bytes) = (0, 0);
    for one in &recordings {
        for file in one.recording.files() {
            let path = staging.path().join(&one.name).join(file);
            bytes += fs::metadata(&path).map_err(refused(&path))?.len();
            files += 1;
        }
    }
    staging.commit_exactly(&folders)?;
    let total_s = begin.elapsed().as_secs_f64();
    Ok(StudySummary { recordings: recordings.len(), files, bytes, stages: stages.list(), total_s })
}

/// The outermost folders of a study: they are moved whole.
fn folders(study: &Study) -> BTreeSet<String> {
    study.recordings().iter().filter_map(|one| one.name.split('/').next().map(str::to_owned)).collect()
}

/// The study that was written there before.
fn stands(out: &Path) -> Option<Study> {
    let record = fs::read(out.join(TABLES).join(RECORD)).ok()?;
    let mut record: serde_json::Value = serde_json::from_slice(&record).ok()?;
    let options: StudyOptions = serde_json::from_value(record["study"].take()).ok()?;
    Study::new(options).ok()
}

/// A file in the folders of the study that stands there that is none of its own: somebody's results beside a recording.
fn foreign(out: &Path, before: &Option<Study>) -> Option<PathBuf> {
    let before = before.as_ref()?;
    let recordings = before.recordings();
    let files =
        recordings.iter().flat_map(|one| one.recording.files().into_iter().map(|file| out.join(&one.name).join(file)));
    let own: BTreeSet<PathBuf> = files.collect();
    let mut open: Vec<PathBuf> = folders(before).into_iter().map(|folder| out.join(folder)).collect();
    while let Some(folder) = open.pop() {
        for path in fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path()) {
            if path.is_dir() {
                open.push(path);
            } else if !own.contains(&path) {
                return Some(path);
            }
        }
    }
    None
}

fn stage_of(recording: &Recording) -> &'static str {
    match recording {
        Recording::Photos(_) => "photographs",
        Recording::Filmed { .. } => "videos",
        Recording::Log(_) => "logs",
        Recording::Press(_) => "presses",
        Recording::Texts(_) => "tables",
    }
}
