//! Learning curves: how good a model gets with how much training data.
//!
//! In: rows to train on and rows held out. Out: a point for each amount of training data, with the scores of both.
//! Amounts are 1, 2, .. of the recordings, in order; or the first shares of each recording's time, as a shorter
//! calibration would have given.

use std::fmt::Display;

use ndarray::Array2;
use rayon::prelude::*;
use serde::Serialize;
use thiserror::Error;

use super::cross::fit_and_predict;
use super::score::{Scores, score};
use crate::Dataset;

/// One amount of training data.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LearningPoint {
    /// Recordings trained on.
    pub recordings: usize,
    /// The first share of each one's time, 0 to 1.
    pub share: f64,
    /// Rows trained on.
    pub rows: usize,
    /// Seconds trained on, summed over recordings: rows times each recording's mean step; none where a recording has no
    /// time.
    pub time_s: Option<f64>,
    /// Scores of the rows trained on; none where the fit failed.
    pub train: Option<Scores>,
    /// Scores of the rows held out.
    pub held_out: Option<Scores>,
    /// Why the fit failed.
    pub fault: Option<String>,
}

/// Why there is no learning curve.
#[derive(Debug, Clone, PartialEq, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum LearningFault {
    #[error("the rows held out have other photodiodes or targets than those to train on")]
    Columns,
    #[error("no rows are {0}")]
    Empty(&'static str),
    #[error("a share of {0} of the training time; it must be above 0 and at most 1")]
    Share(f64),
}

/// Trains on the first recording, the first two, .. all, and scores on `held_out`.
pub fn learn_by_recordings<P, E: Display>(
    train: &Dataset,
    held_out: &Dataset,
    fit: impl Fn(&Dataset) -> Result<P, E> + Sync,
    predict: impl Fn(&P, &Dataset) -> Array2<f64> + Sync,
) -> Result<Vec<LearningPoint>, LearningFault> {
    check(train, held_out)?;
    let amounts: Vec<usize> = (1..=train.recordings().len()).collect();
    let one = |&amount: &usize| {
        let some = train.only(&(0..amount).collect::<Vec<_>>());
        point(&some, held_out, amount, 1.0, &fit, &predict)
    };
    Ok(amounts.par_iter().map(one).collect())
}

/// Trains on the first shares of each recording's time, and scores on `held_out`. Of a recording whose times are not
/// known or do not ascend, the share of its rows is taken.
pub fn learn_by_share<P, E: Display>(
    train: &Dataset,
    held_out: &Dataset,
    shares: &[f64],
    fit: impl Fn(&Dataset) -> Result<P, E> + Sync,
    predict: impl Fn(&P, &Dataset) -> Array2<f64> + Sync,
) -> Result<Vec<LearningPoint>, LearningFault> {
    check(train, held_out)?;
    if let Some(&share) = shares.iter().find(|&&share| !(share > 0.0 && share <= 1.0)) {
        return Err(LearningFault::Share(share));
    }
    let one = |&share: &f64| {
        let some = train.only_rows(&first(train, share));
        point(&some, held_out, some.recordings().len(), share, &fit, &predict)
    };
    Ok(shares.par_iter().map(one).collect())
}

fn check(train: &Dataset, held_out: &Dataset) -> Result<(), LearningFault> {
    if train.inputs() != held_out.inputs() || train.targets() != held_out.targets() {
        return Err(LearningFault::Columns);
    }
    for (data, what) in [(train, "to train on"), (held_out, "held out")] {
        if data.rows() == 0 {
            return Err(LearningFault::Empty(what));
        }
    }
    Ok(())
}

/// The rows within the first share of each recording, at least one of each.
fn first(data: &Dataset, share: f64) -> Vec<usize> {
    let mut rows = Vec::new();
    for one in data.recordings().iter().filter(|one| !one.rows.is_empty()) {
        let time = &data.time_s()[one.rows.clone()];
        let (start, end) = (time[0], time[time.len() - 1]);
        let kept = if time.windows(2).all(|pair| pair[0] < pair[1]) && (end - start).is_finite() {
            let until = start + share * (end - start);
            time.partition_point(|&t| t <= until)
        } else {
            (share * time.len() as f64).ceil() as usize
        };
        rows.extend(one.rows.clone().take(kept.max(1)));
    }
    rows
}

fn point<P, E: Display>(
    some: &Dataset,
    held_out: &Dataset,
    recordings: usize,
    share: f64,
    fit: &(impl Fn(&Dataset) -> Result<P, E> + Sync),
    predict: &(impl Fn(&P, &Dataset) -> Array2<f64> + Sync),
) -> LearningPoint {
    let scored = |data: &Dataset, predicted: &Array2<f64>| score(data.y().view(), predicted.view(), data.targets());
    let result = fit_and_predict(some, held_out, fit, predict);
    LearningPoint {
        recordings,
        share,
        rows: some.rows(),
        time_s: duration_s(some),
        train: result.as_ref().ok().map(|(model, _)| scored(some, &predict(model, some))),
        held_out: result.as_ref().ok().map(|(_, predicted)| scored(held_out, predicted)),
        fault: result.err(),
    }
}

fn duration_s(data: &Dataset) -> Option<f64> {
    let lasts = data.recordings().iter().filter(|one| !one.rows.is_empty()).map(|one| {
        let (n, time) = (one.rows.len() as f64, &data.time_s()[one.rows.clone()]);
        let span = time[time.len() - 1] - time[0];
        if time.len() == 1 { 0.0 } else { span * n / (n - 1.0) }
    });
    let sum: f64 = lasts.sum();
    sum.is_finite().then_some(sum)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluate::fixture::{Nearest, line, mean_of, recordings, repeat};

    #[test]
    fn more_recordings_are_better_by_the_truth() {
        let all = [("s1", "1", "a", 80), ("s2", "2", "a", 80), ("s3", "3", "a", 80), ("v", "4", "a", 80)];
        let data = recordings(&all);
        let (train, held_out) = (data.only(&[0, 1, 2]), data.only(&[3]));
        let points = learn_by_recordings(&train, &held_out, Nearest::fit, Nearest::predict).unwrap();
        assert_eq!(
            points.iter().map(|one| (one.recordings, one.rows)).collect::<Vec<_>>(),
            [(1, 80), (2, 160), (3, 240)]
        );
        for one in &points {
            let model = Nearest(train.only(&(0..one.recordings).collect::<Vec<_>>()));
            let predicted = model.predict(&held_out);
            let scores = score(held_out.y().view(), predicted.view(), held_out.targets());
            assert_eq!(one.held_out.as_ref(), Some(&scores));
            assert_eq!(one.train.as_ref().unwrap().overall.rmse, 0.0, "it remembers what it was trained on");
        }
        // 80 rows of 0.04 s.
        assert!((points[0].time_s.unwrap() - 3.2).abs() <= 1e-12);
    }

    #[test]
    fn shares_are_of_time() {
        let data = line(11);
        let points = learn_by_share(&data, &data, &[0.1, 0.5, 1.0], mean_of, |mean, data| repeat(mean, data)).unwrap();
        assert_eq!(points.iter().map(|one| one.rows).collect::<Vec<_>>(), [2, 6, 11]);
        let tiny = learn_by_share(&data, &data, &[1e-300], mean_of, |mean, data| repeat(mean, data)).unwrap();
        assert_eq!(tiny[0].rows, 1);
    }

    #[test]
    fn what_makes_no_curve() {
        let (data, other) = (line(5), recordings(&[("s1", "1", "a", 5)]));
        let predict = |mean: &Vec<f64>, data: &Dataset| repeat(mean, data);
        assert_eq!(learn_by_recordings(&data, &other, mean_of, predict), Err(LearningFault::Columns));
        assert_eq!(learn_by_recordings(&data, &line(0), mean_of, predict), Err(LearningFault::Empty("held out")));
        for share in [0.0, -0.5, 1.01, f64::NAN] {
            assert!(matches!(learn_by_share(&data, &data, &[share], mean_of, predict), Err(LearningFault::Share(_))));
        }
        let fails = learn_by_recordings(&data, &data, |_| Err::<Vec<f64>, _>("too few rows"), predict).unwrap();
        assert_eq!((fails[0].fault.as_deref(), &fails[0].held_out), (Some("too few rows"), &None));
    }
}
