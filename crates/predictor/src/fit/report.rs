//! What is known about a fit's numbers.

use ndarray::Array2;
use serde::{Deserialize, Serialize};

use super::fault::listed;
use super::jackknife::{self, Terms};
use crate::{Dataset, LeastSquares, LeastSquaresOptions};

/// A photodiode whose variance, over the part that the others don't explain, is more than this is a copy or a mixture
/// of others (assumed: one with noise of 0.3 mV that swings by 0.25 V has 7e5).
const MOST_INFLATED: f64 = 1e6;
/// Fewer digits than this are worth a warning.
const FEW_DIGITS: f64 = 8.0;

/// What is known about a fit's numbers. Terms are equation 9's or 16's, without the offset.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FitReport {
    /// Rows fitted to.
    pub rows: usize,
    /// Names of the terms: `P1`, `P1^2`, `P1*P2`.
    pub terms: Vec<String>,
    /// Independent terms; none where not looked at (normal equations).
    pub rank: Option<usize>,
    /// Condition (2-norm) of the centred terms, each over its own length; none where infinite or not looked at.
    pub condition: Option<f64>,
    /// Decimal digits of the coefficients that rounding the rows' last bit leaves alone; none where not looked at.
    pub digits: Option<f64>,
    /// Terms left out.
    pub dropped: Vec<String>,
    /// What to look at, in words.
    pub warnings: Vec<String>,
    /// Residual SD a target, in its unit; none where no degrees of freedom are left.
    pub residual_sd: Vec<Option<f64>>,
    /// Standard errors, targets x terms, in the model's own units of its coefficients: by a jackknife over parts of
    /// recordings and over recordings, whose residuals go together. None where none is defined, or not asked for.
    pub standard_errors: Vec<Vec<Option<f64>>>,
}

/// Photodiodes of a linear model whose coefficients are known only together: by the variance inflation factor.
fn known_together(fit: &LeastSquares, terms: &[String], data: &Dataset) -> Vec<usize> {
    let Some((target, sd)) = fit.residual_sd.iter().enumerate().find_map(|(k, sd)| Some((k, (*sd)?))) else {
        return Vec::new();
    };
    if terms != data.inputs() || sd == 0.0 {
        return Vec::new();
    }
    let rows = data.rows() as f64;
    let inflated = |j: &usize| {
        let own = data.x().column(*j).var(0.0) * rows;
        (fit.standard_errors[[target, *j]] / sd).powi(2) * own > MOST_INFLATED
    };
    (0..terms.len()).filter(inflated).collect()
}

/// A warning of each target that does not change over rows x targets.
pub(super) fn unchanging(targets: &[String], y: &Array2<f64>) -> impl Iterator<Item = String> {
    let still = targets.iter().zip(y.columns()).filter(|(_, values)| values.iter().all(|value| *value == values[0]));
    still.map(|(name, values)| format!("{name} is {:?} in all training rows, and so in all predictions", values[0]))
}

/// Terms that have standard errors where residuals are independent.
fn with_errors(fit: &LeastSquares) -> Vec<usize> {
    let columns = fit.standard_errors.columns().into_iter().enumerate();
    columns.filter(|(_, errors)| errors.iter().any(|error| error.is_finite())).map(|(term, _)| term).collect()
}

impl FitReport {
    /// Without standard errors; `names`: of the terms.
    pub(super) fn new(fit: &LeastSquares, names: Vec<String>, data: &Dataset) -> Self {
        let known = |value: f64| value.is_finite().then_some(value);
        let digits = known(fit.digits());
        let mut warnings = Vec::new();
        if let Some(rank) = fit.rank
            && rank < names.len()
        {
            warnings.push(format!("the rows tell {rank} of {} terms apart", names.len()));
        }
        if let Some(digits) = digits.filter(|&digits| digits < FEW_DIGITS) {
            let those = listed(&fit.near_collinear, &names);
            warnings.push(format!(
                "{those} hardly differ (condition {:.1e}): about {digits:.0} digits can be trusted",
                fit.solved_condition
            ));
        }
        let shared = known_together(fit, &names, data);
        if !shared.is_empty() && digits.is_none_or(|digits| digits >= FEW_DIGITS) {
            warnings.push(format!(
                "{} are all but copies or mixtures of one another: less than a millionth of the variance is a \
                 photodiode's own, and these coefficients are known only together; leave one out",
                listed(&shared, &names)
            ));
        }
        if fit.residual_sd.iter().any(Option::is_none) {
            warnings.push(format!("{} rows determine the terms exactly: residuals say nothing", fit.rows));
        }
        if data.rows() > 1 {
            warnings.extend(unchanging(data.targets(), data.y()));
        }
        Self {
            rows: fit.rows,
            rank: fit.rank,
            condition: known(fit.condition),
            digits,
            dropped: fit.dropped.iter().map(|&j| names[j].clone()).collect(),
            warnings,
            residual_sd: fit.residual_sd.clone(),
            standard_errors: vec![vec![None; names.len()]; data.targets().len()],
            terms: names,
        }
    }

    /// With them where `options` ask for them.
    pub(super) fn with_errors(
        mut self,
        fit: &LeastSquares,
        terms: &Terms<'_>,
        data: &Dataset,
        options: &LeastSquaresOptions,
    ) -> Self {
        let kept: Vec<usize> = if options.standard_errors { with_errors(fit) } else { Vec::new() };
        let row = |row: usize, to: &mut Vec<f64>| {
            terms(row, to);
            to.extend(data.y().row(row).iter().zip(&fit.target_centre).map(|(value, centre)| value - centre));
        };
        let size = [self.terms.len(), data.targets().len()];
        let found = jackknife::standard_errors(&row, size, &kept, data.recordings());
        for (all, found) in self.standard_errors.iter_mut().zip(found.iter().flatten()) {
            for (&term, &error) in kept.iter().zip(found) {
                all[term] = error.is_finite().then_some(error);
            }
        }
        self
    }
}
