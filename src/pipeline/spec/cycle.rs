//! The order of stages: each after those that it works on, or the circle in which they stand.

use super::{From, Header, StageSpec};
use crate::toml_file::Findings;

pub(super) fn works_on(stage: &StageSpec) -> impl Iterator<Item = usize> {
    stage.roles.iter().flatten().filter_map(|reference| match reference.from {
        From::Stage(at, _) => Some(at),
        From::Input(..) => None,
    })
}

/// Tells of every circle once.
pub(super) fn find(findings: &mut Findings<'_>, headers: &[Header], read: &[Option<StageSpec>]) {
    // 0 not looked at, 1 on the way here, 2 done.
    let mut seen = vec![0_u8; headers.len()];
    for start in 0..headers.len() {
        let mut way = Vec::new();
        walk(findings, headers, read, start, &mut seen, &mut way);
    }
}

fn walk(
    findings: &mut Findings<'_>,
    headers: &[Header],
    read: &[Option<StageSpec>],
    at: usize,
    seen: &mut [u8],
    way: &mut Vec<usize>,
) {
    if seen[at] == 1 {
        let from = way.iter().position(|&stage| stage == at).unwrap_or(0);
        let named = |&stage: &usize| format!("`{}` (line {})", headers[stage].name, findings.line(headers[stage].at));
        let circle: Vec<String> = way[from..].iter().chain([&at]).map(named).collect();
        let what = if circle.len() == 2 {
            format!("{} works on itself; name what it is to work on", circle[0])
        } else {
            format!(
                "stages work on one another in a circle: {}; one of them has to work on an input",
                circle.join(" -> ")
            )
        };
        findings.fault(headers[at].at, what);
    }
    if seen[at] > 0 {
        return;
    }
    seen[at] = 1;
    way.push(at);
    for before in read[at].iter().flat_map(works_on) {
        walk(findings, headers, read, before, seen, way);
    }
    way.pop();
    seen[at] = 2;
}

/// The stages, each after those it works on, else in the file's order; and where each went.
pub(super) fn in_order(stages: Vec<StageSpec>) -> (Vec<StageSpec>, Vec<usize>) {
    let mut order: Vec<usize> = Vec::new();
    fn put(stages: &[StageSpec], at: usize, order: &mut Vec<usize>) {
        if !order.contains(&at) {
            works_on(&stages[at]).for_each(|before| put(stages, before, order));
            order.push(at);
        }
    }
    (0..stages.len()).for_each(|at| put(&stages, at, &mut order));
    let mut place_of = vec![0; stages.len()];
    order.iter().enumerate().for_each(|(place, &at)| place_of[at] = place);
    let mut stages: Vec<Option<StageSpec>> = stages.into_iter().map(Some).collect();
    let mut ordered: Vec<StageSpec> = order.iter().filter_map(|&at| stages[at].take()).collect();
    for reference in ordered.iter_mut().flat_map(|stage| stage.roles.iter_mut().flatten()) {
        if let From::Stage(stage, part) = reference.from {
            reference.from = From::Stage(place_of[stage], part);
        }
    }
    (ordered, place_of)
}
