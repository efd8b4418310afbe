//! Whether the sensor's responses are consistent with the colour patterns (3.3.2 to 3.3.5): photodiodes' changes
//! against the changes of the maps at the photodiodes' places.
//!
//! In: the numbers of the responses (`normal.P1.change_V`, ..) and of the maps (`photos.normal.P1`, ..). Out, for each
//! of normal force, lateral and longitudinal shear and bending, and for all of them together: `<experiment>.rank`,
//! Spearman's rank correlation over the photodiodes, where there are two directions over both; and
//! `<experiment>.chance`, the share of all orders of the photodiodes over the places that reach it (an exact
//! permutation test: 1/40320 at best). Shear is photographed while the finger presses with 3 N, as it is cycled: its
//! colours change against those of normal force.
//!
//! Ranks need no scale: photographs have shares of full scale, photodiodes volts. What is not determined: whether the
//! photodiodes are where the thesis' words put them; a sensor that sits elsewhere is compared with the wrong places.

use crate::Numbers;
use lunula::nail::Positions;

/// A photodiode's change, and the two poses whose maps differ by the same movement: from, to.
type Direction = (&'static str, [&'static str; 2]);

/// By experiment: its directions.
const EXPERIMENTS: [(&str, &[Direction]); 4] = [
    ("normal", &[("pressed_V", ["nominal", "normal"])]),
    (
        "lateral",
        &[
            ("from_zero_to_low_V", ["normal", "lateral_negative"]),
            ("from_zero_to_high_V", ["normal", "lateral_positive"]),
        ],
    ),
    (
        "longitudinal",
        &[
            ("from_zero_to_low_V", ["normal", "longitudinal_negative"]),
            ("from_zero_to_high_V", ["normal", "longitudinal_positive"]),
        ],
    ),
    ("bending", &[("change_V", ["extension", "flexion"])]),
];
/// Fewer photodiodes have no order to speak of; of more, all orders are too many (8! = 40320).
const PHOTODIODES: std::ops::RangeInclusive<usize> = 4..=8;
/// Sums of products of ranks that differ by less are the same sum, added in another order.
const SAME: f64 = 1e-9;

/// Their numbers, named `colours.` by the page; what is missing is not reported.
pub(super) fn colour_numbers(numbers: &Numbers) -> Numbers {
    let mut found = Numbers::default();
    let names: Vec<String> = Positions::thesis().photodiodes.into_iter().map(|one| one.name).collect();
    let mut all: Vec<Vec<[f64; 2]>> = vec![Vec::new(); names.len()];
    for (experiment, directions) in EXPERIMENTS {
        let volts = |name: &str, of: &str| match of {
            // The curve of normal force begins at -4 N.
            "pressed_V" => numbers.get(&format!("{experiment}.{name}.change_V")).map(|change| -change),
            _ => numbers.get(&format!("{experiment}.{name}.{of}")),
        };
        let colour = |name: &str, [from, to]: [&str; 2]| {
            let of = |pose: &str| numbers.get(&format!("photos.{pose}.{name}"));
            Some(of(to)? - of(from)?)
        };
        let of = |name: &String| {
            let pair = |(of, poses): &Direction| Some([volts(name, of)?, colour(name, *poses)?]);
            directions.iter().map(pair).collect::<Option<Vec<_>>>()
        };
        let known: Vec<Option<Vec<[f64; 2]>>> = names.iter().map(of).collect();
        all.iter_mut().zip(&known).for_each(|(all, own)| all.extend(own.iter().flatten()));
        set(&mut found, experiment, known.into_iter().flatten().collect());
    }
    // Of photodiodes that were in all experiments.
    let every = EXPERIMENTS.iter().map(|(_, directions)| directions.len()).sum::<usize>();
    set(&mut found, "all", all.into_iter().filter(|own| own.len() == every).collect());
    found
}

fn set(numbers: &mut Numbers, experiment: &str, known: Vec<Vec<[f64; 2]>>) {
    if let Some([rank, chance]) = alike(&known) {
        numbers.set(format!("{experiment}.rank"), rank);
        numbers.set(format!("{experiment}.chance"), chance);
    }
}

/// Rank correlation of pairs, some of each photodiode, and the share of the photodiodes' orders that reach it.
fn alike(photodiodes: &[Vec<[f64; 2]>]) -> Option<[f64; 2]> {
    if !PHOTODIODES.contains(&photodiodes.len()) {
        return None;
    }
    let of = |k: usize| ranks(&photodiodes.iter().flatten().map(|pair| pair[k]).collect::<Vec<_>>());
    let (volts, colours) = (of(0), of(1));
    let each = photodiodes[0].len();
    let product = |order: &[usize]| -> f64 {
        let own = |(place, from): (usize, &usize)| {
            (0..each).map(|k| volts[each * place + k] * colours[each * from + k]).sum::<f64>()
        };
        order.iter().enumerate().map(own).sum()
    };
    let size = |ranks: &[f64]| ranks.iter().map(|rank| rank * rank).sum::<f64>();
    let spread = (size(&volts) * size(&colours)).sqrt();
    let mut order: Vec<usize> = (0..photodiodes.len()).collect();
    let found = product(&order);
    let (mut reached, mut all) = (0.0, 0.0);
    each_order(&mut order, 0, &mut |order| {
        all += 1.0;
        reached += f64::from(u8::from(product(order) >= found - SAME));
    });
    (spread > 0.0).then(|| [found / spread, reached / all])
}

/// Ranks less their mean; equal values share theirs.
fn ranks(values: &[f64]) -> Vec<f64> {
    let rank = |value: &f64| {
        let below = values.iter().filter(|other| *other < value).count() as f64;
        let above = values.iter().filter(|other| *other > value).count() as f64;
        0.5 * (below - above)
    };
    values.iter().map(rank).collect()
}

/// Calls `take` with every order of what is from `from` on.
fn each_order(order: &mut [usize], from: usize, take: &mut impl FnMut(&[usize])) {
    if from + 1 >= order.len() {
        return take(order);
    }
    for k in from..order.len() {
        order.swap(from, k);
        each_order(order, from + 1, take);
        order.swap(from, k);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_order_of_all_is_the_same_and_the_opposite_one_is_reached_by_all() {
        let pairs = |sign: f64| -> Vec<Vec<[f64; 2]>> {
            (0..8).map(|k| vec![[f64::from(k), sign * f64::from(k * k)]]).collect()
        };
        assert_eq!(alike(&pairs(1.0)), Some([1.0, 1.0 / 40320.0]));
        assert_eq!(alike(&pairs(-1.0)), Some([-1.0, 1.0]));
        assert_eq!(alike(&pairs(1.0)[..3]), None);
        assert_eq!(alike(&vec![vec![[1.0, 2.0]]; 5]), None);
    }

    #[test]
    fn a_rank_correlation_is_that_made_by_hand() {
        // Ranks of four with one pair swapped: 1 - 6 * 2 / (4 * 15) = 0.8; of 24 orders, 4 have 0.8 or more.
        let pairs = [[1.0, 10.0], [2.0, 30.0], [3.0, 20.0], [4.0, 40.0]].map(|pair| vec![pair]);
        let [rank, chance] = alike(&pairs).unwrap();
        assert!((rank - 0.8).abs() < 1e-12 && (chance - 4.0 / 24.0).abs() < 1e-12, "{rank} {chance}");
        // Equal values share a rank.
        assert_eq!(ranks(&[2.0, 1.0, 2.0]), [0.5, -1.0, 0.5]);
    }

    #[test]
    fn directions_of_a_photodiode_stay_together() {
        // Both directions of a photodiode go with it: 4! orders, not 8!.
        let pairs: Vec<Vec<[f64; 2]>> = (0..4).map(f64::from).map(|x| vec![[x, x], [-x - 1.0, -x - 1.0]]).collect();
        assert_eq!(alike(&pairs), Some([1.0, 1.0 / 24.0]));
    }

    #[test]
    fn shear_is_compared_with_the_colours_of_pressing() {
        let mut numbers = Numbers::default();
        for (k, value) in (1..=8).map(|k| (k, f64::from(k))) {
            for (name, size) in [("low", value), ("high", -value)] {
                numbers.set(format!("lateral.P{k}.from_zero_to_{name}_V"), size);
            }
            // Against the nominal pose the order would be turned round.
            for (pose, size) in [("normal", 9.0 * value), ("lateral_negative", 10.0 * value)] {
                numbers.set(format!("photos.{pose}.P{k}"), size);
            }
            numbers.set(format!("photos.lateral_positive.P{k}"), 8.0 * value);
        }
        let found = colour_numbers(&numbers);
        assert_eq!(found.get("lateral.rank"), Some(1.0));
        assert_eq!((found.get("normal.rank"), found.get("bending.chance")), (None, None));
    }
}
