//! What each person's recordings give by themselves, or each recording where all are one person's: whether one value
//! for all holds.
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

/// Two values differ where they are so many of their standard errors apart, and by so much of the smaller one
/// (assumed).
const ERRORS: f64 = 4.0;
const MATTERS: f64 = 0.1;
/// A sensor that is put on again changes its scaling by less than so many times (assumed).
const PUT_ON_AGAIN: f64 = 2.0;

/// What a part of the recordings gives.
#[derive(Debug, Clone, Serialize)]
pub struct Alone {
    /// The person, or the recording where all are one person's.
    pub name: String,
    /// The free groups, as those of the fit of all, without intervals.
    pub free: Vec<Group>,
    /// Scalings of photodiodes.
    #[serde(skip)]
    scalings: Vec<(Symbol, Estimate)>,
    /// Whether its standard errors say how sure it is: nothing is held at a bound, and nothing else fits as well.
    #[serde(skip)]
    is_sure: bool,
}

/// The parts: each person's recordings, or each recording where all are one person's; none where there is only one.
pub(super) fn parts(inputs: &FitInputs) -> Vec<(&str, Vec<usize>)> {
    let all = 0..inputs.recordings.len();
    let mut persons: Vec<(&str, Vec<usize>)> = Vec::new();
    for k in all {
        match persons.iter_mut().find(|(name, _)| *name == inputs.subject(k)) {
            Some((_, own)) => own.push(k),
            None => persons.push((inputs.subject(k), vec![k])),
        }
    }
    match persons.len() {
        1 => persons.remove(0).1.into_iter().map(|k| ("", vec![k])).filter(|_| inputs.recordings.len() > 1).collect(),
        _ => persons,
    }
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
    let of = |(name, own): &(&str, Vec<usize>)| {
        let recordings: Vec<_> = own.iter().map(|&k| all[k].recording.clone()).collect();
        let found = search(&recordings, start, free, &settings).ok()?;
        let name = if name.is_empty() { all[own[0]].name.clone() } else { (*name).to_owned() };
        let scalings = found.photodiodes.iter().map(|one| (Symbol::Scaling(one.unit), one.scaling));
        let is_sure = found.rivals.is_empty() && found.groups.iter().all(|group| group.at_bound.is_none());
        Some(Alone { name, scalings: scalings.collect(), free: found.groups, is_sure })
    };
    parts(inputs).par_iter().filter_map(of).collect()
}

/// What to say of parts that contradict each other.
pub(super) fn warnings(all: &[Alone], inputs: &FitInputs, options: &FitOptions) -> Vec<String> {
    let are_persons = parts(inputs).iter().any(|(name, _)| !name.is_empty());
    let count = all.first().map_or(0, |one| one.free.len());
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
    let mut symbols: Vec<Symbol> = Vec::new();
    for (symbol, _) in all.iter().flat_map(|one| &one.scalings).filter(|_| is_shared) {
        if !symbols.contains(symbol) {
            symbols.push(*symbol);
        }
    }
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
    (0..count).filter_map(of_group).chain(symbols.into_iter().filter_map(of_scaling)).collect()
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
