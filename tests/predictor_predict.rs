//! `lunula predict` from end to end: tables, streams, the gate between force and posture.

use std::collections::BTreeMap;
use std::io::{BufRead, BufReader, Read, Write};

use crate::util::page::ends;
use crate::util::running::{spawned, start};
use crate::util::sensor::{Recording, near};
use crate::util::{Answer, Dir};

/// The model is exact to rounding, newtons (measured: 2e-16) and degrees (3e-14).
const EXACT: f64 = 1e-13;

type Row = BTreeMap<String, String>;

/// Exact models `force.json` (with intervals) and `posture.json`, and a recording `r.csv` of 100 rows.
fn models() -> Dir {
    let dir = Dir::new();
    dir.recording("train.csv", &Recording::of(0..200));
    dir.recording("held.csv", &Recording::of(200..300).map("Fz_N", |row, v| v + [0.125, -0.125][row % 2]));
    dir.train("train.csv", "force", "force.json", &["--validate", "held.csv", "-q"]).expect(0);
    dir.train("train.csv", "posture", "posture.json", &["--validate", "held.csv", "-q"]).expect(0);
    dir.recording("r.csv", &Recording::of(300..400));
    dir
}

fn predict(dir: &Dir, paths: &[&str], more: &[&str]) -> Vec<Row> {
    dir.lunula(&[&["predict"], paths, &["--out", "p.csv", "-q"], more].concat()).expect(0);
    dir.table("p.csv")
}

fn header(dir: &Dir, name: &str) -> String {
    dir.text(name).lines().next().unwrap_or_default().to_owned()
}

fn column(rows: &[Row], name: &str) -> Vec<f64> {
    rows.iter().map(|row| row[name].parse().unwrap_or_else(|_| panic!("{name}: `{}`", row[name]))).collect()
}

#[test]
fn forces_or_angles_are_predicted_for_each_row() {
    let dir = models();
    let truth = Recording::of(300..400);
    let forces = predict(&dir, &["force.json", "r.csv"], &[]);
    let table = dir.text("p.csv");
    // Options may come between.
    dir.lunula(&["predict", "force.json", "--out", "p.csv", "r.csv", "-q"]).expect(0);
    assert_eq!(dir.text("p.csv"), table);
    dir.lunula(&["predict", "--out", "p.csv", "r.csv"]).expect(2).says("only one file is named");
    assert_eq!(header(&dir, "p.csv"), "time_s,Fx_N,Fy_N,Fz_N");
    for name in ["time_s", "Fx_N", "Fy_N", "Fz_N"] {
        near(&column(&forces, name), &truth.numbers(name), EXACT);
    }
    let angles = predict(&dir, &["posture.json", "r.csv"], &[]);
    assert_eq!(header(&dir, "p.csv"), "time_s,J2_deg");
    near(&column(&angles, "J2_deg"), &truth.numbers("J2_deg"), 1e-12);

    let report = dir.lunula(&["predict", "force.json", "r.csv", "--out", "p.csv", "--json"]).expect(0).json();
    assert_eq!(
        (&report["job"], &report["rows"], &report["rows_not_known"]),
        (&"predict".into(), &100.into(), &0.into())
    );
    assert_eq!(report["columns"], serde_json::json!(["Fx_N", "Fy_N", "Fz_N"]));
    // The forces measured are not needed, nor is the time.
    dir.recording("volts.csv", &truth.only(&["P1", "P2", "P3", "P4", "P5", "P6", "P7", "P8"]));
    let alone = predict(&dir, &["force.json", "volts.csv"], &[]);
    assert!(alone.iter().zip(&forces).all(|(a, b)| a["Fx_N"] == b["Fx_N"] && a["time_s"].is_empty()));
}

#[test]
fn a_dead_photodiode_is_warned_of_where_no_force_shows_it() {
    let dir = models();
    dir.lunula(&["predict", "force.json", "r.csv", "--out", "p.csv"]).expect(0).never_says("dead");
    dir.recording("dead.csv", &Recording::of(300..400).map("P3", |_, _| 2.46));
    let answer = dir.lunula(&["predict", "force.json", "dead.csv", "--out", "p.csv"]).expect(0);
    answer.says("dead.csv: P3 is 2.46 V in all 100 rows: dead or not connected");
    // One that hangs for a while shows beside those that it goes with.
    let all = Recording::of(0..300);
    let (first, second) = (all.numbers("P1"), all.numbers("P2"));
    let beside = all.map("P3", |row, _| 0.5 * (first[row] + second[row]));
    dir.recording("goes.csv", &beside);
    dir.lunula(&["predict", "force.json", "goes.csv", "--out", "p.csv"]).expect(0).never_says("did it hang?");
    dir.recording("hangs.csv", &beside.map("P3", |row, v| if (130..220).contains(&row) { 2.46 } else { v }));
    let answer = dir.lunula(&["predict", "force.json", "hangs.csv", "--out", "p.csv"]).expect(0);
    answer.says("hangs.csv: P3 doesn't change by a digit in 90 rows from 5.2 to 8.8 s");
}

#[test]
fn force_and_posture_are_gated() {
    let dir = models();
    let truth = Recording::of(300..400);
    let (fz, angle) = (truth.numbers("Fz_N"), truth.numbers("J2_deg"));
    let gated = |more: &[&str], f_min: f64, theta: f64| {
        let rows = predict(&dir, &["force.json", "posture.json", "r.csv"], more);
        assert_eq!(header(&dir, "p.csv"), "time_s,Fx_N,Fy_N,Fz_N,J2_deg,contact");
        let predicted = column(&rows, "J2_deg");
        let mut touch = 0;
        for (k, row) in rows.iter().enumerate() {
            let touching = -fz[k] >= f_min;
            touch += usize::from(touching);
            assert_eq!(row["contact"], if touching { "touch" } else { "bending" }, "row {k}");
            near(&[predicted[k]], &[if touching { theta } else { angle[k] }], 1e-12);
        }
        touch
    };
    let few = gated(&["--f-min", "0.6", "--theta-touch", "-2.5"], 0.6, -2.5);
    let many = gated(&[], 0.5, 0.0);
    assert!(0 < few && few < many && many < 100, "{few} {many}");
    let report =
        dir.lunula(&["predict", "posture.json", "force.json", "r.csv", "--out", "p.csv", "--json"]).expect(0).json();
    assert_eq!((&report["touch"], &report["bending"]), (&many.into(), &(100 - many).into()));

    // The order of the models is the order of the columns and nothing else.
    let one = predict(&dir, &["force.json", "posture.json", "r.csv"], &[]);
    let other = predict(&dir, &["posture.json", "force.json", "r.csv"], &[]);
    assert_eq!(one, other);
    assert_eq!(header(&dir, "p.csv"), "time_s,J2_deg,Fx_N,Fy_N,Fz_N,contact");
    for (more, words) in [
        (["--f-min", "0"], "threshold F_min of 0 N"),
        (["--f-min", "nan"], "threshold"),
        (["--theta-touch", "inf"], "theta_touch"),
        (["--hysteresis", "0.5"], "hysteresis of 0.5 N"),
    ] {
        let wrong = [&["predict", "force.json", "posture.json", "r.csv", "--out", "q.csv"], &more[..]].concat();
        dir.lunula(&wrong).expect(2).says(words);
    }
    dir.words("predict force.json force.json r.csv --out q.csv").expect(2).says("two models tell Fx_N");
    assert!(!dir.path("q.csv").exists());
}

#[test]
fn hysteresis_ends_a_touch_later_and_only_that() {
    let dir = models();
    let fz = Recording::of(300..400).numbers("Fz_N");
    let rows = predict(&dir, &["force.json", "posture.json", "r.csv"], &["--hysteresis", "0.2"]);
    let (mut touching, mut held) = (false, 0);
    for (row, fz) in rows.iter().zip(&fz) {
        touching = -fz >= if touching { 0.3 } else { 0.5 };
        held += usize::from(touching && -fz < 0.5);
        assert_eq!(row["contact"], if touching { "touch" } else { "bending" });
    }
    assert!(held > 0, "some rows touch by hysteresis alone");
    // A recording that begins does not touch, whatever the one before did.
    let soft = rows.iter().zip(&fz).position(|(row, fz)| row["contact"] == "touch" && -fz < 0.5).unwrap();
    let parted = Recording::of(300..400).with("session", |row, _| if row < soft { "1" } else { "2" }.to_owned());
    dir.recording("parted.csv", &parted);
    let parted = predict(&dir, &["force.json", "posture.json", "parted.csv"], &["--hysteresis", "0.2"]);
    assert_eq!((parted[soft - 1]["contact"].as_str(), parted[soft]["contact"].as_str()), ("touch", "bending"));
}

#[test]
fn a_row_that_lacks_a_voltage_is_invalid_not_touch() {
    let dir = models();
    let holes = Recording::of(300..400)
        .cell(3, "P2", "")
        .cell(7, "P8", "")
        .with("sensor_status", |row, _| if row == 9 { "saturated: P1" } else { "ok" }.to_owned());
    dir.recording("holes.csv", &holes);
    let both = ["force.json", "posture.json", "holes.csv"];
    let rows = predict(&dir, &both, &[]);
    assert_eq!(rows.len(), 100);
    let unknown: Vec<usize> = (0..100).filter(|&k| rows[k]["contact"] == "invalid").collect();
    assert_eq!(unknown, [3, 7, 9]);
    for k in unknown {
        assert!(["Fx_N", "Fy_N", "Fz_N", "J2_deg"].iter().all(|name| rows[k][*name].is_empty()), "{:?}", rows[k]);
        assert!(!rows[k]["time_s"].is_empty());
    }
    let report = dir.lunula(&[&["predict"], &both[..], &["--out", "p.csv", "--json"]].concat()).expect(0).json();
    assert_eq!(report["rows_not_known"], 3);
    assert_ne!(predict(&dir, &both, &["--keep-faults"])[9]["contact"], "invalid");

    dir.recording("holes.csv", &holes.cell(5, "P3", "nan"));
    let wrong = dir.lunula(&[&["predict"], &both[..], &["--out", "q.csv"]].concat()).expect(2);
    wrong.says("holes.csv:7: column `P3`: `NaN`").says("--drop-invalid");
    assert_eq!(predict(&dir, &both, &["--drop-invalid"])[5]["contact"], "invalid");
}

#[test]
fn intervals_stand_beside_the_predictions() {
    let dir = models();
    let rows = predict(&dir, &["force.json", "r.csv"], &["--intervals"]);
    assert_eq!(header(&dir, "p.csv"), "time_s,Fx_N,Fy_N,Fz_N,Fx_N_low,Fx_N_high,Fy_N_low,Fy_N_high,Fz_N_low,Fz_N_high");
    let (fz, low, high) = (column(&rows, "Fz_N"), column(&rows, "Fz_N_low"), column(&rows, "Fz_N_high"));
    for k in 0..100 {
        near(&[fz[k] - low[k], high[k] - fz[k]], &[0.125; 2], EXACT);
    }
    dir.train("train.csv", "posture", "bare.json", &["-q"]).expect(0);
    let without =
        dir.lunula(&["predict", "force.json", "bare.json", "r.csv", "--intervals", "--out", "q.csv"]).expect(2);
    without.says("the model of J2_deg has no prediction intervals; train it with --validate");
}

#[test]
fn parquet_is_read_and_written_alike() {
    let dir = models();
    let both = ["force.json", "posture.json"];
    let csv = predict(&dir, &[&both[..], &["r.csv"]].concat(), &[]);
    let out = |data: &str, to: &str| {
        dir.lunula(&[&["predict"], &both[..], &[data, "--out", to, "-q"]].concat()).expect(0);
    };
    out("r.csv", "p.parquet");
    let [a, b] = ["p.csv", "p.parquet"].map(|name| lunula::table::Table::read(&dir.path(name)).unwrap());
    assert_eq!((a.names(), a.rows(), csv.len()), (b.names(), b.rows(), 100));
    for name in ["time_s", "Fx_N", "Fz_N", "J2_deg"] {
        assert_eq!(a.numbers(name).unwrap(), b.numbers(name).unwrap(), "{name}");
    }
    assert_eq!(a.texts("contact").unwrap(), b.texts("contact").unwrap());
    assert!(b.facts().iter().any(|(key, value)| key == "forces" && value.contains("negative Fz_N")));
    // A table of predictions has the time and forces that another training needs: Parquet in.
    let trained = dir.train("p.parquet", "Fz_N", "q.json", &["--inputs", "Fx_N,Fy_N", "-q"]);
    trained.expect(0);
    dir.lunula(&["predict", "q.json", "p.parquet", "--out", "q.csv", "-q"]).expect(0);
    dir.lunula(&["predict", "q.json", "p.csv", "--out", "q2.csv", "-q"]).expect(0);
    assert_eq!(dir.text("q.csv"), dir.text("q2.csv"));
}

/// A whole text through a stream.
fn streamed(dir: &Dir, arguments: &[&str], text: &str) -> Answer {
    let mut running = start(dir, &[&["predict"], arguments].concat());
    running.write(text);
    let (code, lines, stderr) = running.end();
    Answer { code, stdout: lines.iter().map(|line| line.to_owned() + "\n").collect(), stderr }
}

#[test]
fn a_stream_gives_the_very_text_of_the_table() {
    let dir = models();
    dir.train(
        "train.csv",
        "force",
        "lags.json",
        &["--lags", "0.04,0.1", "--friction", "0.5", "--validate", "held.csv", "-q"],
    )
    .expect(0);
    dir.lunula(&["evaluate", "lags.json", "held.csv", "--by", "rows", "--out", "lags", "-q"]).expect(0);
    let few = ["--model", "network", "--hidden", "3", "--restarts", "1", "--epochs", "5", "-q"];
    dir.train("train.csv", "posture", "network.json", &few).expect(0);
    let data = Recording::of(300..360)
        .cell(3, "P2", "")
        .cell(20, "time_s", "")
        .cell(50, "P1", "1.7e308")
        .with("session", |row, _| if row < 40 { "1" } else { "2" }.to_owned())
        .with("sensor_status", |row, _| if row == 30 { "no ambient" } else { "ok" }.to_owned())
        .with("note", |_, _| "\"a, b\"".to_owned());
    dir.recording("d.csv", &data);
    let sets: [&[&str]; 4] = [
        &["force.json", "--intervals"],
        &["posture.json"],
        &["force.json", "network.json", "--hysteresis", "0.2", "--theta-touch", "3"],
        &["lags.json", "posture.json", "--intervals"],
    ];
    for set in sets {
        let (models, more): (Vec<&str>, Vec<&str>) = {
            let models = set.iter().take_while(|name| name.ends_with(".json"));
            (models.copied().collect(), set.iter().skip_while(|name| name.ends_with(".json")).copied().collect())
        };
        dir.lunula(&[&["predict"], &models[..], &["d.csv", "--out", "p.csv", "-q"], &more].concat()).expect(0);
        let answer = streamed(&dir, &[&models[..], &["-"], &more].concat(), &data.csv()).expect(0);
        assert_eq!(answer.stdout, dir.text("p.csv"), "{set:?}");
        assert_eq!(answer.stdout.lines().count(), 61);
    }
}

#[test]
fn each_row_is_answered_before_the_next_is_written() {
    let dir = models();
    let data = Recording::of(0..20);
    let fz = data.numbers("Fz_N");
    let csv = data.csv();
    let mut lines = csv.lines();
    let mut running = start(&dir, &["predict", "force.json", "posture.json", "-"]);
    running.write(&format!("{}\n", lines.next().unwrap()));
    assert_eq!(running.line(), "time_s,Fx_N,Fy_N,Fz_N,J2_deg,contact");
    for (k, line) in lines.enumerate() {
        // Half a line is no row yet.
        let (half, rest) = line.split_at(line.len() / 2);
        running.write(half);
        running.write(&format!("{rest}\r\n"));
        let answer = running.line();
        let cells: Vec<&str> = answer.split(',').collect();
        near(&[cells[3].parse().unwrap()], &[fz[k]], EXACT);
    }
    assert_eq!(running.end(), (0, vec![], String::new()));
}

#[test]
fn a_stream_warns_of_an_edited_model_before_its_first_row() {
    let dir = models();
    let edited = dir.text("force.json").replacen("\"low\": 2", "\"low\": 1", 1);
    dir.write("edited.json", edited);
    let mut running = start(&dir, &["predict", "edited.json", "-"]);
    running.hears("edited.json: was edited after it was trained");
    running.write(&Recording::of(0..1).csv());
    assert_eq!((running.line().as_str(), running.line().split(',').count()), ("time_s,Fx_N,Fy_N,Fz_N", 4));
}

#[test]
fn what_is_beyond_a_number_is_not_known() {
    let dir = models();
    dir.recording("far.csv", &Recording::of(300..303).cell(1, "P1", "1.7e308"));
    let answer = dir.lunula(&["predict", "posture.json", "far.csv", "--out", "p.csv", "--json"]).expect(0);
    assert_eq!((&answer.json()["rows_not_known"], &answer.json()["rows_outside"]), (&1.into(), &1.into()));
    let empty: Vec<bool> = dir.table("p.csv").iter().map(|row| row["J2_deg"].is_empty()).collect();
    assert_eq!(empty, [false, true, false]);
    dir.recording("far.csv", &Recording::of(300..303).cell(1, "P1", "1.7e308").cell(1, "Fz_N", "0"));
    let judged = dir.lunula(&["evaluate", "posture.json", "far.csv", "--json"]).expect(0);
    assert_eq!((&judged.json()["rows"], &judged.json()["not_finite"]), (&2.into(), &1.into()));
    judged.says("1 of 3 rows have no finite prediction");
}

#[test]
fn a_stream_of_names_alone_and_an_empty_one() {
    let dir = models();
    let names = Recording::of(0..0).csv();
    let none = streamed(&dir, &["force.json", "-"], &names).expect(2).says("standard input: no row came");
    assert_eq!(none.stdout, "time_s,Fx_N,Fy_N,Fz_N\n");
    dir.write("names.csv", &names);
    predict(&dir, &["force.json", "names.csv"], &[]);
    assert_eq!(dir.text("p.csv"), "time_s,Fx_N,Fy_N,Fz_N\n");
    let empty = streamed(&dir, &["force.json", "-"], "").expect(2).says("standard input: ends before a line of names");
    assert_eq!(empty.stdout, "");
    let lacking = Recording::of(0..2).renamed("P3", "x3").csv();
    streamed(&dir, &["force.json", "-"], &lacking).expect(2).says("no column `P3`").says("--columns P3=ch_1");
    let log = Recording::of(0..2).with("led", |_, _| "1".to_owned()).csv();
    // Without an unlit row before it a lit row has no value.
    let dark = streamed(&dir, &["force.json", "-"], &log).expect(1).says("the LED was never off");
    assert_eq!(dark.stdout, "time_s,Fx_N,Fy_N,Fz_N\n0,,,\n0.04,,,\n");
    let numbers = "1,2,3,4,5,6,7,8,9,10,11,12,13\n";
    streamed(&dir, &["force.json", "-"], numbers).expect(2).says("no line of names came before it");
    streamed(&dir, &["force.json", "-", "--out", "p.csv"], "").expect(2).says("leave --out away");
    streamed(&dir, &["nowhere.json", "-"], "").expect(2).says("nowhere.json");
}

#[test]
fn a_wrong_cell_costs_its_row() {
    let dir = models();
    let good = Recording::of(300..305);
    for (text, words) in [
        ("2 V", "standard input: line 5 has a cell that is no finite number"),
        ("1,2", "standard input: line 5 has more or fewer cells than there are columns"),
    ] {
        let bad = good.clone().cell(3, "P2", text);
        let answer = streamed(&dir, &["force.json", "-"], &bad.csv()).expect(1).says(words);
        // The names and four rows.
        assert_eq!(answer.stdout.lines().count(), 5, "{}", answer.stdout);
    }
    let missing = streamed(&dir, &["force.json", "-"], &good.clone().cell(3, "P2", "NaN").csv()).expect(0);
    let lines: Vec<&str> = missing.stdout.lines().collect();
    assert!(lines.len() == 6 && lines[4].ends_with(",,,") && !lines[5].ends_with(','), "{}", missing.stdout);
    // A last line without its end is a row.
    let whole = good.csv();
    let cut = streamed(&dir, &["force.json", "-"], whole.trim_end()).expect(0);
    assert_eq!(cut.stdout.lines().count(), 6);
}

#[test]
fn a_reader_that_goes_away_ends_the_stream_quietly() {
    let dir = models();
    let mut child = spawned(&dir, &["predict", "force.json", "-"]);
    let mut to = child.stdin.take().unwrap();
    let csv = Recording::of(0..500).csv();
    let (first, rest) = csv.split_at(csv.match_indices('\n').nth(3).unwrap().0 + 1);
    to.write_all(first.as_bytes()).expect("the program reads");
    // The names and three rows are taken, then nobody listens.
    let mut out = BufReader::new(child.stdout.take().expect("a pipe"));
    (0..4).for_each(|_| assert!(out.read_line(&mut String::new()).expect("text") > 0));
    drop(out);
    // The program may be gone before all is written.
    let _ = to.write_all(rest.as_bytes());
    drop(to);
    let mut said = child.stderr.take().expect("a pipe");
    assert_eq!(ends(child), 0);
    let mut stderr = String::new();
    said.read_to_string(&mut stderr).expect("text");
    assert_eq!(stderr, "");
}

#[test]
fn results_do_not_go_over_inputs_and_stay_when_a_run_fails() {
    let dir = models();
    predict(&dir, &["force.json", "r.csv"], &[]);
    let before = dir.text("p.csv");
    dir.lunula(&["predict", "force.json", "nowhere.csv", "--out", "p.csv"]).expect(2).says("nowhere.csv");
    assert_eq!(dir.text("p.csv"), before);
    dir.lunula(&["predict", "force.json", "r.csv", "--out", "r.csv"]).expect(2).says("r.csv: is an input itself");
    dir.lunula(&["predict", "force.json", "r.csv", "--out", "p.txt"]).expect(2).says("ends in .csv or .parquet");
    dir.lunula(&["predict", "force.json", "r.csv"]).expect(2).says("--out is needed");
    dir.lunula(&["predict", "force.json"]).expect(2);
    dir.lunula(&["predict", "r.csv", "force.json", "--out", "q.csv"]).expect(2).says("r.csv: is no model of lunula");
    let model = dir.text("force.json");
    dir.lunula(&["predict", "force.json", "r.csv", "--out", "force.json"]).expect(2);
    assert_eq!(dir.text("force.json"), model);
}
