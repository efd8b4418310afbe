//! Tables and logs of the user into rows for the models (5.2).
//!
//! In: CSV or Parquet tables with `P1`.. in volts and the targets, as `lunula align` and anybody else writes them, or
//! cells of a nail's picture (`C_00_00`.., row and column, of which a row may lack some), or
//! raw logs with a column `led` (section 3.1.2c), which are brought to the LED's own light by the same code as in align
//! ([`LogReading`]). Out: a [`Dataset`] with what was left out and why ([`read_data`], [`read_files`]); voltages alone
//! ([`read_inputs`]). Rows of a stream are `live`'s.
//!
//! Conventions. A file is a recording; it is several where `session`, `subject` or `trajectory` change or `time_s` goes
//! back. Where `session` or `subject` is given neither by the file nor with it, the file stands for it. A row with an
//! empty cell that is needed is left out and counted; `nan`, `inf` or text there is an error, or with `drop_invalid`
//! left out and counted. A row whose `sensor_status` (as align writes it) says that a photodiode in use is saturated or
//! without ambient light is left out and counted, unless faults are kept. A row that is left out for several reasons is
//! counted once: as a fault, else as invalid, else as empty. In a raw log `nan` and `NA` mean missing, as in align.

mod blocks;
mod columns;
mod file;
mod frozen;
mod health;
mod recordings;
mod source;
#[cfg(test)]
mod tests;

use clap::Args;
use std::collections::{HashMap, HashSet};
use std::ops::Range;
use std::path::{Path, PathBuf};

use lunula_predictor::{Dataset, DatasetFault, Past, Recording, recording_hashes};
use ndarray::Array2;
use rayon::prelude::*;

use crate::log::{LogError, LogReading};
use crate::table::TableError;
use crate::words::twins;
use blocks::Blocks;
use recordings::Splitter;
use source::{Source, agree};

pub(crate) use columns::{cell, missing};
pub use file::DataFile;
pub(in crate::predictor) use health::{looks, persons, units};

/// Which rows of recordings count.
#[derive(Debug, Clone, PartialEq, Default, Args)]
pub struct RowOptions {
    /// A cell that is not a finite number counts as missing: its row is left out, and counted [default: it is an error]
    #[arg(long)]
    pub drop_invalid: bool,
    /// Rows in which `lunula align` found a photodiode saturated or without ambient light count too
    #[arg(long)]
    pub keep_faults: bool,
    /// How raw logs are read.
    #[command(flatten)]
    pub log: LogReading,
}

/// What is read of tables.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Wanted {
    /// The photodiodes; none: all columns `P<number>`, in the order of their numbers.
    pub inputs: Option<Vec<String>>,
    /// The targets: `Fx_N`, `Fy_N`, `Fz_N`, or `J2_deg`.
    pub targets: Vec<String>,
    /// Which rows count.
    pub rows: RowOptions,
    /// Whether a file that can't be read costs only itself, rather than being an error; where none can be, it is one.
    pub skip_failed: bool,
    /// Whether the inputs are cells of a nail's picture: where none are named, all columns `C_<row>_<column>`. A row
    /// may lack some.
    pub cells: bool,
    /// Whether photodiodes are read as well, after the cells, where all files have the same.
    pub photodiodes_too: bool,
}

/// What was read.
#[derive(Debug, Clone)]
pub struct Read {
    /// The rows.
    pub data: Dataset,
    /// The files, as given.
    pub files: Vec<FileRows>,
    /// Files that can't be read and were skipped, as that was asked for.
    pub failed: Vec<FailedFile>,
    /// What is no error but worth saying.
    pub warnings: Vec<String>,
}

impl Read {
    /// What was done to raw logs, and which columns were guessed.
    pub(crate) fn notes(&self) -> impl Iterator<Item = String> {
        self.files.iter().flat_map(|file| file.notes.iter().cloned())
    }
}

/// A file that was skipped.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct FailedFile {
    /// What tables, pictures and models call it.
    pub name: String,
    /// Why, with its place.
    pub why: String,
}

/// What became of a file's rows.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct FileRows {
    /// The file.
    pub path: PathBuf,
    /// Its rows (of a raw log: its lit rows).
    pub rows: usize,
    /// Rows that are used.
    pub used: usize,
    /// Rows left out for an empty cell.
    pub empty: usize,
    /// Rows left out for a cell that is no finite number.
    pub invalid: usize,
    /// Rows left out for what `sensor_status` says.
    pub faults: usize,
    /// What was done to a raw log: how its ambient light was taken away.
    pub notes: Vec<String>,
}

/// Voltages without targets; every row of the file is there.
#[derive(Debug, Clone)]
pub struct Inputs {
    /// Seconds, row by row; NaN where not known.
    pub time_s: Vec<f64>,
    /// Volts, rows x photodiodes, in standard layout; NaN where a cell is empty or invalid.
    pub x: Array2<f64>,
    /// Rows in which `sensor_status` says that a photodiode in use is saturated or without ambient light.
    pub faulty: Vec<bool>,
    /// The recordings, in order.
    pub recordings: Vec<Recording>,
    /// What was done to a raw log: how its ambient light was taken away.
    pub notes: Vec<String>,
    /// What is no error but worth saying.
    pub warnings: Vec<String>,
}

/// Why there are no rows.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum DataError {
    #[error(transparent)]
    Table(#[from] TableError),
    #[error(transparent)]
    Log(#[from] LogError),
    #[error("{}: {what}", path.display())]
    Columns { path: PathBuf, what: String },
    #[error("no row can be used: {0}")]
    NoRows(String),
    #[error("{0}")]
    Request(String),
    #[error(transparent)]
    Dataset(#[from] DatasetFault),
}

/// Reads labelled rows from tables and raw logs; the result does not depend on the number of threads.
///
/// # Errors
/// [`DataError`]; of several files, that of the first.
pub fn read_data(paths: &[PathBuf], wanted: &Wanted) -> Result<Read, DataError> {
    read_files(&DataFile::of(paths), wanted)
}

/// As [`read_data`], of files that are called otherwise than their paths are written.
///
/// # Errors
/// As [`read_data`].
pub fn read_files(data: &[DataFile], wanted: &Wanted) -> Result<Read, DataError> {
    if data.is_empty() {
        return Err(DataError::Request("no DATA is given; name at least one table or log".to_owned()));
    }
    if wanted.targets.is_empty() {
        return Err(DataError::Request("no target is given".to_owned()));
    }
    let inputs = wanted.inputs.as_deref().unwrap_or_default();
    let mut seen = HashSet::new();
    if let Some(name) = inputs.iter().find(|name| !seen.insert(name.as_str())) {
        return Err(DataError::Request(format!("{name} is named twice among the inputs; name each once")));
    }
    if inputs.iter().chain(&wanted.targets).any(|name| name == "time_s") {
        let what = "time_s is when a row was measured, neither an input nor a target; leave it out of both";
        return Err(DataError::Request(what.to_owned()));
    }
    if let Some(name) = inputs.iter().find(|name| wanted.targets.contains(name)) {
        return Err(DataError::Request(format!("{name} is both an input and a target; leave it out of one of them")));
    }
    let read = data.par_iter().map(|file| Source::read(&file.path, wanted)).collect::<Vec<_>>();
    let (mut sources, mut data_read, mut faults, mut failed) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (source, file) in read.into_iter().zip(data) {
        match source {
            Ok(source) => {
                sources.push(source);
                data_read.push(file.clone());
            }
            Err(why) if wanted.skip_failed => {
                failed.push(FailedFile { name: file.name.clone(), why: why.to_string() });
                faults.push(why);
            }
            Err(why) => return Err(why),
        }
    }
    if sources.is_empty() {
        return Err(faults.swap_remove(0));
    }
    let data = &data_read[..];
    if wanted.photodiodes_too {
        source::without_other_photodiodes(&mut sources);
    }
    agree(&sources)?;
    let mut warnings = Vec::from_iter(lit_and_not(&sources));
    let inputs = sources[0].inputs.clone();
    let (mut files, mut parts) = (Vec::with_capacity(sources.len()), Vec::with_capacity(sources.len()));
    let mut recordings: Vec<Recording> = Vec::new();
    let (mut time_s, mut x, mut y, mut past) = (Vec::new(), Vec::new(), Vec::new(), Past::default());
    for (source, called) in sources.iter().zip(data) {
        warnings.extend(source.warnings.iter().cloned());
        let (path, notes) = (source.path.clone(), source.notes.clone());
        let mut file = FileRows { path, rows: source.rows(), used: 0, empty: 0, invalid: 0, faults: 0, notes };
        let start = time_s.len();
        let mut splitter = Splitter::new(source, called, start);
        for row in 0..source.rows() {
            if source.faulty[row] && !wanted.rows.keep_faults {
                file.faults += 1;
            } else if source.invalid[row] {
                file.invalid += 1;
                splitter.pass(row);
            } else if source.lacks(row, wanted.cells) {
                file.empty += 1;
                splitter.pass(row);
            } else {
                file.used += 1;
                splitter.take(row);
                time_s.push(source.time_s[row]);
                x.extend(source.x.iter().map(|column| column[row]));
                y.extend(source.y.iter().map(|column| column[row]));
            }
        }
        splitter.finish(&mut recordings, &mut past, &mut warnings);
        warnings.extend(health::warnings(source, &wanted.targets, wanted.rows.keep_faults));
        if file.used == 0 {
            let columns = source.inputs.iter().chain(&wanted.targets).zip(source.empty_cells());
            let empty: Vec<&str> =
                columns.filter(|(_, empty)| *empty == file.rows).map(|(name, _)| name.as_str()).collect();
            let why = if empty.is_empty() { String::new() } else { format!("; {} is always empty", empty.join(", ")) };
            warnings.push(format!("{}: none of its {} rows is used{why}", called.name, file.rows));
        }
        files.push(file);
        parts.push(start..time_s.len());
    }
    let rows = time_s.len();
    if rows == 0 {
        return Err(DataError::NoRows(why_none(&files, &sources, &wanted.targets)));
    }
    let shaped = |values: Vec<f64>| {
        let columns = values.len() / rows;
        Array2::from_shape_vec((rows, columns), values).expect("every row gives as many values")
    };
    let make = if wanted.cells { Dataset::with_hidden } else { Dataset::new };
    let data = make(inputs, wanted.targets.clone(), time_s, shaped(x), shaped(y), recordings)?.with_past(past)?;
    warnings.extend(twice(&data));
    let names = |of: fn(&Recording) -> &String| data.recordings().iter().map(move |one| of(one).as_str());
    warnings.extend(twins("subjects", names(|one| &one.subject)));
    warnings.extend(twins("sessions", names(|one| &one.session)));
    let names: Vec<&str> = data_read.iter().map(|file| file.name.as_str()).collect();
    warnings.extend(contradictions(&data, &parts, &names));
    Ok(Read { data, files, failed, warnings })
}

/// What files, whose rows are `parts`, say against each other, and columns against those beside them: other clocks,
/// units, signs or orders, and what hangs. Cells, of which each says little, are looked at in blocks.
pub(crate) fn contradictions(data: &Dataset, parts: &[Range<usize>], names: &[&str]) -> Vec<String> {
    let said = |data: &Dataset, parts: &[Range<usize>], orders: &[Vec<usize>]| {
        let alone = health::clocks(data).into_iter().chain(frozen::warnings(data)).chain(health::units([data]));
        let alone = alone.chain(health::within(data));
        alone.chain(health::mismatched(data, parts, orders, names)).collect()
    };
    if data.inputs().iter().all(|name| cell(name).is_none()) {
        return said(data, parts, &[]);
    }
    let of_blocks = |blocks: Blocks| {
        let parts: Vec<Range<usize>> = parts.iter().map(|rows| blocks.part(rows)).collect();
        said(&blocks.data, &parts, &blocks.orders)
    };
    Blocks::of(data).map(of_blocks).unwrap_or_default()
}

/// Reads the voltages of `inputs` from a table or raw log, read as `log` says; targets need not be there. With
/// `drop_invalid`, a cell that is no finite number is NaN rather than an error.
pub fn read_inputs(path: &Path, inputs: &[String], rows: &RowOptions) -> Result<Inputs, DataError> {
    if inputs.is_empty() {
        return Err(DataError::Request("no photodiode is given".to_owned()));
    }
    let wanted = Wanted { inputs: Some(inputs.to_vec()), rows: rows.clone(), ..Wanted::default() };
    let source = Source::read(path, &wanted)?;
    let mut warnings = source.warnings.clone();
    let mut recordings = Vec::new();
    let called = DataFile::from(path.to_owned());
    let mut splitter = Splitter::new(&source, &called, 0);
    (0..source.rows()).for_each(|row| splitter.take(row));
    splitter.finish(&mut recordings, &mut Past::default(), &mut warnings);
    warnings.extend(health::warnings(&source, &[], rows.keep_faults));
    let x = Array2::from_shape_fn((source.rows(), inputs.len()), |(row, column)| source.x[column][row]);
    let Source { time_s, faulty, notes, .. } = source;
    if inputs.iter().all(|name| cell(name).is_none()) {
        let is_sound = |row: &usize| rows.keep_faults || !faulty[*row];
        let whole = (0..faulty.len()).filter(|row| is_sound(row) && x.row(*row).iter().all(|value| value.is_finite()));
        let none = Array2::zeros((faulty.len(), 0));
        let all =
            Dataset::with_hidden(inputs.to_vec(), Vec::new(), time_s.clone(), x.clone(), none, recordings.clone())?;
        warnings.extend(frozen::warnings(&all.only_rows(&whole.collect::<Vec<_>>())));
    }
    Ok(Inputs { time_s, x, faulty, recordings, notes, warnings })
}

/// What to say where some logs have the column of the LED and others have lost it.
fn lit_and_not(sources: &[Source]) -> Option<String> {
    let [without, with] = [false, true].map(|lit| sources.iter().find(|source| source.is_lit == Some(lit)));
    let [without, with] = [without?, with?].map(|source| source.path.display());
    Some(format!(
        "{without} has no column `led`, and {with} has: is the ambient light in the one, which is taken from the \
         other? Give both as they were logged"
    ))
}

/// Recordings that are there twice, under whatever names.
fn twice(data: &Dataset) -> Vec<String> {
    // Most differ by the number of their rows, or by the first.
    let first_row = |one: &Recording| data.x().row(one.rows.start).iter().map(|value| value.to_bits()).collect();
    let mut seen: HashSet<(usize, Vec<u64>)> = HashSet::new();
    if data.recordings().iter().all(|one| seen.insert((one.rows.len(), first_row(one)))) {
        return Vec::new();
    }
    let mut names: HashMap<String, &str> = HashMap::new();
    let mut said = Vec::new();
    for (one, hash) in data.recordings().iter().zip(recording_hashes(data)) {
        match names.get(&hash) {
            Some(&name) if name == one.name => said.push(format!("{name}: is given twice; its rows count twice")),
            Some(name) => said.push(format!("{} holds the rows of {name}; they count twice", one.name)),
            None => drop(names.insert(hash, &one.name)),
        }
    }
    said
}

fn why_none(files: &[FileRows], sources: &[Source], targets: &[String]) -> String {
    let sum = |of: fn(&FileRows) -> usize| files.iter().map(of).sum::<usize>();
    let all = sum(|f| f.rows);
    let names = files.iter().map(|f| f.path.display().to_string()).collect::<Vec<_>>().join(", ");
    if all == 0 {
        return format!("{names}: there is no row below the names of the columns");
    }
    let reasons = [
        (sum(|f| f.empty), "have an empty cell that is needed"),
        (sum(|f| f.invalid), "have a cell that is no finite number"),
        (sum(|f| f.faults), "are saturated or without ambient light (sensor_status; --keep-faults keeps them)"),
    ];
    let counts: Vec<String> = reasons.iter().filter(|(n, _)| *n > 0).map(|(n, why)| format!("{n} {why}")).collect();
    let mut empty = vec![0; sources[0].inputs.len() + targets.len()];
    for source in sources {
        empty.iter_mut().zip(source.empty_cells()).for_each(|(sum, rows)| *sum += rows);
    }
    let named = sources[0].inputs.iter().chain(targets).zip(&empty).filter(|(_, rows)| **rows > 0);
    let columns: Vec<String> = named.map(|(name, rows)| format!("{name} in {rows}")).collect();
    let columns = if columns.is_empty() { String::new() } else { format!("; empty are {}", columns.join(", ")) };
    let is_apart = sum(|f| f.empty) > 0 && empty.iter().all(|rows| *rows < all);
    let apart = if is_apart { "; no row has all: write them at the same times, interpolated" } else { "" };
    format!("{names}: of {all} rows {}{columns}{apart}", counts.join(", "))
}
