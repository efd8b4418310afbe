//! Whether a model is scored on rows that it was trained on.
//!
//! In: a [`Dataset`]. Out: hashes of its rows or its recordings: SHA-256 over the little-endian bytes of
//! each row's voltages, then its targets (-0 counts as 0). Times, names of recordings, sessions and subjects do not
//! enter: a file given twice under two names is found. Rows that are alike by chance (a sensor at rest, all saturated)
//! count as shared too.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use sha2::{Digest, Sha256};

use crate::Dataset;

/// The first 8 bytes of each row's hash.
#[must_use]
pub fn row_hashes(data: &Dataset) -> Vec<u64> {
    let first = |hash: &[u8]| hash.iter().take(8).fold(0, |all, &byte| all << 8 | u64::from(byte));
    (0..data.rows()).map(|row| first(&hash(data, row..row + 1).finalize())).collect()
}

/// The hash of each recording's rows, hexadecimal, in order.
#[must_use]
pub fn recording_hashes(data: &Dataset) -> Vec<String> {
    data.recordings().iter().map(|one| hex(hash(data, one.rows.clone()))).collect()
}

/// How many of the tested rows are among those trained on, by [`row_hashes`].
#[must_use]
pub fn shared_rows(trained: &[u64], tested: &[u64]) -> usize {
    let known: BTreeSet<&u64> = trained.iter().collect();
    tested.iter().filter(|row| known.contains(row)).count()
}

/// The same for parts that are held out in turn, each tested against the rows of all others: how many of each part's
/// rows others hold as well.
pub(super) fn shared_with_others(hashes: &[u64], parts: &[&[usize]]) -> Vec<usize> {
    // Of each row the parts that hold it: the first, and whether there is another.
    let mut holders: BTreeMap<u64, (usize, bool)> = BTreeMap::new();
    for (k, part) in parts.iter().enumerate() {
        for &row in *part {
            holders.entry(hashes[row]).and_modify(|(first, more)| *more |= *first != k).or_insert((k, false));
        }
    }
    parts.iter().map(|part| part.iter().filter(|&&row| holders[&hashes[row]].1).count()).collect()
}

fn hash(data: &Dataset, rows: Range<usize>) -> Sha256 {
    let mut all = Sha256::new();
    for row in rows {
        for value in data.x().row(row).iter().chain(data.y().row(row)) {
            all.update((value + 0.0).to_le_bytes());
        }
    }
    all
}

/// A hash as text, hexadecimal.
pub(crate) fn hex(hash: Sha256) -> String {
    hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluate::fixture::{line, recordings};

    #[test]
    fn rows_trained_on_are_found() {
        let data = recordings(&[("s1", "1", "a", 50), ("s2", "1", "a", 30)]);
        let all = row_hashes(&data);
        assert_eq!(shared_rows(&all, &row_hashes(&data.only(&[1]))), 30);
        assert_eq!(shared_rows(&row_hashes(&data.only(&[0])), &row_hashes(&data.only(&[1]))), 0);
        assert_eq!(recording_hashes(&data)[1], recording_hashes(&data.only(&[1]))[0]);
    }

    #[test]
    fn rows_of_parts_that_others_hold_as_well_are_counted_like_one_by_one() {
        let hashes = [7, 1, 2, 7, 7, 3, 2, 9];
        let parts: [&[usize]; 3] = [&[0, 1, 4], &[2, 5, 6], &[3, 7]];
        let naive = (0..3).map(|k| {
            let of = |rows: &[usize]| rows.iter().map(|&row| hashes[row]).collect::<Vec<_>>();
            let others: Vec<u64> = (0..3).filter(|&other| other != k).flat_map(|other| of(parts[other])).collect();
            shared_rows(&others, &of(parts[k]))
        });
        let naive: Vec<usize> = naive.collect();
        assert_eq!((shared_with_others(&hashes, &parts), &naive[..]), (vec![2, 0, 1], &[2, 0, 1][..]));
    }

    #[test]
    fn zero_has_no_sign() {
        let set = |zero: f64| {
            let x = ndarray::array![[zero]];
            Dataset::plain(vec!["P1".into()], vec!["Fz_N".into()], x.clone(), x, 0.04).unwrap()
        };
        assert_eq!(row_hashes(&set(0.0)), row_hashes(&set(-0.0)));
        assert_ne!(row_hashes(&set(0.0)), row_hashes(&set(5e-324)));
    }

    #[test]
    fn the_hash_is_sha_256_of_the_bytes() {
        // Python: hashlib.sha256(struct.pack('<2d', 1, 0)).hexdigest()
        let data = line(1);
        assert_eq!(recording_hashes(&data), ["3239b05c38b825ebb79f103172438292a22a0951351a6b81be1df5d44776cc65"]);
        assert_eq!(
            format!("{:016x}", row_hashes(&data)[0]),
            "3239b05c38b825ebb79f103172438292a22a0951351a6b81be1df5d44776cc65"[..16]
        );
    }
}
