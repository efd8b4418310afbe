//! `lunula train` on rows that do not determine the model: which photodiodes are at fault is reported, and what was
//! asked for is done.

use crate::util::sensor::{Recording, near, numbers, slope};
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
    let dead = without_share(Recording::of(0..120), 2).with("P3", |_, _| "2.1".to_owned());
    let dir = dir_with(&dead);
    dir.train("a.csv", "force", "m.json", &[]).expect(2).says("P3 is constant").says("minimum norm, dropping or ridge");
    assert!(!dir.path("m.json").exists());
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
    let wrong = dir.train("a.csv", "force", "m.json", &["--deficient", "ridge=0"]).expect(2);
    wrong.says("refuse, minimum-norm, drop or ridge=LAMBDA");
    dir.train("a.csv", "force", "m.json", &["--deficient", "drop"])
        .expect(0)
        .says("a.csv: P3 is 2.1 V in all 120 rows: dead or not connected");
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
fn huge_forces_are_fitted_and_told_in_short() {
    let dir = dir_with(&Recording::of(0..120).with("Fx_N", |_, cell| format!("{cell}e150")));
    let answer = dir.train("a.csv", "force", "m.json", &["--validate", "a.csv"]).expect(0);
    assert!(answer.stdout.lines().all(|line| line.len() < 120), "{}", answer.stdout);
    near(&[numbers(&dir.parsed("m.json")["model"]["jacobian"][0])[0] / 1e150], &[slope(0, 0)], 1e-13);
}
