//! Equation 16: the quadratic model, fitted in u = (P - m) / s with m the means and s powers of two about the SDs.
//! Products of u are carried exactly into the fit.

use ndarray::Array2;

use super::fault::named;
use super::{FitFault, FitReport};
use crate::least_squares::{Problem, solve};
use crate::{Dataset, LeastSquaresOptions, Quadratic, Solver, least_squares, quadratic_terms};

/// Fits y = y_m + J T(u). Standard errors are of coefficients of u.
///
/// With [`Solver::Normal`] the terms are equation 16's own, of P: m is 0, s is 1.
pub fn fit_quadratic(data: &Dataset, options: &LeastSquaresOptions) -> Result<(Quadratic, FitReport), FitFault> {
    let inputs = data.inputs().len();
    let pairs = quadratic_terms(inputs);
    let names = names(data.inputs(), &pairs);
    let fault = |fault| named(fault, &names, data.targets(), inputs);
    let (fit, centre, scale, offset) = match options.solver {
        Solver::Orthogonal => {
            let (problem, centre, scale) =
                Problem::quadratic(data.x().view(), data.y().view(), &pairs).map_err(fault)?;
            let fit = solve(problem, options).map_err(fault)?;
            // Centres of terms are 0 here: the offset is the targets' value at u = 0.
            let offset = fit.target_centre.clone();
            (fit, centre, scale, offset)
        }
        Solver::Normal => {
            let x = data.x();
            let design = Array2::from_shape_fn((x.nrows(), inputs + pairs.len()), |(i, term)| {
                if term < inputs {
                    x[[i, term]]
                } else {
                    let (a, b) = pairs[term - inputs];
                    x[[i, a]] * x[[i, b]]
                }
            });
            let fit = least_squares(design.view(), data.y().view(), options).map_err(fault)?;
            let offset = fit.intercept.clone();
            (fit, vec![0.0; inputs], vec![1.0; inputs], offset)
        }
    };
    if let Some(k) = scale.iter().position(|scale| !(scale.is_normal() && scale.recip().is_normal())) {
        return Err(FitFault::Scale(data.inputs()[k].clone()));
    }
    let terms = |row: usize, to: &mut Vec<f64>| {
        let first = to.len();
        to.extend(data.x().row(row).iter().zip(centre.iter().zip(&scale)).map(|(x, (m, s))| (x - m) / s));
        pairs.iter().for_each(|&(i, j)| to.push(to[first + i] * to[first + j]));
    };
    let report = FitReport::new(&fit, names, data).with_errors(&fit, &terms, data, options);
    Ok((Quadratic::new(centre, scale, offset, fit.coefficients)?, report))
}

fn names(inputs: &[String], pairs: &[(usize, usize)]) -> Vec<String> {
    let products = pairs
        .iter()
        .map(|&(i, j)| if i == j { format!("{}^2", inputs[i]) } else { format!("{}*{}", inputs[i], inputs[j]) });
    inputs.iter().cloned().chain(products).collect()
}
