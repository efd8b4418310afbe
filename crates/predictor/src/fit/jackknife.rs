//! Standard errors of coefficients where residuals go together: of rows that follow each other, and of all rows of a
//! recording.
//!
//! In: terms and targets, both about their means, and which rows are whose recording. Out: how far each coefficient
//! moves as parts of the rows are left out one after the other (Künsch 1989, doi:10.1214/aos/1176347265). Parts are
//! blocks of time of each recording and, where there are several, once more whole recordings; the larger error counts.
//! Blocks don't show how recordings differ (of four days errors are 4 to 5 times too short), and few recordings hardly
//! do (of two of one day, 1.96 errors hold 82 %).
//!
//! No part is fitted again. With R the triangle of all rows A, a part's rows A_p and residuals e_p, H = R^-T A_p^T A_p
//! R^-1 and s = R^-T A_p^T e_p, without the part coefficients are R^-1 (I - H)^-1 s less. Covariances that lack H,
//! which is large where parts are few, are too short on the same phantoms: Newey and West's of 250 rows by 1.3 to 5.5,
//! sums over recordings by up to 4.9.

use std::ops::Range;

use ndarray::{Array2, ArrayView2, Axis, concatenate};
use rayon::prelude::*;

use crate::Recording;
use crate::algebra::cholesky::{Cholesky, back, forward};
use crate::least_squares::triangle;

/// Blocks of a recording. Measured on phantoms, the SD of a linear model's coefficients over repetitions of one person
/// and day over the RMS error, medians: of one spiral (96) or random movement (48) 0.78 and 0.81, and 1.96 errors hold
/// 93 and 92 %; with 10 blocks 0.86 and 1.19, 92 and 83 %; with 5 blocks 0.74 and 0.71, 91 and 90 %. On 48 others of
/// each that chose nothing: 0.85 and 0.76, 91 and 91 %.
const BLOCKS: usize = 6;

/// A part that holds all but this share of a direction decides it: without it nothing is known, and neither is the
/// error. Assumed: rounding leaves some 1e-15.
const DECISIVE: f64 = 1e-9;

/// Appends the terms of a row, about their means, to others.
pub(super) type Terms<'a> = dyn Fn(usize, &mut Vec<f64>) + Sync + 'a;

/// Of targets x the terms that are `kept`; `row` appends the terms of a row, then its targets, so many of both. None
/// where a part decides a term alone, or there is only one part.
pub(super) fn standard_errors(
    row: &Terms<'_>,
    [terms, targets]: [usize; 2],
    kept: &[usize],
    recordings: &[Recording],
) -> Option<Vec<Vec<f64>>> {
    if kept.is_empty() {
        return None;
    }
    let width = 1 + terms + targets;
    let columns: Vec<usize> =
        std::iter::once(0).chain(kept.iter().map(|term| 1 + term)).chain(1 + terms..width).collect();
    let block = |rows: Range<usize>| {
        let mut values = Vec::with_capacity(rows.len() * width);
        for k in rows.clone() {
            values.push(1.0);
            row(k, &mut values);
        }
        let rows = ArrayView2::from_shape((rows.len(), width), &values).ok()?;
        Some(triangle(rows).select(Axis(1), &columns))
    };
    let cut = |one: &Recording| {
        let end = |block: usize| one.rows.start + block * one.rows.len() / BLOCKS;
        let blocks = (0..BLOCKS).map(|block| end(block)..end(block + 1)).filter(|rows| !rows.is_empty());
        blocks.collect::<Vec<_>>().into_par_iter().map(block).collect::<Option<Vec<_>>>()
    };
    let blocks: Vec<Vec<Array2<f64>>> = recordings.iter().map(cut).collect::<Option<_>>()?;
    let whole = Whole::new(&blocks, 1 + kept.len())?;
    let parts: Vec<Vec<Part>> = blocks.iter().map(|one| one.iter().map(|block| whole.part(block)).collect()).collect();
    let recordings: Vec<Part> = parts.iter().filter_map(|one| one.iter().cloned().reduce(Part::plus)).collect();
    let mut errors = whole.jackknife(&parts.concat())?;
    if recordings.len() > 1 {
        let others = whole.jackknife(&recordings)?;
        errors.iter_mut().flatten().zip(others.iter().flatten()).for_each(|(error, other)| *error = error.max(*other));
    }
    Some(errors)
}

/// What a part of the rows adds.
#[derive(Debug, Clone)]
struct Part {
    /// H, row by row.
    share: Vec<f64>,
    /// s, a target each.
    sides: Vec<Vec<f64>>,
}

impl Part {
    fn plus(mut self, other: Self) -> Self {
        let add = |to: &mut [f64], from: &[f64]| to.iter_mut().zip(from).for_each(|(to, from)| *to += from);
        add(&mut self.share, &other.share);
        self.sides.iter_mut().zip(&other.sides).for_each(|(to, from)| add(to, from));
        self
    }
}

/// The fit of all rows.
struct Whole {
    /// The triangle R of ones and terms, row by row.
    factor: Vec<f64>,
    /// How many these are.
    count: usize,
    /// Coefficients of ones and terms, a target each.
    coefficients: Vec<Vec<f64>>,
}

impl Whole {
    /// From the triangles of all blocks.
    fn new(blocks: &[Vec<Array2<f64>>], count: usize) -> Option<Self> {
        let views: Vec<ArrayView2<'_, f64>> = blocks.iter().flatten().map(|block| block.view()).collect();
        let whole = triangle(concatenate(Axis(0), &views).ok()?.view());
        let factor: Vec<f64> =
            whole.outer_iter().take(count).flat_map(|row| row.to_vec().into_iter().take(count)).collect();
        let solved = |target: usize| {
            let mut side: Vec<f64> = whole.column(target).iter().copied().take(count).collect();
            back(&factor, &mut side);
            side
        };
        let coefficients = (count..whole.ncols()).map(solved).collect();
        Some(Self { factor, count, coefficients })
    }

    /// Of a block's triangle.
    fn part(&self, block: &Array2<f64>) -> Part {
        let count = self.count;
        let mut part = Part { share: vec![0.0; count * count], sides: vec![vec![0.0; count]; self.coefficients.len()] };
        for row in block.outer_iter() {
            let mut row = row.to_vec();
            let targets = row.split_off(count);
            let residuals: Vec<f64> = targets
                .iter()
                .zip(&self.coefficients)
                .map(|(target, own)| target - row.iter().zip(own).map(|(term, own)| term * own).sum::<f64>())
                .collect();
            forward(&self.factor, &mut row);
            for (to, a) in part.share.chunks_exact_mut(count).zip(&row) {
                to.iter_mut().zip(&row).for_each(|(to, b)| *to += a * b);
            }
            for (to, residual) in part.sides.iter_mut().zip(residuals) {
                to.iter_mut().zip(&row).for_each(|(to, a)| *to += a * residual);
            }
        }
        part
    }

    /// Of parts that are all rows together.
    fn jackknife(&self, parts: &[Part]) -> Option<Vec<Vec<f64>>> {
        let count = self.count;
        if parts.len() < 2 {
            return None;
        }
        let mut squares = vec![vec![0.0; count - 1]; self.coefficients.len()];
        for part in parts {
            let mut left: Vec<f64> = part.share.iter().map(|share| -share).collect();
            left.iter_mut().step_by(count + 1).for_each(|own| *own += 1.0);
            let left = Cholesky::of(left, count, -DECISIVE)?;
            for (squares, side) in squares.iter_mut().zip(&part.sides) {
                let mut moved = side.clone();
                left.solve(&mut moved);
                back(&self.factor, &mut moved);
                squares.iter_mut().zip(&moved[1..]).for_each(|(sum, moved)| *sum += moved * moved);
            }
        }
        let share = (parts.len() - 1) as f64 / parts.len() as f64;
        squares.iter_mut().flatten().for_each(|sum| *sum = (share * *sum).sqrt());
        Some(squares)
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;
    use crate::{
        Dataset, Deficient, Kind, LeastSquaresOptions, Predictor, Recipe, Report, fit_linear, fit_quadratic,
        least_squares,
    };

    const INPUTS: usize = 3;
    /// Relative; measured 3e-9, which is [`DECISIVE`].
    const TWIN: f64 = 3e-8;

    /// Recordings whose inputs and residuals wander (correlation of neighbours 0.97); slopes of each recording differ
    /// by `own`.
    fn wandering(count: usize, rows: usize, own: f64, seed: u64) -> Dataset {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut normal = move || -> f64 { StandardNormal.sample(&mut random) };
        let n = count * rows;
        let (mut x, mut y) = (Array2::zeros((n, INPUTS)), Array2::zeros((n, 1)));
        for recording in 0..count {
            let slopes: [f64; INPUTS] = std::array::from_fn(|_| 1.0 + own * normal());
            let mut at = [0.0; INPUTS + 1];
            for row in recording * rows..(recording + 1) * rows {
                at.iter_mut().for_each(|value| *value = 0.97 * *value + 0.243 * normal());
                y[[row, 0]] = at[INPUTS] + slopes.iter().zip(&at).map(|(slope, x)| slope * x).sum::<f64>();
                (0..INPUTS).for_each(|k| x[[row, k]] = 2.5 + at[k]);
            }
        }
        let of = |k: usize| Recording::of(format!("r{k}"), k * rows..(k + 1) * rows);
        let names = (1..=INPUTS).map(|k| format!("P{k}")).collect();
        let time = (0..n).map(|row| 0.04 * (row % rows) as f64).collect();
        Dataset::new(names, vec!["Fz_N".into()], time, x, y, (0..count).map(of).collect()).unwrap()
    }

    fn asked() -> LeastSquaresOptions {
        LeastSquaresOptions { standard_errors: true, ..LeastSquaresOptions::default() }
    }

    fn fitted(data: &Dataset) -> (Vec<f64>, Vec<f64>) {
        let (model, report) = fit_linear(data, &asked()).unwrap();
        let errors = report.standard_errors[0].iter().map(|error| error.unwrap()).collect();
        (model.jacobian().row(0).to_vec(), errors)
    }

    #[test]
    fn each_part_is_left_out() {
        for count in [1, 3] {
            let data = wandering(count, 131, 0.3, 5);
            let jackknife = |parts: &[Vec<usize>]| {
                let moved = |part: &Vec<usize>| {
                    let rest: Vec<usize> = (0..data.rows()).filter(|row| !part.contains(row)).collect();
                    let alone = fitted(&data.only_rows(&rest)).0;
                    alone.iter().zip(fitted(&data).0).map(|(alone, all)| (alone - all).powi(2)).collect()
                };
                let squares: Vec<Vec<f64>> = parts.iter().map(moved).collect();
                let share = (parts.len() as f64 - 1.0) / parts.len() as f64;
                let error = |k: usize| (share * squares.iter().map(|one| one[k]).sum::<f64>()).sqrt();
                (0..INPUTS).map(error).collect::<Vec<f64>>()
            };
            let of = |one: &Recording, block: usize| one.rows.start + block * one.rows.len() / BLOCKS;
            let cut = |one: &Recording| (0..BLOCKS).map(|k| (of(one, k)..of(one, k + 1)).collect()).collect::<Vec<_>>();
            let blocks: Vec<Vec<usize>> = data.recordings().iter().flat_map(cut).collect();
            let whole: Vec<Vec<usize>> = data.recordings().iter().map(|one| one.rows.clone().collect()).collect();
            let by_recording = if count > 1 { jackknife(&whole) } else { vec![0.0; INPUTS] };
            let want: Vec<f64> = jackknife(&blocks).iter().zip(by_recording).map(|(a, b)| a.max(b)).collect();
            for (found, want) in fitted(&data).1.iter().zip(&want) {
                assert!((found / want - 1.0).abs() <= TWIN, "{count}: {found} {want}");
            }
        }
    }

    #[test]
    fn errors_are_those_of_repetitions() {
        // Recordings, how much their slopes differ. The SD of coefficients over 200 repetitions, over the RMS error:
        // measured 0.96, 0.90, 0.98; over that of independent residuals 5.6, 5.6, 12.3.
        for (count, own) in [(1, 0.0), (4, 0.0), (4, 1.0)] {
            let (mut all, mut squares, mut plain) = (Vec::new(), 0.0, 0.0);
            for seed in 0..200 {
                let data = wandering(count, 1500 / count, own, seed);
                let (coefficients, errors) = fitted(&data);
                let white = least_squares(data.x().view(), data.y().view(), &LeastSquaresOptions::default()).unwrap();
                all.push(coefficients);
                squares += errors.iter().map(|error| error.powi(2)).sum::<f64>();
                plain += white.standard_errors.iter().map(|error| error.powi(2)).sum::<f64>();
            }
            let off: f64 = all.iter().flatten().map(|slope| (slope - 1.0).powi(2)).sum();
            let [ratio, white] = [squares, plain].map(|squares| (off / squares).sqrt());
            println!("{count} {own}: {ratio:.2}, of independent residuals {white:.2}");
            assert!((0.8..1.25).contains(&ratio) && white > 3.0, "{count} {own}: {ratio} {white}");
        }
    }

    #[test]
    fn what_one_part_decides_has_no_error_and_what_is_dropped_neither() {
        // P1 moves in one block of the recording only.
        let data = wandering(1, 120, 0.0, 3);
        let still =
            |(row, k): (usize, usize)| if k == 0 && !(20..40).contains(&row) { 2.5 } else { data.x()[[row, k]] };
        let x = Array2::from_shape_fn(data.x().dim(), still);
        let data = Dataset::plain(data.inputs().to_vec(), data.targets().to_vec(), x, data.y().clone(), 0.04).unwrap();
        let (_, report) = fit_linear(&data, &asked()).unwrap();
        assert_eq!(report.standard_errors, [vec![None; INPUTS]]);
        // P2 is P3.
        let data = wandering(2, 120, 0.0, 3);
        let x = Array2::from_shape_fn(data.x().dim(), |(row, k)| data.x()[[row, if k == 1 { 2 } else { k }]]);
        let data = Dataset::plain(data.inputs().to_vec(), data.targets().to_vec(), x, data.y().clone(), 0.04).unwrap();
        let options = LeastSquaresOptions { deficient: Deficient::Drop, ..asked() };
        let (_, report) = fit_linear(&data, &options).unwrap();
        assert_eq!(report.standard_errors[0].iter().filter(|error| error.is_some()).count(), 2, "{report:?}");
        let options = LeastSquaresOptions { deficient: Deficient::MinimumNorm, ..options };
        let (_, report) = fit_linear(&data, &options).unwrap();
        assert_eq!(report.standard_errors, [vec![None; INPUTS]]);
    }

    #[test]
    fn errors_of_products_are_in_the_model_s_own_units() {
        let data = wandering(1, 600, 0.0, 4);
        let (_, report) = fit_quadratic(&data, &asked()).unwrap();
        let scaled = data.x().mapv(|volts| 1024.0 * volts);
        let scaled =
            Dataset::plain(data.inputs().to_vec(), data.targets().to_vec(), scaled, data.y().clone(), 0.04).unwrap();
        let (_, again) = fit_quadratic(&scaled, &asked()).unwrap();
        assert_eq!(report.standard_errors, again.standard_errors);
        assert!(report.standard_errors[0].iter().all(|error| error.is_some_and(|error| error > 0.0)), "{report:?}");
    }

    #[test]
    fn a_model_to_be_kept_has_them_and_fits_of_parts_do_not() {
        let data = wandering(2, 300, 0.3, 6);
        let recipe = Recipe::new(Kind::Linear);
        let errors = |report: &Report| match report {
            Report::LeastSquares(report) => report.standard_errors[0].clone(),
            _ => Vec::new(),
        };
        let kept = Predictor::fit(&data, None, &recipe).unwrap();
        let expected: Vec<Option<f64>> = fitted(&data).1.into_iter().map(Some).collect();
        assert_eq!(errors(&kept.training().report), expected);
        assert_eq!(errors(&recipe.fit(&data, None).unwrap().report), vec![None; INPUTS]);
    }
}
