//! From files' names to a pattern: what differs becomes a place in braces.

use std::collections::BTreeMap;

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
    /// Of nails: from the last one on subject, pose.
    Nails,
    /// Of recordings: from the first one on subject, session, trial; a single one is a session.
    Recordings,
    /// The only one.
    One(&'a str),
}

impl PlaceNames<'_> {
    fn name(self, place: usize, count: usize) -> String {
        let (names, at): (&[&str], usize) = match self {
            Self::Nails => (&["subject", "pose"], count - 1 - place),
            Self::Recordings if count == 1 => (&["session"], place),
            Self::Recordings => (&["subject", "session", "trial"], place),
            Self::One(name) => return name.to_owned(),
        };
        names.get(at).map_or_else(|| format!("part{}", at + 1), |name| (*name).to_owned())
    }
}

/// The pattern of most of the files.
pub(super) fn shape(paths: &[String], places: PlaceNames<'_>) -> Option<NamePattern> {
    // Files of one depth, ending and top folder are of one pattern.
    let mut groups: BTreeMap<(usize, String, bool), Vec<&String>> = BTreeMap::new();
    for path in paths {
        let ending = path.rsplit_once('.').map_or("", |(_, ending)| ending).to_owned();
        groups.entry((path.matches('/').count(), ending, false)).or_default().push(path);
    }
    let (_, group) = groups.into_iter().max_by_key(|((depth, ..), group)| (group.len(), usize::MAX - depth))?;
    let parts: Vec<Vec<&str>> = group.iter().map(|path| stemmed(path)).collect();
    let depth = parts[0].len();
    let differs: Vec<usize> = (0..depth).filter(|&at| parts.iter().any(|part| part[at] != parts[0][at])).collect();
    let name = |place: usize| places.name(place, differs.len());
    let mut names = Vec::new();
    let mut pattern = Vec::new();
    for (at, &part) in parts[0].iter().enumerate() {
        match differs.iter().position(|&differing| differing == at) {
            Some(place) => {
                names.push(name(place));
                pattern.push(format!("{{{}}}", name(place)));
            }
            None => pattern.push(plain(part)),
        }
    }
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
