//! Poses by their names: their order wherever they are listed, which is that of the thesis' figures (Fig. 51 and 53 to
//! 56), then the alphabet; and what names of poses and subjects look like slips.

use std::collections::{BTreeMap, BTreeSet};

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
    let people = as_people(&poses, names());
    let slips = as_poses(&poses, subjects().collect()).into_iter().chain(people).chain(misspelt).chain(places);
    slips.chain(poses_in_names(&names().collect::<Vec<_>>())).chain(again(names())).collect()
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

/// Names with so many digits in a row are a camera's, as `IMG_2041` and `20230412_101500` (assumed: people are numbered
/// with fewer).
const DIGITS: usize = 4;

/// Poses that have not one subject in common, subjects called as cameras call photographs: folders of people.
fn as_people<'a>(poses: &[&str], names: impl Iterator<Item = (&'a str, &'a str)>) -> Option<String> {
    let mut by_subject: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for (pose, subject) in names {
        by_subject.entry(subject).or_default().insert(pose);
    }
    let is_numbered = |name: &str| name.split(|c: char| !c.is_ascii_digit()).any(|run| run.len() >= DIGITS);
    let numbered = by_subject.keys().filter(|subject| is_numbered(subject)).count();
    let is_shared = by_subject.values().any(|poses| poses.len() > 1);
    let is_known = poses.iter().any(|pose| is_of_thesis(pose));
    let first = by_subject.keys().find(|subject| is_numbered(subject))?;
    (poses.len() > 1 && !is_shared && !is_known && 5 * numbered >= 4 * by_subject.len()).then(|| {
        let more = if poses.len() > NAMES { ", .." } else { "" };
        format!(
            "not one subject is in two of the {} poses ({}{more}), and subjects are called as photographs by a camera \
             (`{first}`): if these folders are people, every map mixes poses; folders are poses, \
             SET/<pose>/<subject>.png, or list all in photos.csv (file,subject,pose)",
            poses.len(),
            poses[..poses.len().min(NAMES)].join(", ")
        )
    })
}

/// The parts of a name, in small letters.
fn parts(name: &str) -> Vec<String> {
    name.split(|c: char| !c.is_alphanumeric()).filter(|part| !part.is_empty()).map(str::to_lowercase).collect()
}

/// Subjects whose names hold several poses of the thesis, which are not those that they are listed in.
fn poses_in_names(names: &[(&str, &str)]) -> Option<String> {
    let other = |(pose, subject): &(&str, &str)| {
        let (subject, own) = (parts(subject), parts(pose));
        let is_named = |one: &&&str| parts(one).iter().all(|part| subject.contains(part)) && parts(one) != own;
        THESIS_POSES.iter().filter(is_named).max_by_key(|one| one.len()).copied()
    };
    let all: Vec<(&str, &str)> = names.iter().filter_map(|name| Some((other(name)?, name.1))).collect();
    let (first, subject) = *all.first()?;
    let several = all.iter().any(|(pose, _)| *pose != first);
    (several && 2 * all.len() >= names.len()).then(|| {
        format!(
            "{} of {} subjects are called after a pose that is not the one that they are listed in (`{subject}` \
             first): poses are folders, SET/<pose>/<subject>.png, or are named in photos.csv (file,subject,pose)",
            all.len(),
            names.len()
        )
    })
}

/// What a program or a person appends to the name of a photograph that is there already has so many letters at most.
const APPENDED: usize = 5;

/// A number that is appended to a name has so many digits at most (assumed: more are a camera's or a date's).
const APPENDED_DIGITS: usize = 2;

/// Whether a name is another's and a number, `s05_2` or `s05 (2)`.
fn is_numbered_after(name: &str, other: &str) -> bool {
    let Some(tail) = name.strip_prefix(other).filter(|tail| tail.starts_with([' ', '_', '-', '('])) else {
        return false;
    };
    let number = tail.trim_matches([' ', '_', '-', '(', ')']);
    (1..=APPENDED_DIGITS).contains(&number.len()) && number.bytes().all(|byte| byte.is_ascii_digit())
}

/// Subjects whose names are another's and a little more, as of a photograph that was taken or saved again: of one pose,
/// or, where a number is what is more, of poses of which none has both.
fn again<'a>(names: impl Iterator<Item = (&'a str, &'a str)>) -> Option<String> {
    let mut by_pose: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    names.for_each(|(pose, subject)| {
        by_pose.entry(pose).or_default().insert(subject);
    });
    let of_pose = |subjects: &BTreeSet<&'a str>| -> Vec<[&'a str; 2]> {
        let first = |subject: &&'a str| {
            let ends = subject.char_indices().filter(|(_, c)| " _-(".contains(*c)).map(|(at, _)| at);
            let mut ends = ends.filter(|&at| subject.len() - at <= 1 + APPENDED + 1);
            Some([ends.find_map(|at| subjects.get(subject[..at].trim_end()).copied())?, *subject])
        };
        subjects.iter().filter_map(first).collect()
    };
    let mut all: Vec<[&str; 2]> = by_pose.values().flat_map(of_pose).collect();
    let subjects: BTreeSet<&str> = by_pose.values().flatten().copied().collect();
    for other in &subjects {
        let ends = other.char_indices().filter(|(_, c)| " _-(".contains(*c)).map(|(at, _)| at);
        let one = ends.filter_map(|at| subjects.get(other[..at].trim_end())).find(|one| is_numbered_after(other, one));
        let Some(one) = one else { continue };
        if !by_pose.values().any(|pose| pose.contains(one) && pose.contains(other)) {
            all.push([*one, *other]);
        }
    }
    let [one, other] = all.first()?;
    let more = if all.len() > 1 { format!(" ({} more)", all.len() - 1) } else { String::new() };
    Some(format!(
        "`{one}` and `{other}` count as two people{more}: are these photographs of one person? Keep one for each pose"
    ))
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

    #[test]
    fn people_in_place_of_poses_are_named_by_their_cameras_names() {
        let said = |names: &[(&str, &str)]| doubts(|| names.iter().copied()).join("; ");
        let people =
            [("anna", "IMG_2031"), ("anna", "IMG_2032"), ("ben", "IMG_2041"), ("ben", "IMG_2042"), ("ben", "b")];
        let answer = said(&people);
        assert!(answer.starts_with("not one subject is in two of the 2 poses (anna, ben), "), "{answer}");
        assert!(answer.contains("(`IMG_2031`)"), "{answer}");
        // Poses known as such, subjects in several, groups of people, one pose.
        let known = [("nominal", "IMG_2031"), ("flexion", "IMG_2032")];
        let shared = [("rest", "P1000"), ("press", "P1000"), ("press", "P1001")];
        let groups = [("men", "s01"), ("men", "s02"), ("women", "s103"), ("women", "anna")];
        let one = [("rest", "IMG_2031"), ("rest", "IMG_2032")];
        assert_eq!([said(&known), said(&shared), said(&groups), said(&one)].concat(), "");
    }

    #[test]
    fn poses_in_names_and_photographs_taken_again_are_named() {
        let said = |names: &[(&str, &str)]| doubts(|| names.iter().copied()).join("; ");
        let flat = ["a_normal", "a_flexion", "b_normal", "b-lateral-positive"].map(|subject| ("set", subject));
        assert!(said(&flat).starts_with("4 of 4 subjects are called after a pose"), "{}", said(&flat));
        let own = [("flexion", "a_flexion"), ("normal", "a_normal"), ("normal", "b_normal")];
        // A group of people that is called so.
        let group = [("rest", "normal_1"), ("rest", "normal_2"), ("rest", "patient_1")];
        assert_eq!([said(&own), said(&group)].concat(), "");
        for other in ["s01 (1)", "s01_2", "s01-b", "s01 copy"] {
            let said = said(&[("p", "s01"), ("p", other), ("rest", "s02")]);
            assert!(said.contains(&format!("`s01` and `{other}` count as two people: ")), "{said}");
        }
        let apart = said(&[("p", "s05"), ("rest", "s05_2"), ("p", "s06"), ("rest", "s06")]);
        assert!(apart.contains("`s05` and `s05_2` count as two people: "), "{apart}");
        let padded = said(&[("p", "s05"), ("rest", "S5"), ("p", "s06")]);
        assert!(padded.starts_with("subjects `S5` and `s05` differ in case, spaces or how numbers are"), "{padded}");
        let others = [("p", "s1"), ("p", "s10"), ("rest", "s1_b"), ("rest", "s1_2041"), ("p", "anna-maria")];
        assert_eq!(said(&[&others[..], &[("p", "s1_another"), ("rest", "s2_1"), ("p", "s2_2")]].concat()), "");
    }
}
