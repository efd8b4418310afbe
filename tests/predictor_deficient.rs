//! `lunula train` on rows that do not determine the model: which photodiodes are at fault is reported, and what was
//! asked for is done.

use crate::util::sensor::{Recording, TARGETS, near, numbers, slope, volt};
use crate::util::{Dir, Json};
use serde_json::Value;

/// Of a fit to exact numbers (measured: 1e-16 to 5e-16).
const EXACT: f64 = 1e-14;

fn dir_with(recording: &Recording) -> Dir {
    let dir = Dir::new();
    dir.recording("a.csv", recording);
    dir
}

/// The coefficients of the forces, and the report's fit.
#[track_caller]
fn fitted(dir: &Dir, deficient: &str) -> (Vec<Vec<f64>>, Value) {
    let report = dir.train("a.csv", "force", "m.json", &["--deficient", deficient, "--json"]).expect(0).json();
    let model = dir.parsed("m.json");
    let jacobian = (0..3).map(|t| numbers(&model["model"]["jacobian"][t])).collect();
    (jacobian, report["fit"]["least_squares"].clone())
}

#[track_caller]
fn refused(recording: &Recording, words: &str) {
    let dir = dir_with(recording);
    dir.train("a.csv", "force", "m.json", &[]).expect(2).says(words).says("minimum norm, dropping or ridge");
    assert!(!dir.path("m.json").exists());
}

/// The forces without photodiode `k`'s share, so that what is left is exact.
fn without_share(recording: Recording, k: usize) -> Recording {
    let volts = recording.numbers(&format!("P{}", k + 1));
    ["Fx_N", "Fy_N", "Fz_N"]
        .iter()
        .enumerate()
        .fold(recording, |all, (t, target)| all.map(target, |row, force| force - slope(t, k) * volts[row]))
}

#[test]
fn a_dead_photodiode_is_named_and_gets_nothing() {
    for value in ["0", "2.1"] {
        let dead = without_share(Recording::of(0..120), 2).with("P3", |_, _| value.to_owned());
        refused(&dead, "P3 is constant");
        let dir = dir_with(&dead);
        for how in ["minimum-norm", "drop", "ridge=1e-12"] {
            let (jacobian, fit) = fitted(&dir, how);
            // A ridge of 1e-12 shrinks by as much.
            let most = if how.starts_with("ridge") { 1e-11 } else { EXACT };
            for (t, row) in jacobian.iter().enumerate() {
                let wanted: Vec<f64> = (0..8).map(|k| if k == 2 { 0.0 } else { slope(t, k) }).collect();
                near(row, &wanted, most);
                assert_eq!(row[2], 0.0, "{how}");
            }
            assert_eq!(fit["rank"], 7);
            let dropped = if how == "drop" { serde_json::json!(["P3"]) } else { serde_json::json!([]) };
            assert_eq!(fit["dropped"], dropped, "{how}");
            assert!(fit["warnings"][0].words().contains("7 of 8 terms"), "{fit}");
        }
        let note = format!("a.csv: P3 is {value} V in all 120 rows: dead or not connected");
        dir.train("a.csv", "force", "m.json", &["--deficient", "drop"]).expect(0).says(&note);
        // Several, and the quadratic model's products are not reported beside what explains them.
        let several = dead.with("P7", |_, _| "1".to_owned());
        refused(&several, "P3 is constant; P7 is constant (");
        let dir = dir_with(&several);
        dir.train("a.csv", "force", "m.json", &["--model", "quadratic"])
            .expect(2)
            .says("P3 is constant; P7 is constant (");
        // A network gives it no weight, and says so.
        let network = ["--model", "network", "--hidden", "2", "--restarts", "1", "--epochs", "3"];
        dir.train("a.csv", "force", "m.json", &network)
            .expect(0)
            .says("P7 is 1.0 in all training rows: its weights are 0");
        let model = dir.parsed("m.json");
        for node in model["model"]["hidden_weights"].list() {
            assert_eq!((numbers(node)[2], numbers(node)[6]), (0.0, 0.0));
        }
    }
}

#[test]
fn a_duplicated_photodiode_is_named_and_shares_or_is_dropped() {
    let base = Recording::of(0..120);
    let p2 = base.numbers("P2");
    let double = without_share(base, 4).with("P5", |row, _| p2[row].to_string());
    refused(&double, "P2 and P5 read alike");
    let dir = dir_with(&double);
    let (shared, fit) = fitted(&dir, "minimum-norm");
    assert_eq!(fit["rank"], 7);
    for (t, row) in shared.iter().enumerate() {
        near(&[row[1], row[4]], &[slope(t, 1) / 2.0; 2], EXACT);
        near(&[row[0], row[7]], &[slope(t, 0), slope(t, 7)], EXACT);
    }
    let (dropped, fit) = fitted(&dir, "drop");
    let gone = fit["dropped"][0].words().to_owned();
    assert!(gone == "P2" || gone == "P5", "{gone}");
    for (t, row) in dropped.iter().enumerate() {
        let (kept, left) = if gone == "P5" { (row[1], row[4]) } else { (row[4], row[1]) };
        near(&[kept, left], &[slope(t, 1), 0.0], EXACT);
    }
    // Alike up to offset and scale, and a sum of others.
    refused(&double.clone().map("P5", |_, v| 4.0 * v - 3.0), "P2 and P5 read alike");
    let p7 = double.numbers("P7");
    refused(&double.map("P5", |row, v| v + 2.0 * p7[row]), "P5 follows from P2 and P7");
}

#[test]
fn a_nearly_collinear_photodiode_is_fitted_with_a_warning() {
    let base = Recording::of(0..120);
    let p2 = base.numbers("P2");
    let tiny = 2f64.powi(-30);
    // P5 is P2 and a trace of its own; the forces have the trace's share.
    let near_collinear = base.map("P5", |row, v| p2[row] + tiny * (v - 2.0));
    let p5: Vec<f64> = near_collinear.numbers("P5");
    let forced = ["Fx_N", "Fy_N", "Fz_N"].iter().enumerate().fold(near_collinear, |all, (t, target)| {
        let own: Vec<f64> = (0..120).map(|row| slope(t, 4) * (p5[row] - volt(row, 4))).collect();
        all.map(target, |row, v| v + own[row])
    });
    let dir = dir_with(&forced);
    let answer = dir.train("a.csv", "force", "m.json", &["--json"]).expect(0);
    let report = answer.json();
    answer.says("warning: P2 and P5 hardly differ");
    let fit = &report["fit"]["least_squares"];
    assert_eq!(fit["rank"], 8);
    assert!(fit["digits"].number() < 8.0 && fit["condition"].number() > 1e8, "{fit}");
    for t in 0..3 {
        let row = numbers(&dir.parsed("m.json")["model"]["jacobian"][t]);
        // At least 5 digits where the numbers of the table allow 7.
        near(&[row[1], row[4]], &[slope(t, 1), slope(t, 4)], 1e-5);
        near(&[row[0], row[3]], &[slope(t, 0), slope(t, 3)], 1e-5);
    }
}

#[test]
fn fewer_rows_than_terms_exactly_as_many_and_one() {
    for rows in [1, 8] {
        let few = Recording::of(0..rows);
        refused(&few, &format!("8 terms need at least 9 rows; there are {rows}"));
        let dir = dir_with(&few);
        for how in ["minimum-norm", "drop"] {
            let (_, fit) = fitted(&dir, how);
            assert_eq!((&fit["rank"], &fit["residual_sd"][0]), (&(rows - 1).into(), &Value::Null), "{how}");
            let said = dir.lunula(&["evaluate", "m.json", "a.csv", "--json"]).expect(0).json();
            assert!(said["rmse"]["Fz_N"].number() <= EXACT, "{said}");
        }
        fitted(&dir, "ridge=1e-6");
    }
    // One row more than there are terms determines them, and leaves nothing to judge them by.
    let dir = dir_with(&Recording::of(0..9));
    let (jacobian, fit) = fitted(&dir, "refuse");
    for (t, row) in jacobian.iter().enumerate() {
        near(row, &(0..8).map(|k| slope(t, k)).collect::<Vec<_>>(), 1e-12);
    }
    assert!(fit["warnings"].to_string().contains("9 rows determine the terms exactly"), "{fit}");
    assert_eq!(fit["residual_sd"], serde_json::json!([null, null, null]));
    let quadratic = dir.train("a.csv", "force", "m.json", &["--model", "quadratic"]).expect(2);
    quadratic.says("44 terms need at least 45 rows; there are 9");
    let network =
        dir.train("a.csv", "Fz_N", "m.json", &["--model", "network", "--restarts", "1", "--epochs", "3"]).expect(0);
    network.says("the network learns its rows by heart");
}

#[test]
fn one_row_and_all_rows_alike_tell_their_mean() {
    let first = Recording::of(0..1).rows[0].clone();
    let alike = Recording::of(0..30).with("P1", |_, _| first[1].clone());
    let alike = Recording { rows: vec![first.clone(); 30], ..alike };
    refused(&alike, "P1 is constant; P2 is constant");
    let force: f64 = first[11].parse().unwrap();
    for (recording, rows) in [(alike, 30), (Recording { rows: vec![first.clone()], ..Recording::of(0..1) }, 1)] {
        let dir = dir_with(&recording);
        dir.recording("other.csv", &Recording::of(50..60));
        for how in ["minimum-norm", "drop", "ridge=0.1"] {
            let (jacobian, fit) = fitted(&dir, how);
            assert!(jacobian.iter().flatten().all(|slope| *slope == 0.0), "{how}: {jacobian:?}");
            assert_eq!((&fit["rows"], &fit["rank"]), (&rows.into(), &0.into()));
            dir.lunula(&["predict", "m.json", "other.csv", "--out", "p.csv", "-q"]).expect(0);
            let said = dir.table("p.csv");
            assert!(said.len() == 10 && said.iter().all(|row| row["Fz_N"].parse::<f64>().unwrap() == force));
        }
        let network = ["--model", "network", "--restarts", "1", "--epochs", "3"];
        dir.train("a.csv", "force", "m.json", &network).expect(0).says("and so in all predictions");
        dir.lunula(&["predict", "m.json", "other.csv", "--out", "p.csv", "-q"]).expect(0);
        assert!(dir.table("p.csv").iter().all(|row| row["Fz_N"].parse::<f64>().unwrap() == force));
    }
}

#[test]
fn a_saturated_photodiode_is_reported_and_rows_that_align_marks_are_left_out() {
    let cut = Recording::of(0..120).map("P4", |_, v| v.min(2.5));
    let count = cut.numbers("P4").iter().filter(|v| **v == 2.5).count();
    let dir = dir_with(&cut);
    let said = format!("a.csv: P4 stays at exactly 2.5 V, its greatest value, in {count} of 120 rows: saturated?");
    dir.train("a.csv", "force", "m.json", &[]).expect(0).says(&said);

    let p4 = cut.numbers("P4");
    let status = |row: usize, _: &str| if p4[row] == 2.5 { "saturated: P4" } else { "ok" }.to_owned();
    dir.recording("a.csv", &cut.with("sensor_status", status));
    let answer = dir.train("a.csv", "force", "m.json", &["--json"]).expect(0);
    assert!(!answer.stderr.contains("saturated?"), "{}", answer.stderr);
    let report = answer.json();
    assert_eq!((&report["data"][0]["faults"], &report["data"][0]["used"]), (&count.into(), &(120 - count).into()));
    near(
        &numbers(&dir.parsed("m.json")["model"]["jacobian"][0]),
        &(0..8).map(|k| slope(0, k)).collect::<Vec<_>>(),
        EXACT,
    );
    let kept = dir.train("a.csv", "force", "n.json", &["--keep-faults", "--json"]).expect(0).json();
    assert_eq!((&kept["data"][0]["faults"], &kept["data"][0]["used"]), (&0.into(), &120.into()));
    // What is wrong with a photodiode that is not read does not count.
    let others = dir.train("a.csv", "force", "n.json", &["--inputs", "P1,P2", "--json"]).expect(0).json();
    assert_eq!(others["data"][0]["used"], 120);
}

#[test]
fn a_constant_target_has_no_r2() {
    let dir = dir_with(&Recording::of(0..120).with("Fx_N", |_, _| "0.1".to_owned()));
    for kind in ["linear", "quadratic", "network"] {
        let more = ["--model", kind, "--restarts", "1", "--epochs", "5", "--json"];
        let report = dir.train("a.csv", "force", "m.json", &more).expect(0).json();
        assert!(report["training"]["r2"]["Fx_N"].is_null() && report["training"]["r2"]["Fz_N"].is_number(), "{kind}");
        assert!(report["training"]["rmse"]["Fx_N"].number() <= 1e-15, "{kind}: the constant is reported");
        let said = dir.lunula(&["evaluate", "m.json", "a.csv"]).expect(0).stdout;
        assert!(said.lines().any(|line| line.contains("Fx_N") && line.trim_end().ends_with("R2        -")), "{said}");
    }
}

#[test]
fn huge_and_tiny_volts_and_forces_are_fitted_in_their_own_units() {
    let scaled =
        Recording::of(0..120).with("P1", |_, cell| format!("{cell}e300")).with("P2", |_, cell| format!("{cell}e-300"));
    let dir = dir_with(&scaled);
    let (jacobian, _) = fitted(&dir, "refuse");
    for (t, row) in jacobian.iter().enumerate() {
        // A relative error of rounding: 1e300 is no power of two.
        near(&[row[0] * 1e300, row[1] / 1e300, row[2]], &[slope(t, 0), slope(t, 1), slope(t, 2)], 1e-13);
    }
    dir.recording("a.csv", &Recording::of(0..120).with("Fx_N", |_, cell| format!("{cell}e150")));
    let answer = dir.train("a.csv", "force", "m.json", &["--validate", "a.csv"]).expect(0);
    assert!(answer.stdout.lines().all(|line| line.len() < 120), "{}", answer.stdout);
    near(&[numbers(&dir.parsed("m.json")["model"]["jacobian"][0])[0] / 1e150], &[slope(0, 0)], 1e-13);
    std::fs::remove_file(dir.path("m.json")).expect("a model");
    let far = |e: &'static str| move |_: usize, cell: &str| format!("{cell}{e}");
    let apart = (1..=8).fold(Recording::of(0..120), |all, k| all.with(&format!("P{k}"), far("e300")));
    dir.recording("a.csv", &TARGETS[..3].iter().fold(apart, |all, name| all.with(name, far("e-300"))));
    dir.train("a.csv", "force", "m.json", &[]).expect(2).says("beyond what a number can hold").says("P1");
    assert!(!dir.path("m.json").exists());
    let wrong = dir.train("a.csv", "force", "m.json", &["--deficient", "ridge=0"]).expect(2);
    wrong.says("refuse, minimum-norm, drop or ridge=LAMBDA");
}
