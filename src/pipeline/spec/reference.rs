//! How stages name what they work on: `INPUT`, `INPUT.COLUMN`, `STAGE`, `STAGE.PART`, and which items of it.

use toml::de::DeValue;

use super::{Filter, From, Header, InputSource, InputSpec, Place, Reference};
use crate::photograph::PICTURES;
use crate::toml_file::{Entry, Findings, entries};
use crate::video::FILMS;
use crate::words::{instead, nearest};

/// What references may name.
pub(super) struct Names<'a> {
    pub(super) inputs: &'a mut Vec<InputSpec>,
    /// Names of inputs with faults of their own, already reported.
    pub(super) faulty: &'a [&'a str],
    pub(super) stages: &'a [Header],
}

/// Texts with their places: one, or a list.
pub(super) fn strings(findings: &mut Findings<'_>, entry: Entry<'_>, of: &str) -> Option<Vec<(String, Place)>> {
    let single = entry.value.as_str().map(|text| vec![(text.to_owned(), entry.at)]);
    let list = || {
        let list = entry.value.as_array()?;
        list.iter().map(|value| Some((value.get_ref().as_str()?.to_owned(), value.span().start))).collect()
    };
    let strings = single.or_else(list);
    if strings.is_none() {
        findings.fault(entry.at, format!("`{}` has to be {of}", entry.key));
    }
    strings
}

/// `where = { kind = "bending", session = [1, 2] }`.
pub(super) fn filter(findings: &mut Findings<'_>, entry: Entry<'_>) -> Filter {
    let DeValue::Table(table) = entry.value else {
        findings
            .fault(entry.at, "`where` has to be keys and their values, as { kind = \"bending\", session = [1, 2] }");
        return Vec::new();
    };
    let mut filter = Vec::new();
    for Entry { key, key_at, value, at } in entries(table) {
        let values: Option<Vec<String>> = match value {
            DeValue::Array(list) => list.iter().map(|value| cell(value.get_ref())).collect(),
            one => cell(one).map(|value| vec![value]),
        };
        match values {
            Some(values) if !values.is_empty() => filter.push((key.to_owned(), values, key_at)),
            _ => {
                let what = format!("`{key}` of `where` has to be a value or a list of values: texts or whole numbers");
                findings.fault(at, what);
            }
        }
    }
    filter
}

/// A value as a cell of a table says it.
fn cell(value: &DeValue<'_>) -> Option<String> {
    match value {
        DeValue::String(text) => Some(text.to_string()),
        DeValue::Integer(whole) => {
            i64::from_str_radix(whole.as_str(), whole.radix()).ok().map(|whole| whole.to_string())
        }
        DeValue::Float(number) => Some(number.as_str().to_owned()),
        DeValue::Boolean(truth) => Some(truth.to_string()),
        _ => None,
    }
}

/// One reference: a text, or `{ from = "..", where = {..} }`.
pub(super) fn reference(
    findings: &mut Findings<'_>,
    role: &str,
    value: &DeValue<'_>,
    at: Place,
    names: &mut Names<'_>,
) -> Option<Reference> {
    let (said, said_at, filter) = match value {
        DeValue::String(text) => (text.to_string(), at, Vec::new()),
        DeValue::Table(table) => {
            let table = entries(table);
            findings.unknown_keys(&table, &["from", "where"], "key of a reference");
            let filter = table.iter().find(|e| e.key == "where").map(|e| filter(findings, *e)).unwrap_or_default();
            let from = table.iter().find(|e| e.key == "from");
            let Some((from, text)) = from.and_then(|from| Some((from, from.value.as_str()?))) else {
                let what = format!("`{role}` lacks `from`; write {{ from = \"INPUT.COLUMN\", where = {{ .. }} }}");
                findings.fault(from.map_or(at, |from| from.at), what);
                return None;
            };
            (text.to_owned(), from.at, filter)
        }
        other => {
            let what = format!(
                "`{role}` is {}; name an input or a stage: \"INPUT.COLUMN\", \"STAGE\", \"STAGE.PART\"",
                other.type_str()
            );
            findings.fault(at, what);
            return None;
        }
    };
    let from = resolve(findings, role, &said, said_at, names)?;
    Some(Reference { from, filter, at: said_at, said })
}

fn resolve(findings: &mut Findings<'_>, role: &str, said: &str, at: Place, names: &mut Names<'_>) -> Option<From> {
    let (name, part) = said.split_once('.').map_or((said, None), |(name, part)| (name, Some(part)));
    if let Some(input) = names.inputs.iter().position(|input| input.name == name) {
        let columns = &mut names.inputs[input];
        return match (&columns.source, part) {
            (InputSource::Files(_), None) => Some(From::Input(input, None)),
            (InputSource::Files(_), Some(_)) => {
                findings.fault(at, format!("`{name}` are files and have no columns; write \"{name}\""));
                None
            }
            (InputSource::Table(_), None) => {
                let what = format!("`{name}` is a table; say which column holds the files: \"{name}.COLUMN\"");
                findings.fault(at, what);
                None
            }
            (InputSource::Table(_), Some(column)) => {
                let known = columns.columns.iter().position(|(known, _)| known == column);
                let known = known.unwrap_or_else(|| {
                    columns.columns.push((column.to_owned(), at));
                    columns.columns.len() - 1
                });
                Some(From::Input(input, Some(known)))
            }
        };
    }
    if let Some(stage) = names.stages.iter().position(|stage| stage.name == name) {
        let kind = names.stages[stage].kind?;
        let Some(part) = part else { return Some(From::Stage(stage, (!kind.parts.is_empty()).then_some(0))) };
        let known = kind.parts.iter().position(|known| known.name == part);
        if known.is_none() {
            let parts: Vec<&str> = kind.parts.iter().map(|part| part.name).collect();
            findings.fault(at, format!("the job `{}` makes no `{part}`; {}", kind.name, instead(part, &parts)));
        }
        return Some(From::Stage(stage, Some(known?)));
    }
    if names.faulty.contains(&name) {
        return None;
    }
    let known: Vec<&str> = names
        .inputs
        .iter()
        .map(|input| input.name.as_str())
        .chain(names.stages.iter().map(|s| s.name.as_str()))
        .collect();
    let what = match file_input(said, &known) {
        Some(input) if nearest(name, &known).is_none() => {
            let files = toml::Value::from(said);
            format!(
                "`{said}` is a file's name, and `{role}` names an input or a stage; write [inputs.{input}] with \
                 files = {files}, and {role} = \"{input}\" here"
            )
        }
        _ => format!("`{name}` is neither an input nor a stage; {}", instead(name, &known)),
    };
    findings.fault(at, what);
    None
}

/// Endings of files that roles are given.
const ENDINGS: [&str; 9] = ["csv", "parquet", "gz", "xdf", "toml", "json", "npy", "npz", "html"];

/// What to call the input of a file that is named in place of an input; none where it is no file's name.
fn file_input(said: &str, known: &[&str]) -> Option<String> {
    let (folder, file) = said.rsplit_once('/').map_or(("", said), |(folder, file)| (folder, file));
    let ending = file.rsplit_once('.').map_or(String::new(), |(_, ending)| ending.to_lowercase());
    let is_known = [&ENDINGS[..], &PICTURES, &FILMS].concat().contains(&ending.as_str());
    if !is_known && !said.contains('/') {
        return None;
    }
    let stem = file.split('.').next().unwrap_or_default();
    let places = |c: char| c == '{' || c == '}';
    let above = || folder.rsplit('/').find(|part| !part.contains(places)).unwrap_or_default();
    let stem = if stem.contains(places) { above() } else { stem };
    let name: String = stem.chars().filter(|c| c.is_alphanumeric() || *c == '_' || *c == '-').collect();
    Some(match name.as_str() {
        "" => "files".to_owned(),
        name if known.contains(&name) => format!("{name}_files"),
        name => name.to_owned(),
    })
}
