//! Partial maps: the sums of one pose in a file (`maps/<pose>.partial.npz`), and how they join.
//!
//! An NPZ archive of `sum` (uint64, values of 0 to 65535), `sum_sq` (uint64), `count` (uint32), each `size` x `size`,
//! and `meta` (uint8): a JSON text with the format's version, the pose, the normalization and the subjects' names.
//! `numpy.load(..)["meta"].tobytes()` shows it.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::io::{BufReader, BufWriter, Write};
use std::path::{Path, PathBuf};

use ndarray::{Array1, Array2};
use ndarray_npy::{NpzReader, NpzWriter};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::maps::Sums;
use super::normalize::Normalization;

const FORMAT: u32 = 1;

/// Why partial maps can't be read or don't join.
#[derive(Debug, Error)]
pub enum PartialFault {
    /// Not readable as a partial map.
    #[error("{}: is no partial map ({why}); name a folder that `lunula photos` wrote", .file.display())]
    Unreadable {
        /// Which file.
        file: PathBuf,
        /// What is wrong with it.
        why: String,
    },
    /// Written by another version.
    #[error("{}: has format {found}, this version reads {FORMAT}; make it anew", .file.display())]
    Version {
        /// Which file.
        file: PathBuf,
        /// Its format.
        found: u32,
    },
    /// Made with other options.
    #[error("{}: pose `{pose}` was made with {found}, the parts before it with {expected}; make one of them anew", .file.display())]
    Options {
        /// Which file.
        file: PathBuf,
        /// Whose maps.
        pose: String,
        /// Its options, as JSON.
        found: String,
        /// The others' options, as JSON.
        expected: String,
    },
    /// A subject is in two parts.
    #[error("{}: subject `{subject}` of pose `{pose}` is in an earlier part too; a subject counts once: leave one out", .file.display())]
    Overlap {
        /// Which file.
        file: PathBuf,
        /// Whose maps.
        pose: String,
        /// The subject in both.
        subject: String,
    },
    /// Nothing to join.
    #[error("{}: holds no run.json with maps/<pose>.partial.npz; name a folder that `lunula photos` wrote", .0.display())]
    Nothing(PathBuf),
}

#[derive(Serialize, Deserialize)]
struct Meta {
    format: u32,
    pose: String,
    normalization: Normalization,
    subjects: BTreeSet<String>,
}

/// Sums of every pose, all made with one normalization.
#[derive(Debug, Clone, PartialEq)]
pub struct Partials {
    /// What the normalized pictures were made with.
    pub normalization: Normalization,
    /// By pose.
    pub poses: BTreeMap<String, Sums>,
}

/// Writes one pose's sums.
///
/// # Errors
/// Where the file can't be written.
pub(super) fn write(path: &Path, pose: &str, sums: &Sums, normalization: &Normalization) -> anyhow::Result<()> {
    let subjects = sums.subjects.clone();
    let meta = Meta { format: FORMAT, pose: pose.to_owned(), normalization: *normalization, subjects };
    let shape = (sums.size, sums.size);
    let mut file = BufWriter::new(File::create(path)?);
    let mut npz = NpzWriter::new(&mut file);
    npz.add_array("sum", &ndarray::ArrayView2::from_shape(shape, &sums.sum)?)?;
    npz.add_array("sum_sq", &ndarray::ArrayView2::from_shape(shape, &sums.sum_sq)?)?;
    npz.add_array("count", &ndarray::ArrayView2::from_shape(shape, &sums.count)?)?;
    npz.add_array("meta", &Array1::from(serde_json::to_vec(&meta)?))?;
    npz.finish()?;
    file.flush()?;
    Ok(())
}

/// Joins the partial maps of several results of `lunula photos`.
///
/// # Errors
/// [`PartialFault`]: unreadable, of another version or other options, or with a subject in two parts.
pub fn join(parts: &[PathBuf]) -> Result<Partials, PartialFault> {
    let mut joined: Option<Partials> = None;
    for part in parts {
        for file in partial_files(part)? {
            let (meta, sums) = read(&file)?;
            let joined =
                joined.get_or_insert_with(|| Partials { normalization: meta.normalization, poses: BTreeMap::new() });
            if joined.normalization != meta.normalization {
                let text = |n: &Normalization| serde_json::to_string(n).unwrap_or_default();
                return Err(PartialFault::Options {
                    file,
                    pose: meta.pose,
                    found: text(&meta.normalization),
                    expected: text(&joined.normalization),
                });
            }
            let whole = joined.poses.entry(meta.pose.clone()).or_insert_with(|| Sums::new(sums.size));
            whole.merge(&sums).map_err(|both| PartialFault::Overlap { file, pose: meta.pose, subject: both.0 })?;
        }
    }
    joined.ok_or_else(|| PartialFault::Nothing(parts.first().cloned().unwrap_or_default()))
}

/// The partial maps that the part's own `run.json` names: an earlier run's may stand beside them.
fn partial_files(part: &Path) -> Result<Vec<PathBuf>, PartialFault> {
    let nothing = || PartialFault::Nothing(part.to_owned());
    let text = std::fs::read(part.join("run.json")).map_err(|_| nothing())?;
    let run: serde_json::Value = serde_json::from_slice(&text).map_err(|_| nothing())?;
    let poses = run["poses"].as_array().ok_or_else(nothing)?.iter().filter_map(|p| p["pose"].as_str());
    let files: Vec<PathBuf> = poses.map(|pose| part.join(format!("maps/{pose}.partial.npz"))).collect();
    if files.is_empty() { Err(nothing()) } else { Ok(files) }
}

fn read(path: &Path) -> Result<(Meta, Sums), PartialFault> {
    let unreadable = |why: String| PartialFault::Unreadable { file: path.to_owned(), why };
    let file = File::open(path).map_err(|e| unreadable(e.to_string()))?;
    let mut npz = NpzReader::new(BufReader::new(file)).map_err(|e| unreadable(e.to_string()))?;
    let meta: Array1<u8> = npz.by_name("meta").map_err(|e| unreadable(e.to_string()))?;
    let (bytes, _) = meta.into_raw_vec_and_offset();
    let json: serde_json::Value = serde_json::from_slice(&bytes).map_err(|e| unreadable(e.to_string()))?;
    if let Some(found) = json["format"].as_u64().filter(|&f| f != u64::from(FORMAT)) {
        return Err(PartialFault::Version { file: path.to_owned(), found: found as u32 });
    }
    let meta: Meta = serde_json::from_value(json).map_err(|e| unreadable(e.to_string()))?;
    let normalization = meta.normalization.check().map_err(unreadable)?;
    let size = normalization.size;
    let mut wide = |name: &str| -> Result<Vec<u64>, PartialFault> {
        let array: Array2<u64> = npz.by_name(name).map_err(|e| unreadable(e.to_string()))?;
        expect_size(array.dim(), size).map_err(unreadable)?;
        Ok(array.into_iter().collect())
    };
    let (sum, sum_sq) = (wide("sum")?, wide("sum_sq")?);
    let count: Array2<u32> = npz.by_name("count").map_err(|e| unreadable(e.to_string()))?;
    expect_size(count.dim(), size).map_err(unreadable)?;
    let sums = Sums { size, sum, sum_sq, count: count.into_iter().collect(), subjects: meta.subjects.clone() };
    if !sums.are_possible() {
        return Err(unreadable("its sums contradict one another".into()));
    }
    Ok((meta, sums))
}

fn expect_size((rows, columns): (usize, usize), size: usize) -> Result<(), String> {
    if (rows, columns) == (size, size) {
        Ok(())
    } else {
        Err(format!("an array of {rows} x {columns}, not {size} x {size}"))
    }
}
