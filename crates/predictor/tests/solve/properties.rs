//! What must hold for any rows.

use super::{fit, twin};
use lunula_predictor::{Deficient, modes};
use ndarray::{Array2, Axis};
use proptest::prelude::*;

/// Rows x (columns and one target).
fn rows() -> impl Strategy<Value = Array2<f64>> {
    (1..6_usize, 12..150_usize).prop_flat_map(|(columns, rows)| {
        prop::collection::vec(-1.0..1.0f64, rows * (columns + 1))
            .prop_map(move |values| Array2::from_shape_vec((rows, columns + 1), values).unwrap())
    })
}

fn halves(values: &Array2<f64>) -> (Array2<f64>, Array2<f64>) {
    let (x, y) = values.view().split_at(Axis(1), values.ncols() - 1);
    (x.to_owned(), y.to_owned())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn residuals_are_at_right_angles_to_columns_and_ones(values in rows()) {
        let (x, y) = halves(&values);
        let found = fit(&x, &y, Deficient::Refuse).unwrap();
        let residuals = &y - &x.dot(&found.coefficients.t()) - found.intercept[0];
        let worst = x.t().dot(&residuals).iter().fold(residuals.sum().abs(), |w, v| w.max(v.abs()));
        // Rounding of this test's own sums of up to 150 products of about 1; measured at most 4e-14.
        prop_assert!(worst <= 1e-12, "{worst:e}");
        if let Some(sd) = found.residual_sd[0] {
            let freedom = (x.nrows() - x.ncols() - 1) as f64;
            let own = (residuals.iter().map(|r| r * r).sum::<f64>() / freedom).sqrt();
            prop_assert!((sd - own).abs() <= 1e-12 * own);
        }
    }

    #[test]
    fn the_order_of_rows_does_not_matter(values in rows()) {
        let (x, y) = halves(&values);
        let one = fit(&x, &y, Deficient::Refuse).unwrap();
        let backwards: Vec<usize> = (0..x.nrows()).rev().collect();
        let two = fit(&x.select(Axis(0), &backwards), &y.select(Axis(0), &backwards), Deficient::Refuse).unwrap();
        // Measured 2e-16: refined solutions are rounded once.
        prop_assert!(twin::gap(&two.coefficients, &one.coefficients) <= 1e-15);
    }

    #[test]
    fn powers_of_two_change_nothing_but_units(values in rows(), powers in prop::collection::vec(-200..200i32, 6)) {
        let (x, y) = halves(&values);
        let one = fit(&x, &y, Deficient::Refuse).unwrap();
        let mut scaled = x.clone();
        for (mut column, &e) in scaled.columns_mut().into_iter().zip(&powers) {
            column.mapv_inplace(|v| v * 2f64.powi(e));
        }
        let two = fit(&scaled, &(&y * 2f64.powi(powers[5])), Deficient::Refuse).unwrap();
        for (j, &e) in powers[..x.ncols()].iter().enumerate() {
            prop_assert_eq!(two.coefficients[[0, j]], one.coefficients[[0, j]] * 2f64.powi(powers[5] - e));
            prop_assert_eq!(two.standard_errors[[0, j]], one.standard_errors[[0, j]] * 2f64.powi(powers[5] - e));
        }
        prop_assert_eq!(two.singular_values, one.singular_values);
    }

    #[test]
    fn views_of_any_layout_are_the_same(values in rows()) {
        let (x, y) = halves(&values);
        let one = fit(&x, &y, Deficient::Refuse).unwrap();
        let turned = x.t().as_standard_layout().into_owned().reversed_axes();
        prop_assert_eq!(fit(&turned, &y, Deficient::Refuse).unwrap(), one);
    }

    #[test]
    fn modes_put_the_matrix_together_again(values in rows(), e in -1000..1000i32, wide in any::<bool>()) {
        let a = if wide { values.t().to_owned() } else { values };
        let scaled = a.mapv(|v| v * 2f64.powi(e));
        let found = modes(scaled.view());
        prop_assert!(found.sigma.windows(2).all(|pair| pair[0] >= pair[1]));
        let sigma: Vec<f64> = found.sigma.iter().map(|s| s * 2f64.powi(-e)).collect();
        let mut back = Array2::zeros(a.dim());
        for (k, s) in sigma.iter().enumerate() {
            let left = found.left.column(k).insert_axis(Axis(1));
            back = back + left.dot(&found.right.column(k).insert_axis(Axis(0))) * *s;
            let largest = left.iter().fold(0.0, |most: f64, v| if v.abs() > most.abs() { *v } else { most });
            prop_assert!(largest > 0.0);
        }
        // Measured at most 3e-15.
        prop_assert!(twin::gap(&back, &a) <= 1e-13);
        for vectors in [&found.left, &found.right] {
            let gram = vectors.t().dot(vectors) - Array2::<f64>::eye(vectors.ncols());
            prop_assert!(gram.iter().all(|v| v.abs() <= 1e-13));
        }
    }
}

#[test]
fn modes_of_nothing_and_of_zero() {
    assert!(modes(Array2::zeros((0, 3)).view()).sigma.is_empty());
    for (targets, inputs) in [(3, 8), (8, 3), (1, 1), (2, 2)] {
        let found = modes(Array2::zeros((targets, inputs)).view());
        assert_eq!(found.sigma, vec![0.0; targets.min(inputs)]);
        let gram = found.right.t().dot(&found.right);
        assert_eq!(gram, Array2::<f64>::eye(targets.min(inputs)));
        assert_eq!(found.left.t().dot(&found.left), gram);
    }
    // Columns of very different lengths.
    let steep = Array2::from_shape_fn((2, 2), |(i, j)| if (i, j) == (0, 0) { 1e290 } else { 1.0 + j as f64 });
    let found = modes(steep.view());
    assert_eq!(found.sigma[0], 1e290);
    assert!((found.sigma[1] - 2.0).abs() <= 1e-15, "{:?}", found.sigma);
    // Rank one: the other vectors still stand at right angles.
    let one = Array2::from_shape_fn((3, 8), |(i, j)| (i + 1) as f64 * (j + 1) as f64);
    let found = modes(one.view());
    let wanted = (14.0 * 204.0_f64).sqrt();
    assert!((found.sigma[0] - wanted).abs() <= 1e-14 * wanted && found.sigma[1] <= 1e-14 * wanted);
    for vectors in [&found.left, &found.right] {
        let gram = vectors.t().dot(vectors) - Array2::<f64>::eye(3);
        assert!(gram.iter().all(|v| v.abs() <= 1e-12), "{gram}");
    }
}
