//! How fast a trajectory may be and how fast it is (5.2.2b, equations 19 and 24).
//!
//! The photodiodes lag behind by the fingertip's slowest time constant tau: at a rate F' they read as if the force were
//! F - F' tau. Equation 19 takes that as a share of the force: F' tau / F = f tau, f the relative rate of change. The
//! share of no force is infinite, and every trajectory begins at none: so f is judged where the force is at least a
//! floor, and the time from which the limit is kept is reported.

use std::f64::consts::TAU;

use serde::Serialize;

/// Equation 19: the apparent error of force as a share of it, F' tau / F.
#[must_use]
pub fn percent_error(rate_n_per_s: f64, force_n: f64, tau_s: f64) -> f64 {
    rate_n_per_s * tau_s / force_n
}

/// Equation 19 solved for f: the largest relative rate, per second, whose error is `share` of the force. 1 for 10 % and
/// 0.1 s.
#[must_use]
pub fn rate_limit_per_s(share: f64, tau_s: f64) -> f64 {
    share / tau_s
}

/// Equation 24: circling faster than this, hertz, is more than the relative rate f allows.
#[must_use]
pub fn circling_limit_hz(rate_limit_per_s: f64) -> f64 {
    rate_limit_per_s / TAU
}

/// How fast forces change.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RateLimits {
    /// The largest |dFx/dt|, |dFy/dt|, |dFz/dt|, newtons a second.
    pub components_n_per_s: [f64; 3],
    /// The largest |dF/dt| of the vector, newtons a second.
    pub vector_n_per_s: f64,
    /// When it is that fast, seconds.
    pub vector_at_s: f64,
    /// f of equation 19: the largest |dF/dt| / |F| where |F| is at least the floor, per second; `None` where it never
    /// is.
    pub relative_per_s: Option<f64>,
    /// When that is, seconds.
    pub relative_at_s: Option<f64>,
    /// The share of the time with a force of at least the floor in which f is over the limit.
    pub over_share: Option<f64>,
    /// From then on f keeps the limit whatever the force, seconds; `None` where it does not at the end.
    pub kept_from_s: Option<f64>,
}

/// How fast the forces of `rows` (time in seconds, `[Fx, Fy, Fz]` in newtons) change between neighbours, judged by the
/// relative rate `limit_per_s` where the force is at least `floor_n`. Rows that are not finite and times that do not
/// ascend are gaps. `None` where no two rows follow each other.
pub fn rate_limits(
    rows: impl IntoIterator<Item = (f64, [f64; 3])>,
    floor_n: f64,
    limit_per_s: f64,
) -> Option<RateLimits> {
    let mut found: Option<RateLimits> = None;
    let mut before: Option<(f64, [f64; 3])> = None;
    let (mut judged_s, mut over_s) = (0.0, 0.0);
    for (time_s, force) in rows {
        if !(time_s.is_finite() && force.iter().all(|force| force.is_finite())) {
            before = None;
            continue;
        }
        let Some((from_s, from)) = before.replace((time_s, force)).filter(|(from_s, _)| *from_s < time_s) else {
            continue;
        };
        let step_s = time_s - from_s;
        let rates: [f64; 3] = std::array::from_fn(|k| (force[k] - from[k]) / step_s);
        let middle: [f64; 3] = std::array::from_fn(|k| 0.5 * (force[k] + from[k]));
        let (rate, size) = (length(rates), length(middle));
        let all = found.get_or_insert(RateLimits {
            components_n_per_s: [0.0; 3],
            vector_n_per_s: 0.0,
            vector_at_s: from_s,
            relative_per_s: None,
            relative_at_s: None,
            over_share: None,
            kept_from_s: Some(from_s),
        });
        for (largest, rate) in all.components_n_per_s.iter_mut().zip(rates) {
            *largest = largest.max(rate.abs());
        }
        let at_s = from_s + 0.5 * step_s;
        if rate > all.vector_n_per_s {
            (all.vector_n_per_s, all.vector_at_s) = (rate, at_s);
        }
        let over = rate > limit_per_s * size;
        if over {
            all.kept_from_s = None;
        } else if all.kept_from_s.is_none() {
            all.kept_from_s = Some(from_s);
        }
        if size >= floor_n && size > 0.0 {
            judged_s += step_s;
            over_s += if over { step_s } else { 0.0 };
            let relative = rate / size;
            if all.relative_per_s.is_none_or(|largest| relative > largest) {
                (all.relative_per_s, all.relative_at_s) = (Some(relative), Some(at_s));
            }
        }
    }
    if let Some(all) = &mut found {
        all.over_share = (judged_s > 0.0).then(|| over_s / judged_s);
    }
    found
}

fn length([x, y, z]: [f64; 3]) -> f64 {
    x.hypot(y).hypot(z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trajectory::Spiral;

    #[test]
    fn ten_per_cent_and_a_tenth_of_a_second_allow_one_newton_a_second_at_one_newton() {
        assert_eq!(rate_limit_per_s(0.1, 0.1), 1.0);
        assert_eq!(percent_error(1.0, 1.0, 0.1), 0.1);
        // The thesis rounds 0.159 Hz to 0.15.
        assert!((circling_limit_hz(1.0) - 0.159_154_943).abs() <= 1e-9);
    }

    #[test]
    fn a_circle_of_constant_force_turns_at_equation_24s_rate() {
        let circle = |k: i32| {
            let t_s = f64::from(k) * 1e-3;
            (t_s, [1.5 * (TAU * 0.15 * t_s).sin(), 1.5 * (TAU * 0.15 * t_s).cos(), 0.0])
        };
        let limits = rate_limits((0..20_000).map(circle), 0.1, 1.0).unwrap();
        // A chord of a millisecond falls short of the arc by 4e-8.
        assert!((limits.relative_per_s.unwrap() - TAU * 0.15).abs() <= 1e-6, "{limits:?}");
        assert!((limits.vector_n_per_s - 1.5 * TAU * 0.15).abs() <= 1e-6 && limits.components_n_per_s[2] == 0.0);
        assert_eq!((limits.over_share, limits.kept_from_s), (Some(0.0), Some(0.0)));
    }

    #[test]
    fn the_thesis_spiral_keeps_its_limit_but_for_the_first_seconds() {
        let spiral = Spiral::default();
        let rows = (0..=180_000).map(|k| f64::from(k) * 1e-3).map(|t_s| (t_s, spiral.forces_n(t_s)));
        let limits = rate_limits(rows, 0.3, 1.0).unwrap();
        // Measured: from 1.487 s on, and before that over in 6e-5 of the time with 0.3 N or more, by 1.5 %.
        assert!(limits.kept_from_s.unwrap() < 2.0 && limits.over_share.unwrap() <= 1e-3, "{limits:?}");
        assert!((limits.relative_per_s.unwrap() - 1.0145).abs() <= 1e-3, "{limits:?}");
        // The last full swing of F_r, to 2.07 N at N = 2.76, turns by 0.94 a second: 1.95 N/s.
        assert!((limits.vector_n_per_s - 1.947).abs() <= 1e-3, "{limits:?}");
    }

    #[test]
    fn gaps_are_left_out_and_no_rows_have_no_rates() {
        let row = |t_s: f64, force: f64| (t_s, [0.0, 0.0, -force]);
        assert_eq!(rate_limits([], 0.1, 1.0), None);
        assert_eq!(rate_limits([row(0.0, 1.0)], 0.1, 1.0), None);
        assert_eq!(rate_limits([row(0.0, 1.0), row(0.0, 2.0), row(-1.0, 9.0)], 0.1, 1.0), None);
        let rows = [row(0.0, 1.0), row(1.0, 1.5), row(2.0, f64::NAN), row(3.0, 100.0), row(4.0, 100.0)];
        let limits = rate_limits(rows, 0.1, 0.3).unwrap();
        assert_eq!((limits.vector_n_per_s, limits.vector_at_s, limits.relative_per_s), (0.5, 0.5, Some(0.4)));
        assert_eq!((limits.over_share, limits.kept_from_s), (Some(0.5), Some(3.0)));
        let still = rate_limits([row(0.0, 0.0), row(1.0, 0.0)], 0.1, 1.0).unwrap();
        assert_eq!((still.relative_per_s, still.over_share, still.vector_n_per_s), (None, None, 0.0));
    }
}
