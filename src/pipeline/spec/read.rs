//! From a pipeline file's tables to a checked [`Spec`], or to all of its faults.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use toml::de::DeValue;

use super::reference::{Names, filter, strings};
use super::{Generated, Header, InputSource, InputSpec, Place, Spec, Wanted, cycle, stages};
use crate::job::Kind;
use crate::toml_file::{Entry, Fault, Findings, entries};
use crate::words::instead;

const TOP: [&str; 6] = ["name", "about", "wanted", "phantom", "inputs", "stage"];
const INPUT: [&str; 4] = ["table", "files", "where", "keys"];

pub(super) fn spec(text: &str, path: &Path, kinds: &[&'static Kind]) -> Result<Spec, Vec<Fault>> {
    let mut findings = Findings::new(text);
    let Some(document) = findings.parse() else {
        return Err(findings.finish().err().unwrap_or_default());
    };
    let top = entries(document.get_ref());
    // Doubled keys have been reported already; without them the values are those of the entries.
    let values: toml::Table = text.parse().unwrap_or_default();
    findings.unknown_keys(&top, &TOP, "key");
    let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let name = words(&mut findings, &top, "name").unwrap_or(stem);
    let about = words(&mut findings, &top, "about").unwrap_or_default();
    let phantom = generated(&mut findings, &top, &values);

    let input_tables = named_tables(&mut findings, &top, "inputs");
    let mut inputs: Vec<InputSpec> =
        input_tables.iter().filter_map(|(entry, table)| input(&mut findings, *entry, table)).collect();
    let stage_tables = named_tables(&mut findings, &top, "stage");
    if stage_tables.is_empty() && !top.iter().any(|e| e.key == "stage" && !e.value.is_table()) {
        findings.fault(0, "no stages; write [stage.NAME] with its job and what it works on");
    }
    for (entry, _) in &stage_tables {
        check_stage_name(&mut findings, *entry, &input_tables);
    }
    let headers = stages::headers(&mut findings, &stage_tables, kinds);
    let sound: BTreeSet<&str> = inputs.iter().map(|input| input.name.as_str()).collect();
    let faulty: Vec<&str> =
        input_tables.iter().map(|(entry, _)| entry.key).filter(|name| !sound.contains(name)).collect();
    let mut names = Names { inputs: &mut inputs, faulty: &faulty, stages: &headers };
    let read: Vec<_> = stage_tables
        .iter()
        .zip(&headers)
        .map(|((entry, table), header)| stages::stage(&mut findings, *entry, table, header, &mut names, &values))
        .collect();
    let wanted = wanted(&mut findings, &top, &headers, &names, &read);
    cycle::find(&mut findings, &headers, &read);
    if !findings.is_empty() {
        return Err(findings.finish().err().unwrap_or_default());
    }
    let (stages, place_of) = cycle::in_order(read.into_iter().flatten().collect());
    let wanted = wanted.into_iter().map(|wanted| Wanted { stage: place_of[wanted.stage], ..wanted }).collect();
    Ok(Spec { path: path.to_owned(), text: text.to_owned(), name, about, wanted, phantom, inputs, stages })
}

/// A text of the file's top; none where it is not given.
fn words(findings: &mut Findings<'_>, top: &[Entry<'_>], key: &str) -> Option<String> {
    let entry = top.iter().find(|e| e.key == key)?;
    let words = entry.value.as_str().map(str::to_owned);
    if words.is_none() {
        findings.fault(entry.at, format!("`{key}` has to be text"));
    }
    words
}

/// The tables of the table `key`, by name.
fn named_tables<'a>(findings: &mut Findings<'_>, top: &[Entry<'a>], key: &str) -> Vec<(Entry<'a>, Vec<Entry<'a>>)> {
    let mut tables = Vec::new();
    for entry in findings.table(top, key).unwrap_or_default() {
        match entry.value {
            DeValue::Table(table) => tables.push((entry, entries(table))),
            other => {
                let what = format!(
                    "`{}` is no table but {}; write [{key}.NAME] and its lines below",
                    entry.key,
                    other.type_str()
                );
                findings.fault(entry.key_at, what);
            }
        }
    }
    tables
}

fn generated(findings: &mut Findings<'_>, top: &[Entry<'_>], values: &toml::Table) -> Option<Generated> {
    let entry = top.iter().find(|e| e.key == "phantom")?;
    let table = findings.table(top, "phantom")?;
    let options = values.get("phantom").and_then(toml::Value::as_table).cloned().unwrap_or_default();
    let mut keys: BTreeMap<String, Place> = BTreeMap::new();
    for outer in &table {
        keys.insert(outer.key.to_owned(), outer.key_at);
        if let DeValue::Table(block) = outer.value {
            keys.extend(entries(block).iter().map(|inner| (format!("{}.{}", outer.key, inner.key), inner.key_at)));
        }
    }
    Some(Generated { options, keys, at: entry.key_at })
}

fn input(findings: &mut Findings<'_>, entry: Entry<'_>, table: &[Entry<'_>]) -> Option<InputSpec> {
    check_name(findings, entry, "input");
    findings.unknown_keys(table, &INPUT, "key of an input");
    let of = |key: &str| table.iter().find(|e| e.key == key);
    let text = |findings: &mut Findings<'_>, entry: &Entry<'_>| {
        let text = entry.value.as_str().filter(|text| !text.trim().is_empty()).map(str::to_owned);
        if text.is_none() {
            findings.fault(entry.at, format!("`{}` has to be text: a path", entry.key));
        }
        text
    };
    let (source, source_at) = match (of("table"), of("files")) {
        (Some(table), None) => (InputSource::Table(text(findings, table)?), table.at),
        (None, Some(files)) => (InputSource::Files(text(findings, files)?), files.at),
        (Some(_), Some(files)) => {
            findings.fault(files.key_at, format!("`{}` has both `table` and `files`; name one", entry.key));
            return None;
        }
        (None, None) => {
            let what = format!(
                "the input `{}` has neither `table` nor `files`; write table = \"sessions.csv\" or files = \
                 \"photos/{{pose}}/{{subject}}.png\"",
                entry.key
            );
            findings.fault(entry.key_at, what);
            return None;
        }
    };
    let keys = of("keys").and_then(|keys| {
        if matches!(source, InputSource::Files(_)) {
            let what = "`keys` are of tables; the keys of `files` are its places in braces";
            findings.fault(keys.key_at, what);
        }
        strings(findings, *keys, "columns' names")
    });
    let filter = of("where").map(|entry| filter(findings, *entry)).unwrap_or_default();
    let name = entry.key.to_owned();
    Some(InputSpec { name, source, source_at, keys, filter, columns: Vec::new() })
}

/// Names stand in references before a dot, and stages' names are folders.
fn check_name(findings: &mut Findings<'_>, entry: Entry<'_>, what: &str) {
    let sound = |c: char| c.is_alphanumeric() || c == '_' || c == '-';
    if entry.key.is_empty() || !entry.key.chars().all(sound) {
        let name = entry.key.escape_debug();
        findings.fault(entry.key_at, format!("`{name}` can't name a {what}; use letters, digits, _ and -"));
    }
}

fn check_stage_name(findings: &mut Findings<'_>, entry: Entry<'_>, inputs: &[(Entry<'_>, Vec<Entry<'_>>)]) {
    check_name(findings, entry, "stage");
    if entry.key == "phantom" {
        let what =
            "a stage can't be called `phantom`: the generated recordings go into that folder; choose another name";
        findings.fault(entry.key_at, what);
    }
    if let Some((input, _)) = inputs.iter().find(|(input, _)| input.key == entry.key) {
        let line = findings.line(input.key_at);
        let what = format!("`{}` is an input already (line {line}); give the stage another name", entry.key);
        findings.fault(entry.key_at, what);
    }
}

/// The wanted results; without the key, the stages that no other works on.
fn wanted(
    findings: &mut Findings<'_>,
    top: &[Entry<'_>],
    headers: &[Header],
    names: &Names<'_>,
    read: &[Option<super::StageSpec>],
) -> Vec<Wanted> {
    let Some(entry) = top.iter().find(|e| e.key == "wanted") else {
        let used = |stage: usize| read.iter().flatten().any(|s| cycle::works_on(s).any(|at| at == stage));
        let last = (0..headers.len()).filter(|stage| !used(*stage));
        return last.map(|stage| Wanted { stage, part: None, at: headers[stage].at }).collect();
    };
    let listed = strings(findings, *entry, "stages' names, as [\"sets\", \"angles.tracks\"]").unwrap_or_default();
    if listed.is_empty() && entry.value.as_array().is_some_and(|list| list.is_empty()) {
        findings.fault(entry.at, "nothing is wanted; name stages, or leave `wanted` out");
    }
    let mut wanted = Vec::new();
    for (name, at) in listed {
        if findings.is_full() {
            findings.fault(at, "");
            continue;
        }
        let (stage_name, part_name) = name.split_once('.').map_or((name.as_str(), None), |(s, p)| (s, Some(p)));
        let Some(stage) = headers.iter().position(|header| header.name == stage_name) else {
            let what = if names.inputs.iter().any(|input| input.name == stage_name) {
                format!("`{stage_name}` is an input, which is there already; wanted are stages")
            } else {
                let known: Vec<&str> = headers.iter().map(|header| header.name.as_str()).collect();
                format!("`{name}` is wanted, and no stage makes it; {}", instead(stage_name, &known))
            };
            findings.fault(at, what);
            continue;
        };
        let Some(kind) = headers[stage].kind else { continue };
        let part = part_name.map(|part_name| (part_name, kind.parts.iter().find(|part| part.name == part_name)));
        if let Some((part_name, None)) = part {
            let known: Vec<&str> = kind.parts.iter().map(|part| part.name).collect();
            let what = format!(
                "`{name}` is wanted, and the job `{}` makes no `{part_name}`; {}",
                kind.name,
                instead(part_name, &known)
            );
            findings.fault(at, what);
            continue;
        }
        wanted.push(Wanted { stage, part: part.and_then(|(_, part)| part), at });
    }
    wanted
}
