//! Exact numbers with a derivative: `value + slope e`, `e^2 = 0`, both rational.

use std::ops::{Add, Div, Mul, Neg, Sub};

use num_rational::BigRational;
use num_traits::{Signed, ToPrimitive, Zero};

/// A double as the rational that it is.
pub(crate) fn exact(x: f64) -> BigRational {
    BigRational::from_float(x).expect("a finite number")
}

/// The gap between a computed number and the wanted one, over `scale`.
pub(crate) fn gap(found: f64, wanted: &BigRational, scale: &BigRational) -> f64 {
    ((exact(found) - wanted) / scale).abs().to_f64().expect("a ratio of rationals")
}

#[derive(Clone, Debug)]
pub(crate) struct Dual {
    pub(crate) value: BigRational,
    pub(crate) slope: BigRational,
}

impl Dual {
    pub(crate) fn constant(value: BigRational) -> Dual {
        Dual { value, slope: BigRational::zero() }
    }

    pub(crate) fn of(x: f64) -> Dual {
        Dual::constant(exact(x))
    }
}

impl Add for &Dual {
    type Output = Dual;

    fn add(self, other: &Dual) -> Dual {
        Dual { value: &self.value + &other.value, slope: &self.slope + &other.slope }
    }
}

impl Sub for &Dual {
    type Output = Dual;

    fn sub(self, other: &Dual) -> Dual {
        Dual { value: &self.value - &other.value, slope: &self.slope - &other.slope }
    }
}

impl Mul for &Dual {
    type Output = Dual;

    fn mul(self, other: &Dual) -> Dual {
        let slope = &self.slope * &other.value + &self.value * &other.slope;
        Dual { value: &self.value * &other.value, slope }
    }
}

impl Div for &Dual {
    type Output = Dual;

    fn div(self, other: &Dual) -> Dual {
        let value = &self.value / &other.value;
        Dual { slope: (&self.slope - &value * &other.slope) / &other.value, value }
    }
}

impl Neg for &Dual {
    type Output = Dual;

    fn neg(self) -> Dual {
        Dual { value: -&self.value, slope: -&self.slope }
    }
}
