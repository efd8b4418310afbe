//! The three-dimensional space of forces (Fig. 89) and its two densities (5.2.3).
//!
//! By Coulomb's law the shear is at most mu times the pressing N: the forces that can be are a cone, 0 <= N <= N_max,
//! F_r <= mu N. The thesis asks for training data of uniform density in cylindrical coordinates (dN dF_r dphi) or in
//! Cartesian ones (dF_x dF_y dF_z). Both are here as a map of the cone onto the unit cube under which the density
//! becomes uniform:
//!
//! - cylindrical: (N / N_max)^2, F_r / (mu N), phi / 2 pi; the time at a pressing grows with N, which is equation 20;
//! - Cartesian: (N / N_max)^3, (F_r / (mu N))^2, phi / 2 pi; the time at a pressing grows with N^2.
//!
//! phi is counted as in equation 23, from F_y towards F_x.

use std::f64::consts::TAU;

use serde::Serialize;
use thiserror::Error;

/// What is outside of the cone by less than this part of the largest pressing is rounding.
const ROUNDING: f64 = 1e-9;

/// The cone of the forces that can be.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ForceSpace {
    fz_max_n: f64,
    mu: f64,
}

/// Why there is no cone.
#[derive(Debug, Clone, PartialEq, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum ForceSpaceFault {
    #[error("a largest pressing of {0} N: it has to be positive and finite")]
    Pressing(f64),
    #[error("a coefficient of friction of {0}: it has to be positive and finite, and so the largest shear")]
    Friction(f64),
}

/// In which coordinates data are spread evenly.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Density {
    /// Unbiased in magnitude and direction of the shear; what the spiral aims at.
    Cylindrical,
    /// Unbiased in the components of the force.
    Cartesian,
}

impl Default for ForceSpace {
    fn default() -> Self {
        Self { fz_max_n: 3.0, mu: 0.75 }
    }
}

impl ForceSpace {
    /// The cone up to `fz_max_n` newtons with the coefficient of friction `mu`.
    pub fn new(fz_max_n: f64, mu: f64) -> Result<Self, ForceSpaceFault> {
        let holds = |value: f64| value.is_finite() && value > 0.0;
        if !holds(fz_max_n) {
            return Err(ForceSpaceFault::Pressing(fz_max_n));
        }
        // The largest shear is a number as well.
        if holds(mu) && holds(mu * fz_max_n) { Ok(Self { fz_max_n, mu }) } else { Err(ForceSpaceFault::Friction(mu)) }
    }

    /// The largest pressing, newtons.
    #[must_use]
    pub fn fz_max_n(&self) -> f64 {
        self.fz_max_n
    }

    /// The coefficient of friction.
    #[must_use]
    pub fn mu(&self) -> f64 {
        self.mu
    }

    /// Where a force lies in the unit cube; `None` outside of the cone and for numbers that are not finite.
    #[must_use]
    pub fn place(&self, density: Density, [fx_n, fy_n, fz_n]: [f64; 3]) -> Option<[f64; 3]> {
        let (pressing_n, shear_n) = (-fz_n, fx_n.hypot(fy_n));
        let slack_n = ROUNDING * self.fz_max_n;
        let most_n = self.mu * pressing_n;
        if !((-slack_n..=self.fz_max_n + slack_n).contains(&pressing_n) && shear_n <= most_n + slack_n) {
            return None;
        }
        let up = (pressing_n / self.fz_max_n).clamp(0.0, 1.0);
        let out = if most_n > 0.0 { (shear_n / most_n).min(1.0) } else { 0.0 };
        let turn = (fx_n.atan2(fy_n) / TAU).rem_euclid(1.0);
        Some(match density {
            Density::Cylindrical => [up * up, out, turn],
            Density::Cartesian => [up * up * up, out * out, turn],
        })
    }

    /// The force `[Fx, Fy, Fz]`, newtons, at a place of the unit cube: the inverse of [`place`](Self::place).
    #[must_use]
    pub fn force(&self, density: Density, [up, out, turn]: [f64; 3]) -> [f64; 3] {
        let (up, out) = match density {
            Density::Cylindrical => (up.sqrt(), out),
            Density::Cartesian => (up.cbrt(), out.sqrt()),
        };
        let pressing_n = self.fz_max_n * up;
        let shear_n = self.mu * pressing_n * out;
        let (sin, cos) = (TAU * turn).sin_cos();
        [shear_n * sin, shear_n * cos, -pressing_n]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_and_forces_are_each_others_inverse() {
        // Measured 1.1e-16.
        const NEAR: f64 = 1e-14;
        let space = ForceSpace::new(2.0, 0.5).unwrap();
        for density in [Density::Cylindrical, Density::Cartesian] {
            for place in [[0.1, 0.2, 0.3], [0.9, 0.99, 0.75], [1.0, 0.5, 0.01]] {
                let again = space.place(density, space.force(density, place)).unwrap();
                assert!((0..3).all(|k| (again[k] - place[k]).abs() <= NEAR), "{place:?} {again:?}");
            }
        }
        assert_eq!(space.place(Density::Cartesian, [0.0, 0.5, -1.0]), Some([0.125, 1.0, 0.0]));
        assert_eq!(space.place(Density::Cylindrical, [0.25, 0.0, -1.0]), Some([0.25, 0.5, 0.25]));
        assert_eq!(space.place(Density::Cylindrical, [0.0; 3]), Some([0.0; 3]));
    }

    #[test]
    fn what_is_outside_of_the_cone_has_no_place() {
        let space = ForceSpace::default();
        for force in [[0.0, 0.0, 0.1], [0.0, 0.0, -3.1], [0.8, 0.0, -1.0], [f64::NAN, 0.0, -1.0], [0.0, 0.0, f64::NAN]]
        {
            assert_eq!(space.place(Density::Cartesian, force), None, "{force:?}");
        }
        assert_eq!(ForceSpace::new(0.0, 0.75), Err(ForceSpaceFault::Pressing(0.0)));
        assert_eq!(ForceSpace::new(3.0, f64::INFINITY), Err(ForceSpaceFault::Friction(f64::INFINITY)));
        assert_eq!(ForceSpace::new(1e300, 1e10), Err(ForceSpaceFault::Friction(1e10)));
        assert!(ForceSpace::new(f64::NAN, 0.75).unwrap_err().to_string().contains("NaN N"));
    }

    #[test]
    fn equal_cells_are_equal_volumes() {
        // A lattice of 530 000 forces, counted in two halves of each coordinate; the layer at the middle pressing holds
        // 2.4 % of them. Measured 0.012.
        const NEAR: f64 = 0.02;
        let space = ForceSpace::new(1.0, 1.0).unwrap();
        let axis = |k: i32| (f64::from(k) + 0.5) / 80.0;
        let (mut count, mut lower) = (0.0, [0.0f64; 3]);
        for x in -80..80 {
            for y in -80..80 {
                for z in 0..80 {
                    if let Some(place) = space.place(Density::Cartesian, [axis(x), axis(y), -axis(z)]) {
                        count += 1.0;
                        (0..3).for_each(|k| lower[k] += f64::from(u8::from(place[k] < 0.5)));
                    }
                }
            }
        }
        assert!(lower.iter().all(|half| (half / count - 0.5).abs() <= NEAR), "{lower:?} of {count}");
    }
}
