use std::f64::consts::TAU;
use std::path::PathBuf;

use proptest::prelude::*;

use super::*;

const SIGNAL_V: f64 = 1.0;

fn channel(name: &str, values: Vec<f64>) -> Channel {
    Channel { name: name.to_owned(), values }
}

fn log(time_s: Vec<f64>, led: Option<Vec<bool>>, photodiodes: Vec<Channel>) -> Log {
    let path = PathBuf::from("log.csv");
    Log { path, time_s, midnight_s: None, led, photodiodes, forces: Vec::new(), notes: Vec::new() }
}

/// Rows at 25 Hz, unlit first, lit and unlit in turn: a steady signal in the light that `ambient` says.
fn alternating(rows: usize, ambient: impl Fn(f64) -> f64) -> Log {
    let time_s: Vec<f64> = (0..rows).map(|k| k as f64 * 0.04).collect();
    let led: Vec<bool> = (0..rows).map(|k| k % 2 == 1).collect();
    let values = time_s.iter().zip(&led).map(|(&t, &on)| ambient(t) + if on { SIGNAL_V } else { 0.0 }).collect();
    log(time_s, Some(led), vec![channel("P1", values)])
}

fn all(log: &Log) -> Samples {
    samples(log, &AmbientOptions::default()).unwrap()
}

fn noted(samples: &Samples, words: &str) -> bool {
    samples.warnings.iter().chain(&samples.notes).any(|note| note.contains(words))
}

#[track_caller]
fn is_noted(samples: &Samples, words: &str) {
    assert!(noted(samples, words), "{words}: {:?} {:?}", samples.warnings, samples.notes);
}

/// The greatest error of the first channel where the signal is steady.
fn worst(samples: &Samples) -> f64 {
    samples.photodiodes[0].values.iter().filter(|v| !v.is_nan()).map(|v| (v - SIGNAL_V).abs()).fold(0.0, f64::max)
}

/// What may be left of ambient light as bright as the signal that varies by 10 %, as a share of the signal.
const LEFT: f64 = 0.002;

#[test]
fn ambient_light_that_varies_by_a_tenth_is_removed() {
    let cloud = |t: f64| 1.0 - 0.1 / (1.0 + (-(t - 5.0) / 0.1).exp());
    let slow = |hz: f64| move |t: f64| 1.0 + 0.1 * (TAU * hz * t).sin();
    // Left over: 9.7e-5, 7.1e-4, 1.7e-3 (at the ends, where three neighbours do), 1.1e-4 behind the cloud.
    for (name, left) in [
        ("0.5 Hz", worst(&all(&alternating(1000, slow(0.5))))),
        ("1 Hz", worst(&all(&alternating(1000, slow(1.0))))),
        ("1.4 Hz", worst(&all(&alternating(1000, slow(1.4))))),
        ("a cloud within 0.4 s", worst(&all(&alternating(1000, cloud)))),
    ] {
        assert!(left <= LEFT, "{name}: {left}");
    }
    // A ripple at 6 Hz, near half the rate of unlit samples, stays and is said: 0.71 % in the mean square, counted 1.86
    // times.
    let ripple = all(&alternating(1000, |t| 1.0 + 0.01 * (TAU * 6.0 * t).sin()));
    is_noted(&ripple, "too fast to follow are up to 1.3");
    let samples = all(&alternating(1000, slow(1.0)));
    is_noted(&samples, "50.0 to 50.0 % of what the photodiodes read lit; a row's noise is 1.28 times");
}

#[test]
fn forces_and_rows_are_the_lit_ones_and_without_led_all_stay() {
    let mut modulated = alternating(8, |_| 0.5);
    modulated.forces.push(channel("Fz_N", (0..8).map(f64::from).collect()));
    let samples = all(&modulated);
    assert_eq!(samples.forces[0].values, [1.0, 3.0, 5.0, 7.0]);
    assert!(samples.time_s.iter().zip([0.04, 0.12, 0.2, 0.28]).all(|(a, b)| (a - b).abs() <= 1e-12));
    // Behind the last unlit row nothing is known.
    assert_eq!(samples.faults, ["", "", "", "no ambient"]);
    assert!(samples.photodiodes[0].values[3].is_nan() && worst(&samples) <= 1e-12);
    modulated.led = None;
    let samples = all(&modulated);
    assert_eq!((samples.time_s.len(), &samples.photodiodes), (8, &modulated.photodiodes));
    assert!(samples.faults.iter().all(String::is_empty) && samples.notes.is_empty());
}

#[test]
fn an_led_that_never_changes_is_told() {
    let mut steady = alternating(8, |_| 0.5);
    steady.led = Some(vec![true; 8]);
    let samples = all(&steady);
    assert!(noted(&samples, "never off") && samples.photodiodes == steady.photodiodes);
    steady.led = Some(vec![false; 8]);
    let error = super::samples(&steady, &AmbientOptions::default()).unwrap_err().to_string();
    assert!(error.contains("log.csv: the LED is never on") && error.contains("8 rows"), "{error}");
    // The other way round: what is left is negative.
    let mut reversed = alternating(200, |t| 0.5 + 0.01 * (TAU * t).sin());
    assert!(!noted(&all(&reversed), "less lit than unlit"));
    reversed.led.as_mut().unwrap().iter_mut().for_each(|on| *on = !*on);
    assert!(all(&reversed).warnings.iter().any(|warning| warning.starts_with("P1 read less lit than unlit")));
    for bad in [[5.0, 0.0], [1.0, 1.0], [f64::NAN, 1.0]] {
        let options = AmbientOptions { full_scale_v: Some(bad), ..AmbientOptions::default() };
        assert!(matches!(super::samples(&steady, &options), Err(AmbientError::FullScale { .. })));
    }
}

#[test]
fn one_lit_row_needs_unlit_ones_around_it() {
    for (led, fault) in [
        (vec![false, true, false], ""),
        (vec![false, false, true], "no ambient"),
        (vec![true, false, false], "no ambient"),
        (vec![true], ""),
    ] {
        let rows = led.len();
        let values = led.iter().map(|&on| if on { 1.5 } else { 0.5 }).collect();
        let samples = all(&log((0..rows).map(|k| k as f64).collect(), Some(led), vec![channel("P1", values)]));
        assert_eq!(samples.faults, [fault]);
        assert_eq!(samples.photodiodes[0].values[0].is_nan(), !fault.is_empty());
    }
}

/// Keeps some rows of a log.
fn keep(log: &Log, kept: impl Fn(usize) -> bool) -> Log {
    let rows: Vec<usize> = (0..log.time_s.len()).filter(|&k| kept(k)).collect();
    let led = log.led.as_ref().map(|led| rows.iter().map(|&k| led[k]).collect());
    let channels = log.photodiodes.iter().map(|c| channel(&c.name, rows.iter().map(|&k| c.values[k]).collect()));
    self::log(rows.iter().map(|&k| log.time_s[k]).collect(), led, channels.collect())
}

#[test]
fn lost_rows_are_bridged_and_gaps_are_not() {
    let whole = alternating(400, |t| 1.0 + 0.1 * (TAU * 0.3 * t).sin());
    // One unlit row, and one lit row, are lost: two lit, two unlit rows follow each other.
    let lossy = keep(&whole, |k| k != 100 && k != 201);
    let samples = all(&lossy);
    assert!(samples.faults[..198].iter().all(String::is_empty));
    // Left over: 2.2e-5, where a neighbour was lost.
    assert!(worst(&samples) <= 1e-4, "{}", worst(&samples));
    // Of a second's unlit rows all are lost.
    let gap = keep(&whole, |k| !(100..125).contains(&k) || k % 2 == 1);
    let samples = all(&gap);
    let missing: Vec<f64> = samples.time_s[..199]
        .iter()
        .copied()
        .zip(&samples.faults)
        .filter(|(_, f)| *f == "no ambient")
        .map(|(t, _)| t)
        .collect();
    // The lit rows 99 to 125.
    assert_eq!((missing.len(), missing[0], missing[13]), (14, 99.0 * 0.04, 125.0 * 0.04));
    assert!(samples.photodiodes[0].values.iter().filter(|v| v.is_nan()).count() == 15 && worst(&samples) <= 1e-4);
}

#[test]
fn blocks_of_lit_rows_do_not_make_noise_greater() {
    let time_s: Vec<f64> = (0..400).map(|k| f64::from(k) * 0.01).collect();
    let led: Vec<bool> = (0..400).map(|k| k / 10 % 2 == 1).collect();
    // One millivolt up and down in turn: what four narrow neighbours would make many of.
    let values =
        (0..400).map(|k| 0.5 + if k % 2 == 0 { 1e-3 } else { -1e-3 } + if led[k] { SIGNAL_V } else { 0.0 }).collect();
    let samples = all(&log(time_s, Some(led), vec![channel("P1", values)]));
    assert!(worst(&samples) <= 2e-3 + 1e-12, "{}", worst(&samples));
    assert!(samples.faults[..190].iter().all(String::is_empty));
}

#[test]
fn a_missing_value_is_missing_in_its_channel_only() {
    let mut two = alternating(40, |_| 0.5);
    two.photodiodes.push(channel("P2", two.photodiodes[0].values.clone()));
    two.photodiodes[1].values[11] = f64::NAN;
    two.photodiodes[1].values[20] = f64::NAN;
    let samples = all(&two);
    let [p1, p2] = &samples.photodiodes[..] else { panic!() };
    assert!(p2.values[5].is_nan() && (0..19).all(|k| k == 5 || (p2.values[k] - SIGNAL_V).abs() <= 1e-12));
    assert!(
        (0..19).all(|k| (p1.values[k] - SIGNAL_V).abs() <= 1e-12) && samples.faults[..19].iter().all(String::is_empty)
    );
    two.photodiodes[1].values[16..40].fill(f64::NAN);
    two.photodiodes[1].values[31] = 1.0;
    assert_eq!(all(&two).faults[15], "no ambient: P2");
}

#[test]
fn unlit_rows_of_one_stamp_count_as_one() {
    let time_s = vec![0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0];
    let led: Vec<bool> = (0..8).map(|k| k % 2 == 1).collect();
    let values = vec![0.5, 1.5, 0.7, 1.5, 0.8, 1.8, 1.0, 1.8];
    let samples = all(&log(time_s, Some(led), vec![channel("P1", values)]));
    assert!(samples.photodiodes[0].values.iter().zip([0.9, 0.9, 0.9, 0.9]).all(|(a, b)| (a - b).abs() <= 1e-12));
}

/// A lively signal that is clipped at `top`, in 16 bits of 5 V; noise of 2 mV.
fn lively(rows: usize, top: f64) -> Vec<f64> {
    use rand::{RngExt, SeedableRng};
    let mut noise = rand_chacha::ChaCha8Rng::seed_from_u64(7);
    let codes = 65_536.0 / 5.0;
    let at = |k: usize| 2.0 + (TAU * k as f64 / 300.0).sin() + noise.random_range(-3.5e-3..3.5e-3);
    (0..rows).map(at).map(|v: f64| (v.min(top) * codes).round() / codes).collect()
}

#[test]
fn samples_at_the_rails_are_flagged() {
    let time_s: Vec<f64> = (0..3000).map(|k| f64::from(k) * 0.01).collect();
    let clipped = lively(3000, 2.8);
    let top = clipped.iter().copied().fold(0.0, f64::max);
    let quiet = lively(3000, 9.0);
    let log = log(time_s, None, vec![channel("P1", quiet), channel("P2", clipped.clone())]);
    let samples = all(&log);
    let flagged = samples.faults.iter().filter(|f| *f == "saturated: P2").count();
    assert_eq!(flagged, clipped.iter().filter(|&&v| v == top).count());
    assert!(flagged > 400 && samples.faults.iter().all(|f| f.is_empty() || f == "saturated: P2"));
    is_noted(&samples, "P2 stays at exactly its greatest value");
    assert_eq!(samples.warnings.len(), 1, "{:?}", samples.warnings);
    // The same upside down.
    let mut down = log.clone();
    down.photodiodes.iter_mut().flat_map(|c| &mut c.values).for_each(|v| *v = -*v);
    assert_eq!(all(&down).faults, samples.faults);
    // A range that is given is the range.
    let given = |range| {
        super::samples(&log, &AmbientOptions { full_scale_v: Some(range), ..AmbientOptions::default() }).unwrap()
    };
    assert!(given([0.0, 5.0]).faults.iter().all(String::is_empty));
    assert!(given([0.0, 5.0]).warnings.is_empty());
    let both = given([0.0, 2.8]);
    assert!(both.faults.iter().any(|f| f == "saturated: P1, P2"));
}

#[test]
fn saturation_of_the_light_around_a_row_is_flagged_with_it() {
    let mut bright = alternating(200, |_| 0.5);
    bright.photodiodes[0].values[100] = 5.0;
    let samples =
        super::samples(&bright, &AmbientOptions { full_scale_v: Some([0.0, 5.0]), ..AmbientOptions::default() })
            .unwrap();
    let flagged: Vec<usize> = (0..100).filter(|&k| samples.faults[k] == "saturated: P1").collect();
    // The unlit row 100 goes into the lit rows 97, 99, 101 and 103.
    assert_eq!(flagged, [48, 49, 50, 51]);
}

#[test]
fn signals_that_turn_or_rest_are_not_called_saturated() {
    let codes = 65_536.0 / 5.0;
    let quantized = |v: f64| (v * codes).round() / codes;
    let time_s: Vec<f64> = (0..3000).map(|k| f64::from(k) * 0.01).collect();
    // Without noise: slow sinusoids whose crests stay within a code for long, and a smooth way to a rest.
    let crests = time_s.iter().map(|t| quantized(2.0 + (TAU * t / 20.0).sin())).collect();
    let coarse = time_s.iter().map(|t| ((2.0 + (TAU * t / 3.0).sin()) * 100.0).round() / 100.0).collect();
    let rest = time_s.iter().map(|t| quantized(2.0 - (-t / 0.5).exp())).collect();
    let halves = time_s.iter().map(|t| quantized(2.0 - (TAU * t.min(7.5) / 15.0).cos())).collect();
    // Presses from rest and back, a step of 8 bits from row to row.
    let steps = |k: usize| (91.0 + ((k % 60) as f64 - 10.0).abs().min(9.0)) * 5.0 / 255.0;
    let presses = (0..3000).map(|k| (steps(k) * 1e4).round() / 1e4).collect();
    let log = log(
        time_s,
        None,
        vec![
            channel("P1", crests),
            channel("P2", coarse),
            channel("P3", rest),
            channel("P4", halves),
            channel("P5", presses),
        ],
    );
    let samples = all(&log);
    assert!(samples.faults.iter().all(String::is_empty), "{:?}", samples.notes);
    assert!(!noted(&samples, "saturated"), "{:?}", samples.notes);
}

#[test]
fn dead_and_stuck_channels_are_warned_of() {
    let time_s: Vec<f64> = (0..3000).map(|k| f64::from(k) * 0.01).collect();
    let mut stuck = lively(3000, 9.0);
    stuck[1000..1200].fill(2.25);
    let steps = (0..3000).map(|k| if k % 7 == 0 { 1e-4 } else { 0.0 }).collect();
    let channels = vec![
        channel("P1", vec![0.002; 3000]),
        channel("P2", steps),
        channel("P3", stuck),
        channel("P4", lively(3000, 9.0)),
        channel("P5", vec![f64::NAN; 3000]),
        // Something now and then, at 0 else: no rail.
        channel("P6", (0..3000).map(|k| if k % 200 < 10 { 0.1 + f64::from(k % 13) } else { 0.0 }).collect()),
    ];
    let samples = all(&log(time_s, None, channels));
    is_noted(&samples, "P1 is 0.002 V in all lit samples: dead");
    is_noted(&samples, "P2 has only 2 different values");
    is_noted(&samples, "P3 does not move at all in 1 stretch(es); the longest, from 10.000 to 11.990 s");
    is_noted(&samples, "P6 is 0 V in 95.0 % of the lit samples: dead");
    is_noted(&samples, "P5 has no value at all");
    assert_eq!((samples.warnings.len(), samples.notes.len()), (5, 0), "{samples:?}");
    assert!(samples.faults.iter().all(String::is_empty));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Light that is a straight line goes away whole, whatever the times and the order of the LED.
    #[test]
    fn a_straight_light_goes_away_whole_or_is_missing(
        steps in prop::collection::vec((0.5..1.5_f64, any::<bool>()), 8..80),
        bend in -1.0..1.0_f64,
    ) {
        let mut at_s = 0.0;
        let time_s: Vec<f64> = steps.iter().map(|(step, _)| { at_s += 0.01 * step; at_s }).collect();
        let led: Vec<bool> = steps.iter().map(|s| s.1).collect();
        prop_assume!(led.contains(&true));
        let ambient = |t: f64| 0.5 + bend * t;
        let values = time_s.iter().zip(&led).map(|(&t, &on)| ambient(t) + if on { SIGNAL_V } else { 0.0 }).collect();
        let samples = all(&log(time_s.clone(), Some(led.clone()), vec![channel("P1", values)]));
        prop_assert_eq!(samples.time_s.len(), led.iter().filter(|on| **on).count());
        if led.contains(&false) {
            prop_assert!(worst(&samples) <= 1e-12);
            for (value, fault) in samples.photodiodes[0].values.iter().zip(&samples.faults) {
                prop_assert_eq!(value.is_nan(), fault == "no ambient");
            }
        }
    }
}

/// Twenty phases of `each` rows on, as many off, at 1 kHz; in the first row of each the light is `late` of the way
/// back.
fn phases(each: usize, late: f64, shifted: usize) -> Log {
    let on = |k: usize| (k / each) % 2 == 1;
    let level = |k: usize| if on(k) { 1.5 + 0.1 * (0.001 * k as f64).sin() } else { 0.5 };
    let settling = |k: usize| {
        let by = if k > 0 && k.is_multiple_of(each) { late * (level(k - 1) - level(k)) } else { 0.0 };
        level(k) + by + 0.002 * ((k * 7919) % 13) as f64 / 13.0
    };
    let rows = 40 * each;
    let led = (0..rows).map(|k| on(k.saturating_sub(shifted))).collect();
    log(
        (0..rows).map(|k| 0.001 * k as f64).collect(),
        Some(led),
        vec![channel("P1", (0..rows).map(settling).collect())],
    )
}

#[test]
fn rows_beside_a_switch_of_the_led_are_what_it_says() {
    for each in [3, 5, 10] {
        is_noted(&all(&phases(each, 0.0, 1)), "at the level of the unlit ones: is `led` a row late");
        is_noted(&all(&phases(each, 0.2, 0)), "the first row of each time that the LED is");
        assert!(!noted(&all(&phases(each, 0.0, 0)), "at the level of"), "{each}");
        assert!(!noted(&all(&phases(each, 0.01, 0)), "at the level of"), "{each}");
    }
    // Of one and two rows nothing is known.
    assert!(!noted(&all(&phases(2, 0.2, 0)), "at the level of"));
}

#[test]
fn missing_values_that_are_written_as_numbers_are_seen_in_lit_and_in_unlit_rows() {
    for (place, name) in [(1, "P1: single rows leap"), (0, "P1 unlit: single rows leap")] {
        let mut log = alternating(3000, |t| 0.5 + 0.05 * (0.3 * t).sin() + 0.001 * (70.0 * t).sin());
        log.photodiodes[0].values.iter_mut().skip(200 + place).step_by(200).for_each(|value| *value = -1.0);
        is_noted(&all(&log), name);
    }
}
