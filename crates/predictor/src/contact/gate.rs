//! The cases of equations 9 and 16: does the finger touch, so that the posture model has nothing to say?
//!
//! In: the predicted normal force of each row, `Fz_N`, newtons; pressing is negative. Out: whether the finger touches
//! or bends, and which angle goes with it: that of the posture model while N < F_min, theta_touch from N >= F_min on,
//! with N = -Fz.
//!
//! Departures from the thesis. Equation 9 as printed compares Fz itself with F_min; as pressing is negative, it would
//! call every touch bending. |Fz| would be wrong too: a linear model predicts impossible pulling while the finger
//! bends. Optional hysteresis: a touch that has begun at F_min ends below F_min - hysteresis. A row whose Fz is not
//! finite is neither: it has no force and no angle, and does not begin or end a touch.

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Where touch begins and ends.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Gate {
    f_min_n: f64,
    theta_touch_deg: f64,
    hysteresis_n: f64,
}

/// What the rows before leave behind: whether the finger touches. At first it does not.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct GateState {
    touching: bool,
}

/// What a row is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Contact {
    /// The finger presses; its angle is theta_touch.
    Touch,
    /// It does not; the posture model speaks.
    Bending,
    /// The force is not known: neither force nor angle.
    Invalid,
}

/// Why numbers make no gate.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum GateFault {
    #[error("a threshold F_min of {0} N; it must be above 0, as a finger that does not touch has a normal force of 0")]
    Threshold(f64),
    #[error("theta_touch is {0} degrees; it must be a finite angle")]
    Angle(f64),
    #[error(
        "a hysteresis of {hysteresis_n} N; it must be from 0 to below the threshold of {f_min_n} N, or touch would \
         not end"
    )]
    Hysteresis { hysteresis_n: f64, f_min_n: f64 },
}

impl Gate {
    /// `f_min_n`: the normal force from which on the finger touches, newtons, above 0; `theta_touch_deg`: its angle
    /// then, degrees (the thesis' is 0, 5.2.2); `hysteresis_n`: by how much the force must fall below F_min to end a
    /// touch, newtons.
    pub fn new(f_min_n: f64, theta_touch_deg: f64, hysteresis_n: f64) -> Result<Self, GateFault> {
        if !(f_min_n.is_finite() && f_min_n > 0.0) {
            return Err(GateFault::Threshold(f_min_n));
        }
        if !theta_touch_deg.is_finite() {
            return Err(GateFault::Angle(theta_touch_deg));
        }
        if !(0.0..f_min_n).contains(&hysteresis_n) {
            return Err(GateFault::Hysteresis { hysteresis_n, f_min_n });
        }
        Ok(Self { f_min_n, theta_touch_deg, hysteresis_n })
    }

    /// The angle while it touches, degrees.
    #[must_use]
    pub fn theta_touch_deg(&self) -> f64 {
        self.theta_touch_deg
    }

    /// One row, in the order of time: `fz_n` is the predicted force, newtons.
    pub fn step(&self, state: &mut GateState, fz_n: f64) -> Contact {
        if !fz_n.is_finite() {
            return Contact::Invalid;
        }
        let from = if state.touching { self.f_min_n - self.hysteresis_n } else { self.f_min_n };
        state.touching = -fz_n >= from;
        if state.touching { Contact::Touch } else { Contact::Bending }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn contacts(gate: &Gate, fz_n: &[f64]) -> Vec<Contact> {
        let mut state = GateState::default();
        fz_n.iter().map(|&fz| gate.step(&mut state, fz)).collect()
    }

    #[test]
    fn pressing_touches_and_pulling_bends() {
        use Contact::{Bending, Touch};
        let gate = Gate::new(0.2, 5.0, 0.0).unwrap();
        assert_eq!(
            contacts(&gate, &[-0.1, -0.2, -3.0, -0.19, 0.0, 0.5, 3.0]),
            [Bending, Touch, Touch, Bending, Bending, Bending, Bending]
        );
    }

    #[test]
    fn a_touch_ends_below_the_hysteresis() {
        use Contact::{Bending, Invalid, Touch};
        let gate = Gate::new(0.5, 0.0, 0.2).unwrap();
        let fz = [-0.4, -0.5, -0.4, f64::NAN, -0.31, f64::NEG_INFINITY, -0.29, f64::INFINITY, -0.4, -0.5];
        assert_eq!(
            contacts(&gate, &fz),
            [Bending, Touch, Touch, Invalid, Touch, Invalid, Bending, Invalid, Bending, Touch]
        );
    }

    #[test]
    fn what_is_no_gate() {
        for f_min in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(Gate::new(f_min, 0.0, 0.0), Err(GateFault::Threshold(_))));
        }
        assert!(matches!(Gate::new(1.0, f64::NAN, 0.0), Err(GateFault::Angle(_))));
        for hysteresis in [-0.1, 1.0, 2.0, f64::NAN] {
            assert!(matches!(Gate::new(1.0, 0.0, hysteresis), Err(GateFault::Hysteresis { .. })));
        }
    }

    proptest! {
        // Without hysteresis each row stands for itself: equation 9's cases.
        #[test]
        fn without_hysteresis_there_is_no_memory(
            fz in proptest::collection::vec(-2.0..2.0_f64, 0..40),
            f_min in 0.01..1.0_f64,
        ) {
            let gate = Gate::new(f_min, 0.0, 0.0).unwrap();
            for (contact, fz) in contacts(&gate, &fz).into_iter().zip(fz) {
                prop_assert_eq!(contact == Contact::Bending, -fz < f_min);
            }
        }
    }
}
