//! Offset and scaling of a photodiode: the best ones for given signals, and what is left when they follow.
//!
//! For signals `f` the voltages `V_0 + V_1 f` are linear in offset and scaling, so those are solved for at every point
//! of a fit, and only the other parameters are searched (variable projection, Golub and Pereyra 1973,
//! doi:10.1137/0710036, with Kaufman's derivative).

use crate::fit::algebra::qr::{dot, norm};

/// Of the signal's norm, changes that are rounding: nothing can be said about the scaling.
const FLAT: f64 = 1e-9;

/// Offset and scaling that fit best.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::fit) struct Fitted {
    pub(in crate::fit) offset_v: f64,
    pub(in crate::fit) scaling_v: f64,
    /// Whether the signal changes, so that the scaling is determined.
    pub(in crate::fit) varied: bool,
    /// The triangle of the two columns: `|w|`, `q_1 . w f`, and the norm of the rest of `w f`.
    pub(in crate::fit) triangle: [f64; 3],
    /// Offset and scaling by each coordinate, as they follow.
    pub(in crate::fit) following: Vec<[f64; 2]>,
}

/// Fits `offset weights + scaling signals` to `target`, of which the residuals are left; `signals`, `columns` (the
/// derivatives of the signal) and `target` are weighted as `weights` are, and whitened if these are. Columns are left
/// as the derivatives of the fit with offset and scaling following. Where the signal does not change, the scaling stays
/// `held_v`.
pub(in crate::fit) fn calibrate(
    weights: &[f64],
    signals: &[f64],
    target: &mut [f64],
    columns: &mut [&mut [f64]],
    held_v: f64,
) -> Fitted {
    let size = norm(weights);
    let first: Vec<f64> = weights.iter().map(|w| w / size).collect();
    let mut second = signals.to_vec();
    let whole = norm(&second);
    let mut along = 0.0;
    // Twice: what is left of a nearly constant signal keeps its digits.
    for _ in 0..2 {
        along += remove(&first, &mut second);
    }
    let rest = norm(&second);
    let varied = rest > FLAT * whole;
    if varied {
        second.iter_mut().for_each(|value| *value /= rest);
    } else {
        target.iter_mut().zip(signals).for_each(|(value, f)| *value -= held_v * f);
    }
    let solve = |parts: [f64; 2]| {
        let scaling = if varied { parts[1] / rest } else { 0.0 };
        [(parts[0] - along * scaling) / size, scaling]
    };
    let parts = |values: &mut [f64]| {
        let mut parts = [remove(&first, values), 0.0];
        if varied {
            parts[1] = remove(&second, values);
            parts[1] += remove(&second, values);
        }
        parts[0] += remove(&first, values);
        parts
    };
    let [offset_v, scaling_v] = solve(parts(target));
    let scaling_v = if varied { scaling_v } else { held_v };
    let following = columns
        .iter_mut()
        .map(|column| {
            column.iter_mut().for_each(|value| *value *= scaling_v);
            solve(parts(column)).map(|change| -change)
        })
        .collect();
    Fitted { offset_v, scaling_v, varied, triangle: [size, along, rest], following }
}

/// Takes the part along a unit vector out, and returns its length.
fn remove(unit: &[f64], values: &mut [f64]) -> f64 {
    let along = dot(unit, values);
    for (value, u) in values.iter_mut().zip(unit) {
        *value -= along * u;
    }
    along
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn offset_and_scaling_are_those_of_the_voltages() {
        let signals: Vec<f64> = (0..50).map(|i| 0.87 + 1e-3 * (i as f64).sin()).collect();
        let weights: Vec<f64> = (0..50).map(|i| if i < 20 { 1.0 } else { 0.1 }).collect();
        let mut target: Vec<f64> = signals.iter().zip(&weights).map(|(f, w)| w * (0.4 - 2.5 * f)).collect();
        let mut column: Vec<f64> = weights.iter().zip(&signals).map(|(w, f)| w * (3.0 + 7.0 * f)).collect();
        let weighted: Vec<f64> = signals.iter().zip(&weights).map(|(f, w)| w * f).collect();
        let fitted = calibrate(&weights, &weighted, &mut target, &mut [&mut column], 1.0);
        // Measured 1.1e-13: a thousand times the rounding, as the signal changes by a thousandth of itself; 8e-16 and
        // 9e-15; 6e-13.
        assert!((fitted.offset_v - 0.4).abs() + (fitted.scaling_v + 2.5).abs() <= 1e-11, "{fitted:?}");
        assert!(norm(&target) <= 1e-14 && norm(&column) <= 1e-13);
        // The signal moves by 3 + 7 f: offset and scaling follow by -V_1 (3, 7).
        let [offset, scaling] = fitted.following[0];
        assert!((offset - 7.5).abs() + (scaling - 17.5).abs() <= 1e-10, "{fitted:?}");
    }

    #[test]
    fn a_signal_that_does_not_change_leaves_the_scaling() {
        let (weights, signals) = (vec![1.0; 9], vec![0.8; 9]);
        let mut target: Vec<f64> = (0..9).map(|i| 2.0 + 0.1 * (i as f64 - 4.0)).collect();
        let fitted = calibrate(&weights, &signals, &mut target, &mut [], 1.5);
        assert!(!fitted.varied);
        assert_eq!(fitted.scaling_v, 1.5);
        assert!((fitted.offset_v - (2.0 - 1.2)).abs() <= 1e-14);
        assert!((target[0] + 0.4).abs() <= 1e-14);
    }
}
