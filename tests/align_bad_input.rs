//! `lunula align` on tables that are wrong, odd or empty: each a clear answer, and no half-written set.

use crate::util::{Answer, Dir};

/// A table of angles with the contract's columns alone: 2 s at 30 frames a second, J2 = 10 t degrees, the clock 100 s
/// ahead.
fn joints() -> String {
    let row = |k: usize| {
        let t = k as f64 / 30.0;
        format!("{k},{t:.6},{:.6},{:.5},0.1,ok\n", 100.0 + t, 10.0 * t)
    };
    "frame,time_s,clock_s,J2_deg,J2_sd_deg,status\n".to_owned() + &(0..60).map(row).collect::<String>()
}

/// Rows of a log without an LED's column, from these times on.
fn log(times: impl IntoIterator<Item = f64>) -> String {
    "time_s,P1\n".to_owned() + &times.into_iter().map(|t| format!("{t},{}\n", 0.1 * t)).collect::<String>()
}

fn every_40_ms(from_s: f64) -> impl Iterator<Item = f64> {
    (0..50).map(move |k| from_s + 0.04 * f64::from(k))
}

fn aligned(joints: &str, log: &str, more: &[&str]) -> (Dir, Answer) {
    let dir = Dir::new();
    dir.write("joints.csv", joints);
    dir.write("log.csv", log);
    let answer = dir.lunula(
        &[&["align", "--joints", "joints.csv", "--log", "log.csv", "--out", "out/training.csv"], more].concat(),
    );
    (dir, answer)
}

#[track_caller]
fn is_refused(joints: &str, log: &str, more: &[&str], words: &[&str]) {
    let (dir, answer) = aligned(joints, log, more);
    assert!(answer.refuses(words).stdout.is_empty());
    assert!(!dir.path("out").exists(), "nothing is left behind");
}

#[test]
fn the_contracts_columns_alone_are_enough() {
    let (dir, answer) = aligned(&joints(), &log(every_40_ms(100.0)).replacen(",10.012\n", ",NaN\n", 1), &["-q"]);
    answer.expect(0);
    let set = dir.table("out/training.csv");
    assert!(set[3]["P1"].is_empty() && !set[5]["P1"].is_empty(), "what is missing stays missing");
    for row in &set {
        let time_s: f64 = row["time_s"].parse().unwrap();
        if row["label_status"] == "ok" {
            let angle: f64 = row["J2_deg"].parse().unwrap();
            assert!((angle - 10.0 * (time_s - 100.0)).abs() <= 2e-5, "{angle} at {time_s}");
        }
    }
    assert_eq!(set.iter().filter(|row| row["label_status"] == "ok").count(), 50);
}

#[test]
fn recordings_that_do_not_overlap() {
    is_refused(
        &joints(),
        &log(every_40_ms(5000.0)),
        &["--sync", "offset=100"],
        &["does not overlap", "5000", "log.csv"],
    );
    is_refused(&joints(), &log(every_40_ms(5000.5)), &[], &["overlap"]);
}

#[test]
fn a_log_of_one_row_and_of_none() {
    let (dir, answer) = aligned(&joints(), &log([101.0]), &["-q"]);
    answer.expect(0);
    let set = dir.table("out/training.csv");
    assert_eq!((set.len(), set[0]["J2_deg"].parse::<f64>().unwrap().round()), (1, 10.0));
    is_refused(&joints(), &log([]), &[], &["log.csv"]);
}

#[test]
fn times_that_run_backward() {
    let reset: Vec<f64> = every_40_ms(100.0).chain(every_40_ms(50.0)).collect();
    is_refused(&joints(), &log(reset.clone()), &[], &["log.csv:52", "--piece"]);
    let (dir, answer) = aligned(&joints(), &log(reset), &["--piece", "1", "-q"]);
    answer.expect(0);
    assert_eq!(dir.table("out/training.csv").len(), 50);
}

#[test]
fn a_table_without_a_clock_or_with_a_clock_that_was_never_read() {
    let without = |line: &str| {
        let mut cells: Vec<&str> = line.split(',').collect();
        cells.remove(2);
        cells.join(",") + "\n"
    };
    let without: String = joints().lines().map(without).collect();
    is_refused(&without, &log(every_40_ms(100.0)), &[], &["--sync offset=SECONDS"]);
    let (_, answer) = aligned(&without, &log(every_40_ms(100.0)), &["--sync", "offset=100", "-q"]);
    answer.expect(0);
}

#[test]
fn everything_in_a_gap() {
    let lost: String = joints()
        .lines()
        .enumerate()
        .map(|(k, line)| {
            let cells: Vec<&str> = line.split(',').collect();
            let line =
                if k > 0 { format!("{},{},{},,,lost: a", cells[0], cells[1], cells[2]) } else { line.to_owned() };
            line + "\n"
        })
        .collect();
    is_refused(&lost, &log(every_40_ms(100.0)), &[], &["no row lies between two frames with an angle", "--max-gap"]);
}

#[test]
fn results_never_replace_inputs() {
    let dir = Dir::new();
    dir.write("joints.csv", joints());
    dir.write("log.csv", log(every_40_ms(100.0)));
    for out in ["joints.csv", "log.csv", "./log.csv"] {
        dir.lunula(&["align", "--joints", "joints.csv", "--log", "log.csv", "--out", out])
            .expect(2)
            .says("is an input itself");
    }
    dir.lunula(&["align", "--joints", "joints.csv", "--log", "log.csv", "--out", "t.txt"]).expect(2).says(".parquet");
    dir.lunula(&["align", "--joints", "gone.csv", "--log", "log.csv", "--out", "t.csv"]).expect(2).says("gone.csv");
    assert_eq!(dir.text("joints.csv"), joints());
}

#[test]
fn other_labs_columns() {
    let theirs = "\u{feff}Zeit;ch_a;Kraft\r\n".to_owned()
        + &every_40_ms(100.0)
            .map(|t| format!("{:.3};{:.3};-1,5\r\n", t, 0.1 * t).replace('.', ","))
            .collect::<String>();
    let (dir, answer) = aligned(&joints(), &theirs, &["--columns", "time_s=Zeit,P1=ch_a,Fz_N=Kraft", "-q"]);
    answer.expect(0);
    let set = dir.table("out/training.csv");
    assert_eq!((set.len(), set[3]["Fz_N"].as_str()), (50, "-1.5"));
    is_refused(&joints(), &theirs, &[], &["log.csv", "--columns"]);
    is_refused(&joints(), &theirs, &["--columns", "time_s=Zeit,P1=ch_b"], &["ch_b"]);
}

#[test]
fn a_lag_is_refused_where_nothing_is_related() {
    let mut state = 1u64;
    let noise = every_40_ms(100.0).map(|t| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        format!("{t},{}\n", (state >> 40) as f64 / 1e7)
    });
    let log = "time_s,P1\n".to_owned() + &noise.collect::<String>();
    let (dir, answer) = aligned(&joints(), &log, &["--sync", "correlate"]);
    answer.expect(2).says("joints.csv");
    assert!(!dir.path("out").exists());
}
