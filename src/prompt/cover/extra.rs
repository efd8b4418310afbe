//! The short extra trajectory: through the cells that have no row yet.
//!
//! From rest to the nearest empty cell, on to the nearest next one, and back to rest, on straight lines, which never
//! leave the cone; as long as [`MOST_S`] at most, so that where more is empty the nearest cells are filled. At no place
//! the force changes faster than [`RATE_N_PER_S`], half of what equation 19 allows at 1 N (5.2.2b).

use std::fmt::Write as _;

use lunula_predictor::{ForceSpace, cell_middle_n, cone_cell};
use serde::Serialize;

use super::visited;
use crate::prompt::protocol::{Motion, Path, Prompted, Step, StepKind};

/// How fast a force changes at most, newtons a second.
const RATE_N_PER_S: f64 = 0.5;
/// How long a force is held in a cell, seconds: two of a person's reactions.
const HELD_S: f64 = 0.6;
/// The longest, seconds: as the test of 5.3.1.
const MOST_S: f64 = 100.0;
/// How often the way is looked at for the cells that it passes, seconds.
const STEP_S: f64 = 0.04;

/// A way through empty cells.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Extra {
    /// How long it takes.
    pub seconds: f64,
    /// The share of cells with a row before, and after it where it is followed exactly.
    pub before: f64,
    /// See `before`.
    pub after: f64,
    /// `[time_s, Fx, Fy, Fz]`, newtons.
    pub points: Vec<[f64; 4]>,
}

/// The way through the empty cells of `cells`; none where all have a row.
#[must_use]
pub(crate) fn extra(space: &ForceSpace, cells: &[bool]) -> Option<Extra> {
    let empty = cells.iter().enumerate().filter(|(_, has)| !**has);
    let mut left: Vec<[f64; 3]> = empty.map(|(cell, _)| cell_middle_n(space, cell)).collect();
    let mut points = vec![[0.0; 4]];
    let mut at = [0.0; 3];
    let mut now_s = 0.0;
    while let Some(next) = nearest(&left, at) {
        let goal = left.swap_remove(next);
        let reached_s = now_s + away(at, goal) / RATE_N_PER_S;
        let held_s = reached_s + HELD_S;
        if held_s + away(goal, [0.0; 3]) / RATE_N_PER_S > MOST_S {
            break;
        }
        points.extend([reached_s, held_s].map(|time_s| [time_s, goal[0], goal[1], goal[2]]));
        (now_s, at) = (held_s, goal);
    }
    if points.len() == 1 {
        return None;
    }
    points.push([now_s + away(at, [0.0; 3]) / RATE_N_PER_S, 0.0, 0.0, 0.0]);
    // Hundredths, as a file has them.
    let rounded = |value: f64| (1e4 * value).round() / 1e4;
    let points: Vec<[f64; 4]> = points.into_iter().map(|point| point.map(|value| rounded(value) + 0.0)).collect();
    let seconds = points.last().map_or(0.0, |last| last[0]);
    let found = Extra { seconds, before: visited(cells), after: 0.0, points };
    let after = visited(&filled(space, cells, &found));
    Some(Extra { after, ..found })
}

fn nearest(left: &[[f64; 3]], at: [f64; 3]) -> Option<usize> {
    let distances = left.iter().map(|goal| away(at, *goal)).enumerate();
    distances.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(place, _)| place)
}

fn away(one: [f64; 3], other: [f64; 3]) -> f64 {
    one.iter().zip(other).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

/// The cells after a person has followed it exactly.
fn filled(space: &ForceSpace, cells: &[bool], extra: &Extra) -> Vec<bool> {
    let mut cells = cells.to_vec();
    let (motion, steps) = (extra.motion(), (extra.seconds / STEP_S) as u32);
    for k in 0..=steps {
        if let Prompted::Force(force) = motion.at(STEP_S * f64::from(k))
            && let Some(cell) = cone_cell(space, force)
        {
            cells[cell] = true;
        }
    }
    cells
}

impl Extra {
    fn motion(&self) -> Motion {
        Motion { seconds: self.seconds, path: Path::Points(self.points.clone()) }
    }

    /// As a step of a protocol, of a session.
    #[must_use]
    pub(crate) fn step(&self, session: u32) -> Step {
        Step {
            name: "extra".to_owned(),
            text: self.says(),
            kind: StepKind::Move(self.motion()),
            collects: true,
            waits: true,
            session,
            checks: Vec::new(),
        }
    }

    /// In words.
    #[must_use]
    pub(crate) fn says(&self) -> String {
        let [before, after] = [self.before, self.after].map(|share| (100.0 * share).floor());
        format!("{:.0} s more would fill {before:.0} % -> {after:.0} % of the cone", self.seconds)
    }

    /// As a protocol's file.
    #[must_use]
    pub(crate) fn toml(&self, space: &ForceSpace) -> String {
        let mut text = format!("# {}\nfz_max_N = {}\nmu = {}\n\n", self.says(), space.fz_max_n(), space.mu());
        text.push_str(
            "[[step]]\nkind = \"path\"\nname = \"extra\"\ntext = \"Follow the ring through what is missing.\"\n",
        );
        text.push_str("points = [\n");
        for [time_s, fx, fy, fz] in &self.points {
            let _ = writeln!(text, "  [{time_s}, {fx}, {fy}, {fz}],");
        }
        text + "]\n"
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path as FilePath;

    use super::*;
    use crate::prompt::protocol::Protocol;

    #[test]
    fn what_is_missing_is_passed_within_the_cone_slowly_and_from_rest_to_rest() {
        let space = ForceSpace::default();
        let mut cells = vec![true; 192];
        for empty in [5, 77, 100, 191] {
            cells[empty] = false;
        }
        let extra = extra(&space, &cells).unwrap();
        assert_eq!((extra.before, extra.after), (188.0 / 192.0, 1.0));
        assert!(extra.seconds > 4.0 && extra.seconds < 40.0, "{}", extra.seconds);
        for pair in extra.points.windows(2) {
            let [from, to] = [pair[0], pair[1]].map(|point| [point[1], point[2], point[3]]);
            assert!(cone_cell(&space, to).is_some() && pair[1][0] > pair[0][0], "{pair:?}");
            // Rounded to ten-thousandths.
            assert!(away(from, to) <= (RATE_N_PER_S + 1e-3) * (pair[1][0] - pair[0][0]) + 2e-4, "{pair:?}");
        }
        let ends = [extra.points[0], extra.points[extra.points.len() - 1]];
        assert!(ends.iter().all(|end| end[1..] == [0.0; 3]));
        // The file that is written is the step.
        let protocol = Protocol::parse(&extra.toml(&space), FilePath::new("e.toml")).unwrap();
        assert_eq!(protocol.steps[0].motion(), extra.step(2).motion());
    }

    #[test]
    fn nothing_is_missing_or_too_much() {
        let space = ForceSpace::default();
        assert_eq!(extra(&space, &[true; 192]), None);
        let all = extra(&space, &[false; 192]).unwrap();
        assert!(all.seconds <= MOST_S && all.before == 0.0 && all.after > 0.1 && all.after < 1.0, "{}", all.says());
    }
}
