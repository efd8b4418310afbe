//! Where one session, person or trajectory ends and the next begins.
//!
//! In: a table, or a log that has such columns and its lit rows' times. Out: the first row of each stretch, with what
//! the columns say there.

use std::path::Path;

use super::header::{self, GROUPS};
use crate::table::{Table, TableError, column_names};

/// The first row of each stretch and its session, subject and trajectory.
pub(crate) type Groups = Vec<(usize, [String; 3])>;

/// Times that are read by two readers are the same to the step of 64-bit numbers at seconds since 1970.
const SAME_S: f64 = 1e-6;
/// Rows of a recording, on average, at least (assumed: a second of a slow log).
const FEWEST_ROWS: usize = 10;

/// The stretches of a table.
pub(crate) fn groups(table: &Table) -> Result<Groups, TableError> {
    let mut changes = Groups::new();
    for (k, group) in GROUPS.iter().enumerate().filter(|(_, group)| table.has(group)) {
        let mut own: Vec<(usize, String)> = Vec::new();
        table.each_text(group, |row, text| {
            if own.last().is_none_or(|(_, last)| last != text) {
                own.push((row, text.to_owned()));
            }
        })?;
        changes = merged(&changes, k, own);
    }
    Ok(changes)
}

/// The stretches of a log's lit rows at `times_s`; `all_s`: the times of all its rows.
///
/// # Errors
/// Why columns that the log has are not read.
pub(in crate::log) fn of_log(path: &Path, all_s: &[f64], times_s: &[f64]) -> Result<Groups, String> {
    let names = column_names(path).unwrap_or_else(|_| header::names(path));
    let own: Vec<&str> = GROUPS.into_iter().filter(|group| names.iter().any(|name| name == group)).collect();
    if own.is_empty() {
        return Ok(Groups::new());
    }
    let not_read = |why: &str| format!("`{}` is not read: {why}", own.join("`, `"));
    let Ok(table) = Table::read(path) else { return Err(not_read("save the log as .csv with commas or as .parquet")) };
    let of_all = groups(&table).map_err(|why| not_read(&why.to_string()))?;
    if let [(_, only)] = &of_all[..] {
        return Ok(vec![(0, only.clone())]);
    }
    if of_all.len() * FEWEST_ROWS > table.rows() {
        return Err(not_read("it changes every few rows; is it the number of a row?"));
    }
    let is_first = |time_s: &f64| times_s.first().is_some_and(|first_s| (time_s - first_s).abs() <= SAME_S);
    let own_s = table.values("time_s").ok().filter(|own_s| own_s.iter().any(is_first));
    // Where another column, unit or date says the time: of a log all of whose rows are read each is where it is there.
    let rows_s = own_s.or_else(|| (all_s.len() == table.rows()).then(|| all_s.to_vec()));
    rows_s.and_then(|rows_s| at_times(&rows_s, &of_all, times_s)).ok_or_else(|| {
        not_read(
            "the rows' times don't say which row is whose; give each recording a file of its own, or times that go on \
             from one to the next",
        )
    })
}

/// The stretches of rows at `times_s`, of those of rows at `rows_s`; none where a time is no row's, or rows of several
/// stretches have it.
fn at_times(rows_s: &[f64], groups: &Groups, times_s: &[f64]) -> Option<Groups> {
    let stretch = |row: usize| groups.partition_point(|(first, _)| *first <= row).checked_sub(1);
    let mut rows: Vec<(f64, Option<usize>)> =
        rows_s.iter().enumerate().map(|(row, time_s)| (*time_s, stretch(row))).collect();
    rows.retain(|(time_s, _)| time_s.is_finite());
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut changes = Groups::new();
    let mut last = None;
    for (k, &time_s) in times_s.iter().enumerate() {
        let from = rows.partition_point(|(other_s, _)| *other_s < time_s - SAME_S);
        let mut same = rows[from..].iter().take_while(|(other_s, _)| *other_s <= time_s + SAME_S);
        let own = same.next()?.1?;
        if same.any(|(_, other)| *other != Some(own)) {
            return None;
        }
        if last.replace(own) != Some(own) {
            changes.push((k, groups[own].1.clone()));
        }
    }
    Some(changes)
}

/// Changes of the groups before joined with those of group `k`.
fn merged(before: &[(usize, [String; 3])], k: usize, own: Vec<(usize, String)>) -> Vec<(usize, [String; 3])> {
    let mut rows: Vec<usize> = before.iter().map(|c| c.0).chain(own.iter().map(|c| c.0)).collect();
    rows.sort_unstable();
    rows.dedup();
    let (mut last, mut own) = (before.iter().peekable(), own.into_iter().peekable());
    let mut group: [String; 3] = Default::default();
    let mut joined = Vec::with_capacity(rows.len());
    for row in rows {
        if let Some((_, known)) = last.next_if(|change| change.0 == row) {
            group[..k].clone_from_slice(&known[..k]);
        }
        if let Some((_, text)) = own.next_if(|change| change.0 == row) {
            group[k] = text;
        }
        joined.push((row, group.clone()));
    }
    joined
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::LogReading;

    fn lit(rows: &str) -> (Groups, Vec<String>) {
        of_file("log.csv", &format!("time_s,led,P1,Fz_N,session,subject\n{rows}"))
    }

    fn of_file(name: &str, text: &str) -> (Groups, Vec<String>) {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join(name);
        std::fs::write(&path, text).unwrap();
        let lit = LogReading::default().lit_rows(&path).unwrap();
        (lit.groups, lit.samples.warnings)
    }

    #[test]
    fn a_log_with_an_led_has_its_sessions() {
        let mut rows = String::new();
        for k in 0..60 {
            let session = 1 + k / 20;
            rows += &format!("{},{},{},-1,{session},anna\n", 0.01 * f64::from(k), k % 2, 1.0 + 0.01 * f64::from(k % 7));
        }
        let (groups, warnings) = lit(&rows);
        let group = |session: &str| [session.to_owned(), "anna".to_owned(), String::new()];
        assert_eq!(groups, [(0, group("1")), (10, group("2")), (20, group("3"))]);
        assert!(!warnings.iter().any(|warning| warning.contains("not read")), "{warnings:?}");
        // Whatever its time is called; of one session, whatever it is.
        let mut millis = "time_ms,led,P1,Fz_N,session,subject\n".to_owned();
        (0..60).for_each(|k| millis += &format!("{},{},{},-1,{},anna\n", 10 * k, k % 2, 1 + k % 7, 1 + k / 20));
        let (groups, warnings) = of_file("log.csv", &millis);
        assert!(groups.len() == 3 && !warnings.iter().any(|one| one.contains("not read")), "{groups:?} {warnings:?}");
        let tabs = format!("time_s,led,P1,Fz_N,session,subject\n{rows}").replace(',', "\t");
        let (groups, warnings) = of_file("log.tsv", &tabs);
        assert!(groups.is_empty() && warnings.iter().any(|one| one.contains("save the log as .csv")), "{warnings:?}");
        let (groups, _) = lit(&rows.replace(",2,anna", ",1,anna").replace(",3,anna", ",1,anna"));
        assert_eq!(groups, [(0, group("1"))]);
        // Two persons at one time: nobody's.
        let twice = rows.replace("0.59,1", "0.57,1").replace(",3,anna", ",3,ben");
        let (groups, warnings) = lit(&twice.replacen(",3,ben", ",3,anna", 19));
        assert_eq!(groups, []);
        assert!(warnings.iter().any(|warning| warning.contains("`session`, `subject` is not read")), "{warnings:?}");
    }
}
