//! Photodiodes and cells that show nothing, columns that are cut off at the end of the recorded range, photodiodes
//! whose clock is another than that of what was measured beside them; files that contradict each other.

use std::collections::BTreeSet;
use std::ops::Range;

use lunula_predictor::{
    Apart, Dataset, Delay, Difference, Mismatch, Parts, Recording, delays, recording_hashes, shared_within,
};
use ndarray::{Axis, Slice};

use super::blocks::TURNED;
use super::columns::cell;
use super::source::Source;
use crate::log::doubts::{cut_off, held};
use crate::log::piles;
use crate::median::median_of;

/// What is worth saying on a file's photodiodes and its `targets`. Rows that are left out for faults are not looked at;
/// constant is a photodiode that has a single value.
pub(super) fn warnings(source: &Source, targets: &[String], keep_faults: bool) -> Vec<String> {
    let file = source.path.display();
    let mut warnings = Vec::new();
    let seen = |values: &[f64]| {
        let known = values.iter().zip(&source.faulty);
        let known = known.filter(|(value, faulty)| !value.is_nan() && (keep_faults || !**faulty));
        known.map(|(value, _)| *value).collect::<Vec<f64>>()
    };
    let photodiodes = source.inputs.iter().zip(&source.x).filter(|(name, _)| cell(name).is_none());
    for (name, values) in photodiodes {
        let seen = seen(values);
        let Some(&first) = seen.first() else { continue };
        if seen.len() >= FEW && seen.iter().all(|&value| value == first) {
            warnings.push(format!(
                "{file}: {name} is {} V in all {} rows: dead or not connected",
                short(first),
                seen.len()
            ));
            continue;
        }
        for (pile, which) in piles(&seen).into_iter().zip(["least", "greatest"]) {
            let Some((value, count)) = pile else { continue };
            warnings.push(format!(
                "{file}: {name} stays at exactly {} V, its {which} value, in {count} of {} rows: saturated?",
                short(value),
                seen.len()
            ));
        }
    }
    warnings.extend(unchanging(source).map(|said| format!("{file}: {said}")));
    warnings.extend(copies(source).map(|said| format!("{file}: {said}")));
    let targets = targets.iter().zip(&source.y);
    let targets = targets
        .flat_map(|(name, values)| cut_off(name, &seen(values)).into_iter().chain(held(name, &source.time_s, values)));
    warnings.extend(targets.map(|said| format!("{file}: {said}")));
    warnings
}

/// Of fewer rows a cell or a photodiode may keep its value by chance (assumed).
const FEW: usize = 10;

/// Cells of a file that have a single value. Noise changes the last digit of every other.
fn unchanging(source: &Source) -> Option<String> {
    let is_one = |values: &[f64]| {
        let known: Vec<f64> = values.iter().copied().filter(|value| !value.is_nan()).collect();
        known.len() >= FEW && known.iter().all(|&value| value == known[0])
    };
    let cells = source.inputs.iter().zip(&source.x).filter(|(name, _)| cell(name).is_some());
    let still: Vec<&str> = cells.filter(|(_, values)| is_one(values)).map(|(name, _)| name.as_str()).collect();
    let more = match still.len().checked_sub(1)? {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    Some(format!("{}{more}: the same to the last digit in all rows; overexposed, or no part of the picture?", still[0]))
}

/// Photodiodes of a file that are another's in every row, and not all one value.
fn copies(source: &Source) -> impl Iterator<Item = String> {
    let photodiodes: Vec<(&String, &Vec<f64>)> =
        source.inputs.iter().zip(&source.x).filter(|(name, _)| cell(name).is_none()).collect();
    let count = photodiodes.len();
    let moves = |values: &[f64]| {
        let mut known = values.iter().filter(|value| !value.is_nan());
        let first = known.next();
        known.any(|value| Some(value) != first)
    };
    let is_copy = |one: &[f64], other: &[f64]| one.iter().zip(other).all(|(one, other)| one.is_nan() || one == other);
    let of = move |k: usize| {
        let (name, values) = photodiodes[k];
        let before = if moves(values) { &photodiodes[..k] } else { &[] };
        let (other, _) = before.iter().find(|(_, other)| is_copy(values, other))?;
        Some(format!("{name} is {other} in all rows: is one of them a copy of the other's column?"))
    };
    (0..count).filter_map(of)
}

/// What the inputs are called, of which some are blocks of cells.
pub(super) fn called(data: &Dataset) -> &'static str {
    let is_cell = |name: &String| name.split(' ').next().and_then(cell).is_some();
    if data.inputs().first().is_some_and(is_cell) { "cells" } else { "photodiodes" }
}

/// Photodiodes of one sensor are alike from recording to recording; so many times another's are in another unit
/// (assumed: amplifiers differ by less, units by 1000).
const OTHER_UNIT: f64 = 30.0;

/// What to say of recordings whose photodiodes are many times those of the others.
pub(in crate::predictor) fn units<'a>(sets: impl IntoIterator<Item = &'a Dataset>) -> Option<String> {
    let of_set = |set: &'a Dataset| {
        let size = |one: &Recording| {
            let x = set.x().slice_axis(Axis(0), Slice::from(one.rows.clone()));
            let sizes = x.columns().into_iter().filter_map(|column| median_of(column.iter().map(|v| v.abs())));
            sizes.max_by(f64::total_cmp)
        };
        set.recordings().iter().filter_map(move |one| Some((size(one)?, (one.name.as_str(), called(set)))))
    };
    let mut sizes: Vec<(f64, (&str, &str))> =
        sets.into_iter().flat_map(of_set).filter(|(size, _)| *size > 0.0).collect();
    sizes.sort_by(|a, b| a.0.total_cmp(&b.0));
    let [(least, (small, _)), .., (most, (large, called))] = sizes[..] else { return None };
    (most >= OTHER_UNIT * least).then(|| {
        format!("the {called} of {large} are {:.0} times as large as those of {small}: in another unit?", most / least)
    })
}

/// By how much photodiodes may seem to answer before what they answer to, and after it, seconds (assumed: blood takes
/// 0.1 to 0.4 s, 4.3).
const BEFORE_S: f64 = 0.15;
const AFTER_S: f64 = 1.0;
/// It is sure where the share that is left unexplained is so small, and so much less than with the times as they are:
/// so many times, and by so much (assumed).
const UNEXPLAINED: f64 = 0.3;
const TIMES: f64 = 0.6;
const LESS: f64 = 0.005;

/// What to say of recordings whose photodiodes answer before a finger has done anything, or long after: of the first.
pub(super) fn clocks(data: &Dataset) -> Option<String> {
    let most = |recorded: f64| UNEXPLAINED.min(TIMES * recorded).min(recorded - LESS);
    let is_off = |delay: &Delay| delay.without < most(delay.recorded) && !(-AFTER_S..=BEFORE_S).contains(&delay.by_s);
    let all = data.recordings().iter().zip(delays(data));
    let off: Vec<(&Recording, Delay)> = all.filter_map(|(one, delay)| Some((one, delay.filter(is_off)?))).collect();
    let (recording, delay) = off.first()?;
    let [side, finger] = match delay.by_s {
        by_s if by_s > 0.0 => ["before", "as in no finger"],
        _ => ["after", "and blood takes 0.1 to 0.4 s"],
    };
    let more = if off.len() > 1 { format!(" ({} more recording(s) alike)", off.len() - 1) } else { String::new() };
    Some(format!(
        "{}: the {} answer {:.1} s {side} {}, {finger}: were they logged on two clocks? Shifted so, {:.1} % \
         of the variance is left unexplained instead of {:.1} %{more}",
        recording.name,
        called(data),
        delay.by_s.abs(),
        data.targets().join(", "),
        100.0 * delay.without,
        100.0 * delay.recorded
    ))
}

/// What a difference looks like; `cells`: whether the columns are those of a picture.
pub(in crate::predictor) fn looks(difference: Difference, columns: &[&str], cells: bool) -> String {
    match difference {
        Difference::Exchanged([a, b]) => format!("{} and {} look exchanged", columns[a], columns[b]),
        Difference::Ordered(order) => format!("the picture looks {}", TURNED[order]),
        Difference::Turned { columns: [a, b], by_deg } => {
            format!("{} and {} look turned by {:.0} degrees (mounted otherwise?)", columns[a], columns[b], by_deg.abs())
        }
        Difference::Scaled { column, by } => match by {
            -2.0..-0.5 => {
                // Of a nail that is alike on both sides it is the same.
                let mirrored = if cells { " (or the picture is mirrored)" } else { "" };
                format!("{} looks to have the other sign{mirrored}", columns[column])
            }
            _ => {
                // To two digits.
                let unit = 10f64.powi(1 - by.abs().log10().floor() as i32);
                format!("{} looks {} times as large", columns[column], short((by * unit).round() / unit))
            }
        },
    }
}

/// What to say of files, as ranges of rows, that contradict the others; `orders` are those of [`TURNED`], of cells.
pub(super) fn mismatched(data: &Dataset, parts: &[Range<usize>], orders: &[Vec<usize>], names: &[&str]) -> Vec<String> {
    let Some(compared) = Parts::of(data, parts) else { return Vec::new() };
    let all = compared.mismatches(orders);
    if all.is_empty() {
        return of_several_persons(data, &compared, names).into_iter().collect();
    }
    let columns: Vec<&str> = data.inputs().iter().chain(data.targets()).map(String::as_str).collect();
    // Of two that contradict each other it isn't known which is right.
    let one_of_two = parts.len() == 2 && all.len() == 2;
    let named = if one_of_two { &all[1..] } else { &all[..] };
    let say = |one: &Mismatch| {
        let (whose, others) = match one_of_two {
            true => (format!("{} and {} contradict each other: in one of them", names[0], names[1]), "the other one's"),
            false => (format!("{} contradicts the other files: in it", names[one.part]), "its"),
        };
        format!(
            "{whose} {}; put right, a linear model of the rest leaves {:.0} % of {others} variance unexplained instead \
             of {:.0} %",
            looks(one.difference, &columns, !orders.is_empty()),
            100.0 * one.mended,
            100.0 * one.recorded
        )
    };
    named.iter().map(say).collect()
}

/// Recordings that are parts of others beside them, and not whole copies, which are named elsewhere.
pub(super) fn within(data: &Dataset) -> Option<String> {
    let hashes = recording_hashes(data);
    let all: Vec<(usize, usize)> =
        shared_within(data).into_iter().filter(|(part, whole)| hashes[*part] != hashes[*whole]).collect();
    let [part, whole] = all.first().map(|&(part, whole)| [part, whole].map(|k| &data.recordings()[k].name))?;
    let more = if all.len() > 1 { format!(" ({} more alike)", all.len() - 1) } else { String::new() };
    Some(format!(
        "{part}: its rows are, or lie between, those of {whole}, by time and voltages, perhaps on another clock: a \
         part or a copy of it{more}? It counts twice; keep one"
    ))
}

/// The persons that recordings are known to be of; where nobody says whose a file is, its name stands for one.
pub(in crate::predictor) fn persons<'a>(data: &'a Dataset, files: &[&str]) -> BTreeSet<&'a str> {
    data.recordings().iter().map(|one| one.subject.as_str()).filter(|person| !files.contains(person)).collect()
}

/// What to say where files that are not known to be several persons' are as different as these.
fn of_several_persons(data: &Dataset, parts: &Parts, names: &[&str]) -> Option<String> {
    if persons(data, names).len() > 1 {
        return None;
    }
    let Apart { part, target, times } = parts.apart()?;
    Some(format!(
        "one linear model of all files leaves {times:.1} times the error in {} that one of each file leaves, and fits \
         {} worst: is that another finger, or were transducer or sensor mounted otherwise? Models are of one person",
        data.targets()[target],
        names[part]
    ))
}

/// A number without the hundreds of zeros of one near 1e-300, or the sign of one that is 0.
fn short(value: f64) -> String {
    let text = format!("{:?}", value + 0.0);
    text.strip_suffix(".0").map_or(text.clone(), str::to_owned)
}
