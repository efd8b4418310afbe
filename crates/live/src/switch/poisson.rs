//! How many an hour: a count's rate with its exact interval.
//!
//! Garwood's interval (1936, DOI 10.1093/biomet/28.3-4.437): of a count k in h hours, from chi2(0.025, 2k) / 2h to
//! chi2(0.975, 2k + 2) / 2h. Where nothing was counted the interval is one-sided, up to -ln(0.05) / h: nothing in 12
//! minutes means up to 15 an hour, not none.

use serde::Serialize;
use statrs::function::gamma::{gamma_lr, gamma_ur};

/// The share that intervals hold.
const LEVEL: f64 = 0.95;

/// A recording's time is looked at in so many equal parts (assumed: a minute of half an hour).
pub const PARTS: usize = 30;
/// Counts of parts are heaped where they differ as much by chance in less than this share of cases. That is as
/// chi-squared has it; of 3 to 300 events at random times 0.2 to 1.0 % are called so (*measured*, 20,000 draws each).
const BY_CHANCE: f64 = 0.002;
/// Fewer events say nothing of it: of two every thirtieth pair is in one part.
const FEWEST: u64 = 3;

/// A rate with its interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Rate {
    /// An hour.
    pub per_hour: f64,
    /// The least that agrees with the count.
    pub low: f64,
    /// The most that agrees with it.
    pub high: f64,
}

/// A count's rate; nothing is known without time.
#[must_use]
pub fn rate_per_hour(count: u64, hours: f64) -> Option<Rate> {
    if !(hours > 0.0 && hours.is_finite()) {
        return None;
    }
    let tail = 0.5 * (1.0 - LEVEL);
    let k = count as f64;
    let (low, high) =
        if count == 0 { (0.0, -(1.0 - LEVEL).ln()) } else { (mean_below(k, tail), mean_below(k + 1.0, 1.0 - tail)) };
    Some(Rate { per_hour: k / hours, low: low / hours, high: high / hours })
}

/// How much more counts of recordings differ than chance alone makes them: chi-squared over its degrees of freedom, no
/// less than 1; 1 of fewer than three recordings, or without any count. Each is a count and its hours.
#[must_use]
pub fn dispersion(recordings: &[(u64, f64)]) -> f64 {
    let known = || recordings.iter().filter(|(_, hours)| *hours > 0.0);
    let (count, hours) = known().fold((0.0, 0.0), |(count, hours), one| (count + one.0 as f64, hours + one.1));
    let others = known().count() as f64 - 1.0;
    if others < 2.0 || count == 0.0 {
        return 1.0;
    }
    let squares = known().map(|one| {
        let expected = count / hours * one.1;
        (one.0 as f64 - expected).powi(2) / expected
    });
    (squares.sum::<f64>() / others).max(1.0)
}

/// How much more counts of equal parts of a recording differ than chance alone makes them, where it hardly does in any
/// of so many recordings; otherwise 1.
#[must_use]
pub fn heaping(parts: &[u64; PARTS], recordings: usize) -> f64 {
    let count: u64 = parts.iter().sum();
    if count < FEWEST {
        return 1.0;
    }
    let (expected, others) = (count as f64 / PARTS as f64, (PARTS - 1) as f64);
    let squares: f64 = parts.iter().map(|&one| (one as f64 - expected).powi(2) / expected).sum();
    if squares <= others {
        return 1.0;
    }
    let chance = gamma_ur(0.5 * others, 0.5 * squares) * recordings as f64;
    if chance < BY_CHANCE { squares / others } else { 1.0 }
}

/// The rate of several recordings: false switches come in heaps where one day's sensor sits worse than another's, or
/// the nail is knocked for a minute, and then the interval is as much `wider` as they differ more than by chance
/// ([`dispersion`], [`heaping`]; quasi-Poisson: McCullagh, Nelder 1989, 6.2).
#[must_use]
pub fn rate_of(recordings: &[(u64, f64)], wider: f64) -> Option<Rate> {
    let (count, hours) = recordings.iter().fold((0, 0.0), |(count, hours), one| (count + one.0, hours + one.1));
    let exact = rate_per_hour(count, hours)?;
    if wider <= 1.0 || count == 0 {
        return Some(exact);
    }
    let (k, tail) = (count as f64 / wider, 0.5 * (1.0 - LEVEL));
    let end = |shape: f64, share: f64| wider * mean_below(shape, share) / hours;
    Some(Rate { low: end(k, tail), high: end(k + 1.0, 1.0 - tail), ..exact })
}

/// The x with P(shape, x) = share, P the regularized lower incomplete gamma function: by halving, as it grows with x.
fn mean_below(shape: f64, share: f64) -> f64 {
    let (mut low, mut high) = (0.0, shape + 10.0 * shape.sqrt() + 10.0);
    // Each halving is a bit of 53, and some more for small values.
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if gamma_lr(shape, middle) < share { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, Poisson};

    use super::*;

    #[test]
    fn intervals_are_those_of_the_tables() {
        // Garwood's table, two-sided 95 %.
        for (count, low, high) in [(1, 0.0253, 5.572), (2, 0.2422, 7.225), (5, 1.6235, 11.668), (100, 81.36, 121.63)] {
            let rate = rate_per_hour(count, 1.0).unwrap();
            assert!((rate.low - low).abs() <= 1e-4 * low.max(1.0), "{count}: {rate:?}");
            assert!((rate.high - high).abs() <= 1e-4 * high, "{count}: {rate:?}");
        }
        let none = rate_per_hour(0, 0.2).unwrap();
        assert!(none.per_hour == 0.0 && none.low == 0.0 && (none.high - 14.979).abs() <= 1e-3, "{none:?}");
        assert_eq!(rate_per_hour(3, 0.0), None);
        assert_eq!(rate_per_hour(3, f64::NAN), None);
    }

    #[test]
    fn heaps_widen_the_interval_and_chance_does_not() {
        let even = [(4, 1.0), (5, 1.0), (3, 1.0), (4, 1.0)];
        assert_eq!((dispersion(&even), rate_of(&even, 1.0)), (1.0, rate_per_hour(16, 4.0)));
        let heap = [(16, 1.0), (0, 1.0), (0, 1.0), (0, 1.0)];
        // (12^2 + 3 x 4^2) / 4 / 3.
        assert!((dispersion(&heap) - 16.0).abs() <= 1e-12);
        let (wide, exact) = (rate_of(&heap, dispersion(&heap)).unwrap(), rate_per_hour(16, 4.0).unwrap());
        // One event of 16: 0.025 to 5.57 of them.
        assert!((wide.low - 4.0 * 0.0253).abs() <= 1e-3 && (wide.high - 4.0 * 5.572).abs() <= 1e-2, "{wide:?}");
        assert!(wide.per_hour == exact.per_hour && wide.low < exact.low && wide.high > exact.high);
        // Of two recordings nothing is known of how they differ.
        assert_eq!(dispersion(&heap[..2]), 1.0);
        assert_eq!(rate_of(&[(0, 1.0); 5], 1.0), rate_per_hour(0, 5.0));
    }

    /// The counts of parts of times that are shares of a recording.
    fn parts(times: impl IntoIterator<Item = f64>) -> [u64; PARTS] {
        let mut parts = [0; PARTS];
        times.into_iter().for_each(|time| parts[(time * PARTS as f64) as usize] += 1);
        parts
    }

    #[test]
    fn times_by_chance_are_no_heaps() {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        for count in [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 12, 15, 20, 30, 50, 100, 300] {
            let draws = 20_000;
            let heaped = (0..draws).filter(|_| heaping(&parts((0..count).map(|_| random.random())), 1) > 1.0).count();
            let share = heaped as f64 / f64::from(draws);
            println!("{count}: {:.2} %", 100.0 * share);
            assert!(share <= 0.013, "{count}: {share}");
        }
    }

    #[test]
    fn intervals_of_heaps_hold_the_truth_more_often() {
        // In each hour eight minutes in which the nail is knocked ten times, in the mean.
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let (mut exact_held, mut held) = (0, 0);
        let draws = 2000;
        for _ in 0..draws {
            let mut times = Vec::new();
            for _ in 0..Poisson::new(8.0).unwrap().sample(&mut random) as usize {
                let from: f64 = random.random();
                let knocks = Poisson::new(10.0).unwrap().sample(&mut random) as usize;
                times.extend((0..knocks).map(|_| (from + random.random::<f64>() / 60.0) % 1.0));
            }
            let one = [(times.len() as u64, 1.0)];
            let holds = |wider| rate_of(&one, wider).is_some_and(|rate| (rate.low..=rate.high).contains(&80.0));
            exact_held += usize::from(holds(1.0));
            held += usize::from(holds(heaping(&parts(times), 1)));
        }
        println!("{exact_held} and {held} of {draws}");
        assert!(10 * exact_held <= 6 * draws && 100 * held >= 85 * draws, "{exact_held}, {held}");
        // As even as can be, and one heap of three recordings.
        assert_eq!(heaping(&[2; PARTS], 1), 1.0);
        let mut heap = [0; PARTS];
        heap[7] = 48;
        assert!((heaping(&heap, 3) - 48.0).abs() <= 1e-9);
    }

    #[test]
    fn intervals_hold_the_truth() {
        // The exact probability that the interval holds a true mean, from the counts' own probabilities.
        for mean in [0.3, 1.0, 2.7, 8.0, 40.0] {
            let (mut held, mut probability) = (0.0, f64::exp(-mean));
            for count in 0..400u64 {
                let rate = rate_per_hour(count, 1.0).unwrap();
                held += if (rate.low..=rate.high).contains(&mean) { probability } else { 0.0 };
                probability *= mean / (count + 1) as f64;
            }
            assert!(held >= 0.949, "{mean}: {held}");
        }
    }
}
