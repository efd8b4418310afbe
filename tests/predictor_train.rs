//! `lunula train` from end to end, on a sensor whose coefficients are known.

use crate::util::sensor::{Recording, near, numbers, offset, slopes};
use crate::util::{Answer, Dir, Json, number};

/// The sensor's tables hold exact numbers; the fit is centred and refined (measured: exact, or 1e-32 for a coefficient
/// of 0).
const EXACT: f64 = 1e-15;
/// F_0 is a sum of 8 products of volts (measured: 2e-15).
const EXACT_OFFSET: f64 = 1e-13;

/// `train.csv` of 200 rows, `held.csv` of 100 others of another session.
fn sensor() -> Dir {
    let dir = Dir::new();
    dir.recording("train.csv", &Recording::of(0..200));
    dir.recording("held.csv", &Recording::of(200..300));
    dir
}

fn keys(value: &serde_json::Value) -> Vec<&str> {
    value.as_object().expect("an object").keys().map(String::as_str).collect()
}

#[test]
fn the_coefficients_come_back_exactly() {
    let dir = sensor();
    for (target, first, count) in [("force", 0, 3), ("posture", 3, 1)] {
        dir.train("train.csv", target, "m.json", &["-q"]).expect(0);
        let model = dir.parsed("m.json");
        for t in 0..count {
            near(&numbers(&model["model"]["jacobian"][t]), &slopes(first + t), EXACT);
        }
        let reported = dir.lunula(&["analyse", "m.json", "--json"]).expect(0).json();
        for (t, name) in model["targets"].list().iter().enumerate() {
            let f0 = reported["printed"]["offset"][name["name"].words()].number();
            near(&[f0], &[offset(first + t)], EXACT_OFFSET);
        }
    }
}

#[test]
fn an_option_that_nothing_needs_is_named() {
    let dir = sensor();
    let unused = |answer: &Answer| -> Vec<String> {
        let lines = answer.stderr.lines().filter(|line| line.contains("is of no use here"));
        lines.map(str::to_owned).collect()
    };
    let plain = dir.train("train.csv", "force", "m.json", &["--validate", "held.csv"]).expect(0);
    assert!(unused(&plain).is_empty(), "{}", plain.stderr);
    // Also where it is written with its default.
    let hidden = dir.train("train.csv", "force", "m.json", &["--hidden", "8", "--modes", "4"]).expect(0);
    assert_eq!(
        unused(&hidden),
        [
            "note: --hidden is of no use here: the model is no network",
            "note: --modes is of no use here: the model is not of eigennails"
        ],
    );
    let stopped = dir.train("train.csv", "force", "m.json", &["--stop-on", "held.csv", "--epochs", "5"]).expect(0);
    let no_network = |option: &str| format!("note: {option} is of no use here: the model is no network");
    assert_eq!(unused(&stopped), [no_network("--epochs"), no_network("--stop-on")]);
    let network = ["--model", "network", "--hidden", "2", "--restarts", "1", "--stop-on"];
    let network = |stop_on: &str| dir.train("train.csv", "force", "n.json", &[&network[..], &[stop_on]].concat());
    assert!(unused(&network("held.csv").expect(0)).is_empty());
    network("train.csv").expect(0).says("--stop-on names what is trained on");
    let gate = dir.lunula(&["predict", "m.json", "held.csv", "--f-min", "0.5", "--out", "p.csv"]).expect(0);
    assert_eq!(
        unused(&gate),
        ["note: --f-min is of no use here: only a model of force and one of posture together are gated"]
    );
}

#[test]
fn the_report_has_the_fit_the_rows_and_the_errors() {
    let dir = sensor();
    let answer = dir.train("train.csv", "force", "m.json", &["--validate", "held.csv", "--json"]).expect(0);
    assert!(answer.stderr.is_empty(), "{}", answer.stderr);
    let report = answer.json();
    let mut all = keys(&report);
    all.sort_unstable();
    assert_eq!(
        all,
        [
            "data",
            "failed",
            "fit",
            "half_width",
            "inputs",
            "job",
            "left_out",
            "level",
            "model",
            "notes",
            "options",
            "pictures",
            "recipe",
            "stages",
            "targets",
            "training",
            "validate",
            "validation",
            "version",
            "wall_s",
            "warnings",
            "without"
        ]
    );
    assert_eq!((&report["job"], &report["model"]), (&"train".into(), &"m.json".into()));
    let of = |path: &str, rows: u64| {
        serde_json::json!({
            "path": path, "rows": rows, "used": rows, "empty": 0, "invalid": 0, "faults": 0, "notes": []
        })
    };
    assert_eq!((&report["data"][0], &report["validate"][0]), (&of("train.csv", 200), &of("held.csv", 100)));
    let fit = &report["fit"]["least_squares"];
    assert_eq!((&fit["rank"], &fit["rows"], fit["dropped"].list().len()), (&8.into(), &200.into(), 0));
    assert!(fit["condition"].number() < 2.0 && fit["digits"].number() > 14.0, "{fit}");
    for part in ["training", "validation"] {
        for target in ["Fx_N", "Fy_N", "Fz_N"] {
            let merit = |what: &str| report[part][what][target].number();
            assert!(merit("rmse") <= EXACT && merit("bias").abs() <= EXACT && merit("r2") == 1.0, "{part} {target}");
        }
    }
    assert!(numbers(&serde_json::json!([report["half_width"]["Fz_N"]]))[0] <= EXACT);
    assert!(report["stages"].list().iter().any(|stage| stage["stage"] == "fit"));
    assert!(report["left_out"].to_string().contains("learning curve"), "{}", report["left_out"]);

    dir.train("train.csv", "force", "m.json", &["--validate", "held.csv"])
        .expect(0)
        .prints("Fz_N     RMSE   0.0000")
        .prints("validated (100 rows)");
    assert_eq!(dir.train("train.csv", "force", "m.json", &["-q"]).expect(0).stdout, "");
}

#[test]
fn the_model_file_holds_names_units_ranges_hashes_and_a_version() {
    let dir = sensor();
    let (a, b) = (Recording::of(0..200), Recording::of(400..460));
    let b = b.with("session", |_, _| "2".to_owned()).with("subject", |_, _| "anna".to_owned());
    dir.recording("b.csv", &b);
    dir.train("train.csv b.csv", "force", "m.json", &["-q"]).expect(0);
    let model = dir.parsed("m.json");
    assert_eq!((&model["format"], &model["version"]), (&"lunula predictor".into(), &1.into()));
    let channel = |list: &str, k: usize| &model[list][k];
    for (list, columns, unit) in [("inputs", &["P1", "P2", "P8"][..], "V"), ("targets", &["Fx_N", "Fz_N"], "N")] {
        for name in columns {
            let k = model[list].list().iter().position(|one| one["name"] == *name).unwrap();
            let values = [a.numbers(name), b.numbers(name)].concat();
            let low = values.iter().copied().fold(f64::INFINITY, f64::min);
            let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let wanted = serde_json::json!({"name": name, "unit": unit, "low": low, "high": high});
            assert_eq!(channel(list, k), &wanted);
        }
    }
    let training = &model["training"];
    assert_eq!(training["rows"], 260);
    let recordings = training["recordings"].list();
    let reported = |k: usize| ["name", "session", "subject"].map(|key| recordings[k][key].words());
    assert_eq!((reported(0), reported(1)), (["train.csv"; 3], ["b.csv", "2", "anna"]));
    let hash = |value: &serde_json::Value| value.words().to_owned();
    let hashes = [&training["sha256"], &recordings[0]["sha256"], &recordings[1]["sha256"], &model["sha256"]].map(hash);
    assert!(hashes.iter().all(|hash| hash.len() == 64 && hash.bytes().all(|b| b.is_ascii_hexdigit())), "{hashes:?}");
    assert_eq!(training["recipe"]["kind"], "linear");
    assert_eq!(keys(&model["model"]), ["centre", "jacobian", "kind", "offset"].map(|key| key));

    // A cell of the training rows is another training set; the order of columns is not.
    dir.recording("train.csv", &a.clone().map("P3", |row, v| if row == 7 { v + 0.5 } else { v }));
    dir.train("train.csv b.csv", "force", "m.json", &["-q"]).expect(0);
    let other = dir.parsed("m.json");
    assert_ne!(other["training"]["sha256"], model["training"]["sha256"]);
    assert_eq!(other["training"]["recordings"][1]["sha256"], model["training"]["recordings"][1]["sha256"]);
    let mut names: Vec<&str> = a.names.iter().map(String::as_str).collect();
    names.reverse();
    dir.recording("train.csv", &a.only(&names));
    dir.train("train.csv b.csv", "force", "m.json", &["-q"]).expect(0);
    assert_eq!(dir.parsed("m.json"), model);
}

#[test]
fn the_seed_is_another_network_and_the_same_seed_the_same() {
    let dir = sensor();
    let network = |seed: &str| {
        let few = ["--model", "network", "--hidden", "3", "--restarts", "1", "--epochs", "10", "--seed", seed, "-q"];
        dir.train("train.csv", "posture", "m.json", &few).expect(0);
        dir.parsed("m.json")
    };
    let (one, again, other) = (network("1"), network("1"), network("2"));
    assert_eq!(one, again);
    assert_ne!(one["model"]["hidden_weights"], other["model"]["hidden_weights"]);
    assert_eq!(one["training"]["sha256"], other["training"]["sha256"]);
}

#[test]
fn a_network_fits_a_nonlinear_sensor_and_reports_its_restarts() {
    let dir = Dir::new();
    for (name, rows) in [("train.csv", 0..400), ("stop.csv", 400..500), ("held.csv", 500..600)] {
        let volts = Recording::of(rows).only(&["time_s", "P1", "P2", "J2_deg"]);
        let (p1, p2) = (volts.numbers("P1"), volts.numbers("P2"));
        let bent = |row: usize, _: f64| 30.0 * (4.0 * (p1[row] - 2.5)).tanh() + 10.0 * (p2[row] - 2.5);
        dir.recording(name, &volts.clone().map("J2_deg", bent));
    }
    let few = ["--model", "network", "--hidden", "2", "--restarts", "4", "--epochs", "60", "--json"];
    let own = dir
        .train("train.csv", "posture", "own.json", &[&few[..], &["--validate", "held.csv"]].concat())
        .expect(0)
        .json();
    let fit = &own["fit"]["network"];
    // A fifth of the rows is set aside to stop on.
    assert_eq!((&fit["rows"], &fit["stop_rows"]), (&320.into(), &80.into()));
    assert_eq!(fit["restarts"].list().len(), 4);

    let stopped = ["--stop-on", "stop.csv", "--validate", "held.csv"];
    let given = dir.train("train.csv", "posture", "given.json", &[&few[..], &stopped].concat()).expect(0).json();
    let fit = &given["fit"]["network"];
    assert_eq!((&fit["rows"], &fit["stop_rows"]), (&400.into(), &100.into()));
    assert_ne!(dir.parsed("own.json")["model"], dir.parsed("given.json")["model"]);

    // Made by a network of one bend and a line: two nodes tell it far better than a linear model.
    let linear = dir.train("train.csv", "posture", "line.json", &["--validate", "held.csv", "--json"]).expect(0).json();
    let rmse = |report: &serde_json::Value| report["validation"]["rmse"]["J2_deg"].number();
    assert!(rmse(&given) * 10.0 <= rmse(&linear), "{} against {}", rmse(&given), rmse(&linear));
}

#[test]
fn lags_are_further_inputs_and_both_ways_are_reported() {
    let dir = Dir::new();
    // The force follows the photodiode of a tenth of a second ago: no row can tell it without.
    let late = |rows: std::ops::Range<usize>| {
        let base = Recording::of(rows).with("time_s", |row, _| (row as f64 / 10.0).to_string());
        let p1 = base.numbers("P1");
        base.only(&["time_s", "P1", "P2", "Fz_N"]).map("Fz_N", move |row, _| p1[row.saturating_sub(1)] - 3.0)
    };
    dir.recording("train.csv", &late(0..120));
    dir.recording("held.csv", &late(200..260));
    let more = ["--lags", "0.1", "--validate", "held.csv", "--json"];
    let report = dir.train("train.csv", "Fz_N", "m.json", &more).expect(0).json();
    assert_eq!(report["fit"]["least_squares"]["terms"], serde_json::json!(["P1", "P2", "P1@-0.1s", "P2@-0.1s"]));
    // The first row of each recording has no history.
    assert_eq!((&report["training"]["rows"], &report["validation"]["rows"]), (&119.into(), &59.into()));
    let with = report["validation"]["rmse"]["Fz_N"].number();
    let without = &report["without"][0];
    assert_eq!(without["without"], "lags");
    let plain = without["validation"]["rmse"]["Fz_N"].number();
    assert!(with <= 1e-14 && plain > 0.1, "{with} with, {plain} without");
    near(&numbers(&dir.parsed("m.json")["model"]["jacobian"][0]), &[0.0, 0.0, 1.0, 0.0], 1e-14);
    // Forces in each second row: the others are the past all the same, as where forces are predicted.
    let sparse = |row: usize, cell: &str| if row % 2 == 1 { cell.to_owned() } else { String::new() };
    dir.recording("sparse.csv", &late(0..120).with("Fz_N", sparse));
    let report = dir.train("sparse.csv", "Fz_N", "s.json", &more).expect(0).json();
    assert_eq!(report["training"]["rows"], 60);
    let both = [report, dir.lunula(&["evaluate", "m.json", "sparse.csv", "--json"]).expect(0).json()];
    let rmse = [&both[0]["validation"]["rmse"], &both[1]["rmse"]].map(|rmse| rmse["Fz_N"].number());
    assert!(rmse.iter().all(|rmse| *rmse <= 1e-14), "{rmse:?}");
    dir.train("train.csv", "Fz_N", "n.json", &["--lags", "20"]).expect(2).says("take shorter lags");
    dir.train("train.csv", "Fz_N", "n.json", &["--lags", "0.1,0.1"]).expect(2).says("different from each other");
    let timeless = Recording::of(0..40).without("time_s");
    dir.recording("timeless.csv", &timeless);
    dir.train("timeless.csv", "Fz_N", "n.json", &["--lags", "0.1"]).expect(2).says("time_s");
    dir.train("timeless.csv", "Fz_N", "n.json", &[]).expect(0);
}

#[test]
fn friction_brings_forces_into_the_cone_and_both_ways_are_reported() {
    let dir = sensor();
    let more = ["--friction", "0.3", "--validate", "held.csv", "--json"];
    let report = dir.train("train.csv", "force", "m.json", &more).expect(0).json();
    let without = &report["without"][0];
    assert_eq!(without["without"], "the cone of friction");
    // The sensor's forces lie in no cone: exact without, not exact with.
    assert!(without["validation"]["rmse"]["Fx_N"].number() <= EXACT);
    assert!(report["validation"]["rmse"]["Fx_N"].number() > 0.01);
    let again = dir.lunula(&["evaluate", "m.json", "held.csv", "--json"]).expect(0).json();
    assert_eq!(again["rmse"], report["validation"]["rmse"]);
    assert_eq!(again["without_friction"]["rmse"], without["validation"]["rmse"]);

    dir.lunula(&["predict", "m.json", "held.csv", "--out", "p.csv", "-q"]).expect(0);
    let rows = dir.table("p.csv");
    assert_eq!(rows.len(), 100);
    for row in &rows {
        let [shear, most] = [number(row, "Fx_N").hypot(number(row, "Fy_N")), -0.3 * number(row, "Fz_N")];
        assert!(shear <= most + 1e-12 && most >= 0.0, "{row:?}");
    }
    dir.train("train.csv", "posture", "n.json", &["--friction", "0.5"])
        .expect(2)
        .says("needs the targets Fx_N, Fy_N, Fz_N");
    dir.train("train.csv", "force", "n.json", &["--friction=-1"]).expect(2).says("coefficient of friction of -1");
    assert!(!dir.path("n.json").exists());
}

#[test]
fn chosen_photodiodes_and_targets() {
    let dir = sensor();
    let report = dir.train("train.csv", "Fz_N,J2_deg", "m.json", &["--inputs", "P8,P1", "--json"]).expect(0).json();
    assert_eq!(
        (&report["inputs"], &report["targets"]),
        (&serde_json::json!(["P8", "P1"]), &serde_json::json!(["Fz_N", "J2_deg"]))
    );
    let units: Vec<String> =
        dir.parsed("m.json")["targets"].list().iter().map(|one| one["unit"].words().to_owned()).collect();
    assert_eq!(units, ["N", "deg"]);
    dir.train("train.csv", "Fz_N", "m.json", &["--inputs", "P1,Fz_N"]).expect(2).says("Fz_N");
    dir.train("train.csv", "Fz_N,", "m.json", &[]).expect(2).says("force, posture or columns");
}

#[test]
fn validation_only_reports_and_says_what_was_trained_on() {
    let dir = sensor();
    dir.train("train.csv", "force", "alone.json", &["-q"]).expect(0);
    let shifted = Recording::of(200..300).map("Fy_N", |_, v| v + 0.5).map("Fx_N", |row, v| v + [0.25, -0.25][row % 2]);
    dir.recording("shifted.csv", &shifted);
    let report = dir.train("train.csv", "force", "m.json", &["--validate", "shifted.csv", "--json"]).expect(0).json();
    let [mut alone, mut with] = ["alone.json", "m.json"].map(|name| dir.parsed(name));
    let intervals = with["intervals"].take();
    let calibrated = with["training"].as_object_mut().and_then(|training| training.remove("calibrated_on"));
    assert_eq!(calibrated.expect("what the intervals were made from")[0]["name"], "shifted.csv");
    for one in [&mut alone, &mut with] {
        one["intervals"].take();
        one["sha256"].take();
    }
    assert_eq!(alone, with, "the fit has not seen what it is validated on");
    let reported = |what: &str| ["Fx_N", "Fy_N", "Fz_N"].map(|target| report["validation"][what][target].number());
    near(&reported("rmse"), &[0.25, 0.5, 0.0], EXACT);
    near(&reported("bias"), &[0.0, -0.5, 0.0], EXACT);
    near(&numbers(&intervals["half_width"]), &[0.25, 0.5, 0.0], EXACT);
    assert_eq!((&intervals["level"], &intervals["rows"]), (&0.9.into(), &100.into()));

    let seen = dir.train("train.csv", "force", "m.json", &["--validate", "train.csv"]).expect(0);
    seen.says("train.csv: the model was trained on this; its errors flatter");
    let few = Recording::of(200..205);
    dir.recording("few.csv", &few);
    let few = dir.train("train.csv", "force", "m.json", &["--validate", "few.csv"]).expect(0);
    few.says("no prediction intervals: 5 held-out rows");
    assert!(dir.parsed("m.json")["intervals"].is_null());
    for level in ["0", "1", "nan", "2"] {
        dir.train("train.csv", "force", "m.json", &["--level", level]).expect(2).says("--level");
    }
}

#[test]
fn the_learning_curve_goes_down_the_recordings() {
    let dir = sensor();
    let noise = |row: usize, v: f64| v + ((row * 7919) % 211) as f64 / 211.0 - 0.5;
    let names = ["a.csv", "b.csv", "c.csv"];
    for (k, name) in names.iter().enumerate() {
        dir.recording(name, &Recording::of(300 + 60 * k..360 + 60 * k).map("Fz_N", noise));
    }
    let more = ["--validate", "held.csv", "--learning-curve", "curve.csv", "--json"];
    let report = dir.train(&names.join(" "), "force", "m.json", &more).expect(0).json();
    let rows = dir.table("curve.csv");
    let whole: Vec<[&str; 2]> = rows
        .iter()
        .filter(|row| row["share"] == "1")
        .map(|row| [row["recordings"].as_str(), row["rows"].as_str()])
        .collect();
    assert_eq!(whole, [["1", "60"], ["2", "120"], ["3", "180"]]);
    let share = rows.iter().filter(|row| row["share"] != "1").count();
    assert_eq!(share, 9, "tenths of each recording");
    let last = rows.last().unwrap();
    let reported = report["validation"]["rmse"]["Fz_N"].number();
    near(&[last["Fz_N_validate_rmse"].parse().unwrap()], &[reported], 1e-12);
    let first: f64 = rows.iter().find(|row| row["share"] == "1").unwrap()["Fz_N_validate_rmse"].parse().unwrap();
    assert!(reported < first, "three recordings are better than one: {reported} against {first}");
    // A tenth of 60 rows is fewer than the 9 unknowns: reported, not fitted.
    assert!(
        rows.iter().any(|row| row["rows"].parse::<usize>().unwrap() < 9
            && row["Fz_N_validate_rmse"].is_empty()
            && !row["fault"].is_empty())
            || rows.iter().all(|row| row["rows"].parse::<usize>().unwrap() > 9)
    );
    assert!(dir.path("curve.png").is_file() && dir.path("curve.svg").is_file());
    assert_eq!(report["pictures"], serde_json::json!(["curve.png"]));
    dir.train("a.csv", "force", "m.json", &["--learning-curve", "curve.csv"]).expect(2);
    dir.train("a.csv", "force", "m.json", &["--validate", "held.csv", "--learning-curve", "held.csv"])
        .expect(2)
        .says("held.csv: is an input itself");
}

#[test]
fn a_plan_does_nothing() {
    let dir = sensor();
    let of = |data: &str| dir.lunula(&["train", data, "--target", "force", "--model", "network", "--plan"]);
    of("nowhere.csv").expect(2).says("nowhere.csv: is not there; check its name");
    let plan = of("train.csv").expect(0);
    let line = |stage: &str| {
        plan.stdout.lines().find(|line| line.starts_with(stage)).unwrap_or_else(|| panic!("{stage}")).to_owned()
    };
    assert!(line("fit").contains("run") && line("early stopping").contains("a fifth"), "{}", plan.stdout);
    assert!(line("validation").contains("left out") && line("lags").contains("none asked for"), "{}", plan.stdout);
    let more = ["--plan", "--json", "--validate", "held.csv", "--friction", "0.5"];
    let plan = dir.train("train.csv", "force", "m.json", &more).expect(0).json();
    let fate = |stage: &str| plan["plan"].list().iter().find(|one| one["stage"] == stage).unwrap()["fate"].clone();
    assert_eq!(
        (fate("validation"), fate("early stopping"), fate("cone of friction")),
        ("run".into(), "left_out".into(), "run".into())
    );
    assert!(!dir.path("m.json").exists());
}

#[test]
fn a_raw_log_of_the_phantom_is_trained_on_as_it_stands() {
    let dir = Dir::new();
    for seed in ["1", "2"] {
        dir.words(&format!("phantom log --force spiral --spiral-seconds 20 --seed {seed} --out {seed} -q")).expect(0);
    }
    let report = dir.train("1/log.csv", "force", "m.json", &["--validate", "2/log.csv", "--json"]).expect(0).json();
    // Half of a log's rows are unlit.
    let lit = dir.table("1/log.csv").iter().filter(|row| row["led"] == "1").count();
    assert_eq!(report["data"][0]["rows"], lit);
    // Another spiral of the same finger: most of the force is predicted, and not all (noise, and a sensor that is not
    // linear).
    let r2 = report["validation"]["r2"]["Fz_N"].number();
    assert!((0.7..0.9999).contains(&r2), "{r2}");
    dir.train("1/log.csv", "posture", "n.json", &[]).expect(2).says("run `lunula align` first");
    // Half of the rows are unlit whatever the LED's column is called, and a photodiode with a unit is still one.
    let renamed = |from: &str, to: &str| {
        let text = String::from_utf8(dir.bytes_of("1")["log.csv"].clone()).expect("text");
        dir.write("renamed.csv", text.replacen(from, to, 1));
        dir.train("renamed.csv", "force", "r.json", &[]).expect(0)
    };
    renamed(",led", ",lamp").says("warning: renamed.csv: P1, P2, P3").says("name it with --columns led=NAME");
    renamed(",P1,", ",P1_mV,").says("note: renamed.csv: column `P1_mV` may be a photodiode, and is not read");
}

/// Of targets that no finger has, and of glitches, `train` says what `align` does.
#[test]
fn impossible_targets_and_glitches_are_warned_of() {
    let dir = Dir::new();
    let table = |angle: &dyn Fn(usize) -> f64, volts: &dyn Fn(usize) -> f64| {
        let row = |k: usize| format!("{:.2},{:.6},{:.6}\n", 0.04 * k as f64, volts(k), angle(k));
        let rows: String = (0..400).map(row).collect();
        dir.write("a.csv", format!("time_s,P1,J2_deg\n{rows}"));
        let answer = dir.lunula(&["train", "a.csv", "--target", "posture", "--out", "m.json"]);
        answer.expect(0)
    };
    let volts = |k: usize| 2.0 + (0.05 * k as f64).sin();
    let angle = |k: usize| 30.0 + 25.0 * (0.05 * k as f64).sin();
    table(&angle, &volts).never_says("warning");
    table(&|k| angle(k).to_radians(), &volts).says("warning: a.csv: no angle is further from 0 than 0.96 degrees");
    table(&|k| -angle(k), &volts).says("warning: a.csv: angles that a finger can't have: J2");
    table(&|k| if k % 5 == 0 { -999.0 } else { angle(k) }, &volts).says("J2 is -999 degrees in the first of 80 row(s)");
    table(&angle, &|k| if k == 200 { 1e9 } else { volts(k) }).says("P1 is 1000000000 in one of 1 row(s)");
}

/// A log without a column `led` is one whatever its file is called, and whoever wrote it.
#[test]
fn logs_of_other_programs_are_read_alike_as_csv() {
    let dir = Dir::new();
    let log = "time_s P1 P2 P3 P4 P5 P6 P7 P8 Fx_N Fy_N Fz_N".split(' ').collect::<Vec<_>>();
    let log = Recording::of(0..200).only(&log);
    let csv = log.csv();
    let renamed = |name: &str, text: String| {
        dir.write(&format!("{name}.csv"), &text);
        dir.write(&format!("{name}.txt"), text);
    };
    renamed("plain", csv.replacen("time_s", "time", 1));
    renamed("german", format!("\u{feff}{}", csv.replace(',', ";").replace('.', ",")));
    renamed("commented", format!("# rig 2\n{csv}"));
    renamed("trailing", csv.lines().map(|line| format!("{line},,\n")).collect());
    let dated = |(k, line): (usize, &str)| match k {
        0 => format!("{line}\n"),
        _ => format!("2026-11-27 09:00:{:06.3}{}\n", (k - 1) as f64 * 0.04, &line[line.find(',').unwrap()..]),
    };
    renamed("dated", csv.lines().enumerate().map(dated).collect());
    let utf16: Vec<u8> = [0xfeff].into_iter().chain(csv.encode_utf16()).flat_map(u16::to_le_bytes).collect();
    dir.write("wide.csv", &utf16);
    dir.write("wide.txt", &utf16);
    dir.recording("own.csv", &log);
    dir.train("own.csv", "force", "own.json", &["-q"]).expect(0);
    let own = dir.parsed("own.json");
    for name in ["plain", "german", "commented", "trailing", "dated", "wide"] {
        for ending in ["csv", "txt"] {
            let (file, model) = (format!("{name}.{ending}"), format!("{name}-{ending}.json"));
            dir.train(&file, "force", &model, &["-q"]).expect(0);
            assert_eq!(dir.parsed(&model)["model"], own["model"], "{file}");
            dir.lunula(&["predict", "own.json", &file, "--out", "p.csv", "-q"]).expect(0);
            let times: Vec<f64> = dir.table("p.csv").iter().map(|row| row["time_s"].parse().unwrap()).collect();
            assert!(times.len() == 200 && (times[199] - times[0] - 199.0 * 0.04).abs() <= 1e-6, "{file}: {times:?}");
        }
    }
    // A set that has more than a log is a table, and its time is asked for.
    let labelled = Recording::of(0..200).csv().replacen("time_s", "time", 1);
    assert!(labelled.starts_with("time,P1") && labelled.contains("J2_deg"));
    dir.write("labelled.csv", labelled);
    dir.train("labelled.csv", "posture", "n.json", &[]).expect(0).says("`time` is not read as the time");
}
