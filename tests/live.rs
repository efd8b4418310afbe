//! `lunula live`, `record` and `switch` from end to end: files, pipes, TCP, a device that goes away, a clock that
//! stops.

use std::fmt::Write as _;
use std::io::{BufRead, BufReader, Write};
use std::net::{TcpListener, TcpStream};
use std::time::{Duration, Instant};

use crate::util::Dir;
use crate::util::running::{PATIENCE, start, started};

/// A row: P1 is 1 V and half a volt per newton of pressing.
fn row(t_s: f64, pressing_n: f64) -> String {
    format!("{t_s:.3},{:.4},{:.4}\n", 1.0 + 0.5 * pressing_n, -pressing_n)
}

/// Presses of 0.4 s every 2 s, rising within 0.1 s, 100 rows a second.
fn pressing(t_s: f64) -> f64 {
    let phase = t_s % 2.0 - 1.0;
    if (0.0..0.4).contains(&phase) { (phase / 0.1).min(1.0) } else { 0.0 }
}

fn recording(seconds: f64) -> String {
    let mut text = "time_s,P1,Fz_N\n".to_owned();
    for k in 0..(100.0 * seconds) as usize {
        let t_s = 0.01 * k as f64;
        // Light that wavers by a hundredth of a newton.
        let waver = 0.01 * (7.3 * t_s).sin() * (3.1 * t_s).cos();
        let _ = writeln!(text, "{t_s:.3},{:.5},{:.4}", 1.0 + 0.5 * (pressing(t_s) + waver), -pressing(t_s));
    }
    text
}

/// `m.json` of forces from P1, exact, and `sw.toml`.
pub(crate) fn desk() -> Dir {
    let dir = Dir::new();
    let mut text = "time_s,P1,Fz_N\n".to_owned();
    (0..200).for_each(|k| text.push_str(&row(0.01 * f64::from(k), 0.02 * f64::from(k) - 1.0)));
    dir.write("train.csv", text);
    dir.train("train.csv", "Fz_N", "m.json", &["-q"]).expect(0);
    dir.write("sw.toml", "on_N = 0.5\noff_N = 0.3\nwatchdog_s = 0.3\nname = \"x+\"\nfinger = \"index\"\n");
    dir
}

#[test]
fn live_and_batch_and_every_speed_give_the_same_bytes() {
    let dir = desk();
    dir.write("r.csv", recording(20.0));
    dir.lunula(&["predict", "m.json", "r.csv", "--out", "p.csv", "-q"]).expect(0);
    let live = |rate: &str, events: &str| {
        let source = format!("r.csv?rate={rate}");
        let all = ["live", "--source", &source, "--model", "m.json", "--switch", "sw.toml", "--events", events, "-q"];
        dir.lunula(&all).expect(0).stdout
    };
    let (fast, slow) = (live("max", "a.jsonl"), live("40", "b.jsonl"));
    assert_eq!(fast, slow);
    assert_eq!(dir.text("a.jsonl"), dir.text("b.jsonl"));
    let without: String = fast.lines().map(|line| line.rsplit_once(',').unwrap().0.to_owned() + "\n").collect();
    assert_eq!(without, dir.text("p.csv"));
    // Ten presses and releases, a half newton after each begins.
    let events = dir.json_lines("a.jsonl");
    assert_eq!(events.len(), 20);
    for (k, pair) in events.chunks(2).enumerate() {
        let at = |event: &serde_json::Value| event["t"].as_f64().unwrap() - 2.0 * k as f64 - 1.0;
        assert!(pair[0]["event"] == "press" && (at(&pair[0]) - 0.05).abs() <= 0.011, "{}", pair[0]);
        assert!(pair[1]["event"] == "release" && (at(&pair[1]) - 0.40).abs() <= 0.011, "{}", pair[1]);
        assert!(pair[0]["switch"] == "x+" && pair[0]["finger"] == "index" && pair[0]["reason"] == "value");
    }
    // A Parquet table is the same stream.
    dir.lunula(&["record", "--source", "r.csv", "--out", "r.parquet", "-q"]).expect(0);
    let table = dir.lunula(&["live", "--source", "r.parquet", "--model", "m.json", "-q"]).expect(0).stdout;
    assert_eq!(table, without);
}

#[test]
fn a_modulated_log_is_answered_as_the_batch_answers_it_under_the_same_rule() {
    let dir = desk();
    let mut text = "t_ms,LED,P1\n".to_owned();
    for k in 0..400 {
        let (t_s, lit) = (0.02 * f64::from(k), k % 2);
        let ambient = 0.3 + 0.05 * (1.7 * t_s).sin();
        let volts = ambient + f64::from(lit) * (1.0 + 0.5 * pressing(t_s));
        let _ = writeln!(text, "{},{lit},{volts:.4}", 1000.0 * t_s);
    }
    dir.write("log.csv", &text);
    dir.lunula(&["predict", "m.json", "log.csv", "--ambient", "preceding", "--out", "p.csv", "-q"]).expect(0);
    let live = dir.words("live --source log.csv --model m.json --f-min 9").expect(0).says_all(&[
        "the unlit row before it is taken away",
        "note: --f-min is of no use here: only a model of force and one of posture",
    ]);
    assert_eq!(live.stdout, dir.text("p.csv"));
    assert_eq!(live.stdout.lines().count(), 201);
    // However the bytes are cut.
    let mut running = start(&dir, &["live", "--source", "-", "--model", "m.json", "-q"]);
    let mut left = text.as_str();
    let mut step = 1;
    while !left.is_empty() {
        step = (step * 7 + 3) % 41 + 1;
        let (piece, rest) = left.split_at(step.min(left.len()));
        running.write(piece);
        left = rest;
    }
    let (code, lines, _) = running.end();
    assert_eq!((code, lines.join("\n") + "\n"), (0, live.stdout));
}

#[test]
fn a_recording_is_what_align_and_train_read_and_is_not_lost() {
    let dir = desk();
    dir.write("r.csv", recording(5.0));
    let all = ["record", "--source", "r.csv", "--out", "copy.csv"];
    dir.lunula(&all).expect(0).says("500 rows at 100.0 Hz");
    dir.lunula(&all).expect(2).says("copy.csv: exists already").says("--replace");
    dir.lunula(&[&all[..], &["--replace", "-q"]].concat()).expect(0);
    dir.lunula(&["train", "copy.csv", "--target", "Fz_N", "--out", "again.json", "-q"]).expect(0);
    // Nor is its certificate, by a table of another format.
    let parquet = ["record", "--source", "r.csv", "--out", "copy.parquet"];
    dir.lunula(&parquet).expect(2).says("copy.stream.json: exists already");
    let named = ["record", "--source", "phantom:contacts?seconds=1&rate=max", "--names", "a,b", "--out", "ab.csv"];
    dir.lunula(&named).expect(2).says("its columns have names of their own; leave --names out");
    let report = dir.parsed("copy.stream.json");
    assert_eq!(
        (&report["rows"], &report["sources"][0]["lost"], &report["sources"][0]["spoilt"]),
        (&500.into(), &0.into(), &serde_json::json!([]))
    );
    // Over an input, nothing is written.
    let text = dir.text("r.csv");
    dir.lunula(&["record", "--source", "r.csv", "--out", "r.csv", "--replace"]).expect(2).says("is an input itself");
    assert_eq!(dir.text("r.csv"), text);
    // Forces that no finger has are warned of while they can be measured again.
    let thousands = text.lines().map(|line| match line.rsplit_once(',') {
        Some((row, force)) if force != "Fz_N" => {
            format!("{row},{}\n", -1000.0 * force.parse::<f64>().expect("a number"))
        }
        _ => format!("{line}\n"),
    });
    dir.write("mn.csv", thousands.collect::<String>());
    let doubted = dir.lunula(&["record", "--source", "mn.csv", "--out", "as-mn.csv"]).expect(0);
    doubted.says("Fz_N goes from 0 to 1000 N").says("as if the finger pulled");
    // Without a sample there is no file.
    dir.write("none.csv", "time_s,P1\n");
    dir.lunula(&["record", "--source", "none.csv", "--out", "n.csv"]).expect(2).says("no row came");
    assert!(!dir.path("n.csv").exists() && !dir.path("n.stream.json").exists());
}

#[test]
fn a_recording_makes_its_folder_and_where_none_can_be_nothing_begins() {
    let dir = desk();
    dir.write("1.csv", recording(5.0));
    let record = |out: &str| dir.lunula(&["record", "--source", "1.csv", "--out", out]);
    record("of/anna/today.csv").expect(0);
    assert!(dir.table("of/anna/today.csv").len() > 100, "rows are missing");
    dir.write("file", "");
    for out in ["file/today.csv", "file/of/today.csv"] {
        record(out).expect(2).says("file: cannot be written to").says("choose another --out");
    }
    record("of/anna/today.csv").expect(2).says("exists already");
}

#[test]
fn two_do_not_record_into_one_file() {
    let dir = desk();
    dir.write("1.csv", recording(1.0));
    for (out, grows) in [("r.csv", "r.csv"), ("p.parquet", "p.parquet.csv")] {
        let mut first = start(&dir, &["record", "--source", "-", "--out", out]);
        first.write("time_s,P1\n0,1\n0.01,2\n");
        let text = || std::fs::read_to_string(dir.path(grows)).unwrap_or_default();
        let begin = Instant::now();
        while text().lines().count() < 3 {
            assert!(begin.elapsed() < PATIENCE, "{out}: nothing is recorded");
            std::thread::sleep(Duration::from_millis(10));
        }
        let second = dir.lunula(&["record", "--source", "1.csv", "--out", out, "--replace"]).expect(2);
        second.says("another program is recording into it");
        assert_eq!(text(), "time_s,P1\n0,1\n0.01,2\n");
        first.child.kill().expect("our own child");
        first.child.wait().expect("a child");
        // Who has ended, however, keeps no one out.
        dir.lunula(&["record", "--source", "1.csv", "--out", out, "--replace"]).expect(0);
    }
}

#[test]
fn what_lies_behind_the_seconds_is_not_said_of_them() {
    let dir = desk();
    let rows: String =
        (0..800).filter(|k| !(400..600).contains(k)).map(|k| format!("{}.{:02},1\n", k / 100, k % 100)).collect();
    dir.write("gap.csv", format!("time_s,P1\n{rows}garbage\n"));
    let record = |more: &[&str]| dir.lunula(&[&["record", "--source", "gap.csv", "--out", "o.csv"], more].concat());
    record(&["--seconds", "3"]).expect(0).never_says("never came").never_says("failed");
    assert_eq!(dir.parsed("o.stream.json")["sources"][0]["rows"], 301);
    record(&["--replace"]).expect(1).says("200 rows never came or came late");
}

#[test]
fn killed_at_any_moment_a_recording_lacks_a_second_at_most() {
    let dir = desk();
    let mut running = start(&dir, &["record", "--source", "-", "--out", "r.csv"]);
    running.write("time_s,P1\n");
    let begin = Instant::now();
    let mut sent = Vec::new();
    for k in 0..250 {
        running.write(&format!("{k},{k}.5\n"));
        sent.push(begin.elapsed());
        std::thread::sleep(Duration::from_millis(10));
    }
    running.child.kill().expect("our own child");
    let killed = begin.elapsed();
    running.child.wait().expect("a child");
    let text = dir.text("r.csv");
    let lines: Vec<&str> = text.lines().skip(1).collect();
    assert!(text.starts_with("time_s,P1\n"), "{text}");
    assert!(lines.iter().enumerate().all(|(k, line)| *line == format!("{k},{k}.5")), "whole rows, in order");
    let due = sent.iter().filter(|at| killed - **at > Duration::from_secs(1)).count();
    assert!(lines.len() >= due && due > 50, "{} of {due} rows", lines.len());
}

#[test]
fn spoilt_rows_cost_themselves_and_are_counted() {
    let dir = desk();
    let text = "time_s,P1\n0,1\n0.01,x\n0.02,1.5,7\n\u{1}\u{2}\n0.03,1.5\n# note\n\n0.04,2";
    dir.write("bad.csv", text);
    let live = dir.lunula(&["live", "--source", "bad.csv", "--model", "m.json", "--out", "r.csv"]).expect(1);
    let live = live
        .says("line 3 has a cell that is no finite number (`0.01,x`)")
        .says("line 4 has more or fewer cells than there are columns");
    assert_eq!(live.stdout.lines().count(), 4, "{}", live.stdout);
    let report = dir.parsed("r.stream.json");
    let spoilt: u64 =
        report["sources"][0]["spoilt"].as_array().unwrap().iter().map(|one| one["count"].as_u64().unwrap()).sum();
    assert_eq!(spoilt, 3);
    assert_eq!(dir.text("r.csv"), "time_s,P1\n0,1\n0.03,1.5\n0.04,2\n");
    assert_eq!(dir.text("r.predicted.csv"), live.stdout);
    dir.write("dated.csv", "time_s,P1\n2026-03-21T02:00:59,1\n2026-03-21T02:01:00,2\n");
    let dated = dir.lunula(&["record", "--source", "dated.csv", "--out", "d.csv"]).expect(2);
    dated.says("line 2 has a cell that is no finite number").says("a stream's time is a number");
    live.never_says("a stream's time is a number");
}

#[test]
fn a_time_that_is_not_read_is_named() {
    let dir = desk();
    for (names, is_said) in [("ms,P1", true), ("time_ms,P1", false), ("P1", false)] {
        let mut running = started(&dir, "live --source - --model m.json");
        running.write(&format!("{names}\n{}", if names == "P1" { "1\n1.5\n" } else { "0,1\n10,1.5\n" }));
        let (code, lines, said) = running.end();
        assert_eq!((code, lines.len()), (0, 3), "{said}");
        assert_eq!(said.contains("where one of ms is the time"), is_said, "{names}: {said}");
    }
}

#[test]
fn silence_lets_go_in_time_and_what_still_presses_does_not_press() {
    let dir = desk();
    let mut running = started(&dir, "live --source - --model m.json --switch sw.toml --events e.jsonl");
    running.write("time_s,P1,Fz_N\n");
    for k in 0..20 {
        running.write(&row(0.01 * f64::from(k), if k < 10 { 0.0 } else { 1.0 }));
        std::thread::sleep(Duration::from_millis(10));
    }
    let silent = Instant::now();
    running.hears("state: stalled");
    let event = loop {
        let text = std::fs::read_to_string(dir.path("e.jsonl")).unwrap_or_default();
        if let Some(line) = text.lines().find(|line| line.contains("release")) {
            break line.to_owned();
        }
        assert!(silent.elapsed() < PATIENCE, "never let go: {text}");
        std::thread::sleep(Duration::from_millis(5));
    };
    assert!(event.contains("\"reason\":\"watchdog\"") && event.contains("\"t\":0.49"), "{event}");
    // Still pressing.
    (100..150).for_each(|k| running.write(&row(0.01 * f64::from(k), 1.0)));
    let (code, lines, _) = running.end();
    assert_eq!((code, lines.len()), (0, 71));
    assert!(lines[15].ends_with(",1") && lines[30..].iter().all(|line| line.ends_with(",0")));
    assert_eq!(dir.text("e.jsonl").lines().count(), 2);
}

#[test]
fn a_device_that_goes_away_is_waited_for() {
    let dir = desk();
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let source = format!("tcp:{}", listener.local_addr().expect("an address"));
    let device = std::thread::spawn(move || {
        let mut gone = Instant::now();
        for visit in 0..2 {
            let (mut stream, _) = listener.accept().expect("the program comes");
            if visit == 1 {
                assert!(gone.elapsed() < Duration::from_secs(1), "back after {:?}", gone.elapsed());
            }
            let mut text = "time_s,P1,Fz_N\n".to_owned();
            (0..30).for_each(|k| text.push_str(&row(10.0 * f64::from(visit) + 0.01 * f64::from(k), f64::from(k / 15))));
            // Half a row before it goes.
            text.push_str("1.5,");
            stream.write_all(text.as_bytes()).expect("the program reads");
            std::thread::sleep(Duration::from_millis(100));
            gone = Instant::now();
        }
    });
    let all = format!("live --source {source} --model m.json --switch sw.toml --events e.jsonl --out r.csv");
    let mut running = started(&dir, &format!("{all} --seconds 10.2"));
    running.hears("state: lost");
    running.hears("state: reconnecting");
    running.hears("state: ok");
    device.join().expect("the device");
    let (code, lines, said) = {
        drop(running.child.stdin.take());
        running.end()
    };
    assert_eq!(code, 0, "{said}");
    assert_eq!(dir.text("r.predicted.csv"), lines.join("\n") + "\n");
    let events = dir.text("e.jsonl");
    assert!(events.lines().nth(1).unwrap().contains("\"reason\":\"lost\""), "{events}");
    let report = dir.parsed("r.stream.json");
    assert_eq!(report["rows"], dir.text("r.csv").lines().count() - 1);
    assert!(dir.text("r.csv").lines().count() > 45, "one file");
}

#[test]
fn rows_are_handed_out_over_tcp_too() {
    let dir = desk();
    let mut running = start(&dir, &["live", "--source", "-", "--model", "m.json", "--tcp", "127.0.0.1:0"]);
    let said = running.hears("rows are at tcp:");
    let reader = std::net::TcpStream::connect(said.rsplit_once("tcp:").unwrap().1).expect("it listens");
    running.write("time_s,P1,Fz_N\n");
    running.write(&row(0.0, 0.5));
    running.hears("a reader came");
    (1..20).for_each(|k| running.write(&row(0.01 * f64::from(k), 0.5)));
    let (code, lines, _) = running.end();
    let read: Vec<String> = BufReader::new(reader).lines().map_while(Result::ok).collect();
    assert_eq!((code, lines.len()), (0, 21));
    assert!(read[0] == lines[0] && read.len() >= 20 && read[read.len() - 19..] == lines[2..], "{read:?}");
}

#[test]
fn bad_sources_are_said_with_what_to_do() {
    let dir = desk();
    let live = |source: &str, words: &[&str]| {
        dir.lunula(&["live", "--source", source, "--model", "m.json"]).refuses(words);
    };
    live("serial:/dev/ttyNowhere?baud=9600", &["serial:/dev/ttyNowhere?baud=9600: does not exist"]);
    live("nowhere.csv", &["nowhere.csv: does not exist"]);
    live("tcp:127.0.0.1:1", &["tcp:127.0.0.1:1: refuses", "start the device"]);
    live("serial:/dev/ttyX?bd=3", &["there is no `bd` here"]);
    live("lsl:name=x", &["lsl"]);
    // Counts where volts are needed; a wrong baud rate; other columns than the model's.
    let counts: String = (0..40).map(|k| format!("{k},{}\n", 6553 + k)).collect();
    dir.write("counts.csv", format!("time_s,P1\n{counts}"));
    live("counts.csv", &["look like a converter's counts", "--volts-per-count 10/65536"]);
    let kept = dir.lunula(&["record", "--source", "counts.csv", "--out", "counts.kept.csv"]);
    kept.expect(0).says("look like a converter's counts");
    let scaled = ["live", "--source", "counts.csv", "--model", "m.json", "--volts-per-count", "10/65536", "-q"];
    dir.lunula(&scaled).expect(0);
    // A model of counts reads counts.
    let trained: String = (0..200).map(|k| format!("{k},{},{}\n", 6000 + 7 * k, -0.01 * f64::from(k))).collect();
    dir.write("trained.csv", format!("time_s,P1,Fz_N\n{trained}"));
    dir.train("trained.csv", "Fz_N", "counts.json", &["-q"]).expect(0);
    dir.words("live --source counts.csv --model counts.json").expect(0).never_says("counts");
    // What a terminal wrote to a file of a device that starts.
    dir.write("boot.csv", format!("ets Jun  8 2016 00:22:57\nrst:0x1 (POWERON),boot:0x13\n{}", recording(1.0)));
    dir.words("record --source boot.csv --out boot.kept.csv").expect(0).says("100 rows at 100.0 Hz");
    judge(&dir, "boot.csv", &[]).expect(0);
    let mut garbage = start(&dir, &["live", "--source", "-", "--model", "m.json"]);
    let noise: Vec<u8> = (0..9000u32).map(|k| (k.wrapping_mul(2_654_435_761) >> 24) as u8 | 0x80).collect();
    let to = garbage.child.stdin.as_mut().expect("open");
    let _ = to.write_all(&noise);
    let (code, _, said) = garbage.end();
    assert!(code == 2 && said.contains("wrong baud rate"), "{said}");
    dir.write("other.csv", "time_s,P2\n0,1\n");
    live("other.csv", &["no column `P1`", "--columns P1=ch_1"]);
    dir.write("numbers.csv", "0,1\n1,1\n");
    live("numbers.csv", &["no line of names came before it", "--names"]);
    dir.lunula(&["live", "--source", "numbers.csv", "--names", "time_s,P1", "--model", "m.json", "-q"]).expect(0);
    let three = ["live", "--source", "numbers.csv", "--names", "time_s,P1,P2", "--model", "m.json"];
    dir.lunula(&three).expect(2).says("line 2 has 2 cells, and --names gives 3");
}

#[test]
fn a_session_that_answers_nothing_says_why_and_leaves_no_answers_of_another() {
    let dir = desk();
    let rows = |led: &str| (0..300).map(|k| format!("{:.2},{led},1.5\n", 0.01 * f64::from(k))).collect::<String>();
    for (name, led) in [("on.csv", "1"), ("off.csv", "0")] {
        dir.write(name, format!("time_s,led,P1\n{}", rows(led)));
    }
    dir.write("r.csv", recording(3.0));
    let live = |source: &str, more: &[&str]| {
        dir.lunula(&[&["live", "--source", source, "--model", "m.json", "--out", "k.csv", "-q"], more].concat())
    };
    live("r.csv", &[]).expect(0).never_says("not recorded");
    let [rows, answers] = ["k.csv", "k.predicted.csv"].map(|name| dir.table(name).len());
    assert!(rows == 300 && answers == 300, "{rows} {answers}");
    live("off.csv", &["--replace"]).expect(1).says("failed: no row is answered: the LED was on in no row");
    assert!(dir.table("k.predicted.csv").is_empty());
    live("on.csv", &["--replace"]).expect(1).says("no row is answered: the LED was never off");
    live("r.csv", &["--replace", "--keep", "P9"]).expect(2).says("has no column `P9`");
    let record = ["record", "--source", "r.csv", "--out", "n.csv", "--piece", "1", "--full-scale", "0,5"];
    let said = dir.lunula(&record).expect(0).says("--piece is of no use here: rows are taken as they come");
    said.says("--full-scale is of no use here: rows are recorded as they come");
}

#[test]
fn rows_that_are_left_out_and_clocks_that_begin_again_are_warned_of() {
    let dir = desk();
    let rows = recording(2.0);
    let record = |name: &str, rows: String| {
        dir.write(name, rows);
        dir.lunula(&["record", "--source", name, "--out", &format!("kept-{name}")]).expect(0)
    };
    // One stamp is 60 ms late.
    record("late.csv", rows.replacen("\n1.000,", "\n1.060,", 1)).says("5 rows came behind later ones and are left out");
    let again = rows.lines().skip(1).map(|row| format!("{row}\n")).collect::<String>();
    record("again.csv", rows + &again).says("the clock or counter began again 1 time(s)");
    let milliseconds = (0..50).map(|k| format!("{},1\n", 10 * k)).collect::<String>();
    record("ms.csv", format!("time_s,P1\n{milliseconds}")).says("rows are 10 s apart, if the stamps are in seconds");
    let said = ["record", "--source", "ms.csv", "--time-unit", "ms", "--out", "said.csv"];
    dir.lunula(&said).expect(0).never_says("apart");
}

#[test]
fn other_columns_in_the_middle_end_a_stream_and_the_rows_before_them_are_kept() {
    let dir = desk();
    let rows = |from: u32| (from..from + 20).map(|k| row(0.01 * f64::from(k), 1.0)).collect::<String>();
    let text = format!("time_s,P1,Fz_N\n{}time_s,Fz_N,P1\n{}", rows(0), rows(20));
    dir.write("exchanged.csv", &text);
    let words = "line 22 names the columns time_s,Fz_N,P1, and the rows before it are time_s,P1,Fz_N";
    let record = ["record", "--source", "exchanged.csv", "--out", "kept.csv"];
    dir.lunula(&record).expect(1).says(words);
    assert_eq!(dir.table("kept.csv").len(), 20);
    let mut piped = start(&dir, &["live", "--source", "-", "--model", "m.json"]);
    piped.write(&text);
    let (code, answers, said) = piped.end();
    assert!(code == 1 && answers.len() == 21 && said.contains(words), "{code} {} {said}", answers.len());
    let given = ["live", "--source", "exchanged.csv", "--names", "time_s,Fz_N,P1", "--model", "m.json"];
    dir.lunula(&given)
        .expect(2)
        .says("line 1 names the columns time_s,P1,Fz_N, and --names gives them in another order");
}

#[test]
fn a_stream_without_samples_is_an_alarm_within_a_second() {
    let dir = desk();
    let running = start(&dir, &["record", "--source", "-", "--out", "r.csv"]);
    let begin = Instant::now();
    running.hears("alarm: no sample within a second");
    // A busy machine is given the rest.
    assert!(begin.elapsed() < PATIENCE);
    let (code, ..) = running.end();
    assert!(code == 2 && !dir.path("r.csv").exists());
}

#[test]
fn thresholds_are_chosen_and_judged_on_recordings() {
    let dir = desk();
    for name in ["a.csv", "b.csv", "c.csv"] {
        dir.write(name, recording(120.0));
    }
    let tune = ["switch", "tune", "a.csv", "b.csv", "--model", "m.json", "--contact", "Fz_N<-0.01"];
    let report = dir.lunula(&[&tune[..], &["--false-per-hour", "60", "--out", "s.toml", "--json"]].concat()).expect(0);
    let report = report.json();
    assert_eq!((&report["chosen"]["false_switches"], &report["chosen"]["missed"]), (&0.into(), &0.into()));
    assert!(report["held_out"]["presses"] == 119 + 1 && report["tried"].as_u64().unwrap() > 1000);
    let warnings = report["warnings"].to_string();
    assert!(warnings.contains("a.csv, b.csv: the same to the byte") && !warnings.contains("is missed"), "{warnings}");
    assert!(dir.path("s-curve.png").exists() && dir.path("s-curve.svg").exists());
    let evaluate = ["switch", "evaluate", "s.toml", "c.csv", "--model", "m.json", "--contact", "Fz_N<-0.01"];
    dir.lunula(&[&evaluate[..], &["--out", "ev"]].concat()).expect(0).prints("0 of 60 presses missed");
    let judged = dir.parsed("ev/switch.json");
    assert_eq!(dir.parsed("ev/run.json")["job"], "switch evaluate");
    assert_eq!(
        (&judged["presses"], &judged["missed"], &judged["false_per_hour"]),
        (&60.into(), &0.into(), &0.0.into())
    );
    let high = judged["false_per_hour_high"].as_f64().unwrap();
    // Nothing in two minutes: up to 90 an hour.
    assert!((high - 3600.0 * 2.9957 / 119.99).abs() <= 0.1, "{high}");
    assert!(judged["delay_on_s"]["median"].as_f64().unwrap() <= 0.05);
    assert_eq!(dir.table("ev/presses.csv").len(), 60);
    // Live does what was judged.
    let live = ["live", "--source", "c.csv", "--model", "m.json", "--switch", "s.toml", "--events", "e.jsonl", "-q"];
    dir.lunula(&live).expect(0);
    let presses: Vec<String> = dir.table("ev/presses.csv").iter().map(|row| row["press_s"].clone()).collect();
    let events = dir.json_lines("e.jsonl").into_iter().filter(|event| event["event"] == "press");
    let events: Vec<String> = events.map(|event| event["t"].to_string()).collect();
    assert_eq!(events, presses);
    // Thresholds are of the model whose predictions chose them.
    let model = dir.parsed("m.json")["sha256"].as_str().unwrap().to_owned();
    assert!(dir.text("s.toml").contains(&format!("model_sha256 = \"{model}\"")), "{}", dir.text("s.toml"));
    dir.lunula(&[&evaluate[..], &["--out", "ev3"]].concat()).expect(0).never_says("another model");
    dir.train("a.csv", "Fz_N", "other.json", &["-q"]).expect(0);
    for other in [
        "switch evaluate s.toml c.csv --model other.json --contact Fz_N<-0.01 --out ev4",
        "live --source c.csv --model other.json --switch s.toml",
    ] {
        dir.words(other).expect(0).says("the switch was chosen on predictions of another model");
    }
    // What can't be.
    dir.lunula(&[&tune[..], &["--false-per-hour", "0", "--out", "t.toml"]].concat()).expect(2).says("above 0");
    let nothing = ["switch", "tune", "a.csv", "--model", "m.json", "--contact", "Fz_N<-9", "--out", "t.toml"];
    dir.lunula(&nothing).expect(2).says("no recording has a contact");
    let milliseconds = dir
        .text("a.csv")
        .replacen("time_s", "time", 1)
        .lines()
        .map(|line| {
            let (time, rest) = line.split_once(',').unwrap();
            time.parse().map_or_else(|_| format!("{line}\n"), |time: f64| format!("{},{rest}\n", 1e3 * time))
        })
        .collect::<String>();
    dir.write("ms.csv", milliseconds);
    let slow = ["switch", "tune", "ms.csv", "--model", "m.json", "--contact", "Fz_N<-0.01", "--out", "t.toml"];
    dir.lunula(&slow).expect(2).says("ms.csv: its rows are ").says("time_ms");
    let column = ["switch", "tune", "a.csv", "--model", "m.json", "--contact", "touch", "--out", "t.toml"];
    dir.lunula(&column).expect(2).says("has no column `touch`");
    dir.write("bad.toml", "on_N = 0.2\noff_N = 0.5\nhold = 1\n");
    let bad = ["switch", "evaluate", "bad.toml", "a.csv", "--model", "m.json", "--contact", "Fz_N<-0.1", "--out", "x"];
    dir.lunula(&bad).expect(2).says("bad.toml").says("hold");
    assert!(!dir.path("x").exists() && !dir.path("t.toml").exists());
    // One recording of two that can't be read costs itself.
    let both = ["switch", "evaluate", "s.toml", "c.csv", "lost.csv", "--model", "m.json", "--contact", "Fz_N<-0.01"];
    dir.lunula(&[&both[..], &["--out", "ev2", "-q"]].concat()).expect(1).says("lost.csv");
}

/// A recording, each row as `of` makes it of its time, light and force.
fn altered(seconds: f64, names: &str, of: impl Fn(f64, f64, f64) -> String) -> String {
    let text = recording(seconds);
    let cells = |line: &str| line.split(',').map(|cell| cell.parse().expect("a number")).collect::<Vec<f64>>();
    let rows = text.lines().skip(1).map(cells).map(|cells| of(cells[0], cells[1], cells[2]));
    format!("{names}\n{}", rows.collect::<String>())
}

/// Judges `sw.toml` on a recording of [`desk`] into `ev-<recording>`.
fn judge(dir: &Dir, name: &str, more: &[&str]) -> crate::util::Answer {
    let out = format!("ev-{name}");
    let all = ["switch", "evaluate", "sw.toml", name, "--model", "m.json", "--contact", "Fz_N<-0.01", "--out", &out];
    dir.lunula(&[&all[..], more].concat())
}

#[test]
fn what_makes_the_figures_of_a_switch_doubtful_is_said() {
    let dir = desk();
    let write = |name: &str, of: &dyn Fn(f64, f64, f64) -> String| {
        dir.write(name, altered(20.0, "time_s,P1,Fz_N", of));
    };
    dir.write("good.csv", recording(20.0));
    dir.write("copy.csv", recording(20.0));
    judge(&dir, "good.csv", &[]).expect(0).never_says("warning").never_says("not known");
    judge(&dir, "good.csv", &["copy.csv"]).expect(0).says("good.csv, copy.csv: the same to the byte");
    judge(&dir, "train.csv", &[]).expect(0).says("train.csv: the model was trained on this");
    judge(&dir, "good.csv", &["--ambient", "interpolated", "--stream", "x"])
        .expect(0)
        .says("--ambient is of no use here: no recording says when its LED was on")
        .says("--stream is of no use here");
    write("beyond.csv", &|t_s, light, force| format!("{t_s},{},{force}\n", light + 5.0));
    judge(&dir, "beyond.csv", &[]).expect(0).says("beyond.csv: 2000 of 2000 rows lie outside of the voltages");
    write("surface.csv", &|t_s, light, force| format!("{t_s},{light},{}\n", -1000.0 * force));
    judge(&dir, "surface.csv", &[]).expect(0).says("are the forces in newtons").says("as if the finger pulled");
    // A contact that never is, one that is late by a second, and one that is upside down.
    let contact = |contact: &str, out: &str| {
        let all =
            ["switch", "evaluate", "sw.toml", "good.csv", "--model", "m.json", "--contact", contact, "--out", out];
        dir.lunula(&all).expect(0)
    };
    contact("Fz_N>0.05", "never").says("no recording has a contact whose beginning and end are known; record presses");
    contact("Fz_N>-0.01", "upside-down").says("presses begin when their contact is over: is contact the right way");
    write("late.csv", &|t_s, light, _| format!("{t_s},{light},{}\n", -pressing(t_s - 1.0)));
    judge(&dir, "late.csv", &[]).expect(0).says("9 of 9 contacts are missed and 10 of 10 presses are false");
    judge(&dir, "good.csv", &["late.csv"]).expect(0).says("late.csv: 9 of 9 contacts are missed");
    // On a clock that is less ahead, and contact switches that stick and that break after 10 s.
    write("ahead.csv", &|t_s, light, _| format!("{t_s},{light},{}\n", -pressing(t_s + 0.4)));
    judge(&dir, "ahead.csv", &[])
        .expect(0)
        .says("ahead.csv: what the model says comes 0.4")
        .says("s after contact, and a");
    for (name, force_n, words) in [
        ("sticks.csv", -1.0, "sticks.csv: contact lasts from 10.0 to 30.0 s, "),
        ("breaks.csv", 0.0, "breaks.csv: there is no contact from 9.4 to 30.0 s, and the finger presses 10 times"),
    ] {
        let of =
            |t_s: f64, light: f64, force: f64| format!("{t_s},{light},{}\n", if t_s < 10.0 { force } else { force_n });
        dir.write(name, altered(30.0, "time_s,P1,Fz_N", of));
        judge(&dir, name, &[]).expect(0).says(words);
    }
    // A threshold of contact within the force's noise, and a device that says for a while that nothing is touched.
    write("noise.csv", &|t_s, light, force| {
        let k = (100.0 * t_s).round() as u64;
        format!("{t_s},{light},{}\n", if k * k * 31 % 17 < 1 { force - 0.2 } else { force })
    });
    judge(&dir, "noise.csv", &[]).expect(0).says("contacts last a row or two, which no finger does");
    dir.write(
        "middle.csv",
        altered(60.0, "time_s,P1,Fz_N", |t_s, light, force| {
            format!("{t_s},{light},{}\n", if (20.0..40.0).contains(&t_s) { 0.0 } else { force })
        }),
    );
    judge(&dir, "middle.csv", &[])
        .expect(0)
        .says("middle.csv: there is no contact from ")
        .says("and the finger presses");
    // Something knocks at the nail for four seconds of two minutes.
    dir.write(
        "knocked.csv",
        altered(120.0, "time_s,P1,Fz_N", |t_s, light, force| match t_s {
            40.0..44.0 => format!("{t_s},{},0\n", 1.0 + 0.5 * f64::from(u8::from((2.0 * t_s).fract() < 0.5))),
            _ => format!("{t_s},{light},{force}\n"),
        }),
    );
    judge(&dir, "knocked.csv", &[])
        .expect(0)
        .says("knocked.csv: 8 of 8 false switches come from 40.0 to 43.5 s, more than by chance");
    let knocked = dir.parsed("ev-knocked.csv/switch.json");
    let [dispersion, low] = ["dispersion", "false_per_hour_low"].map(|key| knocked[key].as_f64().unwrap());
    // One event, not eight: 0.025 of it.
    assert!((dispersion - 8.0).abs() <= 1e-9 && low < 0.03 * 240.0, "{dispersion} {low}");
    // Rows that the model can't answer.
    dir.write("lit.csv", altered(20.0, "time_s,led,P1,Fz_N", |t_s, light, force| format!("{t_s},1,{light},{force}\n")));
    judge(&dir, "lit.csv", &[]).expect(2).says("lit.csv: none of its 2000 rows has a prediction");
    let light = |t_s: f64, light: f64| if t_s < 5.0 { light.to_string() } else { String::new() };
    write("half.csv", &|t_s, seen, force| format!("{t_s},{},{force}\n", light(t_s, seen)));
    judge(&dir, "half.csv", &[]).expect(0).says("half.csv: 1500 of 2000 rows have no prediction");
    // Two of ten presses are in 4 s of which nothing is known; known in every other row is never known.
    let where_known = |t_s: f64, light: f64, force: f64, known: bool| {
        if known { format!("{t_s},{light},{force}\n") } else { format!("{t_s},{light},\n") }
    };
    write("part.csv", &|t_s, light, force| where_known(t_s, light, force, !(8.0..12.0).contains(&t_s)));
    judge(&dir, "part.csv", &[])
        .expect(0)
        .says("contact is not known for 4.0 s")
        .says("presses that begin there, 2, are");
    let part = dir.parsed("ev-part.csv/switch.json");
    let counts = ["presses", "missed", "false_switches", "not_judged"].map(|count| part[count].as_u64().unwrap());
    assert_eq!((counts, dir.table("ev-part.csv/presses.csv").len()), ([8, 0, 0, 2], 8));
    // Single cells that are empty cost nothing, but for contacts that begin or end there.
    write("cells.csv", &|t_s, light, force| where_known(t_s, light, force, (100.0 * t_s).round() % 200.0 != 120.0));
    judge(&dir, "cells.csv", &[]).expect(0).never_says("contact is not known");
    let cells = dir.parsed("ev-cells.csv/switch.json");
    assert_eq!(["presses", "missed", "cut_off"].map(|count| cells[count].as_u64().unwrap()), [10, 0, 0]);
    // A contact switch that is logged ten times a second.
    dir.write(
        "held.csv",
        altered(60.0, "time_s,P1,contact", |t_s, light, _| {
            let at_s = (10.0 * t_s + 1e-6).floor() / 10.0;
            format!("{t_s},{light},{}\n", u8::from(pressing(at_s + 0.037 * (at_s / 2.0).floor()) > 0.01))
        }),
    );
    dir.words("switch evaluate sw.toml held.csv --model m.json --contact contact --out ev-held")
        .expect(0)
        .says("contact changes in each 10th row only, 0.10 s");
    write("odd.csv", &|t_s, light, force| where_known(t_s, light, force, (100.0 * t_s).round() % 2.0 == 0.0));
    judge(&dir, "odd.csv", &[]).expect(2).says("1000 of 2000 rows say whether the finger touches (`Fz_N<-0.01`)");
    write("none.csv", &|t_s, light, force| where_known(t_s, light, force, false));
    judge(&dir, "none.csv", &[]).expect(2).says("no row says whether the finger touches");
}

#[test]
fn a_sensor_that_repeats_its_last_sample_is_said_by_switch_and_live() {
    let dir = desk();
    let two = |t_s: f64, light: f64, force: f64| format!("{t_s},{light},{},{force}\n", 1.0 + 0.1 * (7.0 * t_s).sin());
    let names = "time_s,P1,P2,Fz_N";
    dir.write("good.csv", altered(20.0, names, two));
    dir.train("good.csv", "Fz_N", "two.json", &["-q"]).expect(0);
    let stopped = std::cell::RefCell::new(String::new());
    dir.write(
        "stopped.csv",
        altered(20.0, names, |t_s, light, force| {
            let row = two(t_s, light, force);
            let mut last = stopped.borrow_mut();
            if !(5.0..12.0).contains(&t_s) {
                *last = row.split(',').skip(1).take(2).collect::<Vec<_>>().join(",");
            }
            format!("{t_s},{last},{force}\n")
        }),
    );
    let live = |name: &str| dir.words(&format!("live --source {name} --model two.json --switch sw.toml")).expect(0);
    let judged = |name: &str| {
        let options = "--model two.json --contact Fz_N<-0.01";
        dir.words(&format!("switch evaluate sw.toml {name} {options} --out ev-{name}")).expect(0)
    };
    for said in [live("good.csv"), judged("good.csv")] {
        said.never_says("keep(s) all values");
    }
    let dead = |t_s: f64, light: f64, force: f64| format!("{t_s},{light},0.4,{force}\n");
    dir.write("dead.csv", altered(20.0, names, dead));
    for said in [live("dead.csv"), judged("dead.csv")] {
        said.says("P2 keep(s) all values in 1 stretch(es), the longest 2000 samples");
    }
    dir.write("empty.csv", altered(20.0, names, |t_s, light, force| format!("{t_s},{light},,{force}\n")));
    dir.words("live --source empty.csv --model two.json").expect(1).says("no row is answered: each lacks a photodiode");
    for said in
        [live("stopped.csv").says("all photodiodes that a model reads stand(s) still at 5.99"), judged("stopped.csv")]
    {
        said.says("keep(s) all values in 1 stretch(es), the longest 701 samples from 4.990");
    }
}

#[test]
fn of_a_log_whose_clock_was_set_back_a_switch_is_judged_on_a_piece() {
    let dir = desk();
    let twice = |name: &str, text: String| {
        let rows = text.split_once('\n').unwrap().1;
        dir.write(name, format!("{text}{rows}"));
    };
    twice("table.csv", recording(20.0));
    judge(&dir, "table.csv", &[]).expect(0).says("its clock or counter goes back 1 time(s)");
    let lit = |t_s: f64, light: f64, force: f64| format!("{t_s},1,{light},{force}\n{},0,0,{force}\n", t_s + 0.005);
    twice("log.csv", altered(20.0, "time_s,led,P1,Fz_N", lit));
    judge(&dir, "log.csv", &[]).expect(2).says("log.csv:4002: time falls back from").says("--piece");
    judge(&dir, "log.csv", &["--piece", "3"]).expect(2).says("there is no --piece 3");
    for name in ["table.csv", "log.csv"] {
        judge(&dir, name, &["--piece", "2"]).expect(0).says("piece 2 of 2 is taken");
        let presses = dir.table(&format!("ev-{name}/presses.csv"));
        assert!(presses.len() == 10 && crate::util::number(&presses[0], "press_s") < 1.1, "{presses:?}");
    }
    judge(&dir, "log.csv", &["--piece", "1", "--ambient", "interpolated"])
        .expect(0)
        .says("--ambient is of no use here");
}

#[test]
fn a_goal_that_is_missed_on_recordings_held_out_is_said() {
    let dir = desk();
    dir.write("calm.csv", recording(120.0));
    // Every 2 s something lights up the nail without a touch, which no threshold from calm rows keeps out.
    let bump = |t_s: f64| if (0.3..0.4).contains(&(t_s % 2.0)) { 0.25 } else { 0.0 };
    let restless = |t_s: f64, light: f64, force: f64| format!("{t_s},{},{force}\n", light + bump(t_s));
    dir.write("restless.csv", altered(120.0, "time_s,P1,Fz_N", restless));
    let tune = ["switch", "tune", "calm.csv", "restless.csv", "--model", "m.json", "--contact", "Fz_N<-0.01"];
    let said = dir.lunula(&[&tune[..], &["--false-per-hour", "60", "--out", "s.toml"]].concat()).expect(0);
    said.says("the goal is missed on recordings that are held out: ").never_says("more recordings would show it");
}

#[test]
fn the_switches_of_every_model_and_rate_are_on_one_curve() {
    let dir = desk();
    for (folder, names) in [("train", &["1.csv"][..]), ("test", &["1.csv", "2.csv", "3.csv"])] {
        for name in names {
            let text = recording(120.0);
            let lines: Vec<&str> = text.lines().collect();
            let mut rows = format!("{},contact\n", lines[0]);
            // The finger touches 30 ms before its nail shows it.
            for pair in lines[1..].windows(4) {
                let force: f64 = pair[3].rsplit(',').next().unwrap().parse().unwrap();
                let _ = writeln!(rows, "{},{}", pair[0], u8::from(force < 0.0));
            }
            dir.write(&format!("{folder}/{name}"), rows);
        }
    }
    let all = ["tradeoff", "switch", "--input", "train", "--truth", "test", "--repeats", "1"];
    let said = dir.lunula(&[&all[..], &["--out", "t", "--json"]].concat()).expect(0).json();
    let choices = said["curves"].as_array().map_or(0, Vec::len);
    let rows = dir.table("t/tradeoff.csv");
    let of = |choice: &str| rows.iter().filter(|row| row["choice"] == choice).collect::<Vec<_>>();
    assert!(choices >= 2 && of("model").len() >= 6 && !of("--false-per-hour").is_empty(), "{said}");
    for row in rows {
        let (error, time) = (row["error"].parse::<f64>().unwrap(), row["run_s"].parse::<f64>().unwrap());
        // A press of this finger lasts a second.
        assert!(error >= 0.0 && (row["choice"] != "model" || row["error_unit"].contains("false") || error < 0.3));
        assert!(time > 0.0);
    }
    dir.write("few/1.csv", recording(10.0));
    let few = ["tradeoff", "switch", "--input", "train", "--truth", "few", "--out", "u"];
    dir.lunula(&few).expect(2).says("one recording can't choose thresholds and judge them");
}

#[test]
fn a_page_shows_the_session_to_whoever_has_the_address() {
    let dir = desk();
    let mut running = start(&dir, &["live", "--source", "-", "--model", "m.json", "--switch", "sw.toml", "--serve"]);
    let url = running.hears("page: http://");
    let (at, token) = url.trim_start_matches("page: http://").split_once("/#").expect("an address");
    let asks = |authorization: &str| {
        let mut to = TcpStream::connect(at).unwrap();
        to.set_read_timeout(Some(PATIENCE)).unwrap();
        write!(to, "GET /api/live HTTP/1.1\r\nHost: {at}\r\n{authorization}\r\n").unwrap();
        BufReader::new(to)
    };
    running.write(&recording(3.0));
    let mut refused = String::new();
    asks("").read_line(&mut refused).unwrap();
    assert!(refused.contains("403"), "{refused}");
    let mut pictures = asks(&format!("Authorization: Bearer {token}\r\n")).lines().map_while(Result::ok);
    let picture = pictures.find_map(|line| {
        let picture: serde_json::Value = serde_json::from_str(line.strip_prefix("data: ")?).ok()?;
        (picture["fingers"][0]["time_s"].as_f64()? > 2.8).then_some(picture)
    });
    let finger = &picture.expect("a picture")["fingers"][0];
    assert!(finger["photodiodes"][0] == "P1" && finger["answers"][0] == "Fz_N" && finger["has_switch"] == true);
    let low = finger["low"][0].as_array().unwrap();
    assert!(low.len() >= 55 && low.iter().all(|volts| volts.as_f64().is_some_and(|volts| volts > 0.9)), "{low:?}");
    // Whoever does not read holds nobody up, and the page ends with the session.
    let _asleep = asks(&format!("Authorization: Bearer {token}\r\n"));
    let (code, rows, _) = running.end();
    assert!(code == 0 && rows.len() == 301, "{code} {}", rows.len());
    dir.lunula(&["live", "--source", "-", "--model", "m.json", "--port", "80"]).expect(2).says("--serve");
}

#[test]
fn a_press_harder_clicks_and_every_move_is_a_line() {
    let dir = Dir::new();
    // Each force has a photodiode of its own.
    let mut train = "time_s,P1,P2,P3,Fx_N,Fy_N,Fz_N\n".to_owned();
    for k in 0..300 {
        let [x, y, z] = [11, 7, 5].map(|n| f64::from(k * n % 41) / 10.0 - 2.0);
        let _ = writeln!(train, "{},{},{},{},{x},{y},{z}", 0.01 * f64::from(k), 5.0 + x, 5.0 + y, 5.0 + z);
    }
    dir.write("train.csv", train);
    dir.train("train.csv", "force", "f.json", &["-q"]).expect(0);
    // Lifted, then a light touch with shear to the right, a hard press, light again, lifted.
    let mut text = "time_s,P1,P2,P3\n".to_owned();
    for k in 0..600 {
        let pressing = match k {
            0..100 | 500.. => 0.0,
            300..340 => 2.0,
            _ => 0.8,
        };
        let shear = if (150..280).contains(&k) { 0.4 } else { 0.0 };
        let _ = writeln!(text, "{},{},5,{}", 0.01 * f64::from(k), 5.0 + shear, 5.0 - pressing);
    }
    dir.write("r.csv", text);
    let mouse = |more: &[&str]| {
        let all = ["mouse", "--source", "r.csv", "--model", "f.json", "--events", "e.jsonl"];
        dir.lunula(&[&all[..], more].concat())
    };
    let report = mouse(&["--json"]).expect(0).json();
    assert_eq!((&report["pointer"]["clicks"], &report["pointer"]["y_counts"]), (&1.into(), &0.into()), "{report}");
    let moved = report["pointer"]["x_counts"].as_i64().unwrap();
    let events = dir.json_lines("e.jsonl");
    let sum: i64 = events.iter().filter(|one| one["event"] == "move").map(|one| one["dx"].as_i64().unwrap()).sum();
    assert!(moved > 50 && sum == moved, "{moved}, {sum}");
    let buttons: Vec<bool> =
        events.iter().filter(|one| one["event"] == "button").map(|one| one["down"].as_bool().unwrap()).collect();
    assert_eq!(buttons, [true, false]);
    // A cable that is loose for a row clicks nothing, however hard the force that it makes.
    let loose = |(k, line): (usize, &str)| match line.rsplit_once(',') {
        Some((row, _)) if k % 40 == 7 => format!("{row},0\n"),
        _ => format!("{line}\n"),
    };
    dir.write("loose.csv", dir.text("r.csv").lines().enumerate().map(loose).collect::<String>());
    let loose = ["mouse", "--source", "loose.csv", "--model", "f.json", "--events", "l.jsonl", "--json"];
    let report = dir.lunula(&loose).expect(0).json();
    assert_eq!(report["pointer"]["clicks"], 1, "{report}");
    // What a person did can't be done again.
    let fast = dir.text("e.jsonl");
    mouse(&[]).expect(2).says("e.jsonl: exists already").says("--replace");
    assert_eq!(dir.text("e.jsonl"), fast);
    dir.write("e.jsonl", "older\n");
    mouse(&["--replace", "-q"]).expect(0);
    assert_eq!(dir.text("e.jsonl"), fast);
    dir.lunula(&["live", "--source", "r.csv", "--model", "f.json", "--replace"]).expect(2).says("--replace is for");
    // The same at any speed.
    dir.write("scroll.toml", "scroll = true\n");
    mouse(&["--config", "scroll.toml", "--replace"]).expect(2).says("scroll = true needs J2_deg; name a model");
    let slow = ["mouse", "--source", "r.csv?rate=20", "--model", "f.json", "--events", "s.jsonl", "-q"];
    dir.lunula(&slow).expect(0);
    assert_eq!(dir.text("s.jsonl"), fast);
    dir.write("m.toml", "dead_zone_n = 0.1\nclick_m = 3\n");
    mouse(&["--config", "m.toml"]).expect(2).says("m.toml").says("click_m");
    dir.write("m.toml", "watchdog_s = 0.005\n");
    mouse(&["--config", "m.toml", "--replace"])
        .expect(0)
        .says("watchdog_s = 0.005 lets go of everything between two answers, which are 0.010 s apart");
    dir.train("train.csv", "Fz_N", "z.json", &["-q"]).expect(0);
    let one = ["mouse", "--source", "r.csv", "--model", "z.json", "--events", "z.jsonl"];
    dir.lunula(&one).expect(2).says("the mouse needs Fx_N");
}
