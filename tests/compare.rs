//! The comparisons of section 5.4 against what `train` and `evaluate` tell of the same recordings.

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

use crate::util::Dir;
use lunula::job::{Outputs, Watch};
use lunula::phantom::Generated as _;
use lunula::phantom::log::{LogOptions, Protocol};
use lunula::predictor::PredictorError;
use lunula::predictor::models::{Kind, Recipe};
use lunula_thesis::compare::{CompareOptions, CompareReport, Person, compare};

/// Sums over the same rows in another order; measured 0.
const SAME_N: f64 = 1e-12;

fn log(dir: &Dir, protocol: Protocol, subject: u32, repetition: u32) -> String {
    let name = format!("{subject}-{repetition}");
    let options = LogOptions {
        subject,
        lead_s: 0.0,
        trail_s: 0.0,
        ..LogOptions::of(protocol, u64::from(10 * subject + repetition))
    };
    options.write(&dir.path(&name)).expect("a log");
    name
}

/// A person whose bending is labelled by the log's exact angles.
fn person(dir: &Dir, subject: u32) -> Person {
    let touch = |protocol, repetition| dir.path(&log(dir, protocol, subject, repetition)).join("log.csv");
    let labelled = |protocol, repetition| -> PathBuf {
        let name = log(dir, protocol, subject, repetition);
        let [joints, log, out] = ["truth/angles.csv", "log.csv", "training.csv"].map(|file| format!("{name}/{file}"));
        let more = ["--subject", "1", "--session", "1", "--no-figures", "-q"];
        dir.lunula(&[&["align", "--joints", &joints, "--log", &log, "--out", &out][..], &more].concat()).expect(0);
        dir.path(&out)
    };
    Person {
        name: subject.to_string(),
        touch: [1, 2, 3].map(|repetition| touch(Protocol::Touch, repetition)),
        touch_random: touch(Protocol::TouchRandom, 4),
        bending: labelled(Protocol::Bending, 5),
        bending_random: labelled(Protocol::BendingRandom, 6),
    }
}

fn options() -> CompareOptions {
    CompareOptions { models: [Kind::Linear, Kind::Quadratic].map(Recipe::new).to_vec(), bending_s: 60.0 }
}

fn mean(report: &CompareReport, figure: &str, group: &str, series: &str) -> f64 {
    let one = report.comparisons.iter().find(|one| one.figure == figure).expect("the figure");
    let place = |names: &[String], name: &str| names.iter().position(|n| n == name).expect("the name");
    one.cells[place(&one.groups, group)][place(&one.series, series)].mean.expect("a value")
}

#[test]
fn comparisons_are_what_train_and_prune_tell_of_the_same_recordings() {
    let dir = Dir::new();
    let one = person(&dir, 1);
    let report = compare(&[one], &options(), Some(&Outputs::all(dir.path("out"))), &Watch::nobody()).unwrap();
    let figures: Vec<&str> = report.comparisons.iter().map(|one| one.figure.as_str()).collect();
    assert_eq!(figures, ["105", "106", "108", "109", "110", "111", "112", "113"]);
    for model in ["linear", "quadratic"] {
        for (validate, figure) in [("1-3", "109"), ("1-4", "110")] {
            let train = format!("train 1-1/log.csv 1-2/log.csv --target force --model {model} --out m.json --json");
            let json = dir.words(&format!("{train} --validate {validate}/log.csv")).expect(0).json();
            for force in ["Fx_N", "Fy_N", "Fz_N"] {
                let off = |figure, rmse: &str| {
                    (mean(&report, figure, force, model) - json[rmse]["rmse"][force].as_f64().expect("a number")).abs()
                };
                assert!(
                    off(figure, "validation") <= SAME_N && off("108", "training") <= SAME_N,
                    "{model} {figure} {force}"
                );
            }
        }
    }
    let prune = ["prune", "1-1/log.csv", "1-2/log.csv", "--validate", "1-3/log.csv", "--json"];
    let json = dir.lunula(&prune).expect(0).json();
    let pruned = json["without_one"][8]["validate_rmse"]["Fz_N"].as_f64().expect("a number");
    assert!((mean(&report, "113", "P8", "Fz_N") - pruned).abs() <= SAME_N);
    // All in one place: the same figure by two ways.
    assert_eq!(mean(&report, "105", "Fy_N", "both sets"), mean(&report, "109", "Fy_N", "linear"));
    assert_eq!(mean(&report, "111", "Fy_N", "with bending"), mean(&report, "109", "Fy_N", "linear"));
    // Bending of the second half is no worse than 20 degrees for the linear model, whose photodiodes are flat beyond
    // 30; measured 12.8 to 14.3 over seven people.
    assert!((5.0..20.0).contains(&mean(&report, "112", "validation", "linear")));
    let files = dir.bytes_of("out");
    let pictures = files.keys().filter(|name| name.ends_with(".png")).count();
    assert_eq!((pictures, files.len()), (8, 18), "pictures twice, the table and run.json: {:?}", files.keys());
    assert_eq!(report.pictures.len(), 8);
}

#[test]
fn people_are_compared_and_wrong_requests_are_refused() {
    let dir = Dir::new();
    let people = [person(&dir, 1), person(&dir, 2)];
    let stop = AtomicBool::new(false);
    let watch = Watch::stopped_by(&stop);
    let found = compare(&people, &options(), None, &watch).unwrap().figures.comparisons;
    assert!(
        found.iter().flat_map(|one| one.cells.iter().flatten()).all(|cell| cell.values.len() == 2 && cell.sd.is_some())
    );
    let refused = |people: &[Person], options: &CompareOptions| match compare(people, options, None, &watch) {
        Err(PredictorError::Request(what)) => what,
        other => panic!("{:?}", other.map(|report| report.figures.people)),
    };
    assert!(refused(&[], &options()).contains("name people"));
    let twice = CompareOptions { models: vec![Recipe::new(Kind::Linear); 2], ..options() };
    assert!(refused(&people, &twice).contains("`linear` is there twice"));
    let mut joined = people[0].clone();
    let [first, second] = [0, 1].map(|k| std::fs::read_to_string(&people[0].touch[k]).unwrap());
    let both = format!("{first}{}", second.split_once('\n').unwrap().1);
    dir.write("both.csv", both);
    joined.touch[0] = dir.path("both.csv");
    let message =
        compare(&[joined], &options(), None, &watch).map(|report| report.figures.people).unwrap_err().to_string();
    assert!(message.contains("both.csv"), "{message}");
    stop.store(true, std::sync::atomic::Ordering::Relaxed);
    assert!(matches!(compare(&people, &options(), None, &watch), Err(PredictorError::Interrupted(_))));
}
