//! Which rows are held out.
//!
//! In: a [`Dataset`]. Out: folds, each with the rows to train on and the rows to test on. What follows each other in
//! time is alike, so rows of one trajectory on both sides flatter a model: 1.4 to 2 times on this field's data. Whole
//! trajectories, sessions or subjects are held out; shuffled rows only when asked for.

use std::collections::BTreeMap;

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::Serialize;
use thiserror::Error;

use crate::data::path::paths;
use crate::{Dataset, Recording};

/// What is held out at a time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum By {
    /// A recording.
    Trajectory,
    /// All recordings that follow one prompted path ([`paths`](crate::paths)).
    Path,
    /// All recordings of one session of one subject; a recording without a session is one of its own.
    Session,
    /// All recordings of one subject; a recording without a subject is one of its own.
    Subject,
    /// Shuffled rows: it flatters, as rows nearby in time stand on both sides.
    Rows {
        /// In how many parts.
        folds: usize,
        /// Decides which rows come into which part.
        seed: u64,
    },
}

impl By {
    /// Whether a part counts as one value, however many rows it has: what is said is of new persons, sessions, paths or
    /// recordings, and errors within one are alike. Shuffled rows say nothing of new ones.
    #[must_use]
    pub fn counts_parts(self) -> bool {
        !matches!(self, Self::Rows { .. })
    }
}

/// One part held out.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fold {
    /// What is held out.
    pub name: String,
    /// The rows to train on, ascending.
    pub train: Vec<usize>,
    /// The rows held out, ascending.
    pub test: Vec<usize>,
}

/// Why nothing can be held out.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum SplitFault {
    #[error("there is only one {what} with rows; to hold one out, give at least two: {instead}")]
    One { what: &'static str, instead: &'static str },
    #[error("{rows} rows can't be split into {folds} parts; ask for 2 to {rows}")]
    Folds { rows: usize, folds: usize },
    #[error("there are no rows to split")]
    Empty,
}

/// The folds of a set, in the order in which their recordings first come.
pub fn folds(data: &Dataset, by: By) -> Result<Vec<Fold>, SplitFault> {
    if data.rows() == 0 {
        return Err(SplitFault::Empty);
    }
    let parts = match by {
        By::Rows { folds, seed } => shuffled(data.rows(), folds, seed)?,
        _ => groups(data, by),
    };
    if parts.len() < 2 {
        let (what, instead) = match by {
            By::Session => ("session", "name more sessions, or hold out trajectories"),
            By::Path => ("path", "record another, such as random movement, or hold out trajectories"),
            By::Subject => ("subject", "add other subjects' recordings, or hold out sessions or trajectories"),
            _ => ("trajectory", "cut the recording into parts, or give another for validation"),
        };
        return Err(SplitFault::One { what, instead });
    }
    let mut part_of = vec![0; data.rows()];
    for (k, part) in parts.iter().enumerate() {
        part.1.iter().for_each(|&row| part_of[row] = k);
    }
    let fold =
        |(k, (name, test))| Fold { name, train: (0..data.rows()).filter(|&row| part_of[row] != k).collect(), test };
    Ok(parts.into_iter().enumerate().map(fold).collect())
}

/// Names and rows of the groups that have rows; of `By::Rows` each recording.
fn groups(data: &Dataset, by: By) -> Vec<(String, Vec<usize>)> {
    let recordings = data.recordings();
    let several_subjects = recordings.windows(2).any(|pair| pair[0].subject != pair[1].subject);
    let path = if by == By::Path { paths(data) } else { Vec::new() };
    let mut place = BTreeMap::new();
    let mut all: Vec<(String, Vec<usize>)> = Vec::new();
    for (k, one) in recordings.iter().enumerate().filter(|(_, one)| !one.rows.is_empty()) {
        let key = match by {
            By::Session if !one.session.is_empty() => Ok((&one.subject, Some(&one.session))),
            By::Subject if !one.subject.is_empty() => Ok((&one.subject, None)),
            By::Path => Err(path[k]),
            _ => Err(k),
        };
        let at = *place.entry(key).or_insert_with(|| {
            let name = match by {
                By::Subject => one.subject.clone(),
                By::Session if several_subjects && !one.session.is_empty() && !one.subject.is_empty() => {
                    format!("{}/{}", one.subject, one.session)
                }
                By::Session => one.session.clone(),
                _ => String::new(),
            };
            let name = if name.is_empty() { recording_name(one, k) } else { name };
            all.push((distinct(name, &all), Vec::new()));
            all.len() - 1
        });
        all[at].1.extend(one.rows.clone());
    }
    all
}

fn recording_name(one: &Recording, place: usize) -> String {
    if one.name.is_empty() { format!("recording {}", place + 1) } else { one.name.clone() }
}

/// A name that no part has yet.
fn distinct(name: String, taken: &[(String, Vec<usize>)]) -> String {
    let free = |name: &String| taken.iter().all(|(other, _)| other != name);
    let numbered = (2..).map(|k| format!("{name} ({k})"));
    std::iter::once(name.clone()).chain(numbered).find(free).unwrap_or(name)
}

/// Rows dealt out after a shuffle. Rows are sorted by random keys, which no version of a library's shuffle changes.
fn shuffled(rows: usize, folds: usize, seed: u64) -> Result<Vec<(String, Vec<usize>)>, SplitFault> {
    if folds < 2 || folds > rows {
        return Err(SplitFault::Folds { rows, folds });
    }
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut keyed: Vec<(u64, usize)> = (0..rows).map(|row| (random.next_u64(), row)).collect();
    keyed.sort_unstable();
    let part = |k: usize| {
        let mut test: Vec<usize> = keyed.iter().skip(k).step_by(folds).map(|&(_, row)| row).collect();
        test.sort_unstable();
        (format!("rows {}", k + 1), test)
    };
    Ok((0..folds).map(part).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluate::fixture::{line, recordings};

    fn named(data: &Dataset, by: By) -> Vec<(String, usize)> {
        folds(data, by).unwrap().into_iter().map(|fold| (fold.name, fold.test.len())).collect()
    }

    #[test]
    fn whole_trajectories_sessions_and_subjects() {
        // Two subjects' sessions of the same name are not the same session; sizes differ widely.
        let all =
            [("s1", "1", "a", 1), ("s2", "1", "a", 400), ("s3", "2", "a", 3), ("s1", "1", "b", 5), ("s5", "", "", 2)];
        let data = recordings(&all);
        let named = |by| named(&data, by);
        let pairs = |all: &[(&str, usize)]| all.iter().map(|&(name, n)| (name.to_owned(), n)).collect::<Vec<_>>();
        assert_eq!(named(By::Trajectory), pairs(&[("s1", 1), ("s2", 400), ("s3", 3), ("s1 (2)", 5), ("s5", 2)]));
        assert_eq!(named(By::Session), pairs(&[("a/1", 401), ("a/2", 3), ("b/1", 5), ("s5", 2)]));
        assert_eq!(named(By::Subject), pairs(&[("a", 404), ("b", 5), ("s5", 2)]));
        for by in [By::Trajectory, By::Path, By::Session, By::Subject, By::Rows { folds: 7, seed: 3 }] {
            let folds = folds(&data, by).unwrap();
            let mut tested: Vec<usize> = folds.iter().flat_map(|fold| fold.test.clone()).collect();
            tested.sort_unstable();
            assert_eq!(tested, (0..data.rows()).collect::<Vec<_>>(), "every row is held out once");
            for fold in folds {
                assert_eq!(fold.train.len() + fold.test.len(), data.rows());
                assert!(fold.test.iter().all(|row| fold.train.binary_search(row).is_err()));
            }
        }
    }

    #[test]
    fn one_of_a_kind_is_refused_with_what_to_do() {
        let data = recordings(&[("s1", "1", "a", 4), ("s2", "1", "a", 4)]);
        assert!(folds(&data, By::Trajectory).is_ok());
        let says = folds(&data, By::Subject).unwrap_err().to_string();
        assert!(says.contains("only one subject") && says.contains("hold out sessions or trajectories"), "{says}");
        assert!(matches!(folds(&data, By::Session), Err(SplitFault::One { what: "session", .. })));
        let empty = recordings(&[("s1", "1", "a", 4), ("s2", "1", "a", 0)]);
        assert!(folds(&empty, By::Trajectory).is_err(), "a recording without rows is no part");
        assert_eq!(folds(&recordings(&[]), By::Trajectory), Err(SplitFault::Empty));
    }

    #[test]
    fn shuffles_are_even_and_repeatable() {
        let data = line(10);
        let by = |folds, seed| By::Rows { folds, seed };
        let sizes: Vec<usize> = named(&data, by(3, 1)).into_iter().map(|(_, n)| n).collect();
        assert_eq!(sizes, [4, 3, 3]);
        assert_eq!(folds(&data, by(3, 1)), folds(&data, by(3, 1)));
        assert_ne!(folds(&data, by(3, 1)), folds(&data, by(3, 2)));
        for count in [0, 1, 11] {
            assert_eq!(folds(&data, by(count, 1)), Err(SplitFault::Folds { rows: 10, folds: count }));
        }
    }
}
