//! The stages of a pipeline file: their job, what its roles are given, and options that the job accepts.

use std::collections::BTreeSet;

use toml::de::DeValue;

use super::reference::{Names, filter, reference, strings};
use super::{Header, Reference, StageSpec};
use crate::job::{Kind, Role, Takes};
use crate::pipeline::spec::said::in_keys;
use crate::toml_file::{Entry, Findings};
use crate::words::instead;

/// Keys of every stage.
const OWN: [&str; 3] = ["job", "each", "where"];

/// The names and jobs of all stages.
pub(super) fn headers(
    findings: &mut Findings<'_>,
    tables: &[(Entry<'_>, Vec<Entry<'_>>)],
    kinds: &[&'static Kind],
) -> Vec<Header> {
    let known: Vec<&str> = kinds.iter().map(|kind| kind.name).collect();
    tables
        .iter()
        .map(|(entry, table)| {
            let job = table.iter().find(|e| e.key == "job");
            let named = job.and_then(|job| job.value.as_str());
            let kind = named.and_then(|named| kinds.iter().find(|kind| kind.name == named).copied());
            if kind.is_none() {
                let (at, what) = match (job, named) {
                    (None, _) => {
                        (entry.key_at, format!("the stage `{}` has no `job`; known: {}", entry.key, known.join(", ")))
                    }
                    (Some(job), None) => (job.at, format!("`job` has to be a job's name; known: {}", known.join(", "))),
                    (Some(job), Some(named)) => (job.at, format!("no job `{named}`; {}", instead(named, &known))),
                };
                findings.fault(at, what);
            }
            Header { name: entry.key.to_owned(), at: entry.key_at, kind }
        })
        .collect()
}

/// One stage, checked; none with faults.
pub(super) fn stage(
    findings: &mut Findings<'_>,
    entry: Entry<'_>,
    table: &[Entry<'_>],
    header: &Header,
    names: &mut Names<'_>,
    values: &toml::Table,
) -> Option<StageSpec> {
    let kind = header.kind?;
    let role_names: Vec<&str> = kind.roles.iter().map(|role| role.name).collect();
    let keys = (kind.keys)();
    let known = role_names.iter().copied().chain(keys.iter().map(String::as_str)).chain(OWN);
    let known: Vec<&str> = known.collect();
    findings.unknown_keys(table, &known, &format!("key of the job `{}`:", kind.name));
    let roles: Vec<Vec<Reference>> =
        kind.roles.iter().map(|role| given(findings, entry, table, kind, role, names)).collect();
    let each = table.iter().find(|e| e.key == "each").and_then(|each| {
        let keys = strings(findings, *each, "keys' names, as [\"subject\"]")?;
        let mut earlier = BTreeSet::new();
        for (key, at) in &keys {
            if !earlier.insert(key) {
                findings.fault(*at, format!("`each` names `{key}` twice"));
            }
        }
        Some((keys.into_iter().map(|(key, _)| key).collect(), each.at))
    });
    let filter = table.iter().find(|e| e.key == "where").map(|e| filter(findings, *e)).unwrap_or_default();

    let stage = values.get("stage").and_then(|stages| stages.get(entry.key)).and_then(toml::Value::as_table);
    let mut options = stage.cloned().unwrap_or_default();
    // Keys that are not the job's have been reported.
    options.retain(|key, _| keys.iter().any(|known| known == key) && !role_names.contains(&key));
    let prepared = match (kind.prepare)(&options) {
        Ok(prepared) => prepared,
        Err(fault) => {
            let at = table.iter().find(|e| e.key == fault.key).map_or(entry.key_at, |e| e.at);
            findings.fault(at, named(&fault.key, in_keys(&fault.what)));
            return None;
        }
    };
    Some(StageSpec { name: entry.key.to_owned(), at: entry.key_at, kind, each, filter, roles, prepared })
}

/// What is wrong with an option, with its name.
fn named(option: &str, what: String) -> String {
    if option.is_empty() || what.contains(&format!("`{option}`")) {
        what
    } else if what.starts_with("is ") {
        format!("`{option}` {what}")
    } else {
        format!("`{option}`: {what}")
    }
}

/// What a role is given: as many as it takes.
fn given(
    findings: &mut Findings<'_>,
    stage: Entry<'_>,
    table: &[Entry<'_>],
    kind: &Kind,
    role: &Role,
    names: &mut Names<'_>,
) -> Vec<Reference> {
    let Some(entry) = table.iter().find(|e| e.key == role.name) else {
        if matches!(role.takes, Takes::One | Takes::Many) {
            let what = format!(
                "the stage `{}` (job `{}`) lacks `{}`: {}; name an input or a stage",
                stage.key, kind.name, role.name, role.about
            );
            findings.fault(stage.key_at, what);
        }
        return Vec::new();
    };
    let DeValue::Array(list) = entry.value else {
        return reference(findings, role.name, entry.value, entry.at, names).into_iter().collect();
    };
    if matches!(role.takes, Takes::One | Takes::Optional) {
        let what = format!("`{}` takes one file of each item; name one input or stage, no list", role.name);
        findings.fault(entry.at, what);
        return Vec::new();
    }
    if list.is_empty() && role.takes == Takes::Many {
        findings.fault(entry.at, format!("`{}` is empty; name an input or a stage: {}", role.name, role.about));
    }
    let mut references: Vec<Reference> = Vec::new();
    for value in list.iter() {
        let at = value.span().start;
        let Some(found) = reference(findings, role.name, value.get_ref(), at, names) else { continue };
        if references.iter().any(|earlier| earlier.from == found.from && same(&earlier.filter, &found.filter)) {
            findings.fault(at, format!("`{}` names `{}` twice; name it once", role.name, found.said));
        }
        references.push(found);
    }
    references
}

/// Whether two filters say the same, wherever they stand.
fn same(one: &super::Filter, other: &super::Filter) -> bool {
    one.len() == other.len() && one.iter().zip(other).all(|(a, b)| (&a.0, &a.1) == (&b.0, &b.1))
}

#[cfg(test)]
mod tests {
    use super::named;

    #[test]
    fn a_fault_of_an_option_names_it_once() {
        assert_eq!(named("size", "is `big`; write a number".into()), "`size` is `big`; write a number");
        assert_eq!(named("sync", "`x`: choose clock".into()), "`sync`: `x`: choose clock");
        assert_eq!(named("joints", "`joints` has to be text".into()), "`joints` has to be text");
        assert_eq!(named("", "nothing is given".into()), "nothing is given");
    }
}
