//! Partial maps: the sums of one pose in a file (`maps/<pose>.partial.npz`), and how they join.
//!
//! An NPZ archive of `sum` (uint64, values of 0 to 65535), `sum_sq` (uint64), `count` (uint32), each `size` x `size`,
//! and `meta` (uint8): a JSON text with the format's version, the pose, the normalization and the subjects' names.
//! `numpy.load(..)["meta"].tobytes()` shows it.
//!
//! One subject's, as pipelines keep them apart (`partials/<pose>.partial.npz`), are its levels themselves, a sixth of
//! the size: `level` (uint16) and, where the photograph does not show all, `seen` (uint8, 0 or 1); format 2.

use std::collections::{BTreeMap, BTreeSet};
use std::io::Cursor;
use std::path::{Path, PathBuf};

use ndarray::{Array1, ArrayView2};
use ndarray_npy::NpzWriter;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::look::{Look, one_picture, seen_again};
use super::maps::Sums;
use super::members::{Members, OF_A_PART};
use super::npz::Npz;
use crate::input;
use crate::photo::normalize::{Normalization, Normalized};

/// Of sums.
const FORMAT: u32 = 1;
/// Of one subject's levels.
const FORMAT_OF_ONE: u32 = 2;

/// Bytes of an archive beside its arrays, as it is written: their headers, the directory and a common `meta`.
const HEADERS: usize = 16 << 10;
/// Bytes of a partial map's `meta`: what 80,000 subjects' photographs look like.
const MOST_META: u64 = 64 << 20;

/// Why partial maps can't be read or don't join.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum PartialFault {
    #[error("{}: is not a partial map ({why}); name a folder that `lunula photos` wrote", .file.display())]
    Unreadable { file: PathBuf, why: String },
    #[error("{}: has format {found}, this version reads {FORMAT} and {FORMAT_OF_ONE}; make it again", .file.display())]
    Version { file: PathBuf, found: u32 },
    #[error(
        "{}: pose `{pose}` was made with {found}, the parts before it with {expected}; make one of them again",
        .file.display()
    )]
    Options {
        file: PathBuf,
        pose: String,
        /// Its options, as JSON.
        found: String,
        /// The others' options, as JSON.
        expected: String,
    },
    #[error(
        "{}: subject `{subject}` of pose `{pose}` is in an earlier part too; a subject counts once: leave one out",
        .file.display()
    )]
    Overlap { file: PathBuf, pose: String, subject: String },
    #[error(
        "{}: holds no run.json with maps/<pose>.partial.npz; name a folder that `lunula photos` wrote",
        .0.display()
    )]
    Nothing(PathBuf),
}

/// What a partial map says of itself.
#[derive(Serialize, Deserialize)]
pub(super) struct Meta {
    format: u32,
    pub(super) pose: String,
    pub(super) normalization: Normalization,
    subjects: BTreeSet<String>,
    /// Those whose photographs are grey.
    #[serde(default, skip_serializing_if = "BTreeSet::is_empty")]
    grey: BTreeSet<String>,
    /// What their photographs look like.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    looks: BTreeMap<String, Look>,
}

/// What a partial map holds.
pub(super) enum Held {
    /// Sums over subjects.
    Sums(Sums),
    /// One subject's picture.
    One(String, Normalized),
}

/// Sums of every pose, all made with one normalization.
#[derive(Debug, Clone, PartialEq)]
pub struct Partials {
    /// What the normalized pictures were made with.
    pub normalization: Normalization,
    /// By pose.
    pub poses: BTreeMap<String, Sums>,
}

impl Partials {
    /// What to say of people who have one photograph.
    pub(in crate::photo) fn one_picture(&self) -> Option<String> {
        let looks = self.poses.iter().flat_map(|(pose, sums)| {
            sums.looks.iter().map(move |(subject, look)| ((pose.as_str(), subject.as_str()), look))
        });
        let pairs = seen_again(looks, |(_, one), (_, other)| one != other);
        let names = |pair: [(&str, &str); 2]| pair.map(|(pose, subject)| format!("{subject} of {pose}"));
        one_picture(&pairs.into_iter().map(names).collect::<Vec<_>>())
    }
}

/// A file of one pose's sums.
pub(in crate::photo) fn bytes(pose: &str, sums: &Sums, with: &Normalization) -> anyhow::Result<Vec<u8>> {
    let shape = (sums.size, sums.size);
    let mut npz = archive(20 * sums.sum.len());
    npz.add_array("sum", &ArrayView2::from_shape(shape, &sums.sum)?)?;
    npz.add_array("sum_sq", &ArrayView2::from_shape(shape, &sums.sum_sq)?)?;
    npz.add_array("count", &ArrayView2::from_shape(shape, &sums.count)?)?;
    npz.add_array("meta", &meta(FORMAT, pose, sums, with)?)?;
    Ok(npz.finish()?.into_inner())
}

/// The same; one subject's as its levels.
pub(in crate::photo) fn bytes_of_part(pose: &str, sums: &Sums, with: &Normalization) -> anyhow::Result<Vec<u8>> {
    if sums.subjects.len() == 1 { bytes_of_one(pose, sums, with) } else { bytes(pose, sums, with) }
}

fn bytes_of_one(pose: &str, sums: &Sums, with: &Normalization) -> anyhow::Result<Vec<u8>> {
    let shape = (sums.size, sums.size);
    let level = |&sum: &u64| u16::try_from(sum).expect("one subject's sum is its level");
    let levels: Vec<u16> = sums.sum.iter().map(level).collect();
    let mut npz = archive(3 * levels.len());
    npz.add_array("level", &ArrayView2::from_shape(shape, &levels)?)?;
    if sums.count.contains(&0) {
        let seen: Vec<u8> = sums.count.iter().map(|&count| u8::from(count > 0)).collect();
        npz.add_array("seen", &ArrayView2::from_shape(shape, &seen)?)?;
    }
    npz.add_array("meta", &meta(FORMAT_OF_ONE, pose, sums, with)?)?;
    Ok(npz.finish()?.into_inner())
}

/// An archive of about so many bytes of arrays. In memory, for a file that fails in the middle can't be
/// finished: zip asserts that it can.
fn archive(bytes: usize) -> NpzWriter<Cursor<Vec<u8>>> {
    NpzWriter::new(Cursor::new(Vec::with_capacity(bytes + HEADERS)))
}

fn meta(format: u32, pose: &str, sums: &Sums, normalization: &Normalization) -> serde_json::Result<Array1<u8>> {
    let (subjects, grey, looks) = (sums.subjects.clone(), sums.grey.clone(), sums.looks.clone());
    let meta = Meta { format, pose: pose.to_owned(), normalization: *normalization, subjects, grey, looks };
    Ok(Array1::from(serde_json::to_vec(&meta)?))
}

/// Joins the partial maps of several results of `lunula photos`.
///
/// # Errors
/// [`PartialFault`]: unreadable, of another version or other options, or with a subject in two parts.
pub fn join(parts: &[PathBuf]) -> Result<Partials, PartialFault> {
    let mut joined: Option<Partials> = None;
    for part in parts {
        for file in partial_files(part)? {
            let (meta, held) = read(&file)?;
            let joined =
                joined.get_or_insert_with(|| Partials { normalization: meta.normalization, poses: BTreeMap::new() });
            agree(&file, &meta, &joined.normalization)?;
            let whole = joined.poses.entry(meta.pose.clone()).or_insert_with(|| Sums::new(meta.normalization.size));
            add(whole, &file, meta, held)?;
        }
    }
    joined.ok_or_else(|| PartialFault::Nothing(parts.first().cloned().unwrap_or_default()))
}

/// Checks that a partial map is made as the others.
pub(super) fn agree(file: &Path, meta: &Meta, expected: &Normalization) -> Result<(), PartialFault> {
    if meta.normalization == *expected {
        return Ok(());
    }
    let text = |n: &Normalization| serde_json::to_string(n).unwrap_or_default();
    Err(PartialFault::Options {
        file: file.to_owned(),
        pose: meta.pose.clone(),
        found: text(&meta.normalization),
        expected: text(expected),
    })
}

/// Adds what a partial map holds.
pub(super) fn add(whole: &mut Sums, file: &Path, meta: Meta, held: Held) -> Result<(), PartialFault> {
    let added = match held {
        Held::Sums(sums) => whole.merge(&sums),
        Held::One(subject, picture) => {
            whole.grey.extend(meta.grey);
            whole.looks.extend(meta.looks);
            whole.add(&subject, &[picture])
        }
    };
    added.map_err(|both| PartialFault::Overlap { file: file.to_owned(), pose: meta.pose, subject: both.0 })
}

/// The partial maps that the part's own `run.json` names: an earlier run's may stand beside them. Of a pipeline's part,
/// those of its list.
fn partial_files(part: &Path) -> Result<Vec<PathBuf>, PartialFault> {
    let nothing = || PartialFault::Nothing(part.to_owned());
    let Ok(text) = input::read(&part.join("run.json")) else {
        let members = Members::read(&part.join(OF_A_PART)).map_err(|_| nothing())?;
        return Ok(members.poses.keys().map(|pose| part.join(part_name(pose))).collect());
    };
    let run: serde_json::Value = serde_json::from_slice(&text).map_err(|_| nothing())?;
    let poses = run["poses"].as_array().ok_or_else(nothing)?.iter().filter_map(|p| p["pose"].as_str());
    let files: Vec<PathBuf> = poses.map(|pose| part.join(format!("maps/{pose}.partial.npz"))).collect();
    if files.is_empty() { Err(nothing()) } else { Ok(files) }
}

/// Where a part of a pipeline keeps a pose's sums.
pub(in crate::photo) fn part_name(pose: &str) -> String {
    format!("partials/{pose}.partial.npz")
}

pub(super) fn read(path: &Path) -> Result<(Meta, Held), PartialFault> {
    let unreadable = |why: String| PartialFault::Unreadable { file: path.to_owned(), why };
    let mut npz = Npz::open(path).map_err(unreadable)?;
    let text = npz.text("meta", MOST_META).map_err(unreadable)?;
    let json: serde_json::Value = serde_json::from_slice(&text).map_err(|e| unreadable(e.to_string()))?;
    let known = [FORMAT, FORMAT_OF_ONE].map(u64::from);
    if let Some(found) = json["format"].as_u64().filter(|found| !known.contains(found)) {
        return Err(PartialFault::Version { file: path.to_owned(), found: found as u32 });
    }
    let meta: Meta = serde_json::from_value(json).map_err(|e| unreadable(e.to_string()))?;
    let size = meta.normalization.check().map_err(unreadable)?.size;
    if !meta.grey.iter().chain(meta.looks.keys()).all(|subject| meta.subjects.contains(subject)) {
        return Err(unreadable("describes the photograph of a subject that it does not hold".into()));
    }
    if meta.format == FORMAT_OF_ONE {
        let Some(subject) = meta.subjects.first().filter(|_| meta.subjects.len() == 1).cloned() else {
            return Err(unreadable("holds levels, which are one subject's, and names none or several".into()));
        };
        let levels = npz.square::<u16>("level", size).map_err(unreadable)?;
        let has_seen = npz.has("seen");
        let seen = has_seen.then(|| npz.square::<u8>("seen", size)).transpose().map_err(unreadable)?;
        let seen = seen.map(|seen| seen.into_iter().map(|seen| seen > 0).collect());
        return Ok((meta, Held::One(subject, Normalized { size, levels, seen })));
    }
    let sum = npz.square("sum", size).map_err(unreadable)?;
    let sum_sq = npz.square("sum_sq", size).map_err(unreadable)?;
    let count = npz.square("count", size).map_err(unreadable)?;
    let (subjects, grey, looks) = (meta.subjects.clone(), meta.grey.clone(), meta.looks.clone());
    let sums = Sums { size, sum, sum_sq, count, subjects, grey, looks };
    if !sums.are_possible() {
        return Err(unreadable("its sums contradict one another".into()));
    }
    Ok((meta, Held::Sums(sums)))
}
