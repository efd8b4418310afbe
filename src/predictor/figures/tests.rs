use std::path::Path;

use lunula_predictor::{Dataset, Recording};
use ndarray::{Array2, array};

use super::*;
use crate::figure::draw_charts;
use crate::figure::drawn::{self, Drawn};
use crate::predictor::merit::figures::{BinMerit, ByTarget, Merit};

impl Drawn {
    /// Pixels that are not white.
    fn ink(&self) -> usize {
        self.picture.pixels().filter(|p| p.0 != [255; 3]).count()
    }

    /// Pixels of a colour of the palette, or nearly so.
    fn of(&self, colour: [u8; 3]) -> usize {
        let near = |p: &&image::Rgb<u8>| p.0.iter().zip(colour).all(|(a, b)| a.abs_diff(b) < 12);
        self.picture.pixels().filter(near).count()
    }
}

const BLUE: [u8; 3] = [0, 114, 178];
const RED: [u8; 3] = [213, 94, 0];

/// Draws a picture twice, which has to give the same bytes.
fn drawn(name: &str, draw: impl Fn(&Path, &Path) -> anyhow::Result<()>) -> Drawn {
    let [one, again] = [(); 2].map(|()| drawn::drawn(name, |png, svg| draw(png, svg).unwrap()));
    assert!(one.png == again.png && one.svg == again.svg, "{name} is drawn the same each time");
    one
}

fn names(of: &[&str]) -> Vec<String> {
    of.iter().map(|name| (*name).to_owned()).collect()
}

const FORCES: [&str; 3] = ["Fx_N", "Fy_N", "Fz_N"];

/// Spirals in `files` recordings of `rows` rows at 25 Hz, and what a model makes of them.
fn spirals(files: usize, rows: usize) -> (Dataset, Array2<f64>) {
    let all = files * rows;
    let time_s: Vec<f64> = (0..all).map(|k| (k % rows) as f64 * 0.04).collect();
    let y = Array2::from_shape_fn((all, 3), |(row, target)| {
        let t = (time_s[row] - 20.0).max(0.0);
        let reach = 0.06 * t;
        [reach * t.sin(), reach * t.cos(), -2.0 * reach][target]
    });
    let x = Array2::from_shape_fn((all, 1), |(row, _)| row as f64);
    let noise = |row: usize, target: usize| (row as f64 * (12.9 + target as f64)).sin() * 0.4;
    let predicted = Array2::from_shape_fn((all, 3), |(row, target)| 0.9 * y[[row, target]] + noise(row, target));
    let recordings = (0..files).map(|k| Recording {
        name: format!("some/where/anna-spiral{}.csv", k + 1),
        session: String::new(),
        subject: String::new(),
        rows: k * rows..(k + 1) * rows,
    });
    let data = Dataset::new(names(&["P1"]), names(&FORCES), time_s, x, y, recordings.collect()).unwrap();
    (data, predicted)
}

#[test]
fn predictions_are_drawn_over_time() {
    let (data, mut predicted) = spirals(3, 1500);
    (200..400).for_each(|row| predicted[[row, 1]] = f64::NAN);
    let (low, high) = (&predicted - 0.5, &predicted + 0.5);
    let mut all = Predicted::of(&data, predicted.view());
    let plain = drawn("time", |png, svg| draw_charts(&over_time(&all, "validation, linear model"), WIDTH, png, svg));
    assert!(plain.of(BLUE) > 2000 && plain.of(RED) > 2000, "{} {}", plain.of(BLUE), plain.of(RED));
    assert!(plain.svg.contains("anna-spiral3.csv") && plain.svg.contains("RMSE") && plain.svg.contains("Fz, N"));
    all.interval = Some(([low.view(), high.view()], 0.9));
    let banded =
        drawn("time-band", |png, svg| draw_charts(&over_time(&all, "validation, linear model"), WIDTH, png, svg));
    assert!(banded.ink() > plain.ink() && banded.svg.contains("interval for 90 % of the rows"));
    all.measured = None;
    let alone = drawn("time-alone", |png, svg| draw_charts(&over_time(&all, ""), WIDTH, png, svg));
    assert!(alone.of(BLUE) < plain.of(BLUE) / 4 && !alone.svg.contains("RMSE"));
}

#[test]
fn files_do_not_grow_with_the_rows() {
    let (data, predicted) = spirals(2, 20_000);
    let all = Predicted::of(&data, predicted.view());
    let time = drawn("time-long", |png, svg| draw_charts(&over_time(&all, "long"), WIDTH, png, svg));
    let scatter = drawn("scatter-long", |png, svg| draw_scatter(&all, "long", png, svg));
    assert!(time.svg.len() < 600_000 && scatter.svg.len() < 1_500_000, "{} {}", time.svg.len(), scatter.svg.len());
}

#[test]
fn predictions_are_drawn_against_what_was_measured() {
    let (data, predicted) = spirals(2, 1500);
    let all = Predicted::of(&data, predicted.view());
    let three = drawn("scatter", |png, svg| draw_scatter(&all, "validation", png, svg));
    assert!(three.svg.contains("validation: Fx, RMSE 0.") && three.svg.contains("measured Fz, N"));
    assert!(three.svg.matches("<circle").count() > 1000);
    let nothing = Predicted { measured: None, ..all };
    assert!(draw_scatter(&nothing, "", Path::new("x.png"), Path::new("x.svg")).is_err());
}

/// One target, one recording.
fn one(time_s: &[f64], measured: &[f64], predicted: &[f64], name: &str) -> [Drawn; 2] {
    let (targets, rows) = (names(&["J2_deg"]), time_s.len());
    let recordings = [Recording { name: "a".into(), session: String::new(), subject: String::new(), rows: 0..rows }];
    let column = |values: &[f64]| Array2::from_shape_vec((rows, 1), values.to_vec()).unwrap();
    let (measured, predicted) = (column(measured), column(predicted));
    let all = Predicted {
        targets: &targets,
        recordings: &recordings,
        time_s,
        measured: Some(measured.view()),
        predicted: predicted.view(),
        interval: Some(([predicted.view(), predicted.view()], 0.9)),
    };
    [
        drawn(&format!("{name}-time"), |png, svg| draw_charts(&over_time(&all, ""), WIDTH, png, svg)),
        drawn(&format!("{name}-scatter"), |png, svg| draw_scatter(&all, "", png, svg)),
    ]
}

/// Name, times, measured, predicted.
type Case<'a> = (&'a str, &'a [f64], &'a [f64], &'a [f64]);

#[test]
fn extremes_are_drawn() {
    const NAN: f64 = f64::NAN;
    let cases: [Case<'_>; 8] = [
        ("none", &[], &[], &[]),
        ("one", &[1.0], &[5.0], &[6.0]),
        ("constant", &[0.0, 1.0, 2.0], &[5.0; 3], &[5.0; 3]),
        ("zero", &[0.0, 1.0, 2.0], &[0.0; 3], &[0.0; 3]),
        ("nan", &[0.0, 1.0, 2.0], &[NAN; 3], &[NAN, 1.0, NAN]),
        ("untimed", &[NAN, 1.0, NAN], &[1.0, 2.0, 3.0], &[1.0, 2.5, 3.0]),
        ("huge", &[0.0, 1.0, 2.0], &[-1e300, 0.0, 1e300], &[1e300, f64::MAX, f64::INFINITY]),
        ("tiny", &[0.0, 1e-300, 2e-300], &[0.0, 1e-300, 5e-324], &[0.0, 1e-300, 0.0]),
    ];
    for (name, time_s, measured, predicted) in cases {
        for picture in one(time_s, measured, predicted, &format!("extreme-{name}")) {
            assert!(picture.ink() > 1000, "{name}: {}", picture.ink());
            assert!(!picture.svg.contains("NaN") && !picture.svg.contains("inf"), "{name}");
        }
    }
}

#[test]
fn the_error_is_that_of_the_known_rows() {
    let (data, mut predicted) = spirals(1, 100);
    predicted.assign(data.y());
    predicted.column_mut(0).mapv_inplace(|v| v + 3e200);
    predicted[[7, 1]] = f64::NAN;
    predicted[[8, 1]] += 3.0;
    let all = Predicted::of(&data, predicted.view());
    assert!((all.rmse(0).unwrap().0 / 3e200 - 1.0).abs() <= 1e-15);
    let (rmse, rows) = all.rmse(1).unwrap();
    assert!(rows == 99 && (rmse - 3.0 / 99_f64.sqrt()).abs() <= 1e-15, "{rmse}");
    assert_eq!(all.rmse(2), Some((0.0, 100)));
}

#[test]
fn modes_are_drawn() {
    let photodiodes: Vec<String> = (1..=8).map(|k| format!("P{k}")).collect();
    let u = array![[0.1, -0.98, 0.17], [-0.2, 0.15, 0.97], [0.97, 0.13, 0.18]];
    let v = Array2::from_shape_fn((8, 3), |(row, mode)| ((row * (mode + 2)) as f64 * 0.9).sin() * 0.6);
    let modes = Modes {
        targets: &names(&FORCES),
        inputs: &photodiodes,
        values: &[5.43, 2.1, 0.000_87],
        unit: "N/V",
        of_targets: u.view(),
        of_inputs: v.view(),
    };
    let three = drawn("modes", |png, svg| draw_modes(&modes, png, svg));
    assert!(three.svg.contains("= 5.43 N/V") && three.svg.contains("P8") && three.svg.contains("Fx"));
    assert!(three.of(BLUE) > 2000 && three.of(RED) > 2000);
    let (whole, first) = (array![[1.0]], v.select(ndarray::Axis(1), &[0]));
    let single = Modes {
        targets: &names(&["J2_deg"]),
        values: &[f64::NAN],
        unit: "",
        of_targets: whole.view(),
        of_inputs: first.view(),
        ..modes
    };
    assert!(drawn("modes-one", |png, svg| draw_modes(&single, png, svg)).ink() > 5000);
}

#[test]
fn bars_are_drawn_in_groups() {
    let removed = |shift: f64| (0..9).map(|k| Some(0.5 + shift + 0.05 * (k * k % 7) as f64)).collect::<Vec<_>>();
    let series = |name: &str, shift: f64, errors: Vec<Option<f64>>| BarSeries {
        name: name.into(),
        values: removed(shift),
        errors,
    };
    let mut groups = names(&["none"]);
    groups.extend((1..=8).map(|k| format!("P{k}")));
    let mut bars = Bars {
        title: "Validation error of the linear model with a photodiode removed".into(),
        x_label: "photodiode removed".into(),
        y_label: "RMSE, N".into(),
        groups,
        series: vec![
            series("Fx_N", 0.0, vec![Some(0.1); 9]),
            series("Fy_N", 0.1, vec![]),
            series("Fz_N", 0.6, vec![Some(f64::NAN), Some(0.3)]),
        ],
    };
    let full = drawn("bars", |png, svg| draw_bars(std::slice::from_ref(&bars), png, svg));
    assert!(full.svg.contains("none") && full.svg.contains("P8") && full.svg.contains("photodiode removed"));
    bars.series[0].values = vec![None, Some(f64::NAN), Some(-0.5), Some(0.0), Some(f64::INFINITY)];
    let holes = drawn("bars-holes", |png, svg| draw_bars(std::slice::from_ref(&bars), png, svg));
    assert!(holes.of(BLUE) < full.of(BLUE) && holes.ink() > 10_000);
    assert!(drawn("bars-none", |png, svg| draw_bars(&[Bars::default()], png, svg)).ink() > 1000);
}

#[test]
fn errors_are_drawn_by_the_size_of_the_force() {
    let bin = |from: f64, to: f64, rows| {
        let rmse = ByTarget::new(&names(&FORCES), [0.2 + from / 10.0, f64::NAN, 0.4 + from / 5.0]);
        let (bias, mae, r2) = (rmse.clone(), rmse.clone(), ByTarget::new(&names(&FORCES), [None; 3]));
        BinMerit { from, to, merit: Merit { rows, not_finite: 0, rmse, bias, r2, mae } }
    };
    let bins = [bin(0.0, 0.5, 12_000), bin(0.5, 1.0, 340), bin(1.0, 2.0, 400)];
    let picture = drawn("magnitude", |png, svg| {
        draw_bars(&[error_by_magnitude("Error by the size of the force", "N", &names(&FORCES), &bins)], png, svg)
    });
    assert!(picture.svg.contains("0.5 to 1 N") && picture.svg.contains("340 rows"));
}

#[test]
fn the_best_subsets_are_named() {
    let photodiodes: Vec<String> = (1..=8).map(|k| format!("P{k}")).collect();
    let best = |n: usize| Subset { photodiodes: photodiodes[..n].to_vec(), error: 0.6 + 1.2 / n as f64 };
    let best: Vec<Subset> = (1..=8).map(best).collect();
    let (title, label) = ("Best photodiodes of each number", "RMSE on held-out rows, N");
    let chart = best_subsets(title, label, &photodiodes, "Fz_N", &best);
    let picture = drawn("subsets", |png, svg| draw_charts(std::slice::from_ref(&chart), WIDTH, png, svg));
    assert!(picture.svg.contains("P1 P2 P3") && picture.svg.contains("all but P7 P8"), "names");
}

#[test]
fn learning_curves_are_drawn() {
    let point = |k: usize, y: f64| [500.0 * k as f64, y + 1.0 / k as f64];
    let mut series = ["trained on", "held out"].map(|name| LearningSeries {
        name: name.into(),
        points: (1..=12).map(|k| point(k, if name == "held out" { 0.6 } else { 0.2 })).collect(),
    });
    series[1].points[5][1] = f64::NAN;
    let draw = |series: &[LearningSeries], name: &str| {
        let chart = learning_curve("Error by training rows", "training rows", "RMSE of Fz, N", series);
        drawn(name, |png, svg| draw_charts(std::slice::from_ref(&chart), WIDTH, png, svg))
    };
    let curve = draw(&series, "learning");
    assert!(curve.of(BLUE) > 500 && curve.of(RED) > 500 && curve.svg.contains("held out"));
    assert!(draw(&[], "learning-none").ink() > 1000 && curve.png != draw(&series[..1], "learning-one").png);
}
