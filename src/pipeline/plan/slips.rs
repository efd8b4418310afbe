//! What is left out for a slip of the finger: rows of a table whose value is all but one that a `where` asks for, or
//! that lacks it, and files whose names fit a pattern but for the case of letters, are of another format, or are not
//! UTF-8. And what is done apart for one: values of a table or of files' names, of a key that a stage is done for each
//! of, that differ in case and spaces only.
//!
//! A value is a slip where no `where` asks for it as it is written, and it says the same as one that is asked for
//! ([`say_the_same`]: case, spaces, zeros in front of numbers; `1.0` or `Rep1` for the repetition `1`); or differs from
//! it by one letter, where no task works on the row. Values that differ in a digit otherwise, or in their first or last
//! letter, are numbered or lettered ones, as `S01` and `S02`, `day_a` and `day_b`.

use std::collections::{BTreeMap, BTreeSet};

use crate::pipeline::items::InputItems;
use crate::pipeline::spec::{Filter, From, InputSource, Spec, StageSpec};
use crate::words::{plain, say_the_same, twins};

/// How many places of one slip are listed.
const SHOWN: usize = 3;
/// The shortest value that is taken for another with one letter wrong: words of three letters are too often alike.
const SHORTEST: usize = 4;

/// Whose a file is.
const SUBJECT: &str = "subject";

/// The values that are asked for, by table and key.
type Asked<'a> = BTreeMap<(&'a str, &'a str), BTreeSet<&'a str>>;

/// A warning for each slip; `taken` are the places of the items that tasks work on.
pub(super) fn slips(spec: &Spec, inputs: &[Option<InputItems>], taken: &BTreeSet<String>) -> Vec<String> {
    let mut warnings = Vec::new();
    let mut tables: BTreeMap<&str, &InputItems> = BTreeMap::new();
    for (input, items) in spec.inputs.iter().zip(inputs) {
        match (&input.source, items) {
            (InputSource::Table(named), Some(items)) => {
                tables.entry(named).or_insert(items);
            }
            (InputSource::Files(pattern), Some(items)) => warnings.extend(of_files(pattern, items, taken)),
            (_, None) => {}
        }
    }
    warnings.extend(empty_keys(spec, inputs));
    let each = each(spec);
    for ((table, items), key) in tables.iter().flat_map(|of| each.iter().map(move |key| (of, key))) {
        let values = items.rows.iter().filter_map(|(cells, _)| cells.get(key));
        warnings.extend(twins(&format!("{table}: the values of `{key}`"), values));
    }
    for (input, items) in spec.inputs.iter().zip(inputs) {
        let (InputSource::Files(pattern), Some(items)) = (&input.source, items) else { continue };
        let found = || items.relations.iter().flat_map(|relation| &relation.items);
        for key in items.columns.iter().filter(|key| each.contains(key.as_str())) {
            let values = found().filter_map(|item| item.keys.get(key));
            warnings.extend(twins(&format!("`{pattern}`: the values of `{key}`"), values));
        }
    }
    for ((table, key), values) in asked(spec) {
        warnings.extend(tables.get(table).into_iter().flat_map(|items| of_table(table, key, &values, items, taken)));
    }
    warnings
}

/// The keys that stages are done for each of.
fn each(spec: &Spec) -> BTreeSet<&str> {
    fn of_stage(stage: &StageSpec) -> Vec<&str> {
        match &stage.each {
            Some((keys, _)) => keys.iter().map(String::as_str).collect(),
            None => stage.prepared.each().to_vec(),
        }
    }
    spec.stages.iter().flat_map(of_stage).collect()
}

/// Keys that rows of a table leave empty and others of it do not, where they say whose a file is.
pub(super) fn empty_keys(spec: &Spec, inputs: &[Option<InputItems>]) -> Vec<String> {
    let mut warnings = BTreeSet::new();
    let each = each(spec);
    for (input, items) in spec.inputs.iter().zip(inputs) {
        let (InputSource::Table(_), Some(items)) = (&input.source, items) else { continue };
        for relation in &items.relations {
            for key in relation.names.iter().filter(|key| each.contains(key.as_str()) || *key == SUBJECT) {
                let without = relation.items.iter().filter(|item| item.keys.get(key).is_none());
                let without: Vec<&str> = without.map(|item| item.place.as_str()).collect();
                if !without.is_empty() && without.len() < relation.items.len() {
                    warnings.insert(format!(
                        "{}: `{key}` is empty: what is there is in no group of `{key}`, and goes with every one that \
                         it is joined to; write it",
                        listed(&without)
                    ));
                }
            }
        }
    }
    warnings.into_iter().collect()
}

fn not_taken<'a>(paths: &'a [String], taken: &BTreeSet<String>) -> Vec<&'a str> {
    paths.iter().map(String::as_str).filter(|path| !taken.contains(*path)).collect()
}

fn of_files(pattern: &str, items: &InputItems, taken: &BTreeSet<String>) -> Vec<String> {
    let left_out = |paths: Vec<&str>, what: &str, remedy: &str| {
        let said = || format!("`{pattern}` leaves out {} {what}: {}; {remedy}", paths.len(), listed(&paths));
        (!paths.is_empty()).then(said)
    };
    let other_case = "file(s) whose names differ only in the case of letters";
    let other_format = "file(s) of another format, of which it takes none";
    let as_others = "write them as the others are, or name them in an input of their own";
    let unnamed = items.not_utf8.iter().map(String::as_str).collect();
    let all = [
        left_out(not_taken(&items.in_other_case, taken), other_case, "rename them, or write such a letter as [cC]"),
        left_out(not_taken(&items.in_other_format, taken), other_format, as_others),
        left_out(unnamed, "name(s) that are not UTF-8", "rename them"),
    ];
    all.into_iter().flatten().collect()
}

fn of_table(
    table: &str,
    key: &str,
    values: &BTreeSet<&str>,
    items: &InputItems,
    taken: &BTreeSet<String>,
) -> Vec<String> {
    let mut slips: BTreeMap<(&str, &str), Vec<&str>> = BTreeMap::new();
    for (cells, place) in &items.rows {
        let Some(value) = cells.get(key).filter(|value| !values.contains(value)) else { continue };
        let is_taken = taken.contains(&format!("{table}, {place}"));
        let alike = values.iter().find(|asked| say_the_same(key, asked, value));
        let near = alike.or_else(|| values.iter().find(|asked| !is_taken && is_a_letter_off(value, asked)));
        if let Some(near) = near {
            slips.entry((value, *near)).or_default().push(place);
        }
    }
    let said = |((value, near), places): ((&str, &str), Vec<&str>)| {
        format!(
            "{table}, {}: {key} = \"{value}\" is left out where a `where` asks for \"{near}\"; did you mean `{near}`?",
            listed(&places)
        )
    };
    slips.into_iter().map(said).collect()
}

/// What the filters of inputs, stages and references ask for of each table, directly or of results of its rows.
fn asked(spec: &Spec) -> Asked<'_> {
    let mut asked = Asked::new();
    let table = |input: usize| match &spec.inputs[input].source {
        InputSource::Table(named) => Some(named.as_str()),
        InputSource::Files(_) => None,
    };
    for (at, input) in spec.inputs.iter().enumerate() {
        add(&mut asked, table(at), &input.filter);
    }
    let mut tables_of: Vec<BTreeSet<&str>> = Vec::with_capacity(spec.stages.len());
    for stage in &spec.stages {
        let mut tables = BTreeSet::new();
        for reference in stage.roles.iter().flatten() {
            let from: BTreeSet<&str> = match reference.from {
                From::Input(input, _) => table(input).into_iter().collect(),
                From::Stage(before, _) => tables_of[before].clone(),
            };
            add(&mut asked, from.iter().copied(), &reference.filter);
            tables.extend(from);
        }
        add(&mut asked, tables.iter().copied(), &stage.filter);
        tables_of.push(tables);
    }
    asked
}

fn add<'a>(asked: &mut Asked<'a>, tables: impl IntoIterator<Item = &'a str>, filter: &'a Filter) {
    for table in tables {
        for (key, values, _) in filter {
            asked.entry((table, key)).or_default().extend(values.iter().map(String::as_str));
        }
    }
}

/// A value without case and spaces.
fn is_a_letter_off(value: &str, asked: &str) -> bool {
    let (value, asked) = (plain(value), plain(asked));
    let [own, other] = [&value, &asked].map(|text| text.chars().count());
    let pairs = value.chars().zip(asked.chars()).enumerate();
    let replaced: Vec<usize> = pairs.filter(|(_, (a, b))| a != b).map(|(at, _)| at).collect();
    let is_end = own == other && matches!(replaced[..], [at] if at == 0 || at + 1 == own);
    own.min(other) >= SHORTEST
        && value.chars().filter(|c| c.is_numeric()).eq(asked.chars().filter(|c| c.is_numeric()))
        && !is_end
        && strsim::osa_distance(&value, &asked) <= 1
}

/// The first few of some places, then a count.
fn listed(places: &[&str]) -> String {
    let shown = places[..places.len().min(SHOWN)].join(", ");
    if places.len() > SHOWN { format!("{shown} and {} more", places.len() - SHOWN) } else { shown }
}
