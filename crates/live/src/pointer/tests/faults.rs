//! Stalls, spoilt samples and clocks that jump, at every phase of a click and of a drag: the button goes up in time,
//! and a finger that still presses when the stream returns presses nothing.

use super::super::{Click, Reason};
use super::*;

/// What goes wrong.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Fault {
    /// No samples; `advance` passes the time.
    Stall,
    /// No samples, and nobody says that time passes: the next sample finds out.
    Silence,
    NotValid,
    NanShear,
    NanPressing,
    Infinite,
    Huge,
    NoTime,
    ClockBack,
    /// By less than the watchdog.
    ClockBackABit,
    ClockLeap,
    Lost,
}

const FAULTS: [Fault; 12] = [
    Fault::Stall,
    Fault::Silence,
    Fault::NotValid,
    Fault::NanShear,
    Fault::NanPressing,
    Fault::Infinite,
    Fault::Huge,
    Fault::NoTime,
    Fault::ClockBack,
    Fault::ClockBackABit,
    Fault::ClockLeap,
    Fault::Lost,
];

const LASTS_S: f64 = 1.0;

/// In the air, on the desk, moving; then a click and a drag, or a tap and a tap that drags.
fn story(click: Click) -> Vec<[f64; 3]> {
    let pieces: &[(f64, [f64; 3])] = match click {
        Click::Tap => &[
            (0.1, AIR),
            (0.6, PUSH),
            (0.2, AIR),
            (0.1, PUSH),
            (0.1, AIR),
            (0.4, PUSH),
            (0.3, [1.0, 0.4, 1.2]),
            (0.1, AIR),
        ],
        _ => &[
            (0.1, AIR),
            (0.3, REST),
            (0.3, PUSH),
            (0.05, [0.7, 0.2, 1.3]),
            (0.15, CLICK),
            (0.05, [0.7, 0.2, 1.6]),
            (0.2, REST),
            (0.7, CLICK),
            (0.3, [1.5, -1.0, 2.5]),
            (0.1, [1.2, -1.0, 2.0]),
            (0.1, REST),
            (0.1, AIR),
        ],
    };
    let samples = pieces
        .iter()
        .flat_map(|&(seconds, force_n)| std::iter::repeat_n(force_n, (seconds * RATE_HZ).round() as usize));
    samples.collect()
}

/// The fault; returns the time at which it began by the stream's clock before it.
fn happen(bench: &mut Bench, fault: Fault) {
    let samples = (LASTS_S * RATE_HZ) as u32;
    match fault {
        Fault::Stall => {
            for _ in 0..samples {
                bench.samples += 1;
                let (now_s, events) = (bench.t_s(), &mut bench.events);
                bench.pointer.advance(now_s, &mut |event| events.push(event));
            }
        }
        Fault::Silence => bench.samples += samples,
        Fault::NotValid => (0..samples).for_each(|_| bench.one(CLICK, None, false)),
        Fault::NanShear => (0..samples).for_each(|_| bench.one([f64::NAN, 0.0, 2.5], None, true)),
        Fault::NanPressing => (0..samples).for_each(|_| bench.one([0.5, 0.0, f64::NAN], None, true)),
        Fault::Infinite => (0..samples).for_each(|_| bench.one([0.5, 0.0, f64::INFINITY], None, true)),
        Fault::Huge => (0..samples).for_each(|_| bench.one([0.5, -1e300, 2.5], None, true)),
        Fault::NoTime => {
            let shift_s = std::mem::replace(&mut bench.shift_s, f64::NAN);
            (0..samples).for_each(|_| bench.one(CLICK, None, true));
            bench.shift_s = shift_s;
        }
        Fault::ClockBack => bench.shift_s -= 100.0,
        Fault::ClockBackABit => bench.shift_s -= 0.05,
        Fault::ClockLeap => bench.shift_s += 100.0,
        Fault::Lost => {
            let (t_s, events) = (bench.t_s(), &mut bench.events);
            bench.pointer.lose(t_s, Reason::Lost, &mut |event| events.push(event));
        }
    }
}

#[test]
fn every_fault_at_every_phase_lets_go_in_time_and_nothing_presses_on_return() {
    let (mut cases, mut held) = (0, 0);
    for click in [Click::Press, Click::Tap] {
        let story = story(click);
        for fault in FAULTS {
            for phase in 1..story.len() {
                let case = format!("{click:?} {fault:?} at {phase}");
                let config = Config { click, ..Config::default() };
                let mut bench = Bench::new(config);
                story[..phase].iter().for_each(|&force_n| bench.one(force_n, None, true));
                let (was_down, last_valid_s) = (bench.pointer.is_down(), bench.t_s() - 1.0 / RATE_HZ);
                let before = bench.turns().len();
                let place_px = bench.pointer.place_px();
                happen(&mut bench, fault);
                let jump = matches!(fault, Fault::ClockBack | Fault::ClockBackABit | Fault::ClockLeap);
                if jump || fault == Fault::Silence {
                    bench.one(CLICK, None, true);
                }
                assert!(!bench.pointer.is_down(), "{case}");
                let turns = bench.turns();
                assert_eq!(turns.len() - before, usize::from(was_down), "{case}: {turns:?}");
                if was_down {
                    held += 1;
                    let (up_s, _) = turns[turns.len() - 1];
                    let late_s = up_s - last_valid_s - bench.shift_s;
                    assert!(jump || late_s <= config.watchdog_s + 1.0 / RATE_HZ, "{case}: {late_s}");
                }
                // Taking back at a release is the only motion that a fault may bring; here not even that.
                assert_eq!(bench.pointer.place_px(), place_px, "{case}");
                assert_eq!(bench.count("lost"), 1, "{case}");
                let (turns, at) = (bench.turns().len(), bench.at());
                bench.hold(1.0, CLICK).hold(0.5, PUSH).hold(0.5, CLICK);
                assert_eq!((bench.turns().len(), bench.at()), (turns, at), "{case}: a finger still presses");
                match click {
                    Click::Tap => bench.hold(0.1, AIR).hold(0.1, PUSH).hold(0.1, AIR),
                    _ => bench.hold(0.1, AIR).hold(0.2, CLICK).hold(0.1, AIR),
                };
                assert_eq!(bench.downs()[turns..], [true, false], "{case}: lifted, it clicks again");
                cases += 1;
            }
        }
    }
    assert!(cases >= 4000 && held >= 1000, "{cases} {held}");
}

#[test]
fn a_drag_that_is_lost_is_forgotten() {
    let mut bench = Bench::new(Config::default());
    bench.hold(0.1, AIR).hold(0.5, REST).hold(1.0, [0.8, 0.0, 2.5]);
    assert_eq!(bench.count("drag"), 1);
    happen(&mut bench, Fault::Stall);
    bench.hold(0.1, AIR).hold(2.0, REST);
    assert_eq!((bench.at(), bench.downs()), ([0, 0], vec![true, false]));
}

#[test]
fn a_watchdogs_release_has_the_time_at_which_it_was_due() {
    let config = Config::default();
    let mut bench = Bench::new(config);
    bench.hold(0.1, AIR).hold(0.5, REST).hold(0.2, CLICK);
    let last_s = bench.t_s() - 1.0 / RATE_HZ;
    assert_eq!(bench.pointer.due_s(), Some(last_s + config.watchdog_s));
    let events = &mut bench.events;
    bench.pointer.advance(last_s + 0.24, &mut |event| events.push(event));
    assert!(bench.pointer.is_down());
    let events = &mut bench.events;
    bench.pointer.advance(last_s + 7.0, &mut |event| events.push(event));
    assert_eq!(bench.turns().last(), Some(&(last_s + config.watchdog_s, false)));
    assert_eq!(
        bench.events.last(),
        Some(&Event { t_s: last_s + config.watchdog_s, what: What::Lost { reason: Reason::Watchdog } })
    );
    assert_eq!(bench.pointer.due_s(), None);
}

#[test]
fn a_short_gap_moves_nothing_and_keeps_the_button() {
    let mut bench = Bench::new(Config::default());
    bench.hold(0.1, AIR).hold(0.5, REST).hold(0.7, [0.0, 0.0, 2.5]).hold(0.5, [0.6, 0.0, 2.5]);
    let before = bench.at();
    assert!(before[0] > 10 && bench.pointer.is_down());
    for _ in 0..20 {
        bench.one([f64::NAN; 3], None, true);
        assert_eq!(bench.at(), before);
    }
    bench.hold(0.01, [0.6, 0.0, 2.5]);
    assert_eq!(bench.at(), before, "not over the gap either");
    bench.hold(0.5, [0.6, 0.0, 2.5]);
    assert!(bench.at()[0] > before[0] + 10 && bench.pointer.is_down());
    assert_eq!(bench.count("lost"), 0);
}

#[test]
fn a_host_clock_a_little_ahead_of_the_samples_does_no_harm() {
    let mut bench = Bench::new(Config::default());
    bench.hold(0.1, AIR).hold(0.5, REST).hold(0.2, CLICK);
    for _ in 0..100 {
        let (ahead_s, events) = (bench.t_s() + 0.1, &mut bench.events);
        bench.pointer.advance(ahead_s, &mut |event| events.push(event));
        bench.one(CLICK, None, true);
    }
    assert!(bench.pointer.is_down());
}

#[test]
fn samples_of_one_moment_are_one() {
    let mut bench = Bench::new(Config::default());
    bench.hold(0.1, AIR).hold(1.0, PUSH);
    let (before, place_px) = (bench.at(), bench.pointer.place_px());
    for _ in 0..10 {
        bench.samples -= 1;
        bench.one(CLICK, None, true);
    }
    assert_eq!((bench.at(), bench.pointer.place_px(), bench.count("button")), (before, place_px, 0));
    assert_eq!(bench.count("lost"), 0);
}

#[test]
fn a_reset_lets_go_and_begins_from_nothing() {
    let mut bench = Bench::new(Config::default());
    bench.hold(0.1, AIR).hold(0.5, REST).hold(0.2, CLICK);
    let events = &mut bench.events;
    bench.pointer.reset(&mut |event| events.push(event));
    assert_eq!(bench.downs(), [true, false]);
    assert!(matches!(bench.events.last(), Some(Event { what: What::Lost { reason: Reason::End }, .. })));
    let events = &mut Vec::new();
    bench.pointer.reset(&mut |event| events.push(event));
    assert_eq!(*events, []);
}
