//! The switch at every phase of a press, against Rice's formula, and chosen from traces whose truth is known.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::*;

const PERIOD_S: f64 = 0.01;

fn reading(value: f64) -> Reading {
    Reading { value, outside: false }
}

/// Events of values that come every 10 ms.
fn run(config: &SwitchConfig, values: impl IntoIterator<Item = f64>) -> Vec<(i64, Turn, Reason)> {
    let mut switch = Switch::new(config.clone());
    let rows = values.into_iter().enumerate();
    let events = rows.filter_map(|(k, value)| switch.sample(k as f64 * PERIOD_S, reading(value)));
    events.map(|event| ((event.t_s / PERIOD_S).round() as i64, event.turn, event.reason)).collect()
}

/// Rest, a press of 20 samples at 1 N from sample 10 on, rest.
fn press(k: i64) -> f64 {
    if (10..30).contains(&k) { 1.0 } else { 0.0 }
}

fn held() -> SwitchConfig {
    SwitchConfig { hold_on_s: 0.03, hold_off_s: 0.02, watchdog_s: 0.05, ..SwitchConfig::of(0.5, 0.3) }
}

#[test]
fn thresholds_and_holds_decide_when_it_turns() {
    use Reason::Value;
    use Turn::{Press, Release};
    let plain = SwitchConfig::of(0.5, 0.3);
    assert_eq!(run(&plain, (0..50).map(press)), [(10, Press, Value), (30, Release, Value)]);
    assert_eq!(run(&held(), (0..50).map(press)), [(13, Press, Value), (32, Release, Value)]);
    // Between the thresholds nothing turns; exactly at on_N it presses, exactly at off_N it stays.
    let values = [0.0, 0.4, 0.5, 0.4, 0.3, 0.29, 0.4, 0.49, 0.5];
    assert_eq!(run(&plain, values), [(2, Press, Value), (5, Release, Value), (8, Press, Value)]);
    // A hold that is broken begins again.
    let broken = (0..60).map(|k| if k == 12 { 0.4 } else { press(k) });
    assert_eq!(run(&held(), broken)[0], (16, Press, Value));
}

#[test]
fn what_is_pressed_at_the_start_has_to_be_let_go_first() {
    let config = SwitchConfig::of(0.5, 0.3);
    assert_eq!(run(&config, [1.0, 1.0, 0.4, 1.0]), []);
    assert_eq!(run(&config, [1.0, 0.2, 1.0]), [(2, Turn::Press, Reason::Value)]);
}

#[test]
fn a_lockout_delays_and_with_rearm_asks_for_a_release() {
    use Turn::{Press, Release};
    let turns = |rearm: bool| {
        let config = SwitchConfig { lockout_s: 0.05, rearm, ..SwitchConfig::of(0.5, 0.3) };
        let value = |k: i64| if (1..5).contains(&k) || (7..20).contains(&k) { 1.0 } else { 0.0 };
        run(&config, (0..30).map(value)).into_iter().map(|(k, turn, _)| (k, turn)).collect::<Vec<_>>()
    };
    assert_eq!(turns(false), [(1, Press), (5, Release), (10, Press), (20, Release)]);
    assert_eq!(turns(true), [(1, Press), (5, Release)]);
}

#[test]
fn beyond_the_trained_voltages_nothing_presses() {
    let config = |outside| SwitchConfig { outside, watchdog_s: 0.03, ..SwitchConfig::of(0.5, 0.3) };
    let turns = |outside, beyond: std::ops::Range<i64>| {
        let mut switch = Switch::new(config(outside));
        let rows = (0..50).filter_map(|k| {
            let reading = Reading { value: press(k), outside: beyond.contains(&k) };
            switch.sample(k as f64 * PERIOD_S, reading)
        });
        rows.map(|event| ((event.t_s / PERIOD_S).round() as i64, event.turn, event.reason)).collect::<Vec<_>>()
    };
    use Turn::{Press, Release};
    // Off: as any other.
    assert_eq!(turns(None, 5..50).len(), 2);
    // Released at once, and the finger that still presses when the voltages are back does not press.
    let whole = (10, Press, Reason::Value);
    assert_eq!(turns(Some(Outside::Release), 15..20), [whole, (15, Release, Reason::Outside)]);
    // Back within them the press counts from then on.
    let late = [(20, Press, Reason::Value), (30, Release, Reason::Value)];
    assert_eq!(turns(Some(Outside::Release), 5..20), late);
    // As if nothing came: the watchdog, three samples after the last.
    assert_eq!(turns(Some(Outside::Ignore), 15..40), [whole, (17, Release, Reason::Watchdog)]);
    assert_eq!(turns(Some(Outside::Ignore), 15..17), [whole, (30, Release, Reason::Value)]);
}

/// At every phase of a press the sensor fails in every way: it lets go in time, always, and what still presses on
/// return does not press.
#[test]
fn no_fault_at_any_phase_leaves_it_pressed() {
    enum Fault {
        Stall,
        Nan,
        Lost,
        Back,
        Leap,
    }
    let watchdog_s = held().watchdog_s;
    let mut cases = 0;
    for fault in [Fault::Stall, Fault::Nan, Fault::Lost, Fault::Back, Fault::Leap] {
        for phase in 0..40 {
            for length in 6..30 {
                let mut switch = Switch::new(held());
                let (mut pressed_at_fault, mut free_s) = (false, None);
                let mut hear = |event: Option<SwitchEvent>| {
                    if let Some(event) = event
                        && event.turn == Turn::Release
                    {
                        free_s = Some(event.t_s);
                    }
                };
                for k in 0..phase {
                    hear(switch.sample(k as f64 * PERIOD_S, reading(press(k))));
                    pressed_at_fault = switch.is_pressed();
                }
                let (begin_s, end_s) = ((phase - 1) as f64 * PERIOD_S, (phase + length) as f64 * PERIOD_S);
                match fault {
                    Fault::Stall => {
                        let due_s = switch.due_s();
                        assert!(due_s.is_none_or(|due_s| due_s <= begin_s + watchdog_s + 1e-9));
                        hear(switch.advance(end_s));
                    }
                    Fault::Nan => {
                        for k in phase..phase + length {
                            hear(switch.sample(k as f64 * PERIOD_S, reading(f64::NAN)));
                        }
                    }
                    Fault::Lost => hear(switch.lose(begin_s, Reason::Lost)),
                    Fault::Back => hear(switch.sample(begin_s - 100.0, reading(1.0))),
                    Fault::Leap => hear(switch.sample(begin_s + 1000.0, reading(1.0))),
                }
                assert!(!switch.is_pressed(), "phase {phase}, {length} samples");
                if pressed_at_fault && !matches!(fault, Fault::Back) {
                    let free_s = free_s.expect("an event");
                    assert!(free_s <= begin_s + watchdog_s + PERIOD_S + 1e-9, "{free_s} after {begin_s}");
                }
                // Back, and still pressing: never a press until it was let go.
                let later_s = 2000.0;
                let still = (0..20).filter_map(|k| switch.sample(later_s + k as f64 * PERIOD_S, reading(1.0)));
                assert!(still.count() == 0);
                let again = [0.0, 1.0, 1.0, 1.0, 1.0];
                let again = again.iter().enumerate();
                let again: Vec<_> = again
                    .filter_map(|(k, value)| switch.sample(later_s + 1.0 + k as f64 * PERIOD_S, reading(*value)))
                    .collect();
                assert!(matches!(again[..], [SwitchEvent { turn: Turn::Press, .. }]), "{again:?}");
                cases += 1;
            }
        }
    }
    assert_eq!(cases, 5 * 40 * 24);
}

/// A press comes only where the value was at on_N for the hold, and every press has its release.
#[test]
fn random_streams_never_break_the_rules() {
    use rand::RngExt;
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let mut presses = 0;
    for _ in 0..2000 {
        let config = SwitchConfig {
            hold_on_s: rng.random_range(0.0..0.05),
            hold_off_s: rng.random_range(0.0..0.05),
            lockout_s: rng.random_range(0.0..0.1),
            rearm: rng.random_bool(0.5),
            watchdog_s: rng.random_range(0.02..0.2),
            outside: [None, Some(Outside::Ignore), Some(Outside::Release)][rng.random_range(0..3)],
            ..SwitchConfig::of(0.5, 0.3)
        };
        let mut switch = Switch::new(config.clone());
        let (mut t_s, mut pressed, mut valid_s, mut value) = (0.0, false, f64::NEG_INFINITY, 0.0f64);
        for _ in 0..500 {
            t_s += if rng.random_bool(0.02) { rng.random_range(-1.0..1.0) } else { PERIOD_S };
            value = (value + rng.random_range(-0.3..0.3)).clamp(-0.5, 1.5);
            let seen = if rng.random_bool(0.05) { f64::NAN } else { value };
            let outside = rng.random_bool(0.05);
            let event = switch.sample(t_s, Reading { value: seen, outside });
            if let Some(event) = event {
                let press = event.turn == Turn::Press;
                assert_ne!(press, pressed, "presses and releases alternate");
                assert!(!press || (seen >= 0.5 && !(outside && config.outside.is_some())));
                (pressed, presses) = (press, presses + usize::from(press));
            }
            if seen.is_finite() && !(outside && config.outside == Some(Outside::Ignore)) {
                valid_s = t_s;
            }
            assert!(!switch.is_pressed() || t_s - valid_s <= config.watchdog_s + 1e-6);
            assert_eq!(switch.is_pressed(), pressed);
        }
    }
    assert!(presses > 5000, "{presses}");
}

/// A Gaussian error of a flat spectrum from 0 to `HIGH_HZ`, sampled at 100 Hz: it goes up through zero HIGH_HZ /
/// sqrt(3) times a second.
fn gaussian(seed: u64, samples: usize) -> Vec<f64> {
    const WAVES: usize = 400;
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut value = vec![0.0; samples];
    for k in 0..WAVES {
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let (a, b) = (normal(), normal());
        let radians = std::f64::consts::TAU * HIGH_HZ * (k as f64 + 0.5) / WAVES as f64 * PERIOD_S;
        let (turn_sin, turn_cos) = radians.sin_cos();
        let (mut sin, mut cos) = (0.0, 1.0);
        for value in &mut value {
            *value += a * cos + b * sin;
            (sin, cos) = (sin * turn_cos + cos * turn_sin, cos * turn_cos - sin * turn_sin);
        }
    }
    let size = (WAVES as f64).sqrt();
    value.iter_mut().for_each(|value| *value /= size);
    value
}
const HIGH_HZ: f64 = 1.8;

#[test]
fn false_switches_of_a_gaussian_error_are_as_many_as_rices_formula_says() {
    let up_hz = HIGH_HZ / 3f64.sqrt();
    let noise = NoiseRate { mean_n: 0.0, sd_n: 1.0, up_hz };
    assert!((crossings_per_hour(NoiseRate { up_hz: 1.05, ..noise }, 2.0) - 511.6).abs() <= 0.1);
    // Waves repeat after WAVES / HIGH_HZ = 222 s: a seed is one stretch of that length.
    let samples = 22_000;
    let hours = samples as f64 * PERIOD_S / 3600.0;
    let seeds: Vec<Vec<f64>> = (0..120).map(|seed| gaussian(seed, samples)).collect();
    let found = NoiseRate::of(&seeds[0], hours * 3600.0).unwrap();
    assert!((found.sd_n - 1.0).abs() <= 0.1 && (found.up_hz / up_hz - 1.0).abs() <= 0.15, "{found:?}");
    for level in [2.0, 2.5, 3.0] {
        // Let go a hair below: each crossing is a switch.
        let config = SwitchConfig::of(level, level);
        let presses = |values: &Vec<f64>| {
            run(&config, values.iter().copied()).iter().filter(|event| event.1 == Turn::Press).count()
        };
        let counted: usize = seeds.iter().map(presses).sum();
        let expected = crossings_per_hour(noise, level) * hours * seeds.len() as f64;
        println!("at {level} s: {counted} of {expected:.1} expected");
        // Crossings come in clusters: 3 Poisson errors.
        assert!((counted as f64 - expected).abs() <= 3.0 * expected.sqrt(), "{level}: {counted}, {expected}");
    }
}

#[test]
fn how_far_values_follow_contact_is_found() {
    let late_by = |late_s: f64| {
        let plain = trace(1, 60.0);
        let mut late = Trace { contacts: Contacts::default(), ..plain.clone() };
        for (k, t_s) in plain.time_s.iter().enumerate() {
            late.contacts.push(*t_s, plain.contacts.touches(t_s + late_s), k == 0);
        }
        Lag::of(&late).map(|lag| lag.by_s)
    };
    let by_s = late_by(0.0).unwrap();
    assert!((0.0..=0.12).contains(&by_s), "a low-pass of 0.1 s: {by_s}");
    for late_s in [0.3, 0.5, -0.3] {
        let shifted = late_by(late_s).unwrap();
        assert!((shifted - by_s - late_s).abs() < 0.05, "{shifted} of {late_s}");
    }
    let few = Trace { begins: vec![0], ..trace(1, 20.0) };
    assert_eq!(Lag::of(&few), None);
    let plain = trace(1, 60.0);
    let noise = (0..plain.value.len()).map(|k| (k * 7919 % 101) as f64).collect();
    assert_eq!(Lag::of(&Trace { value: noise, ..plain }), None);
}

/// Contacts of 0.4 s every 5 s; the value follows 0.1 s late to 1 N, with noise of 0.05 N.
fn trace(seed: u64, seconds: f64) -> Trace {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut trace = Trace { begins: vec![0], ..Trace::default() };
    let mut value = 0.0;
    for k in 0..(seconds / PERIOD_S) as usize {
        let t_s = k as f64 * PERIOD_S;
        let touches = t_s % 5.0 >= 4.0 && t_s % 5.0 < 4.4;
        value += (f64::from(u8::from(touches)) - value) * (1.0 - (-PERIOD_S / 0.1f64).exp());
        let noise: f64 = StandardNormal.sample(&mut rng);
        trace.time_s.push(t_s);
        trace.value.push(value + 0.05 * noise);
        trace.outside.push(false);
        trace.contacts.push(t_s, Some(touches), k == 0);
    }
    trace
}

#[test]
fn false_switches_misses_and_delays_are_counted() {
    let trace = trace(1, 100.0);
    let all = Evaluation::of(&SwitchConfig::of(0.5, 0.3), std::slice::from_ref(&trace));
    assert_eq!((all.presses, all.missed, all.false_switches), (20, 0, 0), "{all:?}");
    // 1 - exp(-t / 0.1) comes to 0.5 after 0.069 s, and falls below 0.3 of 0.98 after 0.118 s.
    let (on, off) = (all.delay_on_s.unwrap(), all.delay_off_s.unwrap());
    assert!((on.median - 0.065).abs() <= 0.015 && (off.median - 0.115).abs() <= 0.02, "{on:?} {off:?}");
    let rate = all.rate.unwrap();
    assert!(rate.false_per_hour == 0.0 && (rate.false_per_hour_high - 2.9957 * 36.0).abs() <= 0.2, "{rate:?}");
    let none = Evaluation::of(&SwitchConfig::of(2.0, 1.0), std::slice::from_ref(&trace));
    assert_eq!((none.decisions, none.missed, none.delay_on_s), (0, 20, None));
    assert!(none.misses_more_than(0.5) && !none.misses_more_than(1.0) && !all.misses_more_than(0.0));
    // Three of 20 are no more than 0.15 by chance; by a thousandth they are not.
    let some = Evaluation { missed: 3, ..all.clone() };
    assert!(!some.misses_more_than(0.05) && some.misses_more_than(0.01), "0.0755 and 0.0010 by R's pbinom");
    // In the noise it presses again and again.
    let noisy = Evaluation::of(&SwitchConfig::of(0.06, 0.05), std::slice::from_ref(&trace));
    assert!(noisy.false_switches > 200 && noisy.missed == 0, "{noisy:?}");
}

#[test]
fn contacts_at_gaps_and_ends_are_not_held_against_the_switch() {
    let mut contacts = Contacts::default();
    let rows = [(0.0, 1), (0.1, 1), (0.2, 0), (0.4, 1), (0.5, 0), (0.55, 1), (0.6, 0), (0.8, 1), (2.0, 1), (2.1, 0)];
    for (k, (t_s, touches)) in rows.into_iter().enumerate() {
        contacts.push(t_s, Some(touches == 1), k == 0);
    }
    let known: Vec<_> = contacts.contacts.iter().map(|one| (one.start_known, one.end_known)).collect();
    // Already touching; whole (two closer than 0.1 s are one); into a gap; out of one.
    assert_eq!(known, [(false, true), (true, true), (true, false), (false, true)]);
    assert_eq!((contacts.contacts[1].start_s, contacts.contacts[1].end_s), (0.4, 0.6));
    assert!((contacts.seconds - 0.9).abs() <= 1e-12);
}

#[test]
fn what_begins_while_contact_is_not_known_is_not_judged() {
    let (whole, config) = (trace(1, 100.0), SwitchConfig::of(0.5, 0.3));
    // Of two presses of twenty nothing is known, of one more only its beginning.
    let known = |t_s: f64| !(20.0..32.0).contains(&t_s) && !(34.3..35.0).contains(&t_s);
    let mut partly = Trace { contacts: Contacts::default(), ..whole.clone() };
    for &t_s in &whole.time_s {
        let touches = t_s % 5.0 >= 4.0 && t_s % 5.0 < 4.4;
        partly.contacts.push(t_s, known(t_s).then_some(touches), t_s == 0.0);
    }
    let all = Evaluation::of(&config, &[partly]);
    assert_eq!((all.decisions, all.presses, all.not_judged, all.missed, all.false_switches), (20, 17, 2, 0, 0));
    assert_eq!(all.cut_off, 1);
    assert!((all.unknown_s - 12.72).abs() <= 1e-6 && (3600.0 * all.hours - 87.27).abs() <= 1e-6, "{all:?}");
    let all = Evaluation::of(&config, &[whole]);
    assert_eq!((all.not_judged, all.unknown_s), (0, 0.0));
}

#[test]
fn rows_that_do_not_say_it_between_rows_that_say_the_same_cost_nothing() {
    let (whole, config) = (trace(1, 100.0), SwitchConfig::of(0.5, 0.3));
    // A row amid each contact, for 0.08 s in another, for 0.12 s in a third.
    let known = |k: usize| k % 500 != 420 && !(405..413).contains(&k) && !(905..917).contains(&k);
    let mut partly = Trace { contacts: Contacts::default(), ..whole.clone() };
    for (k, &t_s) in whole.time_s.iter().enumerate() {
        partly.contacts.push(t_s, known(k).then_some(t_s % 5.0 >= 4.0 && t_s % 5.0 < 4.4), k == 0);
    }
    let (all, of_whole) = (Evaluation::of(&config, &[partly]), Evaluation::of(&config, &[whole]));
    assert_eq!((all.presses, all.cut_off, of_whole.presses, of_whole.cut_off), (19, 2, 20, 0), "{all:?}");
    assert_eq!((all.missed, all.false_switches, all.repeated), (0, 0, 0), "{all:?}");
    assert!((all.unknown_s - 0.13).abs() <= 1e-9, "{all:?}");
    assert!((3600.0 * (of_whole.hours - all.hours) - 0.13).abs() <= 1e-9, "{all:?}");
}

#[test]
fn thresholds_are_chosen_for_a_rate_and_hold_elsewhere() {
    let traces: Vec<Trace> = (0..4).map(|seed| trace(seed, 900.0)).collect();
    let goal = Goal { false_per_hour: 1.0, missed_share: 0.01, watchdog_s: 0.2, outside: Some(Outside::Release) };
    let tuned = tune(&traces, &goal).unwrap();
    let (config, on) = (&tuned.chosen.config, &tuned.chosen.evaluation);
    println!("{config:?} {on:?} held out {:?}", tuned.held_out);
    assert!(on.false_switches <= 1 && on.missed == 0 && on.delay_on_s.unwrap().median <= 0.05, "{on:?}");
    assert!((config.watchdog_s, config.outside, config.rearm) == (0.2, goal.outside, true));
    // Four SD of the noise, 0.2 N, without a hold; or less with one.
    assert!((0.1..0.4).contains(&config.on_n), "{config:?}");
    let fresh: Vec<Trace> = (10..20).map(|seed| trace(seed, 900.0)).collect();
    let fresh = Evaluation::of(config, &fresh);
    println!("{fresh:?}");
    assert!(fresh.false_switches <= 8 && fresh.missed == 0, "{fresh:?}");
    assert!(tuned.held_out.unwrap().rate.unwrap().false_per_hour <= 5.0);
    let noise = tuned.noise.unwrap();
    assert!((noise.sd_n - 0.05).abs() <= 0.005, "{noise:?}");
    // The curve: fewer false switches cost time.
    let curve: Vec<_> = tuned
        .curve
        .iter()
        .map(|one| (one.evaluation.false_switches, one.evaluation.delay_on_s.unwrap().mean))
        .collect();
    assert!(curve.len() >= 3 && curve.windows(2).all(|pair| pair[0].0 < pair[1].0 && pair[0].1 > pair[1].1));
}

#[test]
fn a_goal_that_cannot_be_reached_is_refused_with_the_nearest() {
    let mut hopeless = trace(1, 300.0);
    hopeless.value.iter_mut().enumerate().for_each(|(k, value)| *value = ((k * 7919) % 100) as f64 * 0.01);
    let goal = Goal { false_per_hour: 1.0, missed_share: 0.01, watchdog_s: 0.0, outside: None };
    let fault = tune(&[hopeless.clone()], &goal).unwrap_err();
    assert!(matches!(fault, TuneFault::Unreachable { .. }) && fault.to_string().contains(" of 60 presses missed"));
    hopeless.value.fill(f64::NAN);
    assert_eq!(tune(&[hopeless], &goal), Err(TuneFault::NoValues));
    assert_eq!(tune(&[Trace::default()], &goal), Err(TuneFault::NoContacts));
    assert_eq!(any_contact(&[Trace::default()]), Err(TuneFault::NoContacts));
    assert_eq!(any_contact(&[Trace::default(), trace(1, 300.0)]), Ok(()));
}

#[test]
fn a_file_is_read_checked_and_written_back() {
    let text = "on_N = 0.5\noff_N = 0.3\nwatchdog_s = 0.2\noutside = \"release\"\n[[place]]\nname = \"x+\"\n\
                rectangle_m = [0, 0, 0.1, 0.1]\n[[place]]\nname = \"x-\"\ndisc_m = [0.3, 0.1, 0.05]\n";
    let config = SwitchConfig::from_toml(text).unwrap();
    assert_eq!(
        (config.hold_on_s, config.lockout_s, config.rearm, config.outside),
        (0.0, 0.0, false, Some(Outside::Release))
    );
    assert_eq!(SwitchConfig::from_toml(&toml::to_string(&config).unwrap()).unwrap(), config);
    assert_eq!([(0.05, 0.1), (0.3, 0.12), (0.2, 0.2)].map(|(x, y)| config.at(x, y)), [Some("x+"), Some("x-"), None]);
    for (slow, most) in [("hold_on_s = 40", 10), ("lockout_s = 300", 60), ("watchdog_s = 500", 60)] {
        let fault = SwitchConfig::from_toml(&format!("on_N = 0.5\noff_N = 0.3\n{slow}\n")).unwrap_err().to_string();
        assert!(fault.contains(&format!("{slow}: choose 0 to {most} s")), "{fault}");
    }
    let bad = "on_N = -1\noff_N = 2\nhold_on_s = -3\nwatchdog_s = nan\n[[place]]\nname = \"p\"\n";
    let fault = SwitchConfig::from_toml(bad).unwrap_err();
    assert_eq!(fault.0.len(), 5, "{fault}");
    let unknown = SwitchConfig::from_toml("on_N = 1\noff_N = 0.5\nhold_s = 1").unwrap_err().to_string();
    assert!(unknown.contains("hold_s") && unknown.contains("hold_on_s"), "{unknown}");
}

#[test]
fn events_are_lines_of_json() {
    let event = SwitchEvent { t_s: 12.08, turn: Turn::Press, reason: Reason::Value, value: 0.61, delay_s: 0.04 };
    let mut line = Vec::new();
    event.write_json(&mut line, "force_N", Some("index"), Some("x+ \"fast\"")).unwrap();
    let line: serde_json::Value = serde_json::from_slice(&line).unwrap();
    let expected = serde_json::json!({"t": 12.08, "event": "press", "reason": "value", "finger": "index",
        "switch": "x+ \"fast\"", "force_N": 0.61, "delay_s": 0.04});
    assert_eq!(line, expected);
}
