//! Columns that leap in single rows and come back: missing values that are written as numbers (0, -1, -999), glitches.
//!
//! In: columns of a recording. Out: what to say where so many rows do it that they can't be a slip.
//!
//! Measured: 0 in every 101st row of a phantom's photodiodes took Fy of a model from 0.14 to 0.40 N, 0 in every 60th
//! row of a force `peak_rise` of `skill` from 3 to 107 N/s. Of 24 phantom logs (touch, bending, random; 13 channels
//! each) no row leaps so; the codes above leap by 14 to 70,000 times as much as other rows step. Forces of a finger
//! that taps do at 12.5 and 25 rows a second: from rest, and each as far as it goes.

use super::lines::order::short;
use super::naming::role::Role;
use crate::median::median_of;

/// So many rows make a fault; fewer are named as [glitches](super::doubts::glitches).
const ROWS: usize = 3;
/// A leap is so many times as long as 90 of 100 steps that are any, and has this share of the range; where it comes
/// back to, it has left, within this share of the leap; a finger that taps comes from rest so nearly.
const STEPS: f64 = 8.0;
const RANGE: f64 = 0.1;
const BACK: f64 = 0.2;
/// A tap goes no further than other presses, but for this share of their range (assumed).
const TAPS: f64 = 0.5;
/// Below so many steps nothing is said.
const LEAST_STEPS: usize = 50;

/// What a column does in single rows.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Leaps {
    name: String,
    rows: usize,
    /// Where most of them leap to exactly.
    to: f64,
    there: usize,
}

/// The leaps of a column, where there are so many and they are no taps of a finger; `ends` are those of its values but
/// for spikes.
pub(super) fn leaps(name: &str, values: &[f64], ends: [f64; 2]) -> Option<Leaps> {
    let range = ends[1] - ends[0];
    let steps = values.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let mut steps: Vec<f64> = steps.filter(|step| step.is_finite() && *step > 0.0).collect();
    if steps.len() < LEAST_STEPS {
        return None;
    }
    let at = 9 * steps.len() / 10;
    let usual = *steps.select_nth_unstable_by(at, f64::total_cmp).1;
    let far = (STEPS * usual).max(RANGE * range);
    let leaps = |&at: &usize| {
        let leap = (values[at] - values[at - 1]).abs().min((values[at] - values[at + 1]).abs());
        leap > far && (values[at + 1] - values[at - 1]).abs() < BACK * leap
    };
    let alone = || (1..values.len() - 1).filter(leaps);
    let mut to: Vec<f64> = alone().map(|at| values[at] + 0.0).collect();
    to.sort_unstable_by(f64::total_cmp);
    let alike = to.chunk_by(|a, b| a == b).max_by_key(|alike| alike.len())?;
    let found = Leaps { name: name.to_owned(), rows: to.len(), to: alike[0], there: alike.len() };
    let is_force = matches!(Role::of(name), Some(Role::Force(_)));
    let are_taps = || {
        let Some(rest) = median_of(values.iter().copied().filter(|value| value.is_finite())) else { return false };
        let is_no_further = |value: f64| (ends[0] - TAPS * range..=ends[1] + TAPS * range).contains(&value);
        let is_tap = |at: usize| {
            let share = |row: usize| values.get(row).map_or(0.0, |value| (value - rest) / (values[at] - rest));
            let rests = |row: usize| share(row).abs() <= BACK;
            // In the row beside it the finger rests, or is on its way from there.
            let comes = |beside: usize, beyond: usize| rests(beside) || (share(beside) > 0.0 && rests(beyond));
            comes(at - 1, at.wrapping_sub(2)) && comes(at + 1, at + 2) && is_no_further(values[at])
        };
        2 * found.there <= found.rows && alone().all(is_tap)
    };
    (found.rows >= ROWS && !(is_force && are_taps())).then_some(found)
}

/// What to say of the columns that do.
pub(super) fn leaping(columns: &[Leaps]) -> Option<String> {
    let most = columns.iter().max_by_key(|one| one.rows)?;
    let names: Vec<&str> = columns.iter().map(|one| one.name.as_str()).collect();
    let to = match most.there {
        there if 2 * there > most.rows => format!("{there} of them to {}", short(most.to)),
        _ => format!("one of them to {}", short(most.to)),
    };
    Some(format!(
        "{}: single rows leap from those before and after, {} of {}, {to}: are missing values written as numbers, or \
         are they glitches? Leave such cells empty: what learns from them, or counts with them, is wrong by far more \
         than their share",
        names.join(", "),
        most.rows,
        most.name
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::rest::without_spikes;

    /// A photodiode of a finger that presses and lets go, in steps of a converter.
    fn volts(k: usize) -> f64 {
        let noise = ((k * 7919 + 31) * (k + 17) % 2003) as f64 / 2003.0 - 0.5;
        let press = (2.0 * (0.02 * k as f64).sin()).clamp(-1.0, 1.0);
        ((2.7 + 0.2 * press + 0.004 * noise) * 1000.0).round() / 1000.0
    }

    fn said(of: impl Fn(usize) -> f64) -> Option<String> {
        said_of("P1", of)
    }

    fn said_of(name: &str, of: impl Fn(usize) -> f64) -> Option<String> {
        let values: Vec<f64> = (0..3000).map(of).collect();
        leaping(&leaps(name, &values, without_spikes(&values)).into_iter().collect::<Vec<_>>())
    }

    #[test]
    fn codes_for_missing_values_and_glitches_are_seen_however_many_they_are() {
        for (code, every) in [(0.0, 600), (-1.0, 100), (-999.0, 40), (4.5, 25)] {
            let found = said(|k| if k % every == 7 { code } else { volts(k) }).unwrap_or_default();
            let rows = 3000 / every;
            let words = format!("P1: single rows leap from those before and after, {rows} of P1, {rows} of them to");
            assert!(found.contains(&format!("{words} {code}:")), "{found}");
        }
        let glitches = said(|k| if k % 300 == 7 { 1.0 + 0.1 * (k / 300) as f64 } else { volts(k) });
        assert!(glitches.is_some_and(|said| said.contains("10 of P1, one of them to ")));
    }

    #[test]
    fn forces_of_a_finger_that_taps_are_not_and_codes_among_them_are() {
        let noise = |k: usize| 0.002 * ((k * k) % 7) as f64;
        let tap = |k: usize| -1.0 - 0.1 * (k / 60 % 9) as f64;
        let is_down = |k: usize| k % 60 == 7 || k % 120 == 8 || k % 300 > 270;
        let taps = |k: usize| if is_down(k) { tap(k) } else { 0.0 } - noise(k);
        assert_eq!(said_of("Fz_N", taps), None);
        // Of three rows, two of them on the way.
        let slower = |k: usize| match k % 60 {
            7 | 9 => 0.4 * tap(k),
            8 => tap(k),
            _ if k % 300 > 270 => -1.0,
            _ => 0.0,
        };
        assert_eq!(said_of("Fz_N", |k| slower(k) - noise(k)), None);
        assert!(said_of("P1", taps).is_some(), "blood is not so quick");
        for code in [0.0, -1.0, -999.0] {
            let held = |k: usize| if k % 600 < 200 { -1.5 - noise(k) } else { taps(k) };
            let coded = said_of("Fz_N", |k| if k % 50 == 25 { code } else { held(k) });
            assert!(coded.is_some_and(|said| said.contains(&format!("to {code}:"))), "{code}");
        }
    }

    #[test]
    fn fingers_steps_and_a_last_digit_that_flickers_are_not() {
        assert_eq!(said(volts), None);
        assert_eq!(said(|k| if k % 1500 == 7 { 0.0 } else { volts(k) }), None, "two are named as glitches");
        assert_eq!(said(|k| if k % 500 < 250 { 0.0 } else { -2.0 }), None, "steps");
        assert_eq!(said(|k| 2.5 + 0.001 * f64::from(k % 40 == 0)), None, "one digit");
        assert_eq!(said(|k| if k % 40 < 2 { 0.0 } else { volts(k) }), None, "two rows are no single one");
        assert_eq!(said(|k| if k % 40 == 0 { f64::NAN } else { volts(k) }), None);
    }
}
