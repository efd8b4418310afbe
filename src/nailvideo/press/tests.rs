use super::*;
use crate::trial::normals;

const RATE_HZ: f64 = 30.0;
const SEEDS: u64 = 150;

/// A press at 3 s and a release at 6 s, or none, in noise with first-order correlation `rho`.
fn trace(step: f64, taus: [f64; 2], release_s: f64, rho: f64, until_s: f64, seed: u64) -> (Vec<f64>, Vec<f64>) {
    let mut normal = normals(seed);
    let onset = 3.0 + (seed % 97) as f64 / 97.0 / RATE_HZ;
    let mut carried = 0.0;
    let time_s: Vec<f64> = (0..(until_s * RATE_HZ) as usize).map(|k| k as f64 / RATE_HZ).collect();
    let values = time_s.iter().map(|&t| {
        carried = rho * carried + (1.0 - rho * rho).sqrt() * normal();
        let rise = |at: f64, tau: f64| if t > at { 1.0 - (-(t - at) / tau).exp() } else { 0.0 };
        let reached = rise(onset, taus[0]).min(1.0);
        let level = if t > release_s { rise(onset, taus[0]) * (1.0 - rise(release_s, taus[1])) } else { reached };
        step * level + carried
    });
    (time_s.clone(), values.collect())
}

fn rows_of(time_s: &[f64], values: Vec<f64>) -> Vec<Row> {
    let still = vec![0.0; values.len()];
    rows_in_light(time_s, values, &still, &still)
}

fn rows_in_light(time_s: &[f64], values: Vec<f64>, skin: &[f64], red: &[f64]) -> Vec<Row> {
    let tint = vec![0.0; red.len()];
    rows_with(time_s, Trace { name: "P2".to_owned(), values, red: red.to_vec(), tint }, skin)
}

fn rows_with(time_s: &[f64], trace: Trace, skin: &[f64]) -> Vec<Row> {
    let traces = [trace];
    // Traces are of ratios as encoded, which a press changes 1.85 times less than those of light.
    let sd = [noise_sd(&traces[0].values)];
    rows(&Recording { time_s, traces: &traces, sd: &sd, ends: &[], skin, whole: 100.0 / 1.85 })
}

/// By how much onset and t90 of releases are off, and whether their intervals hold the truth; of each seed's trace
/// that has a course. The trace is given with its release, and t90.
fn errors(of_seed: impl Fn(u64) -> (Vec<f64>, Vec<f64>, f64) + Sync, t90_s: f64) -> Vec<[(f64, bool); 2]> {
    let errors = |seed: u64| {
        let (time_s, values, release_s) = of_seed(seed);
        let rows = rows_of(&time_s, values);
        // Not what waves of real blood look like elsewhere.
        let is_near = |row: &&Row| row.found_s.1.is_some_and(|found_s| (found_s - release_s).abs() < 2.0);
        let row = rows.iter().filter(is_near).find(|row| row.event == Event::Release)?;
        let course = row.course.as_ref().ok()?;
        let of = |one: fit::Interval, truth: f64| (one.value - truth, one.low <= truth && truth <= one.high);
        Some([of(course.onset_s, release_s), of(course.t90_s, t90_s)])
    };
    (0..SEEDS).into_par_iter().filter_map(errors).collect()
}

/// The share of the intervals that hold the truth.
fn held(errors: &[[(f64, bool); 2]], k: usize) -> f64 {
    errors.iter().filter(|one| one[k].1).count() as f64 / errors.len() as f64
}

/// Prints the figures of some courses. Of the onset, seconds, and of t90, a share of it: the median of the sizes of the
/// errors, and the share of the intervals that hold the truth.
fn figures(course: &str, errors: &[[(f64, bool); 2]], t90_s: f64) -> ([f64; 2], [f64; 2]) {
    let ([onset_s, t90], [onset_held, t90_held]) =
        ([median(errors, 0), median(errors, 1) / t90_s], [0, 1].map(|k| held(errors, k)));
    println!(
        "{course}: {} of {SEEDS}, onset {onset_s:.4} s, {onset_held:.3} held; t90 {:.1} %, {t90_held:.3} held",
        errors.len(),
        100.0 * t90,
    );
    ([onset_s, t90], [onset_held, t90_held])
}

fn median(errors: &[[(f64, bool); 2]], k: usize) -> f64 {
    let mut all: Vec<f64> = errors.iter().map(|one| one[k].0.abs()).collect();
    all.sort_by(f64::total_cmp);
    all[all.len() / 2]
}

#[test]
fn onsets_and_times_are_covered_by_their_intervals() {
    for (tau, rho) in [(0.1, 0.0), (0.3, 0.3), (0.6, 0.0), (1.5, 0.3), (3.0, 0.0)] {
        // Long enough for the slowest to end.
        let until_s = f64::max(20.0, 10.0 + 5.0 * tau);
        let t90_s = tau * 10.0_f64.ln();
        let of_seed = |seed: u64| {
            let release_s = 8.0 + (seed % 89) as f64 / 89.0 / RATE_HZ;
            let (time_s, values) = trace(25.0, [0.2, tau], release_s, rho, until_s, seed);
            (time_s, values, release_s)
        };
        let errors = errors(of_seed, t90_s);
        let ([onset_error_s, t90_error], [onset, t90]) = figures(&format!("tau {tau}, rho {rho}"), &errors, t90_s);
        assert!(errors.len() as u64 == SEEDS && onset_error_s <= 1.0 / RATE_HZ && t90_error <= 0.08);
        // What is counted from an onset has room for one that is seen late, which these aren't.
        assert!((0.90..=0.995).contains(&onset) && t90 >= 0.90, "{tau}");
    }
}

/// Courses that are not a step's: a release that takes 0.2 s, and one with a second, slow course, whose end the window
/// hardly shows where tau is 1.5 s. The intervals hold what they say.
#[test]
fn courses_of_other_shapes_are_off_by_less_than_a_sixth() {
    const PARTS: u32 = 40;
    let reached = |since_s: f64, tau: f64| 1.0 - (-since_s.max(0.0) / tau).exp();
    let ramp = |since_s: f64, tau: f64| {
        let part = |k: u32| reached(since_s - 0.2 * (f64::from(k) + 0.5) / f64::from(PARTS), tau);
        (0..PARTS).map(part).sum::<f64>() / f64::from(PARTS)
    };
    // The share that is slower, by how much, and the step in SDs of the noise; none for the ramp.
    let third = Some((0.2, 3.0, 25.0));
    let courses = [0.3, 0.6, 1.5].map(|tau| (None, tau)).into_iter();
    let courses = courses.chain([0.3, 0.6, 1.5].map(|tau| (third, tau)));
    for (slow, tau) in courses.chain([(Some((0.3, 5.0, 25.0)), 0.6), (Some((0.3, 5.0, 100.0)), 0.6)]) {
        let reached = |since_s: f64| match slow {
            None => ramp(since_s, tau),
            Some((share, by, _)) => (1.0 - share) * reached(since_s, tau) + share * reached(since_s, by * tau),
        };
        let step = slow.map_or(25.0, |(_, _, step)| step);
        let t90_s = (0..).map(|k| f64::from(k) * 1e-3).find(|&t| reached(t) >= 0.9).expect("it ends");
        let of_seed = |seed: u64| {
            let (time_s, mut values) = trace(step, [0.2, tau], f64::INFINITY, 0.0, 20.0, seed);
            values.iter_mut().zip(&time_s).for_each(|(value, t)| *value -= step * reached(t - 8.0));
            (time_s, values, 8.0)
        };
        let errors = errors(of_seed, t90_s);
        let [onset_s, t90] = [0, 1].map(|k| errors.iter().map(|one| one[k].0).sum::<f64>() / errors.len() as f64);
        println!(
            "{slow:?}, tau {tau}: {} of {SEEDS}; onset {onset_s:+.3} s, held {:.2}; t90 {:+.1} %, held {:.2}",
            errors.len(),
            held(&errors, 0),
            100.0 * t90 / t90_s,
            held(&errors, 1)
        );
        assert!(errors.len() as u64 == SEEDS && onset_s.abs() <= 0.12 && t90.abs() <= t90_s / 6.0, "{tau}");
        assert!(held(&errors, 0) >= 0.9 && held(&errors, 1) >= 0.9, "{slow:?} {tau}");
    }
}

/// Blood as it is: a pulse of 2 % of the step, slow waves of 5 %, each seed's at another moment of both, until 5 and
/// 12 s after the release.
#[test]
fn a_pulse_and_slow_waves_are_held() {
    const SD: f64 = 0.3;
    for (tau, pulse, wave, until_s) in [
        (0.3, 0.4, 0.0, 20.0),
        (0.3, 0.0, 1.0, 13.0),
        (0.3, 0.4, 1.0, 20.0),
        (0.6, 0.4, 1.0, 13.0),
        (0.6, 0.4, 0.5, 20.0),
        (1.5, 0.4, 1.0, 20.0),
    ] {
        let of_seed = |seed: u64| {
            let (time_s, mut values) = trace(20.0 / SD, [0.2, tau], 8.0, 0.0, until_s, seed);
            let phase = seed as f64 * 2.4;
            let hz = 0.9 + 0.4 * (seed as f64 * 0.618).fract();
            for (value, t) in values.iter_mut().zip(&time_s) {
                let beat = std::f64::consts::TAU * hz * t + phase;
                let heart = beat.sin() + 0.4 * (2.0 * beat + 0.7).sin();
                *value = SD * *value + pulse * heart + wave * (0.63 * t + 1.7 * phase).sin();
            }
            (time_s, values, 8.0)
        };
        let t90_s = tau * 10.0_f64.ln();
        let errors = errors(of_seed, t90_s);
        let course = format!("tau {tau}, pulse {pulse}, waves {wave}, until {until_s}");
        let ([_, t90], [onset_held, t90_held]) = figures(&course, &errors, t90_s);
        assert!(errors.len() as u64 == SEEDS && t90 <= 1.0 / 7.0, "{tau} {until_s}");
        // Measured 0.97 and more, 0.83 and more.
        assert!(onset_held >= 0.93 && t90_held >= 0.82, "{tau} {until_s}");
    }
}

/// A force that begins and ends smoothly, and colour that follows it: its onset is seen late at any rate of frames, and
/// what is counted from it is short by as much.
#[test]
fn forces_that_begin_smoothly_are_held_at_any_rate() {
    const PARTS: u32 = 60;
    for (rate_hz, rise_s) in [30.0, 60.0, 120.0].into_iter().flat_map(|hz| [(hz, 0.2), (hz, 0.4)]) {
        let reached = |since_s: f64| {
            // The force's steps, each of which the colour follows.
            let part = |k: u32| {
                let [from, to] = [k, k + 1].map(|k| f64::from(k) / f64::from(PARTS));
                let step = lunula_predictor::smooth(to) - lunula_predictor::smooth(from);
                step * (1.0 - (-(since_s - rise_s * 0.5 * (from + to)).max(0.0) / 0.15).exp())
            };
            (0..PARTS).map(part).sum::<f64>()
        };
        let truth = [0.5, 0.9].map(|share| (0..).map(|k| f64::from(k) * 1e-3).find(|&t| reached(t) >= share).unwrap());
        let (mut held, mut late_s) = ([0; 3], 0.0);
        for seed in 0..100 {
            let mut normal = normals(seed);
            let onset_s = seed as f64 / 100.0 / rate_hz;
            let time_s: Vec<f64> = (0..(5.0 * rate_hz) as usize).map(|k| k as f64 / rate_hz - 2.0).collect();
            let values: Vec<f64> = time_s.iter().map(|t| 60.0 * reached(t - onset_s) + normal()).collect();
            let course = fit(&time_s, &values, 0.1, None).expect("a course");
            let of = [(course.onset_s, onset_s), (course.t50_s, truth[0]), (course.t90_s, truth[1])];
            of.iter()
                .zip(&mut held)
                .for_each(|((one, truth), held)| *held += usize::from((one.low..=one.high).contains(truth)));
            late_s += (course.onset_s.value - onset_s) / 100.0;
        }
        println!("{rate_hz} Hz, {rise_s} s: {late_s:.3} s late, held {held:?} of 100");
        assert!(held.iter().all(|held| *held >= 90), "{rate_hz} {rise_s} {held:?}");
    }
}

#[test]
fn a_ramp_shorter_than_a_frame_has_an_onset() {
    const PARTS: u32 = 20;
    let (mut held, mut widest) = (0, 0.0);
    for seed in 0..100 {
        let mut normal = normals(seed);
        let onset_s = seed as f64 / 100.0 / RATE_HZ;
        let ramp_s = (seed % 5 + 1) as f64 / 5.0 / RATE_HZ;
        let time_s: Vec<f64> = (-60..90).map(|k| f64::from(k) / RATE_HZ).collect();
        let values = time_s.iter().map(|t| {
            let since_s = |part: u32| t - onset_s - ramp_s * (f64::from(part) + 0.5) / f64::from(PARTS);
            let reached = (0..PARTS).map(|part| 1.0 - (-since_s(part).max(0.0) / 0.2).exp());
            100.0 * reached.sum::<f64>() / f64::from(PARTS) + normal()
        });
        let onset = fit(&time_s, &values.collect::<Vec<f64>>(), 0.0, None).expect("a course").onset_s;
        held += usize::from(onset.low <= onset_s && onset_s <= onset.high);
        widest = f64::max(widest, onset.high - onset.low);
    }
    println!("{held} of 100 held, widest interval {widest:.3} s");
    assert!(held >= 90 && widest <= 0.2, "{held} {widest}");
}

#[test]
fn a_video_without_a_press_gives_no_figures() {
    for seed in 0..300 {
        let (time_s, mut values) = trace(0.0, [0.2, 0.2], 8.0, 0.5, 20.0, seed);
        assert!(rows_of(&time_s, values.clone()).iter().all(Row::is_refused), "{seed}");
        // Vasomotion of 0.1 Hz and a gap.
        for (value, t) in values.iter_mut().zip(&time_s) {
            *value += 1.5 * (0.6 * t).sin();
        }
        values[200..260].fill(f64::NAN);
        assert!(rows_of(&time_s, values).iter().all(Row::is_refused), "{seed}");
    }
}

#[test]
fn what_does_not_end_or_is_not_seen_is_refused() {
    // Never let go.
    let (time_s, values) = trace(20.0, [0.2, 0.3], f64::INFINITY, 0.0, 12.0, 1);
    let rows = rows_of(&time_s, values);
    assert!(rows.len() == 1 && rows[0].event == Event::Press && rows[0].course.is_ok(), "{rows:?}");
    assert_eq!(rows[0].pressed_s, None);
    // The video ends before the blood is back.
    let (time_s, values) = trace(20.0, [0.2, 3.0], 8.0, 0.0, 11.0, 2);
    let rows = rows_of(&time_s, values);
    assert!(rows[1].status().contains("not seen"), "{}", rows[1].status());
    assert_eq!(rows[1].times_s(), [None; 4]);
    // A tenth of the samples, and a fifth.
    let (time_s, values) = trace(20.0, [0.2, 0.3], 8.0, 0.0, 12.0, 3);
    let mut lost = values.clone();
    (0..lost.len()).filter(|k| k % 5 == 0).for_each(|k| lost[k] = f64::NAN);
    let rows = rows_of(&time_s, lost);
    assert!(rows.iter().all(|row| row.status().contains("missing")), "{:?}", rows[0].status());
    // The skin changes as the nail does: a lamp was switched; or red at the place more than green over red: glare.
    let still = vec![0.0; values.len()];
    for (skin, red) in [(&values, &still), (&still, &values)] {
        let rows = rows_in_light(&time_s, values.clone(), skin, red);
        assert!(rows.iter().all(|row| row.status().contains("light")), "{:?}", rows[0].status());
    }
    // Glare that goes over it for a second of the press, as high as a part of the step.
    for (part, is_refused) in [(0.05, false), (0.2, true)] {
        let of_glare = |time_s: &f64| if (4.0..5.0).contains(time_s) { part * 15.0 } else { 0.0 };
        let tint = time_s.iter().map(of_glare).collect();
        let trace = Trace { name: "P2".to_owned(), values: values.clone(), red: still.clone(), tint };
        let rows = rows_with(&time_s, trace, &still);
        assert_eq!(rows[0].status().contains("glare or coloured light"), is_refused, "{}", rows[0].status());
    }
}

#[test]
fn a_press_in_a_trace_of_two_has_its_length() {
    let (time_s, values) = trace(15.0, [0.2, 0.3], 8.0, 0.0, 14.0, 5);
    let rows = rows_of(&time_s, values);
    let onset = 3.0 + 5.0 / 97.0 / RATE_HZ;
    assert_eq!(rows.len(), 2);
    assert!((rows[0].pressed_s.unwrap() - (8.0 - onset)).abs() <= 0.05, "{:?}", rows[0].pressed_s);
    assert!((rows[1].depth().unwrap() + 15.0).abs() <= 0.5);
}

#[test]
fn each_quick_tap_is_a_press() {
    for (held_s, pause_s) in [(0.2, 0.3), (0.3, 0.4), (0.5, 0.5), (0.5, 0.7)] {
        for seed in 0..20 {
            let onset_s = |tap: u32| 2.0 + f64::from(tap) * (held_s + pause_s) + (seed % 7) as f64 / 7.0 / RATE_HZ;
            let mut normal = normals(seed);
            let mut level = 0.0;
            let time_s: Vec<f64> = (0..360).map(|k| f64::from(k) / RATE_HZ).collect();
            let values = time_s.iter().map(|&t| {
                let is_pressed = (0..8).any(|tap| (onset_s(tap)..onset_s(tap) + held_s).contains(&t));
                // The colour follows with a time constant of 0.15 s.
                level += (f64::from(u8::from(is_pressed)) - level) * (1.0 - (-1.0 / RATE_HZ / 0.15_f64).exp());
                25.0 * level + normal()
            });
            let rows = rows_of(&time_s, values.collect());
            let presses: Vec<&Row> = rows.iter().filter(|row| row.event == Event::Press).collect();
            assert!(presses.len() == 8 && rows.len() == 16, "{held_s} {pause_s} {seed}: {}", rows.len());
            for (tap, press) in (0..).zip(presses) {
                let (from_s, to_s) = press.span_s().expect("each is let go");
                let off_s = [from_s - onset_s(tap), to_s - onset_s(tap) - held_s];
                // A release is seen late by what the means hold of the next press.
                assert!(off_s.iter().all(|off_s| off_s.abs() <= 0.2), "{held_s} {pause_s} {seed}: {off_s:?}");
            }
        }
    }
}

#[test]
fn what_an_encoder_leaves_for_a_while_is_no_press() {
    let time_s: Vec<f64> = (0..300).map(|k| f64::from(k) / RATE_HZ).collect();
    // Of eight photodiodes so many are off by 4 for two seconds; their noise from frame to frame is small.
    let still = vec![0.0; time_s.len()];
    let found = |changed: usize, sd: f64| {
        let one = |k: usize| {
            let mut normal = normals(k as u64);
            let off = |t: f64| if k < changed && (3.0..5.0).contains(&t) { 4.0 } else { 0.0 };
            let values: Vec<f64> = time_s.iter().map(|&t| off(t) + 0.1 * normal()).collect();
            Trace { name: format!("P{}", k + 1), red: vec![0.0; 300], tint: vec![0.0; 300], values }
        };
        let (traces, sd) = ((0..8).map(one).collect::<Vec<_>>(), [Some(sd); 8]);
        rows(&Recording { time_s: &time_s, traces: &traces, sd: &sd, ends: &[], skin: &still, whole: 100.0 })
    };
    assert_eq!([found(1, 0.1), found(1, 1.4), found(8, 1.4)].map(|rows| rows.len()), [16, 0, 16]);
    let shallow = |sd: f64| {
        let is_shallow = |row: &&Row| row.course.as_ref().is_err_and(|why| why.why.contains("6 standard errors"));
        found(8, sd).iter().filter(is_shallow).count()
    };
    assert_eq!([0.6, 0.8].map(shallow), [0, 16]);
}

#[test]
fn a_video_that_begins_while_the_finger_presses_is_doubted() {
    let (time_s, values) = trace(15.0, [0.2, 0.3], 8.0, 0.0, 14.0, 5);
    let said = |proximal: f64, distal: f64| {
        let end = |name: &str, part: f64| {
            let values: Vec<f64> = values.iter().map(|value| part * value).collect();
            Trace { name: name.to_owned(), red: vec![0.0; values.len()], tint: vec![0.0; values.len()], values }
        };
        let (ends, still) = ([end("distal", distal), end("proximal", proximal)], vec![0.0; values.len()]);
        let traces = [end("P3", proximal)];
        let sd = [noise_sd(&traces[0].values)];
        let of = Recording { time_s: &time_s, traces: &traces, sd: &sd, ends: &ends, skin: &still, whole: 100.0 };
        reversed(&rows(&of))
    };
    assert_eq!(said(-1.0, 0.6), None);
    assert!(said(1.0, -0.6).is_some_and(|said| said.starts_with("each of 1 press(es) looks like a release")));
    // Both ends up is another thing.
    assert_eq!(said(1.0, 0.6), None);
}

mod real_data {
    use super::*;
    use crate::real_data::real_data;

    /// Red of a fingertip on a camera, 100 ln, at the tests' rate: pulse, and slow waves that are 1.2 to 2.4 times as
    /// high. Without the first seconds, in which the camera finds its exposure.
    fn blood(subject: usize) -> Vec<f64> {
        let path = real_data(&format!("signals/welltory/subject_0{subject}/PPG.csv"));
        let text = std::fs::read_to_string(path).unwrap();
        let row = |line: &str| {
            let mut cells = line.split(',').map(|cell| cell.parse::<f64>().unwrap());
            (cells.next().unwrap() / 1000.0, 100.0 * cells.next().unwrap().ln())
        };
        let rows: Vec<(f64, f64)> = text.lines().skip(1).map(row).collect();
        let times_s = (0..).map(|k| rows[0].0 + 8.0 + f64::from(k) / RATE_HZ);
        let at = |t: f64| {
            let after = rows.partition_point(|row| row.0 < t);
            let ((t0, v0), (t1, v1)) = (rows[after - 1], *rows.get(after)?);
            Some(v0 + (v1 - v0) * (t - t0) / (t1 - t0))
        };
        times_s.map_while(at).collect()
    }

    /// Exact courses, a step of 20 of 100 ln, in noise of 0.3 and in real blood, so high that its pulse has 0.4
    /// (assumed: nails have not been measured). These recordings chose nothing.
    #[test]
    #[ignore = "needs real recordings: LUNULA_REAL_DATA"]
    fn courses_in_real_blood_are_held() {
        const SD: f64 = 0.3;
        let subjects = [(1, 2.2), (2, 0.9), (3, 3.0)].map(|(subject, by)| (blood(subject), by));
        for (tau, until_s) in [(0.3, 13.0), (0.3, 20.0), (0.6, 13.0), (0.6, 20.0), (1.5, 20.0)] {
            let of_seed = |seed: u64| {
                let (time_s, mut values) = trace(20.0 / SD, [0.2, tau], 8.0, 0.0, until_s, seed);
                let (blood, by) = &subjects[seed as usize % 3];
                let from = (seed as usize * 7919) % (blood.len() - values.len());
                for (value, blood) in values.iter_mut().zip(&blood[from..]) {
                    *value = SD * *value + by * blood;
                }
                (time_s, values, 8.0)
            };
            let t90_s = tau * 10.0_f64.ln();
            let errors = errors(of_seed, t90_s);
            let course = format!("tau {tau}, until {until_s}");
            let ([_, t90], [onset_held, t90_held]) = figures(&course, &errors, t90_s);
            // At 1.5 s the end is not seen in one of eight.
            assert!(errors.len() as u64 * 10 >= SEEDS * 8 && t90 <= 1.0 / 6.0, "{tau} {until_s}");
            // Measured 0.93 and more, 0.89 and more.
            assert!(onset_held >= 0.9 && t90_held >= 0.88, "{tau} {until_s}");
        }
    }
}
