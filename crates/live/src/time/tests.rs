//! Samples in sequence: lost, late, repeated, and clocks that were set.

use proptest::collection::vec;
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::testing::Taker;
use super::*;
use crate::wire::{Meaning, Sample, Use};

const MS: u64 = 1_000_000;

fn sequence(uses: &[Use], link: Link) -> Sequence {
    Sequence::new(&Meaning { uses: uses.to_vec(), values: 0, texts: 0 }, link, None)
}

fn clocked(counted: bool, link: Link) -> Sequence {
    sequence(
        if counted { &[Use::Time { per_second: 1e3 }, Use::Counter] } else { &[Use::Time { per_second: 1e3 }] },
        link,
    )
}

fn sample(time: f64, counter: Option<u64>) -> Sample {
    Sample { time, counter, lit: None }
}

/// Time, lost rows and whether a recording begins, of a row.
fn row(verdict: Verdict) -> (f64, u64, bool) {
    match verdict {
        Verdict::Row { time_s, lost, begins } => (time_s, lost, begins),
        other => panic!("{other:?}"),
    }
}

#[test]
fn rows_without_a_clock_are_spread_up_to_their_arrival() {
    let mut rows = sequence(&[Use::Counter], Link::Device);
    for n in 0..100_u64 {
        // Ten rows in a heap each; of the first nothing is known before.
        let host_ns = 1000 * MS + n / 10 * 10 * MS;
        if n % 10 == 0 {
            rows.announce(10);
        }
        let expected_s = if n < 10 { 1.0 } else { (991.0 + n as f64) / 1e3 };
        let (time_s, lost, begins) = row(rows.take(&sample(f64::NAN, Some(n + u64::from(n >= 50) * 3)), host_ns));
        assert!((time_s - expected_s).abs() <= 1e-9, "{n}: {time_s}");
        assert_eq!((lost, begins), (u64::from(n == 50) * 3, n == 0));
    }
    assert!((rows.period_s().unwrap() - 1e-3).abs() <= 3e-4, "{:?}", rows.period_s());
    assert_eq!(rows.now_s(1_100 * MS), 1.1);
}

#[test]
fn gaps_without_a_counter_are_an_estimate() {
    let mut rows = clocked(false, Link::Recording);
    let mut sent = 0;
    for n in (0..1000).filter(|n| n % 100 < 90) {
        sent += 1;
        assert_eq!(row(rows.take(&sample(f64::from(n), None), 0)).1, 0);
    }
    let counts = rows.counts();
    // Those behind the last row are not known.
    assert_eq!((counts.rows, counts.lost, counts.lost_by_time), (sent, 0, 90));
    assert!((rows.period_s().unwrap() - 1e-3).abs() <= 1e-9);
    assert_eq!(rows.now_s(u64::MAX), 0.989, "the recording's own time");
}

#[test]
fn of_whole_milliseconds_only_gaps_beyond_them_are_lost_rows() {
    // Rows of which every 25th is lost, and how many of the lost ones a clock of milliseconds shows at least: a gap of
    // two periods may be as long as a step of one.
    for (rate_hz, least) in [(60.0, 1.0), (150.0, 1.0), (300.0, 1.0), (600.0, 0.95), (700.0, 0.6), (900.0, 0.1)] {
        for every in [5000, 25] {
            let mut rows = clocked(false, Link::Recording);
            let mut lost = 0_u32;
            for n in 0..3990 {
                if n % every == every - 1 {
                    lost += 1;
                    continue;
                }
                row(rows.take(&sample((f64::from(n) * 1e3 / rate_hz).floor(), None), 0));
            }
            let found = rows.counts().lost_by_time as f64;
            assert!(found >= least * f64::from(lost) && found <= f64::from(lost) + 2.0, "{rate_hz}: {found} of {lost}");
        }
    }
}

#[test]
fn rows_without_a_time_do_not_move_the_clock() {
    let mut rows = clocked(true, Link::Recording);
    assert_eq!(row(rows.take(&sample(5.0, Some(0)), 0)), (0.005, 0, true));
    assert!(row(rows.take(&sample(f64::NAN, Some(1)), 0)).0.is_nan());
    assert_eq!(row(rows.take(&sample(7.0, Some(2)), 0)), (0.007, 0, false));
}

#[test]
fn late_rows_are_dropped_and_seventeen_are_a_clock_that_was_set() {
    let mut rows = clocked(false, Link::Recording);
    for n in 0..100 {
        row(rows.take(&sample(f64::from(n), None), 0));
    }
    assert_eq!(rows.take(&sample(97.5, None), 0), Verdict::Late);
    assert_eq!(row(rows.take(&sample(100.0, None), 0)), (0.1, 0, false));
    let verdicts: Vec<Verdict> = (0..17).map(|n| rows.take(&sample(90.0 + f64::from(n) / 2.0, None), 0)).collect();
    assert!(verdicts[..16].iter().all(|verdict| *verdict == Verdict::Late));
    let (time_s, _, begins) = row(verdicts[16]);
    assert!(begins && (time_s - 0.101).abs() <= 1e-9, "{time_s}");
    let counts = rows.counts();
    assert_eq!((counts.disorder, counts.set_back), (17, 1));
}

/// Times, lost rows and whether a recording begins, of the rows that a sample gives.
fn taken(taker: &mut Taker, rows: &mut Sequence, next: Sample, host_ns: u64) -> Vec<(f64, u64, bool)> {
    taker.take(rows, next, host_ns).into_iter().map(|(_, verdict)| row(verdict)).collect()
}

#[test]
fn a_clock_that_leaps_is_believed_when_a_second_row_agrees() {
    for (link, counted, leap_ms) in [Link::Device, Link::Pipe, Link::Recording]
        .into_iter()
        .flat_map(|link| [true, false].map(|counted| (link, counted)))
        .flat_map(|(link, counted)| [-80.0, -4000.0, 100.0, 5000.0, 5e6].map(|leap_ms| (link, counted, leap_ms)))
    {
        let what = format!("{link:?} {counted} {leap_ms}");
        let (mut rows, mut taker) = (clocked(counted, link), Taker::default());
        let mut take = |time: f64, n: u64| taken(&mut taker, &mut rows, sample(time, counted.then_some(n)), n * MS);
        for n in 0..5000 {
            take(n as f64, n);
        }
        // One row is damaged.
        assert_eq!(take(5000.0 + leap_ms, 5000), [], "{what}");
        assert_eq!(take(5001.0, 5001), [(5.001, u64::from(counted), false)], "{what}");
        // The clock is set: none of its rows is lost.
        assert_eq!(take(5002.0 + leap_ms, 5002), [], "{what}");
        let given = take(5003.0 + leap_ms, 5003);
        // Forwards a recording has a gap, and so has a device of which rows were lost; else its clock was set.
        let gap_s = if leap_ms < 0.0 || link == Link::Device && leap_ms > 1e4 { 0.0 } else { leap_ms / 1e3 };
        let set_back = gap_s == 0.0;
        let expected = [(5.002 + gap_s, 0, set_back), (5.003 + gap_s, 0, false)];
        assert_eq!(given.len(), 2, "{what}");
        for (given, expected) in given.iter().zip(expected) {
            assert!((given.0 - expected.0).abs() <= 1e-9, "{what}: {given:?}");
            assert_eq!((given.1, given.2), (expected.1, expected.2), "{what}");
        }
        let counts = rows.counts();
        assert_eq!((counts.doubtful, counts.set_back, counts.rows), (1, u64::from(set_back), 5003), "{what}");
    }
}

#[test]
fn a_small_leap_of_one_row_costs_the_rows_that_it_hides() {
    for (counted, leap_ms, late) in [(true, 5.0, 5), (false, 5.0, 5), (true, -5.0, 1), (false, -5.0, 1)] {
        let mut rows = clocked(counted, Link::Pipe);
        let verdicts: Vec<Verdict> = (0..1000_u32)
            .map(|n| {
                let time = f64::from(n) + if n == 500 { leap_ms } else { 0.0 };
                rows.take(&sample(time, counted.then_some(n.into())), u64::from(n) * MS)
            })
            .collect();
        let counts = rows.counts();
        assert_eq!((counts.disorder, counts.set_back), (late - u64::from(leap_ms > 0.0), 0), "{counted} {leap_ms}");
        assert_eq!(row(verdicts[999]).0, 0.999);
    }
}

#[test]
fn a_damaged_count_costs_its_row_and_leaves_the_clock() {
    for link in [Link::Device, Link::Pipe, Link::Recording] {
        for damaged in [7, 2_000_000] {
            let (mut rows, mut taker) = (clocked(true, link), Taker::default());
            for n in 0..5000 {
                let given =
                    taken(&mut taker, &mut rows, sample(n as f64, Some(if n == 3000 { damaged } else { n })), n * MS);
                let lost = u64::from(n == 3001);
                let expected = if n == 3000 { vec![] } else { vec![(n as f64 / 1e3, lost, n == 0)] };
                assert_eq!(given, expected, "{link:?} {damaged}");
            }
            assert_eq!((rows.counts().doubtful, rows.counts().set_back), (1, 0), "{link:?} {damaged}");
        }
    }
    // A counter that begins again, and one that counts something else.
    let (mut rows, mut taker) = (clocked(true, Link::Device), Taker::default());
    let given: Vec<_> =
        (0..2000).flat_map(|n| taken(&mut taker, &mut rows, sample(n as f64, Some(n % 1000)), n * MS)).collect();
    assert_eq!((given.len(), given[1000], given[1999]), (2000, (1.0, 0, true), (1.999, 0, false)));
    let (mut rows, mut taker) = (clocked(true, Link::Recording), Taker::default());
    let given: usize = (0..1001).map(|n| taken(&mut taker, &mut rows, sample(n as f64, Some(n * 100)), 0).len()).sum();
    assert!(given >= 1000 && rows.counts().doubtful == 0 && rows.counts().set_back == 0, "{given}");
}

#[test]
fn a_source_that_was_away_goes_on_or_begins_again() {
    // The device ran on, or started again meanwhile: time goes on by what the host saw pass.
    for (back_ms, back_n, lost) in [(3002.0, 3002, 1001), (20_000.0, 1, 0), (40.0, 2, 0)] {
        let mut rows = clocked(true, Link::Device);
        for n in 0..2001 {
            row(rows.take(&sample(n as f64, Some(n)), n * MS));
        }
        rows.come_back();
        let (time_s, now_lost, begins) = row(rows.take(&sample(back_ms, Some(back_n)), 3002 * MS));
        assert_eq!((now_lost, begins), (lost, true), "{back_ms}");
        assert!((time_s - 3.002).abs() <= 1e-9, "{back_ms}: {time_s}");
        assert!(!row(rows.take(&sample(back_ms + 1.0, Some(back_n + 1)), 3003 * MS)).2);
    }
}

#[test]
fn a_device_that_starts_again_at_once_is_no_repetition() {
    let mut rows = clocked(true, Link::Device);
    for n in 0..3 {
        row(rows.take(&sample(n as f64, Some(n)), n * MS));
    }
    // Its names came again.
    rows.begin();
    assert_eq!(row(rows.take(&sample(0.0, Some(0)), 3 * MS)), (0.003, 0, true));
    assert!(!row(rows.take(&sample(1.0, Some(1)), 4 * MS)).2);
    let mut counted = sequence(&[Use::Counter], Link::Device);
    for n in 0..3 {
        row(counted.take(&sample(f64::NAN, Some(n)), n * MS));
    }
    counted.begin();
    assert_eq!(row(counted.take(&sample(f64::NAN, Some(0)), 3 * MS)), (0.003, 0, true));
    assert_eq!(counted.counts().duplicates, 0);
}

#[test]
fn rows_that_jitter_about_a_tick_are_none_lost() {
    // Rows of a crystal of its own, which crosses the ticks of `millis()`; its interrupt jitters.
    let drifts = [(20.0, 0.02), (50.0, 0.1), (-20.0, 0.02), (-50.0, 0.1)];
    for (step_ms, (ppm, jitter_ms)) in [1.0, 2.0, 4.0].into_iter().flat_map(|step_ms| drifts.map(|one| (step_ms, one)))
    {
        for seed in 0..5 {
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            let (mut rows, mut last_ms) = (clocked(false, Link::Recording), 0.0_f64);
            for n in 0..60_000 {
                let late: f64 = StandardNormal.sample(&mut random);
                last_ms = last_ms.max(5.3 + step_ms * f64::from(n) * (1.0 + ppm * 1e-6) + jitter_ms * late);
                row(rows.take(&sample(last_ms.floor(), None), 0));
            }
            let counts = rows.counts();
            assert_eq!((counts.lost_by_time, counts.shared), (0, 0), "{step_ms} {ppm} {jitter_ms} {seed}");
            assert!((1e3 * rows.period_s().unwrap() / step_ms - 1.0).abs() <= 1e-3, "{step_ms}: {:?}", rows.period_s());
        }
    }
}

#[test]
fn rows_that_are_stamped_together_are_counted_and_none_is_lost() {
    for (least, most) in [(2, 2), (1, 2), (1, 3), (2, 6), (8, 8), (50, 50)] {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let mut rows = clocked(false, Link::Recording);
        let mut taker = Taker::default();
        let (mut made, mut stamps) = (0_u32, 0_u32);
        while made < 6000 {
            let packet = random.random_range(least..=most);
            made += packet;
            stamps += 1;
            for _ in 0..packet {
                taken(&mut taker, &mut rows, sample(1e6 + 4.0 * f64::from(made), None), 0);
            }
        }
        let counts = rows.counts();
        let period_s = rows.period_s().unwrap();
        assert!((period_s / 0.004 - 1.0).abs() <= 1e-9, "{least} to {most}: {period_s}");
        let shared = counts.shared.abs_diff(u64::from(made - stamps));
        // Before the first step nothing is known.
        assert!(counts.lost_by_time == 0 && shared < u64::from(most), "{least} to {most}: {counts:?}");
        assert_eq!((counts.rows, counts.doubtful), (u64::from(made), 0), "{least} to {most}");
    }
}

/// Equal, back, tiny and huge, as stamps or as steps between them.
fn any_stamp() -> impl Strategy<Value = f64> {
    prop_oneof![Just(0.0), Just(1.0), Just(2.0), -3.0..3.0, Just(-1e308), Just(1e308), Just(5e-324)]
}

proptest! {
    #[test]
    fn no_stamps_stop_a_stream(
        stamps in vec(any_stamp(), 1..300),
        steps in any::<bool>(),
        counted in any::<bool>(),
        bits in prop_oneof![Just(None), (1_u32..64).prop_map(Some)],
        per_second in prop_oneof![Just(1.0), Just(1e3), Just(1e6)],
        counts in vec(prop_oneof![0_u64..3, any::<u64>()], 300),
    ) {
        let uses = [Use::Time { per_second }, Use::Counter];
        let meaning = Meaning { uses: uses[..=usize::from(counted)].to_vec(), values: 0, texts: 0 };
        for link in [Link::Recording, Link::Pipe, Link::Device] {
            let (mut rows, mut taker) = (Sequence::new(&meaning, link, bits), Taker::default());
            let (mut at, mut count) = (0.0_f64, 0_u64);
            for (stamp, step) in stamps.iter().zip(&counts) {
                at = if steps && (at + stamp).is_finite() { at + stamp } else { *stamp };
                count = count.wrapping_add(*step);
                for (_, verdict) in taker.take(&mut rows, sample(at, counted.then_some(count)), *step >> 2) {
                    prop_assert!(!matches!(verdict, Verdict::Row { time_s, .. } if time_s.is_nan()), "{:?}", verdict);
                }
                prop_assert!(rows.period_s().is_none_or(|period_s| period_s > 0.0 && period_s.is_finite()));
            }
        }
    }
}
