//! How often the truth lies within two standard errors: 95.4 % are expected of 200 recordings with 1 % noise (SD over
//! the swing), 190.9 with an SD of 3.0; and how often it lies within the intervals.
//!
//! The recordings are like those of Fig. 80 (the proximal photodiode under a proximal step), of Fig. 82 (the distal one
//! under a distal step), and both of a subject together; 4 s with 400 samples. The fit starts from the thesis' table.

use lunula_hemodynamics::{Bounds, Estimate, FitOptions, Parameters, Recording, fit};

use crate::phantom::{exact, noisy, pressed, softer, step, tied, with_photodiodes, zero};

/// Stiffness and damping of the phantom over those of the thesis.
const TRUTH: [f64; 2] = [1.5, 0.6];
const SCALINGS_V: [f64; 2] = [2.5, 3.0];
const OFFSETS_V: [f64; 2] = [0.4, -0.2];

fn with_intervals() -> FitOptions {
    FitOptions { intervals: true, ..FitOptions::default() }
}

enum Kind {
    Proximal,
    Distal,
    Both,
    Force,
}

fn phantom(kind: &Kind) -> Vec<Recording> {
    let truth = with_photodiodes(softer(TRUTH[0], TRUTH[1]), SCALINGS_V, OFFSETS_V);
    let (zero, step) = (zero(), step(9000.0));
    let proximal = || exact(&truth, &step, &zero, &[0]);
    let distal = || exact(&truth, &zero, &step, &[1]);
    match kind {
        Kind::Proximal => vec![proximal()],
        Kind::Distal => vec![distal()],
        Kind::Both => vec![proximal().of("2"), distal().of("2")],
        Kind::Force => vec![exact(&truth, &zero, &pressed(9000.0, 0.2, 2.2), &[1])],
    }
}

fn holds(one: &Estimate, truth: f64) -> bool {
    matches!(one.interval, [Some(low), Some(high)] if low <= truth && truth <= high)
}

/// Of so many seeds, how many have the truth within two standard errors (k, b, then offset and scaling of each
/// photodiode) and within the intervals.
fn covered(kind: &Kind, seeds: u64) -> Vec<(String, u64)> {
    let recordings = phantom(kind);
    let mut counts: Vec<(String, u64)> = vec![];
    for seed in 0..seeds {
        let noisy: Vec<Recording> =
            recordings.iter().zip(0..).map(|(one, k)| noisy(one, 0.01, 10 * seed + k)).collect();
        let result = fit(&noisy, &Parameters::thesis(), &tied(), &with_intervals()).expect("a fit");
        let groups = result.groups.iter().zip([1e5 * TRUTH[0], 1e4 * TRUTH[1]]);
        let mut all: Vec<(f64, Option<f64>, f64)> = groups
            .map(|(group, truth)| (group.values[0], group.standard_errors.as_ref().map(|errors| errors[0]), truth))
            .collect();
        for diode in &result.photodiodes {
            for (estimate, truth) in [(diode.offset, OFFSETS_V[diode.unit]), (diode.scaling, SCALINGS_V[diode.unit])] {
                all.push((estimate.value, estimate.standard_error, truth));
            }
        }
        let mut within: Vec<(String, bool)> = vec![];
        for (name, (value, error, truth)) in result.names.iter().zip(all) {
            within.push((name.clone(), error.is_some_and(|error| (value - truth).abs() <= 2.0 * error)));
        }
        for (group, truth) in result.groups.iter().zip([1e5 * TRUTH[0], 1e4 * TRUTH[1]]) {
            let [low, high] = &group.interval;
            let inside =
                low.as_ref().is_none_or(|low| low[0] <= truth) && high.as_ref().is_none_or(|high| truth <= high[0]);
            within.push((format!("interval of {}", group.symbols[0]), inside));
        }
        for diode in &result.photodiodes {
            let truth = [OFFSETS_V[diode.unit], SCALINGS_V[diode.unit]];
            let inside = [diode.offset, diode.scaling].into_iter().zip(truth).all(|(one, truth)| holds(&one, truth));
            within.push((format!("intervals of photodiode {}", diode.unit + 1), inside));
        }
        counts.resize_with(within.len(), || (String::new(), 0));
        for (count, (name, inside)) in counts.iter_mut().zip(within) {
            count.0 = name;
            count.1 += u64::from(inside);
        }
    }
    counts
}

/// At least so many of 200: three standard deviations of the binomial distribution below what is expected.
const LEAST: u64 = 182;

fn check(kind: &Kind, seeds: u64) {
    for (name, count) in covered(kind, seeds) {
        println!("{name}: {count} of {seeds}");
        assert!(count * 200 >= LEAST * seeds, "{name}: {count} of {seeds}");
    }
}

/// Measured: k 196, b 191, V_0 195, V_1 195; intervals of k 196, of b 191.
#[test]
fn a_distal_step_covers_its_truth() {
    check(&Kind::Distal, 200);
}

/// Measured: k 187, b 188, V_0 189 and 186, V_1 185 and 186.
/// Intervals: k 187, b 188.
#[test]
fn a_proximal_and_a_distal_step_cover_their_truth() {
    check(&Kind::Both, 200);
}

/// Measured of 200: k 191, b 193, V_0 191, V_1 191; intervals of k 190, of b 194. A fit takes three times those above.
#[test]
fn a_measured_force_covers_its_truth() {
    check(&Kind::Force, 60);
}

/// The proximal photodiode alone leaves k and V_1 uncertain by 16 %; so far the model is not linear, and two standard
/// errors are a little short; the intervals are not. Measured: k 183, b 183, V_0 188, V_1 190. Intervals: k 195,
/// b 196.
#[test]
fn intervals_of_a_proximal_step_cover_its_truth_and_standard_errors_nearly() {
    for (name, count) in covered(&Kind::Proximal, 200) {
        println!("{name}: {count} of 200");
        let least = if name.starts_with("interval") { LEAST } else { 176 };
        assert!(count >= least, "{name}: {count} of 200");
    }
}

/// The rise of the sum of squares at an interval's ends, over the variance, less 4; measured 0.08, of 0.08 allowed.
const RISE: f64 = 0.1;

#[test]
fn at_the_ends_of_an_interval_the_squares_have_risen_by_four_variances() {
    let recordings = phantom(&Kind::Proximal);
    let noisy = [noisy(&recordings[0], 0.01, 7)];
    let result = fit(&noisy, &Parameters::thesis(), &tied(), &with_intervals()).unwrap();
    let squares = |sd: f64, freedom: usize| sd * sd * freedom as f64;
    let mut ends = 0;
    for (q, group) in result.groups.iter().enumerate() {
        assert!(group.interval[0].as_ref().unwrap()[0] < group.values[0]);
        assert!(group.interval[1].as_ref().unwrap()[1] > group.values[1]);
        for end in group.interval.iter().flatten() {
            let pairs = group.symbols.iter().zip(end);
            let start =
                pairs.fold(result.parameters.clone(), |held, (&symbol, &value)| held.set(symbol, value).unwrap());
            let held = fit(&noisy, &start, &[tied()[1 - q].clone()], &FitOptions::default()).unwrap();
            let rise = (squares(held.residual_sd_v, held.freedom) - squares(result.residual_sd_v, result.freedom))
                / (result.residual_sd_v * result.residual_sd_v);
            assert!((rise - 4.0).abs() <= RISE, "{}: {rise}", group.symbols[0]);
            ends += 1;
        }
    }
    assert_eq!(ends, 4);
}

#[test]
fn an_interval_is_open_towards_a_bound() {
    let recordings = phantom(&Kind::Proximal);
    let noisy = [noisy(&recordings[0], 0.01, 7)];
    let [k, b] = tied();
    let free = [k.within(Bounds::Factors(0.9, 1.6)), b];
    let result = fit(&noisy, &Parameters::thesis(), &free, &with_intervals()).unwrap();
    assert!(result.groups[0].at_bound.is_none() && result.groups[0].interval[1].is_none(), "{:?}", result.groups[0]);
    let without = fit(&noisy, &Parameters::thesis(), &free, &FitOptions::default()).unwrap();
    assert_eq!(without.groups[0].interval, [None, None]);
    assert_eq!(without.groups[0].values, result.groups[0].values);
}

/// Where a proximal photodiode's offset turns round, as the stiffness changes, the derivatives at the best say that it
/// is known; its interval goes as far as it goes. Measured with 2 % noise: 231 of 400
/// offsets and scalings do; two standard errors are short in 7 of them, intervals in none.
#[test]
fn an_offset_that_turns_round_is_not_surer_for_it() {
    let recordings = phantom(&Kind::Proximal);
    let (mut turning, mut short, mut held) = (0, 0, 0);
    for seed in 0..200 {
        let noisy = [noisy(&recordings[0], 0.02, seed)];
        let result = fit(&noisy, &Parameters::thesis(), &tied(), &with_intervals()).expect("a fit");
        for (one, truth) in
            [(result.photodiodes[0].offset, OFFSETS_V[0]), (result.photodiodes[0].scaling, SCALINGS_V[0])]
        {
            if one.beyond_linear().is_some_and(|times| times > 3.0) {
                turning += 1;
                short += u32::from((one.value - truth).abs() > 2.0 * one.standard_error.unwrap_or(f64::NAN));
                held += u32::from(holds(&one, truth));
            }
        }
    }
    println!("{turning} turn round; two standard errors are short in {short}, intervals in {}", turning - held);
    assert!(turning > 0 && held >= turning - short && 20 * held >= 19 * turning, "{turning} {short} {held}");
}

/// Where all is straight intervals are two standard errors. Measured: 1.002 to 1.006.
#[test]
fn intervals_of_what_goes_straight_are_two_standard_errors() {
    for kind in [Kind::Distal, Kind::Both] {
        let noisy: Vec<Recording> = phantom(&kind).iter().zip(0..).map(|(one, k)| noisy(one, 0.001, k)).collect();
        let result = fit(&noisy, &Parameters::thesis(), &tied(), &with_intervals()).expect("a fit");
        for one in result.photodiodes.iter().flat_map(|diode| [diode.offset, diode.scaling]) {
            let times = one.beyond_linear().expect("an interval");
            println!("{times}");
            assert!((0.9..=1.1).contains(&times), "{times}");
        }
    }
}
