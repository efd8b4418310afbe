//! Cross-validation: each part predicted by a model that has not seen it.
//!
//! In: a [`Dataset`], what to hold out, how to fit and how to predict. Out: scores of each fold and of all held-out
//! rows together, and the predictions in row order. Folds run on all cores; the result does not depend on how many
//! there are. A fold whose fit fails is reported with the reason and its rows are not predicted (NaN); the others
//! count.

use std::fmt::Display;

use ndarray::{Array2, Axis};
use rayon::prelude::*;
use serde::Serialize;
use thiserror::Error;

use super::rows::{row_hashes, shared_with_others};
use super::score::{Scores, score};
use super::split::{By, Fold, SplitFault, folds};
use crate::Dataset;

/// What came of one fold.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FoldResult {
    /// What was held out.
    pub name: String,
    /// Rows held out that a row trained on equals in every digit: above 0, something was given twice (or stands still).
    pub shared_rows: usize,
    /// Scores of the rows held out; none where the fit failed.
    pub scores: Option<Scores>,
    /// Why the fit failed.
    pub fault: Option<String>,
}

/// How much shuffled rows flatter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Flattery {
    /// Scores with whole trajectories held out; none where there is only one, or no fold could be fitted.
    pub by_trajectory: Option<Scores>,
    /// Why there are none.
    pub fault: Option<String>,
    /// RMSE by trajectory over RMSE by shuffled rows, a target each: above 1, the shuffle flattered.
    pub ratio: Vec<Option<f64>>,
}

/// What came of all folds.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CrossValidation {
    /// What was held out at a time.
    pub by: By,
    /// Fold by fold.
    pub folds: Vec<FoldResult>,
    /// All held-out rows together.
    pub pooled: Scores,
    /// Each row as predicted by the model that has not seen it; NaN where its fold failed.
    #[serde(skip)]
    pub predicted: Array2<f64>,
    /// The rows of each fold, in the order of `folds`.
    #[serde(skip)]
    pub rows: Vec<Vec<usize>>,
    /// Of shuffled rows: what whole trajectories say.
    pub flattery: Option<Flattery>,
}

/// Why there is no cross-validation.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum CrossFault {
    #[error(transparent)]
    Split(#[from] SplitFault),
    #[error("none of {folds} folds could be fitted; without {name}: {why}")]
    AllFailed { folds: usize, name: String, why: String },
}

impl CrossValidation {
    /// Predicted less measured, rows x targets; NaN where a fold failed.
    ///
    /// # Panics
    /// Where `data` is not the set that was cross-validated.
    #[must_use]
    pub fn residuals(&self, data: &Dataset) -> Array2<f64> {
        &self.predicted - data.y()
    }
}

/// Holds out part by part.
///
/// # Errors
/// [`CrossFault`], where nothing can be held out or no fold could be fitted.
pub fn cross_validate<P, E: Display>(
    data: &Dataset,
    by: By,
    fit: impl Fn(&Dataset) -> Result<P, E> + Sync,
    predict: impl Fn(&P, &Dataset) -> Array2<f64> + Sync,
) -> Result<CrossValidation, CrossFault> {
    let mut result = hold_out(data, by, &fit, &predict)?;
    if matches!(by, By::Rows { .. }) {
        let honest = hold_out(data, By::Trajectory, &fit, &predict);
        let ratio = |column: usize| {
            let of = |scores: &Scores| scores.targets[column].rmse;
            let ratio = of(&honest.as_ref().ok()?.pooled) / of(&result.pooled);
            ratio.is_finite().then_some(ratio)
        };
        let ratio = (0..data.targets().len()).map(ratio).collect();
        let fault = honest.as_ref().err().map(ToString::to_string);
        result.flattery = Some(Flattery { by_trajectory: honest.ok().map(|honest| honest.pooled), fault, ratio });
    }
    Ok(result)
}

/// Fits on one set and predicts another: predictions of the right size, or why there are none.
pub(super) fn fit_and_predict<P, E: Display>(
    train: &Dataset,
    test: &Dataset,
    fit: &(impl Fn(&Dataset) -> Result<P, E> + Sync),
    predict: &(impl Fn(&P, &Dataset) -> Array2<f64> + Sync),
) -> Result<(P, Array2<f64>), String> {
    let model = fit(train).map_err(|fault| fault.to_string())?;
    let predicted = predict(&model, test);
    let (found, wanted) = (predicted.dim(), test.y().dim());
    if found != wanted {
        return Err(format!(
            "{} x {} numbers predicted where {} rows x {} targets are needed",
            found.0, found.1, wanted.0, wanted.1
        ));
    }
    Ok((model, predicted))
}

/// As [`cross_validate`], of shuffled rows without whole trajectories beside.
pub(super) fn hold_out<P, E: Display>(
    data: &Dataset,
    by: By,
    fit: &(impl Fn(&Dataset) -> Result<P, E> + Sync),
    predict: &(impl Fn(&P, &Dataset) -> Array2<f64> + Sync),
) -> Result<CrossValidation, CrossFault> {
    let folds = folds(data, by)?;
    let one = |fold: &Fold| {
        let test = data.only_rows(&fold.test);
        fit_and_predict(&data.only_rows(&fold.train), &test, fit, predict).map(|(_, predicted)| predicted)
    };
    let parts: Vec<Result<Array2<f64>, String>> = folds.par_iter().map(one).collect();
    if let (Some(first), Some(Err(why)), true) = (folds.first(), parts.first(), parts.iter().all(Result::is_err)) {
        return Err(CrossFault::AllFailed { folds: folds.len(), name: first.name.clone(), why: why.clone() });
    }
    let tests: Vec<&[usize]> = folds.iter().map(|fold| fold.test.as_slice()).collect();
    let shared = shared_with_others(&row_hashes(data), &tests);
    let mut predicted = Array2::from_elem(data.y().dim(), f64::NAN);
    let mut results = Vec::new();
    for ((fold, part), shared_rows) in folds.iter().zip(&parts).zip(shared) {
        if let Ok(part) = part {
            fold.test.iter().zip(part.rows()).for_each(|(&row, values)| predicted.row_mut(row).assign(&values));
        }
        let measured = data.y().select(Axis(0), &fold.test);
        results.push(FoldResult {
            name: fold.name.clone(),
            shared_rows,
            scores: part.as_ref().ok().map(|part| score(measured.view(), part.view(), data.targets())),
            fault: part.as_ref().err().cloned(),
        });
    }
    let pooled = score(data.y().view(), predicted.view(), data.targets());
    let rows = folds.into_iter().map(|fold| fold.test).collect();
    Ok(CrossValidation { by, folds: results, pooled, predicted, rows, flattery: None })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluate::fixture::{Nearest, mean_of, recordings, repeat};

    const ALL: [(&str, &str, &str, usize); 4] =
        [("s1", "1", "a", 60), ("s2", "1", "a", 90), ("s3", "2", "a", 70), ("s4", "2", "a", 80)];

    #[test]
    fn held_out_rows_are_predicted_from_the_others() {
        let data = recordings(&ALL);
        let all = cross_validate(&data, By::Trajectory, mean_of, |mean, data| repeat(mean, data)).unwrap();
        for (k, rows) in all.rows.iter().enumerate() {
            let others: Vec<usize> = (0..4).filter(|&other| other != k).collect();
            let mean = mean_of(&data.only(&others)).unwrap();
            assert!(rows.iter().all(|&row| all.predicted.row(row).to_vec() == mean));
        }
        assert_eq!(all.pooled.rows, 300);
        assert_eq!(all.folds[1].scores.as_ref().unwrap().rows, 90);
        assert!(all.flattery.is_none());
        assert_eq!(all.residuals(&data)[[0, 1]], all.predicted[[0, 1]] - data.y()[[0, 1]]);
    }

    #[test]
    fn shuffled_rows_flatter_and_the_report_says_so() {
        let data = recordings(&ALL);
        let shuffled = By::Rows { folds: 5, seed: 1 };
        let all = cross_validate(&data, shuffled, Nearest::fit, Nearest::predict).unwrap();
        let honest = cross_validate(&data, By::Trajectory, Nearest::fit, Nearest::predict).unwrap();
        let flattery = all.flattery.unwrap();
        assert_eq!(flattery.by_trajectory, Some(honest.pooled));
        // Measured 1.3 and more.
        assert!(flattery.ratio.iter().all(|ratio| ratio.unwrap() >= 1.1), "{:?}", flattery.ratio);
        let alone = cross_validate(&data.only(&[0]), shuffled, Nearest::fit, Nearest::predict).unwrap();
        let flattery = alone.flattery.unwrap();
        assert!(flattery.fault.unwrap().contains("only one trajectory") && flattery.ratio == [None, None]);
    }

    #[test]
    fn a_recording_given_twice_is_reported() {
        let mut data = recordings(&ALL);
        data = data.only(&[0, 1, 0]);
        let all = cross_validate(&data, By::Trajectory, mean_of, |mean, data| repeat(mean, data)).unwrap();
        assert_eq!(all.folds.iter().map(|fold| fold.shared_rows).collect::<Vec<_>>(), [60, 0, 60]);
    }

    #[test]
    fn a_fold_that_fails_leaves_the_others() {
        let data = recordings(&ALL);
        let fit =
            |data: &Dataset| if data.rows() == 210 { Err("P1 is dead") } else { mean_of(data).map_err(|_| "empty") };
        let all = cross_validate(&data, By::Trajectory, fit, |mean, data| repeat(mean, data)).unwrap();
        assert_eq!(all.folds[1].fault.as_deref(), Some("P1 is dead"));
        assert!(all.folds[1].scores.is_none() && all.predicted.row(60).iter().all(|value| value.is_nan()));
        assert_eq!((all.pooled.rows, all.pooled.invalid), (210, 90));
        let none = cross_validate(&data, By::Trajectory, |_| Err::<(), _>("no"), |(), data| data.y().clone());
        let says = none.unwrap_err().to_string();
        assert_eq!(says, "none of 4 folds could be fitted; without s1: no");
        let wrong = cross_validate(&data, By::Trajectory, mean_of, |_, _| Array2::zeros((1, 2)));
        assert!(wrong.unwrap_err().to_string().contains("1 x 2 numbers predicted where 60 rows x 2 targets"));
    }

    #[test]
    fn parts_of_one_row_and_constant_targets() {
        let data = recordings(&[("s1", "1", "a", 1), ("s2", "1", "a", 500), ("s3", "1", "a", 1)]);
        let all = cross_validate(&data, By::Trajectory, Nearest::fit, Nearest::predict).unwrap();
        let first = &all.folds[0].scores.as_ref().unwrap().targets[0];
        assert_eq!((first.n, first.r2), (1, None));
        assert!(all.pooled.targets[0].r2.is_some());
        let one = cross_validate(&data.only(&[0]), By::Trajectory, Nearest::fit, Nearest::predict);
        assert!(matches!(one, Err(CrossFault::Split(SplitFault::One { .. }))));
        let flat = data.x().mapv(|_| 0.1);
        let names = |all: &[String]| all.to_vec();
        let (x, time) = (data.x().clone(), data.time_s().to_vec());
        let kept = data.recordings().to_vec();
        let constant = Dataset::new(names(data.inputs()), names(data.targets()), time, x, flat, kept).unwrap();
        let all = cross_validate(&constant, By::Trajectory, Nearest::fit, Nearest::predict).unwrap();
        assert_eq!((all.pooled.targets[0].rmse, all.pooled.targets[0].r2), (0.0, None));
        let shuffled = By::Rows { folds: 3, seed: 0 };
        let all = cross_validate(&constant, shuffled, Nearest::fit, Nearest::predict).unwrap();
        assert_eq!(all.flattery.unwrap().ratio, [None, None], "0 / 0 is no ratio");
    }
}
