//! `lunula evaluate` from end to end, with errors that are known because the tests put them there.

use crate::util::sensor::{Recording, near};
use crate::util::{Dir, Json};
use serde_json::Value;

/// The model is exact to rounding (measured: 1e-16).
const EXACT: f64 = 1e-14;

/// A model of force trained on `train.csv` (exact), validated on `noisy.csv`: 100 rows with noise of 100 different
/// sizes on Fz.
fn trained() -> Dir {
    let dir = Dir::new();
    dir.recording("train.csv", &Recording::of(0..200));
    let noise = |row: usize, v: f64| v + [1.0, -1.0][row % 2] * (1 + (row * 37) % 101) as f64 / 1024.0;
    dir.recording("noisy.csv", &Recording::of(200..300).map("Fz_N", noise));
    dir.train("train.csv", "force", "m.json", &["--validate", "noisy.csv", "-q"]).expect(0);
    dir
}

fn evaluate(dir: &Dir, data: &str, more: &[&str]) -> Value {
    let data: Vec<&str> = data.split(' ').collect();
    dir.lunula(&[&["evaluate", "m.json", "--json"], &data[..], more].concat()).expect(0).json()
}

#[track_caller]
fn of(report: &Value, what: &str) -> [f64; 3] {
    ["Fx_N", "Fy_N", "Fz_N"].map(|target| report[what][target].as_f64().unwrap_or(f64::NAN))
}

#[test]
fn errors_are_reported_by_target() {
    let dir = trained();
    let base = Recording::of(300..400);
    let wrong = base.map("Fx_N", |row, v| v + [0.25, -0.25][row % 2]).map("Fy_N", |_, v| v + 0.5);
    dir.recording("r.csv", &wrong);
    let report = evaluate(&dir, "r.csv", &[]);
    // Predicted less measured: what is measured half a newton high is predicted half a newton low.
    near(&of(&report, "rmse"), &[0.25, 0.5, 0.0], EXACT);
    near(&of(&report, "bias"), &[0.0, -0.5, 0.0], EXACT);
    near(&of(&report, "mae"), &[0.25, 0.5, 0.0], EXACT);
    near(&of(&report, "r2")[2..], &[1.0], EXACT);
    assert_eq!((&report["job"], &report["rows"], &report["held_out"]), (&"evaluate".into(), &100.into(), &Value::Null));
    assert_eq!(report["data"][0]["used"], 100);
    let plain = dir.lunula(&["evaluate", "m.json", "r.csv"]).expect(0).prints("Fy_N     RMSE   0.5000  bias  -0.5000");
    // Fy_N varies by less than it is off.
    assert!(plain.stderr.starts_with("warning: Fy_N: predicted no better than by the mean"), "{}", plain.stderr);
    assert!(plain.stderr.contains("an offset of 0.500") && plain.stderr.lines().count() == 1, "{}", plain.stderr);
}

#[test]
fn a_wrong_sign_unit_or_order_is_named() {
    let dir = trained();
    let base = Recording::of(300..400);
    let swapped = {
        let [one, three] = ["P1", "P3"].map(|name| base.numbers(name));
        base.clone().map("P1", |row, _| three[row]).map("P3", |row, _| one[row] + 2.0)
    };
    for (recording, target, words) in [
        (base.clone().map("Fz_N", |_, v| -v), "Fz_N", "but for the sign"),
        (base.clone().map("Fx_N", |_, v| 101.97 * v), "Fx_N", "times what is predicted"),
        (base.clone().map("Fy_N", |_, v| v + 7.0), "Fy_N", "but for an offset of 7.000"),
        (swapped, "100 of 100 rows", "outside of the voltages that the model was trained on"),
    ] {
        dir.recording("r.csv", &recording);
        let words = [target, words];
        let warned = |list: &Value| list.list().iter().any(|one| words.iter().all(|word| one.words().contains(word)));
        let report = evaluate(&dir, "r.csv", &[]);
        assert!(warned(&report["warnings"]), "{words:?}: {}", report["warnings"]);
        // The same of what a model in the making is validated on.
        let train = ["train", "train.csv", "--target", "force", "--validate", "r.csv", "--out", "n.json", "--json"];
        let report = dir.lunula(&train).expect(0).json();
        assert!(warned(&report["warnings"]), "{words:?}: {}", report["warnings"]);
    }
    let pulls = base.map("Fz_N", |_, v| 10.0 + v);
    dir.recording("r.csv", &pulls);
    dir.lunula(&["train", "r.csv", "--target", "force", "--out", "n.json"]).expect(0).says("as if the finger pulled");
}

#[test]
fn each_recording_has_its_own_errors() {
    let dir = trained();
    for (name, error, rows) in [("a.csv", 0.5, 300..340), ("b.csv", -0.25, 340..400)] {
        dir.recording(
            name,
            &Recording::of(rows).map("Fz_N", |_, v| v + error).with("session", |_, _| name[..1].to_owned()),
        );
    }
    let report = evaluate(&dir, "a.csv b.csv", &[]);
    let recordings = report["recordings"].list();
    let named: Vec<_> =
        recordings.iter().map(|one| ["recording", "session", "subject"].map(|key| one[key].words())).collect();
    assert_eq!(named, [["a.csv", "a", "a.csv"], ["b.csv", "b", "b.csv"]]);
    near(&[of(&recordings[0], "bias")[2], of(&recordings[1], "bias")[2]], &[-0.5, 0.25], EXACT);
    assert_eq!(
        (&recordings[0]["rows"], &recordings[1]["rows"], &report["rows"]),
        (&40.into(), &60.into(), &100.into())
    );
    near(&of(&report, "rmse")[2..], &[((40.0 * 0.25 + 60.0 * 0.0625) / 100.0_f64).sqrt()], EXACT);
}

#[test]
fn errors_are_reported_by_pressing_force() {
    let dir = trained();
    let base = Recording::of(300..500);
    let pressing: Vec<f64> = base.numbers("Fz_N").iter().map(|fz| -fz).collect();
    dir.recording("r.csv", &base.map("Fy_N", |row, v| if pressing[row] >= 0.5 { v + 0.5 } else { v }));
    let found = &evaluate(&dir, "r.csv", &[])["by_magnitude"];
    assert_eq!(found["of"], "-Fz_N");
    let bins = found["bins"].list();
    assert!(bins.iter().any(|bin| bin["from"].number() == 0.5) && bins.len() >= 3, "{found}");
    for bin in bins.iter().filter(|bin| bin["rows"].number() > 0.0) {
        near(&of(bin, "rmse")[1..2], &[if bin["from"].number() >= 0.5 { 0.5 } else { 0.0 }], EXACT);
    }
    assert_eq!(bins.iter().map(|bin| bin["rows"].number()).sum::<f64>(), 200.0, "every row is in one");
}

#[test]
fn rows_of_the_training_set_are_reported() {
    let dir = trained();
    let again = dir.lunula(&["evaluate", "m.json", "train.csv", "noisy.csv", "--json"]).expect(0);
    assert!(again.json()["warnings"][0].words().starts_with("train.csv: the model was trained on this"));
    again.says("its errors flatter");
    // Another name or order of columns does not hide it.
    let all = Recording::of(0..200);
    let mut names: Vec<&str> = all.names.iter().map(String::as_str).collect();
    names.reverse();
    dir.recording("copy.csv", &all.only(&names));
    assert!(evaluate(&dir, "copy.csv", &[])["warnings"][0].words().starts_with("copy.csv: the model"));
    // What the intervals were made from.
    let held = evaluate(&dir, "noisy.csv", &[]);
    assert_eq!(held["warnings"], serde_json::json!([]));
    assert!(held["notes"][0].words().starts_with("noisy.csv: the prediction intervals were made from this"), "{held}");
    // What a network was stopped on.
    let network = ["--model", "network", "--hidden", "2", "--restarts", "1", "--stop-on", "noisy.csv", "-q"];
    dir.train("train.csv", "force", "n.json", &network).expect(0);
    let stopped = dir.lunula(&["evaluate", "n.json", "noisy.csv", "--json"]).expect(0).json();
    assert!(
        stopped["warnings"].to_string().contains("noisy.csv: training was stopped by the errors on this"),
        "{stopped}"
    );
    assert_eq!(dir.lunula(&["evaluate", "m.json", "train.csv", "-q"]).expect(0).stderr, "");
}

#[test]
fn intervals_hold_the_rows_that_they_promise() {
    let dir = trained();
    // Of 100 different sizes the ceil(101 x 0.9) = 91st is the half width.
    let report = evaluate(&dir, "noisy.csv", &[]);
    near(&of(&report, "coverage")[2..], &[0.91], 1e-12);
    let half = dir.parsed("m.json")["intervals"]["half_width"][2].number();
    dir.recording(
        "r.csv",
        &Recording::of(300..400).map("Fz_N", |row, v| if row < 25 { v + half * 1.01 } else { v + half * 0.99 }),
    );
    near(&of(&evaluate(&dir, "r.csv", &[]), "coverage")[2..], &[0.75], 1e-12);
    dir.train("train.csv", "force", "m.json", &["-q"]).expect(0);
    let without = evaluate(&dir, "r.csv", &[]);
    assert!(without["coverage"].is_null() && without["left_out"].to_string().contains("--validate"), "{without}");
}

/// Five recordings of three sessions and two subjects; each session reads the force differently.
fn sessions(dir: &Dir) -> &'static str {
    let all = [
        ("a", "1", 0.0, 2.1),
        ("a", "1", 0.0, 2.1),
        ("a", "2", 0.3, 2.5),
        ("b", "1", -0.3, 2.3),
        ("b", "1", -0.3, 2.3),
    ];
    for (k, (subject, session, error, level)) in all.into_iter().enumerate() {
        let one = Recording::of(300 + 60 * k..360 + 60 * k)
            .map("Fz_N", |_, v| v + error)
            // The last photodiode hardly moves but between sessions, and betrays them.
            .map("P8", |_, v| level + v / 1024.0)
            .with("subject", |_, _| subject.to_owned())
            .with("session", |_, _| session.to_owned());
        dir.recording(&format!("{k}.csv"), &one);
    }
    "0.csv 1.csv 2.csv 3.csv 4.csv"
}

#[test]
fn trajectories_sessions_and_subjects_are_held_out() {
    let dir = trained();
    let data = sessions(&dir);
    let names = |report: &Value| -> Vec<String> {
        report["held_out"]["parts"].list().iter().map(|part| part["name"].words().to_owned()).collect()
    };
    let held = |by: &str| {
        let report = evaluate(&dir, data, &["--by", by]);
        assert_eq!(report["held_out"]["by"], by);
        assert_eq!(report["held_out"]["pooled"]["rows"], 300, "every row is held out once");
        report
    };
    let [trajectory, session, subject] = ["trajectory", "session", "subject"].map(held);
    assert_eq!(names(&trajectory), ["0.csv", "1.csv", "2.csv", "3.csv", "4.csv"]);
    assert_eq!(names(&session), ["a/1", "a/2", "b/1"]);
    assert_eq!(names(&subject), ["a", "b"]);
    let rmse = |report: &Value| of(&report["held_out"]["pooled"], "rmse")[2];
    // A trajectory's session is known from its twin, a session's error from none.
    assert!(rmse(&trajectory) < rmse(&session), "{} {}", rmse(&trajectory), rmse(&session));
    // The model itself is the same whatever is held out.
    assert_eq!(trajectory["rmse"], session["rmse"]);
    let coverage = &trajectory["held_out"]["coverage"];
    let reached = coverage["all"]["reached"][2].number();
    assert!((0.5..=1.0).contains(&reached) && coverage["level"] == 0.9, "{coverage}");
    assert!(subject["held_out"]["no_coverage"].words().contains("2 groups; at least three"));
    let half = evaluate(&dir, data, &["--by", "trajectory", "--level", "0.5"]);
    let wider = half["held_out"]["coverage"]["all"]["reached"][2].number();
    assert!(wider < reached, "{wider} of rows at 0.5, {reached} at 0.9");

    for by in ["trajectory", "session", "subject"] {
        dir.lunula(&["evaluate", "m.json", "0.csv", "--by", by]).expect(2).says(&format!("only one {by}"));
    }
}

#[test]
fn shuffled_rows_flatter_and_the_report_says_how_much() {
    let dir = trained();
    let data = sessions(&dir);
    let rows = evaluate(&dir, data, &["--by", "rows", "--folds", "5", "--seed", "3"]);
    let found = &rows["held_out"];
    assert_eq!((found["parts"].list().len(), &found["by"]["rows"]["folds"]), (5, &5.into()));
    assert!(found["flattery"]["Fz_N"].number() > 1.0, "{found}");
    let other = evaluate(&dir, data, &["--by", "rows", "--folds", "5", "--seed", "4"]);
    assert_ne!(other["held_out"]["pooled"], found["pooled"]);
    assert!(found["no_coverage"].words().contains("promise too much"));
    let list: Vec<&str> = data.split(' ').collect();
    dir.lunula(&[&["evaluate", "m.json"], &list[..], &["--by", "rows"]].concat())
        .expect(0)
        .prints("shuffled rows flatter it")
        .prints("whole trajectories held out instead");
    dir.words("evaluate m.json 0.csv --by rows --folds 61").expect(2).says("60 rows can't be split into 61");
    for level in ["0", "1", "nan"] {
        dir.lunula(&["evaluate", "m.json", "0.csv", "--level", level]).expect(2).says("--level");
    }
}

#[test]
fn the_folder_holds_the_table_the_pictures_and_the_report() {
    let dir = trained();
    let data = sessions(&dir);
    let report = evaluate(&dir, data, &["--by", "trajectory", "--out", "ev"]);
    let found = dir.bytes_of("ev");
    let names: Vec<&str> = found.keys().map(String::as_str).collect();
    let pictures = ["by-magnitude", "held-out", "over-time", "scatter"];
    let mut wanted: Vec<String> =
        pictures.iter().flat_map(|name| [format!("{name}.png"), format!("{name}.svg")]).collect();
    wanted.extend(["merit.csv", "predicted.csv", "run.json"].map(str::to_owned));
    wanted.sort();
    assert_eq!(names, wanted);
    for name in pictures {
        image::load_from_memory(&found[&format!("{name}.png")]).expect("a picture");
        assert!(report["pictures"].to_string().contains(&format!("ev/{name}.png")), "{}", report["pictures"]);
    }
    assert_eq!(dir.parsed("ev/run.json"), report);

    let table = dir.table("ev/predicted.csv");
    assert_eq!(table.len(), 300);
    let header = dir.text("ev/predicted.csv");
    assert_eq!(
        header.lines().next(),
        Some("time_s,Fx_N,Fy_N,Fz_N,Fx_N_predicted,Fy_N_predicted,Fz_N_predicted,recording,session,subject")
    );
    let error: Vec<f64> = table
        .iter()
        .map(|row| row["Fz_N_predicted"].parse::<f64>().unwrap() - row["Fz_N"].parse::<f64>().unwrap())
        .collect();
    let rmse = (error.iter().map(|e| e * e).sum::<f64>() / 300.0).sqrt();
    near(&of(&report, "rmse")[2..], &[rmse], EXACT);
    assert_eq!([&table[130]["recording"], &table[130]["session"], &table[130]["subject"]], ["2.csv", "2", "a"]);

    // What stood there is not touched by a run that fails.
    dir.lunula(&["evaluate", "m.json", "nowhere.csv", "--out", "ev"]).expect(2).says("nowhere.csv");
    assert_eq!(dir.bytes_of("ev"), found);
    let again = [&["evaluate", "m.json", "--out", "ev"], &data.split(' ').collect::<Vec<_>>()[..]].concat();
    dir.lunula(&again).expect(0).says("ev/held-out.png existed before and is not of this run");
}
