//! Splits on rows that know their targets, and on rows that do not.

use ndarray::Array2;

use super::*;
use crate::evaluate::fixture::recordings;
use crate::{Kind, Recipe, Recording, predict};

const WAYS: [By; 5] = [By::Rows { folds: 5, seed: 1 }, By::Trajectory, By::Path, By::Session, By::Subject];

fn linear() -> Method<'static> {
    Method {
        name: "linear".to_owned(),
        fit: Box::new(|train| {
            let fitted = Recipe::new(Kind::Linear).fit(train, None).map_err(|why| why.to_string())?;
            Ok(Box::new(move |test: &Dataset| predict(&fitted.model, None, test.x().view())))
        }),
    }
}

/// Recordings whose inputs wander smoothly, each along its own way, and whose targets do too, of another recording.
fn with_labels_of_another(own: bool) -> Dataset {
    let (count, rows) = (8, 150);
    let way = |seed: f64, t: f64| -> f64 {
        (1..5)
            .map(|k| {
                (0.03 * f64::from(k) * (1.0 + 0.4 * (12.9 * seed).sin()) * t + (seed * f64::from(k)).powi(2)).sin()
            })
            .sum()
    };
    let n = count * rows;
    let at = |row: usize| ((row / rows) as f64, (row % rows) as f64);
    let x = Array2::from_shape_fn((n, 3), |(row, k)| {
        let (one, t) = at(row);
        way(3.0 * one + k as f64 + 1.0, t) + 0.05 * ((row * (k + 3)) as f64 * 12.9898).sin()
    });
    let y = Array2::from_shape_fn((n, 1), |(row, _)| {
        let (one, t) = at(row);
        if own { x[[row, 0]] - 0.5 * x[[row, 2]] } else { way(100.0 + one, t) }
    });
    let one = |k: usize| Recording {
        name: format!("r{k}"),
        session: format!("{}", k / 2),
        subject: format!("{}", k / 4),
        rows: k * rows..(k + 1) * rows,
    };
    let time = (0..n).map(|row| 0.1 * at(row).1).collect();
    let names = ["P1", "P2", "P3"].map(str::to_owned).to_vec();
    Dataset::new(names, vec!["Fz_N".into()], time, x, y, (0..count).map(one).collect()).unwrap()
}

fn of<'a>(splits: &'a [Split], by: By, method: &str) -> &'a SplitTarget {
    let split = splits.iter().find(|split| split.by == by).unwrap();
    &split.methods.iter().find(|one| one.method == method).unwrap().targets[0]
}

#[test]
fn labels_of_another_recording_look_good_by_rows_and_are_named() {
    let splits = compare_splits(&with_labels_of_another(false), &[0, 1, 2], &WAYS, vec![linear()]);
    let nearest = of(&splits, WAYS[0], "nearest row");
    let mean = of(&splits, WAYS[0], "mean");
    assert!(nearest.beats_mean == Some(true) && nearest.rmse < 0.6 * mean.rmse, "{nearest:?} {mean:?}");
    for by in [By::Trajectory, By::Path, By::Session] {
        for method in ["nearest row", "linear"] {
            assert_eq!(of(&splits, by, method).beats_mean, Some(false), "{by:?} {method}");
        }
    }
    // Two subjects don't show how others differ.
    let subjects = of(&splits, By::Subject, "linear");
    assert!(subjects.beats_mean.is_none() && subjects.interval.is_none() && subjects.rmse > 0.0, "{subjects:?}");
    let found = leaks(&splits);
    assert_eq!((found.len(), found[0].target.as_str(), found[0].method.as_str()), (1, "Fz_N", "nearest row"));
    let flattered = flatteries(&splits);
    assert!(flattered[0].1 == "nearest row" && flattered[0].2 > 1.5 && flattered.len() == 2, "{flattered:?}");
    assert!(found[0].by_rows < 0.6 * found[0].by_paths && found[0].by_paths >= 0.9 * found[0].mean, "{found:?}");
}

#[test]
fn labels_of_their_own_are_no_leak() {
    let splits = compare_splits(&with_labels_of_another(true), &[0, 1, 2], &WAYS, vec![linear()]);
    for by in &WAYS[..4] {
        let linear = of(&splits, *by, "linear");
        assert!(linear.beats_mean == Some(true) && linear.rmse < 1e-9, "{by:?} {linear:?}");
        let [low, high] = of(&splits, *by, "mean").interval.unwrap();
        let rmse = of(&splits, *by, "mean").rmse;
        assert!(low < rmse && rmse < high && high < 2.0 * low, "{by:?} {low} {rmse} {high}");
    }
    assert_eq!(
        splits.iter().map(|split| split.same_as).collect::<Vec<_>>(),
        [None, None, Some(By::Trajectory), None, None]
    );
    assert_eq!(leaks(&splits), []);
    assert_eq!(splits.iter().map(|split| split.parts).collect::<Vec<_>>(), [5, 8, 8, 4, 2]);
}

/// One recording of each of five persons, whose inputs say the less of the target the more persons differ.
fn persons(differ: f64) -> Dataset {
    let (count, rows) = (5, 400);
    let n = count * rows;
    let at = |row: usize| ((row / rows) as f64, (row % rows) as f64);
    let y = Array2::from_shape_fn((n, 1), |(row, _)| {
        let (one, t) = at(row);
        (0.05 * t + one).sin() + (0.021 * t * (1.0 + 0.1 * one)).cos()
    });
    let x = Array2::from_shape_fn((n, 2), |(row, k)| {
        let own = 1.0 + differ * (7.3 * (at(row).0 + 1.0) + 2.0 * k as f64).sin();
        own * y[[row, 0]] + 0.05 * ((row * (k + 3)) as f64 * 12.9898).sin()
    });
    let one = |k: usize| Recording::of(format!("r{k}"), k * rows..(k + 1) * rows);
    let names = ["P1", "P2"].map(str::to_owned).to_vec();
    let time = (0..n).map(|row| 0.1 * at(row).1).collect();
    Dataset::new(names, vec!["Fz_N".into()], time, x, y, (0..count).map(one).collect()).unwrap()
}

#[test]
fn intervals_of_persons_are_of_persons_and_not_of_their_rows() {
    let width = |differ: f64, by: By| {
        let ways = [WAYS[0], By::Trajectory, By::Session, By::Subject];
        let splits = compare_splits(&persons(differ), &[0, 1], &ways, vec![linear()]);
        let same: Vec<_> = splits.iter().map(|split| split.same_as).collect();
        assert_eq!(same, [None, None, Some(By::Trajectory), Some(By::Trajectory)], "by time, and by what is held out");
        assert_eq!(of(&splits, By::Trajectory, "linear"), of(&splits, By::Subject, "linear"));
        let one = of(&splits, by, "linear");
        let [low, high] = one.interval.unwrap();
        assert!(low < one.rmse && one.rmse < high, "{one:?}");
        (high / low, one.beats_mean)
    };
    let by_time = width(1.5, WAYS[0]);
    for by in [By::Trajectory, By::Subject] {
        let (alike, differing) = (width(0.0, by), width(1.5, by));
        assert!(alike.1 == Some(true) && alike.0 < 1.1, "{by:?} {alike:?}");
        assert!(differing.1 == Some(false) && differing.0 > 2.0 * by_time.0, "{by:?} {differing:?} {by_time:?}");
    }
}

#[test]
fn what_two_recordings_may_know_is_no_leak_and_what_they_do_not_know_is() {
    // Two recordings don't show how others differ: nothing is sure, but the errors themselves say enough.
    for (own, found) in [(true, 0), (false, 1)] {
        let splits = compare_splits(&with_labels_of_another(own).only(&[0, 1]), &[0, 1, 2], &WAYS, vec![linear()]);
        let held = of(&splits, By::Trajectory, "linear");
        assert_eq!((held.interval, held.beats_mean), (None, None));
        assert_eq!(leaks(&splits).len(), found, "{splits:?}");
    }
}

#[test]
fn what_is_not_surely_better_than_the_mean_is_no_leak() {
    // Inputs that say much of the target in each of three recordings, each with a gain of its own.
    let splits = compare_splits(&persons(1.2).only(&[0, 2, 4]), &[0, 1], &WAYS, vec![linear()]);
    let [nearest, mean] = ["nearest row", "mean"].map(|method| of(&splits, By::Trajectory, method));
    assert!(nearest.beats_mean == Some(false) && nearest.rmse < 0.8 * mean.rmse, "{nearest:?} {mean:?}");
    assert_eq!(of(&splits, By::Trajectory, "linear").beats_mean, Some(false));
    assert_eq!(of(&splits, WAYS[0], "nearest row").beats_mean, Some(true));
    assert_eq!(leaks(&splits), []);
}

#[test]
fn what_can_not_be_held_out_and_what_can_not_be_fitted_say_why() {
    let data = recordings(&[("s1", "1", "a", 60), ("s2", "2", "a", 90)]);
    let dead = || Method { name: "dead".to_owned(), fit: Box::new(|_| Err("P1 is dead".to_owned())) };
    let splits = compare_splits(&data, &[0, 1], &WAYS, vec![dead()]);
    assert!(splits[4].fault.as_ref().unwrap().contains("only one subject") && splits[4].parts == 0);
    let one = splits[1].methods.iter().find(|one| one.method == "dead").unwrap();
    assert_eq!(one.fault.as_deref(), Some("none of 2 folds could be fitted; without s1: P1 is dead"));
    assert!(one.rows == 0 && one.targets.is_empty());
}
