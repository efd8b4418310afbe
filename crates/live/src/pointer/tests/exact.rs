//! The sum of the moves against the integral.

use proptest::prelude::*;

use super::super::{Click, Mode};
use super::*;

/// Rounding of some hundred sums of up to 1e5 px; measured 2e-10.
const NEAR: f64 = 1e-6;

/// The integral as the book has it: low-pass, dead zone, two gains, cap, rectangles; every sample of a touch but its
/// first. Written without the pointer's parts.
fn integral_px(config: &Config, samples: &[(f64, [f64; 3])]) -> [f64; 2] {
    let low = |cutoff: f64, dt: f64| 1.0 / (1.0 + 1.0 / (2.0 * std::f64::consts::PI * cutoff) / dt);
    let (mut sum, mut touched, mut last) = ([0.0; 2], false, None::<(f64, [f64; 2], [f64; 2])>);
    for &(t_s, [fx, fy, pressing]) in samples {
        let (mut filtered, mut rate, mut dt) = ([fx, fy], [0.0; 2], 0.0);
        if let Some((before_s, before, rate_before)) = last {
            dt = t_s - before_s;
            for axis in 0..2 {
                let raw = ([fx, fy][axis] - before[axis]) / dt;
                rate[axis] = low(1.0, dt) * raw + (1.0 - low(1.0, dt)) * rate_before[axis];
            }
            let a = low(config.min_cutoff_hz + config.beta * (rate[0].powi(2) + rate[1].powi(2)).sqrt(), dt);
            for axis in 0..2 {
                filtered[axis] = a * [fx, fy][axis] + (1.0 - a) * before[axis];
            }
        }
        last = Some((t_s, filtered, rate));
        let touches = pressing >= if touched { config.touch_release_n } else { config.touch_n };
        if touches && touched {
            let size = (filtered[0].powi(2) + filtered[1].powi(2)).sqrt();
            let beyond = (size - config.dead_zone_n).max(0.0);
            let slow = beyond.min(config.knee_n) * config.gain_low_px_per_s_per_n;
            let fast = (beyond - config.knee_n).max(0.0) * config.gain_high_px_per_s_per_n;
            let speed = (slow + fast).min(config.cap_px_per_s);
            if size > 0.0 {
                sum[0] += filtered[0] / size * speed * dt;
                sum[1] -= filtered[1] / size * speed * dt;
            }
        }
        touched = touches;
    }
    sum
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn moves_are_never_a_count_away_from_the_integral(
        steps in proptest::collection::vec((1e-4..0.03_f64, -1.0..1.0_f64, -1.0..1.0_f64, 0.0..2.0_f64), 2..300),
        cap_px_per_s in 1.0..3000.0_f64, dead_zone_n in 0.0..0.5_f64, beta in 0.0..5.0_f64,
    ) {
        let config = Config {
            click: Click::Off, settle_s: 0.0, rise_n: 20.0, zero: false, cap_px_per_s, dead_zone_n, beta,
            ..Config::default()
        };
        let mut samples = vec![(10.0, [0.0; 3])];
        for (dt_s, fx, fy, pressing) in steps {
            samples.push((samples[samples.len() - 1].0 + dt_s, [fx, fy, pressing]));
        }
        let (mut pointer, mut reported) = (Pointer::new(config), [0.0; 2]);
        for (index, &(t_s, [fx, fy, pressing])) in samples.iter().enumerate() {
            pointer.sample(t_s, fx, fy, -pressing, None, true, &mut |event| if let What::Move { dx, dy } = event.what {
                reported = [reported[0] + f64::from(dx), reported[1] + f64::from(dy)];
            });
            let exact = integral_px(&config, &samples[..=index]);
            for axis in 0..2 {
                prop_assert!((reported[axis] - exact[axis]).abs() <= 1.0 + NEAR, "{reported:?} {exact:?}");
                prop_assert!((pointer.place_px()[axis] - exact[axis]).abs() <= NEAR);
            }
        }
    }

    /// Clicks, drags, taps, faults and all: what was reported and where the pointer is stay within a count, nothing
    /// panics, times never go back but with the clock, and the button is pressed and let go in turn.
    #[test]
    fn whatever_comes_moves_and_place_agree(
        steps in proptest::collection::vec(
            (-0.02..0.1_f64, -2.0..2.0_f64, -2.0..2.0_f64, -0.5..3.5_f64, 0..40_u8, 1..12_u8), 1..120),
        mode in prop_oneof![Just(Mode::Velocity), Just(Mode::Position)],
        click in prop_oneof![Just(Click::Press), Just(Click::Tap), Just(Click::Off)],
        take_back_s in prop_oneof![Just(0.0), 0.001..1.0_f64],
        cap_px_per_s in 1.0..1e6_f64,
    ) {
        let config = Config { mode, click, take_back_s, cap_px_per_s, scroll: true, ..Config::default() };
        let (mut pointer, mut reported, mut down) = (Pointer::new(config), [0.0; 2], false);
        let (mut t_s, mut wrong) = (0.0, 0);
        for (dt_s, fx, fy, pressing, kind, times) in steps {
            for _ in 0..times {
                t_s += dt_s.max(-0.01);
                let mut out = |event: Event| {
                    wrong += u32::from(!event.t_s.is_finite());
                    match event.what {
                        What::Move { dx, dy } => {
                            reported = [reported[0] + f64::from(dx), reported[1] + f64::from(dy)];
                        }
                        What::Button { down: now, .. } => {
                            wrong += u32::from(now == down);
                            down = now;
                        }
                        _ => {}
                    }
                };
                let (fx, t) = match kind {
                    0 => (f64::NAN, t_s),
                    1 => (f64::INFINITY, t_s),
                    2 => (f64::MAX, t_s),
                    3 => (fx, f64::NAN),
                    4 => (fx, t_s + 1e300),
                    5 => (fx, t_s - 1e3),
                    _ => (fx, t_s),
                };
                pointer.sample(t, fx, fy, -pressing, Some(20.0 * fx), kind != 6, &mut out);
                match kind {
                    7 => pointer.advance(t_s + 1.0, &mut out),
                    8 => pointer.advance(f64::NAN, &mut out),
                    9 => pointer.lose(t_s, super::super::Reason::Lost, &mut out),
                    _ => {}
                }
                prop_assert_eq!(pointer.is_down(), down);
                for (reported, place_px) in reported.iter().zip(pointer.place_px()) {
                    prop_assert!((reported - place_px).abs() <= 1.0, "{reported} {place_px}");
                }
            }
        }
        prop_assert_eq!(wrong, 0);
        pointer.reset(&mut |event| if let What::Button { down: now, .. } = event.what { down = now; });
        prop_assert!(!down);
    }
}
