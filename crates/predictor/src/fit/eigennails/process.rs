//! Which rows a Gaussian process keeps, and what it is like.
//!
//! Rows: those farthest from each other, the first nearest the mean. Length and noise: of a grid, then of finer ones
//! about the best, by the marginal likelihood of the rows kept (Rasmussen and Williams 2006, equation 2.30), in which
//! the amplitude has its own best value in closed form. The SD is then widened such that it holds on groups of rows
//! left out: rows of one recording are alike in more than the scores say, and the likelihood knows nothing of
//! that.

use ndarray::{Array2, ArrayView2, Axis};
use rayon::prelude::*;

use crate::algebra::cholesky::Cholesky;
use crate::model::{kernel, squared_distances};
use crate::{Covariance, ModelFault, Process};

/// Rows that a process keeps at most: its fit takes the cube of it; assumed.
const KEPT: usize = 300;
/// Grids of the length, SDs of the scores, and of the noise, over the amplitude squared: from, to, how many.
const LENGTHS: (f64, f64, usize) = (0.5, 128.0, 9);
const NOISES: (f64, f64, usize) = (1e-5, 1.0, 6);
/// How often the grid is made finer, three by three, by half each time.
const FINER: usize = 3;
/// Of a normal distribution this many SDs hold 95 %.
const SDS_OF_95: f64 = 1.959_963_984_540_054;

/// Fits a process of each target: `whitened` rows x modes, `spread` their SD, `groups` rows each.
pub(super) fn fit(
    whitened: &Array2<f64>,
    y: ArrayView2<'_, f64>,
    groups: &[Vec<usize>],
    spread: &[f64],
) -> Result<Process, ModelFault> {
    let kept = farthest(whitened, KEPT);
    let (rows, targets) = (whitened.select(Axis(0), &kept), y.select(Axis(0), &kept));
    let squared = squared_distances(&rows);
    let mut covariances = likeliest(&squared, &targets);
    let wider = widened(whitened, y, groups, &kept, &covariances)?;
    covariances.iter_mut().zip(wider).for_each(|(one, wider)| one.widened = wider);
    Process::new(rows, targets, covariances, spread)
}

/// At most so many rows, each the farthest from those before, ascending.
fn farthest(whitened: &Array2<f64>, most: usize) -> Vec<usize> {
    let length = |row: usize| whitened.row(row).iter().map(|value| value * value).sum::<f64>();
    let Some(first) = (0..whitened.nrows()).min_by(|&a, &b| length(a).total_cmp(&length(b))) else { return Vec::new() };
    let mut kept = vec![first];
    let mut nearest = vec![f64::INFINITY; whitened.nrows()];
    while kept.len() < most.min(whitened.nrows()) {
        let last = whitened.row(kept[kept.len() - 1]);
        for (row, nearest) in whitened.rows().into_iter().zip(&mut nearest) {
            let apart: f64 = row.iter().zip(last).map(|(a, b)| (a - b) * (a - b)).sum();
            *nearest = nearest.min(apart);
        }
        // Of equals the first; rows that are there already say nothing new.
        let next = (0..nearest.len()).rev().max_by(|&a, &b| nearest[a].total_cmp(&nearest[b]));
        match next.filter(|&next| nearest[next] > 0.0) {
            Some(next) => kept.push(next),
            None => break,
        }
    }
    kept.sort_unstable();
    kept
}

/// Length and noise of the greatest likelihood for each target.
fn likeliest(squared: &[f64], targets: &Array2<f64>) -> Vec<Covariance> {
    let columns: Vec<Vec<f64>> = targets.columns().into_iter().map(|column| column.to_vec()).collect();
    let mut best =
        vec![(f64::NEG_INFINITY, Covariance { amplitude: 0.0, length: 1.0, noise: 1.0, widened: 1.0 }); columns.len()];
    for length in grid(LENGTHS) {
        let alike = kernel(squared, length);
        for noise in grid(NOISES) {
            let Some(factor) = Cholesky::of(alike.clone(), targets.nrows(), noise) else { continue };
            for (best, column) in best.iter_mut().zip(&columns) {
                better(best, &factor, column, length, noise);
            }
        }
    }
    let step = |(from, to, count): (f64, f64, usize)| (to / from).powf(1.0 / (count as f64 - 1.0));
    let mut steps = [step(LENGTHS), step(NOISES)];
    for _ in 0..FINER {
        steps = steps.map(f64::sqrt);
        for (best, column) in best.iter_mut().zip(&columns).filter(|(best, _)| best.1.amplitude > 0.0) {
            let at = best.1;
            for length in [at.length / steps[0], at.length, at.length * steps[0]] {
                let alike = kernel(squared, length);
                for noise in [at.noise / steps[1], at.noise, at.noise * steps[1]] {
                    if let Some(factor) = Cholesky::of(alike.clone(), targets.nrows(), noise) {
                        better(best, &factor, column, length, noise);
                    }
                }
            }
        }
    }
    best.into_iter().map(|(_, one)| one).collect()
}

fn grid((from, to, count): (f64, f64, usize)) -> impl Iterator<Item = f64> {
    (0..count).map(move |k| from * (to / from).powf(k as f64 / (count as f64 - 1.0)))
}

fn better(best: &mut (f64, Covariance), factor: &Cholesky, column: &[f64], length: f64, noise: f64) {
    let (likelihood, amplitude) = log_likelihood(factor, column);
    if likelihood > best.0 {
        *best = (likelihood, Covariance { amplitude, length, noise, widened: 1.0 });
    }
}

/// The log marginal likelihood of a target with the amplitude that makes it greatest, and that amplitude; of a target
/// that does not change nothing.
fn log_likelihood(factor: &Cholesky, column: &[f64]) -> (f64, f64) {
    let rows = column.len() as f64;
    let mean = column.iter().sum::<f64>() / rows;
    let variance = factor.square(&mut column.iter().map(|value| value - mean).collect::<Vec<_>>()) / rows;
    if variance.is_nan() || variance <= 1e-24 * mean * mean {
        return (f64::NEG_INFINITY, 0.0);
    }
    let fixed = 1.0 + (2.0 * std::f64::consts::PI).ln();
    (-0.5 * (rows * (variance.ln() + fixed) + factor.log_determinant()), variance.sqrt())
}

/// By how much the SD of each target has to be wider to hold 95 % of the rows of groups left out; 1 where that is not
/// known.
fn widened(
    whitened: &Array2<f64>,
    y: ArrayView2<'_, f64>,
    groups: &[Vec<usize>],
    kept: &[usize],
    covariances: &[Covariance],
) -> Result<Vec<f64>, ModelFault> {
    let mut sds = vec![Vec::new(); covariances.len()];
    let ones = vec![1.0; whitened.ncols()];
    for group in groups {
        let rest: Vec<usize> = kept.iter().copied().filter(|row| group.binary_search(row).is_err()).collect();
        if rest.is_empty() {
            continue;
        }
        let (rows, targets) = (whitened.select(Axis(0), &rest), y.select(Axis(0), &rest));
        let others = Process::new(rows, targets, covariances.to_vec(), &ones)?;
        let far: Vec<Vec<f64>> = group
            .par_iter()
            .map(|&row| {
                let (mean, sd) = others.at(&whitened.row(row).to_vec());
                let apart = mean.iter().zip(y.row(row)).zip(sd);
                apart.map(|((mean, y), sd)| (mean - y).abs() / sd).collect()
            })
            .collect();
        for row in far {
            sds.iter_mut().zip(row).filter(|(_, sd)| sd.is_finite()).for_each(|(all, sd)| all.push(sd));
        }
    }
    let of_95 = |mut all: Vec<f64>| {
        all.sort_by(f64::total_cmp);
        let at = (0.95 * all.len() as f64).ceil() as usize;
        at.checked_sub(1).map_or(1.0, |at| (all[at] / SDS_OF_95).max(f64::MIN_POSITIVE.sqrt()))
    };
    Ok(sds.into_iter().map(of_95).collect())
}

#[cfg(test)]
/// The log marginal likelihood of a covariance.
pub(super) fn log_likelihood_of(rows: &Array2<f64>, column: &[f64], one: &Covariance) -> f64 {
    let factor = Cholesky::of(kernel(&squared_distances(rows), one.length), rows.nrows(), one.noise).unwrap();
    let (best, amplitude) = log_likelihood(&factor, column);
    // With another amplitude than the best.
    let ratio = (amplitude / one.amplitude).powi(2);
    best - 0.5 * column.len() as f64 * (ratio - 1.0 - ratio.ln())
}
