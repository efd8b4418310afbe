//! Wampler 1 to 5: polynomials of degree 5 over 0 .. 20, exact (1, 2) or with residuals, the same times 1, 100 and 10
//! 000 (3, 4, 5), which are at right angles to all powers.

use super::{Certified, column, polynomial};

/// Published to five decimals for Wampler2, exact whole numbers for the others.
const RESIDUALS: [f64; 21] = [
    759.0, -2048.0, 2048.0, -2048.0, 2523.0, -2048.0, 2048.0, -2048.0, 1838.0, -2048.0, 2048.0, -2048.0, 1838.0,
    -2048.0, 2048.0, -2048.0, 2523.0, -2048.0, 2048.0, -2048.0, 759.0,
];

const ERRORS: [f64; 6] =
    [2152.32624678170, 2363.55173469681, 779.343524331583, 101.475507550350, 5.64566512170752, 0.112324854679312];

const RESIDUAL_SD: f64 = 2360.14502379268;

pub(crate) fn wampler(number: u32) -> Certified {
    let x: Vec<f64> = (0..21).map(f64::from).collect();
    let design = polynomial(&x, 5);
    // 1 + x + .. + x^5, but for Wampler2 1 + x / 10 + .. + (x / 10)^5, rounded once from whole numbers.
    let second = number == 2;
    let y = x.iter().zip(RESIDUALS).map(|(&x, residual)| {
        let whole: f64 = (0..6).map(|k| x.powi(k) * if second { 10f64.powi(5 - k) } else { 1.0 }).sum();
        match number {
            1 => whole,
            2 => whole / 1e5,
            _ => whole + residual * factor(number),
        }
    });
    let y: Vec<f64> = y.collect();
    Certified {
        design,
        target: column(&y),
        coefficients: if second { vec![1.0, 0.1, 0.01, 0.001, 0.0001, 0.00001] } else { vec![1.0; 6] },
        errors: ERRORS.iter().map(|error| error * factor(number)).collect(),
        residual_sd: RESIDUAL_SD * factor(number),
    }
}

fn factor(number: u32) -> f64 {
    match number {
        1 | 2 => 0.0,
        _ => 100f64.powi(number as i32 - 3),
    }
}
