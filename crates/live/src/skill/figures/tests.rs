use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::*;

const THRESHOLDS: Thresholds = Thresholds { touch_n: 0.2, release_n: 0.1, hold_s: 0.05 };

/// A finger at `rate_hz` that presses in trapezoids: up in a tenth of a second, held, down in a fifth.
fn presses(rate_hz: f64, seconds: f64, of: &[(f64, f64, f64)]) -> Force {
    let at = |time_s: f64| {
        let one = |&(from_s, held_s, peak_n): &(f64, f64, f64)| {
            let since_s = time_s - from_s;
            let up = since_s / 0.1;
            let down = (0.1 + held_s + 0.2 - since_s) / 0.2;
            peak_n * up.min(down).clamp(0.0, 1.0)
        };
        of.iter().map(one).sum()
    };
    let time_s: Vec<f64> = (0..=(seconds * rate_hz) as usize).map(|k| k as f64 / rate_hz).collect();
    Force { force_n: time_s.iter().map(|&time_s| at(time_s)).collect(), time_s, lifted: Vec::new() }
}

#[test]
fn a_finger_that_never_touches_has_no_force_and_one_that_is_not_known_has_nothing() {
    let (idle, _) = Figures::of(&presses(50.0, 2.0, &[(0.5, 0.2, 0.15)]), &THRESHOLDS);
    assert_eq!((idle.presses, idle.contact_s, idle.impulse_ns), (Some(0), Some(0.0), Some(0.0)));
    assert_eq!((idle.peak_n, idle.mean_n, idle.peak_rise_n_per_s, idle.first_s), (None, None, None, None));
    let mut lost = presses(50.0, 2.0, &[(0.5, 0.2, 2.0)]);
    lost.force_n.fill(f64::NAN);
    let (lost, found) = Figures::of(&lost, &THRESHOLDS);
    assert_eq!((lost.presses, lost.contact_s, lost.impulse_ns, found.len()), (None, None, None, 0));
    let none = Force { time_s: Vec::new(), force_n: Vec::new(), lifted: Vec::new() };
    assert_eq!(Figures::of(&none, &THRESHOLDS).0.presses, None);
}

#[test]
fn forces_of_rows_that_a_gate_calls_lifted_are_not_looked_at() {
    let mut force = presses(100.0, 3.0, &[(0.5, 1.0, 2.0)]);
    force.lifted = force.time_s.iter().map(|time_s| !(0.7..=1.2).contains(time_s)).collect();
    let (rows, _): (Vec<usize>, Vec<()>) = (70..=120).map(|row| (row, ())).unzip();
    (0..force.force_n.len()).filter(|row| !rows.contains(row)).for_each(|row| force.force_n[row] = 99.0);
    let (figures, _) = Figures::of(&force, &THRESHOLDS);
    assert_eq!((figures.presses, figures.peak_n), (Some(1), Some(2.0)));
    assert!((figures.contact_s.unwrap() - 0.5).abs() <= 1e-9 && (figures.impulse_ns.unwrap() - 1.0).abs() <= 1e-9);
}

#[test]
fn fingers_are_ranked_by_their_first_touch() {
    let finger = |from_s: f64| Figures::of(&presses(100.0, 3.0, &[(from_s, 0.2, 2.0)]), &THRESHOLDS);
    let all = [finger(1.0), finger(0.5), finger(2.0), finger(0.5), finger(9.0)];
    let ranked = |all: &[(Figures, Vec<Contact>)]| {
        ranks(&all.iter().map(|(figures, contacts)| (figures, contacts.as_slice())).collect::<Vec<_>>())
    };
    assert_eq!(ranked(&all), [Some(3), Some(1), Some(4), Some(1), None]);
    // One of them was there before: who came first is not known.
    let mut held = presses(100.0, 3.0, &[(1.0, 0.2, 2.0)]);
    held.force_n[..20].fill(1.0);
    assert_eq!(ranked(&[finger(0.5), Figures::of(&held, &THRESHOLDS)]), [None, None]);
}

#[test]
fn a_press_is_as_smooth_at_any_time_of_the_day() {
    let smoothness = |from_s: f64| {
        let mut force = presses(100.0, 5.0, &[(0.5, 0.4, 2.0), (2.0, 0.3, 1.0)]);
        force.time_s.iter_mut().for_each(|time_s| *time_s += from_s);
        Figures::of(&force, &THRESHOLDS).0.smoothness.unwrap()
    };
    let first = smoothness(0.0);
    for from_s in [59.0, 3600.0, 34567.125, 50_000.0, 86_390.0] {
        assert!((smoothness(from_s) - first).abs() <= 1e-6, "{from_s}: {}", smoothness(from_s));
    }
}

/// Presses of minimum jerk (`strokes` in each, up and down) with noise of so many newtons.
fn strokes(rate_hz: f64, strokes: u32, peak_n: f64, noise_n: f64) -> Force {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let (all, step_s) = (f64::from(strokes), 0.8 / f64::from(strokes));
    let up = |u: f64| u.powi(3) * (10.0 + u * (6.0 * u - 15.0));
    let at = |time_s: f64| {
        let one = |k: u32| {
            let from_s = 1.0 + f64::from(k) * step_s;
            let part = |from_s: f64| up(((time_s - from_s) / (0.6 * step_s)).clamp(0.0, 1.0));
            (part(from_s) - part(from_s + 0.8)) / all
        };
        peak_n * (0..strokes).map(one).sum::<f64>()
    };
    let time_s: Vec<f64> = (0..(4.0 * rate_hz) as usize).map(|k| k as f64 / rate_hz).collect();
    let mut noise = || noise_n * Distribution::<f64>::sample(&StandardNormal, &mut random);
    Force { force_n: time_s.iter().map(|&time_s| at(time_s) + noise()).collect(), time_s, lifted: Vec::new() }
}

#[test]
fn a_noisy_transducer_and_a_weak_finger_are_as_smooth_as_others() {
    let of = |force: Force| Figures::of(&force, &THRESHOLDS).0.smoothness.unwrap();
    for count in [1, 4] {
        let clean = of(strokes(100.0, count, 2.0, 0.0));
        for (rate_hz, noise_n) in [(250.0, 0.0), (1000.0, 0.0), (1000.0, 0.003), (1000.0, 0.01)] {
            let found = of(strokes(rate_hz, count, 2.0, noise_n));
            println!("{count} {rate_hz} {noise_n}: {found} {clean}");
            assert!((found - clean).abs() <= 0.1, "{count} {rate_hz} {noise_n}: {found} {clean}");
        }
        // Steps before the threshold is crossed, and behind a pause, are no part of the press.
        let peaks_n: &[f64] = if count == 1 { &[0.5, 1.0, 20.0] } else { &[1.0, 20.0] };
        for &peak_n in peaks_n {
            let found = of(strokes(100.0, count, peak_n, 0.0));
            // What lies around differs by where thresholds are crossed.
            assert!((found - clean).abs() <= 1e-3, "{count} {peak_n}: {found} {clean}");
        }
    }
}
