//! From files' names to a pattern: what differs becomes a place in braces.

use std::collections::BTreeMap;

use crate::photo::is_of_thesis;

/// A pattern and how many files it is for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct NamePattern {
    pub(super) pattern: String,
    /// The places' names, in order.
    pub(super) names: Vec<String>,
    /// Their values, one list per file.
    pub(super) values: Vec<Vec<String>>,
    /// Files of the same sort that lie elsewhere or are called otherwise.
    pub(super) others: Vec<String>,
}

/// How the places of a pattern are called.
#[derive(Debug, Clone, Copy)]
pub(super) enum PlaceNames<'a> {
    /// Of nails: from the last one on subject, pose, but for the one whose values are the thesis' poses.
    Nails,
    /// Of recordings: from the first one on subject, session, trial; a single one is a session.
    Recordings,
    /// The only one.
    One(&'a str),
}

impl PlaceNames<'_> {
    /// Names of so many places; `pose` is the one of the poses, where values say it.
    fn names(self, count: usize, pose: Option<usize>) -> Vec<String> {
        let mut order: Vec<usize> = (0..count).collect();
        let known: &[&str] = match self {
            Self::Nails => {
                order.reverse();
                if let Some(pose) = pose.filter(|_| count > 1) {
                    order.retain(|place| *place != pose);
                    order.insert(1, pose);
                }
                &["subject", "pose"]
            }
            Self::Recordings if count == 1 => &["session"],
            Self::Recordings => &["subject", "session", "trial"],
            Self::One(name) => return vec![name.to_owned(); count],
        };
        let mut names = vec![String::new(); count];
        for (at, place) in order.into_iter().enumerate() {
            names[place] = known.get(at).map_or_else(|| format!("part{}", at + 1), |name| (*name).to_owned());
        }
        names
    }
}

/// The pattern of most of the files.
pub(super) fn shape(paths: &[String], places: PlaceNames<'_>) -> Option<NamePattern> {
    // Files of one depth and ending are of one pattern.
    let mut groups: BTreeMap<(usize, String), Vec<&String>> = BTreeMap::new();
    for path in paths {
        let ending = path.rsplit_once('.').map_or("", |(_, ending)| ending).to_owned();
        groups.entry((path.matches('/').count(), ending)).or_default().push(path);
    }
    let (_, group) = groups.into_iter().max_by_key(|((depth, _), group)| (group.len(), usize::MAX - depth))?;
    let parts: Vec<Vec<&str>> = group.iter().map(|path| stemmed(path)).collect();
    let depth = parts[0].len();
    let differs: Vec<usize> = (0..depth).filter(|&at| parts.iter().any(|part| part[at] != parts[0][at])).collect();
    // Of five files, four at least.
    let are_poses = |at: &usize| 5 * parts.iter().filter(|part| is_of_thesis(part[*at])).count() >= 4 * parts.len();
    let names = places.names(differs.len(), differs.iter().position(are_poses));
    let named = |at: usize| Some(&names[differs.iter().position(|&differing| differing == at)?]);
    let part = |(at, part): (usize, &&str)| named(at).map_or_else(|| plain(part), |name| format!("{{{name}}}"));
    let pattern: Vec<String> = parts[0].iter().enumerate().map(part).collect();
    let values = parts.iter().map(|part| differs.iter().map(|&at| part[at].to_owned()).collect()).collect();
    let ending = group[0].rsplit_once('.').map_or(String::new(), |(_, ending)| format!(".{ending}"));
    let others = paths.iter().filter(|path| !group.contains(path)).cloned().collect();
    Some(NamePattern { pattern: pattern.join("/") + &ending, names, values, others })
}

/// A path's names, the last without its ending.
fn stemmed(path: &str) -> Vec<&str> {
    let stem = path.rsplit_once('.').map_or(path, |(stem, _)| stem);
    stem.split('/').collect()
}

/// A name in which nothing is a wildcard.
fn plain(name: &str) -> String {
    // What means something in a pattern is any one character.
    name.chars().map(|c| if "*?[]{}".contains(c) { '?' } else { c }).collect()
}
