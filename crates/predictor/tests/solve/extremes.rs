//! The ends: few rows, constant targets, very large and very small values, what is not finite.

use super::{any, dataset, fit};
use lunula_predictor::{
    Deficient, FitFault, LeastSquaresFault, LeastSquaresOptions, fit_linear, fit_quadratic, least_squares,
};
use ndarray::{Array2, array};

#[test]
fn as_many_rows_as_unknowns_fit_exactly_and_say_so() {
    let (x, y) = (any(4, 3, 1), any(4, 1, 2));
    let found = fit(&x, &y, Deficient::Refuse).unwrap();
    assert_eq!(found.residual_sd, [None]);
    assert!(found.standard_errors.iter().all(|v| v.is_nan()));
    for (row, &y) in x.outer_iter().zip(&y) {
        let at = found.target_centre[0]
            + row.iter().zip(&found.centre).zip(&found.coefficients).map(|((x, m), j)| (x - m) * j).sum::<f64>();
        // Measured 4e-16.
        assert!((at - y).abs() <= 1e-14);
    }
    let (_, report) = fit_linear(&dataset(x, y), &LeastSquaresOptions::default()).unwrap();
    assert_eq!(report.residual_sd, [None]);
    assert!(report.warnings[0].contains("determine the terms exactly"), "{:?}", report.warnings);
}

#[test]
fn too_few_rows_are_refused_or_shared_out() {
    let (x, y) = (any(3, 3, 3), any(3, 1, 4));
    let fault = fit(&x, &y, Deficient::Refuse).unwrap_err();
    assert_eq!(fault, LeastSquaresFault::TooFewRows { rows: 3, columns: 3 });
    assert_eq!(fault.to_string(), "3 terms need at least 4 rows; there are 3");
    assert_eq!(fit(&x, &y, Deficient::Drop).unwrap().rank, Some(2));
    let none = Array2::zeros((0, 3));
    assert_eq!(fit(&none, &Array2::zeros((0, 1)), Deficient::MinimumNorm).unwrap_err(), LeastSquaresFault::NoRows);
}

#[test]
fn one_row_and_rows_all_alike_tell_only_their_value() {
    for rows in [1, 70] {
        let x = Array2::from_shape_fn((rows, 2), |(_, j)| 0.1 + j as f64);
        let y = Array2::from_elem((rows, 1), 0.7);
        let found = fit(&x, &y, Deficient::MinimumNorm).unwrap();
        assert_eq!((found.rank, found.condition), (Some(0), f64::INFINITY));
        assert!(found.coefficients.iter().all(|&v| v == 0.0));
        assert_eq!((&found.centre[..], &found.target_centre[..]), (&[0.1, 1.1][..], &[0.7][..]));
        assert_eq!(fit(&x, &y, Deficient::Drop).unwrap().dropped, [0, 1]);
        assert!(fit(&x, &y, Deficient::Ridge(1.0)).unwrap().coefficients.iter().all(|&v| v == 0.0));
    }
    let alike = Array2::from_elem((70, 2), 2.5);
    let fault = fit_linear(&dataset(alike, any(70, 1, 5)), &LeastSquaresOptions::default()).unwrap_err();
    assert_eq!(fault, FitFault::Deficient(vec!["P1 is constant".into(), "P2 is constant".into()]));
}

#[test]
fn a_constant_target_has_no_slopes_at_all() {
    let found = fit(&any(90, 4, 6), &Array2::from_elem((90, 1), -0.1), Deficient::Refuse).unwrap();
    assert!(found.coefficients.iter().all(|&v| v == 0.0));
    assert_eq!((&found.target_centre[..], &found.residual_sd[..]), (&[-0.1][..], &[Some(0.0)][..]));
    assert_eq!(found.intercept, [-0.1]);
}

#[test]
fn without_columns_there_is_the_mean() {
    let found = fit(&Array2::zeros((3, 0)), &array![[1.0], [2.0], [6.0]], Deficient::Refuse).unwrap();
    assert_eq!((&found.target_centre[..], &found.intercept[..]), (&[3.0][..], &[3.0][..]));
    assert_eq!((found.rank, found.condition), (Some(0), 1.0));
}

#[test]
fn huge_and_tiny_values_are_values() {
    let (x, y) = (any(50, 3, 7), any(50, 1, 8));
    let plain = fit(&x, &y, Deficient::Refuse).unwrap();
    for (of_x, of_y) in [(990, 990), (-990, -990), (1021, 1021), (-1000, 0), (600, -400)] {
        // Values lie between 2 and 3, so that these go from 1e-301 to the largest number there is.
        let scale = |values: &Array2<f64>, e| values.mapv(|v| v * 2f64.powi(e));
        let found = fit(&scale(&x, of_x), &scale(&y, of_y), Deficient::Refuse).unwrap();
        let back = found.coefficients.mapv(|v| v * 2f64.powi(of_x - of_y - 1) * 2.0);
        assert_eq!(back, plain.coefficients, "2^{of_x}, 2^{of_y}");
        assert_eq!(found.residual_sd[0].unwrap() * 2f64.powi(-of_y), plain.residual_sd[0].unwrap());
        assert_eq!(found.condition, plain.condition);
        let data = dataset(scale(&x, of_x), scale(&y, of_y));
        let (model, _) = fit_quadratic(&data, &LeastSquaresOptions::default()).unwrap();
        let mut out = [0.0];
        model.predict_row(data.x().row(0).as_slice().unwrap(), &mut out);
        assert!(out[0].is_finite());
    }
    let fault = fit(&x.mapv(|v| v * 1e-300), &y.mapv(|v| v * 1e300), Deficient::Refuse).unwrap_err();
    assert_eq!(fault, LeastSquaresFault::Range { column: 0, target: 0 });
    // Below what a number holds it is no 0: that would be a model that says nothing.
    let fault = fit(&x.mapv(|v| v * 1e300), &y.mapv(|v| v * 1e-300), Deficient::Refuse).unwrap_err();
    assert_eq!(fault, LeastSquaresFault::Range { column: 0, target: 0 });
    // Both ends in one column.
    let mut wild = x;
    wild[[3, 1]] = f64::MAX;
    wild[[4, 1]] = -f64::MAX;
    assert!(fit(&wild, &y, Deficient::Refuse).unwrap().coefficients.iter().all(|v| v.is_finite()));
}

#[test]
fn what_is_not_finite_is_named() {
    let (mut x, y) = (any(70, 3, 9), any(70, 2, 10));
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        x[[66, 1]] = bad;
        let fault = fit(&x, &y, Deficient::Drop).unwrap_err();
        assert_eq!(fault, LeastSquaresFault::NotFinite { target: false, row: 66, column: 1 });
        x[[66, 1]] = 2.0;
        let mut z = y.clone();
        z[[0, 1]] = bad;
        let fault = fit(&x, &z, Deficient::Drop).unwrap_err();
        assert_eq!(fault, LeastSquaresFault::NotFinite { target: true, row: 0, column: 1 });
    }
    let fault = fit(&x, &any(69, 1, 11), Deficient::Drop).unwrap_err();
    assert_eq!(fault, LeastSquaresFault::Rows { design: 70, targets: 69 });
}

#[test]
fn a_flicker_of_the_last_bit_is_no_signal() {
    let mut x = any(80, 2, 12);
    for (i, v) in x.column_mut(1).iter_mut().enumerate() {
        *v = if i % 3 == 0 { 2.0 } else { 2.0 + f64::EPSILON * 2.0 };
    }
    let fault = fit(&x, &any(80, 1, 13), Deficient::Refuse).unwrap_err();
    assert_eq!(fault, LeastSquaresFault::Deficient { constant: vec![1], dependent: vec![] });
}

/// A photodiode that is another one seen on a large offset: rounding leaves it only some digits of that other.
#[test]
fn a_photodiode_on_a_large_offset_is_still_dependent() {
    for share in [1.0, 0.9, 0.7, 0.5, 0.001] {
        for seed in 0..10 {
            let wave = |row: usize| 3.0 + ((row * (7 + seed)) as f64 * 0.618).sin() * 0.2;
            let design = Array2::from_shape_fn((200, 2), |(row, column)| match column {
                0 => wave(row),
                _ => share * wave(row) + 500.0,
            });
            let targets = Array2::from_shape_fn((200, 1), |(row, _)| wave(row));
            let found = least_squares(design.view(), targets.view(), &LeastSquaresOptions::default());
            assert!(matches!(found, Err(LeastSquaresFault::Deficient { .. })), "{share} {seed}: {found:?}");
        }
    }
}

#[test]
fn voltages_and_targets_beyond_a_number_are_reported_by_name() {
    let (x, y) = (any(60, 2, 9), any(60, 2, 10));
    let denormal = x.mapv(|v| (v * 100.0).round() * 5e-324);
    let options = LeastSquaresOptions::default();
    let said = fit_linear(&dataset(denormal.clone(), y.clone()), &options).unwrap_err().to_string();
    assert!(said.starts_with("what F1 has of P1 is beyond what a number can hold"), "{said}");
    let said = fit_quadratic(&dataset(denormal, y), &options).unwrap_err().to_string();
    assert!(said.starts_with("P1 spreads over so little"), "{said}");
}

#[test]
fn a_constant_target_is_reported() {
    let data = dataset(any(90, 2, 6), array![[-1e-300]].broadcast((90, 1)).unwrap().to_owned());
    let options = LeastSquaresOptions::default();
    for warnings in
        [fit_linear(&data, &options).unwrap().1.warnings, fit_quadratic(&data, &options).unwrap().1.warnings]
    {
        assert_eq!(warnings, ["F1 is -1e-300 in all training rows, and so in all predictions"]);
    }
}
