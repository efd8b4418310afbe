//! How often measured values fall within prediction intervals, on sessions that gave neither the model nor the
//! intervals.
//!
//! In: residuals by group, or a set with how to fit and to predict. Out: the share within, group by group and over all.

use std::fmt::Display;

use ndarray::{Array2, ArrayView2, Axis};
use rayon::prelude::*;
use serde::Serialize;

use super::cross::{cross_validate, fit_and_predict};
use super::interval::{IntervalFault, Intervals, calibrate};
use super::split::{By, Fold, folds};
use crate::Dataset;

/// How many measured values fell within.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Coverage {
    /// The group, or `all`.
    pub name: String,
    /// Rows looked at.
    pub rows: usize,
    /// The share within, 0 to 1, a target each; none of no rows.
    pub reached: Vec<Option<f64>>,
    /// Half the width used, a target each; over all groups, the mean over rows.
    pub half_width: Vec<f64>,
}

/// Coverage of groups left out one by one.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CrossCoverage {
    /// The share aimed at.
    pub level: f64,
    /// All groups' rows together.
    pub all: Coverage,
    /// Group by group.
    pub groups: Vec<Coverage>,
    /// Groups that give none, each with why; they are not in `all`.
    pub faults: Vec<(String, String)>,
}

/// The share of residuals, rows x targets, within intervals. Rows with a residual that is not finite do not count.
///
/// # Panics
/// Where the number of targets is not that of the intervals.
#[must_use]
pub fn coverage(residuals: ArrayView2<f64>, intervals: &Intervals, name: &str) -> Coverage {
    assert!(residuals.ncols() == intervals.half_width.len(), "residuals of the intervals' targets");
    let finite: Vec<_> = residuals.rows().into_iter().filter(|row| row.iter().all(|value| value.is_finite())).collect();
    let within = |(column, half): (usize, &f64)| {
        let inside = finite.iter().filter(|row| row[column].abs() <= *half).count();
        (!finite.is_empty()).then(|| inside as f64 / finite.len() as f64)
    };
    Coverage {
        name: name.to_owned(),
        rows: finite.len(),
        reached: intervals.half_width.iter().enumerate().map(within).collect(),
        half_width: intervals.half_width.clone(),
    }
}

/// Each group's coverage by intervals calibrated on the other groups' out-of-fold residuals (of [`cross_validate`];
/// `groups`: name and rows of each). It costs no fit. But the models that gave the others' residuals have seen the
/// group: [`nested_coverage`] is strict.
pub fn cross_coverage(
    residuals: ArrayView2<f64>,
    groups: &[(String, Vec<usize>)],
    level: f64,
) -> Result<CrossCoverage, IntervalFault> {
    if groups.len() < 2 {
        return Err(IntervalFault::Groups(groups.len()));
    }
    let one = |(k, (name, rows)): (usize, &(String, Vec<usize>))| {
        let others = groups.iter().enumerate().filter(|&(other, _)| other != k);
        let rest: Vec<usize> = others.flat_map(|(_, (_, rows))| rows.iter().copied()).collect();
        let intervals = calibrate(residuals.select(Axis(0), &rest).view(), level).map_err(|fault| fault.to_string())?;
        Ok(coverage(residuals.select(Axis(0), rows).view(), &intervals, name))
    };
    let results = groups.iter().enumerate().map(one).collect();
    gather(level, groups.iter().map(|(name, _)| name.clone()).collect(), results, residuals.ncols())
}

/// Each group's coverage by a model and intervals that have not seen it: the group is set aside, the others are
/// cross-validated among themselves for the half widths, the model is fitted to all of them and predicts the group.
/// Fits as many times as there are groups, squared.
pub fn nested_coverage<P, E: Display>(
    data: &Dataset,
    by: By,
    level: f64,
    fit: impl Fn(&Dataset) -> Result<P, E> + Sync,
    predict: impl Fn(&P, &Dataset) -> Array2<f64> + Sync,
) -> Result<CrossCoverage, IntervalFault> {
    if !(0.0..=1.0).contains(&level) {
        return Err(IntervalFault::Level(level));
    }
    if matches!(by, By::Rows { .. }) {
        return Err(IntervalFault::Shuffled);
    }
    let outer = folds(data, by)?;
    if outer.len() < 3 {
        return Err(IntervalFault::Groups(outer.len()));
    }
    let one = |fold: &Fold| {
        let (rest, test) = (data.only_rows(&fold.train), data.only_rows(&fold.test));
        let inner = cross_validate(&rest, by, &fit, &predict).map_err(|fault| fault.to_string())?;
        let intervals = calibrate(inner.residuals(&rest).view(), level).map_err(|fault| fault.to_string())?;
        let (_, predicted) = fit_and_predict(&rest, &test, &fit, &predict)?;
        Ok(coverage((predicted - test.y()).view(), &intervals, &fold.name))
    };
    let results = outer.par_iter().map(one).collect();
    gather(level, outer.iter().map(|fold| fold.name.clone()).collect(), results, data.targets().len())
}

/// Groups' coverages in one, weighted by their rows.
fn gather(
    level: f64,
    names: Vec<String>,
    results: Vec<Result<Coverage, String>>,
    targets: usize,
) -> Result<CrossCoverage, IntervalFault> {
    let (mut groups, mut faults) = (Vec::new(), Vec::new());
    for (name, result) in names.into_iter().zip(results) {
        match result {
            Ok(coverage) => groups.push(coverage),
            Err(why) => faults.push((name, why)),
        }
    }
    if let (true, Some((name, why))) = (groups.is_empty(), faults.first()) {
        return Err(IntervalFault::AllFailed { name: name.clone(), why: why.clone() });
    }
    let rows: usize = groups.iter().map(|group| group.rows).sum();
    let over = |of: &dyn Fn(&Coverage) -> Option<f64>| {
        let sum: f64 = groups.iter().filter_map(|group| Some(of(group)? * group.rows as f64)).sum();
        (rows > 0).then(|| sum / rows as f64)
    };
    let all = Coverage {
        name: "all".to_owned(),
        rows,
        reached: (0..targets).map(|k| over(&|group| group.reached[k])).collect(),
        half_width: (0..targets).map(|k| over(&|group| Some(group.half_width[k])).unwrap_or(f64::NAN)).collect(),
    };
    Ok(CrossCoverage { level, all, groups, faults })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluate::fixture::{mean_of, recordings, repeat};
    use ndarray::array;
    use rand::{RngExt, SeedableRng};

    #[test]
    fn the_share_within_by_hand() {
        let some = calibrate(array![[1.0], [3.0]].view(), 0.5).unwrap();
        assert_eq!(coverage(array![[3.0], [-3.1], [f64::NAN]].view(), &some, "s1").reached, [Some(0.5)]);
        assert_eq!(coverage(Array2::zeros((0, 1)).view(), &some, "s1").reached, [None]);
    }

    #[test]
    fn swappable_rows_are_covered_as_promised() {
        // 200 draws of 40 rows to calibrate and 400 to test. Between 0.9 and 0.9 + 1 / 41 by the theorem, SD of the
        // mean 0.004; measured 0.902.
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(5);
        let mut draw = |rows| Array2::from_shape_fn((rows, 1), |_| random.random_range(-1.0..1.0_f64).powi(3));
        let shares = (0..200).map(|_| {
            let intervals = calibrate(draw(40).view(), 0.9).unwrap();
            coverage(draw(400).view(), &intervals, "").reached[0].unwrap()
        });
        let mean = shares.sum::<f64>() / 200.0;
        assert!((0.888..=0.937).contains(&mean), "{mean}");
    }

    #[test]
    fn groups_are_left_out_of_everything() {
        let sizes = [("s1", "1", "a", 300), ("s2", "2", "a", 40), ("s3", "3", "a", 200), ("s4", "4", "a", 60)];
        let data = recordings(&sizes);
        let predict = |mean: &Vec<f64>, data: &Dataset| repeat(mean, data);
        let nested = nested_coverage(&data, By::Session, 0.8, mean_of, predict).unwrap();
        assert_eq!(nested.groups.iter().map(|group| group.rows).collect::<Vec<_>>(), [300, 40, 200, 60]);
        // By hand for the second: what the strict figure is.
        let rest = data.only(&[0, 2, 3]);
        let inner = cross_validate(&rest, By::Session, mean_of, predict).unwrap();
        let intervals = calibrate(inner.residuals(&rest).view(), 0.8).unwrap();
        let test = data.only(&[1]);
        let residuals = repeat(&mean_of(&rest).unwrap(), &test) - test.y();
        assert_eq!(nested.groups[1], coverage(residuals.view(), &intervals, "2"));
        // Measured 0.78 to 0.82.
        assert!(nested.all.reached.iter().all(|share| (0.7..=0.9).contains(&share.unwrap())), "{:?}", nested.all);

        let all = cross_validate(&data, By::Session, mean_of, predict).unwrap();
        let groups: Vec<_> = all.folds.iter().map(|fold| fold.name.clone()).zip(all.rows.clone()).collect();
        let quick = cross_coverage(all.residuals(&data).view(), &groups, 0.8).unwrap();
        assert_eq!((quick.groups.len(), quick.all.rows), (4, 600));
        assert!(cross_coverage(all.residuals(&data).view(), &groups[..1], 0.8).is_err());
    }

    #[test]
    fn what_promises_nothing_is_refused() {
        let data = recordings(&[("s1", "1", "a", 30), ("s2", "2", "a", 30), ("s3", "3", "a", 30)]);
        let predict = |mean: &Vec<f64>, data: &Dataset| repeat(mean, data);
        let run = |data: &Dataset, by, level| nested_coverage(data, by, level, mean_of, predict);
        assert_eq!(run(&data, By::Rows { folds: 3, seed: 0 }, 0.9), Err(IntervalFault::Shuffled));
        assert_eq!(run(&data.only(&[0, 1]), By::Session, 0.9), Err(IntervalFault::Groups(2)));
        assert!(matches!(run(&data, By::Subject, 0.9), Err(IntervalFault::Split(_))));
        let says = run(&data, By::Session, 0.99).unwrap_err().to_string();
        assert!(says.contains("without 1: 60 held-out rows can't tell how wide 0.99 of all is"), "{says}");
        let failing = |data: &Dataset| if data.rows() == 60 { Err("dead".to_owned()) } else { mean_of(data) };
        assert!(matches!(
            nested_coverage(&data, By::Session, 0.9, failing, predict),
            Err(IntervalFault::AllFailed { .. })
        ));
    }
}
