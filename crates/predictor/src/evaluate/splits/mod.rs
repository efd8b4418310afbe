//! The same models judged by several ways to hold rows out, so that what a split flatters is seen.
//!
//! In: a [`Dataset`], ways to hold out, methods. Out: of each split and method the RMSE of each target on the rows held
//! out, its 95 % interval and whether it surely beats the mean; [`leaks`]: what looks good by shuffled rows and is no
//! better than the mean with whole paths held out. The mean and the nearest row are always among the methods.

pub(super) mod baseline;
mod bootstrap;
#[cfg(test)]
mod tests;
mod units;

use std::rc::Rc;

use ndarray::Array2;
use serde::Serialize;

use super::cross::{CrossValidation, hold_out};
use super::split::{By, folds};
use crate::Dataset;
use bootstrap::Blocks;
pub use units::FEWEST_UNITS;

/// Predicts rows: rows x targets; NaN is not known.
pub type Predict<'a> = Box<dyn Fn(&Dataset) -> Array2<f64> + 'a>;

/// Of rows to train on what predicts others, or why nothing does.
pub type Fit<'a> = Box<dyn Fn(&Dataset) -> Result<Predict<'a>, String> + Sync + 'a>;

/// A way to predict.
pub struct Method<'a> {
    /// What tables call it.
    pub name: String,
    /// How it learns.
    pub fit: Fit<'a>,
}

/// A target with rows held out.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SplitTarget {
    /// Its column.
    pub name: String,
    /// Its unit; NaN of no rows.
    pub rmse: f64,
    /// The 95 % interval of that: of new persons, sessions, paths or recordings where those are held out
    /// ([`By::counts_parts`]); of shuffled rows from blocks of time drawn again, of these recordings only. None of too
    /// few.
    pub interval: Option<[f64; 2]>,
    /// Whether it is surely below the mean's error on the same rows; none where that is not known.
    pub beats_mean: Option<bool>,
}

/// A method with rows held out.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MethodScore {
    /// Which.
    pub method: String,
    /// Rows predicted.
    pub rows: usize,
    /// Target by target; empty where nothing was predicted.
    pub targets: Vec<SplitTarget>,
    /// Why not, or why not all.
    pub fault: Option<String>,
}

/// A way to hold rows out.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Split {
    /// What is held out.
    pub by: By,
    /// In how many parts; 0 where nothing can be.
    pub parts: usize,
    /// A way before it that holds out the very same parts and has the same intervals.
    pub same_as: Option<By>,
    /// Method by method: the mean, the nearest row, then those given.
    pub methods: Vec<MethodScore>,
    /// Why nothing can be held out.
    pub fault: Option<String>,
}

/// What a split by shuffled rows makes look good.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Leak {
    /// The target.
    pub target: String,
    /// The method that looks best by rows.
    pub method: String,
    /// Its RMSE by rows, the target's unit.
    pub by_rows: f64,
    /// Its RMSE with whole paths held out (recordings, where there is one path only).
    pub by_paths: f64,
    /// The mean's RMSE there.
    pub mean: f64,
}

/// What the first method is called, and the second.
const MEAN: &str = "mean";
const NEAREST: &str = "nearest row";

/// A method with paths held out may be better than the mean where its RMSE is below this share of the mean's, though
/// few paths don't make that sure: a leak is then not what the figures show. Measured: of 40 studies of a phantom
/// person's recordings of four days, in which the nearest row has 0.74 of the mean's error of Fx and 0.61 of Fz, 13 and
/// 3 would be called leaks without it, none with it; of Fy, of which nothing beats the mean, 27 and 24.
const PERHAPS_BETTER: f64 = 0.9;

/// Judges methods by each way to hold out; `inputs`: columns by which the nearest row is found. A split whose parts are
/// another's before it is not worked out again.
#[must_use]
pub fn compare_splits<'a>(data: &Dataset, inputs: &'a [usize], ways: &[By], methods: Vec<Method<'a>>) -> Vec<Split> {
    let own = |name: &str, predict: fn(&Dataset, &Dataset) -> Array2<f64>| Method {
        name: name.to_owned(),
        fit: Box::new(move |train| {
            let train = train.only_inputs(inputs);
            Ok(Box::new(move |test: &Dataset| predict(&train, &test.only_inputs(inputs))))
        }),
    };
    let mut all = vec![own(MEAN, baseline::mean), own(NEAREST, baseline::nearest)];
    all.extend(methods);
    let mut done: Vec<Done> = Vec::new();
    for &by in ways {
        let one = match folds(data, by) {
            Err(why) => {
                let split = Split { by, parts: 0, same_as: None, methods: Vec::new(), fault: Some(why.to_string()) };
                Done { parts: Vec::new(), held: Rc::default(), split }
            }
            Ok(folds) => {
                let parts: Vec<Vec<usize>> = folds.into_iter().map(|fold| fold.test).collect();
                let same = || done.iter().filter(|other| other.parts == parts);
                let held = same().next().map(|other| Rc::clone(&other.held));
                let held =
                    held.unwrap_or_else(|| Rc::new(all.iter().map(|method| held_out(data, by, method)).collect()));
                let same_as =
                    same().map(|other| other.split.by).find(|other| other.counts_parts() == by.counts_parts());
                let methods = scores(data, by, &parts, &all, &held);
                let count = parts.len();
                Done { parts, held, split: Split { by, parts: count, same_as, methods, fault: None } }
            }
        };
        done.push(one);
    }
    done.into_iter().map(|one| one.split).collect()
}

/// A split with its parts and what came of each method, which a later one of the same parts shares.
struct Done {
    parts: Vec<Vec<usize>>,
    held: Rc<Vec<Held>>,
    split: Split,
}

/// What came of a method with parts held out, or why nothing did.
type Held = Result<CrossValidation, String>;

fn held_out(data: &Dataset, by: By, method: &Method<'_>) -> Held {
    hold_out(data, by, &|train| (method.fit)(train), &|model, test| model(test)).map_err(|why| why.to_string())
}

fn scores(data: &Dataset, by: By, parts: &[Vec<usize>], methods: &[Method<'_>], held: &[Held]) -> Vec<MethodScore> {
    let mut mean: Option<Array2<f64>> = None;
    let mut scores = Vec::new();
    for (method, held) in methods.iter().zip(held) {
        scores.push(match held {
            Ok(found) => {
                let errors = found.residuals(data);
                let baseline = mean.get_or_insert_with(|| errors.clone());
                let interval = |errors: &[f64], baseline: &[f64]| match by.counts_parts() {
                    true => units::interval(parts, errors, baseline),
                    false => Blocks::of(data, errors, baseline).interval(),
                };
                score(method, found, [&errors, baseline], interval)
            }
            Err(why) => {
                MethodScore { method: method.name.clone(), rows: 0, targets: Vec::new(), fault: Some(why.clone()) }
            }
        });
    }
    scores
}

/// Of the method's errors and the mean's.
fn score(
    method: &Method<'_>,
    found: &CrossValidation,
    [errors, mean]: [&Array2<f64>; 2],
    interval: impl Fn(&[f64], &[f64]) -> Option<units::Sure>,
) -> MethodScore {
    let target = |(k, one): (usize, &super::TargetScore)| {
        let interval = interval(&errors.column(k).to_vec(), &mean.column(k).to_vec());
        SplitTarget {
            name: one.name.clone(),
            rmse: one.rmse,
            interval: interval.map(|(ends, _)| ends),
            beats_mean: interval.filter(|_| method.name != MEAN).map(|(_, below)| below),
        }
    };
    MethodScore {
        method: method.name.clone(),
        rows: found.pooled.rows,
        targets: found.pooled.targets.iter().enumerate().map(target).collect(),
        fault: found.folds.iter().find_map(|fold| fold.fault.clone()),
    }
}

/// By how much shuffled rows flatter each method: its RMSE with whole paths held out (recordings, where there is one
/// path only) over that by rows; target, method, ratio.
#[must_use]
pub fn flatteries(splits: &[Split]) -> Vec<(String, String, f64)> {
    let Some([rows, paths]) = rows_and_paths(splits) else { return Vec::new() };
    let pairs = rows.methods.iter().zip(&paths.methods).filter(|(rows, _)| rows.method != MEAN);
    let of = |(rows, paths): (&MethodScore, &MethodScore)| {
        let both = rows.targets.iter().zip(&paths.targets);
        both.map(|(a, b)| (a.name.clone(), rows.method.clone(), b.rmse / a.rmse)).collect::<Vec<_>>()
    };
    pairs.flat_map(of).filter(|(_, _, ratio)| ratio.is_finite()).collect()
}

fn rows_and_paths(splits: &[Split]) -> Option<[&Split; 2]> {
    let with = |is: fn(By) -> bool| splits.iter().find(|split| split.parts > 0 && is(split.by));
    let paths = with(|by| by == By::Path).or_else(|| with(|by| by == By::Trajectory))?;
    Some([with(|by| matches!(by, By::Rows { .. }))?, paths])
}

/// Targets that no method knows better than the mean where whole paths are held out (recordings, where there is one
/// path only), neither surely nor by a tenth of its error, though one surely does by shuffled rows.
#[must_use]
pub fn leaks(splits: &[Split]) -> Vec<Leak> {
    let Some([rows, paths]) = rows_and_paths(splits) else { return Vec::new() };
    let Some(mean) = paths.methods.iter().find(|one| one.method == MEAN) else { return Vec::new() };
    let one = |(k, at): (usize, &SplitTarget)| {
        let of = |one: &MethodScore| one.targets.get(k).cloned();
        let better = |held: SplitTarget| held.beats_mean == Some(true) || held.rmse < PERHAPS_BETTER * at.rmse;
        if paths.methods.iter().filter_map(of).any(better) {
            return None;
        }
        let better = rows.methods.iter().filter_map(|one| Some((one, of(one)?)));
        let better = better.filter(|(_, target)| target.beats_mean == Some(true));
        let (method, best) = better.min_by(|a, b| a.1.rmse.total_cmp(&b.1.rmse))?;
        let held = paths.methods.iter().find(|one| one.method == method.method).and_then(of)?;
        Some(Leak {
            target: at.name.clone(),
            method: method.method.clone(),
            by_rows: best.rmse,
            by_paths: held.rmse,
            mean: at.rmse,
        })
    };
    mean.targets.iter().enumerate().filter_map(one).collect()
}
