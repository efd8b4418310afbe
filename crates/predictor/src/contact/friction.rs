//! Forces that a finger can have: the nearest point of the friction cone.
//!
//! In: a predicted force, newtons, and the coefficient of friction mu. Out: the nearest force (in newtons, all three
//! axes alike) with
//! |(Fx, Fy)| <= mu N and N = -Fz >= 0 (5.2.2: mu is about 0.75 on the thesis' platform). Closed form: a force within
//! the cone stays, one within the polar cone (mu |(Fx, Fy)| <= -N) becomes 0, any other goes straight to the cone's
//! surface.
//!
//! A force that was measured within the cone is never farther from the result than from the prediction. Whether mu is
//! right for the surface is not known here: evaluate with and without.

use serde::Serialize;
use thiserror::Error;

/// Digits that rounding may take: a force beyond the surface by no more counts as on it, so that projecting twice
/// changes nothing.
const SLACK: f64 = 8.0 * f64::EPSILON;

/// The friction cone.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FrictionCone {
    mu: f64,
}

/// Why there is no cone.
#[derive(Debug, Clone, PartialEq, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum FrictionFault {
    #[error("a coefficient of friction of {0}; it must be a finite number, 0 or above")]
    Mu(f64),
}

impl FrictionCone {
    /// The cone of a coefficient of friction.
    ///
    /// # Errors
    /// [`FrictionFault::Mu`].
    pub fn new(mu: f64) -> Result<Self, FrictionFault> {
        if mu.is_finite() && mu >= 0.0 { Ok(Self { mu }) } else { Err(FrictionFault::Mu(mu)) }
    }

    /// The nearest force of the cone to `[Fx, Fy, Fz]`, newtons. One that is not finite stays as it is.
    #[must_use]
    pub fn nearest(&self, force_n: [f64; 3]) -> [f64; 3] {
        let [fx, fy, fz] = force_n;
        if !force_n.iter().all(|value| value.is_finite()) {
            return force_n;
        }
        let (shear, normal) = (fx.hypot(fy), -fz);
        if shear <= self.mu * normal * (1.0 + SLACK) && normal >= 0.0 {
            return force_n;
        }
        // The surface's direction in the plane of shear and normal; how far along it the force reaches. In halves,
        // which can't overflow.
        let slant = self.mu.hypot(1.0);
        let (along_shear, along_normal) = (self.mu / slant, 1.0 / slant);
        let half = 0.5 * normal * along_normal + 0.5 * shear * along_shear;
        if half <= 0.0 {
            return [0.0; 3];
        }
        // Shear is above 0 here unless mu is 0, where the surface is the normal itself.
        let shrink = if along_shear == 0.0 { 0.0 } else { 2.0 * (half / shear * along_shear) };
        [fx * shrink, fy * shrink, -(2.0 * (half * along_normal))]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn far(a: [f64; 3], b: [f64; 3]) -> f64 {
        (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
    }

    /// A force of the cone: normal force, share of the shear that friction holds, direction.
    fn within(mu: f64, normal: f64, share: f64, turn: f64) -> [f64; 3] {
        let shear = mu * normal * share;
        [shear * turn.cos(), shear * turn.sin(), -normal]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        #[test]
        fn twice_is_once_and_no_force_of_the_cone_gets_farther(
            fx in -3.0..3.0_f64, fy in -3.0..3.0_f64, fz in -3.0..3.0_f64, mu in 0.0..3.0_f64,
            normal in 0.0..4.0_f64, share in 0.0..=1.0_f64, turn in 0.0..7.0_f64,
        ) {
            let (cone, force) = (FrictionCone::new(mu).unwrap(), [fx, fy, fz]);
            let near = cone.nearest(force);
            prop_assert_eq!(cone.nearest(near), near);
            prop_assert!(near[0].hypot(near[1]) <= -mu * near[2] * (1.0 + SLACK) && near[2] <= 0.0);
            let other = within(mu, normal, share, turn);
            // Measured excess of rounding 4e-16.
            prop_assert!(far(near, other) <= far(force, other) + 1e-14);
            prop_assert!(far(force, near) <= far(force, other) + 1e-14, "another force of the cone is nearer");
        }
    }

    #[test]
    fn nearest_by_brute_force() {
        let cone = FrictionCone::new(0.75).unwrap();
        for force in [[1.0, 2.0, -1.0], [1.0, 0.0, 0.5], [-0.3, 0.1, 2.0], [0.45, 0.0, -1.0], [2.0, 1.0, 0.0]] {
            let near = cone.nearest(force);
            let turn = force[1].atan2(force[0]);
            let grid = (0..=4000).flat_map(|n| (0..=20).map(move |s| (f64::from(n) * 1e-3, f64::from(s) / 20.0)));
            let best = grid.map(|(n, s)| far(force, within(0.75, n, s, turn))).fold(f64::INFINITY, f64::min);
            // The grid's step is 1e-3 N of normal force: measured gap 7e-7.
            assert!((best - far(force, near)).abs() <= 1e-5, "{force:?}: {best} and {}", far(force, near));
        }
    }

    #[test]
    fn corners_of_the_cone() {
        let cone = |mu| FrictionCone::new(mu).unwrap();
        assert_eq!(cone(0.0).nearest([1.0, 2.0, -3.0]), [0.0, 0.0, -3.0]);
        assert_eq!(cone(0.0).nearest([1.0, 2.0, 3.0]), [0.0; 3]);
        assert_eq!(cone(0.75).nearest([0.0, 0.0, 1.0]), [0.0; 3]);
        assert_eq!(cone(0.75).nearest([0.0; 3]), [0.0; 3]);
        assert_eq!(
            cone(1.0).nearest([2.0, 0.0, 0.0]),
            [1.0, 0.0, -1.0].map(|v: f64| v * (1.0 / 2f64.sqrt()) * (2.0 * (1.0 / 2f64.sqrt())))
        );
        for (mu, size) in [(1e300, 1.0), (1.0, 1e300), (1.0, 1e-300), (1e-300, 1.0), (0.5, f64::MAX)] {
            let near = cone(mu).nearest([size, 0.0, 0.0]);
            assert!(near.iter().all(|value| value.is_finite()) && near[2] <= 0.0 && near[0] <= size, "{mu} {near:?}");
        }
        for mu in [-0.1, f64::NAN, f64::INFINITY] {
            assert!(FrictionCone::new(mu).is_err());
        }
    }
}
