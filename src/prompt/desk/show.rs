//! What a page hears, as JSON: the state now and then, and each force.
//!
//! The page draws the ring where it will be when a frame is seen, so it hears what is prompted from a moment ago until
//! [`AHEAD_S`] from now, in pieces between which something begins or stops, each at least every [`EVERY_S`]; on the
//! straight line between two rows the ring is within some thousandths of a newton of the path.

use lunula_predictor::ConeCoverage;
use serde::Serialize;

use super::Shared;
use crate::prompt::protocol::{Prompted, StepKind};

/// How far back and ahead, and how often, seconds.
const BACK_S: f64 = 0.25;
const AHEAD_S: f64 = 1.25;
const EVERY_S: f64 = 0.02;

#[derive(Serialize)]
struct State<'a> {
    now_s: f64,
    phase: &'static str,
    why: &'a str,
    step: Option<StepState<'a>>,
    checks: Vec<CheckState>,
    ahead: Vec<Piece>,
    scale_n: f64,
    fz_max_n: f64,
    mu: f64,
    cover: CoverState,
    extra: Option<String>,
    frames: [u64; 2],
}

#[derive(Serialize)]
struct StepState<'a> {
    place: usize,
    count: usize,
    name: &'a str,
    text: &'a str,
    kind: &'static str,
    collects: bool,
    session: u32,
    at_s: f64,
    seconds: f64,
    followed_n: Option<f64>,
}

#[derive(Serialize)]
struct CheckState {
    check: crate::prompt::protocol::Check,
    passed: bool,
    says: String,
}

/// What is prompted from one time to another, in rows at even distances, the first and the last at its ends: `[Fx, Fy,
/// Fz]` newtons, or `[J2]` degrees, or nothing; one row where nothing moves.
#[derive(Serialize)]
struct Piece {
    from_s: f64,
    to_s: f64,
    rows: Vec<Vec<f64>>,
}

#[derive(Serialize)]
struct CoverState {
    rows: usize,
    visited: f64,
    /// A letter for each cell: 1 where it has a row.
    cells: String,
    hole_n: Option<f64>,
    hole_at_n: Option<[f64; 3]>,
}

/// Six digits behind the point: what a page needs.
pub(in crate::prompt) fn short(value: f64) -> f64 {
    (1e6 * value).round() / 1e6
}

pub(super) fn state_json(shared: &mut Shared, now_s: f64) -> String {
    let lately: Option<ConeCoverage> = shared.cover.lately();
    let hole = lately.and_then(|coverage| coverage.hole);
    let (phase, why) = shared.run.phase();
    let (place, count) = shared.run.place();
    let done = phase.word() == "done";
    let step = shared.run.current().map(|step| StepState {
        place,
        count,
        name: &step.name,
        text: &step.text,
        kind: match &step.kind {
            StepKind::Ask => "ask",
            StepKind::Check => "check",
            StepKind::Move(motion) if motion.bends() => "bend",
            StepKind::Move(_) => "force",
        },
        collects: step.collects,
        session: step.session,
        at_s: short(shared.run.prompted(now_s).1.map_or(0.0, |(_, at_s)| at_s)),
        seconds: step.motion().map_or(0.0, |motion| motion.whole_s()),
        followed_n: shared.followed_n(place),
    });
    let checks = shared.run.verdicts().into_iter();
    let checks = checks.map(|(check, verdict)| CheckState { check, passed: verdict.passed, says: verdict.says });
    let protocol = &shared.run.protocol;
    let state = State {
        now_s: short(now_s),
        phase: phase.word(),
        why,
        step,
        checks: checks.collect(),
        ahead: ahead(shared, now_s),
        scale_n: protocol.scale_n(),
        fz_max_n: protocol.space.fz_max_n(),
        mu: protocol.space.mu(),
        cover: CoverState {
            rows: shared.cover.rows(),
            visited: shared.cover.visited(),
            cells: shared.cover.cells.iter().map(|cell| if *cell { '1' } else { '0' }).collect(),
            hole_n: hole.map(|hole| hole.radius_n),
            hole_at_n: hole.map(|hole| hole.middle_n),
        },
        extra: if done { shared.cover.extra().map(|extra| extra.says()) } else { None },
        frames: shared.frames.counts(),
    };
    serde_json::to_string(&state).unwrap_or_default()
}

fn ahead(shared: &Shared, now_s: f64) -> Vec<Piece> {
    let (from_s, until_s) = (now_s - BACK_S, now_s + AHEAD_S);
    let course = &shared.run.course;
    let later = course.stretches().iter().map(|stretch| stretch.from_s);
    let mut bounds: Vec<f64> = vec![from_s];
    bounds.extend(later.filter(|begins_s| (from_s..until_s).contains(begins_s)));
    bounds.push(until_s);
    let row = |time_s: f64| match shared.run.prompted(time_s).0 {
        None => Vec::new(),
        Some(Prompted::Force(force)) => force.map(short).to_vec(),
        Some(Prompted::Bend(j2_deg)) => vec![short(j2_deg)],
    };
    let piece = |from_s: f64, to_s: f64| {
        let steps = if course.at(from_s).0.moves { ((to_s - from_s) / EVERY_S).ceil() as u32 } else { 0 };
        let every_s = (to_s - from_s) / f64::from(steps.max(1));
        // The end is the next one's.
        let rows = (0..=steps).map(|k| row((from_s + every_s * f64::from(k)).min(to_s - 1e-9).max(from_s)));
        Piece { from_s: short(from_s), to_s: short(to_s), rows: rows.collect() }
    };
    bounds.windows(2).filter(|pair| pair[1] > pair[0]).map(|pair| piece(pair[0], pair[1])).collect()
}

pub(super) fn force_json(time_s: f64, force_n: [f64; 3]) -> String {
    let [fx, fy, fz] = force_n.map(short);
    format!("[{:.6},{fx},{fy},{fz}]", time_s)
}
