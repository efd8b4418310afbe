//! Least squares where columns depend on each other or rows are few, and what must hold for any rows.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod extremes;
mod properties;
mod twin;

use lunula_predictor::{
    Dataset, Deficient, Dependent, FitFault, LeastSquares, LeastSquaresFault, LeastSquaresOptions, Solver, fit_linear,
    fit_quadratic, least_squares,
};
use ndarray::{Array2, Axis};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Evenly distributed, 0 to 1, with an offset of 2.
pub(crate) fn any(rows: usize, columns: usize, seed: u64) -> Array2<f64> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    Array2::from_shape_fn((rows, columns), |_| 2.0 + rng.random_range(0.0..1.0))
}

pub(crate) fn fit(x: &Array2<f64>, y: &Array2<f64>, deficient: Deficient) -> Result<LeastSquares, LeastSquaresFault> {
    least_squares(x.view(), y.view(), &LeastSquaresOptions { deficient, ..LeastSquaresOptions::default() })
}

/// Six columns: the third constant, the fifth twice the second plus an offset, the sixth the first less the fourth.
fn dependent(rows: usize) -> Array2<f64> {
    let mut x = any(rows, 6, 21);
    for mut row in x.rows_mut() {
        row[2] = 0.3;
        row[4] = 2.0 * row[1] + 0.7;
        row[5] = row[0] - row[3];
    }
    x
}

fn dataset(x: Array2<f64>, y: Array2<f64>) -> Dataset {
    let names = |letter: &str, count| (1..=count).map(|k| format!("{letter}{k}")).collect();
    Dataset::plain(names("P", x.ncols()), names("F", y.ncols()), x, y, 0.04).unwrap()
}

/// The twins' own arithmetic; measured 2e-10 for the minimum norm, 1e-14 for the others.
const TWIN: f64 = 2e-9;

#[test]
fn dependent_columns_are_refused_by_name() {
    let fault = fit(&dependent(50), &any(50, 1, 22), Deficient::Refuse).unwrap_err();
    let LeastSquaresFault::Deficient { constant, dependent: found } = &fault else { panic!("{fault}") };
    assert_eq!(constant, &[2]);
    assert_eq!(found.len(), 2);
    // Which of those that depend is named last is the pivoting's choice.
    assert!(
        found.contains(&Dependent { column: 1, with: vec![4] })
            || found.contains(&Dependent { column: 4, with: vec![1] })
    );
    let mut three: Vec<usize> = found[1].with.iter().chain([&found[1].column]).copied().collect();
    if found[1].with.len() == 1 {
        three = found[0].with.iter().chain([&found[0].column]).copied().collect();
    }
    three.sort_unstable();
    assert_eq!(three, [0, 3, 5]);
}

#[test]
fn photodiodes_are_named() {
    let data = dataset(dependent(50), any(50, 1, 22));
    let FitFault::Deficient(words) = fit_linear(&data, &LeastSquaresOptions::default()).unwrap_err() else { panic!() };
    assert_eq!(words[..2], ["P3 is constant", "P2 and P5 read alike"]);
    assert!(words[2].contains(" follows from "), "{words:?}");
    let mut x = any(80, 4, 23);
    x.column_mut(1).fill(1.5);
    let three = x.column(0).to_owned();
    x.column_mut(2).assign(&three);
    x.column_mut(3).assign(&three.mapv(|v| -v));
    let fault = fit_quadratic(&dataset(x, any(80, 3, 24)), &LeastSquaresOptions::default()).unwrap_err();
    let message = fault.to_string();
    assert!(message.starts_with("P2 is constant; P1, P3 and P4 read alike (leave out"), "{message}");
    let few = fit_quadratic(&dataset(any(30, 8, 25), any(30, 3, 26)), &LeastSquaresOptions::default()).unwrap_err();
    assert!(few.to_string().starts_with("44 terms need at least 45 rows; there are 30"), "{few}");
}

#[test]
fn minimum_norm_is_the_limit_of_the_ridge() {
    for (x, rank) in [(dependent(60), 3), (any(5, 8, 27), 4), (any(40, 5, 28), 5)] {
        let y = any(x.nrows(), 2, 29);
        let found = fit(&x, &y, Deficient::MinimumNorm).unwrap();
        assert_eq!(found.rank, Some(rank));
        let gap = twin::gap(&found.coefficients, &twin::minimum_norm(&x, &y));
        println!("rank {rank}: gap {gap:.1e}");
        assert!(gap <= TWIN, "rank {rank}: gap {gap:e}");
    }
    let shared = fit(&dependent(60), &any(60, 2, 29), Deficient::MinimumNorm).unwrap();
    for row in shared.coefficients.outer_iter() {
        assert_eq!(row[2], 0.0);
        // Duplicates share: coefficient times length is the same.
        assert!((row[1] - 2.0 * row[4]).abs() <= 1e-13 * row[1].abs());
    }
}

#[test]
fn dropping_fits_without_what_is_dropped() {
    let (x, y) = (dependent(60), any(60, 2, 30));
    let found = fit(&x, &y, Deficient::Drop).unwrap();
    assert_eq!((found.rank, found.dropped.len()), (Some(3), 3));
    assert!(found.dropped.contains(&2));
    let kept: Vec<usize> = (0..6).filter(|j| !found.dropped.contains(j)).collect();
    let alone = fit(&x.select(Axis(1), &kept), &y, Deficient::Refuse).unwrap();
    let gap = twin::gap(&found.coefficients.select(Axis(1), &kept), &alone.coefficients);
    assert!(gap <= 1e-15, "{gap:e}");
    for &j in &found.dropped {
        assert!(found.coefficients.column(j).iter().all(|&v| v == 0.0));
        assert!(found.standard_errors.column(j).iter().all(|v| v.is_nan()));
    }
    let gap = twin::gap(&found.standard_errors.select(Axis(1), &kept), &alone.standard_errors);
    assert!(gap <= 1e-13, "{gap:e}");
    let data = dataset(x, y);
    let options = LeastSquaresOptions { deficient: Deficient::Drop, ..LeastSquaresOptions::default() };
    let (_, report) = fit_linear(&data, &options).unwrap();
    assert_eq!(report.dropped.len(), 3);
    assert_eq!(report.warnings, ["the rows tell 3 of 6 terms apart"]);
}

#[test]
fn ridge_is_the_textbook_s() {
    for lambda in [1e-6, 0.1, 10.0] {
        for x in [any(60, 5, 31), dependent(60), any(3, 7, 32)] {
            let y = any(x.nrows(), 2, 33);
            let found = fit(&x, &y, Deficient::Ridge(lambda)).unwrap();
            let gap = twin::gap(&found.coefficients, &twin::ridge(&x, &y, lambda));
            println!("lambda {lambda}: gap {gap:.1e}");
            assert!(gap <= TWIN, "lambda {lambda}: gap {gap:e}");
        }
    }
    for lambda in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(
            fit(&any(9, 2, 34), &any(9, 1, 35), Deficient::Ridge(lambda)),
            Err(LeastSquaresFault::Ridge(_))
        ));
    }
}

#[test]
fn normal_equations_agree_where_nothing_is_lost() {
    let (x, y) = (any(60, 5, 36), any(60, 2, 37));
    let options = LeastSquaresOptions { solver: Solver::Normal, ..LeastSquaresOptions::default() };
    let normal = least_squares(x.view(), y.view(), &options).unwrap();
    let orthogonal = fit(&x, &y, Deficient::Refuse).unwrap();
    // Measured 7e-14 and 2e-13.
    assert!(twin::gap(&normal.coefficients, &orthogonal.coefficients) <= 2e-12);
    assert!(twin::gap(&normal.standard_errors, &orthogonal.standard_errors) <= 2e-12);
    assert!(normal.condition.is_nan() && normal.rank.is_none());
    let data = dataset(x, y);
    let (printed, _) = fit_quadratic(&data, &options).unwrap();
    let (centred, _) = fit_quadratic(&data, &LeastSquaresOptions::default()).unwrap();
    let mut out = ([0.0; 2], [0.0; 2]);
    for row in data.x().outer_iter() {
        printed.predict_row(row.as_slice().unwrap(), &mut out.0);
        centred.predict_row(row.as_slice().unwrap(), &mut out.1);
        // Measured 3e-8: what the normal equations lose on 20 terms.
        assert!((out.0[0] - out.1[0]).abs() <= 1e-6, "{out:?}");
    }
}
