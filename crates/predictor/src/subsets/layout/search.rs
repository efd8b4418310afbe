//! Forward greedy, then exchange of one unit for another (Fedorov 1972) until none improves, from greedy and from
//! seeded random starts.

use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use serde::Serialize;

use super::ladder::Ladder;
use super::problem::LayoutProblem;
use super::rules::{Rules, Units};

/// A smaller gain than this is rounding.
const GAIN: f64 = 1e-13;
/// Exchanges of one start at most (assumed; each gains, so they end by themselves).
const MOST_EXCHANGES: usize = 1000;

/// Some places.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Choice {
    /// By the caller's numbers, from the tip down, from left to right.
    pub places: Vec<usize>,
    /// What they cost, by the problem's criterion.
    pub cost: f64,
}

/// Where exchange starts besides greedy.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Starts {
    /// How many random layouts.
    pub count: usize,
    /// Of the random numbers.
    pub seed: u64,
}

/// What is minimized.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Aim {
    /// The problem's criterion.
    Cost,
    /// Minus the log of the determinant of the chosen readings' second moments.
    Determinant,
}

/// Greedy alone, and the best that exchange found from all starts; `None` where no `k` places keep the rules.
#[must_use]
pub fn search(problem: &LayoutProblem, rules: &Rules, k: usize, starts: Starts) -> Option<[Choice; 2]> {
    let units = Units::new(problem, rules);
    let mut search = Search { ladder: Ladder::new(problem), units: &units, aim: Aim::Cost };
    let greedy = best(units.compositions(k).into_iter().filter_map(|of| search.greedy(of)))?;
    let exchanged = search.exchanged(k, starts)?;
    Some([greedy, exchanged].map(|found| choice(problem, &units, &found.0)))
}

/// The choice that some units make.
pub(super) fn choice(problem: &LayoutProblem, units: &Units, chosen: &[usize]) -> Choice {
    let own: Vec<usize> =
        units.kept.iter().chain(chosen.iter().flat_map(|&unit| &units.units[unit])).copied().collect();
    let places = problem.callers(&own);
    Choice { cost: problem.cost(&places), places }
}

/// Chosen units with what they cost.
type Found = (Vec<usize>, f64);

/// The cheapest, of equals the first.
fn best(found: impl Iterator<Item = Found>) -> Option<Found> {
    found.reduce(|best, next| if next.1 < best.1 - GAIN { next } else { best })
}

/// A search at work.
pub(super) struct Search<'a> {
    pub(super) ladder: Ladder<'a>,
    pub(super) units: &'a Units,
    pub(super) aim: Aim,
}

impl Search<'_> {
    /// The best of all starts; each is exchanged by itself.
    pub(super) fn exchanged(&mut self, k: usize, starts: Starts) -> Option<Found> {
        let mut rng = ChaCha8Rng::seed_from_u64(starts.seed);
        let mut found = Vec::new();
        for of in self.units.compositions(k) {
            let greedy = self.greedy(of).map(|one| one.0);
            let random: Vec<_> = (0..starts.count).filter_map(|_| self.random(of, &mut rng)).collect();
            found.extend(greedy.into_iter().chain(random).map(|start| self.exchange(start)));
        }
        best(found.into_iter())
    }

    /// Takes one unit after the other, each the one that costs least then.
    fn greedy(&mut self, of: [usize; 2]) -> Option<Found> {
        let (mut chosen, mut left, mut cost) = (Vec::new(), of, None);
        while left != [0, 0] {
            let (unit, own) = self.cheapest(&chosen, |unit| left[2 - unit.len()] > 0)?;
            left[2 - self.units.units[unit].len()] -= 1;
            chosen.push(unit);
            cost = Some(own);
        }
        let cost = cost.unwrap_or_else(|| self.cost(&[]));
        Some((chosen, cost))
    }

    /// Units in a random order, each taken that may be.
    fn random(&self, of: [usize; 2], rng: &mut ChaCha8Rng) -> Option<Vec<usize>> {
        let mut order: Vec<usize> = (0..self.units.units.len()).collect();
        order.shuffle(rng);
        let (mut chosen, mut left): (Vec<usize>, _) = (Vec::new(), of);
        for unit in order {
            let room = &mut left[2 - self.units.units[unit].len()];
            if *room > 0 && !chosen.iter().any(|&other| self.units.near(unit, other)) {
                *room -= 1;
                chosen.push(unit);
            }
        }
        (left == [0, 0]).then_some(chosen)
    }

    /// Exchanges the unit whose replacement gains most, until none gains.
    fn exchange(&mut self, mut chosen: Vec<usize>) -> Found {
        chosen.sort_unstable();
        let mut cost = self.cost(&chosen);
        for _ in 0..MOST_EXCHANGES {
            let swaps = (0..chosen.len()).filter_map(|out| {
                let others: Vec<usize> = chosen.iter().copied().filter(|&unit| unit != chosen[out]).collect();
                let size = self.units.units[chosen[out]].len();
                let (unit, cost) = self.cheapest(&others, |unit| unit.len() == size)?;
                Some((out, unit, cost))
            });
            let best = swaps.reduce(|best, next| if next.2 < best.2 - GAIN { next } else { best });
            let Some((out, unit, least)) = best.filter(|best| best.2 < cost - GAIN) else { break };
            (chosen[out], cost) = (unit, least);
            chosen.sort_unstable();
        }
        (chosen, cost)
    }

    /// The unit that costs least beside `chosen`, and that cost; of equals the first.
    fn cheapest(&mut self, chosen: &[usize], fits: impl Fn(&[usize]) -> bool) -> Option<(usize, f64)> {
        let Units { kept, units, .. } = self.units;
        let taken = self.take(chosen);
        let mut singles = vec![f64::INFINITY; self.ladder.problem.len()];
        match self.aim {
            Aim::Cost => self.ladder.costs_with(0, &mut singles),
            Aim::Determinant => self.ladder.minus_log_determinants_with(&mut singles),
        }
        let mut best: Option<(usize, f64)> = None;
        for (unit, places) in units.iter().enumerate() {
            if !fits(places) || chosen.iter().any(|&other| self.units.near(unit, other)) {
                continue;
            }
            let cost = match places[..] {
                [place] => singles[place],
                _ => self.with(places),
            };
            if best.is_none_or(|(_, least)| cost < least - GAIN) {
                best = Some((unit, cost));
            }
        }
        debug_assert_eq!(taken, kept.len() + chosen.iter().map(|&unit| units[unit].len()).sum::<usize>());
        (0..taken).for_each(|_| self.ladder.pop());
        best
    }

    fn with(&mut self, places: &[usize]) -> f64 {
        places.iter().for_each(|&place| self.ladder.push(place));
        let cost = self.of_ladder();
        places.iter().for_each(|_| self.ladder.pop());
        cost
    }

    fn cost(&mut self, chosen: &[usize]) -> f64 {
        let taken = self.take(chosen);
        let cost = self.of_ladder();
        (0..taken).for_each(|_| self.ladder.pop());
        cost
    }

    fn of_ladder(&self) -> f64 {
        match self.aim {
            Aim::Cost => self.ladder.cost(),
            Aim::Determinant => self.ladder.minus_log_determinant(),
        }
    }

    /// Takes kept places and chosen units; how many places these are.
    fn take(&mut self, chosen: &[usize]) -> usize {
        let places = self.units.kept.iter().chain(chosen.iter().flat_map(|&unit| &self.units.units[unit]));
        places.map(|&place| self.ladder.push(place)).count()
    }
}
