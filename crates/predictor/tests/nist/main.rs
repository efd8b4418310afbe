//! The linear least squares problems of NIST's Statistical Reference Datasets (<https://www.itl.nist.gov/div898/strd>):
//! worst digits of coefficients, the offset among them, and of standard errors. Data and certified values as the GNU
//! Scientific Library ships them (`multifit/test_{filip,longley,pontius}.c`); Wampler's as published, their
//! coefficients checked in rational numbers.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod filip;
mod longley;
mod pontius;
mod wampler;

use lunula_predictor::{LeastSquares, LeastSquaresOptions, least_squares};
use ndarray::{Array2, ArrayView2, Axis};

/// A problem with one target: certified coefficients and their standard errors, the offset first.
pub(crate) struct Certified {
    design: Array2<f64>,
    target: Array2<f64>,
    coefficients: Vec<f64>,
    errors: Vec<f64>,
    residual_sd: f64,
}

/// Powers 1 .. `degree` of `x`.
pub(crate) fn polynomial(x: &[f64], degree: usize) -> Array2<f64> {
    Array2::from_shape_fn((x.len(), degree), |(i, j)| x[i].powi(i32::try_from(j).unwrap() + 1))
}

pub(crate) fn column(y: &[f64]) -> Array2<f64> {
    ArrayView2::from_shape((y.len(), 1), y).unwrap().to_owned()
}

fn digits(found: f64, wanted: f64) -> f64 {
    let error = if wanted == 0.0 { found.abs() } else { ((found - wanted) / wanted).abs() };
    -error.max(f64::EPSILON).log10()
}

fn fit(problem: &Certified) -> LeastSquares {
    least_squares(problem.design.view(), problem.target.view(), &LeastSquaresOptions::default()).unwrap()
}

/// Fewest digits of coefficients, of standard errors with the residual SD.
fn worst(problem: &Certified) -> (f64, f64) {
    let fit = fit(problem);
    let found: Vec<f64> = fit.intercept.iter().chain(fit.coefficients.index_axis(Axis(0), 0)).copied().collect();
    assert_eq!(found.len(), problem.coefficients.len());
    let least = |pairs: &mut dyn Iterator<Item = (f64, f64)>| pairs.fold(16.0, |d: f64, (a, b)| d.min(digits(a, b)));
    let coefficients = least(&mut found.into_iter().zip(problem.coefficients.iter().copied()));
    let spreads = fit.standard_errors.iter().copied().zip(problem.errors[1..].iter().copied());
    let sd = (fit.residual_sd[0].unwrap(), problem.residual_sd);
    (coefficients, least(&mut spreads.chain([sd])))
}

#[test]
fn coefficients_have_the_digits_asked_for() {
    // Name, problem, digits asked for of coefficients and of their standard errors.
    let all = [
        ("Longley", longley::longley(), 12.0, 12.0),
        ("Wampler1", wampler::wampler(1), 9.0, 9.0),
        ("Wampler2", wampler::wampler(2), 12.0, 9.0),
        ("Wampler3", wampler::wampler(3), 9.0, 12.0),
        ("Wampler4", wampler::wampler(4), 7.0, 12.0),
        ("Wampler5", wampler::wampler(5), 5.0, 12.0),
        ("Pontius", pontius::pontius(), 12.0, 12.0),
        ("Filip", filip::filip(), 7.0, 7.0),
    ];
    let mut ran = 0;
    for (name, problem, asked, asked_errors) in all {
        let (coefficients, errors) = worst(&problem);
        println!("{name}: {coefficients:.1} digits of coefficients, {errors:.1} of standard errors");
        assert!(coefficients >= asked, "{name}: {coefficients:.1} digits of coefficients, not {asked}");
        assert!(errors >= asked_errors, "{name}: {errors:.1} digits of standard errors, not {asked_errors}");
        ran += 1;
    }
    assert_eq!(ran, 8);
}
