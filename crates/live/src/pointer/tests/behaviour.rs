//! What moves, clicks, drags, scrolls and is zeroed, and what does not.

use super::super::{Click, Mode};
use super::*;

#[test]
fn a_finger_that_touches_and_pushes_moves_the_pointer_and_no_other_does() {
    let mut bench = Bench::new(Config::default());
    bench.hold(0.5, [0.5, 0.2, 0.0]).hold(0.5, [0.5, 0.2, 0.29]);
    assert_eq!((bench.at(), bench.pointer.touches), ([0, 0], false), "in the air");
    bench.hold(0.5, AIR).hold(1.0, REST).hold(1.0, [0.15, 0.15, 0.9]);
    assert_eq!((bench.at(), bench.pointer.touches), ([0, 0], true), "within the dead zone");
    bench.hold(1.0, PUSH);
    let [right, down] = bench.at();
    assert!(right > 50 && down < -20, "{right} {down}");
    // The direction is that of the shear, but for whole counts and the filter's way there.
    assert!((down as f64 / right as f64 + 0.4).abs() <= 0.05, "{right} {down}");
    bench.hold(0.5, REST);
    let before = bench.at();
    bench.hold(1.0, REST).hold(0.3, [0.5, 0.2, 0.1]);
    assert_eq!(bench.at(), before);
    assert_eq!((bench.count("button"), bench.count("ready"), bench.count("lost")), (0, 1, 0));
}

#[test]
fn a_touch_settles_before_it_moves() {
    for settle_s in [0.0, 0.1, 0.5] {
        let mut bench = Bench::new(Config { settle_s, ..Config::default() });
        bench.hold(0.5, AIR).hold(1.5, [2.0, 0.0, 0.9]);
        let first_s = bench.events.iter().find(|event| matches!(event.what, What::Move { .. })).unwrap().t_s;
        // The second sample of the touch is the first that is steady; then the shear passes its filter.
        assert!((0.0..=0.05).contains(&(first_s - 0.51 - settle_s)), "{settle_s}: {first_s}");
    }
}

#[test]
fn the_speed_is_that_of_the_curve() {
    let mut bench = Bench::new(Config::default());
    bench.hold(0.5, AIR).hold(1.0, REST).hold(2.0, [0.55, 0.0, 0.9]);
    let before = bench.at()[0];
    bench.hold(2.0, [0.55, 0.0, 0.9]);
    // 0.3 N beyond the dead zone: 0.15 N of 400 and 0.15 N of 2400 px/s per N.
    assert!((bench.at()[0] - before - 840).abs() <= 1, "{}", bench.at()[0] - before);
    let mut capped = Bench::new(Config { cap_px_per_s: 100.0, ..Config::default() });
    capped.hold(0.5, AIR).hold(1.0, REST).hold(1.0, [3.0, 0.0, 0.9]);
    let before = capped.at()[0];
    capped.hold(2.0, [3.0, 0.0, 0.9]);
    assert!((capped.at()[0] - before - 200).abs() <= 1);
}

#[test]
fn a_press_clicks_where_the_pointer_was() {
    let mut bench = Bench::new(Config::default());
    bench.hold(0.5, AIR).hold(1.0, REST);
    for _ in 0..3 {
        bench.ramp(0.15, REST, CLICK).hold(0.1, CLICK).ramp(0.15, CLICK, REST).hold(0.7, REST);
    }
    assert_eq!(bench.downs(), [true, false, true, false, true, false]);
    assert_eq!(bench.at(), [0, 0]);
    // The same without the lock: the pointer is thrown.
    let open = Config { rise_n: 20.0, settle_s: 0.0, take_back_s: 0.0, ..Config::default() };
    let mut bench = Bench::new(open);
    bench.hold(0.5, AIR).hold(1.0, REST);
    bench.ramp(0.15, REST, CLICK).hold(0.1, CLICK).ramp(0.15, CLICK, REST).hold(0.7, REST);
    assert!(bench.at()[0] > 5 && bench.at()[1] > 5, "{:?}", bench.at());
}

#[test]
fn a_click_takes_back_the_last_of_the_motion_and_a_rise_without_a_click_nothing() {
    const FIRST: [f64; 3] = [0.4, 0.0, 0.9];
    // 0.15 N beyond the dead zone at 400 px/s per N.
    const SPEED: f64 = 60.0;
    let moved = |take_back_s: f64, top_n: f64| {
        let mut bench = Bench::new(Config { take_back_s, ..Config::default() });
        bench.hold(0.5, AIR).hold(1.0, REST).hold(2.0, FIRST);
        let top = [FIRST[0], FIRST[1], top_n];
        bench.hold(0.2, top);
        bench.at()[0] as f64
    };
    let back_px = moved(0.0, 2.5) - moved(0.5, 2.5);
    // A 64th of 0.5 s is a sample, and each place is cut to whole counts.
    assert!((back_px - 0.5 * SPEED).abs() <= 1.0 + 2.0 * SPEED / RATE_HZ, "{back_px}");
    let back_px = moved(0.0, 1.5) - moved(0.5, 1.5);
    assert_eq!(back_px, 0.0);
}

#[test]
fn a_rise_that_is_no_click_freezes_for_a_while_only() {
    let mut bench = Bench::new(Config::default());
    bench.hold(0.5, AIR).hold(1.0, REST).hold(1.0, PUSH);
    let before = bench.at();
    bench.hold(0.4, [0.5, 0.2, 1.5]);
    assert_eq!(bench.at(), before);
    bench.hold(0.5, [0.5, 0.2, 1.5]);
    assert!(bench.at()[0] > before[0] + 20, "{before:?} {:?}", bench.at());
    assert_eq!(bench.count("button"), 0);
}

#[test]
fn a_button_that_is_held_drags_from_where_the_shear_was_and_drops_in_place() {
    let mut bench = Bench::new(Config::default());
    let pressed = [1.2, 0.0, 2.5];
    bench.hold(0.5, AIR).hold(1.0, REST).hold(1.0, pressed);
    assert_eq!((bench.downs(), bench.at(), bench.count("drag")), (vec![true], [0, 0], 1));
    bench.hold(1.0, [1.7, 0.0, 2.5]);
    let dragged = bench.at()[0];
    assert!(dragged > 50, "{dragged}");
    bench.hold(0.5, pressed);
    let before = bench.at();
    bench.ramp(0.4, pressed, REST).hold(1.0, REST);
    assert_eq!((bench.downs(), bench.at()), (vec![true, false], before));
    // The drag's own origin is forgotten.
    bench.hold(1.0, [0.6, 0.0, 0.9]);
    assert!(bench.at()[0] > before[0] + 50);
}

#[test]
fn a_finger_that_lifts_lets_the_button_go() {
    let mut bench = Bench::new(Config::default());
    bench.hold(0.5, AIR).hold(1.0, REST).hold(0.2, CLICK).hold(0.01, AIR);
    assert_eq!(bench.downs(), [true, false]);
}

#[test]
fn a_finger_that_presses_from_the_beginning_does_nothing() {
    let mut bench = Bench::new(Config::default());
    bench.hold(2.0, CLICK).hold(1.0, PUSH).hold(1.0, CLICK);
    assert_eq!(bench.events, []);
    bench.hold(0.1, AIR).hold(0.2, CLICK);
    assert_eq!(bench.downs(), [true]);
}

#[test]
fn a_tap_clicks_and_a_tap_and_a_touch_drag() {
    let mut bench = Bench::new(Config { click: Click::Tap, ..Config::default() });
    let tap = [0.6, 0.3, 1.2];
    bench.hold(0.5, AIR).hold(0.15, tap).hold(0.5, AIR);
    assert_eq!((bench.downs(), bench.at()), (vec![true, false], [0, 0]));
    bench.hold(0.1, tap).hold(0.1, AIR).hold(0.1, tap).hold(0.5, AIR);
    assert_eq!(bench.downs().len(), 6, "two more clicks");
    bench.hold(0.1, tap).hold(0.1, AIR).hold(0.5, tap);
    assert_eq!((bench.downs().len(), bench.pointer.is_down(), bench.at()), (9, true, [0, 0]));
    bench.hold(0.5, [1.0, 0.3, 1.2]);
    assert!(bench.at()[0] > 10);
    bench.hold(0.1, AIR);
    assert_eq!((bench.downs().len(), bench.pointer.is_down()), (10, false));
    bench.hold(0.5, AIR).hold(1.0, [0.0, 0.0, 3.0]).hold(0.5, AIR);
    assert_eq!(bench.downs().len(), 10, "a touch that lasts, however hard, is no tap");
}

#[test]
fn bending_scrolls_in_the_air_only() {
    let config = Config { scroll: true, ..Config::default() };
    let mut bench = Bench::new(config);
    bench.bend(0.5, AIR, 20.0).bend(1.0, AIR, 34.0);
    assert_eq!(bench.count("scroll"), 0, "within the dead zone");
    bench.bend(2.0, AIR, 45.0);
    let lines = |bench: &Bench| -> i32 {
        bench.events.iter().map(|event| if let What::Scroll { lines } = event.what { lines } else { 0 }).sum()
    };
    // 10 degrees beyond at 0.3 lines/s per degree, flexion is down.
    assert!((lines(&bench) + 6).abs() <= 1, "{}", lines(&bench));
    let before = lines(&bench);
    bench.bend(2.0, REST, 60.0).bend(0.4, AIR, 60.0);
    assert_eq!(lines(&bench), before, "while it touches, and shortly after");
    bench.bend(2.0, AIR, -60.0);
    assert!(lines(&bench) > before + 10, "{}", lines(&bench));
    let before = lines(&bench);
    bench.bend(1.0, AIR, f64::NAN).hold(1.0, AIR);
    assert_eq!(lines(&bench), before);
    let mut off = Bench::new(Config::default());
    off.bend(3.0, AIR, 90.0);
    assert_eq!(off.count("scroll"), 0);
}

#[test]
fn the_zero_follows_a_finger_in_the_air_and_no_other() {
    let off = [0.3, -0.2];
    let zeros = |bench: &Bench| -> Vec<[f64; 2]> {
        let zero = |event: &Event| if let What::Zero { fx_n, fy_n } = event.what { Some([fx_n, fy_n]) } else { None };
        bench.events.iter().filter_map(zero).collect()
    };
    let mut bench = Bench::new(Config::default());
    bench.hold(10.0, [off[0], off[1], 0.0]);
    let found = zeros(&bench);
    assert_eq!(found.len(), 4, "one after 0.5 and 2 s, then every 2 s");
    assert!(found.iter().all(|zero| (0..2).all(|axis| (zero[axis] - off[axis]).abs() <= 1e-12)), "{found:?}");
    bench.hold(30.0, [off[0], off[1], 0.9]);
    assert_eq!((bench.at(), zeros(&bench).len()), ([0, 0], 4), "the offset moves nothing; touching sets no zero");
    // Too light to count as touching, too heavy to be air for certain.
    bench.hold(20.0, [0.6, 0.0, 0.15]);
    assert_eq!(zeros(&bench).len(), 4);
    // An offset that grows is followed slowly.
    bench.hold(3.0, [0.6, -0.2, 0.0]);
    let last = *zeros(&bench).last().unwrap();
    assert!((last[0] - (0.3 + 0.3 * (1.0 - (-0.2f64).exp()))).abs() <= 1e-12, "{last:?}");
    // One that bends to scroll is left out.
    let mut bends = Bench::new(Config { scroll: true, ..Config::default() });
    bends.bend(10.0, AIR, 60.0);
    assert_eq!(zeros(&bends).len(), 0);
}

#[test]
fn in_the_mode_of_positions_the_pointer_is_a_spring() {
    let mut bench = Bench::new(Config { mode: Mode::Position, ..Config::default() });
    bench.hold(0.5, AIR).hold(1.0, REST).hold(3.0, [0.55, 0.0, 0.9]);
    // 0.3 N beyond the dead zone at 800 px per N.
    assert!((bench.at()[0] - 240).abs() <= 1, "{:?}", bench.at());
    bench.hold(3.0, REST);
    assert!(bench.at()[0].abs() <= 1, "{:?}", bench.at());
    bench.hold(3.0, [0.55, 0.0, 0.9]).hold(1.0, AIR).hold(1.0, REST);
    assert!((bench.at()[0] - 240).abs() <= 1, "a finger that lifts at once leaves the pointer there");
    let mut capped = Bench::new(Config { mode: Mode::Position, cap_px_per_s: 50.0, ..Config::default() });
    capped.hold(0.5, AIR).hold(1.0, REST).hold(2.0, [0.55, 0.0, 0.9]);
    assert!((capped.at()[0] - 100).abs() <= 2, "{:?}", capped.at());
    capped.hold(6.0, [0.55, 0.0, 0.9]);
    assert!((capped.at()[0] - 240).abs() <= 1, "{:?}", capped.at());
}

#[test]
fn nothing_is_allocated_for_a_sample() {
    let mut pointer = Pointer::new(Config { scroll: true, ..Config::default() });
    let mut events = 0u64;
    let counted = allocation_counter::measure(|| {
        for k in 0..20_000_u32 {
            let t_s = f64::from(k) / RATE_HZ;
            let press = (0.7 * t_s).sin() * 3.0;
            let valid = k % 97 != 0;
            pointer.sample(t_s, t_s.sin(), t_s.cos(), -press, Some(60.0), valid, &mut |_| events += 1);
            pointer.advance(t_s, &mut |_| events += 1);
        }
    });
    assert!(events > 1000, "{events}");
    assert_eq!(counted.count_total, 0);
}
