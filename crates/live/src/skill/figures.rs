//! What a finger did in a trial.

use std::ops::Range;

use serde::Serialize;

use super::contact::Contact;
use super::force::{Force, Row, whole_steps};
use super::smooth::{MOST_SAMPLES, low_passed, spectral_arc_length};
use super::{Thresholds, contacts};
use crate::spread::Spread;

/// Figures of one finger in one trial.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Figures {
    /// The time of which it is known whether the finger presses, seconds.
    pub known_s: f64,
    /// The time of which it is not, seconds: gaps and unknown rows.
    pub unknown_s: f64,
    /// Contacts whose beginning was seen; none where nothing is known.
    pub presses: Option<usize>,
    /// Contacts of which an end was not seen: it lies in a gap, or before or after the trial.
    pub cut: usize,
    /// Time in contact, seconds; none where nothing is known.
    pub contact_s: Option<f64>,
    /// The largest force in contact, newtons; none without contact.
    pub peak_n: Option<f64>,
    /// The mean force in contact over time, newtons; none without contact.
    pub mean_n: Option<f64>,
    /// The integral of the force over the time in contact, newton seconds; none where nothing is known.
    pub impulse_ns: Option<f64>,
    /// The fastest rise of the force between two rows, newtons a second; none without contact.
    pub peak_rise_n_per_s: Option<f64>,
    /// The mean over whole presses of the spectral arc length of the size of the force's rate; none where no press is
    /// long enough.
    pub smoothness: Option<f64>,
    /// The mean over those presses of the fastest change of the force, less its noise, newtons a second: what noise is
    /// seen against.
    #[serde(skip)]
    pub fastest_n_per_s: Option<f64>,
    /// When the first contact began, seconds; none where there is none, or its beginning was not seen.
    pub first_s: Option<f64>,
}

impl Figures {
    /// Of a finger, with its contacts.
    #[must_use]
    pub fn of(force: &Force, thresholds: &Thresholds) -> (Self, Vec<Contact>) {
        let found = contacts(force, thresholds);
        let (known_s, unknown_s) = (force.known_s(), force.unknown_s());
        let known = known_s > 0.0;
        let sums: Vec<[f64; 2]> = found.iter().map(|contact| sum(force, contact, thresholds)).collect();
        // `sum` of nothing is -0, which nobody wants to read.
        let [impulse_ns, summed_s] = [0, 1].map(|k| sums.iter().fold(0.0, |total, of| total + of[k]));
        let pressed = found.iter().flat_map(|contact| contact.rows.clone());
        let peak_n = pressed.filter_map(|row| known_force(force, row)).reduce(f64::max);
        let rises = found.iter().flat_map(|contact| rises(force, contact));
        let longest_s = force.longest_step_s();
        let whole = (0..found.len()).filter(|&k| found[k].begin_seen && found[k].end_seen);
        let smooth: Vec<[f64; 2]> = whole.filter_map(|k| smoothness(force, &found, k, longest_s)).collect();
        let [smooth, fastest] = [0, 1].map(|k| Spread::of(smooth.iter().map(|one| one[k])));
        let figures = Self {
            known_s,
            unknown_s,
            presses: known.then(|| found.iter().filter(|contact| contact.begin_seen).count()),
            cut: found.iter().filter(|contact| !(contact.begin_seen && contact.end_seen)).count(),
            contact_s: known.then(|| found.iter().fold(0.0, |total, contact| total + (contact.to_s - contact.from_s))),
            peak_n,
            mean_n: (summed_s > 0.0).then(|| impulse_ns / summed_s),
            impulse_ns: known.then_some(impulse_ns),
            peak_rise_n_per_s: rises.reduce(f64::max),
            smoothness: smooth.map(|smooth| smooth.mean),
            fastest_n_per_s: fastest.map(|fastest| fastest.mean),
            first_s: found.first().filter(|first| first.begin_seen).map(|first| first.from_s),
        };
        (figures, found)
    }
}

fn known_force(force: &Force, row: usize) -> Option<f64> {
    match force.row(row) {
        Row::Known(force_n) => Some(force_n),
        _ => None,
    }
}

/// Neighbouring rows of a contact with known forces, as `[from_s, from_n, to_s, to_n]`.
fn lines<'a>(force: &'a Force, contact: &Contact) -> impl Iterator<Item = [f64; 4]> + use<'a> {
    let rows = contact.rows.clone();
    (rows.start + 1..rows.end).filter_map(|row| {
        let (from_n, to_n) = (known_force(force, row - 1)?, known_force(force, row)?);
        Some([force.time_s[row - 1], from_n, force.time_s[row], to_n])
    })
}

/// The integral of the force over a contact, newton seconds, and the time that it is taken over, seconds.
fn sum(force: &Force, contact: &Contact, thresholds: &Thresholds) -> [f64; 2] {
    let (first, last) = (contact.rows.start, contact.rows.end - 1);
    let area = |[from_s, from_n, to_s, to_n]: [f64; 4]| [0.5 * (from_n + to_n) * (to_s - from_s), to_s - from_s];
    // From the crossing of a threshold to the next row, and from the last row to the other.
    let ends = [
        [contact.from_s, thresholds.touch_n, force.time_s[first], force.force_n[first]],
        [force.time_s[last], force.force_n[last], contact.to_s, thresholds.release_n],
    ];
    let all = lines(force, contact).chain(ends).map(area);
    all.fold([0.0; 2], |sums, one| [sums[0] + one[0], sums[1] + one[1]])
}

/// How fast the force rises from row to row, from the row before the contact on.
fn rises<'a>(force: &'a Force, contact: &Contact) -> impl Iterator<Item = f64> + use<'a> {
    let first = contact.rows.start;
    let before = (contact.from_s < force.time_s[first]).then(|| first.checked_sub(1)).flatten();
    let onset = before.and_then(|row| {
        Some([force.time_s[row], known_force(force, row)?, force.time_s[first], known_force(force, first)?])
    });
    onset
        .into_iter()
        .chain(lines(force, contact))
        .map(|[from_s, from_n, to_s, to_n]| (to_n - from_n) / (to_s - from_s))
        .filter(|rise| rise.is_finite())
}

/// A press begins and ends where its rate is below this share of its fastest: as the field has the beginning of a
/// movement. Thresholds cut more of a weak press: of one course, presses of 0.5 N were 0.77 less smooth than of 20 N.
const ONSET: f64 = 0.05;
/// It is looked for so long before and after the contact, seconds (assumed).
pub(super) const AROUND_S: f64 = 0.3;

/// The smoothness of contact `k`, and its fastest change, newtons a second.
fn smoothness(force: &Force, contacts: &[Contact], k: usize, longest_s: f64) -> Option<[f64; 2]> {
    let own = &contacts[k].rows;
    let rows = around(force, contacts, k, longest_s);
    let within = Force {
        time_s: force.time_s[rows.clone()].to_vec(),
        force_n: rows.clone().map(|row| known_force(force, row)).collect::<Option<_>>()?,
        lifted: Vec::new(),
    };
    let (rate, period_s) = even_rate(&within)?;
    let from_s = within.time_s[0];
    let speed: Vec<f64> = low_passed(&rate, 1.0 / period_s).iter().map(|rate| rate.abs()).collect();
    let step = |row: usize| (whole_steps(force.time_s[row] - from_s, period_s) as usize).min(speed.len());
    let (mut begin, mut end) = (step(own.start), step(own.end - 1));
    let fastest = speed[begin..end].iter().copied().reduce(f64::max)?;
    while begin > 0 && speed[begin - 1] >= ONSET * fastest {
        begin -= 1;
    }
    while end < speed.len() && speed[end] >= ONSET * fastest {
        end += 1;
    }
    Some([spectral_arc_length(&speed[begin..end], 1.0 / period_s)?, fastest])
}

/// The rate of a force that is known throughout at even times, newtons a second, and the step between them, seconds.
pub(super) fn even_rate(force: &Force) -> Option<(Vec<f64>, f64)> {
    let period_s = force.period_s()?;
    let (from_s, to_s) = (force.time_s[0], force.time_s[force.time_s.len() - 1]);
    let samples = whole_steps(to_s - from_s, period_s) + 1.0;
    if samples > MOST_SAMPLES as f64 {
        return None;
    }
    let mut row = 0;
    let even = (0..samples as usize).map(|k| {
        let time_s = (from_s + k as f64 * period_s).min(to_s);
        while row + 2 < force.time_s.len() && force.time_s[row + 1] < time_s {
            row += 1;
        }
        let (before_s, after_s) = (force.time_s[row], force.time_s[row + 1]);
        let share = (time_s - before_s) / (after_s - before_s);
        force.force_n[row] + share * (force.force_n[row + 1] - force.force_n[row])
    });
    let even: Vec<f64> = even.collect();
    Some((even.windows(2).map(|pair| (pair[1] - pair[0]) / period_s).collect(), period_s))
}

/// The rows of contact `k` and those around it of which the force is known, without a gap, up to its neighbours.
fn around(force: &Force, contacts: &[Contact], k: usize, longest_s: f64) -> Range<usize> {
    let own = &contacts[k].rows;
    let first = k.checked_sub(1).map_or(0, |before| contacts[before].rows.end);
    let last = contacts.get(k + 1).map_or(force.time_s.len(), |after| after.rows.start);
    let time_s = &force.time_s;
    let (mut from, mut to) = (own.start, own.end);
    let goes_on = |row: usize, step_s: f64, since_s: f64| {
        known_force(force, row).is_some() && step_s <= longest_s && since_s <= AROUND_S
    };
    while from > first && goes_on(from - 1, time_s[from] - time_s[from - 1], time_s[own.start] - time_s[from - 1]) {
        from -= 1;
    }
    while to < last && goes_on(to, time_s[to] - time_s[to - 1], time_s[to] - time_s[own.end - 1]) {
        to += 1;
    }
    from..to
}

/// The order in which fingers first touched, from 1 on; fingers at one moment share a rank. None for fingers that did
/// not touch; none for all where a first touch was not seen to begin.
#[must_use]
pub fn ranks(fingers: &[(&Figures, &[Contact])]) -> Vec<Option<usize>> {
    let hidden = fingers.iter().any(|(figures, contacts)| figures.first_s.is_none() && !contacts.is_empty());
    let firsts: Vec<Option<f64>> = fingers.iter().map(|(figures, _)| figures.first_s.filter(|_| !hidden)).collect();
    let rank = |own: f64| 1 + firsts.iter().flatten().filter(|other| **other < own).count();
    firsts.iter().map(|first| first.map(rank)).collect()
}

#[cfg(test)]
mod tests;
