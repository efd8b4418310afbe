//! What marker files have that other TOML files have not: pairs of names.

use crate::toml_file::{Entry, Findings};
use crate::words::instead;

/// Two different names out of `known`, as indices.
pub(super) fn pair(findings: &mut Findings<'_>, entry: Entry<'_>, kind: &str, known: &[&str]) -> Option<[usize; 2]> {
    let shape = format!("two {kind}s, proximal first, such as {} = [\"a\", \"b\"]", entry.key);
    let Some(list) = entry.value.as_array() else {
        findings.fault(entry.at, format!("`{}` is no list; name {shape}", entry.key));
        return None;
    };
    let mut found = Vec::new();
    for value in list.iter() {
        let at = value.span().start;
        match value.get_ref().as_str() {
            None => findings.fault(at, format!("a {kind} of `{}` is no name; name {shape}", entry.key)),
            Some(name) => match known.iter().position(|&k| k == name) {
                None => findings
                    .fault(at, format!("`{}` names the unknown {kind} `{name}`; {}", entry.key, instead(name, known))),
                Some(index) => found.push(index),
            },
        }
    }
    if list.len() != 2 {
        findings.fault(entry.at, format!("`{}` has {} {kind}(s) and needs two; name {shape}", entry.key, list.len()));
        return None;
    }
    let pair = <[usize; 2]>::try_from(found).ok()?;
    if pair[0] == pair[1] {
        let name = known[pair[0]];
        findings.fault(entry.at, format!("`{}` names the {kind} `{name}` twice; name two different ones", entry.key));
        return None;
    }
    Some(pair)
}
