use std::path::Path;

use super::*;

const SPIRAL: &str = "[[step]]\nkind = \"spiral\"\nname = \"force\"\nseconds = 20\n";

fn protocol(text: &str) -> Protocol {
    Protocol::parse(text, Path::new("p.toml")).unwrap()
}

/// A run with samples and forces at 100 Hz, at a time of the server's clock.
struct Bench {
    run: Run,
    now_s: f64,
    force: Option<[f64; 3]>,
    samples: bool,
    page: bool,
}

impl Bench {
    fn new(text: &str) -> Self {
        let mut run = Run::new(protocol(text), true);
        run.begin(vec!["P1".to_owned()], None);
        let mut bench = Self { run, now_s: 5.0, force: Some([0.0; 3]), samples: true, page: true };
        bench.pass(1.0);
        bench
    }

    fn pass(&mut self, seconds: f64) {
        for _ in 0..(100.0 * seconds).round() as u32 {
            self.now_s += 0.01;
            if self.samples {
                self.run.sample(self.now_s, Some(&[2.0 + 0.01 * self.now_s.sin()]));
            }
            if let Some(force) = self.force {
                self.run.force(self.now_s, force);
            }
            if self.page {
                self.run.page(self.now_s);
            }
            self.run.advance(self.now_s);
        }
    }

    fn key(&mut self, key: Key) {
        self.run.key(key, self.now_s, self.now_s);
    }

    fn phase(&self) -> Phase {
        self.run.phase().0.clone()
    }

    /// The step's own time now.
    fn at_s(&self) -> f64 {
        self.run.prompted(self.now_s).1.map_or(f64::NAN, |(_, at_s)| at_s)
    }

    fn events(&self) -> Vec<&'static str> {
        self.run.turns.iter().map(|turn| turn.event).collect()
    }
}

/// Times are sums of hundredths.
fn near(one: f64, other: f64) -> bool {
    (one - other).abs() <= 1e-6
}

#[test]
fn a_step_waits_moves_pauses_goes_on_and_ends() {
    let mut bench = Bench::new(SPIRAL);
    assert!(bench.phase() == Phase::Waiting && bench.run.prompted(bench.now_s).0.is_none());
    bench.key(Key::Go);
    bench.pass(2.0);
    assert!(near(bench.at_s(), 2.0 - LEAD_S), "{}", bench.at_s());
    assert!(bench.run.collecting(bench.now_s).is_some());
    // The key was pressed 0.1 s before it came: the ring stopped then.
    bench.run.key(Key::Go, bench.now_s - 0.1, bench.now_s);
    assert_eq!(bench.phase(), Phase::Paused);
    let stopped_s = bench.at_s();
    assert!(near(stopped_s, 1.9 - LEAD_S) && bench.run.collecting(bench.now_s).is_none());
    bench.pass(3.0);
    assert_eq!(bench.at_s(), stopped_s);
    bench.key(Key::Go);
    bench.pass(1.0);
    assert!(near(bench.at_s(), stopped_s + 1.0 - LEAD_S));
    let went_on = bench.run.turns.last().unwrap();
    assert!(went_on.event == "goes on" && near(went_on.stood_s.unwrap(), 3.1 + LEAD_S), "{went_on:?}");
    bench.pass(30.0);
    assert_eq!(bench.phase(), Phase::Done);
    assert_eq!(bench.events(), ["begins", "paused", "goes on", "ends", "done"]);
    let ended = &bench.run.turns[3];
    assert!(near(ended.time_s - bench.run.turns[2].time_s, 22.0 - stopped_s), "the release is part of it");
    assert!(bench.run.collecting(bench.now_s).is_none() && bench.run.prompted(bench.now_s).0.is_none());
}

#[test]
fn what_is_decided_takes_effect_later_so_that_a_page_knows_before() {
    let mut bench = Bench::new(SPIRAL);
    bench.key(Key::Go);
    assert!(bench.run.prompted(bench.now_s + 0.5 * LEAD_S).0.is_none());
    assert!(bench.run.prompted(bench.now_s + LEAD_S).0.is_some());
    bench.pass(1.0);
    let before = bench.run.clone();
    bench.force = None;
    while bench.phase() == Phase::Running {
        bench.pass(0.01);
    }
    // The page that still draws what it heard before is right until the stop.
    let stop_s = bench.now_s + LEAD_S;
    assert_eq!(before.prompted(stop_s - 0.01), bench.run.prompted(stop_s - 0.01));
    assert_ne!(before.prompted(stop_s + 0.1), bench.run.prompted(stop_s + 0.1));
}

#[test]
fn a_silent_force_stops_the_ring_and_collects_nothing_until_it_is_back() {
    for (silent_force, says) in [(true, "no force"), (false, "no sample")] {
        let mut bench = Bench::new(SPIRAL);
        bench.key(Key::Go);
        bench.pass(3.0);
        if silent_force {
            bench.force = Some([f64::NAN; 3]);
        } else {
            bench.samples = false;
        }
        bench.pass(0.39);
        assert_eq!(bench.phase(), Phase::Running);
        bench.pass(0.05);
        assert!(bench.phase() == Phase::Stalled && bench.run.phase().1.starts_with(says), "{:?}", bench.run.phase());
        bench.pass(5.0);
        let stood_s = bench.at_s();
        assert!(bench.run.collecting(bench.now_s).is_none() && (stood_s - 3.41).abs() <= 0.011, "{stood_s}");
        (bench.force, bench.samples) = (Some([0.0; 3]), true);
        bench.pass(1.0);
        assert!(bench.phase() == Phase::Running && bench.at_s() > stood_s && bench.at_s() < stood_s + 1.0);
        let turn = bench.run.turns.last().unwrap();
        assert!(turn.event == "goes on" && turn.stood_s.is_some_and(|stood_s| stood_s > 4.9), "{turn:?}");
    }
}

#[test]
fn nothing_begins_without_forces() {
    let mut bench = Bench::new(SPIRAL);
    bench.force = None;
    bench.pass(1.0);
    bench.key(Key::Go);
    assert!(bench.phase() == Phase::Waiting && bench.run.phase().1.starts_with("no force"));
    bench.force = Some([0.0; 3]);
    bench.pass(0.1);
    bench.key(Key::Go);
    assert_eq!(bench.phase(), Phase::Running);
}

#[test]
fn a_page_that_is_hidden_or_gone_pauses_and_a_person_goes_on() {
    let mut bench = Bench::new(SPIRAL);
    bench.key(Key::Go);
    bench.pass(2.0);
    bench.key(Key::Hidden);
    assert_eq!(bench.run.phase(), (&Phase::Paused, "the page was hidden"));
    bench.pass(9.0);
    assert_eq!(bench.phase(), Phase::Paused);
    bench.key(Key::Go);
    bench.pass(1.0);
    bench.page = false;
    bench.pass(GONE_S - 0.05);
    assert_eq!(bench.phase(), Phase::Running);
    bench.pass(0.1);
    assert!(bench.phase() == Phase::Paused && bench.run.phase().1.starts_with("the page is gone"));
    // Hidden while it waits or is paused: as it was.
    bench.key(Key::Hidden);
    assert!(bench.run.phase().1.starts_with("the page is gone"));
    // The stream falls silent while it is paused: going on waits for it.
    bench.force = None;
    bench.pass(1.0);
    bench.key(Key::Go);
    assert_eq!(bench.phase(), Phase::Stalled);
    bench.key(Key::Hidden);
    (bench.force, bench.page) = (Some([0.0; 3]), true);
    bench.pass(1.0);
    assert_eq!(bench.phase(), Phase::Paused, "it does not go on unseen");
}

const CHECKS: &str = "[[step]]\nkind = \"ask\"\n[[step]]\nkind = \"check\"\nchecks = [\"photodiodes\", \"tare\", \
                      \"sign\"]\n[[step]]\nkind = \"bending\"\nseconds = 5\nchecks = [\"adhesion\"]\n";

#[test]
fn checks_hold_the_next_step_up_and_the_sign_is_prompted_after_the_tare() {
    let mut bench = Bench::new(CHECKS);
    bench.key(Key::Go);
    assert_eq!(bench.run.place(), (1, 3));
    bench.force = Some([0.0, 0.0, -0.8]);
    bench.key(Key::Go);
    bench.pass(4.0);
    assert!(bench.phase() == Phase::Running && bench.run.prompted(bench.now_s).0.is_none());
    let says: Vec<String> = bench.run.verdicts().into_iter().map(|(_, verdict)| verdict.says).collect();
    assert!(says[1].contains("set the transducer to zero"), "{says:?}");
    bench.force = Some([0.0; 3]);
    bench.pass(3.0);
    assert_eq!(bench.run.prompted(bench.now_s).0, Some(Prompted::Force([0.0, 0.0, -1.0])));
    assert!(bench.run.collecting(bench.now_s).is_none());
    bench.force = Some([0.0, 0.0, -1.1]);
    bench.pass(1.0);
    assert_eq!((bench.phase(), bench.run.place()), (Phase::Waiting, (2, 3)));
    assert!(bench.run.prompted(bench.now_s).0.is_none());
}

#[test]
fn a_sensor_that_jumps_while_bending_has_the_step_repeated_and_who_goes_on_is_told() {
    let mut bench = Bench::new(CHECKS);
    bench.key(Key::Go);
    bench.key(Key::Skip);
    assert!(bench.run.skipped[0].starts_with("check: passed over"), "{:?}", bench.run.skipped);
    bench.key(Key::Go);
    bench.pass(2.0);
    bench.run.sample(bench.now_s + 0.001, Some(&[4.0]));
    bench.pass(5.0);
    assert!(bench.phase() == Phase::Waiting && bench.run.phase().1.starts_with("once more: P1 jumped by"));
    bench.key(Key::Go);
    bench.pass(6.0);
    assert_eq!(bench.phase(), Phase::Done);
    assert!(bench.events().contains(&"to be repeated"));
}

#[test]
fn reset_begins_the_step_again_and_stop_keeps_and_then_ends() {
    let mut bench = Bench::new(&format!("{SPIRAL}{SPIRAL}"));
    bench.key(Key::Reset);
    assert_eq!(bench.phase(), Phase::Waiting);
    bench.key(Key::Go);
    bench.pass(5.0);
    bench.key(Key::Reset);
    bench.pass(0.2);
    assert!(bench.phase() == Phase::Waiting && bench.at_s() == 0.0 && bench.run.place().0 == 0);
    bench.key(Key::Go);
    bench.pass(1.0);
    assert!(near(bench.at_s(), 1.0 - LEAD_S));
    bench.key(Key::Stop);
    bench.pass(0.2);
    assert!(bench.phase() == Phase::Done && bench.run.collecting(bench.now_s).is_none());
    bench.key(Key::Go);
    assert_eq!(bench.phase(), Phase::Done);
    let extra = protocol(SPIRAL).steps[0].clone();
    bench.run.append(extra);
    assert_eq!((bench.phase(), bench.run.place()), (Phase::Waiting, (2, 3)));
    bench.key(Key::Stop);
    bench.key(Key::Stop);
    assert_eq!(bench.phase(), Phase::Over);
}

#[test]
fn steps_that_begin_at_once_follow_each_other() {
    let mut bench = Bench::new(
        "[[step]]\nkind = \"rest\"\nseconds = 2\n[[step]]\nkind = \"rest\"\nseconds = 2\nstarts = \"at once\"",
    );
    bench.key(Key::Go);
    bench.pass(3.0);
    assert_eq!((bench.phase(), bench.run.place().0), (Phase::Running, 1));
    bench.pass(2.0);
    assert_eq!(bench.phase(), Phase::Done);
    // A key without a time that makes sense counts as pressed now.
    let mut bench = Bench::new(SPIRAL);
    bench.run.key(Key::Go, f64::NAN, bench.now_s);
    bench.pass(1.0);
    bench.run.key(Key::Go, -1e9, bench.now_s);
    assert!(near(bench.at_s(), 1.0 - LEAD_S - OLDEST_KEY_S), "{}", bench.at_s());
}
