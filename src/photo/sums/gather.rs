//! Maps of many subjects from each one's own sums, adding to those of an earlier gathering.
//!
//! In: folders that [`run`](fn@crate::photo::run) wrote as [`Results::Sums`](crate::photo::Results::Sums), and perhaps
//! what was gathered before. Out: maps, their partial sums and `members.json`, `nails.csv` of all, and figures where
//! they are wanted. Sums are integers: where all that was added before is still there with the same content, only what
//! is new is read and added, and the bytes are those of adding all.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use serde::Serialize;

use super::accuracy::Accuracy;
use super::maps::Sums;
use super::members::{Member, Members, OF_A_PART, OF_MAPS};
use super::partial::{self, Held, PartialFault, Partials};
use crate::files::Staging;
use crate::job::{Report, Watch};
use crate::photo::error::MergeError;
use crate::photo::normalize::Normalization;
use crate::photo::pose;
use crate::photo::results::{NailTable, write_maps};
use crate::photo::run::report::{PoseCount, doubts_of_sums, one_subject, pose_counts};
use crate::stages::Stages;

/// What is gathered, and where results go.
#[derive(Debug, Clone)]
pub struct Gathering<'a> {
    /// Folders of sums.
    pub parts: &'a [PathBuf],
    /// Where an earlier gathering of them, or of some, is.
    pub before: Option<&'a Path>,
    /// Exact maps to compare with: `<pose>-mean.npy` and `<pose>-sd.npy`.
    pub truth: Option<&'a Path>,
    /// Whether figures are drawn.
    pub figures: bool,
    /// Folder for the results.
    pub out: &'a Path,
}

/// What was gathered.
pub type GatherReport = Report<GatherFigures>;

/// The figures of a gathering.
#[derive(Debug, Clone, Serialize)]
pub struct GatherFigures {
    /// Subjects by pose.
    pub poses: Vec<PoseCount>,
    /// Files of sums that were read and added.
    pub sums_added: usize,
    /// Those that the earlier gathering held already.
    pub sums_kept: usize,
    /// What the normalized pictures were made with.
    pub normalization: Normalization,
    /// How good the maps are.
    #[serde(skip)]
    pub accuracy: Accuracy,
}

/// A pose's members and the files that hold them.
type Files = BTreeMap<Member, PathBuf>;

/// Gathers sums and puts the maps in their place.
///
/// # Errors
/// [`MergeError`]; nothing is written then.
pub fn gather(gathering: &Gathering, watch: &Watch<'_>) -> Result<GatherReport, MergeError> {
    let Gathering { parts, before, truth, figures, out } = *gathering;
    let stages = Stages::default();
    let staging = Staging::new(out)?;
    let (members, files) = stages.time("list sums", || list(parts))?;
    let before = before.and_then(|folder| Some((folder, Members::read(&folder.join(OF_MAPS)).ok()?)));
    let before = before.filter(|(_, earlier)| earlier.normalization == members.normalization);
    let add_up = |(pose, files): (&String, &Files)| {
        let earlier = before.as_ref().and_then(|(folder, earlier)| Some((*folder, earlier.poses.get(pose)?)));
        let earlier = earlier.and_then(|(folder, known)| earlier_sums(folder, pose, known, files, &members));
        let (mut sums, known) = match earlier {
            Some((sums, known)) => (sums, Some(known)),
            None => (Sums::new(members.normalization.size), None),
        };
        let mut added = 0;
        for (_, file) in files.iter().filter(|(member, _)| known.is_none_or(|known| !known.contains(*member))) {
            watch.go_on()?;
            let (meta, held) = partial::read(file)?;
            partial::agree(file, &meta, &members.normalization)?;
            partial::add(&mut sums, file, meta, held)?;
            added += 1;
        }
        Ok((pose.clone(), sums, added))
    };
    let summed: Vec<(String, Sums, usize)> =
        stages.time("add up", || files.par_iter().map(add_up).collect::<Result<_, MergeError>>())?;
    let sums_added = summed.iter().map(|(_, _, added)| added).sum();
    let poses = summed.into_iter().map(|(pose, sums, _)| (pose, sums)).collect();
    let partials = Partials { normalization: members.normalization, poses };
    write_maps(&partials, figures, &staging, &stages)?;
    members.write(&staging, OF_MAPS)?;
    let nails = NailTable::of_parts(parts)?;
    stages.time("table of nails", || nails.write(&staging))?;
    let accuracy = stages.time("accuracy", || Accuracy::of(&partials, truth))?;
    staging.commit()?;

    let poses = pose_counts(&partials);
    let sums_kept = files.values().map(BTreeMap::len).sum::<usize>() - sums_added;
    let left_out = (sums_kept > 0)
        .then(|| format!("sums: {sums_kept} are part of the maps made before, and are not read again"))
        .into_iter()
        .collect();
    let notes = one_subject(&poses).into_iter().collect();
    let mut warnings = doubts_of_sums(&partials);
    warnings.extend(pose::doubts(|| members.names()).into_iter().chain(nails.at_one_place()));
    let figures = GatherFigures { poses, sums_added, sums_kept, normalization: partials.normalization, accuracy };
    Ok(Report { left_out, warnings, notes, ..Report::new("maps", watch, figures) }.timed(&stages))
}

/// What the parts hold, by pose, from their lists alone.
fn list(parts: &[PathBuf]) -> Result<(Members, BTreeMap<String, Files>), MergeError> {
    let mut all: Option<Members> = None;
    let mut files: BTreeMap<String, Files> = BTreeMap::new();
    let mut subjects: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for part in parts {
        let list = part.join(OF_A_PART);
        let own = Members::read(&list).map_err(|why| PartialFault::Unreadable { file: list, why })?;
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

/// The sums that exist, where all that they hold is to be added and was made in the same way.
fn earlier_sums<'a>(
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
