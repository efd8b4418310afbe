//! Does an option help? Scores with and without it, on the same held-out rows.
//!
//! In: predictions of held-out rows, or a set to cross-validate. Out: both scores and their ratio. Rows that an option
//! leaves out (lags need history) are left out of both.

use std::fmt::Display;

use ndarray::{Array2, ArrayView2};
use serde::Serialize;
use thiserror::Error;

use super::cross::{CrossFault, cross_validate};
use super::score::{Scores, score};
use super::split::By;
use crate::{Dataset, FrictionCone, FrictionFault, LagFault, Lags};

/// Scores without and with an option.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Effect {
    /// Without it.
    pub without: Scores,
    /// With it.
    pub with: Scores,
    /// RMSE with over RMSE without, a target each: below 1, it helps; none where there is no such ratio.
    pub ratio: Vec<Option<f64>>,
    /// Rows that it changed (a friction cone) or left out of both (lags).
    pub rows: usize,
}

/// Why an option's effect is not known.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum EffectFault {
    /// No cone.
    #[error(transparent)]
    Friction(#[from] FrictionFault),
    /// No lags.
    #[error(transparent)]
    Lag(#[from] LagFault),
    /// No cross-validation.
    #[error(transparent)]
    Cross(#[from] CrossFault),
}

impl Effect {
    /// From scores of the same rows; `rows`: how many the option changed or left out.
    #[must_use]
    pub fn new(without: Scores, with: Scores, rows: usize) -> Self {
        let ratio = without.targets.iter().zip(&with.targets).map(|(without, with)| {
            let ratio = with.rmse / without.rmse;
            ratio.is_finite().then_some(ratio)
        });
        Self { ratio: ratio.collect(), without, with, rows }
    }
}

/// What a friction cone does to predictions of held-out rows, rows x targets.
///
/// # Errors
/// [`EffectFault::Friction`].
///
/// # Panics
/// Where the sizes do not agree.
pub fn friction_effect(
    measured: ArrayView2<f64>,
    predicted: ArrayView2<f64>,
    names: &[String],
    cone: FrictionCone,
) -> Result<Effect, EffectFault> {
    let mut within = predicted.to_owned();
    let moved = cone.apply(within.view_mut(), names)?;
    Ok(Effect::new(score(measured, predicted, names), score(measured, within.view(), names), moved))
}

/// What lags do to a model's cross-validation, on the rows that have the history.
///
/// # Errors
/// [`EffectFault::Lag`] and [`EffectFault::Cross`].
pub fn lag_effect<P, E: Display>(
    data: &Dataset,
    lags: &Lags,
    by: By,
    fit: impl Fn(&Dataset) -> Result<P, E> + Sync,
    predict: impl Fn(&P, &Dataset) -> Array2<f64> + Sync,
) -> Result<Effect, EffectFault> {
    let wide = lags.expand(data)?;
    let without = cross_validate(&data.only_rows(&wide.kept), by, &fit, &predict)?.pooled;
    let with = cross_validate(&wide.data, by, &fit, &predict)?.pooled;
    Ok(Effect::new(without, with, wide.dropped))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluate::fixture::{Nearest, recordings};
    use ndarray::array;

    #[test]
    fn a_cone_that_holds_the_truth_helps() {
        let names: Vec<String> = ["Fx_N", "Fy_N", "Fz_N"].map(str::to_owned).to_vec();
        let measured = array![[0.5, 0.0, -1.0], [0.0, 0.0, 0.0], [0.1, 0.2, -2.0]];
        let predicted = array![[1.0, 0.0, -1.0], [0.1, 0.0, 0.4], [0.2, 0.2, -1.9]];
        let cone = FrictionCone::new(0.75).unwrap();
        let effect = friction_effect(measured.view(), predicted.view(), &names, cone).unwrap();
        assert_eq!((effect.rows, effect.without.rows, effect.with.rows), (2, 3, 3));
        assert!(effect.ratio[0].unwrap() < 1.0 && effect.ratio[1].is_none(), "0 / 0 is no ratio: {:?}", effect.ratio);
        assert!(effect.with.overall.rmse < effect.without.overall.rmse);
        assert!(friction_effect(array![[1.0]].view(), array![[1.0]].view(), &names[..1], cone).is_err());
    }

    #[test]
    fn lags_are_compared_on_the_same_rows() {
        let data = recordings(&[("s1", "1", "a", 80), ("s2", "1", "a", 60), ("short", "1", "a", 2)]);
        let lags = Lags::of(vec![0.08, 0.2], &data).unwrap();
        let effect = lag_effect(&data, &lags, By::Trajectory, Nearest::fit, Nearest::predict).unwrap();
        assert_eq!((effect.rows, effect.with.rows, effect.without.rows), (12, 130, 130));
        let long = Lags::new(vec![100.0], 1.0).unwrap();
        assert!(matches!(
            lag_effect(&data, &long, By::Trajectory, Nearest::fit, Nearest::predict),
            Err(EffectFault::Lag(_))
        ));
        let wrong = lag_effect(&data, &lags, By::Subject, Nearest::fit, Nearest::predict);
        assert!(matches!(wrong, Err(EffectFault::Cross(_))));
    }
}
