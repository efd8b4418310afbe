//! An input of a pipeline file, looked at: its rows or files, with all that is wrong with them.

use std::collections::{BTreeMap, BTreeSet};

use super::table::{Rows, read};
use super::{Item, Lacking, Origin, Relation, World, holds, plain};
use crate::job::Keys;
use crate::photo::MASKS;
use crate::photograph::PICTURES;
use crate::pipeline::items::pattern::{Disk, Match, Pattern};
use crate::pipeline::spec::{Filter, InputSource, InputSpec, Spec};
use crate::pipeline::store::MadeBefore;
use crate::toml_file::Fault;
use crate::video::FILMS;
use crate::words::{instead, say_the_same};

/// How many places of one fault are listed.
const TOLD: usize = 5;

/// An input's items, for each of the columns that stages name, or its files.
pub(in crate::pipeline) struct InputItems {
    /// Those of each column that stages name, or the files'.
    pub(in crate::pipeline) relations: Vec<Relation>,
    /// The names that a filter may use.
    pub(in crate::pipeline) columns: Vec<String>,
    /// Of a table all rows, those that `where` leaves out too: what is known of each, and its place in the table.
    pub(in crate::pipeline) rows: Vec<(Keys, String)>,
    /// Files that a pattern leaves out only for the case of letters.
    pub(in crate::pipeline) in_other_case: Vec<String>,
    /// Photographs and films that it leaves out for their ending, of which it takes none with another.
    pub(in crate::pipeline) in_other_format: Vec<String>,
    /// What it leaves out for a name that is not UTF-8.
    pub(in crate::pipeline) not_utf8: Vec<String>,
}

impl InputItems {
    pub(in crate::pipeline) fn of(&self, column: Option<usize>) -> Relation {
        self.relations.get(column.unwrap_or(0)).cloned().unwrap_or_default()
    }
}

/// Looks at an input.
///
/// # Errors
/// All that is wrong with it, at the lines that name it.
pub(in crate::pipeline) fn input_items(
    spec: &Spec,
    input: &InputSpec,
    world: &World<'_>,
) -> Result<InputItems, Vec<Fault>> {
    match &input.source {
        InputSource::Table(named) => {
            let rows = read(named, world).map_err(|why| vec![spec.fault(input.source_at, why)])?;
            of_table(spec, input, named, &rows, world)
        }
        InputSource::Files(pattern) => of_files(spec, input, pattern, world).map_err(|fault| vec![fault]),
    }
}

fn of_files(spec: &Spec, input: &InputSpec, said: &str, world: &World<'_>) -> Result<InputItems, Fault> {
    let fault = |what: String| spec.fault(input.source_at, what);
    let inside = said.strip_prefix("{phantom}/");
    let pattern = Pattern::parse(inside.unwrap_or(said)).map_err(fault)?;
    let (mut in_other_case, mut in_other_format) = (Vec::new(), Vec::new());
    let found = if inside.is_some() {
        if world.catalogue.is_none() {
            return Err(fault(
                "`{phantom}` is named, but there is no [phantom]; add it, or name your own files".to_owned(),
            ));
        }
        pattern.find(&world.listed)
    } else {
        let disk = Disk { base: world.base.clone(), out: world.out.canonicalize().ok() };
        within_results(&pattern, &input.filter, &disk, said, world).map_err(fault)?;
        let found = pattern.find(&disk);
        let paths: BTreeSet<&str> = found.matches.iter().map(|found| found.path.as_str()).collect();
        let others = pattern.in_any_case().map_or_else(Vec::new, |pattern| pattern.find(&disk).matches);
        let others = others.into_iter().filter(|other| holds(&input.filter, &other.keys));
        in_other_case.extend(others.map(|other| other.path).filter(|path| !paths.contains(path.as_str())));
        // A picture may lie beside its film, a mask beside its photograph.
        let is_mask = |path: &str| path.to_lowercase().split(['/', '_', '-', '.']).any(|part| MASKS.contains(&part));
        let is_new = |other: &Match| {
            // Most are those that the pattern finds itself.
            let is_other = !paths.contains(other.path.as_str()) && !in_other_case.contains(&other.path);
            is_other && !is_mask(&other.path) && !found.matches.iter().any(|found| goes_with(&other.path, &found.path))
        };
        let others = [&PICTURES, &FILMS].into_iter().filter_map(|endings| pattern.with_endings(endings));
        let others = others.flat_map(|pattern| pattern.find(&disk).matches).filter(is_new);
        in_other_format.extend(others.filter(|other| holds(&input.filter, &other.keys)).map(|other| other.path));
        found
    };
    if let Some(why) = found.nothing {
        let why = if inside.is_some() { format!("of the generated recordings, {why}") } else { why };
        return Err(fault(nothing_matches(said, &why)));
    }
    if !found.ambiguous.is_empty() {
        let listed = found.ambiguous[..found.ambiguous.len().min(TOLD)].join("; ");
        let what = format!(
            "`{said}` fits {} name(s) in two ways: {listed}; rename them, or write the pattern more narrowly",
            found.ambiguous.len()
        );
        return Err(fault(what));
    }
    let mut items = Vec::with_capacity(found.matches.len());
    for Match { path, keys } in found.matches {
        let origin = match inside {
            Some(_) => Origin::Generated(path.clone()),
            None => Origin::Given { path: world.at(&path), name: path.clone() },
        };
        if inside.is_some() && world.maker(&path).is_none() {
            let what = format!("{{phantom}}/{path} is made by several tasks; name folders within it");
            return Err(fault(what));
        }
        items.push(Item { columns: keys.clone(), keys, origin, place: path });
    }
    check_filter(spec, &input.filter, &pattern.names, |key| {
        items.iter().filter_map(|item| item.columns.get(key)).collect()
    })?;
    let relation = Relation { names: pattern.names.clone(), items, lacking: Vec::new() }.only(&input.filter);
    if relation.items.is_empty() {
        return Err(nothing_left(spec, input));
    }
    let (columns, not_utf8) = (pattern.names, found.not_utf8);
    Ok(InputItems { relations: vec![relation], columns, rows: Vec::new(), in_other_case, in_other_format, not_utf8 })
}

fn nothing_matches(said: &str, why: &str) -> String {
    format!("nothing matches `{said}`: {why}")
}

/// Whether a picture is of the same as one that is taken: `s01.jpg`, `s01_thumb.jpg`, `s01 (1).jpg` beside `s01.png`.
fn goes_with(path: &str, taken: &str) -> bool {
    let (taken, _) = taken.rsplit_once('.').unwrap_or((taken, ""));
    path.strip_prefix(taken).is_some_and(|rest| rest.starts_with(['.', '_', '-', ' ', '(']))
}

/// Refuses files that a pattern finds in the folder of results, unless a run made them: they would be left out.
fn within_results(
    pattern: &Pattern,
    filter: &Filter,
    disk: &Disk,
    said: &str,
    world: &World<'_>,
) -> Result<(), String> {
    let Some(out) = &disk.out else { return Ok(()) };
    let found = pattern.find(&Disk { base: disk.base.clone(), out: None });
    if let Some(why) = found.nothing {
        return Err(nothing_matches(said, &why));
    }
    let everywhere: Vec<Match> = found.matches.into_iter().filter(|found| holds(filter, &found.keys)).collect();
    let inside = |found: &Match| {
        let path = world.at(&found.path).canonicalize().ok()?;
        let inside = path.strip_prefix(out).ok()?.to_string_lossy().replace('\\', "/");
        (!inside.is_empty()).then_some(inside)
    };
    let inside: Vec<(&str, String)> =
        everywhere.iter().filter_map(|found| Some((found.path.as_str(), inside(found)?))).collect();
    if inside.is_empty() {
        return Ok(());
    }
    let made = MadeBefore::of(out);
    let own: Vec<&str> = inside.iter().filter(|(_, inside)| !made.holds(inside)).map(|(path, _)| *path).collect();
    let results = world.out.display();
    if own.is_empty() && inside.len() == everywhere.len() {
        return Err(format!(
            "`{said}` finds nothing but results of an earlier run in {results}, where this one's go; name the stage \
             that makes them, or choose another --out"
        ));
    }
    if own.is_empty() {
        return Ok(());
    }
    Err(format!(
        "`{said}` finds {} file(s) in {results}, where results go and no inputs are looked for: {}{}; choose a folder \
         of its own for --out",
        own.len(),
        own[..own.len().min(TOLD)].join(", "),
        if own.len() > TOLD { ", .." } else { "" }
    ))
}

fn of_table(
    spec: &Spec,
    input: &InputSpec,
    named: &str,
    rows: &Rows,
    world: &World<'_>,
) -> Result<InputItems, Vec<Fault>> {
    let mut faults = Vec::new();
    if rows.rows.is_empty() {
        faults.push(spec.fault(input.source_at, format!("{named} has no rows; add one for each recording")));
    }
    let known: Vec<&str> = rows.columns.iter().map(String::as_str).collect();
    let place_of = |name: &str| rows.columns.iter().position(|column| column == name);
    let mut file_columns = Vec::new();
    for (column, at) in &input.columns {
        match place_of(column) {
            Some(column) => file_columns.push(column),
            None => {
                faults.push(spec.fault(*at, format!("{named} has no column `{column}`; {}", instead(column, &known))))
            }
        }
    }
    for (key, at) in input.keys.iter().flatten() {
        match place_of(key) {
            None => faults.push(spec.fault(*at, format!("{named} has no column `{key}`; {}", instead(key, &known)))),
            Some(column) if file_columns.contains(&column) => {
                faults
                    .push(spec.fault(*at, format!("the column `{key}` holds files, which are no keys; leave it out")));
            }
            Some(_) => {}
        }
    }
    if let Err(fault) = check_filter(spec, &input.filter, &rows.columns, |key| {
        let column = place_of(key);
        let cells = rows.rows.iter().filter_map(|(cells, _)| Some(cells[column?].as_str()));
        cells.filter(|cell| !cell.is_empty()).collect()
    }) {
        faults.push(fault);
    }
    if !faults.is_empty() {
        return Err(faults);
    }
    let key_columns: Vec<usize> = match &input.keys {
        Some(keys) => keys.iter().filter_map(|(key, _)| place_of(key)).collect(),
        None => (0..known.len()).filter(|c| !file_columns.contains(c) && !rows.looks_like_files(*c)).collect(),
    };
    let taken: Vec<usize> =
        (0..rows.rows.len()).filter(|&row| holds(&input.filter, &rows.known(row, 0..known.len()))).collect();
    if taken.is_empty() {
        return Err(vec![nothing_left(spec, input)]);
    }
    let doubled = doubled(rows, &taken, &key_columns, &file_columns);
    if !doubled.is_empty() {
        let listed = doubled[..doubled.len().min(TOLD)].join("; ");
        let what = format!("{named} holds {} row(s) twice: {listed}; remove one of each", doubled.len());
        return Err(vec![spec.fault(input.source_at, what)]);
    }
    let names: Vec<String> = key_columns.iter().map(|&column| rows.columns[column].clone()).collect();
    let relations = file_columns
        .iter()
        .map(|&file| {
            let mut relation = Relation { names: names.clone(), ..Relation::default() };
            for &row in &taken {
                let (cells, place) = &rows.rows[row];
                let (keys, columns) = (rows.known(row, key_columns.iter().copied()), rows.known(row, 0..known.len()));
                if cells[file].is_empty() {
                    let reason = format!("{named} names no `{}` for it", rows.columns[file]);
                    relation.lacking.push(Lacking { keys, columns, reason });
                    continue;
                }
                let place = format!("{named}, {place}");
                relation.items.push(Item { keys, columns, origin: origin(&cells[file], rows, world), place });
            }
            relation
        })
        .collect();
    let all = (0..rows.rows.len()).map(|row| (rows.known(row, 0..known.len()), rows.rows[row].1.clone())).collect();
    let columns = rows.columns.clone();
    Ok(InputItems { relations, columns, rows: all, in_other_case: vec![], in_other_format: vec![], not_utf8: vec![] })
}

/// Where the file of a cell stands.
fn origin(cell: &str, rows: &Rows, world: &World<'_>) -> Origin {
    let inside = cell.strip_prefix("{phantom}/").map(plain);
    let beside = || plain(&if cell.starts_with('/') { cell.to_owned() } else { format!("{}{cell}", rows.folder) });
    let generated = inside.or_else(|| rows.generated.then(beside));
    match generated {
        None => {
            let name = beside();
            Origin::Given { path: world.at(&name), name }
        }
        Some(path) if world.generates(&path) && world.maker(&path).is_some() => Origin::Generated(path),
        Some(path) => {
            Origin::Given { path: world.out.join("phantom").join(&path), name: format!("{{phantom}}/{path}") }
        }
    }
}

/// Rows that say the same as an earlier one, as messages tell.
fn doubled(rows: &Rows, taken: &[usize], keys: &[usize], files: &[usize]) -> Vec<String> {
    let mut seen: BTreeMap<Vec<&str>, usize> = BTreeMap::new();
    let mut doubled = Vec::new();
    for &row in taken {
        let said: Vec<&str> = keys.iter().chain(files).map(|&column| rows.rows[row].0[column].as_str()).collect();
        if let Some(earlier) = seen.insert(said, row) {
            doubled.push(format!("{} and {}", rows.rows[earlier].1, rows.rows[row].1));
        }
    }
    doubled
}

fn nothing_left(spec: &Spec, input: &InputSpec) -> Fault {
    let at = input.filter.first().map_or(input.source_at, |(_, _, at)| *at);
    spec.fault(at, format!("no item of `{}` has all that `where` asks for", input.name))
}

/// Faults of a filter: keys that are none, values that nothing has.
pub(in crate::pipeline) fn check_filter<'v>(
    spec: &Spec,
    filter: &Filter,
    names: &[String],
    values_of: impl Fn(&str) -> Vec<&'v str>,
) -> Result<(), Fault> {
    for (key, values, at) in filter {
        let known: Vec<&str> = names.iter().map(String::as_str).collect();
        if !known.contains(&key.as_str()) {
            return Err(spec.fault(*at, format!("there is no key `{key}` to choose by; {}", instead(key, &known))));
        }
        let mut there = values_of(key);
        there.sort_unstable();
        there.dedup();
        if let Some(value) = values.iter().find(|value| !there.contains(&value.as_str())) {
            let same = there.iter().find(|known| say_the_same(key, known, value));
            let what = match (there.len(), same) {
                (0, _) => format!("nothing has a `{key}`"),
                (_, Some(same)) => format!("nothing has {key} = \"{value}\"; did you mean `{same}`?"),
                (1..=12, None) => format!("nothing has {key} = \"{value}\"; {}", instead(value, &there)),
                (more, None) => format!(
                    "nothing has {key} = \"{value}\"; there are {more} others, from {} to {}",
                    there[0],
                    there[more - 1]
                ),
            };
            return Err(spec.fault(*at, what));
        }
    }
    Ok(())
}
