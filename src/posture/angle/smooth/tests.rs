use super::*;
use crate::trial::normals;

/// How a series is drawn.
#[derive(Clone, Copy)]
struct Drawn {
    rows: usize,
    rate_hz: f64,
    /// Degrees over seconds.
    motion: fn(f64) -> f64,
    sd_deg: f64,
    /// Correlation of the errors of neighbouring frames, and the share of their variance that is so.
    correlation: f64,
    share: f64,
    /// True errors over reported ones.
    scale: f64,
    /// Frame times move by up to so many frames.
    jitter: f64,
    /// Rows hidden out of a hundred, in runs of ten.
    hidden: usize,
}

const PLAIN: Drawn = Drawn {
    rows: 600,
    rate_hz: 30.0,
    motion: equation_27,
    sd_deg: 0.1,
    correlation: 0.0,
    share: 0.0,
    scale: 1.0,
    jitter: 0.0,
    hidden: 0,
};

fn equation_27(t: f64) -> f64 {
    35.0 - 40.0 * (std::f64::consts::TAU * 0.1 * t).cos()
}

fn one_hertz(t: f64) -> f64 {
    35.0 - 40.0 * (std::f64::consts::TAU * t).cos()
}

fn stop_and_go(t: f64) -> f64 {
    let at = (t / 2.0).fract();
    let way = |s: f64| s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
    60.0 * way((at * 4.0).min(1.0)) - 60.0 * way(((at - 0.5) * 4.0).clamp(0.0, 1.0))
}

fn still(_: f64) -> f64 {
    12.0
}

struct Series {
    times_s: Vec<f64>,
    truth: Vec<f64>,
    angles: Vec<Option<Angle>>,
}

fn draw(drawn: Drawn, seed: u64) -> Series {
    let mut normal = normals(seed);
    let mut series = Series { times_s: Vec::new(), truth: Vec::new(), angles: Vec::new() };
    let mut slow = normal();
    let (mut time, mut last) = (0.0, 0.0);
    for k in 0..drawn.rows {
        let kept = drawn.correlation.powf((time - last) * drawn.rate_hz);
        slow = kept * slow + (1.0 - kept * kept).sqrt() * normal();
        last = time;
        // Errors of different size, as of a finger that turns.
        let sd_rad = drawn.sd_deg.to_radians() * (1.0 + 0.5 * (k as f64 / 40.0).sin());
        let error = drawn.scale * sd_rad * (drawn.share.sqrt() * slow + (1.0 - drawn.share).sqrt() * normal());
        let truth = (drawn.motion)(time).to_radians();
        let hidden = (k / 10) * 37 % 100 < drawn.hidden;
        series.times_s.push(time);
        series.truth.push(truth);
        series.angles.push((!hidden).then_some(Angle { rad: truth + error, sd_rad, lasting_sd_rad: 0.0 }));
        time += (1.0 + drawn.jitter * normal().clamp(-0.9, 0.9)) / drawn.rate_hz;
    }
    series
}

/// Root mean square error before and after in degrees, and the share of the smoothed errors within one standard error.
fn measured(series: &Series, smoothed: &Smoothed) -> (f64, f64, f64) {
    let (mut before, mut after, mut within, mut n) = (0.0, 0.0, 0, 0);
    for ((given, got), truth) in series.angles.iter().zip(&smoothed.angles).zip(&series.truth) {
        assert_eq!(given.is_some(), got.is_some());
        if let (Some(given), Some(got)) = (given, got) {
            before += (given.rad - truth).powi(2);
            after += (got.rad - truth).powi(2);
            within += usize::from((got.rad - truth).abs() <= got.sd_rad);
            n += 1;
        }
    }
    let rms = |sum: f64| (sum / n as f64).sqrt().to_degrees();
    (rms(before), rms(after), within as f64 / n as f64)
}

/// Means over some seeds of what [`measured`] gives.
fn mean_of(drawn: Drawn) -> (f64, f64, f64) {
    const SEEDS: u64 = 8;
    let mut sums = [0.0; 3];
    for seed in 0..SEEDS {
        let series = draw(drawn, seed);
        let (before, after, within) = measured(&series, &smooth(&series.times_s, &series.angles));
        for (sum, value) in sums.iter_mut().zip([before, after, within]) {
            *sum += value / SEEDS as f64;
        }
    }
    (sums[0], sums[1], sums[2])
}

const HALF: Drawn = Drawn { correlation: 0.8, share: 0.7, ..PLAIN };

#[test]
fn correlated_errors_shrink_and_their_standard_errors_hold() {
    // What is left of the error, and the share within one standard error, as measured.
    for (name, drawn, left, within) in [
        ("correlation 0.5, all", Drawn { correlation: 0.5, share: 1.0, ..PLAIN }, 0.37, 0.79),
        ("correlation 0.8, all", Drawn { share: 1.0, ..HALF }, 0.59, 0.77),
        ("correlation 0.8, half", Drawn { share: 0.5, ..HALF }, 0.44, 0.76),
        ("correlation 0.95, half", Drawn { correlation: 0.95, share: 0.5, ..PLAIN }, 0.63, 0.73),
        ("1 Hz at 60 fps", Drawn { motion: one_hertz, rate_hz: 60.0, ..HALF }, 0.80, 0.71),
        ("1 Hz at 30 fps", Drawn { motion: one_hertz, ..HALF }, 0.89, 0.71),
        ("stop and go", Drawn { motion: stop_and_go, correlation: 0.5, ..HALF }, 0.83, 0.72),
        ("at rest", Drawn { motion: still, ..HALF }, 0.17, 0.65),
        ("errors 1.4 times as reported", Drawn { scale: 1.4, correlation: 0.6, ..HALF }, 0.36, 0.71),
        ("variable rate, a fifth hidden", Drawn { jitter: 0.5, hidden: 20, correlation: 0.6, ..HALF }, 0.39, 0.77),
        ("a hundredth of a degree", Drawn { sd_deg: 0.01, correlation: 0.6, ..HALF }, 0.51, 0.74),
    ] {
        let (before, after, share) = mean_of(drawn);
        assert!(after / before <= left + 0.03, "{name}: {before} to {after} degrees");
        assert!((share - within).abs() <= 0.03 && (0.60..=0.80).contains(&share), "{name}: {share} within one");
    }
}

#[test]
fn white_errors_shrink_most_and_are_not_understated() {
    for (drawn, left) in [(PLAIN, 0.23), (Drawn { motion: one_hertz, rate_hz: 60.0, ..PLAIN }, 0.47)] {
        let (before, after, share) = mean_of(drawn);
        // Measured 0.226 and 0.464; 0.86 and 0.85 within one: a slow error can't be ruled out, so some is allowed for.
        assert!(after / before <= left + 0.02, "{before} to {after} degrees");
        assert!((0.60..=0.90).contains(&share), "{share} within one");
    }
}

#[test]
fn bierman_s_form_is_the_least_squares_solution() {
    use nalgebra::{DMatrix, DVector};
    // Without a correlated part, with known strength: minimize the sum of squares over all states at once.
    let parameters = Parameters { jerk: 0.3, correlation: 0.5, share: 0.0, scale: 1.0 };
    let half_turn = 1000.0;
    let times: [f64; 6] = [0.0, 1.0, 1.5, 4.0, 4.2, 6.0];
    let series: Vec<Observation> = times
        .iter()
        .enumerate()
        .map(|(k, &time)| Observation { time, value: [3.0, 4.0, 2.0, 7.0, 8.5, 20.0][k], sd: 1.0 + 0.2 * k as f64 })
        .collect();
    let n = 3 * series.len();
    let (mut normal, mut right) = (DMatrix::<f64>::zeros(n, n), DVector::<f64>::zeros(n));
    for (k, sd) in [half_turn, half_turn / 4.0, half_turn / 4.0].into_iter().enumerate() {
        normal[(k, k)] += 1.0 / (sd * sd);
    }
    right[0] += series[0].value / (half_turn * half_turn);
    for (k, seen) in series.iter().enumerate() {
        normal[(3 * k, 3 * k)] += 1.0 / (seen.sd * seen.sd);
        right[3 * k] += seen.value / (seen.sd * seen.sd);
        if k > 0 {
            let t = seen.time - series[k - 1].time;
            let divisors = [[20.0, 8.0, 6.0], [8.0, 3.0, 2.0], [6.0, 2.0, 1.0]];
            let noise =
                nalgebra::Matrix3::from_fn(|r, c| t.powi(5 - (r + c) as i32) / divisors[r][c]) * parameters.jerk;
            let weight = noise.try_inverse().unwrap();
            let step = nalgebra::Matrix3::new(1.0, t, 0.5 * t * t, 0.0, 1.0, t, 0.0, 0.0, 1.0);
            let mut both = nalgebra::Matrix3x6::<f64>::zeros();
            both.fixed_view_mut::<3, 3>(0, 0).copy_from(&-step);
            both.fixed_view_mut::<3, 3>(0, 3).copy_from(&nalgebra::Matrix3::identity());
            let add = both.transpose() * weight * both;
            let mut part = normal.fixed_view_mut::<6, 6>(3 * (k - 1), 3 * (k - 1));
            part += add;
        }
    }
    let inverse = normal.try_inverse().unwrap();
    let expected = &inverse * right;
    let smoothed = filter::smooth(&series, &parameters, half_turn);
    assert!(smoothed.iter().all(|row| !row.left_out));
    for (k, row) in smoothed.iter().enumerate() {
        // Measured 7.5e-9 and 2.5e-8 of values near 10 and standard errors near 1.
        assert!((row.value - expected[3 * k]).abs() <= 1e-7, "{k}: {} {}", row.value, expected[3 * k]);
        assert!((row.sd - inverse[(3 * k, 3 * k)].sqrt()).abs() <= 1e-7, "{k}: {}", row.sd);
    }
}

#[test]
fn few_rows_stay_as_they_are() {
    for rows in [0, 1, FEWEST - 1] {
        let series = draw(Drawn { rows, ..PLAIN }, 1);
        let smoothed = smooth(&series.times_s, &series.angles);
        assert_eq!((smoothed.angles, smoothed.model), (series.angles, None));
    }
    let none = vec![None; 100];
    let times: Vec<f64> = (0..100).map(f64::from).collect();
    assert_eq!(smooth(&times, &none).angles, none);
}

#[test]
fn a_frozen_series_keeps_its_value_and_some_of_its_error() {
    let angles = vec![Some(Angle { rad: 0.5, sd_rad: 0.002, lasting_sd_rad: 0.0 }); 200];
    let times: Vec<f64> = (0..200).map(|k| f64::from(k) / 30.0).collect();
    for angle in smooth(&times, &angles).angles.iter().flatten() {
        // Measured 0.0020, as given: errors that do not change at all may be the same error.
        assert!((angle.rad - 0.5).abs() <= 1e-9 && (0.001..=0.002).contains(&angle.sd_rad), "{angle:?}");
    }
}

#[test]
fn a_wild_angle_does_not_bend_its_neighbours() {
    let plain = draw(HALF, 3);
    let mut wild = draw(HALF, 3);
    for row in [0, 100, 101, 102, 350, 599] {
        wild.angles[row].as_mut().unwrap().rad += 0.3;
    }
    let [expected, got] = [&plain, &wild].map(|s| smooth(&s.times_s, &s.angles));
    assert_eq!(
        (expected.model.unwrap().left_out, got.model.unwrap().left_out),
        (0, 5),
        "the first row has none before it"
    );
    for (row, (a, b)) in expected.angles.iter().zip(&got.angles).enumerate().skip(10) {
        let (a, b) = (a.unwrap(), b.unwrap());
        // 17 degrees of error; measured 0.13 degrees.
        assert!((a.rad - b.rad).abs() <= 0.15_f64.to_radians(), "{row}: {a:?} {b:?}");
    }
}

#[test]
fn a_jump_or_a_long_gap_begins_anew() {
    let drawn = Drawn { rows: 200, ..HALF };
    let series = draw(drawn, 5);
    let mut jumped = series.angles.clone();
    for angle in jumped[100..].iter_mut().flatten() {
        angle.rad += 1.0;
    }
    let smoothed = smooth(&series.times_s, &jumped);
    for row in (0..90).chain(110..200) {
        let truth = series.truth[row] + if row < 100 { 0.0 } else { 1.0 };
        let angle = smoothed.angles[row].unwrap();
        assert!((angle.rad - truth).abs() <= 5.0 * angle.sd_rad, "{row}: {angle:?} {truth}");
    }
    let mut times = series.times_s.clone();
    for time in &mut times[100..] {
        *time += 1e6;
    }
    let smoothed = smooth(&times, &series.angles);
    for (angle, truth) in smoothed.angles.iter().flatten().zip(&series.truth) {
        assert!((angle.rad - truth).abs() <= 5.0 * angle.sd_rad && angle.sd_rad < 0.01, "{angle:?} {truth}");
    }
}

/// A joint that hardly bends back, twice a second: its turns are sharper than its motion.
fn hinge(t: f64) -> f64 {
    let flexed = 35.0 - 40.0 * (std::f64::consts::TAU * 2.0 * t).cos();
    if flexed < 10.0 { -5.0 + 0.02 * flexed } else { -5.0 + 0.85 * (flexed - 10.0) }
}

#[test]
fn a_motion_that_is_too_fast_for_the_frames_stays_as_measured() {
    for (rate_hz, seed) in [(24.0, 1), (24.0, 2), (15.0, 4), (10.0, 5), (30.0, 3)] {
        let series = draw(Drawn { rows: 144, rate_hz, motion: hinge, sd_deg: 0.12, ..PLAIN }, seed);
        let smoothed = smooth(&series.times_s, &series.angles);
        let known = smoothed.angles.iter().zip(&series.truth).filter_map(|(angle, truth)| angle.map(|a| (a, truth)));
        let far = known.map(|(angle, truth)| (angle.rad - truth).abs().to_degrees()).fold(0.0, f64::max);
        println!("{rate_hz} Hz: {far:.2} degrees off; {:?}", smoothed.doubt);
        assert!(far <= 1.0, "{far}");
        let is_as_measured = smoothed.angles == series.angles;
        assert_eq!(is_as_measured, smoothed.model.is_none());
        assert_eq!(is_as_measured, smoothed.doubt.is_some());
    }
}

#[test]
fn a_wild_angle_amid_a_motion_is_its_neighbours() {
    for motion in [equation_27, one_hertz, stop_and_go] {
        let series = draw(Drawn { motion, ..PLAIN }, 7);
        let mut wild = series.angles.clone();
        for row in [100, 250, 251, 400] {
            wild[row].as_mut().unwrap().rad += 0.6;
        }
        let smoothed = smooth(&series.times_s, &wild);
        let model = smoothed.model.unwrap();
        let ratio =
            |row: usize| smoothed.angles[row].map_or(f64::NAN, |angle| angle.sd_rad / wild[row].unwrap().sd_rad);
        println!("{} left out; {:?}", model.left_out, [100, 250, 251, 400].map(ratio));
        assert!(model.left_out == 4 && smoothed.doubt.is_none());
        let far = smoothed.angles.iter().zip(&series.truth).map(|(angle, truth)| (angle.unwrap().rad - truth).abs());
        assert!(far.fold(0.0, f64::max).to_degrees() <= 0.5);
    }
}

#[test]
fn equal_times_and_errors_of_nothing_are_borne() {
    let series = draw(Drawn { rows: 100, ..PLAIN }, 2);
    let mut times = series.times_s.clone();
    times[50] = times[49];
    let mut exact = series.angles.clone();
    for angle in exact.iter_mut().flatten() {
        angle.sd_rad = 0.0;
    }
    for angles in [&series.angles, &exact] {
        for times in [&times, &vec![0.0; 100]] {
            let smoothed = smooth(times, angles);
            assert!(smoothed.angles.iter().flatten().all(|a| a.rad.is_finite() && a.sd_rad.is_finite()));
        }
    }
}

#[test]
fn a_long_series_is_looked_at_in_places() {
    let series = draw(Drawn { rows: 20_000, ..HALF }, 4);
    let smoothed = smooth(&series.times_s, &series.angles);
    let (before, after, within) = measured(&series, &smoothed);
    // Measured 0.52 and 0.70.
    assert!(after <= 0.6 * before && (0.60..=0.80).contains(&within), "{before} {after} {within}");
    assert_eq!(smoothed, smooth(&series.times_s, &series.angles), "the same again");
}

#[test]
fn what_lasts_is_not_smoothed_away() {
    let times_s: Vec<f64> = (0..200).map(|row| f64::from(row) / 24.0).collect();
    let at = |row: usize, lasting_sd_rad: f64| {
        let noise = 0.001 * (1.7 * row as f64).sin() * 1.414;
        let sd_rad = 0.001f64.hypot(lasting_sd_rad);
        Some(Angle { rad: 0.5 + noise, sd_rad, lasting_sd_rad })
    };
    let [plain, lasting] =
        [0.0, 0.004].map(|lasting| smooth(&times_s, &(0..200).map(|row| at(row, lasting)).collect::<Vec<_>>()));
    for (plain, lasting) in plain.angles.iter().zip(&lasting.angles) {
        let (plain, lasting) = (plain.unwrap(), lasting.unwrap());
        assert!((plain.rad - lasting.rad).abs() < 1e-6, "the same noise is smoothed alike");
        assert!(plain.sd_rad < 0.001 && (lasting.sd_rad - plain.sd_rad.hypot(0.004)).abs() < 1e-6);
    }
}
