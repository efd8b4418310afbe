//! Which digits a cell's steady looks are.
//!
//! In: what a cell showed for at least two frames, when, and what the network says of it. Out: a name for each look, or
//! none. A clock counts:
//! where a cell changed several times, the digits follow one another at the cell's own rate, and only the first of them
//! is unknown; all of the network's answers together tell which it is, so that one glyph that the network does not
//! know, or mistakes, gets its name from the others. Where the cell stood still the network has to be sure by itself.

use super::look::Look;
use crate::clock::format::{Cell, ClockFormat};

/// What a digit of the format can be, and for how long it stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::clock) struct Place {
    pub(in crate::clock) highest: u8,
    step_s: f64,
}

/// The places of a format's digits.
pub(in crate::clock) fn places(format: &ClockFormat) -> Vec<Place> {
    let of = |cell: &Cell| match *cell {
        Cell::Digit { highest, worth_ns, .. } => Some(Place { highest, step_s: 1e-9 * worth_ns as f64 }),
        Cell::Mark(_) | Cell::Half => None,
    };
    format.cells().iter().filter_map(of).collect()
}

/// Once that a look stood.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::clock) struct Stand {
    pub(in crate::clock) middle_s: f64,
    /// Logarithms of the digits' probabilities, none under [`UNLIKELIEST`]'s.
    pub(in crate::clock) log_digits: [f64; 10],
}

/// A look that stood at least once.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::clock) struct Steady {
    pub(in crate::clock) look: Look,
    pub(in crate::clock) stands: Vec<Stand>,
}

/// The network errs more often than it thinks.
pub(in crate::clock) const UNLIKELIEST: f64 = 1e-3;
/// A name that is at least this probable is given to a glyph.
pub(in crate::clock) const NAMED: f64 = 0.9;
/// The order decides where at least this many different looks follow one another.
const FOLLOWING: usize = 4;
/// How probable the network has to find the digits of the order (geometric mean).
const AGREED: f64 = 0.2;
/// How probably a digit of the order has to be right.
const ORDERED: f64 = 0.999;
/// When the clock changes is tried at so many moments of a step.
const PHASES: usize = 20;

/// Each look's digit and how probable it is, by the order in which they stood.
///
/// A stand that was seen in part only has its middle anywhere between two changes, so that when the clock changes is as
/// unknown as the first digit: a look's digit is what all phases say of it together, each by how well the network
/// agrees with it.
pub(in crate::clock) fn by_order(steady: &[Steady], place: Place) -> Option<Vec<Option<(u8, f64)>>> {
    let modulus = usize::from(place.highest) + 1;
    let count: usize = steady.iter().map(|one| one.stands.len()).sum();
    let start_s = steady.iter().flat_map(|one| &one.stands).map(|stand| stand.middle_s).fold(f64::INFINITY, f64::min);
    // Each phase and first digit: the looks' steps, and how probable all of the network's answers are.
    let mut cases: Vec<(Vec<Option<usize>>, usize, f64)> = Vec::new();
    for phase in 0..PHASES {
        let since_s = start_s - place.step_s * (phase as f64 + 0.5) / PHASES as f64;
        let Some(steps) = steps(steady, place, since_s, modulus) else { continue };
        for first in 0..modulus {
            let of = |(one, step): (&Steady, &Option<usize>)| -> f64 {
                let log =
                    |stand: &Stand| step.map_or(UNLIKELIEST.ln(), |step| stand.log_digits[(first + step) % modulus]);
                one.stands.iter().map(log).sum()
            };
            let log = steady.iter().zip(&steps).map(of).sum();
            cases.push((steps.clone(), first, log));
        }
    }
    let best = cases.iter().map(|(_, _, log)| *log).fold(f64::NEG_INFINITY, f64::max);
    if cases.is_empty() || (best / count as f64).exp() < AGREED {
        return None;
    }
    let mut weights = vec![[0.0f64; 10]; steady.len()];
    let mut whole = 0.0;
    for (steps, first, log) in &cases {
        let weight = (log - best).exp();
        whole += weight;
        for (weights, step) in weights.iter_mut().zip(steps) {
            if let Some(step) = step {
                weights[(first + step) % modulus] += weight;
            }
        }
    }
    let name = |weights: &[f64; 10]| {
        let digit = (0..10).fold(0, |most, digit| if weights[digit] > weights[most] { digit } else { most });
        let sure = weights[digit] / whole;
        (sure >= ORDERED).then_some((digit as u8, sure))
    };
    let names: Vec<Option<(u8, f64)>> = weights.iter().map(name).collect();
    // Two looks of one name are one digit only where the network does not say otherwise.
    let alone = |name: (u8, f64)| names.iter().flatten().filter(|(digit, _)| *digit == name.0).count() == 1;
    let kept = |(name, one): (&Option<(u8, f64)>, &Steady)| {
        name.filter(|&name| alone(name) || network(one).is_none_or(|(digit, sure)| digit == name.0 || sure < NAMED))
    };
    let kept: Vec<Option<(u8, f64)>> = names.iter().zip(steady).map(kept).collect();
    kept.iter().any(Option::is_some).then_some(kept)
}

/// How many steps after `since_s` each look stands, where it is the same digit whenever it does; none where too few
/// different ones follow.
fn steps(steady: &[Steady], place: Place, since_s: f64, modulus: usize) -> Option<Vec<Option<usize>>> {
    let step = |stand: &Stand| (((stand.middle_s - since_s) / place.step_s).floor() as i64).rem_euclid(modulus as i64);
    let of = |one: &Steady| {
        let mut steps = one.stands.iter().map(step);
        let first = steps.next()?;
        steps.all(|step| step == first).then_some(first as usize)
    };
    let steps: Vec<Option<usize>> = steady.iter().map(of).collect();
    let mut different: Vec<usize> = steps.iter().flatten().copied().collect();
    different.sort_unstable();
    different.dedup();
    (different.len() >= FOLLOWING).then_some(steps)
}

/// What the network says of a look in all of its stands: the likeliest digit and the mean (geometric) of its
/// probabilities.
pub(in crate::clock) fn network(one: &Steady) -> Option<(u8, f64)> {
    let mean = |digit: usize| {
        let sum: f64 = one.stands.iter().map(|stand| stand.log_digits[digit]).sum();
        (sum / one.stands.len().max(1) as f64).exp()
    };
    let best = (0..10).fold((0, 0.0), |best, digit| if mean(digit) > best.1 { (digit, mean(digit)) } else { best });
    (!one.stands.is_empty()).then_some((best.0 as u8, best.1))
}

/// Each look's digit and how probable it is, by the network alone.
pub(in crate::clock) fn one_by_one(steady: &[Steady], place: Place) -> Vec<Option<(u8, f64)>> {
    let name = |one: &Steady| network(one).filter(|&(digit, sure)| sure >= NAMED && digit <= place.highest);
    steady.iter().map(name).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clock::cell::look::CELLS;

    /// What stood from `first` on, each for a tenth; `says` gives the network's digit of each, none where it does not
    /// know.
    fn steady(says: &[Option<usize>]) -> Vec<Steady> {
        let one = |(k, says): (usize, &Option<usize>)| {
            let mut log_digits = [(0.1f64).ln(); 10];
            if let Some(digit) = says {
                log_digits = [UNLIKELIEST.ln(); 10];
                log_digits[*digit] = (0.99f64).ln();
            }
            let stand = Stand { middle_s: 3.0 + 0.1 * k as f64, log_digits };
            Steady { look: Look::of([0.0; CELLS]), stands: vec![stand] }
        };
        says.iter().enumerate().map(one).collect()
    }

    fn tenths() -> Place {
        places(&ClockFormat::parse("ss.t").unwrap())[2]
    }

    #[test]
    fn the_order_names_what_the_network_does_not_know_or_mistakes() {
        let says = [Some(8), Some(9), None, Some(1), Some(2), Some(8), Some(4)];
        let names = by_order(&steady(&says), tenths()).unwrap();
        let digits: Vec<u8> = names.iter().map(|name| name.unwrap().0).collect();
        assert_eq!(digits, [8, 9, 0, 1, 2, 3, 4]);
        // Alone each has what the network is sure of.
        let alone = one_by_one(&steady(&says), tenths());
        assert_eq!(alone[2], None);
        assert_eq!(alone[1].map(|(digit, _)| digit), Some(9));
    }

    #[test]
    fn stands_that_are_seen_in_part_don_t_shift_the_others() {
        // Irregular frames: the first stand is its end only, the third one's end was not seen, the seventh not at all.
        let middles = [0.015, 0.152, 0.266, 0.349, 0.455, 0.556, 0.745, 0.845, 0.941];
        let digits = [0, 1, 2, 3, 4, 5, 7, 8, 9];
        let mut looks = steady(&digits.map(Some));
        for (look, middle) in looks.iter_mut().zip(middles) {
            look.stands[0].middle_s = middle;
        }
        let named = |looks: &[Steady]| -> Vec<Option<u8>> {
            by_order(looks, tenths()).unwrap().iter().map(|name| name.map(|(digit, _)| digit)).collect()
        };
        assert_eq!(named(&looks), digits.map(|digit| Some(digit as u8)));
        // What the network does not know and phases don't agree on stays unknown, and takes no other digit's name.
        looks[2].stands[0].log_digits = [(0.1f64).ln(); 10];
        let names = named(&looks);
        assert!(names[2].is_none_or(|digit| digit == 2) && names[3] == Some(3), "{names:?}");
    }

    #[test]
    fn no_order_is_seen_where_there_is_none() {
        assert_eq!(by_order(&steady(&[Some(8), Some(9), Some(0)]), tenths()), None);
        assert_eq!(by_order(&steady(&[None; 6]), tenths()), None);
        let jumble = [Some(3), Some(3), Some(7), Some(1), Some(0), Some(9)];
        assert_eq!(by_order(&steady(&jumble), tenths()), None);
        assert_eq!(by_order(&[], tenths()), None);
    }

    #[test]
    fn places_count_their_own_time() {
        let places = places(&ClockFormat::parse("mm:ss.t").unwrap());
        assert_eq!(places.iter().map(|place| place.highest).collect::<Vec<_>>(), [9, 9, 5, 9, 9]);
        assert!((places[2].step_s - 10.0).abs() < 1e-12 && (places[4].step_s - 0.1).abs() < 1e-12);
    }
}
