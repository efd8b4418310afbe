//! How far two courses of a force are apart, whatever their pace: dynamic time warping.
//!
//! In: two courses at even times of one period. Out: the mean distance along the path that brings them together best,
//! newtons. The path takes a step of one or both at a time, begins and ends with both, and stays within a band about
//! the straight way (Sakoe and Chiba 1978, DOI 10.1109/TASSP.1978.1163055: their band; all steps weigh one here, and
//! the sum is divided by the number of steps). Memory is two rows of the band.

use super::force::{Force, Row, whole_steps};

/// Courses of more points are not warped.
pub const MOST_POINTS: usize = 2048;
/// More than this share of unknown points, and a course is not known (assumed).
const UNKNOWN: f64 = 0.05;

/// The force at even times between `from_s` and `to_s`; none where too much of it is not known. What little is not
/// known is passed over. A finger that a gate says is lifted presses with 0 N here.
#[must_use]
pub fn resampled(force: &Force, from_s: f64, to_s: f64, period_s: f64) -> Option<Vec<f64>> {
    let points = whole_steps(to_s - from_s, period_s) + 1.0;
    if !(1.0..=MOST_POINTS as f64).contains(&points) {
        return None;
    }
    let longest_s = force.longest_step_s();
    let level = |row: usize| match force.row(row) {
        Row::Known(force_n) => Some(force_n),
        Row::Lifted => Some(0.0),
        Row::Unknown => None,
    };
    let at = |time_s: f64| {
        let after = force.time_s.partition_point(|row_s| *row_s < time_s);
        if force.time_s.get(after) == Some(&time_s) {
            return level(after);
        }
        let before = after.checked_sub(1)?;
        let (from_s, to_s) = (force.time_s[before], *force.time_s.get(after)?);
        let (from_n, to_n) = (level(before)?, level(after)?);
        (to_s - from_s <= longest_s).then(|| from_n + (time_s - from_s) / (to_s - from_s) * (to_n - from_n))
    };
    let known: Vec<f64> = (0..points as usize).filter_map(|k| at(from_s + k as f64 * period_s)).collect();
    (known.len() as f64 >= (1.0 - UNKNOWN) * points).then_some(known)
}

/// The mean distance along the best path between two courses; `band`: how far it may stray from the straight way, as a
/// share of the longer course. None of an empty or unknown course, or one of more than [`MOST_POINTS`].
#[must_use]
pub fn distance(one: &[f64], other: &[f64], band: f64) -> Option<f64> {
    let (n, m) = (one.len(), other.len());
    let possible = (1..=MOST_POINTS).contains(&n) && (1..=MOST_POINTS).contains(&m);
    if !possible || !one.iter().chain(other).all(|value| value.is_finite()) {
        return None;
    }
    let slope = (m.max(2) - 1) as f64 / (n.max(2) - 1) as f64;
    // A path has to be able to climb to the next row's band, whatever the share.
    let half = (band * n.max(m) as f64).max(slope).max(1.0);
    let unreached = (f64::INFINITY, 0u32);
    let (mut before, mut row) = (vec![unreached; m + 1], vec![unreached; m + 1]);
    before[0] = (0.0, 0);
    for (i, value) in one.iter().enumerate() {
        row.fill(unreached);
        let straight = if n == 1 { 0.5 * (m - 1) as f64 } else { i as f64 * slope };
        let half = if n == 1 || m == 1 { n.max(m) as f64 } else { half };
        let (low, high) = ((straight - half).ceil().max(0.0) as usize, ((straight + half) as usize).min(m - 1));
        for j in low..=high {
            // Of equal costs the step of both.
            let (mut cost, mut steps) = before[j];
            for other in [before[j + 1], row[j]] {
                if other.0 < cost {
                    (cost, steps) = other;
                }
            }
            row[j + 1] = (cost + (value - other[j]).abs(), steps + 1);
        }
        std::mem::swap(&mut before, &mut row);
    }
    let (cost, steps) = before[m];
    let mean = cost / f64::from(steps);
    mean.is_finite().then_some(mean)
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    /// The least cost of all paths, by trying each.
    fn least_cost(one: &[f64], other: &[f64]) -> f64 {
        let own = (one[0] - other[0]).abs();
        let tails = [(1, 1), (1, 0), (0, 1)].into_iter().filter(|(i, j)| *i < one.len() && *j < other.len());
        let rest = tails.map(|(i, j)| least_cost(&one[i..], &other[j..])).fold(f64::INFINITY, f64::min);
        if one.len() == 1 && other.len() == 1 { own } else { own + rest }
    }

    #[test]
    fn it_is_the_best_of_all_paths() {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let mut compared = 0;
        for _ in 0..300 {
            let [n, m] = [random.random_range(1..8), random.random_range(1..8)];
            let mut course = |points: usize| (0..points).map(|_| random.random::<f64>()).collect::<Vec<_>>();
            let (one, other) = (course(n), course(m));
            let (mean, cost) = (distance(&one, &other, 1.0).unwrap(), least_cost(&one, &other));
            // The number of steps of the best path lies between the longer and both together.
            let steps = cost / mean;
            assert!((steps - steps.round()).abs() <= 1e-9, "{one:?} {other:?}");
            assert!((n.max(m)..n + m).contains(&(steps.round() as usize)));
            compared += 1;
        }
        assert_eq!(compared, 300);
    }

    #[test]
    fn pace_does_not_matter_and_force_does() {
        let press = |rows: usize| -> Vec<f64> {
            (0..=rows).map(|k| 2.0 * (std::f64::consts::PI * k as f64 / rows as f64).sin()).collect()
        };
        assert_eq!(distance(&press(100), &press(100), 0.1), Some(0.0));
        let slower = distance(&press(100), &press(150), 0.1).unwrap();
        assert!(slower <= 0.02, "{slower}");
        let harder: Vec<f64> = press(100).iter().map(|force_n| 1.5 * force_n).collect();
        assert!(distance(&press(100), &harder, 0.1).unwrap() > 5.0 * slower);
        // Held at 1 N against held at 3 N: 2 N at each step.
        assert_eq!(distance(&[1.0; 40], &[3.0; 60], 0.1), Some(2.0));
        // Two presses that are further apart than the band lets warp.
        let shifted =
            |at: usize| (0..100).map(|k| if (at..at + 5).contains(&k) { 1.0 } else { 0.0 }).collect::<Vec<_>>();
        assert_eq!(distance(&shifted(20), &shifted(28), 0.1), Some(0.0));
        assert!(distance(&shifted(20), &shifted(70), 0.1).unwrap() > 0.05);
    }

    #[test]
    fn the_narrowest_band_still_reaches_the_end() {
        for (n, m) in [(1, 1), (1, 50), (50, 1), (2, 2048), (2048, 2), (3, 100), (100, 3), (7, 2048)] {
            assert_eq!(distance(&vec![1.0; n], &vec![1.5; m], 0.0), Some(0.5), "{n} {m}");
        }
    }

    #[test]
    fn what_is_not_known_has_no_distance() {
        assert_eq!(distance(&[], &[1.0], 0.1), None);
        assert_eq!(distance(&[f64::NAN], &[1.0], 0.1), None);
        assert_eq!(distance(&vec![1.0; MOST_POINTS + 1], &[1.0], 0.1), None);
    }

    #[test]
    fn a_course_is_the_line_between_rows() {
        let mut force = Force {
            time_s: (0..101).map(|k| 0.1 * f64::from(k)).collect(),
            force_n: (0..101).map(f64::from).collect(),
            lifted: Vec::new(),
        };
        let course = resampled(&force, 1.0, 9.0, 0.05).unwrap();
        assert_eq!(course.len(), 161);
        assert!(course.iter().enumerate().all(|(k, force_n)| (force_n - 10.0 - 0.5 * k as f64).abs() <= 1e-9));
        force.force_n[50] = f64::NAN;
        assert!(resampled(&force, 1.0, 9.0, 0.05).unwrap().len() < 161);
        force.force_n[50..60].fill(f64::NAN);
        assert_eq!(resampled(&force, 1.0, 9.0, 0.05), None);
        assert_eq!(resampled(&force, 1.0, 9.0, 1e-5), None);
    }
}
