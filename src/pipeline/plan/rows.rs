//! The tasks of a stage, as combinations of items: one for each joined row, or for each value of the keys that are
//! gathered by.

use std::collections::{BTreeMap, BTreeSet};

use crate::job::{Keys, Takes};
use crate::pipeline::items::{Index, Item, JoinedRows, Missing, Relation, Unjoined, join, leaves_out};
use crate::pipeline::spec::{From, Reference, Spec, StageSpec};
use crate::toml_file::Fault;
use crate::words::{grouped, instead};

/// A task to be: its keys, and for each role the items it takes, by position.
pub(super) struct Row {
    pub(super) keys: Keys,
    pub(super) items: Vec<Vec<usize>>,
}

/// A stage's tasks to be.
pub(super) struct StageRows {
    /// The keys' names in order.
    pub(super) names: Vec<String>,
    pub(super) rows: Vec<Row>,
    pub(super) left_out: Vec<Missing>,
}

/// Combines what each role of a stage is given.
pub(super) fn stage_rows(spec: &Spec, stage: &StageSpec, given: &[Relation]) -> Result<StageRows, Vec<Fault>> {
    let takes = |role: usize| stage.kind.roles[role].takes;
    let named = |role: &usize| !stage.roles[*role].is_empty();
    let roles = 0..stage.kind.roles.len();
    let mut single: Vec<usize> = roles.clone().filter(|&role| takes(role) == Takes::One).collect();
    let mut optional: Vec<usize> = roles.clone().filter(|&role| takes(role) == Takes::Optional).filter(named).collect();
    let many: Vec<usize> =
        roles.filter(|&role| matches!(takes(role), Takes::Many | Takes::AnyNumber)).filter(named).collect();
    // A job that needs no input is done for each that it is given.
    if single.is_empty() && many.is_empty() {
        std::mem::swap(&mut single, &mut optional);
    }
    let each = each(spec, stage, given).map_err(|fault| vec![fault])?;

    let mut left_out = lacking_files(spec, stage, given);
    let relations: Vec<&Relation> = single.iter().map(|&role| &given[role]).collect();
    let mut joined =
        join(&relations).map_err(|(one, other)| vec![unrelated(spec, stage, given, single[one], single[other])])?;
    for unjoined in &mut joined.unjoined {
        unjoined.keys.retain(|keys| !is_left_by_choice(spec, stage, keys));
        if !unjoined.keys.is_empty() {
            left_out.push(alone(stage, unjoined, &single));
        }
    }
    if single.is_empty() && many.is_empty() {
        joined.rows = vec![(Keys::default(), Vec::new())];
    } else if single.is_empty() {
        joined = groups(each.as_deref().unwrap_or_default(), &many, given, &mut left_out);
    }
    let mut rows = Vec::with_capacity(joined.rows.len());
    let mut faults = Vec::new();
    let mut lacking: BTreeMap<usize, usize> = BTreeMap::new();
    let names = if single.is_empty() { each.clone().unwrap_or_default() } else { joined.names.clone() };
    let searched: Vec<(usize, Index<'_>)> =
        optional.iter().chain(&many).map(|&role| (role, Index::new(&given[role], &names))).collect();
    for (keys, picks) in &joined.rows {
        let mut items = vec![Vec::new(); stage.kind.roles.len()];
        for (&role, &pick) in single.iter().zip(picks) {
            items[role] = vec![pick];
        }
        for (role, index) in &searched {
            items[*role] = index.find(keys);
            // Of what is gathered by keys, items that do not say all of them are in no group.
            if single.is_empty() && keys.0.iter().all(|(key, _)| given[*role].names.contains(key)) {
                items[*role].retain(|&at| keys.0.iter().all(|(key, _)| given[*role].items[at].keys.get(key).is_some()));
            }
        }
        if let Some(&role) = optional.iter().find(|&&role| items[role].len() > 1) {
            let places: Vec<&str> = items[role].iter().map(|&at| given[role].items[at].place.as_str()).collect();
            let what = format!(
                "`{}` of `{}` takes one file, and for {} there are {}: {}; choose with `where`, or name more keys",
                stage.kind.roles[role].name,
                stage.name,
                said(keys),
                places.len(),
                places[..places.len().min(4)].join(", ")
            );
            faults.push(spec.fault(stage.roles[role][0].at, what));
            break;
        }
        if let Some(&role) = many.iter().find(|&&role| takes(role) == Takes::Many && items[role].is_empty()) {
            *lacking.entry(role).or_default() += 1;
            continue;
        }
        if let Some(fault) = twice(spec, stage, given, &many, &items) {
            faults.push(fault);
            break;
        }
        let keys = each.as_ref().map_or_else(|| keys.clone(), |each| keys.only(each.iter().map(String::as_str)));
        rows.push(Row { keys, items });
    }
    for (role, count) in lacking {
        left_out.push(Missing { reason: format!("no `{}` for it", stage.kind.roles[role].name), count });
    }
    let names = each.unwrap_or(names);
    if faults.is_empty() { Ok(StageRows { names, rows, left_out }) } else { Err(faults) }
}

/// The rows that name no file for a stage, counted by reason, without those that a `where` leaves out.
fn lacking_files(spec: &Spec, stage: &StageSpec, given: &[Relation]) -> Vec<Missing> {
    let rows = given.iter().flat_map(|relation| &relation.lacking);
    let rows = rows.filter(|row| !is_left_by_choice(spec, stage, &row.keys));
    let missing = |(reason, rows): (&String, Vec<_>)| Missing { reason: reason.clone(), count: rows.len() };
    grouped(rows.map(|row| (&row.reason, row))).into_iter().map(missing).collect()
}

/// Whether what has these keys is meant to be in no task of a stage: a `where` of what each task needs leaves it out,
/// here or in the stages before.
fn is_left_by_choice(spec: &Spec, stage: &StageSpec, keys: &Keys) -> bool {
    let is_left = |reference: &Reference| {
        let before = match reference.from {
            From::Input(input, _) => leaves_out(&spec.inputs[input].filter, keys),
            From::Stage(before, _) => {
                let before = &spec.stages[before];
                // Results of what is gathered are of all that have these keys.
                let own = gathered_by(before).map(|names| keys.only(names));
                is_left_by_choice(spec, before, own.as_ref().unwrap_or(keys))
            }
        };
        before || leaves_out(&reference.filter, keys)
    };
    let is_needed = |role: usize| matches!(stage.kind.roles[role].takes, Takes::One | Takes::Many);
    let mut needed = stage.roles.iter().enumerate().filter(|(role, _)| is_needed(*role)).map(|(_, named)| named);
    leaves_out(&stage.filter, keys) || needed.any(|named| !named.is_empty() && named.iter().all(is_left))
}

/// The keys that a stage is done for each of, where it says them or its job gathers by them.
fn gathered_by(stage: &StageSpec) -> Option<Vec<&str>> {
    let own = || if gathers(stage) { Some(stage.prepared.each().to_vec()) } else { None };
    stage.each.as_ref().map(|(each, _)| each.iter().map(String::as_str).collect()).or_else(own)
}

/// Whether a stage's job works on what it gathers alone.
fn gathers(stage: &StageSpec) -> bool {
    let some = |takes: Takes| stage.kind.roles.iter().any(|role| role.takes == takes);
    !some(Takes::One) && (some(Takes::Many) || some(Takes::AnyNumber))
}

/// The keys that a stage is done for each of: as it says, or as its job does.
fn each(spec: &Spec, stage: &StageSpec, given: &[Relation]) -> Result<Option<Vec<String>>, Fault> {
    let mut known: Vec<&str> = given.iter().flat_map(|relation| &relation.names).map(String::as_str).collect();
    known.sort_unstable();
    known.dedup();
    if let Some((each, at)) = &stage.each {
        if let Some(unknown) = each.iter().find(|key| !known.contains(&key.as_str())) {
            let what = format!(
                "`each` names `{unknown}`, which nothing that `{}` works on has; {}",
                stage.name,
                instead(unknown, &known)
            );
            return Err(spec.fault(*at, what));
        }
        return Ok(Some(each.clone()));
    }
    let own = stage.prepared.each().iter().filter(|key| known.contains(key)).map(|key| (*key).to_owned()).collect();
    Ok(gathers(stage).then_some(own))
}

/// For a job that only gathers: every combination of the keys' values that some item has.
fn groups(each: &[String], many: &[usize], given: &[Relation], left_out: &mut Vec<Missing>) -> JoinedRows {
    let mut groups: BTreeSet<Vec<&str>> = BTreeSet::new();
    let mut in_order: Vec<Vec<&str>> = Vec::new();
    for &role in many.iter().filter(|&&role| each.iter().all(|key| given[role].names.contains(key))) {
        let mut without = 0;
        for item in &given[role].items {
            match each.iter().map(|key| item.keys.get(key)).collect::<Option<Vec<&str>>>() {
                Some(values) if groups.insert(values.clone()) => in_order.push(values),
                Some(_) => {}
                None => without += 1,
            }
        }
        if without > 0 {
            left_out.push(Missing { reason: format!("it does not say all of: {}", each.join(", ")), count: without });
        }
    }
    let keys = |values: &Vec<&str>| Keys(each.iter().cloned().zip(values.iter().map(|v| (*v).to_owned())).collect());
    JoinedRows { rows: in_order.iter().map(|values| (keys(values), Vec::new())).collect(), ..JoinedRows::default() }
}

/// A file that one role of a task is given twice.
fn twice(spec: &Spec, stage: &StageSpec, given: &[Relation], many: &[usize], items: &[Vec<usize>]) -> Option<Fault> {
    for &role in many.iter().filter(|&&role| stage.roles[role].len() > 1) {
        let mut seen: Vec<&Item> = Vec::new();
        for item in items[role].iter().map(|&at| &given[role].items[at]) {
            if seen.iter().any(|earlier| earlier.origin == item.origin) {
                let what =
                    format!("`{}` is given {} twice; choose with `where`", stage.kind.roles[role].name, item.place);
                return Some(spec.fault(stage.roles[role][0].at, what));
            }
            seen.push(item);
        }
    }
    None
}

fn unrelated(spec: &Spec, stage: &StageSpec, given: &[Relation], one: usize, other: usize) -> Fault {
    let name = |role: usize| stage.kind.roles[role].name;
    let what = format!(
        "`{}` ({}) and `{}` ({}) have no key in common, so none of them belong together; name the same keys in both \
         inputs",
        name(one),
        given[one].names.join(", "),
        name(other),
        given[other].names.join(", ")
    );
    spec.fault(stage.roles[other].first().map_or(stage.at, |reference| reference.at), what)
}

/// How items without a partner are reported: `log: no joints of subject=S07`.
fn alone(stage: &StageSpec, unjoined: &Unjoined, single: &[usize]) -> Missing {
    let name = |at: usize| stage.kind.roles[single[at]].name;
    let shown: Vec<String> = unjoined.keys.iter().take(3).map(said).collect();
    let more = if unjoined.keys.len() > 3 { ", .." } else { "" };
    let reason = format!("its `{}` has no `{}`: {}{more}", name(unjoined.of), name(unjoined.lacks), shown.join(", "));
    Missing { reason, count: unjoined.keys.len() }
}

fn said(keys: &Keys) -> String {
    if keys.0.is_empty() { "all".to_owned() } else { keys.to_string() }
}
