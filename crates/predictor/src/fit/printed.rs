//! The models as the thesis prints them, in P itself: worked out in numbers of twice the length from the model's
//! coefficients and rounded once. Only for print: using them cancels digits that the centred models keep.

use ndarray::Array2;

use crate::algebra::exact::Long;
use crate::{Linear, Quadratic, quadratic_terms};

/// Equation 9's F_0 = y_m - J m, a target each, in its unit.
#[must_use]
pub fn linear_f0(model: &Linear) -> Vec<f64> {
    model
        .offset()
        .iter()
        .zip(model.jacobian().outer_iter())
        .map(|(&offset, slopes)| {
            let products = slopes.iter().zip(model.centre()).map(|(&j, &m)| Long::from(-j).times(m.into()));
            products.fold(Long::from(offset), Long::plus).rounded()
        })
        .collect()
}

/// Equation 16's coefficients of P_Q with F_0.
#[derive(Debug, Clone, PartialEq)]
pub struct Printed {
    /// targets x terms, a target's unit a volt or a square volt. Infinite where that is beyond a number.
    pub coefficients: Array2<f64>,
    /// A target each, in its unit.
    pub f0: Vec<f64>,
}

/// Equation 16 in P itself.
#[must_use]
pub fn quadratic_printed(model: &Quadratic) -> Printed {
    let (m, s) = (model.centre(), model.scale());
    let inputs = m.len();
    let pairs = quadratic_terms(inputs);
    let mut coefficients = Array2::zeros(model.jacobian().dim());
    let mut f0 = Vec::new();
    for (k, row) in model.jacobian().outer_iter().enumerate() {
        let mut constant = Long::from(model.offset()[k]);
        let mut slopes: Vec<Long> = (0..inputs).map(|i| Long::from(row[i]).over(s[i])).collect();
        for (slope, &m) in slopes.iter().zip(m) {
            constant = constant.plus(slope.times((-m).into()));
        }
        for (term, &(i, j)) in pairs.iter().enumerate() {
            let square = Long::from(row[inputs + term]).over(s[i]).over(s[j]);
            slopes[i] = slopes[i].plus(square.times((-m[j]).into()));
            slopes[j] = slopes[j].plus(square.times((-m[i]).into()));
            constant = constant.plus(square.times(m[i].into()).times(m[j].into()));
            coefficients[[k, inputs + term]] = square.rounded();
        }
        for (i, slope) in slopes.iter().enumerate() {
            coefficients[[k, i]] = slope.rounded();
        }
        f0.push(constant.rounded());
    }
    Printed { coefficients, f0 }
}
