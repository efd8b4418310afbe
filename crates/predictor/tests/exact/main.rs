//! Fits and singular values against exact arithmetic.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod rational;

use lunula_predictor::{
    Dataset, FitReport, LeastSquaresOptions, Linear, Quadratic, fit_linear, fit_quadratic, linear_f0, modes,
    quadratic_printed, quadratic_terms,
};
use ndarray::{Array2, Axis};
use num_rational::BigRational;
use num_traits::{Signed, Zero};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rational::{digits, exact, fewest, least_squares};

/// Voltages of `inputs` photodiodes that share most of what they see: `own` is how much each sees by itself.
fn volts(rows: usize, inputs: usize, own: f64, seed: u64) -> Array2<f64> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut x = Array2::zeros((rows, inputs));
    for mut row in x.rows_mut() {
        let shared: f64 = rng.random_range(-0.5..0.5);
        for value in &mut row {
            *value = 2.5 + shared + own * rng.random_range(-0.5..0.5);
        }
    }
    x
}

/// One force of them with noise.
fn force(x: &Array2<f64>, seed: u64) -> Array2<f64> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let slopes: Vec<f64> = (0..x.ncols()).map(|_| rng.random_range(-2.0..2.0)).collect();
    Array2::from_shape_fn((x.nrows(), 1), |(i, _)| {
        let row = x.row(i);
        let centred = row.iter().zip(&slopes).map(|(x, slope)| (x - 2.5) * slope).sum::<f64>();
        centred + 0.3 * (row[0] - 2.5).powi(2) + rng.random_range(-0.1..0.1)
    })
}

fn dataset(x: Array2<f64>, y: Array2<f64>) -> Dataset {
    let inputs = (1..=x.ncols()).map(|k| format!("P{k}")).collect();
    Dataset::plain(inputs, vec!["Fz_N".into()], x, y, 0.04).unwrap()
}

fn linear(data: &Dataset) -> (Linear, FitReport) {
    fit_linear(data, &LeastSquaresOptions::default()).unwrap()
}

/// Digits of the linear model's slopes, and of its F_0.
fn linear_digits(data: &Dataset) -> (f64, f64, FitReport) {
    let (model, report) = linear(data);
    let rows: Vec<Vec<BigRational>> =
        data.x().outer_iter().map(|row| row.iter().map(|&v| exact(v)).collect()).collect();
    let wanted = least_squares(&rows, &data.y().column(0).to_vec());
    let (f0, slopes) = wanted.split_last().unwrap();
    (fewest(model.jacobian(), slopes), digits(linear_f0(&model)[0], f0), report)
}

#[test]
fn linear_at_ordinary_volts() {
    let x = volts(200, 8, 2e-3, 1);
    let y = force(&x, 2);
    let (slopes, f0, report) = linear_digits(&dataset(x, y));
    let condition = report.condition.unwrap();
    println!("condition {condition:.1e}: {slopes:.1} digits of slopes, {f0:.1} of F_0");
    assert!((5e2..5e3).contains(&condition), "condition {condition:e}");
    assert!(slopes >= 15.0, "{slopes} digits");
    assert!(f0 >= 12.0, "{f0} digits of F_0");
}

#[test]
fn an_offset_takes_no_digits() {
    let signal = volts(150, 8, 0.5, 3).mapv(|v| v - 2.5);
    let x = signal.mapv(|v| 2f64.powi(20) + v * 2f64.powi(-10));
    let y = force(&signal.mapv(|v| v + 2.5), 4);
    let (slopes, _, _) = linear_digits(&dataset(x, y));
    println!("{slopes:.1} digits of slopes");
    assert!(slopes >= 15.0, "{slopes} digits");
}

#[test]
fn channels_scales_take_no_digits() {
    let mut x = volts(150, 9, 0.5, 5);
    let y = force(&x, 6);
    for (j, mut column) in x.columns_mut().into_iter().enumerate() {
        let scale = 2f64.powi(10 * j as i32 - 40);
        column.mapv_inplace(|v| v * scale);
    }
    let (slopes, _, _) = linear_digits(&dataset(x, y));
    println!("{slopes:.1} digits of slopes");
    assert!(slopes >= 15.0, "{slopes} digits");
}

#[test]
fn near_collinear_channels_are_separated_with_a_warning() {
    let mut x = volts(150, 8, 0.5, 7);
    let mut rng = ChaCha8Rng::seed_from_u64(8);
    for mut row in x.rows_mut() {
        row[6] = row[2] + 2f64.powi(-30) * rng.random_range(-0.5..0.5);
    }
    let y = force(&x, 9);
    let (slopes, _, report) = linear_digits(&dataset(x, y));
    println!("condition {:.1e}: {slopes:.1} digits; {:?}", report.condition.unwrap(), report.warnings);
    assert!(slopes >= 13.0, "{slopes} digits");
    assert!(report.digits.unwrap() < 8.0);
    assert_eq!(report.warnings.len(), 1);
    assert!(report.warnings[0].starts_with("P3 and P7 hardly differ"), "{}", report.warnings[0]);
}

#[test]
fn a_rounded_copy_of_a_photodiode_is_named() {
    let mut x = volts(600, 8, 0.5, 7);
    for mut row in x.rows_mut() {
        row[6] = (row[2] * 1e4).round() / 1e4;
    }
    let y = force(&x, 9);
    let (_, _, report) = linear_digits(&dataset(x, y.clone()));
    let [warning] = &report.warnings[..] else { panic!("{:?}", report.warnings) };
    assert!(warning.starts_with("P3 and P7 are all but copies"), "{warning}");
    // With noise of its own of a millivolt it is another one.
    let mut x = volts(600, 8, 0.5, 7);
    let mut rng = ChaCha8Rng::seed_from_u64(8);
    for mut row in x.rows_mut() {
        row[6] = row[2] + rng.random_range(-2e-3..2e-3);
    }
    let (_, _, report) = linear_digits(&dataset(x, y));
    assert!(report.warnings.is_empty(), "{:?}", report.warnings);
}

/// Exact coefficients of u and the value at u = 0, for the centre and scale that the model chose.
fn quadratic_wanted(data: &Dataset, model: &Quadratic) -> Vec<BigRational> {
    let pairs = quadratic_terms(data.inputs().len());
    let rows: Vec<Vec<BigRational>> = data
        .x()
        .outer_iter()
        .map(|row| {
            let shifts = model.centre().iter().zip(model.scale());
            let u: Vec<BigRational> =
                row.iter().zip(shifts).map(|(&p, (&m, &s))| (exact(p) - exact(m)) / exact(s)).collect();
            let products = pairs.iter().map(|&(i, j)| &u[i] * &u[j]).collect::<Vec<_>>();
            u.into_iter().chain(products).collect()
        })
        .collect();
    least_squares(&rows, &data.y().column(0).to_vec())
}

/// The same in P.
fn expanded(wanted: &[BigRational], model: &Quadratic) -> Vec<BigRational> {
    let inputs = model.centre().len();
    let m: Vec<BigRational> = model.centre().iter().map(|&m| exact(m)).collect();
    let s: Vec<BigRational> = model.scale().iter().map(|&s| exact(s)).collect();
    let mut out = vec![BigRational::zero(); wanted.len()];
    let last = wanted.len() - 1;
    out[last] = wanted[last].clone();
    for i in 0..inputs {
        out[i] = &wanted[i] / &s[i];
        let part = &out[i] * &m[i];
        out[last] -= part;
    }
    for (term, (i, j)) in quadratic_terms(inputs).into_iter().enumerate() {
        let square = &wanted[inputs + term] / (&s[i] * &s[j]);
        out[i] -= &square * &m[j];
        out[j] -= &square * &m[i];
        out[last] += &square * &m[i] * &m[j];
        out[inputs + term] = square;
    }
    out
}

#[test]
fn quadratic_at_ordinary_volts() {
    let x = volts(160, 8, 4e-3, 10);
    let y = force(&x, 11);
    let data = dataset(x, y);
    let (model, report) = fit_quadratic(&data, &LeastSquaresOptions::default()).unwrap();
    let wanted = quadratic_wanted(&data, &model);
    let (offset, terms) = wanted.split_last().unwrap();
    let found = fewest(model.jacobian(), terms).min(digits(model.offset()[0], offset));
    let printed = quadratic_printed(&model);
    let in_volts = fewest(printed.coefficients.iter().chain(&printed.f0), &expanded(&wanted, &model));
    let condition = report.condition.unwrap();
    println!("condition {condition:.1e}: {found:.1} digits of the terms of u, {in_volts:.1} of P");
    assert!((1e5..1e7).contains(&condition), "condition {condition:e}");
    assert!(found >= 14.0, "{found} digits of the terms of u");
    assert!(in_volts >= 9.0, "{in_volts} digits of the terms of P");
}

/// det(A A^T - lambda I) of a 3 x n matrix.
fn characteristic(a: &Array2<f64>, lambda: &BigRational) -> BigRational {
    let g: Vec<Vec<BigRational>> = a
        .outer_iter()
        .map(|p| a.outer_iter().map(|q| p.iter().zip(q).map(|(&p, &q)| exact(p) * exact(q)).sum()).collect())
        .collect();
    let at = |i: usize, j: usize| if i == j { &g[i][j] - lambda } else { g[i][j].clone() };
    let minor = |p: usize, q: usize| at(1, p) * at(2, q) - at(1, q) * at(2, p);
    at(0, 0) * minor(1, 2) - at(0, 1) * minor(0, 2) + at(0, 2) * minor(0, 1)
}

/// The exact singular value lies so close: measured between 15 and 16 digits.
const SIGMA: f64 = 2e-14;

#[test]
fn singular_values_of_a_jacobian() {
    let mut rng = ChaCha8Rng::seed_from_u64(12);
    let mut cases = 0;
    // The third force's row nearly follows from the other two, or is small, or is neither.
    for (near, size) in [(1.0, 1.0), (1e-3, 1.0), (1.0, 1e-9), (1.0, 1e6)] {
        let mut a = Array2::from_shape_fn((3, 8), |_| rng.random_range(-1.0..1.0));
        let sum = &a.index_axis(Axis(0), 0) + &a.index_axis(Axis(0), 1);
        let mut third = a.index_axis_mut(Axis(0), 2);
        third.mapv_inplace(|v| v * near);
        if near < 1.0 {
            third += &sum;
        }
        third.mapv_inplace(|v| v * size);
        for &sigma in &modes(a.view()).sigma {
            // The characteristic polynomial changes its sign in between, worked out exactly.
            let signs = [1.0 - SIGMA, 1.0 + SIGMA].map(|f| {
                let edge = exact(sigma) * exact(f);
                characteristic(&a, &(&edge * &edge)).is_positive()
            });
            assert!(signs[0] != signs[1], "sigma {sigma:e} of case {cases}");
        }
        cases += 1;
    }
    assert_eq!(cases, 4);
}
