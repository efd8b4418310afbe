//! Forwards: from inputs to the tasks of every stage that some wanted result may need.

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::fmt::Write as _;
use std::path::Path;

use super::ids::task_id;
use super::rows::{Row, stage_rows};
use super::slips::{empty_keys, slips};
use super::{Layout, Node, NodeInput, NodeSource};
use crate::job::{Facts, Takes};
use crate::pipeline::items::{
    InputItems, Item, Missing, Origin, Relation, World, check_filter, input_items, leaves_out, plain,
};
use crate::pipeline::spec::{From, Reference, Spec, StageSpec};
use crate::toml_file::Fault;

/// How many clashes of a stage are reported.
const TOLD: usize = 5;

/// Lays out all stages that wanted ones stand on.
///
/// # Errors
/// All faults that inputs show.
pub(super) fn lay_out<'a>(spec: &Spec, world: &World<'a>) -> Result<Layout<'a>, Vec<Fault>> {
    let needed = needed_stages(spec);
    let mut faults = Vec::new();
    let inputs = inputs(spec, &needed, world, &mut faults);
    let mut layout = Layout {
        nodes: generated_nodes(world),
        of_stage: vec![None; spec.stages.len()],
        left_out: vec![Vec::new(); spec.stages.len()],
        catalogue: world.catalogue,
        warnings: Vec::new(),
        taken: BTreeSet::new(),
    };
    let mut results: BTreeMap<usize, Vec<String>> = BTreeMap::new();
    for (at, stage) in spec.stages.iter().enumerate().filter(|(at, _)| needed[*at]) {
        let start = layout.nodes.len();
        layout.of_stage[at] = Some(start..start);
        // Where an input could not be looked at, nothing can be said of what stands on it.
        let broken = |from: &From| match from {
            From::Input(input, _) => inputs[*input].is_none(),
            From::Stage(stage, _) => !results.contains_key(stage),
        };
        if stage.roles.iter().flatten().any(|reference| broken(&reference.from)) {
            continue;
        }
        match lay_out_stage(spec, (at, stage), &inputs, &results, &mut layout, world) {
            Ok((names, missing)) => {
                layout.of_stage[at] = Some(start..layout.nodes.len());
                layout.left_out[at] = missing;
                results.insert(at, names);
            }
            Err(more) => faults.extend(more),
        }
    }
    let before = faults.len();
    clashes(spec, &layout, &mut faults);
    if let Some(clash) = faults.get_mut(before)
        && let Some(empty) = empty_keys(spec, &inputs).first()
    {
        let _ = write!(clash.what, ". {empty}");
    }
    if faults.is_empty() {
        nothing_to_do(spec, &layout, &mut faults);
    }
    if faults.is_empty() {
        layout.warnings.extend(slips(spec, &inputs, &layout.taken));
        return Ok(layout);
    }
    faults.sort_by_key(|fault| (fault.line, fault.column));
    faults.dedup();
    Err(faults)
}

/// Which stages wanted ones stand on, and these themselves.
fn needed_stages(spec: &Spec) -> Vec<bool> {
    let mut needed = vec![false; spec.stages.len()];
    spec.wanted.iter().for_each(|wanted| needed[wanted.stage] = true);
    for at in (0..spec.stages.len()).rev().filter(|at| needed[*at]).collect::<Vec<_>>() {
        mark(spec, at, &mut needed);
    }
    needed
}

fn mark(spec: &Spec, at: usize, needed: &mut [bool]) {
    needed[at] = true;
    for reference in spec.stages[at].roles.iter().flatten() {
        if let From::Stage(before, _) = reference.from {
            mark(spec, before, needed);
        }
    }
}

/// The inputs that needed stages name.
fn inputs(spec: &Spec, needed: &[bool], world: &World<'_>, faults: &mut Vec<Fault>) -> Vec<Option<InputItems>> {
    let named = |input: usize| {
        let stages = spec.stages.iter().zip(needed).filter(|(_, needed)| **needed).map(|(stage, _)| stage);
        stages
            .flat_map(|stage| stage.roles.iter().flatten())
            .any(|r| matches!(r.from, From::Input(at, _) if at == input))
    };
    let look = |(at, input)| {
        if !named(at) {
            return None;
        }
        input_items(spec, input, world).map_err(|more| faults.extend(more)).ok()
    };
    spec.inputs.iter().enumerate().map(look).collect()
}

fn generated_nodes(world: &World<'_>) -> Vec<Node> {
    let tasks = world.catalogue.into_iter().flat_map(|catalogue| &catalogue.tasks);
    let node = |task: &crate::pipeline::items::catalogue::CatalogueTask| Node {
        id: format!("phantom/{}", task.name),
        stage: None,
        keys: task.keys.clone(),
        inputs: Vec::new(),
        gathers: false,
        place: format!("[phantom], {}", task.name),
    };
    tasks.map(node).collect()
}

fn lay_out_stage(
    spec: &Spec,
    (at, stage): (usize, &StageSpec),
    inputs: &[Option<InputItems>],
    results: &BTreeMap<usize, Vec<String>>,
    layout: &mut Layout<'_>,
    world: &World<'_>,
) -> Result<(Vec<String>, Vec<Missing>), Vec<Fault>> {
    let mut faults = Vec::new();
    let mut given: Vec<Relation> = Vec::new();
    for references in &stage.roles {
        let mut relation = Relation::default();
        for reference in references {
            match items_of(spec, reference, inputs, results, layout) {
                Ok(items) => relation.extend(items),
                Err(fault) => faults.push(fault),
            }
        }
        given.push(relation);
    }
    if let Err(fault) = filter_stage(spec, stage, &mut given) {
        faults.push(fault);
    }
    if !faults.is_empty() {
        return Err(faults);
    }
    let rows = stage_rows(spec, stage, &given)?;
    for row in rows.rows {
        let id = task_id(&stage.name, &rows.names, &row.keys).map_err(|why| vec![spec.fault(stage.at, why)])?;
        for (items, relation) in row.items.iter().zip(&given) {
            layout.taken.extend(items.iter().map(|&at| relation.items[at].place.clone()));
        }
        let node = node((at, stage), id, row, &given, &mut layout.warnings, world);
        layout.nodes.push(node);
    }
    Ok((rows.names, rows.left_out))
}

fn items_of(
    spec: &Spec,
    reference: &Reference,
    inputs: &[Option<InputItems>],
    results: &BTreeMap<usize, Vec<String>>,
    layout: &Layout<'_>,
) -> Result<Relation, Fault> {
    let (relation, columns) = match reference.from {
        From::Input(input, column) => {
            let items = inputs[input].as_ref();
            (items.map(|items| items.of(column)).unwrap_or_default(), items.map(|items| items.columns.clone()))
        }
        From::Stage(stage, part) => {
            let maker = &spec.stages[stage];
            let file = part.map_or("", |part| maker.prepared.file(&maker.kind.parts[part]));
            let names = results.get(&stage).cloned().unwrap_or_default();
            let nodes = layout.of_stage[stage].clone().unwrap_or_default();
            let item = |node: usize| Item {
                keys: layout.nodes[node].keys.clone(),
                columns: layout.nodes[node].keys.clone(),
                origin: Origin::Made {
                    task: node,
                    file: file.to_owned(),
                    part: part.map(|part| maker.kind.parts[part].name),
                },
                place: layout.nodes[node].id.clone(),
            };
            let relation = Relation { names: names.clone(), items: nodes.map(item).collect(), lacking: Vec::new() };
            (relation, Some(names))
        }
    };
    let there = |key: &str| relation.items.iter().filter_map(|item| item.columns.get(key)).collect();
    if !relation.items.is_empty() {
        check_filter(spec, &reference.filter, &columns.unwrap_or_default(), there)?;
    }
    Ok(relation.only(&reference.filter))
}

/// A stage's own `where` is for all that it works on, of what has the key.
fn filter_stage(spec: &Spec, stage: &StageSpec, given: &mut [Relation]) -> Result<(), Fault> {
    let mut names: Vec<String> = given.iter().flat_map(|relation| relation.names.clone()).collect();
    names.sort();
    names.dedup();
    if given.iter().all(|relation| relation.items.is_empty()) {
        return Ok(());
    }
    check_filter(spec, &stage.filter, &names, |key| {
        given.iter().flat_map(|relation| &relation.items).filter_map(|item| item.keys.get(key)).collect()
    })?;
    for relation in given {
        relation.items.retain(|item| !leaves_out(&stage.filter, &item.keys));
        relation.lacking.retain(|row| !leaves_out(&stage.filter, &row.keys));
    }
    Ok(())
}

fn node(
    (at, stage): (usize, &StageSpec),
    id: String,
    row: Row,
    given: &[Relation],
    warnings: &mut Vec<String>,
    world: &World<'_>,
) -> Node {
    let mut inputs = Vec::new();
    let mut places = Vec::new();
    let mut gathers = false;
    for (role, items) in row.items.iter().enumerate() {
        let kind = &stage.kind.roles[role];
        let may_fail = matches!(kind.takes, Takes::Many | Takes::AnyNumber);
        gathers |= may_fail && items.len() > 1;
        for item in items.iter().map(|&at| &given[role].items[at]) {
            if !may_fail {
                places.push(item.place.as_str());
            }
            let own = source(stage, item, kind.name, warnings, world).map(|source| (kind.name, source));
            for (role, from) in own.into_iter().chain(beside(stage, item, kind.name, world)) {
                inputs.push(NodeInput { role, keys: item.keys.clone(), from, may_fail });
            }
        }
    }
    places.dedup();
    let place = if places.is_empty() { format!("`{}`", stage.name) } else { places.join(" with ") };
    Node { id, stage: Some(at), keys: row.keys, inputs, gathers, place }
}

/// Where an item comes from; a generated one of a catalogue that is not there can't be.
fn source(
    stage: &StageSpec,
    item: &Item,
    role: &str,
    warnings: &mut Vec<String>,
    world: &World<'_>,
) -> Option<NodeSource> {
    Some(match &item.origin {
        Origin::Given { path, name } => {
            let stands = path.exists();
            if !stands {
                let what = format!(
                    "{}: the `{}` of `{}`, {}, does not stand; what needs it will fail",
                    item.place,
                    role,
                    stage.name,
                    path.display()
                );
                warnings.push(what);
            }
            NodeSource::Given { path: path.clone(), name: name.clone(), stands }
        }
        Origin::Generated(path) => return generated(path, world),
        Origin::Made { task, file, part } => {
            NodeSource::Made { node: *task, file: file.clone(), part: *part, facts: Facts::default() }
        }
    })
}

/// A file or a folder of the catalogue, and the task that makes it.
fn generated(path: &str, world: &World<'_>) -> Option<NodeSource> {
    let (node, file, facts) = world.maker(path)?;
    Some(NodeSource::Made { node, file, part: None, facts })
}

/// Files that a job reads with an input, where they stand or will be generated and the stage does not name that role
/// itself.
fn beside(stage: &StageSpec, item: &Item, role: &str, world: &World<'_>) -> Vec<(&'static str, NodeSource)> {
    let path = match &item.origin {
        Origin::Given { path, .. } => path.clone(),
        Origin::Generated(path) => Path::new(path).to_owned(),
        Origin::Made { .. } => return Vec::new(),
    };
    let mut found = Vec::new();
    for (role, beside) in stage.prepared.beside(role, &path) {
        let named = stage.kind.roles.iter().position(|known| known.name == role);
        if named.is_some_and(|at| !stage.roles[at].is_empty()) {
            continue;
        }
        let source = match &item.origin {
            Origin::Given { name, .. } if beside.exists() => {
                let said = name_beside(name, &path, &beside);
                Some(NodeSource::Given { path: beside, name: said, stands: true })
            }
            Origin::Generated(_) => {
                beside.to_str().filter(|path| world.generates(path)).and_then(|path| generated(path, world))
            }
            _ => None,
        };
        found.extend(source.map(|source| (role, source)));
    }
    found
}

/// What a file beside another is called where that one is called `name`.
fn name_beside(name: &str, path: &Path, beside: &Path) -> String {
    let relative =
        path.parent().and_then(|folder| pathdiff::diff_paths(beside, folder)).unwrap_or_else(|| beside.to_owned());
    let folder = name.rsplit_once('/').map_or(String::new(), |(folder, _)| format!("{folder}/"));
    plain(&format!("{folder}{}", relative.to_string_lossy()))
}

/// Tasks of the same name: their results would be the same files.
fn clashes(spec: &Spec, layout: &Layout<'_>, faults: &mut Vec<Fault>) {
    let mut seen: HashMap<&str, usize> = HashMap::new();
    let mut clashing: HashSet<&str> = HashSet::new();
    let mut shown: BTreeMap<usize, usize> = BTreeMap::new();
    for (at, node) in layout.nodes.iter().enumerate() {
        // The first of a name stands for all before: of many alike one pair says it.
        let earlier = *seen.entry(&node.id).or_insert(at);
        let (Some(stage), true) = (node.stage, earlier != at && clashing.insert(&node.id)) else { continue };
        let earlier = &layout.nodes[earlier];
        let count = shown.entry(stage).or_default();
        *count += 1;
        if *count > TOLD {
            continue;
        }
        let why = if earlier.keys == node.keys {
            "add a column or a {place} that tells them apart, or choose with `where`"
        } else {
            "their keys differ only in characters that no folder's name has; rename one"
        };
        let what = format!("{} and {} would both be written to `{}`; {why}", earlier.place, node.place, node.id);
        faults.push(spec.fault(spec.stages[stage].at, what));
    }
    for (stage, count) in shown {
        if count > TOLD {
            faults.push(
                spec.fault(
                    spec.stages[stage].at,
                    format!("and {} more of `{}`", count - TOLD, spec.stages[stage].name),
                ),
            );
        }
    }
}

/// Wanted stages that have nothing to work on.
fn nothing_to_do(spec: &Spec, layout: &Layout<'_>, faults: &mut Vec<Fault>) {
    for wanted in &spec.wanted {
        if layout.of_stage[wanted.stage].as_ref().is_some_and(|nodes| nodes.is_empty()) {
            let what = format!(
                "`{}` is wanted and has nothing to work on: {}",
                spec.stages[wanted.stage].name,
                why(spec, layout, wanted.stage)
            );
            faults.push(spec.fault(wanted.at, what));
        }
    }
}

fn why(spec: &Spec, layout: &Layout<'_>, stage: usize) -> String {
    let spec_stage = &spec.stages[stage];
    for (role, references) in spec_stage.kind.roles.iter().zip(&spec_stage.roles) {
        if !matches!(role.takes, Takes::One | Takes::Many) {
            continue;
        }
        let empty = references.iter().find_map(|reference| match reference.from {
            From::Stage(at, _) if layout.of_stage[at].as_ref().is_some_and(|nodes| nodes.is_empty()) => Some(at),
            _ => None,
        });
        if let Some(before) = empty {
            let (name, line) = (&spec.stages[before].name, spec.line(spec.stages[before].at));
            return format!(
                "its `{}` comes from `{name}` (line {line}), which has nothing: {}",
                role.name,
                why(spec, layout, before)
            );
        }
    }
    let reasons: Vec<String> =
        layout.left_out[stage].iter().map(|missing| format!("{} ({})", missing.reason, missing.count)).collect();
    if reasons.is_empty() { "no item is left after `where`".to_owned() } else { reasons.join("; ") }
}
