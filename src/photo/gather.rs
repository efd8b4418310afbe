//! Maps of many subjects from each one's own sums, going on from those that stand.
//!
//! In: folders that [`run`](super::run) wrote with [`PhotosOptions::parts`](super::PhotosOptions::parts), and perhaps
//! what was gathered before. Out:
//! maps, their partial sums and `members.json`, `nails.csv` of all, and figures where they are wanted. Sums are
//! integers: where all that was added before is still there with the same content, only what is new is read and added,
//! and the bytes are those of adding all.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use super::maps::Sums;
use super::members::{Member, Members};
use super::merge::{MergeError, read_nails};
use super::partial::{self, Held, PartialFault, Partials};
use super::report::{NailTable, PoseCount};
use super::results;
use crate::files::Staging;
use crate::stages::{Stage, Stages};

/// What was gathered.
#[derive(Debug)]
pub struct Gathered {
    /// Sums of every pose.
    pub partials: Partials,
    /// Subjects by pose.
    pub poses: Vec<PoseCount>,
    /// Files of sums that were read and added.
    pub added: usize,
    /// Those that sums standing from before held already.
    pub stood: usize,
    /// What a reader of the maps should know.
    pub warnings: Vec<String>,
    /// Time by stage.
    pub stages: Vec<Stage>,
}

/// A pose's members and the files that hold them.
type Files = BTreeMap<Member, PathBuf>;

/// Gathers `parts` into `staging`; `before` is where an earlier gathering stands.
///
/// # Errors
/// [`MergeError`].
pub fn gather(
    parts: &[PathBuf],
    before: Option<&Path>,
    figures: bool,
    staging: &Staging,
    stop: &AtomicBool,
) -> Result<Gathered, MergeError> {
    let stages = Stages::default();
    let (members, files) = stages.time("list sums", || list(parts))?;
    let before = before.and_then(|folder| Some((folder, Members::of_maps(folder)?)));
    let before = before.filter(|(_, standing)| standing.normalization == members.normalization);
    let add_up = |(pose, files): (&String, &Files)| {
        let standing = before.as_ref().and_then(|(folder, standing)| Some((*folder, standing.poses.get(pose)?)));
        let standing = standing.and_then(|(folder, known)| standing_sums(folder, pose, known, files, &members));
        let (mut sums, known) = match standing {
            Some((sums, known)) => (sums, Some(known)),
            None => (Sums::new(members.normalization.size), None),
        };
        let mut added = 0;
        for (_, file) in files.iter().filter(|(member, _)| known.is_none_or(|known| !known.contains(*member))) {
            if stop.load(Ordering::Relaxed) {
                return Err(MergeError::Interrupted);
            }
            let (meta, held) = partial::read(file)?;
            partial::agree(file, &meta, &members.normalization)?;
            partial::add(&mut sums, file, meta, held)?;
            added += 1;
        }
        Ok((pose.clone(), sums, added))
    };
    let summed: Vec<(String, Sums, usize)> =
        stages.time("add up", || files.par_iter().map(add_up).collect::<Result<_, MergeError>>())?;
    let added = summed.iter().map(|(_, _, added)| added).sum();
    let poses = summed.into_iter().map(|(pose, sums, _)| (pose, sums)).collect();
    let partials = Partials { normalization: members.normalization, poses };
    results::write_maps(&partials, figures, staging, &stages)?;
    members.write_of_maps(staging)?;
    stages.time("table of nails", || {
        let mut rows = Vec::new();
        for part in parts {
            rows.extend(read_nails(&part.join("nails.csv"))?);
        }
        Ok::<_, MergeError>(results::write_nails(NailTable::of_parts(rows).rows(), staging)?)
    })?;
    let counts = partials.poses.iter().map(|(pose, sums)| (pose, sums.subjects().len()));
    let poses: Vec<PoseCount> = counts.map(|(pose, subjects)| PoseCount { pose: pose.clone(), subjects }).collect();
    let alone = poses.iter().filter(|pose| pose.subjects == 1);
    let warnings = alone.map(|pose| super::job::one_subject(&pose.pose)).collect();
    let all: usize = files.values().map(BTreeMap::len).sum();
    Ok(Gathered { partials, poses, added, stood: all - added, warnings, stages: stages.list() })
}

/// What the parts hold, by pose, from their lists alone.
fn list(parts: &[PathBuf]) -> Result<(Members, BTreeMap<String, Files>), MergeError> {
    let mut all: Option<Members> = None;
    let mut files: BTreeMap<String, Files> = BTreeMap::new();
    let mut subjects: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for part in parts {
        let own = Members::read(part)
            .map_err(|why| PartialFault::Unreadable { file: part.join("partials/members.json"), why })?;
        let all = all.get_or_insert_with(|| Members::new(own.normalization));
        for (pose, members) in own.poses {
            for member in members {
                let file = part.join(partial::part_name(&pose));
                let counted = subjects.entry(pose.clone()).or_default();
                if let Some(subject) = member.subjects.iter().find(|subject| !counted.insert((*subject).clone())) {
                    return Err(PartialFault::Overlap { file, pose, subject: subject.clone() }.into());
                }
                all.add(&pose, member.clone());
                files.entry(pose.clone()).or_default().insert(member, file);
            }
        }
    }
    let all = all.ok_or_else(|| PartialFault::Nothing(parts.first().cloned().unwrap_or_default()))?;
    Ok((all, files))
}

/// The sums that stand, where all that they hold is to be added and was made in the same way.
fn standing_sums<'a>(
    folder: &Path,
    pose: &str,
    known: &'a BTreeSet<Member>,
    files: &Files,
    members: &Members,
) -> Option<(Sums, &'a BTreeSet<Member>)> {
    if known.is_empty() || !known.iter().all(|member| files.contains_key(member)) {
        return None;
    }
    let (meta, held) = partial::read(&folder.join(format!("maps/{pose}.partial.npz"))).ok()?;
    let subjects: BTreeSet<&str> = known.iter().flat_map(|m| &m.subjects).map(String::as_str).collect();
    let Held::Sums(sums) = held else { return None };
    let same = meta.pose == pose && meta.normalization == members.normalization && sums.subjects().eq(subjects);
    same.then_some((sums, known))
}
