//! Least squares in rational numbers, through the normal equations without fractions (Bareiss,
//! doi:10.1090/S0025-5718-1968-0226829-0).

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{Signed, ToPrimitive, Zero};

pub(crate) fn exact(x: f64) -> BigRational {
    BigRational::from_float(x).unwrap()
}

/// Coefficients of the columns, then the offset; `rows` without ones.
pub(crate) fn least_squares(rows: &[Vec<BigRational>], target: &[f64]) -> Vec<BigRational> {
    let rows: Vec<Vec<BigRational>> =
        rows.iter().zip(target).map(|(row, &y)| row.iter().cloned().chain([exact(1.0), exact(y)]).collect()).collect();
    // Whole numbers: every value is one over a power of two, and scaling a column scales its coefficient.
    let width = rows[0].len();
    let units: Vec<BigInt> = (0..width).map(|j| rows.iter().map(|row| row[j].denom().clone()).max().unwrap()).collect();
    let rows: Vec<Vec<BigInt>> = rows
        .iter()
        .map(|row| row.iter().zip(&units).map(|(value, unit)| (value * unit).to_integer()).collect())
        .collect();
    let unknowns = width - 1;
    let mut a: Vec<Vec<BigInt>> =
        (0..unknowns).map(|i| (0..width).map(|j| rows.iter().map(|row| &row[i] * &row[j]).sum()).collect()).collect();
    let mut previous = BigInt::from(1);
    for k in 0..unknowns {
        let (head, tail) = a.split_at_mut(k + 1);
        let row = &head[k];
        assert!(!row[k].is_zero(), "columns are independent");
        for below in tail {
            for j in (k + 1..width).rev() {
                below[j] = (&below[j] * &row[k] - &below[k] * &row[j]) / &previous;
            }
        }
        previous = row[k].clone();
    }
    let mut x = vec![BigRational::zero(); unknowns];
    for k in (0..unknowns).rev() {
        let mut sum = BigRational::from(a[k][unknowns].clone());
        for j in k + 1..unknowns {
            sum -= &x[j] * BigRational::from(a[k][j].clone());
        }
        x[k] = sum / BigRational::from(a[k][k].clone());
    }
    x.iter().zip(&units).map(|(x, unit)| x * BigRational::new(unit.clone(), units[unknowns].clone())).collect()
}

/// Decimal digits that agree, at most 16.
pub(crate) fn digits(found: f64, wanted: &BigRational) -> f64 {
    let error = ((exact(found) - wanted) / wanted).abs().to_f64().unwrap();
    -error.max(1e-16).log10()
}

/// Fewest over all.
pub(crate) fn fewest<'a>(found: impl IntoIterator<Item = &'a f64>, wanted: &[BigRational]) -> f64 {
    let found: Vec<&f64> = found.into_iter().collect();
    assert_eq!(found.len(), wanted.len());
    found.into_iter().zip(wanted).map(|(&found, wanted)| digits(found, wanted)).fold(16.0, f64::min)
}
