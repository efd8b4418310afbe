//! How many modes and how much shrinkage, by leaving groups of rows out.
//!
//! In: scores and targets of whole rows, and the groups. Out: the number of modes and a lambda for each target that
//! leave the least squared error on the groups left out, with those errors. What is left without a group follows from
//! sums of products, less the group's own: exactly the fit to the other rows, at the cost of a small triangle.

use ndarray::{Array2, ArrayView2};

use crate::algebra::cholesky::Cholesky;

/// Numbers of modes that are tried.
const MODES: [usize; 9] = [2, 3, 4, 6, 8, 12, 16, 24, 32];
/// Lambda over the greatest sum of squares of a score: from, how many to a decade, how many.
const LAMBDA: (f64, f64, usize) = (1e-10, 2.0, 21);

/// What was chosen.
#[derive(Debug, Clone)]
pub(super) struct Choice {
    pub(super) modes: usize,
    /// A target each, the cells' unit squared.
    pub(super) lambda: Vec<f64>,
    /// Of each row by the fit without its group, predicted less measured, rows x targets.
    pub(super) residuals: Array2<f64>,
}

/// Sums over rows: all that ridge regression needs of them.
#[derive(Debug, Clone)]
pub(crate) struct Moments {
    rows: f64,
    sums: Vec<f64>,
    target_sums: Vec<f64>,
    /// Scores x scores, row by row.
    squares: Vec<f64>,
    /// Scores x targets, row by row.
    products: Vec<f64>,
}

impl Moments {
    /// Of some rows of scores and targets.
    pub(crate) fn of(scores: ArrayView2<'_, f64>, y: ArrayView2<'_, f64>, rows: &[usize]) -> Self {
        let (count, targets) = (scores.ncols(), y.ncols());
        let mut all = Self {
            rows: rows.len() as f64,
            sums: vec![0.0; count],
            target_sums: vec![0.0; targets],
            squares: vec![0.0; count * count],
            products: vec![0.0; count * targets],
        };
        for &row in rows {
            let (s, y) = (scores.row(row), y.row(row));
            for i in 0..count {
                all.sums[i] += s[i];
                (0..count).for_each(|j| all.squares[i * count + j] += s[i] * s[j]);
                (0..targets).for_each(|j| all.products[i * targets + j] += s[i] * y[j]);
            }
            (0..targets).for_each(|j| all.target_sums[j] += y[j]);
        }
        all
    }

    /// Of the other rows.
    pub(crate) fn without(&self, part: &Self) -> Self {
        let less = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a - b).collect();
        Self {
            rows: self.rows - part.rows,
            sums: less(&self.sums, &part.sums),
            target_sums: less(&self.target_sums, &part.target_sums),
            squares: less(&self.squares, &part.squares),
            products: less(&self.products, &part.products),
        }
    }

    /// The greatest sum of squares of a score.
    fn greatest(&self) -> f64 {
        let count = self.sums.len();
        (0..count).map(|k| self.squares[k * count + k]).fold(0.0, f64::max)
    }

    /// Coefficients of each target on the first `modes` scores, and its offset; none where nothing determines them.
    pub(crate) fn solve(&self, modes: usize, lambda: f64) -> Option<Vec<(Vec<f64>, f64)>> {
        let (count, targets) = (self.sums.len(), self.target_sums.len());
        let mut normal = vec![0.0; modes * modes];
        for i in 0..modes {
            for j in i..modes {
                normal[i * modes + j] = self.squares[i * count + j] - self.sums[i] * self.sums[j] / self.rows;
            }
        }
        let factor = Cholesky::of(normal, modes, lambda)?;
        let one = |target: usize| {
            let mean = self.target_sums[target] / self.rows;
            let mut b: Vec<f64> =
                (0..modes).map(|i| self.products[i * targets + target] - self.sums[i] * mean).collect();
            factor.solve(&mut b);
            let at_mean: f64 = b.iter().zip(&self.sums).map(|(b, sum)| b * sum / self.rows).sum();
            (b, mean - at_mean)
        };
        Some((0..targets).map(one).collect())
    }
}

/// Chooses modes (`asked`, or by the errors) and lambdas; `groups`: at least two, rows each.
pub(super) fn choose(
    scores: ArrayView2<'_, f64>,
    y: ArrayView2<'_, f64>,
    groups: &[Vec<usize>],
    asked: Option<usize>,
) -> Option<Choice> {
    let every: Vec<usize> = (0..scores.nrows()).collect();
    let all = Moments::of(scores, y, &every);
    let others: Vec<Moments> = groups.iter().map(|rows| all.without(&Moments::of(scores, y, rows))).collect();
    let tried: Vec<usize> = match asked {
        Some(modes) => vec![modes.min(scores.ncols())],
        None => MODES.into_iter().filter(|&modes| modes < scores.ncols()).chain([scores.ncols()]).collect(),
    };
    let (least, per_decade, count) = LAMBDA;
    let lambdas: Vec<f64> = (0..count).map(|k| all.greatest() * least * 10_f64.powf(k as f64 / per_decade)).collect();
    let spread: Vec<f64> = y.columns().into_iter().map(|column| column.var(0.0)).collect();
    let mut best: Option<(f64, Choice)> = None;
    for modes in tried {
        // Of each target the residuals with its least sum of squares.
        let mut own: Vec<(f64, f64, Vec<f64>)> = vec![(f64::INFINITY, 0.0, Vec::new()); y.ncols()];
        for &lambda in &lambdas {
            let Some(residuals) = left_out(scores, y, groups, &others, modes, lambda) else { continue };
            for (own, column) in own.iter_mut().zip(residuals.columns()) {
                let squares: f64 = column.iter().map(|value| value * value).sum();
                if squares < own.0 {
                    *own = (squares, lambda, column.to_vec());
                }
            }
        }
        // A target that does not change decides nothing.
        let total: f64 = own.iter().zip(&spread).filter(|(_, spread)| **spread > 0.0).map(|(o, s)| o.0 / s).sum();
        if total.is_finite() && best.as_ref().is_none_or(|(least, _)| total < *least) {
            let residuals = Array2::from_shape_fn(y.dim(), |(row, target)| own[target].2[row]);
            let lambda = own.iter().map(|own| own.1).collect();
            best = Some((total, Choice { modes, lambda, residuals }));
        }
    }
    best.map(|(_, choice)| choice)
}

fn left_out(
    scores: ArrayView2<'_, f64>,
    y: ArrayView2<'_, f64>,
    groups: &[Vec<usize>],
    others: &[Moments],
    modes: usize,
    lambda: f64,
) -> Option<Array2<f64>> {
    let mut residuals = Array2::zeros(y.dim());
    for (rows, others) in groups.iter().zip(others) {
        let fits = others.solve(modes, lambda)?;
        for &row in rows {
            for (target, (b, offset)) in fits.iter().enumerate() {
                let predicted: f64 = b.iter().zip(scores.row(row)).map(|(b, s)| b * s).sum();
                residuals[[row, target]] = offset + predicted - y[[row, target]];
            }
        }
    }
    Some(residuals)
}
