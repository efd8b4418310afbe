//! Columns of numbers of a table or of a log's lit rows, every fault reported with its row and column.

use std::path::{Path, PathBuf};

use crate::hemodynamics::HemodynamicsError;
use crate::log::{Channel, LitRows, LogReading, doubts, without_faults};
use crate::table::{Cell, Table};
use crate::words::{decimal_comma, nearest};

pub(in crate::hemodynamics) const TIME: &str = "time_s";
/// `P_F1` and `P_F2`.
pub(in crate::hemodynamics) const PRESSED: [&str; 2] = ["pf1_Pa", "pf2_Pa"];
/// `P_H` and `P_L`.
pub(in crate::hemodynamics) const BLOOD: [&str; 2] = ["ph_Pa", "pl_Pa"];

/// How many faults of a table are reported.
const MOST_FAULTS: usize = 10;

/// Named columns of a table, whole.
#[derive(Debug, Clone)]
pub(in crate::hemodynamics) struct Columns {
    pub(in crate::hemodynamics) path: PathBuf,
    names: Vec<String>,
    values: Vec<Vec<f64>>,
}

impl Columns {
    /// A column's values; `None` where it was not there.
    pub(in crate::hemodynamics) fn get(&self, name: &str) -> Option<&[f64]> {
        let at = self.names.iter().position(|one| one == name)?;
        Some(&self.values[at])
    }
}

/// A table, or the lit rows of a log and the loads of its unlit ones.
#[derive(Debug)]
pub(in crate::hemodynamics) struct Rows {
    path: PathBuf,
    names: Vec<String>,
    from: Source,
}

#[derive(Debug)]
enum Source {
    Table(Table),
    Log(LitRows),
}

/// A load at growing times.
#[derive(Debug, Clone, Default, PartialEq)]
pub(in crate::hemodynamics) struct Knots {
    pub(in crate::hemodynamics) times_s: Vec<f64>,
    pub(in crate::hemodynamics) values: Vec<f64>,
}

/// A photodiode's voltages, a row each.
#[derive(Debug)]
pub(in crate::hemodynamics) struct Voltages {
    /// Volts; NaN where a cell is empty, and in rows in which the sensor had a fault.
    pub(in crate::hemodynamics) values_v: Vec<f64>,
    /// Rows in which the sensor had a fault: saturated, or without ambient light.
    pub(in crate::hemodynamics) faults: usize,
    /// Rows whose status nobody knows are used.
    pub(in crate::hemodynamics) warning: Option<String>,
}

impl Rows {
    /// Reads a file: a table, or what `log` says is a log.
    pub(in crate::hemodynamics) fn read(path: &Path, log: &LogReading) -> Result<Self, HemodynamicsError> {
        if !log.is_log(path)? {
            return Self::table(path);
        }
        let lit = log.lit_rows(path)?;
        let channels = lit.samples.photodiodes.iter().chain(&lit.samples.forces);
        let names = std::iter::once(TIME.to_owned()).chain(channels.map(|channel| channel.name.clone())).collect();
        Ok(Self { path: path.to_owned(), names, from: Source::Log(lit) })
    }

    /// Reads a table.
    pub(in crate::hemodynamics) fn table(path: &Path) -> Result<Self, HemodynamicsError> {
        let table = Table::read(path)?;
        Ok(Self { path: path.to_owned(), names: table.names().to_vec(), from: Source::Table(table) })
    }

    pub(in crate::hemodynamics) fn names(&self) -> &[String] {
        &self.names
    }

    pub(in crate::hemodynamics) fn is_log(&self) -> bool {
        matches!(self.from, Source::Log(_))
    }

    /// What of a log has to be known before its values are used.
    pub(in crate::hemodynamics) fn warnings(&self) -> &[String] {
        match &self.from {
            Source::Table(_) => &[],
            Source::Log(lit) => &lit.samples.warnings,
        }
    }

    /// What is worth saying on a log, how its ambient light was taken away among it.
    pub(in crate::hemodynamics) fn notes(&self) -> Vec<String> {
        match &self.from {
            Source::Table(_) => Vec::new(),
            Source::Log(lit) => lit.notes.iter().chain(&lit.samples.notes).cloned().collect(),
        }
    }

    /// What to say of columns that are not `used`, and whose name is a slip away from one that is `wanted` and missing.
    pub(in crate::hemodynamics) fn near_misses(&self, wanted: &[&str], used: &[&str]) -> Vec<String> {
        let missing: Vec<&str> =
            wanted.iter().copied().filter(|name| !self.names.iter().any(|own| own == name)).collect();
        let unused = self.names.iter().filter(|own| !used.contains(&own.as_str()) && !wanted.contains(&own.as_str()));
        unused
            .filter_map(|own| Some((own, nearest(own, &missing)?)))
            .map(|(own, meant)| format!("the column `{own}` is not used; did you mean `{meant}`?"))
            .collect()
    }

    /// What to say of a column that is not `used` and grows as times do, of a table without times.
    pub(in crate::hemodynamics) fn like_a_time(&self, used: &[&str]) -> Option<String> {
        let Source::Table(table) = &self.from else { return None };
        let mut unused = self.names.iter().filter(|own| !used.contains(&own.as_str()));
        let is_like = |name: &&String| {
            let values = table.values(name).unwrap_or_default();
            let Some(usual) = doubts::even_step(&values) else { return false };
            // Rows that are counted are no times.
            let is_count = values.iter().all(|value| value.fract() == 0.0) && usual == 1.0;
            values.is_sorted_by(|a, b| a < b) && !is_count
        };
        unused.find(is_like).map(|name| {
            format!(
                "the column `{name}` grows evenly from row to row: is it the time? As no column is called `{TIME}`, \
                 rows are taken for equilibria; call it so, in seconds, where they follow each other"
            )
        })
    }

    /// The columns that are `needed` and those `wanted` that are there. Every cell has to be a finite number.
    ///
    /// # Errors
    /// Columns that are missing, all of them; cells that are empty or no finite number, with row and column; no rows;
    /// where `time` is one of the columns, times that do not ascend.
    pub(in crate::hemodynamics) fn numbers(
        &self,
        needed: &[&str],
        wanted: &[&str],
        time: &str,
    ) -> Result<Columns, HemodynamicsError> {
        let has = |name: &&&str| self.names.iter().any(|own| own == **name);
        let missing: Vec<String> = needed.iter().filter(|name| !has(name)).map(|name| format!("`{name}`")).collect();
        if !missing.is_empty() {
            let what = format!(
                "has no column {}; its columns are {}: rename or add what is missing, in the unit of its name (a \
                 pressure in kPa times 1000 is in Pa)",
                missing.join(", "),
                listed(&self.names)
            );
            return Err(HemodynamicsError::table(&self.path, what));
        }
        let mut faults: Vec<(usize, String)> = Vec::new();
        let mut columns = Columns { path: self.path.clone(), names: Vec::new(), values: Vec::new() };
        for name in needed.iter().chain(wanted.iter().filter(|name| has(name))) {
            let values = self.column(name, &mut faults)?;
            if values.is_empty() {
                return Err(HemodynamicsError::table(&self.path, "has no rows"));
            }
            if *name == time {
                for (row, pair) in values.windows(2).enumerate() {
                    if pair[1] <= pair[0] {
                        let what = format!(
                            "{} s comes after {} s; times have to grow from row to row: sort the rows, and keep one of \
                             those that have the same time",
                            pair[1], pair[0]
                        );
                        faults.push((row + 1, self.fault(row + 1, name, what)));
                    }
                }
            }
            columns.names.push((*name).to_owned());
            columns.values.push(values);
        }
        if faults.is_empty() {
            return Ok(columns);
        }
        faults.sort_by_key(|(row, _)| *row);
        let more = faults.len().saturating_sub(MOST_FAULTS);
        let mut messages: Vec<String> = faults.into_iter().take(MOST_FAULTS).map(|(_, what)| what).collect();
        if more > 0 {
            messages.push(format!("and {more} more"));
        }
        Err(HemodynamicsError::Rows(messages))
    }

    /// The times and values of one of the loads `read`, at all rows at which it is known: of a log the unlit rows among
    /// them, for a load may turn a corner there. Of rows of one time the lit one counts, otherwise the first.
    pub(in crate::hemodynamics) fn knots(&self, name: &str, read: &Columns) -> Knots {
        let own = |name: &str| read.get(name).unwrap_or_default();
        let mut all: Vec<(f64, f64)> = own(TIME).iter().copied().zip(own(name).iter().copied()).collect();
        if let Source::Log(lit) = &self.from {
            let unlit = lit.unlit.forces.iter().filter(|channel| channel.name == name);
            let unlit = unlit.flat_map(|channel| lit.unlit.time_s.iter().copied().zip(channel.values.iter().copied()));
            all.extend(unlit.filter(|(_, value)| !value.is_nan()));
            // Stable: the lit row of a time stays first.
            all.sort_by(|a, b| a.0.total_cmp(&b.0));
            all.dedup_by(|later, first| later.0 == first.0);
        }
        let (times_s, values) = all.into_iter().unzip();
        Knots { times_s, values }
    }

    /// A column, NaN where it is not a finite number, which is a fault.
    fn column(&self, name: &str, faults: &mut Vec<(usize, String)>) -> Result<Vec<f64>, HemodynamicsError> {
        const WHY: &str = "a load or response has to be known in every row: correct it or leave the row out";
        let mut values = Vec::new();
        let mut take = |row: usize, cell: Cell<'_>| {
            let shown = match cell {
                Cell::Number(value) if value.is_finite() => {
                    values.push(value);
                    return;
                }
                Cell::Number(value) => format!("`{value}` is no finite number"),
                Cell::Text(text) => format!("`{text}` is no number{}", decimal_comma(text)),
                Cell::Missing => "is empty".to_owned(),
            };
            values.push(f64::NAN);
            faults.push((row, self.fault(row, name, format!("{shown}; {WHY}"))));
        };
        match &self.from {
            Source::Table(table) => table.each_cell(name, |row, cell| {
                take(row, cell);
                Ok(())
            })?,
            Source::Log(lit) => {
                let of = |value: f64| if value.is_nan() { Cell::Missing } else { Cell::Number(value) };
                let own = channel(lit, name).map_or(&lit.samples.time_s, |channel| &channel.values);
                own.iter().enumerate().for_each(|(row, &value)| take(row, of(value)));
            }
        }
        Ok(values)
    }

    /// What is wrong with a cell, with its place.
    fn fault(&self, row: usize, name: &str, what: String) -> String {
        match &self.from {
            Source::Table(table) => table.cell(row, name, what).to_string(),
            // Its rows are sorted by time, which identifies them as well as a line does.
            Source::Log(lit) => {
                format!("{}: column `{name}` at {} s: {what}", self.path.display(), lit.samples.time_s[row])
            }
        }
    }

    /// A photodiode's voltages; rows in which the sensor had a fault, as `lunula align` flags them, have none.
    ///
    /// # Errors
    /// No such column, a cell that is neither empty nor a finite number.
    pub(in crate::hemodynamics) fn voltages(&self, name: &str) -> Result<Voltages, HemodynamicsError> {
        let mut values_v: Vec<f64> = Vec::new();
        match &self.from {
            Source::Log(lit) => {
                values_v.extend(channel(lit, name).iter().flat_map(|channel| &channel.values));
                if let Some(row) = values_v.iter().position(|value| value.is_infinite()) {
                    let what = "less the ambient light it is beyond 1e308; write the log in volts".to_owned();
                    return Err(HemodynamicsError::Rows(vec![self.fault(row, name, what)]));
                }
            }
            Source::Table(table) => {
                table.each_cell(name, |row, cell| {
                    let what = match cell {
                        Cell::Missing => {
                            values_v.push(f64::NAN);
                            return Ok(());
                        }
                        Cell::Number(value) if value.is_finite() => {
                            values_v.push(value);
                            return Ok(());
                        }
                        Cell::Number(value) => {
                            format!(
                                "`{value}` is no finite number; a photodiode's cell may be empty, but no other thing"
                            )
                        }
                        Cell::Text(text) => {
                            format!("`{text}` is no number{}; correct it or leave it empty", decimal_comma(text))
                        }
                    };
                    Err(table.cell(row, name, what))
                })?;
            }
        }
        let (faults, unknown) = without_faults(vec![(name, &mut values_v)], |take| match &self.from {
            Source::Log(lit) => {
                lit.samples.faults.iter().enumerate().for_each(|(row, fault)| take(row, fault));
                Ok(())
            }
            Source::Table(table) if table.has("sensor_status") => table.each_text("sensor_status", take),
            Source::Table(_) => Ok(()),
        })?;
        Ok(Voltages { values_v, faults: faults[0], warning: unknown.warning() })
    }
}

fn channel<'a>(lit: &'a LitRows, name: &str) -> Option<&'a Channel> {
    lit.samples.photodiodes.iter().chain(&lit.samples.forces).find(|channel| channel.name == name)
}

/// The columns there are, of very many the first.
pub(in crate::hemodynamics) fn listed(names: &[String]) -> String {
    const MOST: usize = 40;
    let more = if names.len() > MOST { format!(", .. ({} in all)", names.len()) } else { String::new() };
    format!("{}{more}", names.iter().take(MOST).cloned().collect::<Vec<_>>().join(", "))
}
