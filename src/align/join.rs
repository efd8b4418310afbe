//! Labelled sets of several videos to one table, in the order of time.
//!
//! In: sets as [`run`](super::run) writes them. Out: one table of the same columns; a column that only some have is
//! empty in the others' rows. Sets of one subject and session are on one clock, the log's. Where the log went on
//! between two videos, both sets have its rows: the one that was filmed then stands, once. Two whose filmed times
//! overlap are refused, as one moment would be labelled twice. Other sessions have clocks of their own; they follow in
//! the order of their names.

use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::align::run::results::{ANGLE_DECIMALS, TEXTS};
use crate::log::is_filmed;
use crate::table::{Column, ColumnKind, Table, TableError, TableWriter, Value};

/// Why sets were not joined.
#[derive(Debug, Error)]
pub(super) enum JoinError {
    #[error(transparent)]
    Table(#[from] TableError),
    #[error(
        "{}: what was filmed from {from_s} s on overlaps with what was filmed in {} up to {to_s} s, of one subject and \
         session; leave one out, or give the recordings sessions of their own: `--session`, in a pipeline a key \
         `session`",
        later.display(),
        earlier.display()
    )]
    Overlap {
        /// The set that begins first.
        earlier: PathBuf,
        later: PathBuf,
        /// Where the later one begins, seconds.
        from_s: f64,
        /// Where the earlier one ends, seconds.
        to_s: f64,
    },
    #[error("{}: no set has a row to be joined; look at what made it", .0.display())]
    Empty(PathBuf),
}

/// A set, read.
struct Set {
    table: Table,
    path: PathBuf,
    /// Subject and session.
    of: [String; 2],
    times_s: Vec<Option<f64>>,
    /// Which rows lie within the video.
    filmed: Vec<bool>,
    /// When the filmed rows begin and end; of all rows where none was filmed.
    from_s: f64,
    to_s: f64,
}

/// A column's cells.
enum Cells {
    Numbers(Vec<Option<f64>>),
    Texts(Vec<Option<String>>),
    /// The set has no such column.
    None,
}

impl Cells {
    fn value(&self, row: usize) -> Value<'_> {
        match self {
            Self::Numbers(numbers) => numbers[row].into(),
            Self::Texts(texts) => texts[row].as_deref().map_or(Value::Missing, Value::Text),
            Self::None => Value::Missing,
        }
    }
}

/// Joins the sets in `at`, which is to stand at `path`; returns how many rows there are.
pub(super) fn join(sets: &[PathBuf], at: &Path, path: &Path) -> Result<usize, JoinError> {
    let sets = sets.iter().map(|set| Set::read(set)).collect::<Result<Vec<_>, _>>()?;
    let mut sets: Vec<Set> = sets.into_iter().flatten().collect();
    sets.sort_by(|a, b| a.of.cmp(&b.of).then(a.from_s.total_cmp(&b.from_s)));
    let overlaps = |pair: &&[Set]| pair[0].of == pair[1].of && pair[1].from_s <= pair[0].to_s;
    if let Some(pair) = sets.windows(2).find(overlaps) {
        let [earlier, later] = [&pair[0], &pair[1]].map(|set| set.path.clone());
        return Err(JoinError::Overlap { earlier, later, from_s: pair[1].from_s, to_s: pair[0].to_s });
    }
    let Some(first) = sets.first() else { return Err(JoinError::Empty(path.to_owned())) };
    let facts = first.table.facts().to_vec();
    let columns = columns(&sets);
    let mut table = TableWriter::create(at, path, columns.clone(), &facts)?;
    let cells_of = |set: &Set| columns.iter().map(|column| set.cells(column)).collect::<Result<Vec<_>, _>>();
    let cells = sets.iter().map(cells_of).collect::<Result<Vec<_>, _>>()?;
    let picks: Vec<(usize, usize)> = sets.chunk_by(|a, b| a.of == b.of).scan(0, one_session).flatten().collect();
    table.write_rows(picks.len(), &|pick, write| {
        let (set, row) = picks[pick];
        write(&cells[set].iter().map(|cells| cells.value(row)).collect::<Vec<_>>());
    })?;
    table.finish()?;
    Ok(picks.len())
}

/// The rows of a session's sets, each as its set's position and its own, in the order of time: of a time in several
/// sets the row that was filmed.
fn one_session(before: &mut usize, sets: &[Set]) -> Option<Vec<(usize, usize)>> {
    let first = *before;
    *before += sets.len();
    let rows_of = |(at, set): (usize, &Set)| (0..set.times_s.len()).map(move |row| (at, row)).collect::<Vec<_>>();
    let mut rows: Vec<(usize, usize)> = sets.iter().enumerate().flat_map(rows_of).collect();
    let time_s = |&(set, row): &(usize, usize)| sets[set].times_s[row].unwrap_or(f64::INFINITY);
    let filmed = |&(set, row): &(usize, usize)| sets[set].filmed[row];
    rows.sort_by(|a, b| time_s(a).total_cmp(&time_s(b)).then(filmed(b).cmp(&filmed(a))));
    rows.dedup_by(|later, kept| time_s(later) == time_s(kept) && later.0 != kept.0);
    rows.iter_mut().for_each(|pick| pick.0 += first);
    Some(rows)
}

impl Set {
    /// None where it has no row.
    fn read(path: &Path) -> Result<Option<Self>, TableError> {
        let table = Table::read(path)?;
        let times_s = table.numbers("time_s")?;
        let filmed: Vec<bool> = match table.has("label_status") {
            true => table.texts("label_status")?.iter().map(|status| status.as_deref().is_none_or(is_filmed)).collect(),
            false => vec![true; times_s.len()],
        };
        let any = filmed.contains(&true);
        let mut known =
            times_s.iter().zip(&filmed).filter(|(_, filmed)| **filmed || !any).filter_map(|(time, _)| *time);
        let Some(from_s) = known.next() else { return Ok(None) };
        let to_s = known.next_back().unwrap_or(from_s);
        let mut of = [String::new(), String::new()];
        for (value, name) in of.iter_mut().zip(["subject", "session"]) {
            if table.has(name) {
                *value = table.texts(name)?.into_iter().flatten().next().unwrap_or_default();
            }
        }
        Ok(Some(Self { table, path: path.to_owned(), of, times_s, filmed, from_s, to_s }))
    }

    fn cells(&self, column: &Column) -> Result<Cells, TableError> {
        if !self.table.has(&column.name) {
            return Ok(Cells::None);
        }
        Ok(match column.kind {
            ColumnKind::Text => Cells::Texts(self.table.texts(&column.name)?),
            _ => Cells::Numbers(self.table.numbers_or_nan(&column.name)?),
        })
    }
}

/// The columns of all, each where it first stands.
fn columns(sets: &[Set]) -> Vec<Column> {
    let mut columns: Vec<Column> = Vec::new();
    for name in sets.iter().flat_map(|set| set.table.names()) {
        if columns.iter().any(|column| column.name == *name) {
            continue;
        }
        let mut holders = sets.iter().filter(|set| set.table.has(name));
        let is_number = |set: &Set| set.table.numbers_or_nan(name).is_ok();
        columns.push(if TEXTS.contains(&name.as_str()) || !holders.all(is_number) {
            Column::text(name)
        } else if name.ends_with("_deg") {
            Column::rounded(name, ANGLE_DECIMALS)
        } else {
            Column::number(name)
        });
    }
    columns
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: &str = "time_s,P1,J2_deg,J2_sd_deg,label_status,subject,session,sensor_status\n";

    fn joined(texts: &[&str]) -> Result<String, String> {
        let dir = tempfile::tempdir().unwrap();
        let mut sets = Vec::new();
        for (k, text) in texts.iter().enumerate() {
            sets.push(dir.path().join(format!("set-{k}.csv")));
            std::fs::write(&sets[k], text).unwrap();
        }
        let out = dir.path().join("all.csv");
        join(&sets, &out, &out).map_err(|why| why.to_string())?;
        Ok(std::fs::read_to_string(out).unwrap())
    }

    #[test]
    fn sets_follow_one_another_in_the_order_of_time_cell_by_cell() {
        let early = "60.04,0.125,12.50000,0.02000,ok,S01,1,ok\n60.08,0.25,,,gap,S01,1,saturated: P1\n";
        let late = "70.04,1e-7,1.00000,0.02000,ok,S01,1,ok\n";
        let other = "1,0.5,1.00000,0.02000,ok,S01,2,ok\n";
        let joint = joined(&[&format!("{HEAD}{other}"), &format!("{HEAD}{late}"), &format!("{HEAD}{early}")]);
        assert_eq!(joint.unwrap(), format!("{HEAD}{early}{late}{other}"));
    }

    #[test]
    fn a_column_that_some_lack_is_empty_there() {
        let joint = joined(&["time_s,P1,J2_deg\n1,2,3\n", "time_s,P1,J3_deg\n5,6,7\n", "time_s,P1\n"]).unwrap();
        assert_eq!(joint, "time_s,P1,J2_deg,J3_deg\n1,2,3.00000,\n5,6,,7.00000\n");
    }

    #[test]
    fn of_two_videos_of_one_log_each_row_comes_from_the_one_that_filmed_it() {
        let row = |time_s: u32, angle: &str, status: &str| format!("{time_s},0.5,{angle},,{status},S01,1,ok\n");
        let (before, after) = ("before the video", "after the video");
        let first =
            [row(1, "", before), row(2, "5.00000", "ok"), row(3, "", after), row(4, "", after), row(5, "", after)];
        let second =
            [row(1, "", before), row(2, "", before), row(3, "", before), row(4, "7.00000", "ok"), row(5, "", after)];
        let joint = joined(&[&format!("{HEAD}{}", second.concat()), &format!("{HEAD}{}", first.concat())]).unwrap();
        let expected = [row(1, "", before), first[1].clone(), row(3, "", after), second[3].clone(), row(5, "", after)];
        assert_eq!(joint, format!("{HEAD}{}", expected.concat()));
    }

    #[test]
    fn what_would_count_twice_is_refused() {
        let row = |time_s: f64, session: u32| format!("{time_s},0,1,1,ok,S01,{session},ok\n");
        let first = format!("{HEAD}{}{}", row(1.0, 1), row(5.0, 1));
        let error = joined(&[&first, &format!("{HEAD}{}", row(4.0, 1))]).unwrap_err();
        assert!(
            error.contains("set-1.csv: what was filmed from 4 s on overlaps") && error.contains("set-0.csv up to 5"),
            "{error}"
        );
        assert!(joined(&[&first, &format!("{HEAD}{}", row(4.0, 2))]).is_ok(), "another session's clock is another");
        assert!(joined(&[HEAD]).unwrap_err().contains("no set has a row"));
    }
}
