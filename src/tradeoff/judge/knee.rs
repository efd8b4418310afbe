//! The knee of error against run time: the setting beyond which more time buys little.
//!
//! In: settings with their error and the median and quartiles of their time. Out: which of them are worth their time
//! (the front) and the knee.
//!
//! **The front.** From the fastest on, a setting is on it whose error is lower by more than [`SAME`] than that of all
//! faster ones. Settings whose times can't be distinguished, their quartiles touching or their medians within [`SAME`],
//! are one place of it, and the most exact of them stands there. A setting without a positive finite time or with an
//! error that is no number or negative has no place.
//!
//! **The knee.** Of three places or more, the one that lies farthest below the chord from the first to the last, with
//! the logarithms of both axes brought to the unit square (Satopaa et al. 2011, doi:10.1109/ICDCSW.2011.20, whose curve
//! is this one upside down), if that is at least [`BEND`]. Where there is no such bend, also of two places: the most
//! exact setting if over the whole front the error falls at least as many times as the time grows, else the cheapest.
//! Of one place: that one; nothing that costs more errs less.
//!
//! An error of exactly zero can't be bettered. For the chord it counts as a tenth of the least other error.

/// What differs by less is the same, as a share: of errors and of times.
pub const SAME: f64 = 0.05;
/// How far below the chord a bend is, as a share of the square's side.
pub const BEND: f64 = 0.1;

/// A setting's price and what it gives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cost {
    /// The median time, seconds.
    pub run_s: f64,
    /// Its lower quartile.
    pub low_s: f64,
    /// Its upper quartile.
    pub high_s: f64,
    /// How wrong, in any unit.
    pub error: f64,
}

/// Why the knee is where it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Why {
    /// Nothing that costs more errs less.
    Flat,
    /// The front bends there, so far below its chord.
    Bend(f64),
    /// No bend, and the error falls faster than the time grows: the most exact.
    Steep,
    /// No bend, and the error falls slower than the time grows: the cheapest.
    Shallow,
}

impl Why {
    /// In words.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Flat => "nothing that costs more errs less",
            Self::Bend(_) => "there the curve bends",
            Self::Steep => "no bend: the error falls faster than the time grows, so the most exact",
            Self::Shallow => "no bend: the error falls slower than the time grows, so the cheapest",
        }
    }
}

/// Where the curve of error over time bends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Knee {
    /// Its place among the settings, from 0.
    pub at: usize,
    /// Why that one.
    pub why: Why,
}

/// The settings that are worth their time, from the fastest to the most exact.
#[must_use]
pub fn front(costs: &[Cost]) -> Vec<usize> {
    let usable =
        |cost: &Cost| cost.run_s > 0.0 && cost.run_s.is_finite() && cost.error >= 0.0 && cost.error.is_finite();
    let mut order: Vec<usize> = (0..costs.len()).filter(|&k| usable(&costs[k])).collect();
    order.sort_by(|&a, &b| {
        let (a, b) = (&costs[a], &costs[b]);
        a.run_s.total_cmp(&b.run_s).then(a.error.total_cmp(&b.error))
    });
    let mut front: Vec<usize> = Vec::new();
    // How slow a setting may be to stand in the last place.
    let mut same_until_s = f64::NEG_INFINITY;
    for k in order {
        let cost = &costs[k];
        let lower =
            |other: &usize| cost.error < costs[*other].error && cost.error * (1.0 + SAME) <= costs[*other].error;
        if !front.last().is_none_or(lower) {
            continue;
        }
        if cost.low_s.min(cost.run_s / (1.0 + SAME)) <= same_until_s {
            front.pop();
        } else {
            same_until_s = cost.high_s.max(cost.run_s);
        }
        front.push(k);
    }
    front
}

/// The knee; none where no setting has a place.
#[must_use]
pub fn knee(costs: &[Cost]) -> Option<Knee> {
    let front = front(costs);
    let (&first, &last) = (front.first()?, front.last()?);
    if front.len() == 1 {
        return Some(Knee { at: first, why: Why::Flat });
    }
    let least = front.iter().map(|&k| costs[k].error).filter(|&error| error > 0.0).fold(f64::INFINITY, f64::min);
    let place = |k: usize| {
        let error = if costs[k].error > 0.0 { costs[k].error } else { 0.1 * least };
        (costs[k].run_s.ln(), error.ln())
    };
    let ((from_s, from), (to_s, to)) = (place(first), place(last));
    let (slower, better) = (to_s - from_s, from - to);
    let below = |k: usize| {
        let (run_s, error) = place(k);
        1.0 - (run_s - from_s) / slower - (error - to) / better
    };
    let inner = front[1..front.len() - 1].iter().map(|&k| (k, below(k)));
    let bend = inner.fold(None, |best: Option<(usize, f64)>, (k, depth)| match best {
        Some((_, deepest)) if deepest >= depth => best,
        _ => Some((k, depth)),
    });
    Some(match bend {
        Some((at, depth)) if depth >= BEND => Knee { at, why: Why::Bend(depth) },
        _ if better >= slower => Knee { at: last, why: Why::Steep },
        _ => Knee { at: first, why: Why::Shallow },
    })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn exact(run_s: f64, error: f64) -> Cost {
        Cost { run_s, low_s: run_s, high_s: run_s, error }
    }

    fn spread(low_s: f64, run_s: f64, high_s: f64, error: f64) -> Cost {
        Cost { run_s, low_s, high_s, error }
    }

    fn at(costs: &[Cost]) -> (usize, Why) {
        let knee = knee(costs).expect("a knee");
        (knee.at, knee.why)
    }

    #[test]
    fn nothing_has_no_knee_and_the_others_one_that_pays() {
        assert_eq!(knee(&[]), None);
        assert_eq!(at(&[exact(1.0, 2.0)]), (0, Why::Flat), "one setting is its own");
        assert_eq!(at(&[exact(1.0, 10.0), exact(2.0, 1.0)]), (1, Why::Steep), "of two the exact one has to pay");
        assert_eq!(at(&[exact(1.0, 10.0), exact(20.0, 5.0)]), (0, Why::Shallow), "of two the exact one has to pay");
        assert_eq!(at(&[exact(1.0, 10.0), exact(8.0, 1.0)]).0, 1, "ten times the time for a tenth of the error pays");
        let slope = |power: f64| [1.0_f64, 2.0, 4.0, 8.0].map(|run_s| exact(run_s, run_s.powf(-power)));
        assert_eq!(at(&slope(3.0)), (3, Why::Steep), "a straight front");
        assert_eq!(at(&slope(0.3)), (0, Why::Shallow), "a straight front");
        let other_way = [exact(1.0, 10.0), exact(4.0, 9.0), exact(5.0, 1.0)];
        assert_eq!(at(&other_way), (2, Why::Steep), "one that bends the other way");
        let constant = [exact(3.0, 1.0), exact(1.0, 1.0), exact(2.0, 1.0)];
        assert_eq!(at(&constant), (1, Why::Flat), "where the error does not fall the cheapest is the knee");
        let rises = [exact(1.0, 1.04), exact(2.0, 1.0), exact(9.0, 5.0)];
        assert_eq!(at(&rises), (0, Why::Flat), "within what counts as the same, and where it rises");
    }

    #[test]
    fn a_corner_is_the_knee() {
        let costs = [exact(1.0, 100.0), exact(1.2, 2.0), exact(100.0, 1.0)];
        let (at, why) = at(&costs);
        assert_eq!(at, 1);
        assert!(matches!(why, Why::Bend(depth) if depth > 0.8), "{why:?}");
    }

    #[test]
    fn beyond_a_floor_nothing_is_worth_its_time() {
        let floor = [exact(1.0, 1.0), exact(2.0, 1e-2), exact(4.0, 1.001e-4), exact(8.0, 1e-4), exact(16.0, 1e-4)];
        assert_eq!(front(&floor), [0, 1, 2]);
        assert_eq!(at(&floor), (2, Why::Steep));
    }

    #[test]
    fn indistinguishable_times_are_one_place() {
        // The second is slower by its median, but not by what is known of it.
        let noisy = [spread(0.8, 1.0, 1.4, 10.0), spread(1.3, 1.5, 2.0, 1.0), spread(90.0, 100.0, 110.0, 0.9)];
        assert_eq!(front(&noisy), [1, 2]);
        // With one repeat the spread is not known; a twentieth is.
        assert_eq!(front(&[exact(1.0, 10.0), exact(1.04, 1.0)]), [1]);
        assert_eq!(front(&[exact(1.0, 10.0), exact(1.1, 1.0)]), [0, 1]);
        // Each is within reach of the one before, but not of the place's first.
        let chain = [spread(0.9, 1.0, 1.2, 8.0), spread(1.1, 1.2, 1.4, 4.0), spread(1.3, 1.4, 1.6, 2.0)];
        assert_eq!(front(&chain), [1, 2]);
    }

    #[test]
    fn no_number_has_no_place_and_zero_has_one() {
        let costs =
            [exact(f64::NAN, 1.0), exact(1.0, f64::NAN), exact(0.0, 1.0), exact(1.0, -1.0), exact(1.0, f64::INFINITY)];
        assert_eq!(knee(&costs), None);
        assert_eq!(at(&[exact(1.0, 0.0), exact(2.0, 0.0)]), (0, Why::Flat));
        assert_eq!(at(&[exact(1.0, 1.0), exact(2.0, 0.0), exact(3.0, 0.0)]), (1, Why::Steep));
        assert_eq!(front(&[exact(1.0, 1.0), exact(2.0, 0.1), exact(3.0, 0.0)]), [0, 1, 2]);
    }

    proptest! {
        #[test]
        fn the_knee_is_on_the_front_whatever_the_units(
            costs in prop::collection::vec((1e-6..1e3_f64, 1e-9..1e3_f64), 1..20),
            scale in 1e-3..1e3_f64,
        ) {
            let own: Vec<Cost> = costs.iter().map(|&(run_s, error)| exact(run_s, error)).collect();
            let found = knee(&own).expect("a knee");
            let places = front(&own);
            prop_assert!(places.contains(&found.at));
            let better = |pair: &[usize]| {
                let [one, other] = [&own[pair[0]], &own[pair[1]]];
                one.run_s < other.run_s && one.error > other.error
            };
            prop_assert!(places.windows(2).all(better));
            // Powers of two change no digit.
            let unit = scale.log2().round().exp2();
            let other: Vec<Cost> = costs.iter().map(|&(run_s, error)| exact(run_s, unit * error)).collect();
            prop_assert_eq!(front(&other), places);
        }
    }
}
