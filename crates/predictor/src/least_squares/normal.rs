//! Equation 11 as printed, as a peer: [J F_0] = Y Z^T (Z Z^T)^-1 with Z = [P; 1] (equations 12 and 14), in plain
//! arithmetic, by the inverse.

use ndarray::{Array1, Array2, ArrayView2, Axis, Slice, concatenate};

use super::problem::{check_finite, check_rows};
use super::{LeastSquares, LeastSquaresFault};

pub(super) fn normal(
    design: ArrayView2<'_, f64>,
    targets: ArrayView2<'_, f64>,
) -> Result<LeastSquares, LeastSquaresFault> {
    let (rows, columns) = design.dim();
    check_rows(design, targets)?;
    check_finite(design, targets)?;
    let centre = design.mean_axis(Axis(0)).expect("there are rows");
    let ones = Array2::ones((rows, 1));
    let z = concatenate(Axis(1), &[design, ones.view()]).expect("both have the design's rows");
    let inverse = inverse(z.t().dot(&z))?;
    let beta = targets.t().dot(&z).dot(&inverse);
    let coefficients = beta.slice_axis(Axis(1), Slice::from(..columns)).to_owned();
    let intercept: Array1<f64> = beta.column(columns).to_owned();
    let residuals = &targets - &z.dot(&beta.t());
    let freedom = rows.saturating_sub(columns + 1);
    let residual_sd: Vec<Option<f64>> =
        residuals.columns().into_iter().map(|r| (freedom > 0).then(|| (r.dot(&r) / freedom as f64).sqrt())).collect();
    let standard_errors = Array2::from_shape_fn(coefficients.dim(), |(k, j)| {
        residual_sd[k].map_or(f64::NAN, |sd| sd * inverse[[j, j]].sqrt())
    });
    Ok(LeastSquares {
        target_centre: (&intercept + &coefficients.dot(&centre)).to_vec(),
        centre: centre.to_vec(),
        coefficients,
        intercept: intercept.to_vec(),
        rows,
        rank: None,
        singular_values: Vec::new(),
        condition: f64::NAN,
        solved_condition: f64::NAN,
        dropped: Vec::new(),
        near_collinear: Vec::new(),
        standard_errors,
        residual_sd,
        refined: 0,
    })
}

/// By Gauss and Jordan with row pivoting.
fn inverse(mut a: Array2<f64>) -> Result<Array2<f64>, LeastSquaresFault> {
    let n = a.nrows();
    let mut out = Array2::eye(n);
    for j in 0..n {
        let best = (j..n).max_by(|&p, &q| a[[p, j]].abs().total_cmp(&a[[q, j]].abs())).unwrap_or(j);
        let pivot = a[[best, j]];
        if pivot == 0.0 || !pivot.is_finite() {
            return Err(LeastSquaresFault::Singular);
        }
        for k in 0..n {
            a.swap([j, k], [best, k]);
            out.swap([j, k], [best, k]);
            a[[j, k]] /= pivot;
            out[[j, k]] /= pivot;
        }
        for i in (0..n).filter(|&i| i != j) {
            let factor = a[[i, j]];
            for k in 0..n {
                a[[i, k]] -= factor * a[[j, k]];
                out[[i, k]] -= factor * out[[j, k]];
            }
        }
    }
    Ok(out)
}
