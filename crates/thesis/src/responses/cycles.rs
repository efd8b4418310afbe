//! Cycles of a driving signal, found from the signal itself (3.3: five at 0.05 Hz, six at 0.1 Hz, as people do them).
//!
//! In: time and a force or angle that goes up and down. Out: its legs, rising and falling in turn, each from one
//! turning point to the next. A turning point is where the signal comes back by half of its range; so neither noise nor
//! a halting hand makes one. A leg counts where it covers [`WHOLE`] of the range and no gap in time; the others are cut
//! off, and counted as such. Nothing is said of the time before the first and after the last turn.

use std::ops::Range;

/// A leg counts where it covers this share of the signal's range.
pub(super) const WHOLE: f64 = 0.8;
/// A signal comes back by this share of its range where it turns.
const TURN: f64 = 0.5;
/// Of the mean squared step from row to row over the variance: 2 for noise, nearly 0 for what moves slowly.
const NOISE: f64 = 0.5;
/// A leg with a gap of more than this share of its time is cut off.
const GAP: f64 = 0.2;
/// A cycle lacks up to this share of itself and is whole all the same.
const SLACK: f64 = 0.1;
/// The range lies between these shares of the rows, so that a slip at one end is excluded.
const ENDS: [f64; 2] = [0.02, 0.98];

/// A way from one turning point to the next.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Leg {
    /// Its rows, both turning points among them.
    pub(crate) rows: Range<usize>,
    /// Whether the signal rises.
    pub(crate) rising: bool,
}

/// What goes up and down.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Cycles {
    /// Whole legs in the order of time.
    pub(crate) legs: Vec<Leg>,
    /// Legs that are not whole.
    pub(crate) cut: usize,
    /// What the signal goes besides whole legs, at its beginning and end above all, in whole ones.
    pub(crate) parts: f64,
    /// The signal's range, without slips; none where nothing is known.
    pub(crate) range: Option<[f64; 2]>,
}

impl Cycles {
    /// Finds the cycles. Times that are missing, or signals that are, are passed over.
    #[must_use]
    pub(crate) fn of(time_s: &[f64], drive: &[f64]) -> Self {
        let known: Vec<usize> = (0..drive.len().min(time_s.len()))
            .filter(|&row| drive[row].is_finite() && time_s[row].is_finite())
            .collect();
        let Some(range) = range(known.iter().map(|&row| drive[row]).collect()) else { return Self::default() };
        let mut found = Self { range: Some(range), ..Self::default() };
        let width = range[1] - range[0];
        if width <= 1e-9 * range[0].abs().max(range[1].abs()) || is_noise(&known, drive) {
            return found;
        }
        let turns = turns(&known, drive, TURN * width);
        if let (Some(&first), Some(&last)) = (turns.first(), turns.last()) {
            let way = |from: usize, to: usize| ((drive[to] - drive[from]).abs() / width).min(1.0);
            found.parts = way(known[0], first) + way(last, known[known.len() - 1]);
        }
        for pair in turns.windows(2) {
            let rows = pair[0]..pair[1] + 1;
            let moved = drive[pair[1]] - drive[pair[0]];
            let gap = has_gap(&known, time_s, &rows);
            if moved.abs() >= WHOLE * width && !gap {
                found.legs.push(Leg { rows, rising: moved > 0.0 });
            } else {
                found.cut += 1;
                found.parts += if gap { 0.0 } else { moved.abs() / width };
            }
        }
        found
    }

    /// How many whole cycles: there and back, in whatever part of it the signal begins.
    #[must_use]
    pub(crate) fn count(&self) -> usize {
        (0.5 * (self.legs.len() as f64 + self.parts) + SLACK) as usize
    }

    /// Cycles a second, from the legs' mean duration; none without legs.
    #[must_use]
    pub(crate) fn rate_hz(&self, time_s: &[f64]) -> Option<f64> {
        let spent: f64 = self.legs.iter().map(|leg| time_s[leg.rows.end - 1] - time_s[leg.rows.start]).sum();
        (spent > 0.0).then(|| self.legs.len() as f64 / (2.0 * spent))
    }
}

/// Where most of the values lie.
fn range(mut values: Vec<f64>) -> Option<[f64; 2]> {
    values.sort_by(f64::total_cmp);
    let last = values.len().checked_sub(1)?;
    Some(ENDS.map(|share| values[(share * last as f64).round() as usize]))
}

fn is_noise(known: &[usize], drive: &[f64]) -> bool {
    let n = known.len() as f64;
    let mean = known.iter().map(|&row| drive[row]).sum::<f64>() / n;
    let variance = known.iter().map(|&row| (drive[row] - mean).powi(2)).sum::<f64>() / n;
    let steps = known.windows(2).map(|pair| (drive[pair[1]] - drive[pair[0]]).powi(2)).sum::<f64>() / n;
    steps > NOISE * variance
}

/// Rows where the signal turns, and the farthest before the first and after the last turn.
fn turns(known: &[usize], drive: &[f64], back: f64) -> Vec<usize> {
    let mut turns = Vec::new();
    let Some((&first, rest)) = known.split_first() else { return turns };
    let (mut lowest, mut highest) = (first, first);
    // None as long as it is not known where the signal goes first.
    let mut rising: Option<bool> = None;
    for &row in rest {
        if drive[row] < drive[lowest] {
            lowest = row;
        }
        if drive[row] > drive[highest] {
            highest = row;
        }
        let (fell, rose) = (drive[highest] - drive[row] >= back, drive[row] - drive[lowest] >= back);
        if rising != Some(false) && fell {
            turns.push(highest);
            (rising, lowest) = (Some(false), row);
        } else if rising != Some(true) && rose {
            turns.push(lowest);
            (rising, highest) = (Some(true), row);
        }
    }
    match rising {
        Some(true) => turns.push(highest),
        Some(false) => turns.push(lowest),
        None => {}
    }
    turns
}

/// Whether time stands still for long, or goes back, within these rows.
fn has_gap(known: &[usize], time_s: &[f64], rows: &Range<usize>) -> bool {
    let longest = GAP * (time_s[rows.end - 1] - time_s[rows.start]);
    let from = known.partition_point(|&row| row < rows.start);
    let own = known[from..].iter().take_while(|&&row| row < rows.end);
    let times: Vec<f64> = own.map(|&row| time_s[row]).collect();
    times.windows(2).any(|pair| pair[1] < pair[0] || pair[1] - pair[0] > longest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn times(rows: usize) -> Vec<f64> {
        (0..rows).map(|k| k as f64 / 12.5).collect()
    }

    /// Cycles and legs of a drive.
    fn counts(rows: usize, drive: impl Fn((usize, &f64)) -> f64) -> (usize, usize) {
        let time_s = times(rows);
        let found = Cycles::of(&time_s, &time_s.iter().enumerate().map(drive).collect::<Vec<_>>());
        (found.count(), found.legs.len())
    }

    /// Small disorder, the same each time.
    fn shake(k: usize) -> f64 {
        (k as f64 * 12.9898).sin() * 43758.547 % 1.0
    }

    #[test]
    fn five_slow_presses_are_five_cycles() {
        let time_s = times(1250);
        let drive: Vec<f64> =
            time_s.iter().enumerate().map(|(k, t)| -2.0 + 2.0 * (TAU * 0.05 * t).cos() + 0.05 * shake(k)).collect();
        let found = Cycles::of(&time_s, &drive);
        assert_eq!((found.count(), found.cut), (5, 0));
        assert!(found.legs.iter().zip(found.legs.iter().skip(1)).all(|(a, b)| a.rising != b.rising));
        assert!((found.rate_hz(&time_s).unwrap() - 0.05).abs() < 0.002);
    }

    #[test]
    fn rests_before_and_after_and_drift_make_no_cycles() {
        let rests =
            |t: f64| if (20.0..80.0).contains(&t) { 40.0 - 50.0 * (TAU * 0.1 * (t - 20.0)).cos() } else { -10.0 };
        assert_eq!(counts(1500, |(_, &t)| rests(t) + 0.05 * t).0, 6);
    }

    #[test]
    fn what_does_not_move_and_noise_have_no_cycle() {
        let time_s = times(500);
        let noise: Vec<f64> = (0..500).map(|k| -3.0 + 0.01 * shake(k)).collect();
        for drive in [vec![2.0; 500], noise, vec![f64::NAN; 500], (0..500).map(f64::from).collect()] {
            assert_eq!(Cycles::of(&time_s, &drive).count(), 0);
        }
        assert_eq!(Cycles::of(&[], &[]), Cycles::default());
    }

    #[test]
    fn a_sine_of_five_cycles_has_five_though_only_nine_ways_are_whole() {
        assert_eq!(counts(1251, |(k, t)| 2.0 * (TAU * 0.05 * t).sin() + 0.05 * shake(k)), (5, 9));
    }

    #[test]
    fn one_cycle_and_a_half_one_are_distinguished() {
        let once = |t: f64| if t < 20.0 { (TAU * 0.05 * t).cos() } else { 1.0 - 0.03 * (t - 20.0) };
        assert_eq!(counts(400, |(_, &t)| once(t)), (1, 2));
    }

    #[test]
    fn a_leg_with_a_gap_is_cut_off_and_missing_rows_are_passed_over() {
        let mut time_s = times(1250);
        let mut drive: Vec<f64> = time_s.iter().map(|t| (TAU * 0.05 * t).cos()).collect();
        drive.iter_mut().step_by(7).for_each(|value| *value = f64::NAN);
        assert_eq!(Cycles::of(&time_s, &drive).count(), 5);
        time_s.iter_mut().skip(180).for_each(|time_s| *time_s += 30.0);
        let found = Cycles::of(&time_s, &drive);
        assert_eq!((found.legs.len(), found.cut), (9, 1));
    }
}
