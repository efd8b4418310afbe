use proptest::prelude::*;

use super::*;

const GAP_S: f64 = 0.1;

/// A curve through `value` at `times`, with one standard error.
fn curve(times_s: &[f64], value: impl Fn(f64) -> f64, sd: f64) -> Curve {
    let angles: Vec<f64> = times_s.iter().map(|&t| value(t)).collect();
    Curve::new(times_s, &angles, &vec![sd; times_s.len()], GAP_S)
}

fn frames(count: usize, rate_hz: f64) -> Vec<f64> {
    (0..count).map(|k| k as f64 / rate_hz).collect()
}

#[test]
fn a_polynomial_goes_as_far_as_its_neighbours_reach() {
    let cubic = |t: f64| 2.0 - 30.0 * t + 400.0 * t * t - 5000.0 * t.powi(3);
    let rate = |t: f64| -30.0 + 800.0 * t - 15_000.0 * t * t;
    let mut inner = curve(&[0.0, 0.03, 0.07, 0.1, 0.14], cubic, 0.0);
    let at = inner.at(0.05).unwrap();
    // Measured 4e-16, 1e-14; the fifth frame finds nothing to add.
    assert!((at.deg - cubic(0.05)).abs() <= 1e-13 && (at.rate_deg_s - rate(0.05)).abs() <= 1e-11, "{at:?}");
    assert!(at.variance_deg2 <= 1e-24, "{at:?}");
    let parabola = |t: f64| 1.0 + 20.0 * t - 700.0 * t * t;
    let mut end = curve(&[0.0, 0.03, 0.07, 0.1], parabola, 0.0);
    assert!((end.at(0.01).unwrap().deg - parabola(0.01)).abs() <= 1e-13);
    let line = |t: f64| 1.0 + 20.0 * t;
    let mut pair = curve(&[0.0, 0.03, 0.5], line, 0.0);
    let at = pair.at(0.01).unwrap();
    assert!((at.deg - line(0.01)).abs() <= 1e-13 && (at.rate_deg_s - 20.0).abs() <= 1e-11);
    assert!(at.variance_deg2.is_nan(), "nothing shows how the angle bends");
}

#[test]
fn a_neighbour_that_would_magnify_errors_is_left_out() {
    let times = [0.0, 0.001, 0.051, 0.052];
    let at = curve(&times, |t| t, 1.0).at(0.026).unwrap();
    // The line's weights are 0.5 and 0.5; the polynomial's were 12.5 and more.
    assert!((at.variance_deg2 - 0.5).abs() <= 0.01, "{at:?}");
}

#[test]
fn the_error_of_the_polynomial_is_told() {
    // 1 Hz, 40 degrees, 30 frames a second, errors far below the interpolation's.
    let (rate_hz, omega) = (30.0, std::f64::consts::TAU);
    let truth = |t: f64| 40.0 * (omega * t).sin();
    for (name, lost, from, most) in
        [("cubic", 0..0, 40, 2e-3), ("parabola", 11..20, 9, 0.025), ("line", 12..20, 10, 0.25)]
    {
        let mut times = frames(60, rate_hz);
        times.drain(lost.clone());
        if name == "line" {
            times.drain(0..10);
        }
        let mut curve = curve(&times, truth, 1e-9);
        let (mut worst, mut reported): (f64, f64) = (0.0, 0.0);
        for k in 0..100 {
            let t = (f64::from(from) + f64::from(k) / 100.0) / rate_hz;
            let at = curve.at(t).unwrap();
            let error = (at.deg - truth(t)).abs();
            worst = worst.max(error);
            reported = reported.max(at.variance_deg2.sqrt());
        }
        // Measured 0.0015 reported as 0.0016, 0.0079 as 0.0049, 0.18 as 0.16.
        assert!(
            worst <= most && reported >= 0.5 * worst && reported <= 3.0 * worst,
            "{name}: {worst} reported as {reported}"
        );
    }
}

#[test]
fn frames_alone_have_their_own_angle_and_nothing_around() {
    let mut lone = curve(&[1.0], |_| 7.0, 0.2);
    let at = lone.at(1.0 + 0.5 * SAME_TIME_S).unwrap();
    assert!(at.deg == 7.0 && (at.variance_deg2 - 0.04).abs() <= 1e-15 && at.rate_deg_s.is_nan());
    assert_eq!(lone.at(1.1), Err(Hole { after_s: Some(1.0), before_s: None }));
    assert_eq!(lone.at(0.9), Err(Hole { after_s: None, before_s: Some(1.0) }));
    let mut none = curve(&[], |_| 0.0, 0.0);
    assert_eq!(none.at(1.0), Err(Hole { after_s: None, before_s: None }));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn frames_keep_their_angles_and_the_order_of_asking_does_not_matter(
        steps in prop::collection::vec(0.001..0.3_f64, 1..40),
        angles in prop::collection::vec(prop_oneof![4 => -90.0..90.0_f64, 1 => Just(f64::NAN)], 41),
        asked in prop::collection::vec(0.0..1.0_f64, 1..40),
    ) {
        let times: Vec<f64> = {
            let sums = steps.iter().scan(0.0, |t, s| {
                *t += s;
                Some(*t)
            });
            std::iter::once(0.0).chain(sums).collect()
        };
        let angles = &angles[..times.len()];
        let sds = vec![0.1; times.len()];
        let mut curve = Curve::new(&times, angles, &sds, GAP_S);
        for (k, &t) in times.iter().enumerate() {
            match curve.at(t) {
                Ok(at) => prop_assert!(at.deg == angles[k] || angles[k].is_nan()),
                Err(_) => prop_assert!(angles[k].is_nan()),
            }
        }
        let span = times[times.len() - 1];
        for share in asked {
            let t = share * span;
            let fresh = Curve::new(&times, angles, &sds, GAP_S).at(t);
            let bits = |at: Result<Between, Hole>| at.map(|b| [b.deg, b.variance_deg2, b.rate_deg_s].map(f64::to_bits));
            prop_assert_eq!(bits(curve.at(t)), bits(fresh));
            // The naive rule: seen frames on both sides, no further apart than the gap.
            let seen = |k: &usize| angles[*k].is_finite();
            let before = (0..times.len()).filter(seen).rfind(|&k| times[k] <= t);
            let after = (0..times.len()).filter(seen).find(|&k| times[k] > t);
            let near = before.into_iter().chain(after).any(|k| (times[k] - t).abs() <= SAME_TIME_S);
            let bridged = matches!((before, after), (Some(a), Some(b)) if times[b] - times[a] <= GAP_S + SAME_TIME_S);
            prop_assert_eq!(fresh.is_ok(), near || bridged);
        }
    }
}
