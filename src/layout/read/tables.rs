//! Tables and raw logs to the second moments of each person.
//!
//! Candidates are the cells `C_rr_cc` where there are any, else the photodiodes `P1`, `P2`, ..; with a file of places
//! the photodiodes. All files have the same ones. A person is a value of the column `subject`, else the file.
//!
//! A candidate is left out that is nearer to the edge of the nail's box than asked for, missing in more than a fifth of
//! anybody's rows (outside of the outline, often hidden), or the same in all of anybody's rows (dead). Then a row
//! counts where no reading and no target is missing. A photodiode's reading is missing where the sensor had a fault, as
//! `sensor_status` or the log says: saturated, or without ambient light.

use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::ops::Range;

use lunula_predictor::{Criterion, Dataset, LayoutFault, LayoutProblem, Moments, Recording};
use ndarray::{Array2, Axis};
use rayon::prelude::*;

use super::given::{Given, LeftOutCandidates, Parts, PersonFigures, Target};
use super::places::{Place, cells, is_photodiode, photodiodes};
use crate::input::copies;
use crate::layout::error::LayoutError;
use crate::layout::held_out::OwnRows;
use crate::layout::options::{LayoutInputs, LayoutOptions};
use crate::log::{doubts, without_faults};
use crate::predictor::{DataFile, cell, contradictions};
use crate::table::{Table, TableError};

/// A candidate that more of a person's rows lack is left out (assumed).
const MOST_MISSING: f64 = 0.2;
/// Targets that are looked for where none is named.
const TARGETS: [&str; 4] = ["Fx_N", "Fy_N", "Fz_N", "J2_deg"];

/// The columns of a file, NaN where a cell is missing.
struct Source {
    names: Vec<String>,
    time_s: Vec<f64>,
    columns: BTreeMap<String, Vec<f64>>,
    /// The person of each row.
    subject: Vec<String>,
    notes: Vec<String>,
    warnings: Vec<String>,
}

/// The rows of a person.
#[derive(Default)]
struct Rows {
    /// Rows x candidates, one row after the other.
    x: Vec<f64>,
    /// Rows x targets.
    y: Vec<f64>,
    count: usize,
}

pub(super) fn read(inputs: &LayoutInputs, options: &LayoutOptions) -> Result<Given, LayoutError> {
    let sources: Vec<Source> =
        inputs.data.par_iter().map(|input| Source::read(input, options)).collect::<Result<_, _>>()?;
    let (first, path) = (&sources[0], &inputs.data[0].path);
    let has_cells = inputs.positions.is_none() && first.names.iter().any(|name| cell(name).is_some());
    let mut notes: Vec<String> = sources.iter().flat_map(|source| source.notes.clone()).collect();
    let all = if has_cells {
        cells(path, &first.names, options)?
    } else {
        let (places, known) = photodiodes(path, &first.names, inputs.positions.as_deref())?;
        if inputs.positions.is_none() && !places.is_empty() {
            notes.push(format!("no --positions: the photodiodes are where \"{}\" has them", known.name));
        }
        places
    };
    if all.is_empty() {
        let what = "has no candidates: columns C_rr_cc (`lunula nailvideo --cells`) or photodiodes P1, P2, ..";
        return Err(LayoutError::input(path, what));
    }
    let is_candidate = |name: &str| if has_cells { cell(name).is_some() } else { is_photodiode(name) };
    let own: Vec<&str> = all.iter().map(|place| place.name.as_str()).collect();
    agree(&sources, inputs, &own, is_candidate)?;
    let targets = targets(&sources, inputs, options)?;
    let people = people(&sources, &own, &targets);
    if people.is_empty() {
        return Err(LayoutError::input(path, "has no row below the names of the columns"));
    }
    let (kept, left_out) = choose(&all, &people, options)?;
    let twice = same_rows(&people);
    LayoutProblem::fits(kept.len(), people.len())?;
    let places: Vec<Place> = kept.iter().map(|&k| all[k].clone()).collect();
    let files = inputs.data.iter().map(|input| (input.path.display().to_string(), input.path.as_path()));
    let warnings = copies(files).into_iter().chain(twice).chain(contradicted(&sources, inputs, &own, &targets));
    let warnings = warnings.chain(sources.into_iter().flat_map(|source| source.warnings)).collect();
    let mut given = Given {
        criterion: Criterion::Error,
        places,
        moments: Vec::new(),
        parts: Parts::Persons(Vec::new()),
        persons: Vec::new(),
        targets: targets.iter().map(|name| Target { name: name.clone(), sd: Vec::new() }).collect(),
        left_out,
        rows: usize::MAX,
        contrast: None,
        notes,
        warnings,
    };
    let largest = options.k.0.last().copied().unwrap_or(1);
    for (person, rows) in &people {
        given.take(person, rows, &kept, [own.len(), targets.len()], largest)?;
    }
    Ok(given)
}

impl Given {
    /// Adds a person; `[all, targets]` count what a row of theirs has.
    fn take(
        &mut self,
        person: &str,
        rows: &Rows,
        kept: &[usize],
        [all, targets]: [usize; 2],
        largest: usize,
    ) -> Result<(), LayoutError> {
        let fault = |what: String| LayoutError::Person { person: person.to_owned(), what };
        let x = Array2::from_shape_fn((rows.count, kept.len()), |(row, k)| rows.x[row * all + kept[k]]);
        let y = Array2::from_shape_fn((rows.count, targets), |(row, k)| rows.y[row * targets + k]);
        let whole: Vec<usize> =
            (0..rows.count).filter(|&row| x.row(row).iter().chain(y.row(row)).all(|value| !value.is_nan())).collect();
        if whole.len() < largest + 2 {
            return Err(fault(format!(
                "{} of {} rows have all readings and targets, and {} are the fewest that a model of {largest} \
                 photodiodes takes; record more, or lower --k",
                whole.len(),
                rows.count,
                largest + 2
            )));
        }
        let (x, y) = (x.select(Axis(0), &whole), y.select(Axis(0), &whole));
        if kept.len() > 1 && x.rows().into_iter().all(|row| row.iter().all(|value| *value == row[0])) {
            return Err(fault(
                "all photodiodes read the same in every row, so no place is better than another".to_owned(),
            ));
        }
        let moments = Moments::of_rows(x.view(), y.view()).map_err(|why| match why {
            LayoutFault::ConstantTarget { column } => fault(format!(
                "{} is the same in all rows, so no reading can say it; leave it out with --targets",
                self.targets[column].name
            )),
            LayoutFault::NotFinite { .. } => fault("the readings or targets are too large to square".to_owned()),
            other => LayoutError::Problem(other),
        })?;
        for (target, column) in self.targets.iter_mut().zip(y.columns()) {
            target.sd.push(column.std(0.0));
        }
        let incomplete = rows.count - whole.len();
        self.persons.push(PersonFigures { name: person.to_owned(), rows: whole.len(), incomplete });
        self.moments.push(moments);
        if let Parts::Persons(each) = &mut self.parts {
            each.push(OwnRows { x, y });
        }
        self.rows = self.rows.min(whole.len());
        Ok(())
    }
}

impl Source {
    fn read(input: &DataFile, options: &LayoutOptions) -> Result<Self, LayoutError> {
        if options.log.is_log(&input.path)? { Self::of_log(input, options) } else { Self::of_table(input, options) }
    }

    fn of_table(input: &DataFile, options: &LayoutOptions) -> Result<Self, LayoutError> {
        let table = Table::read(&input.path)?;
        let mut columns = BTreeMap::new();
        // Only clocks are compared by it: places are found without.
        let time_s = table.values("time_s").unwrap_or_else(|_| vec![f64::NAN; table.rows()]);
        for name in table.names() {
            let target = options.targets.as_ref().map_or(TARGETS.contains(&name.as_str()), |own| own.contains(name));
            if target || cell(name).is_some() || is_photodiode(name) {
                columns.insert(name.clone(), table.values(name)?);
            }
        }
        let mut subject = vec![input.person().to_owned(); table.rows()];
        if table.has("subject") {
            table.each_text("subject", |row, text| {
                if !text.is_empty() {
                    text.clone_into(&mut subject[row]);
                }
            })?;
        }
        let known = columns.iter().map(|(name, values): (&String, &Vec<f64>)| (&name[..], &values[..]));
        let doubts = doubts::table(table.names(), known);
        let warnings = doubts.iter().map(|doubt| placed(input, doubt)).collect();
        let names = table.names().to_vec();
        let mut source = Self { names, time_s, columns, subject, notes: Vec::new(), warnings };
        if table.has("sensor_status") {
            source.without_faults(input, |take| table.each_text("sensor_status", take))?;
        }
        Ok(source)
    }

    fn of_log(input: &DataFile, options: &LayoutOptions) -> Result<Self, LayoutError> {
        let lit = options.log.lit_rows(&input.path)?;
        let notes: Vec<String> = lit.notes.iter().chain(&lit.samples.notes).map(|note| placed(input, note)).collect();
        let warnings = lit.samples.warnings.iter().map(|warning| placed(input, warning)).collect();
        let channels = lit.samples.photodiodes.into_iter().chain(lit.samples.forces);
        let columns: Vec<_> = channels.map(|channel| (channel.name, channel.values)).collect();
        let names = columns.iter().map(|(name, _)| name.clone()).collect();
        let mut subject = vec![input.person().to_owned(); lit.samples.time_s.len()];
        for (first, [_, own, _]) in &lit.groups {
            subject[*first..].fill(if own.is_empty() { input.person().to_owned() } else { own.clone() });
        }
        let columns = columns.into_iter().collect();
        let mut source = Self { names, time_s: lit.samples.time_s, columns, subject, notes, warnings };
        source.without_faults(input, |take| {
            lit.samples.faults.iter().enumerate().for_each(|(row, fault)| take(row, fault));
            Ok(())
        })?;
        Ok(source)
    }

    /// Takes away the readings of photodiodes in rows in which the sensor had a fault, and says so.
    fn without_faults(
        &mut self,
        input: &DataFile,
        each: impl FnOnce(&mut dyn FnMut(usize, &str)) -> Result<(), TableError>,
    ) -> Result<(), TableError> {
        let photodiodes = self.columns.iter_mut().filter(|(name, _)| is_photodiode(name));
        let photodiodes: Vec<(&str, &mut [f64])> =
            photodiodes.map(|(name, values)| (name.as_str(), &mut values[..])).collect();
        let names: Vec<String> = photodiodes.iter().map(|(name, _)| (*name).to_owned()).collect();
        let (faults, unknown) = without_faults(photodiodes, each)?;
        let counts = names.iter().zip(faults).filter(|(_, rows)| *rows > 0);
        let counts: Vec<String> = counts.map(|(name, rows)| format!("{name} in {rows} rows")).collect();
        if !counts.is_empty() {
            let what = format!("not read where saturated or without ambient light: {}", counts.join(", "));
            self.notes.push(placed(input, &what));
        }
        self.warnings.extend(unknown.warning().map(|warning| placed(input, &warning)));
        Ok(())
    }
}

fn placed(input: &DataFile, what: &str) -> String {
    format!("{}: {what}", input.path.display())
}

/// Whether all files have the same candidates.
fn agree(
    sources: &[Source],
    inputs: &LayoutInputs,
    own: &[&str],
    is_candidate: impl Fn(&str) -> bool,
) -> Result<(), LayoutError> {
    let first = inputs.data[0].path.display();
    for (source, input) in sources.iter().zip(&inputs.data).skip(1) {
        if let Some(lacking) = own.iter().find(|name| !source.columns.contains_key(**name)) {
            let what = format!("has no column {lacking}, which {first} has; every input needs the same candidates");
            return Err(LayoutError::input(&input.path, what));
        }
        if let Some(other) = source.names.iter().find(|name| is_candidate(name) && !own.contains(&name.as_str())) {
            let what = format!("has a column {other}, which {first} lacks; every input needs the same candidates");
            return Err(LayoutError::input(&input.path, what));
        }
    }
    Ok(())
}

/// The targets: as named, else the known ones that every file has.
fn targets(sources: &[Source], inputs: &LayoutInputs, options: &LayoutOptions) -> Result<Vec<String>, LayoutError> {
    let Some(named) = &options.targets else {
        let everywhere = |name: &&str| sources.iter().all(|source| source.columns.contains_key(*name));
        let known: Vec<String> =
            TARGETS.iter().filter(|name| everywhere(name)).map(|name| (*name).to_owned()).collect();
        if known.is_empty() {
            let what = format!(
                "there is no target: no {} in every input; name columns with --targets, or join loads to the \
                 readings first",
                TARGETS.join(", ")
            );
            return Err(LayoutError::input(&inputs.data[0].path, what));
        }
        return Ok(known);
    };
    for (k, name) in named.iter().enumerate() {
        if named[..k].contains(name) || cell(name).is_some() || is_photodiode(name) {
            let what = format!("--targets: {name} is there twice, or is a reading; name each target once");
            return Err(LayoutError::Request(what));
        }
        if let Some(at) = sources.iter().position(|source| !source.columns.contains_key(name)) {
            let names = sources[at].names.iter().filter(|name| cell(name).is_none() && !is_photodiode(name));
            let others = names.cloned().collect::<Vec<_>>().join(", ");
            let what = format!("has no column {name}; its columns besides readings are {others}");
            return Err(LayoutError::input(&inputs.data[at].path, what));
        }
    }
    Ok(named.clone())
}

/// What the files say against each other. Rows without a target, or without a photodiode, are not looked at.
fn contradicted(sources: &[Source], inputs: &LayoutInputs, own: &[&str], targets: &[String]) -> Vec<String> {
    let (mut time_s, mut x, mut y) = (Vec::new(), Vec::new(), Vec::new());
    let (mut recordings, mut parts): (Vec<Recording>, Vec<Range<usize>>) = (Vec::new(), Vec::new());
    let are_cells = own.iter().all(|name| cell(name).is_some());
    let is_known = |values: &[f64]| values.iter().all(|value| value.is_finite());
    for (source, input) in sources.iter().zip(&inputs.data) {
        let of = |names: &mut dyn Iterator<Item = &str>| names.map(|name| &source.columns[name]).collect::<Vec<_>>();
        let [readings, measured] = [of(&mut own.iter().copied()), of(&mut targets.iter().map(String::as_str))];
        let start = time_s.len();
        for (row, at_s) in source.time_s.iter().enumerate() {
            let [own_x, own_y] = [&readings, &measured].map(|all| all.iter().map(|v| v[row]).collect::<Vec<f64>>());
            if is_known(&own_y) && (are_cells || is_known(&own_x)) {
                time_s.push(*at_s);
                x.extend(own_x);
                y.extend(own_y);
            }
        }
        let rows = start..time_s.len();
        // Everybody has a model of their own here, also those whose name is only their file's: they may differ.
        let person = source.subject.first().map_or(input.person(), String::as_str);
        let [name, session] = [&input.name; 2].map(String::clone);
        let subject = format!("person {person}");
        recordings.push(Recording { name, session, subject, rows: rows.clone() });
        parts.push(rows);
    }
    let shaped = |values: Vec<f64>, columns: usize| Array2::from_shape_vec((time_s.len(), columns), values).ok();
    let (Some(x), Some(y)) = (shaped(x, own.len()), shaped(y, targets.len())) else { return Vec::new() };
    let names = own.iter().map(|&name| name.to_owned()).collect();
    let data = Dataset::with_hidden(names, targets.to_vec(), time_s, x, y, recordings);
    let called: Vec<&str> = inputs.data.iter().map(|input| input.name.as_str()).collect();
    data.map(|data| contradictions(&data, &parts, &called)).unwrap_or_default()
}

/// The rows of each person, by name.
fn people(sources: &[Source], own: &[&str], targets: &[String]) -> BTreeMap<String, Rows> {
    let mut people: BTreeMap<String, Rows> = BTreeMap::new();
    for source in sources {
        let columns = |names: &mut dyn Iterator<Item = &str>| -> Vec<&Vec<f64>> {
            names.map(|name| &source.columns[name]).collect()
        };
        let x = columns(&mut own.iter().copied());
        let y = columns(&mut targets.iter().map(String::as_str));
        for (row, subject) in source.subject.iter().enumerate() {
            // Not `entry`, which would copy the name for each row.
            if !people.contains_key(subject) {
                people.insert(subject.clone(), Rows::default());
            }
            let Some(person) = people.get_mut(subject) else { continue };
            person.x.extend(x.iter().map(|column| column[row]));
            person.y.extend(y.iter().map(|column| column[row]));
            person.count += 1;
        }
    }
    people
}

/// What to say of persons who have the same readings and targets: one recording under several names, by which the
/// interval over persons is too narrow.
fn same_rows(people: &BTreeMap<String, Rows>) -> Vec<String> {
    let mut by_rows: BTreeMap<u64, Vec<&str>> = BTreeMap::new();
    for (person, rows) in people {
        let mut hasher = DefaultHasher::new();
        rows.x.iter().chain(&rows.y).for_each(|value| value.to_bits().hash(&mut hasher));
        by_rows.entry(hasher.finish()).or_default().push(person);
    }
    let mut said: Vec<String> = by_rows
        .into_values()
        .filter(|persons| persons.len() > 1)
        .map(|persons| {
            format!(
                "{} have the same readings and targets, row by row, and count as {} persons: is this one recording \
                 under several names? The interval over persons is too narrow then",
                persons.join(", "),
                persons.len()
            )
        })
        .collect();
    said.sort();
    said
}

/// The candidates that stay, and how many do not.
fn choose(
    all: &[Place],
    people: &BTreeMap<String, Rows>,
    options: &LayoutOptions,
) -> Result<(Vec<usize>, LeftOutCandidates), LayoutError> {
    let mut left_out = LeftOutCandidates::default();
    let mut kept = Vec::new();
    for (k, place) in all.iter().enumerate() {
        let readings = |rows: &Rows| rows.x.iter().skip(k).step_by(all.len()).copied().collect::<Vec<f64>>();
        let missing = |rows: &Rows| {
            let lacking = readings(rows).iter().filter(|value| value.is_nan()).count();
            lacking as f64 > MOST_MISSING * rows.count as f64
        };
        let constant = |rows: &Rows| {
            let known: Vec<f64> = readings(rows).into_iter().filter(|value| !value.is_nan()).collect();
            known.iter().all(|value| *value == known[0])
        };
        if !place.is_inside(options) {
            left_out.edge += 1;
        } else if people.values().any(missing) {
            left_out.missing += 1;
        } else if people.values().any(constant) {
            left_out.constant += 1;
        } else {
            kept.push(k);
            continue;
        }
        if options.keep.contains(&place.name) {
            let what = format!("--keep: {} is too near to the edge, missing or the same in all rows", place.name);
            return Err(LayoutError::Request(what));
        }
    }
    if kept.is_empty() {
        let LeftOutCandidates { edge, missing, constant, .. } = left_out;
        let what = format!(
            "no candidate is left: {edge} are nearer than {} mm to the edge of the nail's box, {missing} are missing \
             in more than a fifth of somebody's rows, {constant} are the same in all rows of somebody",
            options.edge
        );
        return Err(LayoutError::Request(what));
    }
    Ok((kept, left_out))
}
