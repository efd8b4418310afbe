//! Equations 9 to 15: the linear model.

use super::fault::named;
use super::{FitFault, FitReport};
use crate::{Dataset, LeastSquaresOptions, Linear, least_squares};

/// Fits y = y_m + J (P - m).
pub fn fit_linear(data: &Dataset, options: &LeastSquaresOptions) -> Result<(Linear, FitReport), FitFault> {
    let fit = least_squares(data.x().view(), data.y().view(), options)
        .map_err(|fault| named(fault, data.inputs(), data.targets(), data.inputs().len()))?;
    let terms =
        |row: usize, to: &mut Vec<f64>| to.extend(data.x().row(row).iter().zip(&fit.centre).map(|(x, m)| x - m));
    let report = FitReport::new(&fit, data.inputs().to_vec(), data).with_errors(&fit, &terms, data, options);
    Ok((Linear::new(fit.centre, fit.target_centre, fit.coefficients)?, report))
}
