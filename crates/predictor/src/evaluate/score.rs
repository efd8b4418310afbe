//! How far predictions are from measurements.
//!
//! In: measured and predicted rows, a column a target. Out: RMSE, bias, mean absolute error and R2 of each target and
//! over all. An error is predicted less measured. A row with a number that is not finite is counted and not scored; so
//! all targets are scored on the same rows. R2 = 1 - (sum of squared errors) / (sum of squares about the mean of the
//! rows scored); it is not defined where the target is constant.
//!
//! Offsets far above the errors cost no digits, and sizes from 1e-300 to 1e300 neither overflow nor underflow.

use ndarray::{ArrayView1, ArrayView2};
use serde::Serialize;

use super::sum::{exact_mean, mean, rms};

/// Errors of one target, or over all.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TargetScore {
    /// The target; of [`Scores::overall`], `all`.
    pub name: String,
    /// Root mean square of the errors, the target's unit; NaN of no rows.
    pub rmse: f64,
    /// Mean of predicted less measured, the target's unit; NaN of no rows.
    pub bias: f64,
    /// Mean magnitude of the errors, the target's unit; NaN of no rows.
    pub mae: f64,
    /// Share of the variance that is explained, below 0 where the mean would do better; none where the target is
    /// constant, of fewer than two rows, or spread beyond a double.
    pub r2: Option<f64>,
    /// How many numbers were compared.
    pub n: usize,
}

/// Errors of all targets.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Scores {
    /// Target by target.
    pub targets: Vec<TargetScore>,
    /// All targets' errors pooled (R2: summed squares over summed squares). Meaningful where all have one
    /// unit.
    pub overall: TargetScore,
    /// Rows that were scored.
    pub rows: usize,
    /// Rows that were not, as a number of them is not finite.
    pub invalid: usize,
}

/// Scores predictions, rows x targets.
///
/// # Panics
/// Where the sizes do not agree.
#[must_use]
pub fn score(measured: ArrayView2<f64>, predicted: ArrayView2<f64>, names: &[String]) -> Scores {
    let all: Vec<usize> = (0..measured.nrows()).collect();
    score_rows(measured, predicted, names, &all)
}

/// Scores some rows, in the order given.
pub(super) fn score_rows(
    measured: ArrayView2<f64>,
    predicted: ArrayView2<f64>,
    names: &[String],
    rows: &[usize],
) -> Scores {
    assert!(
        measured.dim() == predicted.dim() && measured.ncols() == names.len(),
        "as many rows and targets predicted as measured"
    );
    let valid: Vec<usize> = rows.iter().copied().filter(|&row| finite(&measured, &predicted, row)).collect();
    let (mut errors, mut deviations, mut targets) = (Vec::new(), Vec::new(), Vec::new());
    for (column, name) in names.iter().enumerate() {
        let (measured, predicted) = (measured.column(column), predicted.column(column));
        let own: Vec<f64> = valid.iter().map(|&row| predicted[row] - measured[row]).collect();
        let spread = about_mean(measured, &valid);
        targets.push(summary(name.clone(), &own, &spread));
        errors.extend(own);
        deviations.extend(spread);
    }
    let overall = summary("all".to_owned(), &errors, &deviations);
    Scores { targets, overall, rows: valid.len(), invalid: rows.len() - valid.len() }
}

fn finite(measured: &ArrayView2<f64>, predicted: &ArrayView2<f64>, row: usize) -> bool {
    measured.row(row).iter().chain(predicted.row(row)).all(|value| value.is_finite())
}

/// A target's values less their mean; exactly 0 where it is constant, which the mean of doubles need not give.
fn about_mean(values: ArrayView1<f64>, rows: &[usize]) -> Vec<f64> {
    if rows.windows(2).all(|pair| values[pair[0]] == values[pair[1]]) {
        return vec![0.0; rows.len()];
    }
    let (near, rest) = exact_mean(rows.iter().map(|&row| values[row]));
    rows.iter().map(|&row| (values[row] - near) - rest).collect()
}

fn summary(name: String, errors: &[f64], deviations: &[f64]) -> TargetScore {
    let rmse = rms(errors.iter().copied());
    let spread = rms(deviations.iter().copied());
    TargetScore {
        name,
        rmse,
        bias: mean(errors.iter().copied()),
        mae: mean(errors.iter().map(|error| error.abs())),
        r2: (spread > 0.0 && spread.is_finite()).then(|| 1.0 - (rmse / spread).powi(2)),
        n: errors.len(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::{Array2, array};
    use proptest::prelude::*;

    fn names(all: &[&str]) -> Vec<String> {
        all.iter().map(|&name| name.to_owned()).collect()
    }

    #[test]
    fn by_hand() {
        let measured = array![[1.0, 10.0], [2.0, 10.0], [3.0, 10.0], [f64::NAN, 10.0]];
        let predicted = array![[1.0, 11.0], [2.0, 11.0], [6.0, 8.0], [1.0, 10.0]];
        let all = score(measured.view(), predicted.view(), &names(&["Fx_N", "Fy_N"]));
        assert_eq!((all.rows, all.invalid), (3, 1));
        let first = &all.targets[0];
        assert_eq!((first.rmse, first.bias, first.mae, first.n), (3f64.sqrt(), 1.0, 1.0, 3));
        // 1 - 9 / 2.
        assert!((first.r2.unwrap() + 3.5).abs() <= 1e-15);
        let second = &all.targets[1];
        assert_eq!((second.bias, second.r2), (0.0, None), "a constant target has no R2");
        assert_eq!(all.overall.n, 6);
        // (9 + 6) / 6 under the root.
        assert!((all.overall.rmse - 2.5f64.sqrt()).abs() <= 1e-15);
    }

    #[test]
    fn nothing_and_one_row() {
        let none = score(Array2::zeros((0, 1)).view(), Array2::zeros((0, 1)).view(), &names(&["J2_deg"]));
        assert!(none.targets[0].rmse.is_nan() && none.targets[0].bias.is_nan() && none.targets[0].r2.is_none());
        let one = score(array![[3.0]].view(), array![[5.0]].view(), &names(&["J2_deg"]));
        assert_eq!((one.targets[0].rmse, one.targets[0].bias, one.targets[0].r2), (2.0, 2.0, None));
        let invalid = score(array![[3.0]].view(), array![[f64::INFINITY]].view(), &names(&["J2_deg"]));
        assert_eq!((invalid.rows, invalid.invalid), (0, 1));
    }

    #[test]
    fn errors_beyond_a_double_are_infinite_not_lost() {
        let (most, names) = (f64::MAX, names(&["J2_deg"]));
        let far = score(array![[-most], [1.0]].view(), array![[most], [1.0]].view(), &names);
        assert_eq!((far.targets[0].rmse, far.targets[0].bias, far.rows), (f64::INFINITY, f64::INFINITY, 2));
        let wide = array![[most], [most], [-most]];
        let right = score(wide.view(), wide.view(), &names);
        assert_eq!((right.targets[0].rmse, right.targets[0].r2), (0.0, None));
    }

    proptest! {
        // Numbers of ordinary size: the definitions as they are written in books.
        #[test]
        fn the_definitions(pairs in proptest::collection::vec((-3.0..3.0_f64, -3.0..3.0_f64), 2..50)) {
            let n = pairs.len() as f64;
            let column = |of: fn(&(f64, f64)) -> f64| {
                Array2::from_shape_fn((pairs.len(), 1), |(row, _)| of(&pairs[row]))
            };
            let all = score(column(|pair| pair.0).view(), column(|pair| pair.1).view(), &names(&["J2_deg"]));
            let over = |of: &dyn Fn(&(f64, f64)) -> f64| pairs.iter().map(of).sum::<f64>() / n;
            let mean = over(&|pair| pair.0);
            let squares = over(&|pair| (pair.1 - pair.0).powi(2));
            let spread = over(&|pair| (pair.0 - mean).powi(2));
            let one = &all.targets[0];
            let near = |a: f64, b: f64| (a - b).abs() <= 1e-13 * (1.0 + b.abs());
            prop_assert!(near(one.rmse, squares.sqrt()) && near(one.bias, over(&|pair| pair.1 - pair.0)));
            prop_assert!(near(one.mae, over(&|pair| (pair.1 - pair.0).abs())));
            // The naive mean's rounding enters where the spread is tiny.
            prop_assert!(spread < 1e-6 || near(one.r2.unwrap(), 1.0 - squares / spread));
            prop_assert_eq!((one.rmse, one.bias, one.r2), (all.overall.rmse, all.overall.bias, all.overall.r2));
        }
    }

    #[test]
    fn offsets_and_sizes_cost_no_digits() {
        // R2 of the same rows, moved and scaled by powers of two: the same number. Measured gap 0 when scaled, 1e-12 at
        // the offset, where the data themselves keep 2^-42 of the signal.
        let measured = [0.25, -0.5, 0.125, 0.75, -0.375];
        let predicted = [0.5, -0.25, 0.0, 0.5, -0.5];
        let r2 = |scale: f64, offset: f64| {
            let column = |all: [f64; 5]| Array2::from_shape_fn((5, 1), |(row, _)| offset + scale * all[row]);
            score(column(measured).view(), column(predicted).view(), &names(&["J2_deg"])).targets[0].r2.unwrap()
        };
        let plain = r2(1.0, 0.0);
        for scale in [2f64.powi(990), 2f64.powi(-1000)] {
            assert_eq!(r2(scale, 0.0), plain);
        }
        assert!((r2(2f64.powi(-10), 2f64.powi(20)) - plain).abs() <= 1e-12);
        // A constant that has no exact mean is still constant.
        let constant = Array2::from_elem((7, 1), 0.1);
        assert!(score(constant.view(), constant.view(), &names(&["J2_deg"])).targets[0].r2.is_none());
    }
}
