//! Curves are judged: where the knee of each is, where the default stands, what the best of the other programs does.

pub(in crate::tradeoff) mod knee;
use std::time::Instant;

use anyhow::ensure;
use serde::Serialize;

use super::choices::{Choice, choices};
use super::peers::{PeerReport, PeerRow, join};
use crate::tradeoff::measure::rows::{Measured, Row};
use knee::{Cost, SAME, front, knee};

/// A setting with its figures.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Figures {
    /// As in the table's column of that name.
    pub setting: String,
    /// In the row's unit of error.
    pub error: f64,
    /// Seconds an input.
    pub run_s: f64,
}

/// What became of one curve: a choice's settings by one error.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Verdict {
    /// Of which job.
    pub job: &'static str,
    /// What is chosen.
    pub choice: &'static str,
    /// By which option.
    pub option: &'static str,
    /// The unit of all errors here.
    pub error_unit: String,
    /// Whether this error decides.
    pub decides: bool,
    /// The knee; none where no setting has a place.
    pub knee: Option<Figures>,
    /// Why it is the knee.
    pub knee_why: &'static str,
    /// The default; none where it has no answer.
    pub default: Option<Figures>,
    /// Where it stands by the knee, in words.
    pub default_is: String,
    /// Why it is the default.
    pub default_why: &'static str,
    /// Of the other programs that err no more than the default the fastest, else the one that errs least.
    pub peer: Option<Figures>,
    /// Settings worth their time: seconds and error, from the fastest on.
    #[serde(skip)]
    pub front: Vec<[f64; 2]>,
}

/// A job's curves.
#[derive(Debug, Clone, Serialize)]
pub struct Tradeoff {
    /// Its name, such as `posture`.
    pub job: &'static str,
    /// Every setting, marked.
    pub rows: Vec<Row>,
    /// One per choice and unit of error.
    pub curves: Vec<Verdict>,
    /// Settings that have no answer, and why.
    pub refused: Vec<String>,
    /// What became of other programs.
    pub peers: Vec<PeerReport>,
    /// Seconds that measuring took.
    pub wall_s: f64,
}

/// Finds the knees of what `measured` gave for `job` on `scene`, with the rows of other programs beside it. `begun`:
/// when measuring began.
///
/// # Errors
/// Rows of other programs that fit no curve.
pub fn judge(
    job: &'static str,
    measured: Measured,
    (scene, others): (&str, &[&PeerRow]),
    begun: Instant,
) -> anyhow::Result<Tradeoff> {
    let Measured { mut rows, mut refused } = measured;
    let peers = join(&mut rows, scene, others)?;
    let mut curves = Vec::new();
    for choice in choices().into_iter().filter(|choice| choice.job == job) {
        let mut units: Vec<String> = Vec::new();
        for row in rows.iter().filter(|row| row.choice == choice.name) {
            if !units.contains(&row.error_unit) {
                units.push(row.error_unit.clone());
            }
        }
        curves.extend(units.into_iter().map(|unit| curve(&choice, unit, &mut rows)));
    }
    ensure!(!curves.is_empty(), "{job}: no setting has an answer: {}", refused.join("; "));
    let bare = |curve: &&Verdict| !rows.iter().any(|row| is_on(row, curve) && row.has_place());
    let not_drawn: Vec<String> = curves.iter().filter(bare).map(not_drawn).collect();
    ensure!(not_drawn.len() < curves.len(), "{}", not_drawn.join("; "));
    refused.extend(not_drawn);
    Ok(Tradeoff { job, rows, curves, refused, peers, wall_s: begun.elapsed().as_secs_f64() })
}

pub(in crate::tradeoff) fn is_on(row: &Row, curve: &Verdict) -> bool {
    row.choice == curve.choice && row.error_unit == curve.error_unit
}

fn not_drawn(curve: &Verdict) -> String {
    let Verdict { job, choice, error_unit, .. } = curve;
    format!("{job}, {choice} ({error_unit}): no setting has both an error and a time above 0, so there is no picture")
}

fn figures(row: &Row) -> Figures {
    Figures { setting: row.setting.clone(), error: row.error, run_s: row.run_s }
}

fn curve(choice: &Choice, unit: String, rows: &mut [Row]) -> Verdict {
    let on = |row: &Row| row.choice == choice.name && row.error_unit == unit;
    let own: Vec<usize> = (0..rows.len()).filter(|&k| on(&rows[k]) && !rows[k].peer).collect();
    let cost = |row: &Row| Cost { run_s: row.run_s, low_s: row.run_low_s, high_s: row.run_high_s, error: row.error };
    let costs: Vec<Cost> = own.iter().map(|&k| cost(&rows[k])).collect();
    let found = knee(&costs);
    if let Some(found) = found {
        rows[own[found.at]].knee = true;
    }
    let default = own.iter().copied().find(|&k| rows[k].setting == choice.default);
    if let Some(default) = default {
        rows[default].default = true;
    }
    let knee_row = found.map(|found| own[found.at]);
    let default_is = match (default, knee_row) {
        (None, _) => "it has no answer here".to_owned(),
        (Some(_), None) => "no setting has a place".to_owned(),
        (Some(default), Some(knee)) => stands(&rows[default], &rows[knee]),
    };
    let peers = rows.iter().filter(|row| on(row) && row.peer && row.error.is_finite() && row.run_s > 0.0);
    Verdict {
        job: choice.job,
        choice: choice.name,
        option: choice.option,
        decides: unit.starts_with(choice.judged_by),
        knee: knee_row.map(|k| figures(&rows[k])),
        knee_why: found.map_or("", |found| found.why.words()),
        default: default.map(|k| figures(&rows[k])),
        default_is,
        default_why: choice.why,
        peer: best(peers, default.map(|k| rows[k].error)).map(figures),
        front: front(&costs).into_iter().map(|k| [costs[k].run_s, costs[k].error]).collect(),
        error_unit: unit,
    }
}

/// Where the default stands by the knee.
fn stands(default: &Row, knee: &Row) -> String {
    if default.setting == knee.setting {
        return "the knee".to_owned();
    }
    let (time, error) = (default.run_s / knee.run_s, default.error / knee.error);
    let same = |ratio: f64| (1.0 / (1.0 + SAME)..=1.0 + SAME).contains(&ratio);
    let times = |ratio: f64| if same(ratio) { "the same".to_owned() } else { format!("{} times its", short(ratio)) };
    let place = match (same(time), same(error), time > 1.0) {
        (true, true, _) => "no different from the knee",
        (true, false, _) => "beside the knee",
        (false, _, true) => "beyond the knee",
        (false, _, false) => "before the knee",
    };
    format!("{place}: {} time, {} error", times(time), times(error))
}

/// A ratio in two digits.
fn short(ratio: f64) -> String {
    if (0.01..100.0).contains(&ratio) { format!("{ratio:.2}") } else { format!("{ratio:.0e}") }
}

fn best<'a>(peers: impl Iterator<Item = &'a Row>, error: Option<f64>) -> Option<&'a Row> {
    let enough = |row: &Row| error.is_some_and(|error| row.error <= (1.0 + SAME) * error);
    peers.min_by(|a, b| match (enough(a), enough(b)) {
        (true, true) => a.run_s.total_cmp(&b.run_s),
        (false, false) => a.error.total_cmp(&b.error),
        (a, b) => b.cmp(&a),
    })
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::tradeoff::measure::timing::Timing;
    use crate::tradeoff::photos;

    pub(in crate::tradeoff) fn row(setting: &str, run_s: f64, error: f64) -> Row {
        Row::own(photos::DETECTION, setting, (error, photos::OUTLINE_ERROR), Timing::of(vec![run_s]), 1)
    }

    pub(in crate::tradeoff) fn judged(rows: Vec<Row>, others: &[PeerRow]) -> anyhow::Result<Tradeoff> {
        let others: Vec<&PeerRow> = others.iter().collect();
        judge("photos", Measured { rows, ..Measured::default() }, ("seed 1", &others), Instant::now())
    }

    /// Settings `a` and `b`, of which `b` is the knee, the default beyond it, and another program where it is named.
    pub(in crate::tradeoff) fn judged_by_default(other: Option<&str>) -> Tradeoff {
        let mut rows = vec![row("a", 1.0, 9.0), row("b", 1.5, 0.5), row(&photos::detection_default(), 30.0, 0.4)];
        rows.extend(other.map(|other| Row { peer: true, ..row(other, 0.1, 0.1) }));
        judged(rows, &[]).unwrap()
    }

    #[test]
    fn knee_and_default_are_marked_and_reported() {
        let found = judged_by_default(Some("other"));
        let marks: Vec<_> = found.rows.iter().map(|row| (row.knee, row.default, row.peer)).collect();
        assert_eq!(marks, [(false, false, false), (true, false, false), (false, true, false), (false, false, true)]);
        let curve = &found.curves[0];
        assert_eq!(curve.knee.as_ref().unwrap().setting, "b");
        assert_eq!(curve.default_is, "beyond the knee: 20.00 times its time, 0.80 times its error");
        assert_eq!(curve.peer.as_ref().unwrap().setting, "other");
        assert!(curve.decides && curve.front.len() == 3);
    }

    #[test]
    fn the_default_may_be_the_knee_or_like_it() {
        let default = photos::detection_default();
        let is = |rows: Vec<Row>| judged(rows, &[]).unwrap().curves[0].default_is.clone();
        assert_eq!(is(vec![row("a", 1.0, 9.0), row(&default, 1.5, 0.5), row("c", 40.0, 0.4)]), "the knee");
        assert_eq!(
            is(vec![row("a", 1.0, 9.0), row(&default, 1.02, 9.1)]),
            "no different from the knee: the same time, the same error"
        );
        assert_eq!(is(vec![row("a", 1.0, 9.0)]), "it has no answer here");
    }

    #[test]
    fn the_best_peer_is_the_fastest_that_errs_no_more() {
        let rows = [row("slow", 9.0, 0.1), row("fast", 2.0, 0.5), row("wrong", 0.1, 7.0)];
        let best = |error| best(rows.iter(), Some(error)).map(|row| row.setting.clone()).unwrap();
        assert_eq!([best(0.5), best(0.2), best(0.01)], ["fast", "slow", "slow"]);
    }

    #[test]
    fn without_an_answer_there_is_no_curve() {
        let measured = Measured { refused: vec!["a: why".into()], ..Measured::default() };
        let why = judge("photos", measured, ("seed 1", &[]), Instant::now()).unwrap_err().to_string();
        assert!(why.contains("a: why"), "{why}");
    }
}
