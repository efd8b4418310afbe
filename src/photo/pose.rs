//! Poses by their names: their order wherever they are listed, which is that of the thesis' figures (Fig. 51 and 53 to
//! 56), then the alphabet; and what names of poses and subjects look like slips.

use std::collections::BTreeMap;

use crate::words::{nearest, plain, twins};

/// The thesis' poses, by their names in folders and tables, in the order of its figures.
pub const THESIS_POSES: [&str; 8] = [
    "nominal",
    "normal",
    "lateral_negative",
    "lateral_positive",
    "longitudinal_negative",
    "longitudinal_positive",
    "extension",
    "flexion",
];

/// Whether a name is that of one of the thesis' poses, whatever its case and spaces.
pub(crate) fn is_of_thesis(name: &str) -> bool {
    THESIS_POSES.iter().any(|pose| plain(pose) == plain(name))
}

/// What poses are sorted by: the thesis' come first, in its order, all others after them by name.
pub(in crate::photo) fn rank(pose: &str) -> (usize, &str) {
    (THESIS_POSES.iter().position(|name| *name == pose).unwrap_or(THESIS_POSES.len()), pose)
}

/// Sorts what belongs to poses; what belongs to the same one stays in its order.
pub(in crate::photo) fn sort_by_pose<T>(items: &mut [T], pose: impl Fn(&T) -> &str) {
    items.sort_by(|a, b| rank(pose(a)).cmp(&rank(pose(b))));
}

/// Photographs from which on a pose may be what another was meant to be.
const USUAL: usize = 3;
/// Poses that a warning names.
const NAMES: usize = 3;

/// What is doubtful about the names of photographs' poses and subjects.
pub(in crate::photo) fn doubts<'a, I: Iterator<Item = (&'a str, &'a str)>>(names: impl Fn() -> I) -> Vec<String> {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    names().for_each(|(pose, _)| *counts.entry(pose).or_default() += 1);
    let mut poses: Vec<&str> = counts.keys().copied().collect();
    sort_by_pose(&mut poses, |pose| pose);
    let subjects = || names().map(|(_, subject)| subject);
    let misspelt = misspelt(&poses, &counts);
    let places = twins("subjects", subjects()).into_iter().chain(twins("poses", poses.iter().copied()));
    as_poses(&poses, subjects().collect()).into_iter().chain(misspelt).chain(places).collect()
}

/// Subjects that have the names of poses, where no pose has: folders of people, or columns that were exchanged.
fn as_poses(poses: &[&str], mut subjects: Vec<&str>) -> Option<String> {
    let all = subjects.len();
    subjects.retain(|subject| is_of_thesis(subject));
    let most = 5 * subjects.len() >= 4 * all;
    subjects.sort_unstable();
    subjects.dedup();
    (all > 0 && most && !poses.iter().any(|pose| is_of_thesis(pose))).then(|| {
        let more = if poses.len() > NAMES { ", .." } else { "" };
        format!(
            "the subjects are called {}, which are poses, and the poses {}{more}: people and poses stand in each \
             other's place, and every map mixes poses; folders are poses, SET/<pose>/<subject>.png, or list all in \
             photos.csv (file,subject,pose)",
            subjects.join(", "),
            poses[..poses.len().min(NAMES)].join(", ")
        )
    })
}

/// Poses of one photograph with a name that is nearly another's.
fn misspelt(poses: &[&str], counts: &BTreeMap<&str, usize>) -> Vec<String> {
    let (rare, usual): (Vec<&str>, Vec<&str>) = poses.iter().copied().partition(|pose| counts[pose] < USUAL);
    let one = |pose: &&str| {
        let meant = nearest(pose, &usual).filter(|meant| strsim::osa_distance(pose, meant) == 1)?;
        let is_numbered = |name: &str| name.ends_with(|last: char| last.is_ascii_digit());
        (!is_numbered(pose) || !is_numbered(meant)).then(|| {
            format!(
                "pose `{pose}` has {} photograph(s), and `{meant}` {}: is it misspelt?",
                counts[pose], counts[meant]
            )
        })
    };
    rare.iter().filter_map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_thesis_poses_come_first_and_in_its_order() {
        let mut poses = ["relaxed", "flexion", "Normal", "extension", "normal", "nominal"];
        sort_by_pose(&mut poses, |pose| pose);
        assert_eq!(poses, ["nominal", "normal", "extension", "flexion", "Normal", "relaxed"]);
    }
}
