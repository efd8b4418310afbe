//! From a [`Problem`] to a [`LeastSquares`]: triangle, rank, solution, refinement.

use ndarray::Array2;

use super::factor::{Centred, Factor, part};
use super::problem::Problem;
use super::settle::settle;
use super::{Deficient, Dependent, LeastSquares, LeastSquaresFault, LeastSquaresOptions};
use crate::algebra::exact::Long;
use crate::algebra::scale::ldexp;
use crate::algebra::small::{Column, back, inverse_rows, pivot};
use crate::algebra::svd::modes;

/// Takes part in a dependence: above this share of the column's length. Shares of those that do not are rounding, some
/// 1e-12.
const PART: f64 = 1e-6;

/// A coefficient may lose so much below the smallest number, as a share of the target's largest value: 2^-40, assumed;
/// far below any noise.
const LOST: f64 = 1.0 / (1u64 << 40) as f64;

/// Takes part in the weakest direction: above this share of its largest component.
const WEAK: f64 = 0.1;

pub(crate) fn solve(
    mut problem: Problem<'_>,
    options: &LeastSquaresOptions,
) -> Result<LeastSquares, LeastSquaresFault> {
    let (rows, count) = (problem.rows, problem.columns);
    if let Deficient::Ridge(lambda) = options.deficient
        && !(lambda > 0.0 && lambda.is_finite())
    {
        return Err(LeastSquaresFault::Ridge(lambda));
    }
    if options.deficient == Deficient::Refuse && rows < count + 1 {
        return Err(LeastSquaresFault::TooFewRows { rows, columns: count });
    }
    let r = problem.triangle();
    let problem = &problem;
    let centred = Centred::new(problem, &r);
    let mut pivoted = centred.columns.clone();
    let (order, rank) = pivot(&mut pivoted, &centred.limits);
    if options.deficient == Deficient::Refuse && rank < count {
        return Err(dependences(&centred, &pivoted, &order, rank));
    }
    let all = 1 + count + problem.targets;
    let sides: Vec<Column> = (1 + count..all).map(|k| part(&r, 1..1 + count, k)).collect();
    let factor = Factor::new(&centred, &pivoted, &order[..rank], &sides, options.deficient);
    let ridge = if let Deficient::Ridge(lambda) = options.deficient { lambda } else { 0.0 };
    let first: Column = (1 + count..all).map(|k| r[[0, k]]).collect();
    let left: Vec<f64> = (1 + count..all).map(|k| part(&r, 1 + count..all, k).iter().map(|v| v * v).sum()).collect();
    let solution = settle(problem, &centred, &factor, ridge, &first, left, options.refinements);

    let weak = Weak::new(&centred, &pivoted, &order);
    let sigma = &weak.sigma;
    let condition = match sigma.last() {
        None => 1.0,
        Some(0.0) => f64::INFINITY,
        Some(last) => sigma[0] / last,
    };
    let solved_condition = match options.deficient {
        _ if rank == 0 => 1.0,
        Deficient::Ridge(lambda) => ((sigma[0].powi(2) + lambda) / (sigma[count - 1].powi(2) + lambda)).sqrt(),
        _ => sigma[0] / sigma[rank - 1],
    };
    let dropped = if options.deficient == Deficient::Drop {
        let mut dropped = order[rank..].to_vec();
        dropped.sort_unstable();
        dropped
    } else {
        Vec::new()
    };
    // Degrees of freedom: what ones and independent columns leave; a ridge's are not worked out.
    let freedom = rows.saturating_sub(rank + 1);
    let units = |k: usize| problem.exponents[count + k];
    let residual_sd: Vec<Option<f64>> = solution
        .squares
        .iter()
        .enumerate()
        .map(|(k, squares)| (freedom > 0).then(|| ldexp((squares / freedom as f64).sqrt(), units(k))))
        .collect();
    let spread = match options.deficient {
        Deficient::Refuse | Deficient::Drop => inverse_rows(&factor.f),
        Deficient::MinimumNorm if rank == count => inverse_rows(&factor.f),
        Deficient::MinimumNorm | Deficient::Ridge(_) => Vec::new(),
    };
    let mut standard_errors = Array2::from_elem((problem.targets, count), f64::NAN);
    if freedom > 0 && (rank == count || options.deficient == Deficient::Drop) {
        for (&j, spread) in order.iter().zip(&spread) {
            for (k, squares) in solution.squares.iter().enumerate() {
                let e = units(k) - problem.exponents[j] - centred.exponents[j];
                standard_errors[[k, j]] = ldexp((squares / freedom as f64).sqrt() * spread, e);
            }
        }
    }
    let mut coefficients = Array2::zeros((problem.targets, count));
    let mut intercept = Vec::new();
    let mut target_centre = Vec::new();
    for (k, x) in solution.coefficients.iter().enumerate() {
        let at_centre = Long::from(problem.centres[count + k]).plus(x[0]);
        let mut offset = at_centre;
        for j in 0..count {
            let e = units(k) - problem.exponents[j];
            let value = ldexp(x[1 + j].rounded(), e);
            // What of the target is lost where a number holds no coefficient that small, in units of its largest value.
            let lost = (ldexp(value, -e) - x[1 + j].rounded()).abs();
            if !(value.is_finite() && lost <= LOST) {
                return Err(LeastSquaresFault::Range { column: j, target: k });
            }
            coefficients[[k, j]] = value;
            offset = offset.plus(x[1 + j].times(problem.centres[j].into()).negative());
        }
        target_centre.push(ldexp(at_centre.rounded(), units(k)));
        intercept.push(ldexp(offset.rounded(), units(k)));
    }
    Ok(LeastSquares {
        centre: (0..count).map(|j| ldexp(problem.centres[j], problem.exponents[j])).collect(),
        target_centre,
        coefficients,
        intercept,
        rows,
        rank: Some(rank),
        condition,
        solved_condition,
        dropped,
        near_collinear: weak.columns,
        singular_values: weak.sigma,
        standard_errors,
        residual_sd,
        refined: solution.refined,
    })
}

/// Who depends on whom.
fn dependences(centred: &Centred, pivoted: &[Column], order: &[usize], rank: usize) -> LeastSquaresFault {
    let (mut constant, mut dependent) = (Vec::new(), Vec::new());
    for (place, &j) in order.iter().enumerate().skip(rank) {
        if centred.constant(j) {
            constant.push(j);
            continue;
        }
        let shares = back(&pivoted[..rank], &pivoted[place]);
        let mut with: Vec<usize> = (0..rank)
            .filter(|&k| (shares[k] * centred.lengths[order[k]]).abs() > PART * centred.lengths[j])
            .map(|k| order[k])
            .collect();
        with.sort_unstable();
        dependent.push(Dependent { column: j, with });
    }
    constant.sort_unstable();
    dependent.sort_by_key(|one| one.column);
    LeastSquaresFault::Deficient { constant, dependent }
}

/// Singular values of the columns over their lengths, and who takes part in the weakest direction.
struct Weak {
    sigma: Vec<f64>,
    columns: Vec<usize>,
}

impl Weak {
    fn new(centred: &Centred, pivoted: &[Column], order: &[usize]) -> Self {
        let count = order.len();
        // Transposed, as rotations of a triangle's rows settle sooner.
        let rows = Array2::from_shape_fn((count, count), |(place, i)| {
            let j = order[place];
            if centred.constant(j) { 0.0 } else { pivoted[place][i] / centred.lengths[j] }
        });
        let modes = modes(rows.t());
        let mut columns = Vec::new();
        if count > 0 {
            let weakest = modes.right.column(count - 1);
            let most = weakest.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
            columns =
                (0..count).filter(|&place| weakest[place].abs() >= WEAK * most).map(|place| order[place]).collect();
            columns.sort_unstable();
        }
        Self { sigma: modes.sigma, columns }
    }
}
