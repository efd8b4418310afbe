//! Equations 9 to 15: the linear model.

use super::fault::named;
use super::{FitFault, FitReport};
use crate::{Dataset, LeastSquaresOptions, Linear, least_squares};

/// Fits y = y_m + J (P - m).
pub fn fit_linear(data: &Dataset, options: &LeastSquaresOptions) -> Result<(Linear, FitReport), FitFault> {
    let fit = least_squares(data.x().view(), data.y().view(), options)
        .map_err(|fault| named(fault, data.inputs(), data.targets(), data.inputs().len()))?;
    let report = FitReport::new(&fit, data.inputs().to_vec(), data);
    Ok((Linear::new(fit.centre, fit.target_centre, fit.coefficients)?, report))
}
