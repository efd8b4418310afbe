//! One file, column by column: a table, or a raw log brought to the LED's own light.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use rayon::prelude::*;

use super::columns::{cell, cells, listed, missing, other_grid, photodiodes};
use super::{DataError, Wanted};
use crate::flexion;
use crate::log::{Channel, Groups, LitRows, Statuses, Unknown, Verdict, doubts, groups, lacks_label, time_not_read};
use crate::table::{Cell, Table, TableError};
use crate::words::decimal_comma;

/// The rows of a file, all of them.
#[derive(Debug)]
pub(super) struct Source {
    pub(super) path: PathBuf,
    pub(super) inputs: Vec<String>,
    /// Seconds; NaN where not known.
    pub(super) time_s: Vec<f64>,
    /// Each photodiode's values; NaN where missing or invalid.
    pub(super) x: Vec<Vec<f64>>,
    /// Each target's values; NaN where missing or invalid.
    pub(super) y: Vec<Vec<f64>>,
    /// Rows with a cell that is no finite number.
    pub(super) invalid: Vec<bool>,
    /// Rows that `sensor_status` warns of.
    pub(super) faulty: Vec<bool>,
    /// Whether the LED went on and off, so that ambient light was taken away; none: another program did, or a camera's.
    pub(super) is_lit: Option<bool>,
    /// Session, subject and trajectory, and the first row that has them.
    pub(super) groups: Groups,
    /// How the ambient light of a raw log was taken away.
    pub(super) notes: Vec<String>,
    /// What whoever uses the rows should know.
    pub(super) warnings: Vec<String>,
}

impl Source {
    /// Reads a file, a table or a raw log.
    pub(super) fn read(path: &Path, wanted: &Wanted) -> Result<Self, DataError> {
        if wanted.rows.log.is_log(path)? { Self::of_log(path, wanted) } else { Self::of_table(path, wanted) }
    }

    pub(super) fn rows(&self) -> usize {
        self.time_s.len()
    }

    /// Whether a row lacks what is needed of it: any input (of `cells` all) or a target.
    pub(super) fn lacks(&self, row: usize, cells: bool) -> bool {
        let lacking = |column: &Vec<f64>| column[row].is_nan();
        let inputs = if cells { self.x.iter().all(lacking) } else { self.x.iter().any(lacking) };
        inputs || self.y.iter().any(lacking)
    }

    /// In how many rows each photodiode is empty, then each target.
    pub(super) fn empty_cells(&self) -> impl Iterator<Item = usize> {
        self.x.iter().chain(&self.y).map(|column| column.iter().filter(|value| value.is_nan()).count())
    }

    fn of_table(path: &Path, wanted: &Wanted) -> Result<Self, DataError> {
        let table = Table::read(path)?;
        let names = table.names();
        let inputs = chosen(path, wanted, names)?;
        let has = |name: &str| table.has(name);
        if let Some(lacking) = inputs.iter().chain(&wanted.targets).find(|name| !has(name)) {
            return Err(DataError::Columns { path: path.to_owned(), what: missing(lacking, names) });
        }
        let time = has("time_s").then_some("time_s");
        let asked: Vec<&str> =
            time.into_iter().chain(inputs.iter().chain(&wanted.targets).map(String::as_str)).collect();
        let read: Vec<NumberColumn> =
            asked.par_iter().map(|name| NumberColumn::read(&table, name)).collect::<Result<_, _>>()?;
        let mut invalid = vec![false; table.rows()];
        read.iter().flat_map(|column| &column.invalid).for_each(|&row| invalid[row] = true);
        // Of several wrong cells the first by row, then by column as asked.
        let first = read.iter().zip(&asked).filter_map(|(column, name)| Some((*column.invalid.first()?, *name)));
        if let Some((row, name)) = first.min_by_key(|(row, _)| *row).filter(|_| !wanted.rows.drop_invalid) {
            return Err(bad_cell(&table, row, name)?.into());
        }
        let mut values = read.into_iter().map(|column| column.values);
        let time_s = match time {
            Some(_) => values.next().unwrap_or_default(),
            None => vec![f64::NAN; table.rows()],
        };
        let x: Vec<Vec<f64>> = values.by_ref().take(inputs.len()).collect();
        let mut source = Self {
            path: path.to_owned(),
            time_s,
            x,
            y: values.collect(),
            invalid,
            faulty: vec![false; table.rows()],
            is_lit: (!["sensor_status", "label_status", "P1_status"].into_iter().any(has)).then_some(false),
            groups: groups(&table)?,
            notes: Vec::new(),
            warnings: Vec::new(),
            inputs,
        };
        let other_grid = wanted.inputs.as_ref().and_then(|inputs| other_grid(inputs, names));
        source.warnings.extend(other_grid.map(|what| format!("{}: {what}", path.display())));
        if has("sensor_status") {
            source.read_status(|take| table.each_text("sensor_status", take))?;
        }
        if has("label_status") {
            source.without_filled_labels(&table, &wanted.targets)?;
        }
        let read = source.inputs.iter().zip(&source.x).chain(wanted.targets.iter().zip(&source.y));
        let read = read.map(|(name, values)| (name.as_str(), &values[..]));
        if let Some(name) = time_not_read(names) {
            source.warnings.push(format!(
                "{}: `{name}` is not read as the time; call it `time_s` and write seconds",
                path.display()
            ));
        }
        let angle = |name: &str| name.strip_suffix("_deg").map(str::to_owned);
        let (joints, angles): (Vec<String>, Vec<&[f64]>) =
            read.clone().filter_map(|(name, values)| Some((angle(name)?, values))).unzip();
        let doubts = doubts::table(names, read).into_iter().chain(flexion::doubts(&joints, &angles));
        let doubts = doubts.chain(doubts::time(&source.time_s));
        source.warnings.extend(doubts.map(|doubt| format!("{}: {doubt}", path.display())).collect::<Vec<_>>());
        Ok(source)
    }

    fn of_log(path: &Path, wanted: &Wanted) -> Result<Self, DataError> {
        let LitRows { samples, groups, notes, .. } = wanted.rows.log.lit_rows(path)?;
        // A force in another unit is not read.
        let of_columns = notes.iter().filter(|note| note.starts_with("column "));
        let of_columns: String = of_columns.map(|note| format!("; {note}")).collect();
        let placed = |notes: &[String]| notes.iter().map(|note| format!("{}: {note}", path.display())).collect();
        let (warnings, notes) = (placed(&samples.warnings), placed(&[&notes[..], &samples.notes].concat()));
        let channels = || samples.photodiodes.iter().chain(&samples.forces);
        let names: Vec<String> = channels().map(|channel| channel.name.clone()).collect();
        let by_name: HashMap<&str, &Channel> = channels().map(|channel| (channel.name.as_str(), channel)).collect();
        let inputs = chosen(path, wanted, &names)?;
        let column = |name: &String| -> Result<Vec<f64>, DataError> {
            match by_name.get(name.as_str()) {
                Some(Channel { values, .. }) => match values.iter().position(|value| value.is_infinite()) {
                    None => Ok(values.clone()),
                    Some(row) => {
                        let what = format!(
                            "{name} less the ambient light is beyond 1e308 at {} s; write the log in volts",
                            samples.time_s[row]
                        );
                        Err(DataError::Columns { path: path.to_owned(), what })
                    }
                },
                None => {
                    let angle = if name.ends_with("_deg") {
                        "; angles come from a video: run `lunula align` first"
                    } else {
                        ""
                    };
                    let what = format!("is a raw log and {}{of_columns}{angle}", missing(name, &names));
                    Err(DataError::Columns { path: path.to_owned(), what })
                }
            }
        };
        let x = inputs.iter().map(column).collect::<Result<_, _>>()?;
        let y = wanted.targets.iter().map(column).collect::<Result<_, _>>()?;
        let rows = samples.time_s.len();
        let mut source = Self {
            path: path.to_owned(),
            inputs,
            x,
            y,
            invalid: vec![false; rows],
            faulty: vec![false; rows],
            is_lit: wanted.rows.log.led_of(path),
            groups,
            notes,
            warnings,
            time_s: samples.time_s,
        };
        source.read_status(|take| {
            samples.faults.iter().enumerate().for_each(|(row, fault)| take(row, fault));
            Ok(())
        })?;
        Ok(source)
    }

    /// Takes angles away that stand where `label_status` says that there is none.
    fn without_filled_labels(&mut self, table: &Table, targets: &[String]) -> Result<(), TableError> {
        let angles =
            targets.iter().zip(&mut self.y).filter_map(|(name, y)| Some((name, name.strip_suffix("_deg")?, y)));
        let mut angles: Vec<_> = angles.map(|(name, joint, y)| (name, joint, y, 0_usize)).collect();
        table.each_text("label_status", |row, status| {
            for (_, joint, values, filled) in &mut angles {
                if !values[row].is_nan() && lacks_label(status, joint) {
                    values[row] = f64::NAN;
                    *filled += 1;
                }
            }
        })?;
        let said = angles.iter().filter(|(.., filled)| *filled > 0).map(|(name, _, _, filled)| {
            format!(
                "{}: {name} stands in {filled} row(s) of which `label_status` says that they have none: were empty \
                 cells filled in? They count as empty; where the labels are your own, leave out the column \
                 `label_status`",
                self.path.display()
            )
        });
        self.warnings.extend(said);
        Ok(())
    }

    /// Marks the rows that statuses warn of.
    fn read_status(
        &mut self,
        each: impl FnOnce(&mut dyn FnMut(usize, &str)) -> Result<(), TableError>,
    ) -> Result<(), DataError> {
        let mut statuses = Statuses::new(&self.inputs);
        let mut unknown = Unknown::default();
        let faulty = &mut self.faulty;
        each(&mut |row, status| match statuses.read(status) {
            Verdict::Sound => {}
            Verdict::Fault => faulty[row] = true,
            Verdict::Unknown => unknown.add(status),
        })?;
        self.warnings.extend(unknown.warning().map(|warning| format!("{}: {warning}", self.path.display())));
        Ok(())
    }
}

/// The photodiodes or cells to read: as wanted, else all.
fn chosen(path: &Path, wanted: &Wanted, names: &[String]) -> Result<Vec<String>, DataError> {
    let all = |names| if wanted.cells { cells(names) } else { photodiodes(names) };
    let mut inputs = wanted.inputs.clone().unwrap_or_else(|| all(names));
    if wanted.photodiodes_too {
        let others = photodiodes(names).into_iter().filter(|name| !inputs.contains(name)).collect::<Vec<_>>();
        inputs.extend(others);
    }
    if inputs.is_empty() && wanted.cells {
        let what = format!(
            "has no cell `C_00_00`, `C_00_01`, ... of a nail's picture: `lunula nailvideo --cells` makes them. {}",
            listed(names, 40)
        );
        return Err(DataError::Columns { path: path.to_owned(), what });
    }
    if inputs.is_empty() {
        let what = format!("has no photodiode `P1`, `P2`, ... {}", listed(names, 40));
        return Err(DataError::Columns { path: path.to_owned(), what });
    }
    Ok(inputs)
}

struct NumberColumn {
    /// NaN where missing or invalid.
    values: Vec<f64>,
    /// Rows with a cell that is no finite number.
    invalid: Vec<usize>,
}

impl NumberColumn {
    fn read(table: &Table, name: &str) -> Result<Self, TableError> {
        let mut column = Self { values: Vec::with_capacity(table.rows()), invalid: Vec::new() };
        table.each_cell(name, |row, cell| {
            column.values.push(match cell {
                Cell::Number(number) if number.is_finite() => number,
                Cell::Missing => f64::NAN,
                Cell::Number(_) | Cell::Text(_) => {
                    column.invalid.push(row);
                    f64::NAN
                }
            });
            Ok(())
        })?;
        Ok(column)
    }
}

fn bad_cell(table: &Table, row: usize, name: &str) -> Result<TableError, TableError> {
    let mut shown = String::new();
    table.each_cell(name, |at, cell| {
        if at == row {
            shown = match cell {
                Cell::Missing => String::new(),
                Cell::Number(number) => number.to_string(),
                Cell::Text(text) => text.chars().take(40).collect(),
            };
        }
        Ok(())
    })?;
    let what = format!(
        "`{shown}` is no finite number{}; correct it, leave it empty, or leave out such rows with --drop-invalid",
        decimal_comma(&shown)
    );
    Ok(table.cell(row, name, what))
}

/// Leaves only the cells where files have other photodiodes than each other.
pub(super) fn without_other_photodiodes(sources: &mut [Source]) {
    if sources.windows(2).all(|pair| pair[0].inputs == pair[1].inputs) {
        return;
    }
    for source in sources {
        let kept: Vec<bool> = source.inputs.iter().map(|name| cell(name).is_some()).collect();
        let mut is_kept = kept.iter();
        source.inputs.retain(|_| is_kept.next().is_some_and(|kept| *kept));
        let mut is_kept = kept.iter();
        source.x.retain(|_| is_kept.next().is_some_and(|kept| *kept));
    }
}

/// Whether all files have the same photodiodes.
pub(super) fn agree(sources: &[Source]) -> Result<(), DataError> {
    let first = &sources[0];
    let Some(other) = sources.iter().find(|source| source.inputs != first.inputs) else { return Ok(()) };
    let lacks = |a: &Source, b: &Source| {
        let lacking: Vec<&str> = b.inputs.iter().filter(|p| !a.inputs.contains(p)).map(String::as_str).collect();
        (!lacking.is_empty()).then(|| format!("{} lacks {}", a.path.display(), lacking.join(", ")))
    };
    let differences: Vec<String> = [lacks(other, first), lacks(first, other)].into_iter().flatten().collect();
    let what = format!(
        "has other photodiodes than {} ({}); choose those that all files have, or leave a file out",
        first.path.display(),
        differences.join("; ")
    );
    Err(DataError::Columns { path: other.path.clone(), what })
}
