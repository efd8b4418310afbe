//! What others choose, which do not know the targets: QR with column pivoting, and D-optimal places.

use super::ladder::Ladder;
use super::problem::LayoutProblem;
use super::rules::{Rules, Units};
use super::search::{Aim, Choice, Search, Starts, choice};

/// The first `k` pivots of QR on the centred readings of all persons, one below the other (Businger and Golub 1965,
/// doi:10.1007/BF01436084; as sensor selection: Manohar et al. 2018, doi:10.1109/MCS.2018.2810460): each place is the
/// one with the most variance that those before it do not explain. Left and right are not made alike.
#[must_use]
pub fn pivoted(problem: &LayoutProblem, rules: &Rules, k: usize) -> Option<Choice> {
    let units = Units::new(problem, &Rules { mirror: false, ..rules.clone() });
    let n = problem.len();
    let mut ladder = Ladder::new(problem);
    units.kept.iter().for_each(|&place| ladder.push(place));
    let mut chosen: Vec<usize> = Vec::new();
    for _ in units.kept.len()..k {
        let left = |place: usize| -> f64 {
            let d = ladder.top().d.chunks(n).zip(problem.variance.chunks(n));
            d.map(|(d, variance)| d[place] * variance[place]).sum()
        };
        let free = (0..units.units.len()).filter(|&unit| !chosen.iter().any(|&other| units.near(unit, other)));
        let first = |a: (usize, f64), b: (usize, f64)| if b.1 > a.1 { b } else { a };
        let (unit, _) = free.map(|unit| (unit, left(units.units[unit][0]))).reduce(first)?;
        ladder.push(units.units[unit][0]);
        chosen.push(unit);
    }
    (k >= units.kept.len()).then(|| choice(problem, &units, &chosen))
}

/// The places with the largest determinant of their readings' second moments (D-optimal; its log averaged over
/// persons), by greedy and exchange from all starts.
#[must_use]
pub fn determinant(problem: &LayoutProblem, rules: &Rules, k: usize, starts: Starts) -> Option<Choice> {
    let units = Units::new(problem, rules);
    let mut search = Search { ladder: Ladder::new(problem), units: &units, aim: Aim::Determinant };
    let found = search.exchanged(k, starts)?;
    Some(choice(problem, &units, &found.0))
}
