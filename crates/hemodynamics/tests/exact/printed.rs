//! The matrices that the thesis prints (equation 2), in exact arithmetic.

use lunula_hemodynamics::Parameters;
use num_rational::BigRational;
use num_traits::One;

use crate::network::resistance;
use crate::number::{Dual, exact};

/// `R_ij` with the walls' damping, and `B_4..B_6` by `P_H` and `P_L`.
pub(crate) struct Printed {
    pub(crate) r: [[BigRational; 3]; 3],
    pub(crate) b: [[BigRational; 2]; 3],
}

/// At lumens over nominal diameters of C1, C2, V.
pub(crate) fn printed(parameters: &Parameters, lumens: &[f64]) -> Printed {
    let walls: Vec<_> = parameters.walls().collect();
    let value = |f: fn(&lunula_hemodynamics::Vessel) -> f64| [0, 1, 2].map(|j| exact(f(walls[j])));
    let (a, m, d) = (value(|w| w.area_m2), value(|w| w.mass_kg), value(|w| w.damping_n_s_per_m));
    let of = |j: usize| {
        let lumen = &Dual::of(walls[j].diameter_m) * &Dual::of(lumens[j]);
        resistance(walls[j], parameters.viscosity_pa_s(), &lumen).value
    };
    let [ra1, ra2, rv] = [0, 1, 2].map(of);
    let [rv1, rv2] = [0, 1].map(|i| exact(parameters.units()[i].venule_pa_s_per_m3));
    let one = BigRational::one();
    let (first, second) = (&ra1 + &rv1, &ra2 + &rv2);
    let total = &first + &second + &first * &second / &rv;

    let r11 = &d[0] + &a[0] * &a[0] * &ra1 * (&one - &ra1 * (&ra2 + &rv2 + &rv) / (&rv * &total));
    let r22 = &d[1] + &a[1] * &a[1] * &ra2 * (&one - &ra2 * (&ra1 + &rv1 + &rv) / (&rv * &total));
    let r33 = &d[2] + &a[2] * &a[2] * &first * &second / &total;
    let r12 = &a[0] * &a[1] * &ra1 * &ra2 / &total;
    let r13 = &a[0] * &a[2] * &ra1 * &second / &total;
    let r23 = &a[1] * &a[2] * &ra2 * &first / &total;
    let b = [
        [&a[0] / &m[0] * (&one - &ra1 * &second / (&rv * &total)), &a[0] * &ra1 * &second / (&m[0] * &rv * &total)],
        [&a[1] / &m[1] * (&one - &ra2 * &first / (&rv * &total)), &a[1] * &ra2 * &first / (&m[1] * &rv * &total)],
        [&a[2] * (&first + &second) / (&m[2] * &total), &a[2] * &first * &second / (&m[2] * &rv * &total)],
    ];
    Printed { r: [[r11, r12.clone(), r13.clone()], [r12, r22, r23.clone()], [r13, r23, r33]], b }
}
