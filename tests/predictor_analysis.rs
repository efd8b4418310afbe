//! `lunula analyse` and `lunula prune` from end to end, against values that are known.

use crate::util::sensor::{Recording, near, numbers, offset, slopes, volt};
use crate::util::{Dir, Json};
use serde_json::Value;

/// Of a few operations on exact coefficients (measured: 3e-16).
const EXACT: f64 = 1e-14;

/// A model whose Jacobian is `rows`, targets Fx, Fy, Fz over P1, P2, ..: the tables are made so.
fn model_of(dir: &Dir, rows: &[&[f64]]) {
    let inputs: Vec<String> = (1..=rows[0].len()).map(|k| format!("P{k}")).collect();
    let targets = ["Fx_N", "Fy_N", "Fz_N"];
    let columns: Vec<&str> = ["time_s"]
        .into_iter()
        .chain(inputs.iter().map(String::as_str))
        .chain(targets.into_iter().take(rows.len()))
        .collect();
    let base = Recording::of(0..100).only(&columns);
    let log = rows.iter().zip(targets).fold(base, |all, (row, target)| {
        all.map(target, |k, _| row.iter().enumerate().map(|(input, slope)| slope * volt(k, input)).sum())
    });
    dir.recording("a.csv", &log);
    let names = targets[..rows.len()].join(",");
    dir.train("a.csv", &names, "m.json", &["-q"]).expect(0);
}

fn by_name(value: &Value, names: &[&str]) -> Vec<f64> {
    names.iter().map(|name| value[*name].number()).collect()
}

#[test]
fn modes_are_those_of_the_jacobian_with_signs_fixed() {
    let dir = Dir::new();
    // Orthogonal rows: their lengths are the singular values, the targets are the modes.
    model_of(&dir, &[&[0.0, 0.5, -0.5, 0.0], &[2.0, 0.0, 0.0, 0.0], &[0.0, 3.0, 3.0, 0.0]]);
    let report = dir.lunula(&["analyse", "m.json", "--json"]).expect(0).json();
    let modes = report["modes"].list();
    let (half, targets, inputs) = (0.5_f64.sqrt(), ["Fx_N", "Fy_N", "Fz_N"], ["P1", "P2", "P3", "P4"]);
    let wanted = [
        (18f64.sqrt(), [0.0, 0.0, 1.0], [0.0, half, half, 0.0]),
        (2.0, [0.0, 1.0, 0.0], [1.0, 0.0, 0.0, 0.0]),
        (half, [1.0, 0.0, 0.0], [0.0, half, -half, 0.0]),
    ];
    assert_eq!(modes.len(), 3);
    for (mode, (value, of_targets, of_inputs)) in modes.iter().zip(wanted) {
        near(&by_name(mode, &["singular_value"]), &[value], EXACT);
        near(&by_name(&mode["targets"], &targets), &of_targets, EXACT);
        near(&by_name(&mode["inputs"], &inputs), &of_inputs, EXACT);
    }
    near(&by_name(&report, &["condition"]), &[6.0], EXACT);
    assert_eq!(
        (&report["job"], &report["at_v"], &report["inputs"]),
        (&"analyse".into(), &Value::Null, &serde_json::json!(inputs))
    );
    near(&numbers(&report["jacobian"]["Fz_N"]), &[0.0, 3.0, 3.0, 0.0], EXACT);
    dir.lunula(&["analyse", "m.json"])
        .expect(0)
        .prints("mode 1: singular value 4.24264")
        .prints("the strongest over the weakest: 6.00");
}

#[test]
fn the_model_is_printed_as_in_the_thesis() {
    let dir = Dir::new();
    dir.recording("a.csv", &Recording::of(0..120));
    dir.train("a.csv", "force", "m.json", &["-q"]).expect(0);
    let printed = &dir.lunula(&["analyse", "m.json", "--json"]).expect(0).json()["printed"];
    for (t, target) in ["Fx_N", "Fy_N", "Fz_N"].iter().enumerate() {
        near(&numbers(&printed["jacobian"][target]), &slopes(t), EXACT);
        near(&by_name(&printed["offset"], &[target]), &[offset(t)], 1e-13);
    }
    assert_eq!(printed["terms"].list().len(), 8);
}

#[test]
fn a_nonlinear_model_is_reported_at_the_middle() {
    let dir = Dir::new();
    let base = Recording::of(0..100).only(&["time_s", "P1", "P2", "Fz_N"]);
    let (p1, p2) = (base.numbers("P1"), base.numbers("P2"));
    dir.recording("a.csv", &base.map("Fz_N", |row, _| p1[row] * p1[row] - 3.0 * p2[row]));
    dir.train("a.csv", "Fz_N", "m.json", &["--model", "quadratic", "-q"]).expect(0);
    let answer = dir.lunula(&["analyse", "m.json", "--json"]).expect(0);
    let report = answer.json();
    let middle = numbers(&report["at_v"]);
    near(&middle, &[p1.iter().sum::<f64>() / 100.0, p2.iter().sum::<f64>() / 100.0], 1e-12);
    near(&numbers(&report["jacobian"]["Fz_N"]), &[2.0 * middle[0], -3.0], 1e-11);
    near(&by_name(&report["modes"][0], &["singular_value"]), &[(4.0 * middle[0] * middle[0] + 9.0).sqrt()], 1e-11);
    assert_eq!(report["printed"]["terms"], serde_json::json!(["P1", "P2", "P1^2", "P1 P2", "P2^2"]));
    near(&numbers(&report["printed"]["jacobian"]["Fz_N"]), &[0.0, -3.0, 1.0, 0.0, 0.0], 1e-11);
    answer.says("the model is not linear");

    let few = ["--model", "network", "--hidden", "2", "--restarts", "1", "--epochs", "30", "-q"];
    dir.train("a.csv", "Fz_N", "n.json", &few).expect(0);
    let network = dir.lunula(&["analyse", "n.json", "--json", "-q"]).expect(0).json();
    assert!(network["printed"].is_null() && network["modes"][0]["singular_value"].number() > 0.0, "{network}");
    // A lag is an input as any other.
    dir.train("a.csv", "Fz_N", "l.json", &["--lags", "0.04", "-q"]).expect(0);
    let lagged = dir.lunula(&["analyse", "l.json", "--json"]).expect(0).json();
    assert_eq!(lagged["inputs"], serde_json::json!(["P1", "P2", "P1@-0.04s", "P2@-0.04s"]));
}

#[test]
fn a_target_that_depends_on_nothing_has_no_condition() {
    let dir = Dir::new();
    model_of(&dir, &[&[1.0, 2.0], &[0.0, 0.0]]);
    let report = dir.lunula(&["analyse", "m.json", "--json", "--out", "an"]).expect(0).json();
    assert_eq!(report["modes"][1]["singular_value"], 0.0);
    assert!(report["condition"].is_null(), "{report}");
    let found = dir.bytes_of("an");
    assert_eq!(found.keys().collect::<Vec<_>>(), ["modes.csv", "modes.png", "modes.svg", "run.json"]);
    assert_eq!(dir.parsed("an/run.json"), report);
    let rows = dir.table("an/modes.csv");
    assert_eq!(dir.text("an/modes.csv").lines().next(), Some("mode,singular_value,Fx_N,Fy_N,P1,P2"));
    assert!((rows[0]["singular_value"].parse::<f64>().unwrap() - 5f64.sqrt()).abs() <= EXACT && rows.len() == 2);
    image::load_from_memory(&found["modes.png"]).expect("a picture");
}

/// Training and validation rows of a force that is 3 P1 + P2 + P3 / 4, and nothing of P4.
fn graded(dir: &Dir) {
    for (name, rows) in [("a.csv", 0..200), ("b.csv", 200..300)] {
        let first = rows.start;
        let force = |row: usize, _: f64| 3.0 * volt(first + row, 0) + volt(first + row, 1) + volt(first + row, 2) / 4.0;
        dir.recording(name, &Recording::of(rows).only(&["time_s", "P1", "P2", "P3", "P4", "Fz_N"]).map("Fz_N", force));
    }
}

fn names_of(row: &Value) -> String {
    row["inputs"].list().iter().map(|name| name.words()).collect::<Vec<_>>().join(" ")
}

#[test]
fn every_subset_is_compared_and_the_best_of_each_size_reported() {
    let dir = Dir::new();
    graded(&dir);
    let prune = ["prune", "a.csv", "--validate", "b.csv", "--target", "Fz_N"];
    let report = dir.lunula(&[&prune[..], &["--json", "--out", "pr"]].concat()).expect(0).json();
    assert_eq!((&report["job"], &report["subsets"]), (&"prune".into(), &15.into()));
    let best: Vec<String> = report["best_of_size"].list().iter().map(names_of).collect();
    assert_eq!(&best[..3], ["P1", "P1 P2", "P1 P2 P3"]);
    let rmse = |row: &Value| row["validate_rmse"]["Fz_N"].number();
    let errors: Vec<f64> = report["best_of_size"].list().iter().map(rmse).collect();
    assert!(errors[0] > errors[1] && errors[1] > errors[2] && errors[2] <= EXACT, "{errors:?}");
    let without: Vec<(String, f64)> =
        report["without_one"].list().iter().map(|row| (names_of(row), rmse(row))).collect();
    let names: Vec<&str> = without.iter().map(|(names, _)| names.as_str()).collect();
    assert_eq!(names, ["P1 P2 P3 P4", "P2 P3 P4", "P1 P3 P4", "P1 P2 P4", "P1 P2 P3"]);
    assert!(without[1].1 > without[2].1 && without[2].1 > without[3].1 && without[4].1 <= EXACT, "{without:?}");
    // No photodiode at all is the training rows' mean.
    let (train, predicted): (Vec<f64>, Vec<f64>) = {
        let force = |row: usize| 3.0 * volt(row, 0) + volt(row, 1) + volt(row, 2) / 4.0;
        ((0..200).map(force).collect(), (200..300).map(force).collect())
    };
    let mean = train.iter().sum::<f64>() / 200.0;
    let none = (predicted.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / 100.0).sqrt();
    near(&by_name(&report["none"], &["Fz_N"]), &[none], 1e-12);

    // Of another sensor, whose photodiodes come in another order, no subset says anything.
    assert!(!report["warnings"].to_string().contains("as large as with none"), "{}", report["warnings"]);
    dir.write("order.csv", dir.text("b.csv").replacen("P1,P2,P3,P4", "P4,P3,P2,P1", 1));
    let other = ["prune", "a.csv", "--validate", "order.csv", "--target", "Fz_N"];
    dir.lunula(&other).expect(0).says("the errors with all photodiodes are as large as with none of them: Fz_N (");
    // Each subset's figures are those of a model trained on it.
    let rows = dir.table("pr/subsets.csv");
    assert_eq!(rows.len(), 15);
    assert_eq!(
        dir.text("pr/subsets.csv").lines().next(),
        Some("photodiodes,inputs,rank,Fz_N_train_rmse,Fz_N_validate_rmse,score")
    );
    let row = rows.iter().find(|row| row["inputs"] == "P1 P4").unwrap();
    let more = ["--inputs", "P1,P4", "--validate", "b.csv", "--json"];
    let model = dir.train("a.csv", "Fz_N", "m.json", &more).expect(0).json();
    for (column, part) in [("Fz_N_train_rmse", "training"), ("Fz_N_validate_rmse", "validation")] {
        near(&[row[column].parse().unwrap()], &[model[part]["rmse"]["Fz_N"].number()], 1e-12);
    }
    let found = dir.bytes_of("pr");
    let names: Vec<&str> = found.keys().map(String::as_str).collect();
    assert_eq!(
        names,
        ["best-of-size.png", "best-of-size.svg", "run.json", "subsets.csv", "without-one.png", "without-one.svg"]
    );
    dir.lunula(&prune).expect(0).prints("15 subsets").prints("all, then all but one");
}

#[test]
fn photodiodes_that_depend_on_each_other_make_no_model_and_the_others_do() {
    let dir = Dir::new();
    graded(&dir);
    for name in ["a.csv", "b.csv"] {
        let table = dir.table(name);
        let base = if name == "a.csv" { Recording::of(0..200) } else { Recording::of(200..300) };
        let whole = base.only(&["P1", "P2", "P3", "P4", "Fz_N"]);
        let whole = whole.with("P3", |row, _| table[row]["P2"].clone()).with("P4", |_, _| "1.5".to_owned());
        dir.recording(name, &whole.with("Fz_N", |row, _| table[row]["Fz_N"].clone()));
    }
    let answer =
        dir.lunula(&["prune", "a.csv", "--validate", "b.csv", "--target", "Fz_N", "--json", "--out", "pr"]).expect(0);
    let report = answer.json();
    answer.says("P4 is 1.5 V in all 200 rows");
    let rows = dir.table("pr/subsets.csv");
    assert_eq!(rows.len(), 15);
    for row in &rows {
        let names: Vec<&str> = row["inputs"].split(' ').collect();
        let (double, dead) = (names.contains(&"P2") && names.contains(&"P3"), names.contains(&"P4"));
        let rank = names.len() - usize::from(double) - usize::from(dead);
        assert_eq!(row["rank"], rank.to_string(), "{names:?}");
        assert_eq!(row["Fz_N_validate_rmse"].is_empty(), double || dead, "{names:?}");
        assert_eq!(row["score"].is_empty(), double || dead, "{names:?}");
    }
    let best: Vec<String> = report["best_of_size"].list().iter().map(names_of).collect();
    // Of equals the first; of three and four there is no model.
    assert_eq!(best, ["P1", "P1 P2"]);
    assert!(report["without_one"][0]["validate_rmse"].is_null());
    let plain = dir.lunula(&["prune", "a.csv", "--validate", "b.csv", "--target", "Fz_N"]).expect(0).stdout;
    assert!(plain.contains("dependent on each other: no one model"), "{plain}");
}

#[test]
fn of_seventeen_photodiodes_the_one_missed_least_is_removed_again_and_again() {
    let dir = Dir::new();
    let names: Vec<String> = (1..=17).map(|k| format!("P{k}")).collect();
    for (name, rows) in [("a.csv", 0..300), ("b.csv", 300..400)] {
        let first = rows.start;
        let wide = (9..=17).fold(Recording::of(rows), |all, k| {
            all.with(&format!("P{k}"), |row, _| volt(first + row, k - 1).to_string())
        });
        // Each photodiode counts twice as much as the one before, from P17 down.
        let force = |row: usize, _: f64| (0..17).map(|k| 2f64.powi(-(k as i32)) * volt(first + row, k)).sum();
        dir.recording(name, &wide.map("Fz_N", force));
    }
    let report = dir.words("prune a.csv --validate b.csv --target Fz_N --json --out pr").expect(0).json();
    assert_eq!((&report["subsets"], &report["inputs"]), (&17.into(), &serde_json::json!(names)));
    for (k, row) in report["best_of_size"].list().iter().enumerate() {
        assert_eq!(names_of(row), names[..=k].join(" "), "the strongest {} are left", k + 1);
    }
    assert!(report["left_out"].to_string().contains("2^17"), "{}", report["left_out"]);
    assert_eq!(report["without_one"], serde_json::json!([]));
    assert!(dir.path("pr/best-of-size.png").is_file() && !dir.path("pr/without-one.png").exists());
    assert_eq!(dir.table("pr/subsets.csv").len(), 17);
    // Sixteen are compared in every way.
    let sixteen = names[..16].join(",");
    let few = ["prune", "a.csv", "--validate", "b.csv", "--target", "Fz_N", "--inputs", &sixteen, "--json"];
    assert_eq!(dir.lunula(&few).expect(0).json()["subsets"], 65_535);
}

#[test]
fn a_request_that_is_wrong_says_so() {
    let dir = Dir::new();
    graded(&dir);
    dir.lunula(&["prune", "a.csv"]).expect(2).says("--validate");
    let millivolts = ["P1", "P2", "P3", "P4"]
        .into_iter()
        .fold(Recording::of(200..300), |all, name| all.map(name, |_, volts| 1000.0 * volts));
    dir.recording("mV.csv", &millivolts);
    dir.words("prune a.csv --validate mV.csv --target Fz_N --inputs P1,P2,P3,P4").expect(0).says("in another unit?");
    dir.lunula(&["prune", "a.csv", "--validate", "b.csv"]).expect(2).says("has no column `Fx_N`. Its columns are");
    dir.lunula(&["prune", "a.csv", "--validate", "nowhere.csv", "--target", "Fz_N"]).expect(2).says("nowhere.csv");
    dir.recording("c.csv", &Recording::of(0..50).without("P4"));
    dir.words("prune a.csv --validate c.csv --target Fz_N").expect(2).says("c.csv: has no column `P4`");
    dir.lunula(&["analyse", "nowhere.json"]).expect(2).says("nowhere.json: is not there");
    dir.lunula(&["analyse", "a.csv"]).expect(2).says("a.csv: is no model of lunula");
    let same = dir.lunula(&["prune", "a.csv", "--validate", "a.csv", "--target", "Fz_N"]).expect(0);
    same.says("200 of 200 rows to compare on are among those trained on; their errors flatter");
}
