//! Whether a finger can have done what a recording says, when it says so.
//!
//! Warned of, and nothing is changed. Milliseconds that are called seconds make every duration a thousand times as
//! long. A transducer reports the force of the surface on the finger as often as that of the finger on the surface, and
//! in any unit: a model that learnt from such a recording fits it well, and ever after answers with the wrong sign or
//! unit.

use super::leaps::{self, leaps};
use super::lines::order::{median_step_s, short};
use super::naming::columns::photodiodes_not_read;
use super::naming::role::Role;
use super::piles;
use super::rest::{self, Pressing, without_spikes};
use crate::median::median_of;

/// Below so many samples nothing is said of values.
const SAMPLES: usize = 50;
/// Rows of a sensor are nearer together, seconds (assumed), and so near where there are many: 1 and 2 kHz.
const APART_S: f64 = 1.0;
const MANY_APART_S: f64 = 0.5;
/// Nor nearer together, where all of them are within so many seconds (assumed): minutes or days called seconds.
const NEAR_S: [[f64; 2]; 2] = [[9e-4, 15.0], [2e-3, 3.0]];
/// Where a finger hardly presses, newtons, in so many rows, it is not sheared by more than this (assumed).
const TOUCHES_N: f64 = 0.05;
const LOOSE_ROWS: usize = 20;
const SHEARED_N: f64 = 0.15;
/// A finger that is sheared by so much presses with this share of it at least (assumed: skin holds less the harder it
/// presses, and coefficients of friction above 4 were seen only at some hundredths of a newton: Adams et al. 2013, DOI
/// 10.1098/rsif.2012.0467).
const MUCH_SHEARED_N: f64 = 1.0;
const HOLDS: f64 = 0.25;
/// Rows come evenly where so many steps, of so many at least, are within a half of the usual one (assumed).
const EVEN: f64 = 0.8;
const EVEN_ROWS: usize = 20;
/// A gap is longer than so many usual steps, and than so long, seconds (assumed: vessels follow a load within 0.1 to
/// 0.4 s, 4.3).
const GAP_STEPS: f64 = 10.0;
const GAP_S: f64 = 0.2;
/// Of steps from row to row, so many turn back where an LED is on and off by turns (assumed).
const BY_TURNS: f64 = 0.95;
/// So many times the range of all others beyond them is far, and for a row whose neighbours lie among the others
/// (assumed: no finger presses for one row alone).
const FAR: f64 = 20.0;
const FAR_ALONE: f64 = 3.0;
/// More rows than this, and than this share, are no glitches: a finger that presses seldom (assumed).
const MOST_GLITCHES: usize = 3;
const SHARE_OF_GLITCHES: f64 = 0.0005;
/// Blocks of rows of one time stamp are nearer together where a device sends them as they come, seconds (assumed).
const BLOCK_S: f64 = 0.25;
/// More than a finger presses, newtons (assumed; norms of the strength of pinches: Mathiowetz et al., Archives of
/// Physical Medicine and Rehabilitation 66(2), 1985).
const MOST_N: f64 = 200.0;
/// A column is held where so many runs of equal values, of this share, are as long as the usual one, to a row; runs of
/// one row are at most so many; a run is no longer, seconds; and no step is this share of all (assumed: a force that
/// grows evenly, in coarse digits, has one). Steps that somebody prompts are longer and fewer.
const RUNS: usize = 20;
const ALIKE: f64 = 0.8;
const ALONE: f64 = 0.1;
const HELD_S: f64 = 0.6;
const ONE_STEP: f64 = 0.6;
/// An offset that is forgiven, newtons: of a force that may pull, of one that rests.
const OFFSET_N: f64 = 0.5;
const RESTS_N: f64 = 0.02;
/// How much further than it presses a finger may seem to pull (assumed): from the first on the sign is another, from
/// the second on the force.
pub(crate) const PULLED: f64 = 2.0;
const PULLS: f64 = 0.25;

/// What to say of a recording's times, which ascend.
pub(crate) fn time(time_s: &[f64]) -> Option<String> {
    let span_s = || Some(time_s.last()? - time_s.first()?);
    blocks(time_s).or_else(|| unit(median_step_s(time_s)?, span_s()?, time_s.len()))
}

/// What to say of the unit of times, of so many rows that are so far apart.
pub(crate) fn unit(step_s: f64, span_s: f64, rows: usize) -> Option<String> {
    if step_s > APART_S || step_s >= MANY_APART_S && rows >= SAMPLES {
        return Some(format!(
            "rows are {} s apart, if the stamps are in seconds; write them in seconds, or say with --time-unit what \
             they are in",
            short(step_s)
        ));
    }
    let near = |[step, span]: &[f64; 2]| step_s < *step && span_s < *span;
    (step_s > 0.0 && rows >= SAMPLES && NEAR_S.iter().any(near)).then(|| {
        format!(
            "rows are {} s apart, and all of them within {} s, if the stamps are in seconds: are they minutes, or days \
             as a spreadsheet counts them? Write them in seconds",
            short(step_s),
            short(span_s)
        )
    })
}

/// The usual step of values that grow evenly from row to row.
pub(crate) fn even_step(values: &[f64]) -> Option<f64> {
    let steps = || values.windows(2).map(|pair| pair[1] - pair[0]);
    let usual = median_of(steps()).filter(|usual| *usual > 0.0 && values.len() > EVEN_ROWS)?;
    let even = steps().filter(|step| (0.5 * usual..=1.5 * usual).contains(step)).count();
    (even as f64 >= EVEN * (values.len() - 1) as f64).then_some(usual)
}

/// What to say of a hole in a table of loads whose rows come evenly.
pub(crate) fn gap(time_s: &[f64]) -> Option<String> {
    let usual_s = even_step(time_s)?;
    let longest = time_s.windows(2).max_by(|a, b| (a[1] - a[0]).total_cmp(&(b[1] - b[0])))?;
    (longest[1] - longest[0] > GAP_S.max(GAP_STEPS * usual_s)).then(|| {
        format!(
            "rows come every {} s, and none is between {} and {} s: loads are taken to go straight from the one to the \
             other; what was pressed there is not known",
            short(usual_s),
            short(longest[0]),
            short(longest[1])
        )
    })
}

/// What to say of rows that share their stamps.
pub(crate) fn blocks(time_s: &[f64]) -> Option<String> {
    let distinct: Vec<f64> = time_s.chunk_by(|a, b| a == b).map(|block| block[0]).collect();
    let block_s = median_step_s(&distinct).filter(|_| 2 * distinct.len() < time_s.len());
    block_s.filter(|block_s| *block_s >= BLOCK_S).map(|block_s| {
        format!(
            "rows come in blocks of one time stamp, about {:.0} rows each, {} s apart: what changes within a block is \
             labelled wrongly by up to so much; write when each row was taken",
            time_s.len() as f64 / distinct.len() as f64,
            short(block_s)
        )
    })
}

/// What to say of a table's columns, known by name: photodiodes that go up and down from row to row, forces that no
/// finger has, glitches; and of its names, photodiodes that are not read.
pub(crate) fn table<'a>(names: &[String], columns: impl Iterator<Item = (&'a str, &'a [f64])> + Clone) -> Vec<String> {
    let is_photodiode = |name: &str| matches!(Role::of(name), Some(Role::Photodiode(_)));
    let photodiodes = columns.clone().filter(|(name, _)| is_photodiode(name));
    let mut doubts = photodiodes_not_read(names);
    doubts.extend(alternating(photodiodes.clone()));
    doubts.extend(forces(columns.clone()));
    let is_force = |name: &str| matches!(Role::of(name), Some(Role::Force(_)));
    doubts.extend(glitches(columns.filter(|(name, _)| is_photodiode(name) || is_force(name))));
    doubts
}

/// Photodiodes that go up and down by turns, in all rows: of white noise, two steps of three turn back.
pub(crate) fn alternating<'a>(photodiodes: impl Iterator<Item = (&'a str, &'a [f64])>) -> Option<String> {
    let alternates = |values: &[f64]| {
        let known: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
        let steps: Vec<f64> = known.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let turns = steps.windows(2).filter(|pair| pair[0] * pair[1] < 0.0).count();
        known.len() >= SAMPLES && turns as f64 >= BY_TURNS * (steps.len() - 1) as f64
    };
    let names: Vec<&str> = photodiodes.filter(|(_, values)| alternates(values)).map(|(name, _)| name).collect();
    (!names.is_empty()).then(|| {
        format!(
            "{} go up and down from row to row, as where an LED is on and off by turns, and no column is read that \
             says when it is on; name it with --columns led=NAME, or call it `led`",
            names.join(", ")
        )
    })
}

/// Rows that leap and come back, and values of a few rows that lie far beyond all others.
pub(crate) fn glitches<'a>(columns: impl Iterator<Item = (&'a str, &'a [f64])>) -> Vec<String> {
    let mut leaping = Vec::new();
    let of = |(name, values): (&str, &[f64])| {
        let [least, greatest] = without_spikes(values);
        let range = greatest - least;
        if let Some(leaps) = leaps(name, values, [least, greatest]) {
            leaping.push(leaps);
            return None;
        }
        let beyond = |value: f64| (least - value).max(value - greatest);
        let alone = |row: usize| {
            let beside = [row.checked_sub(1), Some(row + 1)].into_iter().flatten();
            !beside.filter_map(|row| values.get(row)).any(|value| beyond(*value) > 0.0)
        };
        let is_glitch = |row: usize, value: f64| {
            let far = beyond(value) / range;
            value.is_finite() && range > 0.0 && (far > FAR || far > FAR_ALONE && alone(row))
        };
        let worst = |a: f64, b: &f64| if b.abs() > a.abs() { *b } else { a };
        let glitches = || values.iter().enumerate().filter(|(row, value)| is_glitch(*row, **value));
        let count = glitches().count();
        let most = MOST_GLITCHES.max((SHARE_OF_GLITCHES * values.len() as f64) as usize);
        (values.len() >= SAMPLES && (1..=most).contains(&count)).then(|| {
            format!(
                "{name} is {} in one of {count} row(s), far beyond all others, which go from {least:.3} to \
                 {greatest:.3}; leave such rows out if they are glitches: a model learns from them too",
                short(glitches().map(|(_, value)| value).fold(0.0, worst))
            )
        })
    };
    let alone: Vec<String> = columns.filter_map(of).collect();
    leaps::leaping(&leaping).into_iter().chain(alone).collect()
}

/// What to say of a column that stays at an end of its range, but for 0, at which a finger rests.
pub(crate) fn cut_off(name: &str, values: &[f64]) -> Vec<String> {
    let ends = piles(values).into_iter().zip(["least", "greatest"]);
    let ends = ends.filter_map(|(pile, which)| Some((pile.filter(|(value, _)| *value != 0.0)?, which)));
    ends.map(|((value, count), which)| {
        format!(
            "{name} stays at exactly {}, its {which} value, in {count} of {} rows: cut off at the end of a range, or \
             at rest and never zeroed? What learns from it takes it as it is",
            short(value),
            values.len()
        )
    })
    .collect()
}

/// What to say of a column that stays for a few rows and jumps, all through, while it moves.
pub(crate) fn held(name: &str, time_s: &[f64], values: &[f64]) -> Option<String> {
    let runs: Vec<&[f64]> = values.chunk_by(|a, b| a == b).collect();
    // The first and the last one are cut off.
    let [_, inner @ .., _] = &runs[..] else { return None };
    let share =
        |counts: &dyn Fn(&&[f64]) -> bool| inner.iter().filter(|run| counts(run)).count() as f64 / inner.len() as f64;
    let usual = median_of(inner.iter().map(|run| run.len() as f64)).filter(|_| inner.len() >= RUNS)?;
    let lasts_s = usual * median_step_s(time_s)?;
    let mut steps: Vec<f64> = inner.windows(2).map(|pair| (pair[1][0] - pair[0][0]).abs()).collect();
    steps.sort_by(f64::total_cmp);
    let most = 1e-6 * steps.last()?;
    let one_step = steps.chunk_by(|a, b| b - a <= most).map(<[f64]>::len).max()?;
    let is_held = usual >= 2.0
        && lasts_s <= HELD_S
        && share(&|run| (run.len() as f64 - usual).abs() <= 1.0) >= ALIKE
        && share(&|run| run.len() == 1) <= ALONE
        && (one_step as f64) < ONE_STEP * steps.len() as f64;
    is_held.then(|| {
        format!(
            "{name} stays for {} rows, {} s, and jumps, all through: is it of a slower device, repeated? Its steps are \
             taken as they are; write its own samples at their own times, or what lies between them",
            short(usual),
            short(lasts_s)
        )
    })
}

/// What to say of shear without pressing, of forces.
fn not_zeroed(columns: &[(&str, &[f64])]) -> Vec<String> {
    let Some((_, pressing)) = columns.iter().find(|(name, _)| *name == "Fz_N") else { return Vec::new() };
    let loose = |force: &[f64]| {
        let loose = force.iter().zip(*pressing).filter(|(force, fz)| force.is_finite() && fz.abs() <= TOUCHES_N);
        loose.map(|(force, _)| *force).collect::<Vec<f64>>()
    };
    let of = |(name, force): &(&str, &[f64])| {
        let forces = loose(force);
        let rests_n = median_of(forces.iter().copied()).filter(|_| forces.len() >= LOOSE_ROWS)?;
        (rests_n.abs() > SHEARED_N).then(|| {
            format!(
                "{name} is {rests_n:.2} N in the median of {} rows in which the finger does not press (Fz_N within \
                 {TOUCHES_N} N of 0): was the transducer zeroed? Take its offset away",
                forces.len()
            )
        })
    };
    columns.iter().filter(|(name, _)| matches!(*name, "Fx_N" | "Fy_N")).filter_map(of).collect()
}

/// What to say of more shear than a pressing finger holds, of forces.
fn slips(columns: &[(&str, &[f64])]) -> Option<String> {
    let of = |wanted: &str| columns.iter().find(|(name, _)| *name == wanted).map(|(_, values)| *values);
    let fz = of("Fz_N")?;
    let rows = columns.iter().map(|(_, values)| values.len()).min()?;
    let sheared: Vec<&[f64]> = ["Fx_N", "Fy_N"].into_iter().filter_map(of).collect();
    let shear = |row: usize| sheared.iter().map(|force| force[row].powi(2)).sum::<f64>().sqrt();
    let much: Vec<usize> = (0..rows).filter(|&row| shear(row) > MUCH_SHEARED_N && fz[row].is_finite()).collect();
    let slips = much.iter().filter(|&&row| -fz[row] < HOLDS * shear(row)).count();
    (much.len() >= LOOSE_ROWS && 2 * slips > much.len()).then(|| {
        format!(
            "in {slips} of {} rows with a shear of more than {MUCH_SHEARED_N} N, Fz_N presses with less than {HOLDS} \
             of it, by which no finger holds on: are two of the columns exchanged, or in other units?",
            much.len()
        )
    })
}

/// Forces of exactly 0 in so many rows, at whose ends one leaps by so many newtons, and by so many times as much as 99
/// of 100 steps while it is not 0 (runs of 12 phantoms with true forces: 1.3 times at most; gaps that were filled with
/// 0: 43 to 53 times).
const ZERO_ROWS: usize = 20;
const LEAPS_N: f64 = 0.2;
const LEAPS: f64 = 5.0;

/// What to say of forces that leap to exactly 0, stay there and leap back: a finger comes and goes in some rows.
fn filled_with_0(columns: &[(&str, &[f64])]) -> Option<String> {
    let rows = columns.iter().map(|(_, values)| values.len()).min()?;
    let is_zero = |row: usize| columns.iter().all(|(_, values)| values[row] == 0.0);
    let step = |row: usize| columns.iter().map(|(_, values)| (values[row] - values[row - 1]).abs()).fold(0.0, f64::max);
    let mut steps: Vec<f64> = (1..rows).filter(|&row| !is_zero(row) && !is_zero(row - 1)).map(step).collect();
    if steps.len() < SAMPLES {
        return None;
    }
    let at = 99 * steps.len() / 100;
    // Without noise every press leaps.
    let usual_n = Some(*steps.select_nth_unstable_by(at, f64::total_cmp).1).filter(|usual_n| *usual_n > 0.0)?;
    let order: Vec<usize> = (0..rows).collect();
    let mut runs: Vec<&[usize]> = order.chunk_by(|a, b| is_zero(*a) == is_zero(*b)).collect();
    runs.retain(|run| {
        let (first, after) = (run[0], run[0] + run.len());
        // What was done before the recording, and after it, isn't known.
        let is_inner = is_zero(first) && run.len() >= ZERO_ROWS && first > 0 && after < rows;
        is_inner && step(first).min(step(after)) > LEAPS_N.max(LEAPS * usual_n)
    });
    let longest = runs.iter().max_by_key(|run| run.len())?;
    Some(format!(
        "forces leap to exactly 0, and back, in {} stretch(es) of rows, the longest of {} rows from row {} on: were \
         gaps filled with 0? Leave their cells empty",
        runs.len(),
        longest.len(),
        longest[0] + 1
    ))
}

/// What to say of a finger's force on the surface that rests elsewhere than at 0.
pub(crate) fn resting(name: &str, forces_n: &[f64]) -> Option<String> {
    rest::not_at_zero(name, "N", RESTS_N, forces_n, Pressing::Negative)
}

/// What to say of a recording's columns, those that are forces.
pub(crate) fn forces<'a>(columns: impl Iterator<Item = (&'a str, &'a [f64])>) -> Vec<String> {
    let columns: Vec<(&str, &[f64])> = columns.filter(|(name, _)| matches!(*name, "Fx_N" | "Fy_N" | "Fz_N")).collect();
    let mut doubts = not_zeroed(&columns);
    doubts.extend(slips(&columns));
    doubts.extend(filled_with_0(&columns));
    for (name, values) in columns {
        if values.iter().filter(|value| value.is_finite()).count() < SAMPLES {
            continue;
        }
        let [least, greatest] = without_spikes(values);
        if greatest.max(-least) > MOST_N {
            doubts.push(format!(
                "{name} goes from {least:.0} to {greatest:.0} N, and no finger presses with more than {MOST_N} N: are \
                 the forces in newtons (1 gram is 0.00981 N)?"
            ));
        }
        if name == "Fz_N" && greatest > OFFSET_N && greatest > -PULLED * least {
            doubts.push(format!(
                "{name} goes from {least:.3} to {greatest:.3} N, as if the finger pulled: pressing is negative. Where \
                 these are forces of the surface on the finger, negate Fx_N, Fy_N and Fz_N; where the transducer was \
                 not zeroed, take its offset away"
            ));
        } else if name == "Fz_N" {
            let pulls = || {
                (greatest > OFFSET_N && greatest > -PULLS * least).then(|| {
                    format!(
                        "{name} goes from {least:.3} to {greatest:.3} N, and a finger that presses hardly pulls: is it \
                         the column of another force, or was the transducer not zeroed?"
                    )
                })
            };
            doubts.extend(resting(name, values).or_else(pulls));
        }
    }
    doubts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn milliseconds_that_are_called_seconds_are_doubted() {
        let every = |step_s: f64, count: usize| time(&(0..count).map(|k| step_s * k as f64).collect::<Vec<_>>());
        assert!(every(10.0, 50).is_some_and(|said| said.starts_with("rows are 10 s apart")), "{:?}", every(10.0, 50));
        assert!([1.0, 0.5].iter().all(|step_s| every(*step_s, 400).is_some()), "1 and 2 kHz in milliseconds");
        assert_eq!([every(0.4, 400), every(1.0, 20), every(10.0, 1), time(&[])], [const { None }; 4]);
        let stamped = |every: usize, step_s: f64| {
            time(&(0..400).map(|k| step_s * (k / every) as f64).collect::<Vec<_>>()).unwrap_or_default()
        };
        assert!(stamped(25, 1.0).contains("about 25 rows each, 1 s apart"), "{}", stamped(25, 1.0));
        assert_eq!(stamped(8, 0.08), "");
        // Of dates, blocks alone.
        let minutes: Vec<f64> = (0..400).map(|k| 60.0 * (k / 25) as f64).collect();
        assert!(blocks(&minutes).is_some() && blocks(&[0.0, 10.0, 20.0]).is_none());
    }

    #[test]
    fn minutes_that_are_called_seconds_are_doubted_and_quick_sensors_are_not() {
        let every = |step_s: f64, count: usize| time(&(0..count).map(|k| step_s * k as f64).collect::<Vec<_>>());
        let minutes = every(0.04 / 60.0, 1500).expect("a minute at 25 Hz");
        assert!(minutes.contains("rows are 0.000667 s apart, and all of them within 0.999 s"), "{minutes}");
        let days = every(0.04 / 86_400.0, 300).expect("12 s at 25 Hz");
        assert!(
            days.contains("rows are 0.000000463 s apart") && days.contains("days as a spreadsheet counts"),
            "{days}"
        );
        assert!(every(0.08 / 60.0, 750).is_some());
        assert_eq!([every(1e-3, 60_000), every(1e-3, 5000), every(0.01, 100), every(1e-4, 20)], [(); 4].map(|()| None));
    }

    #[test]
    fn ends_of_ranges_and_offsets_are_doubted_and_fingers_are_not() {
        let force = |k: usize| -2.5 + 2.5 * (0.02 * k as f64).cos() + 0.002 * ((k * k) % 7) as f64;
        let all = |of: &dyn Fn(usize) -> f64| (0..900).map(of).collect::<Vec<f64>>();
        assert!(cut_off("Fz_N", &all(&force)).is_empty());
        let cut = cut_off("Fz_N", &all(&|k| force(k).max(-4.0)));
        assert!(cut.len() == 1 && cut[0].starts_with("Fz_N stays at exactly -4, its least value, in "), "{cut:?}");
        assert!(cut_off("Fz_N", &all(&|k| (force(k) + 1.0).min(0.0))).is_empty(), "a finger that rests");
        let said = |offset_n: f64, pressed: f64| {
            let (fx, fz) = (all(&|k| offset_n + 0.1 * force(k)), all(&|k| (force(k) + pressed).min(0.0)));
            forces([("Fx_N", &fx[..]), ("Fz_N", &fz[..])].into_iter()).concat()
        };
        assert!(said(0.5, 1.0).starts_with("Fx_N is 0.4"), "{}", said(0.5, 1.0));
        assert_eq!([said(0.05, 1.0), said(0.5, -1.0)].concat(), "");
    }

    #[test]
    fn gaps_that_were_filled_with_0_are_seen_and_a_finger_that_rests_is_not() {
        let of = |alter: &dyn Fn(usize, f64) -> f64| {
            let noise = |k: usize| 0.002 * ((k * k) % 7) as f64;
            let fz: Vec<f64> = (0..900).map(|k| alter(k, 1.5 * (0.02 * k as f64).cos() - 1.0 - noise(k))).collect();
            let fx: Vec<f64> = fz.iter().map(|fz| 0.1 * fz).collect();
            filled_with_0(&[("Fx_N", &fx[..]), ("Fz_N", &fz[..])])
        };
        let gap = |k: usize| (400..450).contains(&k) || (700..800).contains(&k);
        let filled = of(&|k, force| if gap(k) { 0.0 } else { force.min(-0.5) });
        let words = "in 2 stretch(es) of rows, the longest of 100 rows from row 701 on";
        assert!(filled.as_ref().is_some_and(|said| said.contains(words)), "{filled:?}");
        // A transducer that rests at exactly 0, a press that begins and ends at once, and rows that are not known.
        assert_eq!(of(&|_, force| force.min(0.0)), None);
        assert_eq!(of(&|k, _| if k % 200 < 100 { 0.0 } else { -2.0 }), None);
        assert_eq!(of(&|k, force| if (400..450).contains(&k) { f64::NAN } else { force.min(0.0) }), None);
    }

    #[test]
    fn what_a_slower_device_measured_is_seen_in_its_steps() {
        let said = |every_s: f64, of: &dyn Fn(f64) -> f64| {
            let time_s: Vec<f64> = (0..2000).map(|k| 0.01 * f64::from(k)).collect();
            let values: Vec<f64> = time_s.iter().map(|t_s| of((t_s / every_s + 1e-9).floor() * every_s)).collect();
            held("Fz_N", &time_s, &values)
        };
        let force = |t_s: f64| -2.0 + 2.0 * (1.3 * t_s).cos() + 0.3 * (4.1 * t_s).sin();
        for (every_s, rows) in
            [(0.02, "2"), (0.04, "4"), (0.1, "10"), (0.2, "20"), (0.5, "50"), (0.025, "2 rows, 0.02")]
        {
            let said = said(every_s, &force).unwrap_or_else(|| panic!("every {every_s} s"));
            assert!(said.starts_with(&format!("Fz_N stays for {rows}")) || every_s == 0.025, "{said}");
        }
        // Presses and rests between them, all in the digits of a converter.
        let presses = |t_s: f64| (force(t_s) + 1.0).min(0.0);
        let coarse = |t_s: f64| (force(t_s) / 0.05).round() * 0.05;
        let evenly = |t_s: f64| (0.4 * t_s / 0.05).floor() * 0.05;
        let prompted = |t_s: f64| (t_s / 1.0).floor() % 5.0;
        for own in [&force as &dyn Fn(f64) -> f64, &presses, &coarse, &evenly, &prompted, &|_| 0.0] {
            assert_eq!(said(0.01, own), None);
        }
        assert!(said(0.1, &presses).is_some(), "rests between");
        assert_eq!([held("Fz_N", &[], &[]), held("Fz_N", &[0.0; 3], &[1.0, 2.0, 2.0])], [None, None]);
    }

    #[test]
    fn more_shear_than_a_finger_holds_is_doubted() {
        let fz: Vec<f64> = (0..900).map(|k| -2.5 + 2.5 * (0.02 * f64::from(k)).cos()).collect();
        let fx: Vec<f64> = fz.iter().zip(0..).map(|(fz, k)| 0.8 * fz * f64::from(k % 400 - 200).signum()).collect();
        let said = |fx: &[f64], fz: &[f64]| {
            let doubts = forces([("Fx_N", fx), ("Fz_N", fz)].into_iter());
            doubts.into_iter().find(|doubt| doubt.contains("by which no finger holds on"))
        };
        assert_eq!(said(&fx, &fz), None);
        assert!(said(&fz, &fx.iter().map(|fx| 0.1 * fx).collect::<Vec<_>>()).is_some(), "exchanged");
        assert!(said(&fx, &fz.iter().map(|fz| 0.1 * fz).collect::<Vec<_>>()).is_some(), "another unit");
    }

    #[test]
    fn an_led_that_goes_on_and_off_is_seen_in_photodiodes_and_noise_is_none() {
        let noise = |k: usize| ((k * k * 7919 + 31 * k) % 1009) as f64 / 1009.0;
        let of = |count: usize, value: &dyn Fn(usize) -> f64| {
            let values: Vec<f64> = (0..count).map(value).collect();
            alternating([("P1", &values[..]), ("P2", &[1.0; 400][..])].into_iter())
        };
        let by_turns = |k: usize| if k.is_multiple_of(2) { 2.0 + 0.5 * noise(k) } else { 0.5 * noise(k) };
        let said = of(400, &by_turns).expect("a doubt");
        assert!(said.starts_with("P1 go up and down") && said.contains("--columns led=NAME"), "{said}");
        assert!(of(400, &|k| if k == 100 { f64::NAN } else { by_turns(k) }).is_some());
        for quiet in [&noise as &dyn Fn(usize) -> f64, &|k| (0.1 * k as f64).sin(), &|_| 1.0, &|k| (k % 4) as f64] {
            assert_eq!(of(400, quiet), None);
        }
        assert_eq!(of(49, &by_turns), None);
    }

    #[test]
    fn a_few_values_far_beyond_all_others_are_doubted_and_seldom_presses_are_not() {
        let of = |value: &dyn Fn(usize) -> f64| {
            let values: Vec<f64> = (0..1000).map(value).collect();
            glitches(std::iter::once(("P4", &values[..])))
        };
        let usual = |k: usize| 2.0 + 0.1 * (0.3 * k as f64).sin();
        let said = of(&|k| if k == 500 { 1e9 } else { usual(k) });
        assert!(
            said.len() == 1 && said[0].contains("1000000000 in one of 1 row(s)") && said[0].contains("1.9"),
            "{said:?}"
        );
        assert!(of(&|k| if k % 500 == 7 { -5.0 } else { usual(k) })[0].contains("-5 in one of 2 row(s)"));
        // Ten times the greatest in one row alone, and in two, as of a finger that taps.
        let press = |k: usize| 2.5 - 2.5 * (0.05 * k as f64).cos();
        assert!(of(&|k| if k == 500 { 50.0 } else { press(k) })[0].contains("50 in one of 1 row(s)"));
        for quiet in [
            &usual as &dyn Fn(usize) -> f64,
            &|k| if k % 100 < 2 { 50.0 } else { usual(k) },
            &|_| 1.0,
            &|k| if k / 2 == 250 { 50.0 } else { press(k) },
            &|k| if k == 500 { 15.0 } else { press(k) },
        ] {
            assert!(of(quiet).is_empty(), "{:?}", of(quiet));
        }
    }

    #[test]
    fn photodiodes_of_a_table_that_are_not_read_are_named() {
        let of = |names: &[&str]| {
            let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
            table(&names, std::iter::empty())
        };
        for other in ["P1_mV", "P1 (mV)", "P1_new", "P1.1", "PD1 mV"] {
            let said = of(&["time_s", other, "P2", "Fz_N"]);
            assert!(said.len() == 1 && said[0].starts_with(&format!("column `{other}` may be")), "{said:?}");
        }
        // Beside the photodiode itself it says something of it; where none is read, others say that.
        assert!(of(&["P1", "P1_sd_V", "P2"]).is_empty() && of(&["P1_mV", "Fz_N"]).is_empty());
        assert!(of(&["P1", "pf1_Pa", "C_00_01", "P"]).is_empty());
    }

    #[test]
    fn a_sign_and_a_unit_that_no_finger_has_are_doubted_and_fingers_are_not() {
        // Presses of 5 N for half of the time.
        let press = |k: usize| if (k / 20).is_multiple_of(2) { 0.0 } else { -5.0 };
        let of = |name: &str, count: usize, value: &dyn Fn(usize) -> f64| {
            let values: Vec<f64> = (0..count).map(value).collect();
            forces(std::iter::once((name, &values[..])))
        };
        let doubted = |name: &str, value: &dyn Fn(usize) -> f64| of(name, 400, value).join(" ");
        for fine in [&press as &dyn Fn(usize) -> f64, &|_| 0.01, &|k| 20.0 * press(k)] {
            assert_eq!(doubted("Fz_N", fine), "");
        }
        for rests in [&|k| press(k) + 1.0, &|_| 0.1] as [&dyn Fn(usize) -> f64; 2] {
            assert!(doubted("Fz_N", rests).starts_with("Fz_N rests at "), "{}", doubted("Fz_N", rests));
        }
        // Spikes and missing values are no presses.
        assert_eq!(doubted("Fz_N", &|k| if k % 300 == 7 { 1e9 } else { press(k) }), "");
        assert_eq!(doubted("Fz_N", &|k| if k % 2 == 0 { f64::NAN } else { press(k) }), "");
        let other_sign = doubted("Fz_N", &|k| -press(k));
        assert!(other_sign.contains("from 0.000 to 5.000 N") && other_sign.contains("negate"), "{other_sign}");
        let grams = doubted("Fz_N", &|k| press(k) * 101.97);
        assert!(grams.contains("from -510 to 0 N") && grams.contains("in newtons"), "{grams}");
        // Shear has either sign, and the same units.
        assert_eq!(doubted("Fx_N", &|k| -press(k)), "");
        assert!(doubted("Fx_N", &|k| press(k) * -1000.0).contains("Fx_N goes from 0 to 5000 N"));
        // Both at once; and neither of what is no force, or of too few.
        assert_eq!(of("Fz_N", 400, &|k| press(k) * -1000.0).len(), 2);
        assert!(of("P1", 400, &|k| press(k) * -1000.0).is_empty() && of("Fz_N", 49, &|_| 1e4).is_empty());
    }
}
