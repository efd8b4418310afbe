//! How far a table of angles is from the true one.

use std::path::Path;

use super::Quality;
use crate::table::{Table, TableError};

/// The root mean square error of every `<joint>_deg` of `made` that `truth` has too. Rows belong together where
/// `made`'s column `key` and `truth`'s column `true_key` agree to within `close`; both ascend.
pub fn against(truth: &Path, true_key: &str, made: &Path, key: &str, close: f64) -> Result<Vec<Quality>, TableError> {
    let (truth, made) = (Table::read(truth)?, Table::read(made)?);
    let (true_at, at) = (truth.numbers(true_key)?, made.numbers(key)?);
    let pairs = pairs(&true_at, &at, close);
    let joint = |name: &String| name.strip_suffix("_deg").filter(|joint| !joint.ends_with("_sd")).map(str::to_owned);
    let mut all = Vec::new();
    for joint in made.names().iter().filter_map(joint) {
        let name = format!("{joint}_deg");
        if !truth.has(&name) {
            continue;
        }
        let (exact, measured) = (truth.numbers(&name)?, made.numbers(&name)?);
        let differences = pairs.iter().filter_map(|&[row, of]| Some(measured[row]? - exact[of]?));
        let (squares, count) = differences.fold((0.0, 0), |(squares, count), d| (squares + d * d, count + 1));
        if count > 0 {
            let value = (squares / f64::from(count)).sqrt();
            all.push(Quality { what: joint, value, unit: "degrees RMS".to_owned(), against_truth: true });
        }
    }
    Ok(all)
}

/// Rows of the second that belong to rows of the first, as `[second, first]`.
fn pairs(first: &[Option<f64>], second: &[Option<f64>], close: f64) -> Vec<[usize; 2]> {
    let mut pairs = Vec::with_capacity(second.len());
    let mut of = 0;
    for (row, at) in second.iter().enumerate() {
        let Some(at) = at else { continue };
        while first.get(of).is_some_and(|first| first.is_none_or(|first| first < at - close)) {
            of += 1;
        }
        if first.get(of).copied().flatten().is_some_and(|first| first <= at + close) {
            pairs.push([row, of]);
        }
    }
    pairs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_paired_by_what_they_are_of() {
        let some = |values: &[f64]| values.iter().copied().map(Some).collect::<Vec<_>>();
        assert_eq!(pairs(&some(&[0.0, 1.0, 2.0]), &some(&[1.0, 3.0]), 0.1), [[0, 1]]);
        assert_eq!(pairs(&[Some(0.0), None, Some(2.0)], &some(&[0.05, 2.05]), 0.1), [[0, 0], [1, 2]]);
    }

    #[test]
    fn the_root_mean_square_is_of_rows_that_both_have() {
        let dir = tempfile::tempdir().unwrap();
        let (truth, made) = (dir.path().join("truth.csv"), dir.path().join("made.csv"));
        std::fs::write(&truth, "frame,J1_deg,J2_deg\n0,5,10\n1,5,20\n2,5,30\n").unwrap();
        std::fs::write(&made, "frame,J2_deg,J2_sd_deg,J9_deg\n0,13,1,1\n1,,,\n2,26,1,1\n").unwrap();
        let measured = against(&truth, "frame", &made, "frame", 0.5).unwrap();
        let value = (12.5_f64).sqrt();
        let unit = "degrees RMS".to_owned();
        assert_eq!(measured, [Quality { what: "J2".to_owned(), value, unit, against_truth: true }]);
    }
}
