use std::f64::consts::TAU;

use super::*;
use crate::align::label::{Unlabelled, label};
use crate::align::posture::ClockColumns;
use crate::align::tie::by_clock;
use crate::figure::drawn::drawn;
use crate::timebase::Timebase;

/// Bending at 0.1 Hz filmed at 30 frames a second with a tenths clock; of every `every` frames `lost` are lost.
fn posture(seconds: f64, every: usize, lost: usize) -> Posture {
    let time_s: Vec<f64> = (0..(30.0 * seconds) as usize).map(|k| k as f64 / 29.97).collect();
    let j2 = |t: f64| 35.0 - 40.0 * (TAU * 0.1 * t).cos();
    let seen = |k: usize, angle: f64| if k % every >= every - lost { f64::NAN } else { angle };
    let counts = |t: &f64| 65.03 + (1.0 + 45e-6) * t;
    let angles_deg = vec![
        time_s.iter().map(|&t| 10.0 + 2.0 * (TAU * 0.03 * t).sin()).collect(),
        time_s.iter().enumerate().map(|(k, &t)| seen(k, j2(t))).collect(),
        time_s.iter().enumerate().map(|(k, &t)| seen(k, 0.46 * j2(t) - 8.0)).collect(),
    ];
    Posture {
        clock_s: time_s.iter().map(counts).collect(),
        clock: Some(ClockColumns {
            read_s: time_s.iter().map(|t| (counts(t) * 10.0).floor() / 10.0).collect(),
            sd_s: vec![0.003; time_s.len()],
            low_s: time_s.iter().map(|t| counts(t) - 0.005).collect(),
            high_s: time_s.iter().map(|t| counts(t) + 0.005).collect(),
        }),
        sds_deg: vec![vec![0.4; time_s.len()], vec![0.6; time_s.len()], vec![1.2; time_s.len()]],
        ..Posture::of(time_s, angles_deg, 0.0)
    }
}

/// Eight photodiodes at 25 Hz from 5 s before the clock's start on; one dead, one without a value.
fn samples(start_s: f64, seconds: f64) -> Samples {
    let time_s: Vec<f64> = (0..(25.0 * seconds) as usize).map(|k| start_s - 5.0 + k as f64 / 25.0).collect();
    let value = |p: usize, t: f64| match p {
        3 => 2.5,
        5 => f64::NAN,
        _ => 1.0 + 0.1 * p as f64 - 0.3 * (TAU * 0.1 * (t - start_s)).cos() + 0.02 * (TAU * 1.1 * t).sin(),
    };
    let channel =
        |p: usize| Channel { name: format!("P{}", p + 1), values: time_s.iter().map(|&t| value(p, t)).collect() };
    Samples {
        photodiodes: (0..8).map(channel).collect(),
        faults: vec![String::new(); time_s.len()],
        time_s,
        ..Samples::default()
    }
}

fn clock(posture: &Posture, samples: &Samples) -> Tie {
    by_clock(posture, &samples.time_s, None, Some(0.0)).unwrap()
}

fn grey(picture: &image::RgbImage) -> usize {
    picture.pixels().filter(|p| p.0 == [226, 226, 226]).count()
}

#[test]
fn a_clocks_tie_is_drawn_with_what_its_readings_leave_open() {
    for (name, seconds) in [("tie", 20.0), ("tie-hour", 3600.0)] {
        let (posture, samples) = (posture(seconds, 100, 0), samples(65.0, seconds));
        let tie = clock(&posture, &samples);
        let picture = drawn(name, |png, svg| assert!(draw_tie(&tie, &posture, png, svg).unwrap()));
        assert_eq!(picture.picture.dimensions(), (WIDTH, TIE_PX));
        for words in
            ["Tied by the clock in the picture: offset 65.0", "ppm", "last digit, 50 ms", "standard error of the tie"]
        {
            assert!(picture.svg.contains(words), "{words}");
        }
        // Measured 0.07 MB and 0.33 MB.
        assert!(picture.svg.len() < 600_000, "{name}: {}", picture.svg.len());
    }
}

#[test]
fn other_ties_are_drawn_where_they_leave_something_over() {
    let posture = posture(20.0, 100, 0);
    let timebase = Timebase {
        reference_s: 0.0,
        at_reference_s: -3.25,
        at_reference_sd_s: f64::NAN,
        drift: 0.0,
        drift_sd: f64::NAN,
    };
    let mut tie =
        Tie { method: TieMethod::Offset, timebase, residuals_s: Vec::new(), ..clock(&posture, &samples(65.0, 20.0)) };
    tie.offset_interval_s = None;
    assert!(!draw_tie(&tie, &posture, Path::new("no.png"), Path::new("no.svg")).unwrap());
    tie.residuals_s = vec![[3.0, 0.004]];
    let picture = drawn("tie-one", |png, svg| assert!(draw_tie(&tie, &posture, png, svg).unwrap()));
    assert!(picture.svg.contains("offset \u{2212}3.250 s, drift 0 ppm") && !picture.svg.contains("standard error"));
}

#[test]
fn labels_are_drawn_below_the_photodiodes() {
    for (name, seconds, every, lost, start_s) in [
        ("labels", 20.0, 200, 30, 65.03),
        ("labels-hour", 3600.0, 9000, 300, 65.03),
        ("labels-few", 60.0, 100, 90, 65.03),
    ] {
        let (posture, samples) = (posture(seconds, every, lost), samples(start_s, seconds + 15.0));
        let labels = label(&posture, &samples, &clock(&posture, &samples), None, 0.0);
        let picture = drawn(name, |png, svg| draw_labels(&samples, &labels, png, svg).unwrap());
        assert_eq!(picture.picture.dimensions(), (WIDTH, 90 + 8 * LANE_PX + 460));
        assert!(grey(&picture.picture) > 5000, "{name}");
        for words in ["a label is missing", "P4: 2.500 to 2.500 V", "P6: no value", "time of the log, s"] {
            assert!(picture.svg.contains(words), "{words}");
        }
        // Measured 0.10 MB, 0.31 MB and 0.18 MB.
        assert!(picture.svg.len() < 600_000, "{name}: {}", picture.svg.len());
    }
}

#[test]
fn sets_without_photodiodes_labels_or_rows_are_drawn() {
    let (posture, all) = (posture(5.0, 100, 0), samples(1.7e9, 20.0));
    let tie = Tie {
        timebase: Timebase {
            at_reference_s: 1.7e9,
            reference_s: 0.0,
            ..clock(&posture, &samples(65.0, 20.0)).timebase
        },
        ..clock(&posture, &samples(65.0, 20.0))
    };
    let labels = label(&posture, &all, &tie, None, 0.0);
    let picture = drawn("labels-epoch", |png, svg| draw_labels(&all, &labels, png, svg).unwrap());
    assert!(picture.svg.contains("time of the log less 1699999995, s"));
    let bare = Samples { photodiodes: Vec::new(), ..all.clone() };
    let picture = drawn("labels-bare", |png, svg| draw_labels(&bare, &labels, png, svg).unwrap());
    assert_eq!(picture.picture.height(), 460);
    let none =
        Labels { angles_deg: vec![vec![f64::NAN; 500]; 3], unlabelled: vec![Some(Unlabelled::Gap); 500], ..labels };
    drawn("labels-none", |png, svg| draw_labels(&all, &none, png, svg).unwrap());
    let empty = samples(65.0, 0.0);
    let labels = label(&posture, &empty, &tie, None, 0.0);
    drawn("labels-empty", |png, svg| draw_labels(&empty, &labels, png, svg).unwrap());
}
