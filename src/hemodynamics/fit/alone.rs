//! What each person's recordings give by themselves, and each of several recordings of a person: whether one value for
//! all holds.
//!
//! The standard errors of a fit of all know the noise of the voltages, not how fingers differ: of two phantoms of 7e4
//! and 1.3e5 N/m the common `k_C` is 7.0e4 with a standard error of 0.7 %.

use lunula_hemodynamics::{
    Calibration, Estimate, FitOptions as Settings, Free, Group, Parameters, Symbol, fit as search,
};
use rayon::prelude::*;
use serde::Serialize;

use super::recording::ReadRecording;
use super::{FitInputs, FitOptions};
use crate::words::{grouped, in_order};

/// Two values differ where they are so many of their standard errors apart, and by so much of the smaller one
/// (assumed; 120 fits of two to four phantom recordings of one finger, of steps, waves and equilibria, with noise of
/// 0.0005 to 0.05 V, say nothing).
const ERRORS: f64 = 4.0;
const MATTERS: f64 = 0.1;
/// A sensor that is put on again changes its scaling by less than so many times (assumed).
const PUT_ON_AGAIN: f64 = 2.0;

/// What a part of the recordings gives.
#[derive(Debug, Clone, Serialize)]
pub struct Alone {
    /// The person; of a recording, its name.
    pub name: String,
    /// Of a recording, whose it is.
    pub of: Option<String>,
    /// The free groups, as those of the fit of all, without intervals.
    pub free: Vec<Group>,
    /// Scalings of photodiodes.
    #[serde(skip)]
    scalings: Vec<(Symbol, Estimate)>,
    /// Whether its standard errors say how sure it is: nothing is held at a bound, and nothing else fits as well.
    #[serde(skip)]
    is_sure: bool,
}

/// Recordings that are fitted by themselves.
struct Part<'a> {
    person: &'a str,
    /// One of several of this person's.
    is_one_of: bool,
    recordings: Vec<usize>,
}

/// Each person's recordings where there are several persons, then each of those of whom there are several.
fn parts(inputs: &FitInputs) -> Vec<Part<'_>> {
    let of_person = |(person, recordings)| Part { person, is_one_of: false, recordings };
    let all = (0..inputs.recordings.len()).map(|k| (inputs.subject(k), k));
    let mut persons: Vec<Part<'_>> = grouped(all).into_iter().map(of_person).collect();
    let several = persons.iter().filter(|part| part.recordings.len() > 1);
    let each = several.flat_map(|part| {
        part.recordings.iter().map(|&k| Part { person: part.person, is_one_of: true, recordings: vec![k] })
    });
    let each: Vec<Part<'_>> = each.collect();
    if persons.len() == 1 {
        persons.clear();
    }
    persons.extend(each);
    persons
}

/// How many parts are fitted by themselves.
pub(super) fn count(inputs: &FitInputs) -> usize {
    parts(inputs).len()
}

/// Fits each part by itself. Those to which nothing can be fitted are left out.
pub(super) fn each(
    inputs: &FitInputs,
    all: &[ReadRecording],
    start: &Parameters,
    free: &[Free],
    settings: &Settings,
) -> Vec<Alone> {
    let settings = Settings { intervals: false, ..settings.clone() };
    let called = |k: usize| match all.iter().filter(|read| read.name == all[k].name).count() {
        1 => all[k].name.clone(),
        _ => all[k].path.display().to_string(),
    };
    let of = |part: &Part<'_>| {
        let recordings: Vec<_> = part.recordings.iter().map(|&k| all[k].recording.clone()).collect();
        let found = search(&recordings, start, free, &settings).ok()?;
        let scalings = found.photodiodes.iter().map(|one| (Symbol::Scaling(one.unit), one.scaling));
        let is_sure = found.rivals.is_empty() && found.groups.iter().all(|group| group.at_bound.is_none());
        Some(Alone {
            name: if part.is_one_of { called(part.recordings[0]) } else { part.person.to_owned() },
            of: part.is_one_of.then(|| part.person.to_owned()),
            scalings: scalings.collect(),
            free: found.groups,
            is_sure,
        })
    };
    parts(inputs).par_iter().filter_map(of).collect()
}

/// What to say of parts that contradict each other: persons, and recordings of one of them.
pub(super) fn warnings(all: &[Alone], options: &FitOptions) -> Vec<String> {
    all.chunk_by(|a, b| a.of == b.of).flat_map(|alike| of_alike(alike, options)).collect()
}

fn of_alike(all: &[Alone], options: &FitOptions) -> Vec<String> {
    let are_persons = all[0].of.is_none();
    let of_group = |q: usize| {
        let value = |one: &Alone| {
            let group = &one.free[q];
            Some([group.values[0], group.standard_errors.as_ref()?[0]])
        };
        let [low, high] = farthest(all, value, MATTERS)?;
        let what = if are_persons {
            "persons differ: fit each one's recordings by themselves"
        } else {
            "recordings differ: are they of one finger, under one load?"
        };
        Some(format!(
            "{} is {} by {} alone and {} by {} alone: one value for both doesn't hold, and its standard error doesn't \
             include how {what}",
            all[0].free[q].symbols[0], low.1, low.0, high.1, high.0
        ))
    };
    let is_shared = match options.calibrate {
        Calibration::Shared => true,
        Calibration::PerSubject => !are_persons,
        Calibration::PerRecording | Calibration::Fixed => false,
    };
    let scalings = all.iter().flat_map(|one| &one.scalings).filter(|_| is_shared);
    let symbols = in_order(scalings.map(|(symbol, _)| *symbol));
    let of_scaling = |symbol: Symbol| {
        let value = |one: &Alone| {
            let (_, estimate) = one.scalings.iter().find(|(own, _)| *own == symbol)?;
            Some([estimate.value, estimate.standard_error?])
        };
        let [low, high] = farthest(all, value, PUT_ON_AGAIN - 1.0)?;
        Some(format!(
            "{symbol} is {} by {} alone and {} by {} alone: in another unit, or put on again? --calibrate recording \
             gives each its own",
            low.1, low.0, high.1, high.0
        ))
    };
    (0..all[0].free.len()).filter_map(of_group).chain(symbols.into_iter().filter_map(of_scaling)).collect()
}

/// The parts with the least and the greatest value, and these in words, where they differ by `matters` of the lesser.
fn farthest(all: &[Alone], value: impl Fn(&Alone) -> Option<[f64; 2]>, matters: f64) -> Option<[(&str, String); 2]> {
    let sure = all.iter().filter(|one| one.is_sure);
    let mut known: Vec<(&str, [f64; 2])> = sure.filter_map(|one| Some((one.name.as_str(), value(one)?))).collect();
    known.sort_by(|a, b| a.1[0].total_cmp(&b.1[0]));
    let [(first, low), .., (last, high)] = known[..] else { return None };
    let apart = high[0] - low[0];
    let differ = apart > ERRORS * low[1].hypot(high[1]) && apart > matters * low[0].abs().min(high[0].abs());
    let words = |[value, error]: [f64; 2]| format!("{value:.3e} +- {error:.1e}");
    differ.then(|| [(first, words(low)), (last, words(high))])
}
