//! Which photodiodes the linear model needs: every subset of them (Fig. 113 and beyond, 5.5).
//!
//! In: training and validation rows. Out: for each non-empty subset the RMSE of the linear model of those photodiodes
//! (with its offset), fitted to the training rows and tried on both; the best of each size; the figure's bars, none and
//! each photodiode removed.
//!
//! Each set of rows is compressed once, without loss, into a triangle as wide as it has columns (QR of the centred
//! columns); each subset is then solved from its columns of that triangle. The figures are those of a fit to all rows,
//! not an approximation. No normal equations.
//!
//! The criterion for the best: the mean over targets of validation RMSE over the target's SD on the training rows (with
//! n); a target that is constant in training does not count. So 1 is what the mean alone would reach, and forces and
//! angles weigh alike. Ties go to the lower mask. As the validation rows choose the subset, they flatter it: report the
//! chosen one on rows used for neither.
//!
//! A subset whose photodiodes are not independent of each other on the training rows (dead, constant, duplicated, too
//! few rows) has no errors, only its rank. Dependent is what is left with no more beside the others than rounding may
//! have made, as in [`least_squares`](crate::least_squares()).

mod compress;
mod layout;
mod solve;

use rayon::prelude::*;
use serde::Serialize;
use thiserror::Error;

pub use self::layout::{
    Candidate, Choice, Criterion, LayoutFault, LayoutProblem, MOST_CANDIDATES, Moments, Proof, Rules, Starts,
    determinant, pivoted, prove, search,
};

use self::compress::Compressed;
use self::solve::solve;
use crate::Dataset;
use crate::algebra::small::norm;

/// The most photodiodes whose every subset is looked at: 65 535 subsets.
pub const MOST_INPUTS: usize = 16;

/// Errors of the linear model of some photodiodes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SubsetErrors {
    /// On the training rows, a target each in its unit.
    pub train_rmse: Vec<f64>,
    /// On the validation rows.
    pub validate_rmse: Vec<f64>,
    /// Mean over targets of validation RMSE over the training SD; none where all targets are constant.
    pub score: Option<f64>,
}

/// Some photodiodes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Subset {
    /// Bit k stands for the k-th photodiode.
    pub mask: u32,
    /// Which, by column.
    pub inputs: Vec<usize>,
    /// How many of them are independent on the training rows.
    pub rank: usize,
    /// Errors; none where they are not all independent, or where an error is beyond a double.
    pub errors: Option<SubsetErrors>,
}

/// All photodiodes but one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct WithoutOne {
    /// The one removed, by column; none removed first.
    pub removed: Option<usize>,
    /// Its place in [`Subsets::all`].
    pub subset: usize,
}

/// Every subset.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Subsets {
    /// Names of the photodiodes.
    pub inputs: Vec<String>,
    /// Names of the targets.
    pub targets: Vec<String>,
    /// Of no photodiode at all: the training rows' mean.
    pub none: SubsetErrors,
    /// By mask: subset m is at m - 1.
    pub all: Vec<Subset>,
    /// The place of the best of 1, 2, .. photodiodes; none where no subset of that size has a score.
    pub best_of_size: Vec<Option<usize>>,
    /// The bars of Fig. 113: none removed, then each.
    pub without_one: Vec<WithoutOne>,
}

/// Why subsets are not looked at.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum SubsetFault {
    #[error("the validation rows have other photodiodes or targets than the training rows")]
    Columns,
    #[error("there are no {0}")]
    Empty(&'static str),
    #[error(
        "{inputs} photodiodes have too many subsets to look at each; choose at most {most} of them, or remove one \
         after the other"
    )]
    TooMany { inputs: usize, most: usize },
}

/// Looks at every non-empty subset of at most [`MOST_INPUTS`] photodiodes. The result does not depend on the number of
/// threads.
pub fn every_subset(train: &Dataset, validate: &Dataset) -> Result<Subsets, SubsetFault> {
    check(train, validate, MOST_INPUTS)?;
    let inputs = train.inputs().len();
    let rows = Compressed::new(train, validate);
    let full = u32::MAX >> (32 - inputs);
    let all: Vec<Subset> = (1..=full).into_par_iter().map(|mask| subset(&rows, mask).0).collect();
    let place = |mask: u32| mask as usize - 1;
    let best = |size: usize| {
        let own = all.iter().enumerate().filter(|(_, one)| one.inputs.len() == size);
        let scored = own.filter_map(|(place, one)| Some((place, one.errors.as_ref()?.score?)));
        scored.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(place, _)| place)
    };
    let removed = (0..inputs).filter(|_| inputs > 1);
    let without = removed.map(|k| WithoutOne { removed: Some(k), subset: place(full & !(1 << k)) });
    Ok(Subsets {
        inputs: train.inputs().to_vec(),
        targets: train.targets().to_vec(),
        none: errors_of_none(&rows),
        best_of_size: (1..=inputs).map(best).collect(),
        without_one: std::iter::once(WithoutOne { removed: None, subset: place(full) }).chain(without).collect(),
        all,
    })
}

/// Removes the photodiode that is missed least, again and again: the subsets of all, all but one, .. one. Not every
/// subset is looked at, so the best of a size may be missed; for more photodiodes than [`MOST_INPUTS`], at most 32.
/// While photodiodes are dependent, those that others stand for go first.
pub fn backward_elimination(train: &Dataset, validate: &Dataset) -> Result<Vec<Subset>, SubsetFault> {
    check(train, validate, 32)?;
    let rows = Compressed::new(train, validate);
    let (mut now, mut order) = subset(&rows, u32::MAX >> (32 - train.inputs().len()));
    let mut path = Vec::new();
    while now.inputs.len() > 1 {
        // Dependent ones leave in the reverse order of pivoting; of independent ones each is tried.
        let without = |k: usize| now.mask & !(1 << now.inputs[k]);
        let masks: Vec<u32> = if now.rank < now.inputs.len() {
            order.last().map(|&last| without(last)).into_iter().collect()
        } else {
            (0..now.inputs.len()).map(without).collect()
        };
        let score = |one: &Subset| one.errors.as_ref().and_then(|errors| errors.score).unwrap_or(f64::INFINITY);
        let mut tried: Vec<(Subset, Vec<usize>)> = masks.par_iter().map(|&mask| subset(&rows, mask)).collect();
        tried.sort_by(|(a, _), (b, _)| score(a).total_cmp(&score(b)).then(a.mask.cmp(&b.mask)));
        let next = tried.swap_remove(0);
        path.push(std::mem::replace(&mut now, next.0));
        order = next.1;
    }
    path.push(now);
    Ok(path)
}

fn check(train: &Dataset, validate: &Dataset, most: usize) -> Result<(), SubsetFault> {
    let inputs = train.inputs().len();
    if inputs > most {
        return Err(SubsetFault::TooMany { inputs, most });
    }
    if train.inputs() != validate.inputs() || train.targets() != validate.targets() {
        return Err(SubsetFault::Columns);
    }
    let counts = [
        (inputs, "photodiodes"),
        (train.targets().len(), "targets"),
        (train.rows(), "training rows"),
        (validate.rows(), "validation rows"),
    ];
    match counts.into_iter().find(|&(count, _)| count == 0) {
        Some((_, what)) => Err(SubsetFault::Empty(what)),
        None => Ok(()),
    }
}

/// One subset, and its photodiodes (by place in `inputs`) in the order of pivoting.
fn subset(rows: &Compressed, mask: u32) -> (Subset, Vec<usize>) {
    let inputs: Vec<usize> = (0..rows.inputs).filter(|k| mask & (1 << k) != 0).collect();
    let columns: Vec<&[f64]> = inputs.iter().map(|&k| rows.train[k].as_slice()).collect();
    let targets: Vec<&[f64]> = rows.train[rows.inputs..].iter().map(Vec::as_slice).collect();
    let limits: Vec<f64> = inputs.iter().map(|&k| rows.limits[k]).collect();
    let solved = solve(&columns, &targets, &limits);
    // Centring takes one row's worth: n rows tell at most n - 1 photodiodes apart.
    let rank = solved.rank.min(rows.train_rows - 1);
    let errors = (rank == inputs.len()).then(|| {
        let left = solved.coefficients.iter().enumerate().map(|(target, coefficients)| {
            let mut left = rows.validate[rows.inputs + target].clone();
            for (&k, slope) in inputs.iter().zip(coefficients) {
                left.iter_mut().zip(&rows.validate[k]).for_each(|(left, value)| *left -= slope * value);
            }
            norm(&left)
        });
        errors(rows, &solved.left, &left.collect::<Vec<_>>())
    });
    let finite = |errors: &SubsetErrors| errors.train_rmse.iter().chain(&errors.validate_rmse).all(|v| v.is_finite());
    (Subset { mask, inputs, rank, errors: errors.filter(finite) }, solved.order)
}

fn errors_of_none(rows: &Compressed) -> SubsetErrors {
    let norms = |columns: &[Vec<f64>]| columns[rows.inputs..].iter().map(|column| norm(column)).collect::<Vec<_>>();
    errors(rows, &norms(&rows.train), &norms(&rows.validate))
}

/// Errors from norms of what is left of each target.
fn errors(rows: &Compressed, train: &[f64], validate: &[f64]) -> SubsetErrors {
    let (n, m) = ((rows.train_rows as f64).sqrt(), (rows.validate_rows as f64).sqrt());
    let unit = |(norm, unit): (f64, &[f64; 2])| norm * unit[0] * unit[1];
    let rmse = |norms: &[f64], n: f64| norms.iter().map(|norm| norm / n).zip(&rows.unit).map(unit).collect();
    // In the scales of the triangle a target's SD is its column's norm over n: nothing over- or underflows.
    let spread = rows.train[rows.inputs..].iter().map(|column| norm(column) / n);
    let shares: Vec<f64> =
        validate.iter().zip(spread).filter(|(_, sd)| *sd > 0.0).map(|(left, sd)| left / m / sd).collect();
    let score = (!shares.is_empty()).then(|| shares.iter().sum::<f64>() / shares.len() as f64);
    SubsetErrors { train_rmse: rmse(train, n), validate_rmse: rmse(validate, m), score }
}

#[cfg(test)]
mod tests;
