use std::fs;
use std::io::Write;
use std::num::NonZeroUsize;

use proptest::prelude::*;

use super::*;
use crate::table::{Column, TableWriter, Value};

/// Reads a file of these bytes.
fn read_as(name: &str, bytes: &[u8], columns: &Columns) -> Result<Log, LogError> {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join(name);
    fs::write(&path, bytes).unwrap();
    Log::read(&path, columns)
}

fn read(text: &str) -> Result<Log, LogError> {
    read_as("log.csv", text.as_bytes(), &Columns::default())
}

fn good(text: &str) -> Log {
    read(text).unwrap_or_else(|why| panic!("{why}"))
}

/// The words of the error.
fn error_of(text: &str) -> String {
    read(text).map(|log| panic!("{log:?}")).unwrap_err().to_string()
}

fn timed(text: &str, unit: TimeUnit) -> Columns {
    let mut columns = Columns::parse(text).unwrap();
    columns.time_unit = Some(unit);
    columns
}

/// Whether some note has all these words.
fn noted(log: &Log, words: &[&str]) -> bool {
    log.notes.iter().any(|note| words.iter().all(|word| note.contains(word)))
}

#[test]
fn the_contracts_columns_are_read() {
    let log = good("time_s,led,P1,P2,Fz_N\n0,1,1.5,2.5,-0.5\n0.04,0,0.5,,-0.6\n");
    assert_eq!((log.time_s, log.led, log.midnight_s), (vec![0.0, 0.04], Some(vec![true, false]), None));
    let names = |channels: &[Channel]| channels.iter().map(|c| c.name.clone()).collect::<Vec<_>>();
    assert_eq!((names(&log.photodiodes), names(&log.forces)), (vec!["P1".into(), "P2".into()], vec!["Fz_N".into()]));
    assert_eq!((&log.photodiodes[0].values[..], &log.forces[0].values[..]), (&[1.5, 0.5][..], &[-0.5, -0.6][..]));
    assert!(log.photodiodes[1].values[0] == 2.5 && log.photodiodes[1].values[1].is_nan());
    assert_eq!(log.notes, ["P2 has no value in 1 of 2 rows"]);
}

#[test]
fn dialects_read_alike() {
    let plain = good("time_s,P1,Fz_N\n0,1.5,-1\n0.5,2.5,-2\n");
    assert!(plain.notes.is_empty());
    let same = |name: &str, bytes: &[u8], words: &[&[&str]]| {
        let log = read_as(name, bytes, &Columns::default()).unwrap_or_else(|why| panic!("{why}"));
        assert_eq!(
            (&log.time_s, &log.photodiodes, &log.forces),
            (&plain.time_s, &plain.photodiodes, &plain.forces),
            "{name}"
        );
        assert!(words.iter().all(|words| noted(&log, words)) && log.notes.len() == words.len(), "{:?}", log.notes);
    };
    same("bom.csv", b"\xef\xbb\xbftime_s,P1,Fz_N\r\n0,1.5,-1\r\n\r\n0.5,2.5,-2\r\n\r\n", &[]);
    same("spaces.csv", b" time_s , \"P1\", \"Fz_N\"\n 0 ,\"1.5\", \" -1 \"\n0.5,2.5,-2", &[]);
    same("german.txt", b"time_s;P1;Fz_N\n0;1,5;-1\n0,5;2,5;-2\n", &[&["`;`"], &["decimal commas"]]);
    same("tabs.tsv", b"time_s\tP1\tFz_N\n0\t1,5\t-1\n0,5\t2,5\t-2\n", &[&["tabs"], &["decimal commas"]]);
    same("comments.csv", b"# logger 3, \"A\n#\n\ntime_s,P1,Fz_N\n0,1.5,-1\n# pause\n0.5,2.5,-2\n", &[]);
    same("numpy.csv", b"# made by numpy\n# time_s,P1,Fz_N\n0.0,1.5,-1e0\n0.5,2.5,-2e0\n", &[&["names", "comment"]]);
    same("excel.csv", b"sep=;\r\ntime_s;P1;Fz_N\r\n0;1.5;-1\r\n0.5;2.5;-2\r\n", &[&["`;`"]]);
    same("trailing.csv", b"time_s,P1,Fz_N\n0,1.5,-1,\n0.5,2.5,-2,,\n", &[]);
    same("nameless.csv", b"time_s,P1,Fz_N,\n0,1.5,-1\n0.5,2.5,-2\n", &[]);
    let again = b"time_s,P1,Fz_N\n0,1.5,-1\n\"time_s\", P1,Fz_N\n0.5,2.5,-2\ntime_s,P1,Fz_N\n";
    same("joined.csv", again, &[&["line 3 and 1 more repeats the names"]]);
    same("cut.csv", b"time_s,P1,Fz_N\n0,1.5,-1\n0.5,2.5,-2\n1.0,3.", &[&["line 4", "cut off"]]);
    let above = "LabVIEW Measurement\t\nWriter_Version\t2\nDate\t2026/11/20\n***End_of_Header***\t\n\t\n\
                 Samples\t2\t2\nX0\t0.0E+0\t0.0E+0\nDelta_X\t0.5\t0.5\n***End_of_Header***\t\t\n";
    let labview = format!("{above}X_Value\tP1\tFz_N\tComment\n0.0\t1.5\t-1.0\tgo\n0.5\t2.5\t-2.0\n");
    for comment in ["go", ""] {
        let labview = labview.replace("go", comment);
        same("log.lvm", labview.as_bytes(), &[&["tabs"], &["line 10", "above"], &["`X_Value`"]]);
    }
    let labchart = "Interval=\t0.5 s\nTimeFormat=\tStartOfBlock\nChannelTitle=\tP1\tFz_N\nRange=\t10 V\t20 N\n";
    let rows = "0\t1.5\t-1\n0.5\t2.5\t-2\n";
    let notes: [&[&str]; 3] = [&["tabs"], &["line 3"], &["`Time`"]];
    same("chart.txt", format!("{labchart}{rows}").as_bytes(), &notes);
    let commented = rows.replace("-1", "-1\t#* pressed");
    same("commented.txt", format!("{labchart}{commented}").as_bytes(), &notes);
    same("behind.csv", b"time_s,P1,Fz_N\n0,1.5,-1\n0.5,2.5,-2,#* pressed, then let go\n", &[]);
    same("said.csv", b"time_s,P1,Fz_N,Comment\n0,1.5,-1\n0.5,2.5,-2,go\n1.0,3.5,-", &[&["line 4", "cut off"]]);
    let scope = b"Logger 7\nRate: 2 Hz\n\nTime,P1,Fz_N\n(ms),(V),(N)\n\n0,1.5,-1\n500,2.5,-2\n";
    let notes: [&[&str]; 4] = [&["line 4"], &["units", "line 5"], &["`Time (ms)`"], &["`P1 (V)`"]];
    same("scope.csv", scope, &notes);
    same("units.csv", b"time_s,P1,Fz_N\ns,V,N\n0,1.5,-1\n0.5,2.5,-2\n", &[&["units", "line 2"], &["`P1 (V)`"]]);
    same("some.csv", b"time_s,P1,Fz_N\n(s),,(N)\n0,1.5,-1\n0.5,2.5,-2\n", &[&["units", "line 2"]]);
    let mapped = Columns::parse("time_s=stamp,P1=ch").unwrap();
    let log = read_as("late.csv", b"stamp,ch,x\nNA,0,0\n0,1.5,1\n0.5,2.5,2\n1,3,4\n", &mapped).unwrap();
    assert_eq!(log.photodiodes[0].values, [1.5, 2.5, 3.0]);
    same("named.csv", b"who,time_s,P1,Fz_N\nA,0,1.5,-1\nA,0.5,2.5,-2\n", &[]);
    let utf16 = |text: &str| {
        [0xff, 0xfe].into_iter().chain(text.encode_utf16().flat_map(u16::to_le_bytes)).collect::<Vec<u8>>()
    };
    same("utf16.txt", &utf16("time_s\tP1\tFz_N\r\n0\t1.5\t-1\r\n0.5\t2.5\t-2\r\n"), &[&["tabs"]]);
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    packed.write_all(b"time_s,P1,Fz_N\n0,1.5,-1\n0.5,2.5,-2\n").unwrap();
    let packed = packed.finish().unwrap();
    same("log.csv.gz", &packed, &[]);
    let error = read_as("log.csv.gz", &packed[..packed.len() / 2], &Columns::default()).unwrap_err().to_string();
    assert!(error.contains("log.csv.gz: can't be unpacked"), "{error}");
}

#[test]
fn parquet_reads_as_text_does() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("log.parquet");
    let columns = vec![
        Column::text("stamp"),
        Column::integer("led"),
        Column::number("P1"),
        Column::integer("P2"),
        Column::text("x"),
    ];
    let mut table = TableWriter::create(&path, &path, columns, &[]).unwrap();
    for k in 0..3 {
        let stamp = format!("2021-10-21 00:00:0{k}.25Z");
        let row = [Value::Text(&stamp), Value::Integer(k % 2), Value::Number(0.5), Value::Integer(k), Value::Text("a")];
        table.write(&row).unwrap();
    }
    table.finish().unwrap();
    let log = Log::read(&path, &Columns::parse("time_s=stamp").unwrap()).unwrap();
    assert_eq!((log.time_s[2] - log.time_s[0], log.time_s[0] - log.midnight_s.unwrap()), (2.0, 0.25));
    assert_eq!((log.led.unwrap(), &log.photodiodes[1].values[..]), (vec![false, true, false], &[0.0, 1.0, 2.0][..]));
    let error = Log::read(&path, &Columns::parse("time_s=stamp,P1=x").unwrap()).unwrap_err().to_string();
    assert!(error.contains("log.parquet: row 1, column `x`: `a` is no"), "{error}");
    let error = Log::read(&path, &Columns::parse("time_s=P2,led=P1,P1=x").unwrap()).unwrap_err().to_string();
    assert!(error.contains("log.parquet: row 1, column `P1`: `0.5` is neither"), "{error}");
}

#[test]
fn a_wrong_cell_is_named_with_file_line_and_column() {
    for (text, words) in [
        ("time_s,P1\n0,1\n\n# x\n0.1,1.2V\n", "log.csv:5: column `P1`: `1.2V` is no number"),
        ("time_s,P1\n0,1\n0.1,inf\n", "log.csv:3: column `P1`: `inf` is no finite number"),
        ("time_s,P1\n0,1\nsoon,1\n", "log.csv:3: column `time_s`: `soon` is no number"),
        ("# a\n\ntime_s,led,P1\n0,2,1\n", "log.csv:4: column `led`: `2` is neither 1 (on) nor 0 (off)"),
        ("time_s,note,P1\n0,\"two\nlines\",1\n1,,x\n", "log.csv:4: column `P1`"),
        (
            "time_s,P1\n0,1\n0.1,1,2\n",
            "log.csv:3: has 3 cells and the header 2; correct it; if numbers have decimal commas",
        ),
        ("time_s,P1,P2\n0,1\n0.1,1,2\n", "log.csv:2: has 2 cells and the header 3"),
        ("time_s,P1,P2\n0,1\n0.1,1,2\n0.2,1,2\n0.3,1,2\n", "log.csv:2: has 2 cells and the header 3"),
        ("time_s,P1\nOVERLOAD,---\n0.1,1\n0.2,1\n0.3,1\n", "log.csv:2: column `time_s`: `OVERLOAD` is no "),
        ("time_s;P1\n0;1,5\n0,1;1.5\n", "log.csv:3: column `P1`: `1.5`: numbers have decimal points here"),
    ] {
        let error = error_of(text);
        assert!(error.contains(words), "{error}");
    }
}

#[test]
fn files_that_are_no_logs_are_told() {
    for (name, bytes, words) in [
        ("log.csv", &b""[..], "is empty"),
        ("log.csv", b"\n# only this\n", "has no line of names"),
        ("log.csv", b"0,1\n1,2\n", "line 1 holds numbers where the columns' names should be"),
        ("log.csv", b"Logger 7\nRate,2\n0,1\n1,2\n2,3\n3,4\n", "no time column found; its columns are Rate, 2"),
        ("log.csv", b"Logger 7\nSecond line\n0,1\n1,2\n2,3\n3,4\n", "above its rows, which begin in line 3"),
        ("log.csv", b"time_s,P1\n", "has no rows"),
        ("log.csv", b"time_s,P1\n,1\nnan,2\n", "has no rows"),
        ("log.csv", b"time_s,P1\n0,\xff\n", "log.csv:2: column `P1`"),
        ("log.csv", b"\0\0\0\0", "is no text"),
        ("log.xlsx", b"PK\x03\x04abc", "spreadsheet"),
        ("log.mat", b"MATLAB 5.0 MAT-file, Platform: GLNXA64", "writetable"),
        ("log.tdms", b"TDSm\x0e\0\0\0", "LabVIEW"),
        ("log.h5", b"\x89HDF\r\n\x1a\n", "HDF5"),
        ("log.csv", b"PAR1abc", ".parquet"),
        ("log.parquet", b"PAR1abc", "not a whole Parquet file"),
    ] {
        let error = read_as(name, bytes, &Columns::default()).unwrap_err().to_string();
        assert!(error.contains(words) && error.contains(name), "{error}");
    }
    assert!(
        Log::read(Path::new("nothing.csv"), &Columns::default())
            .unwrap_err()
            .to_string()
            .contains("nothing.csv: is not there")
    );
    #[cfg(not(feature = "xdf"))]
    {
        let error = Log::read(Path::new("nothing.xdf"), &Columns::default()).unwrap_err().to_string();
        assert!(error.contains("--features xdf"), "{error}");
    }
}

#[test]
fn rows_without_time_or_led_are_left_out_and_words_for_missing_are_missing() {
    let log = good("time_s,led,P1\n0,1,NaN\n,1,5\n0.2,,6\nn/a,0,7\n0.3,0,NULL\n0.4,1,9\n");
    assert_eq!((&log.time_s[..], log.led.as_deref()), (&[0.0, 0.3, 0.4][..], Some(&[true, false, true][..])));
    assert!(log.photodiodes[0].values[0].is_nan() && log.photodiodes[0].values[2] == 9.0);
    assert!(noted(&log, &["2 of 6 rows have no time"]) && noted(&log, &["1 of 6 rows do not say"]), "{:?}", log.notes);
    assert!(noted(&log, &["P1 has no value in 2 of 3 rows"]), "{:?}", log.notes);
    let lit = samples(&good("time_s,P1,P2\n0,,1\n"), &AmbientOptions::default()).unwrap();
    assert!(lit.warnings.iter().any(|warning| warning == "P1 has no value at all"), "{:?}", lit.warnings);
}

#[test]
fn one_row_is_a_log() {
    let log = good("time_s,P1\n5.5,1\n");
    assert_eq!((log.time_s, log.notes), (vec![5.5], Vec::<String>::new()));
}

#[test]
fn guesses_and_units_are_told() {
    let log = good("Timestamp (ms),PD1\n0,1\n40,2\n");
    assert_eq!(log.time_s, [0.0, 0.04]);
    assert!(noted(&log, &["`Timestamp (ms)`", "time_s"]) && noted(&log, &["`PD1`", "P1"]), "{:?}", log.notes);
    let columns = timed("time_s=t,P1=v", TimeUnit::Microseconds);
    let log = read_as("log.csv", b"t,v\n0,1\n40000,2\n", &columns).unwrap();
    assert_eq!((log.time_s, log.notes.len()), (vec![0.0, 0.04], 0));
    let slow = |text: &str| {
        let lit = samples(&good(text), &AmbientOptions::default()).unwrap();
        lit.warnings.iter().any(|one| one.contains("40 s apart") && one.contains("--time-unit"))
    };
    assert!(slow("time_s,P1\n0,1\n40,2\n80,3\n"));
    assert!(!slow("time,P1\n10:00:00,1\n10:00:40,2\n10:01:20,3\n"), "times of day have their unit");
}

#[test]
fn dates_have_a_midnight() {
    let log = good("time_s,P1\n2021-10-21 23:59:59.5+02:00,1\n2021-10-22 00:00:00.5+02:00,2\n");
    assert_eq!(log.time_s[1] - log.time_s[0], 1.0);
    assert_eq!(log.time_s[0] - log.midnight_s.unwrap(), 86_399.5);
    // A row out of place does not move it behind the first stamp.
    let log = good("time_s,P1\n00:00:00.02,1\n00:00:00.00,1\n00:00:00.04,1\n00:00:00.06,1\n");
    assert_eq!((log.time_s[0], log.midnight_s), (0.0, Some(0.0)));
    let log = good("time_s,P1\n23:59:59,1\n0:00:00,2\n");
    assert_eq!((log.time_s[1], log.midnight_s), (86_400.0, Some(0.0)));
}

/// A log of these times; `P1` counts the rows as they stand.
fn of_times(times_s: impl IntoIterator<Item = f64>) -> String {
    let rows = times_s.into_iter().enumerate().map(|(k, t)| format!("{t},{k}\n"));
    "time_s,P1\n".chars().chain(rows.collect::<String>().chars()).collect()
}

#[test]
fn rows_that_were_swapped_are_sorted() {
    let log = good(&of_times([0.0, 0.1, 0.3, 0.2, 0.4, 0.5]));
    assert_eq!(log.time_s, [0.0, 0.1, 0.2, 0.3, 0.4, 0.5]);
    assert_eq!(log.photodiodes[0].values, [0.0, 1.0, 3.0, 2.0, 4.0, 5.0]);
    assert!(noted(&log, &["1 row(s) stood behind later ones, by up to 0.1 s", "line 5"]), "{:?}", log.notes);
    // A packet of eight rows that came late.
    let mut times: Vec<f64> = (0..100).map(|k| f64::from(k) * 0.01).collect();
    times[40..56].rotate_left(8);
    let log = good(&of_times(times));
    assert!(log.time_s.is_sorted() && noted(&log, &["8 row(s)"]) && log.notes.len() == 1, "{:?}", log.notes);
}

#[test]
fn a_clock_that_was_reset_is_an_error_that_says_where_and_pieces_are_chosen() {
    let steps = |n: i32, from: f64| (0..n).map(move |k| from + f64::from(k) * 0.01);
    let reset = of_times(steps(50, 100.0).chain(steps(30, 0.0)).chain(steps(20, 5e6)));
    let error = error_of(&reset);
    for words in ["log.csv:52: time falls back from 100.49 s to 0 s", "the first of 2", "--piece"] {
        assert!(error.contains(words), "{error}");
    }
    let piece = |n| {
        let mut columns = Columns::default();
        columns.piece = NonZeroUsize::new(n);
        read_as("log.csv", reset.as_bytes(), &columns)
    };
    for (n, rows, lines) in
        [(1, 50, "line 2 to line 51"), (2, 30, "line 52 to line 81"), (3, 20, "line 82 to line 101")]
    {
        let log = piece(n).unwrap();
        assert_eq!(log.time_s.len(), rows);
        assert!(noted(&log, &[&format!("piece {n} of 3"), lines]), "{:?}", log.notes);
    }
    let words = piece(4).unwrap_err().to_string();
    assert!(words.contains("3 piece(s)"), "{words}");
    // A leap alone, and short logs that begin again.
    for (times, words) in [
        (vec![0.0, 0.1, 1.6e9, 1.6e9 + 0.1], "log.csv:4: time leaps from 0.1 s to 1600000000 s"),
        (vec![100.0, 100.1, 100.2, 0.0, 0.1, 0.2], "log.csv:5: time falls back"),
        (vec![0.3, 0.4, 0.5, 0.0, 0.1, 0.2], "log.csv:5: time falls back"),
        (vec![0.0, 0.1, 0.2, 0.3, 0.0, 0.1, 0.2, 0.3], "log.csv:6: time falls back"),
        (vec![0.3, 0.2, 0.1], "log.csv:3: time runs backwards from here on; sort the rows by time"),
        (vec![1.0, 0.0], "log.csv:3: time runs backwards"),
    ] {
        let error = error_of(&of_times(times));
        assert!(error.contains(words), "{error}");
    }
    // A clock that was set back by a fifth of a second, or by two rows, goes over the same time twice.
    for back_to_s in [0.3, 0.48, 0.4875] {
        let error = error_of(&of_times(steps(50, 0.0).chain(steps(50, back_to_s))));
        assert!(error.contains("log.csv:52: time falls back"), "{error}");
    }
}

#[test]
fn microseconds_of_32_bits_go_on_after_their_end() {
    let of = |stamps: Vec<u64>| {
        let rows: String = stamps.iter().enumerate().map(|(k, stamp)| format!("{stamp},{k}.5\n")).collect();
        format!("time_us,P1\n{rows}")
    };
    let began = |first: u64| (0..500_u64).map(move |k| (first + k * 5000) % (1 << 32));
    // Rows swapped at the end, too.
    let mut stamps: Vec<u64> = began((1 << 32) - 1_000_000).collect();
    stamps.swap(199, 200);
    let log = good(&of(stamps));
    assert!((0..500).all(|k| (log.time_s[k] - (4_293.967_296 + k as f64 * 0.005)).abs() <= 1e-9));
    assert!(noted(&log, &["32 bits of microseconds began again", "line 201"]), "{:?}", log.notes);
    // A clock that starts again elsewhere, or goes on elsewhere.
    for (first, second) in [((1 << 32) - 9_000_000, 0), ((1 << 32) - 1_000_000, 3_000_000)] {
        let error = error_of(&of(began(first).take(200).chain(began(second).take(100)).collect()));
        assert!(error.contains("log.csv:202: time falls back"), "{error}");
    }
}

#[test]
fn repeated_stamps_and_gaps_are_told() {
    let log = good(&of_times([0.0, 0.1, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8]));
    assert_eq!(log.time_s.len(), 10);
    assert!(noted(&log, &["1 row(s) have the same time stamp", "line 4"]), "{:?}", log.notes);
    let log = good(&of_times((0..64).map(|k| f64::from(k / 8) * 0.08)));
    assert!(noted(&log, &["blocks of one time stamp", "about 8.0 rows each, 0.08 s apart"]), "{:?}", log.notes);
    assert!(noted(&good(&of_times([1.0; 20])), &["blocks of one time stamp"]));
    let log = good(&of_times((0..30).map(|k| f64::from(k) * 0.1 + if k >= 20 { 2.3 } else { 0.0 })));
    assert!(
        noted(&log, &["1 gap(s) of more than 5 steps of 0.1 s; the longest, 2.4 s, ends at line 22"]),
        "{:?}",
        log.notes
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Rows that are put back by few places come out as they were, whatever the dialect.
    #[test]
    fn any_small_disorder_comes_out_sorted(
        swaps in prop::collection::vec(0..200_usize, 0..20),
        comma in any::<bool>(),
    ) {
        let mut rows: Vec<(f64, f64)> = (0..201).map(|k| (f64::from(k) / 64.0, f64::from(k * k) / 4.0)).collect();
        for &at in &swaps {
            rows.swap(at, at + 1);
        }
        let mut text = String::from(if comma { "time_s;P1\n" } else { "time_s,P1\n" });
        for (t, v) in rows {
            let row = if comma { format!("{t};{v}\n").replace('.', ",") } else { format!("{t},{v}\n") };
            text += &row;
        }
        let log = good(&text);
        prop_assert!(log.time_s.iter().enumerate().all(|(k, &t)| t == k as f64 / 64.0));
        prop_assert!(log.photodiodes[0].values.iter().enumerate().all(|(k, &v)| v == (k * k) as f64 / 4.0));
    }

    /// Whatever bytes stand in a file, reading ends in words.
    #[test]
    fn any_bytes_are_answered(
        bytes in prop::collection::vec(prop::sample::select(&b"time_s,P1;led\n\r\t\"#0123.-:e\xff"[..]), 0..200)
    ) {
        let text = [&b"time_s,P1\n"[..], &bytes].concat();
        for bytes in [&bytes, &text] {
            if let Err(why) = read_as("log.csv", bytes, &Columns::default()) {
                prop_assert!(why.to_string().contains("log.csv"));
            }
        }
    }
}

mod real_data {
    use super::*;
    use crate::real_data::real_data;

    #[test]
    #[ignore = "needs real recordings: LUNULA_REAL_DATA"]
    fn real_photoplethysmograms_are_read() {
        let milliseconds = |text| timed(text, TimeUnit::Milliseconds);
        let log = Log::read(&real_data("signals/heartpy_data2.csv"), &milliseconds("time_s=timer,P1=hr")).unwrap();
        assert_eq!((log.time_s.len(), log.photodiodes[0].values[1]), (15_000, 514.0));
        assert!((log.time_s[1] - 0.008_547_903).abs() <= 1e-9);
        for (subject, rows) in [("subject_01", 3155), ("subject_02", 2212), ("subject_03", 2219)] {
            let path = real_data(&format!("signals/welltory/{subject}/PPG.csv"));
            let log = Log::read(&path, &milliseconds("P1=R,P2=G,P3=B")).unwrap();
            assert_eq!((log.time_s.len(), log.photodiodes.len()), (rows, 3), "{subject}");
            assert!(log.time_s.is_sorted() && noted(&log, &["`time`"]), "{:?}", log.notes);
        }
    }

    #[test]
    #[ignore = "needs real recordings: LUNULA_REAL_DATA"]
    fn real_inertial_logs_with_dates_are_read() {
        let [phone, other] = ["camera_imu", "LF"].map(|name| real_data(&format!("signals/sevivi/{name}.csv.gz")));
        let columns = Columns::parse("P1=ACCELERATION_X,P2=ACCELERATION_Y,P3=ACCELERATION_Z").unwrap();
        let [phone, other] = [phone, other].map(|path| Log::read(&path, &columns).unwrap());
        // Both begin with a header; their stamps are 64 and 105.8 a second.
        let swapped = phone.time_s.len() == 1717;
        let (slow, fast) = if swapped { (phone, other) } else { (other, phone) };
        assert_eq!((slow.time_s.len(), fast.time_s.len()), (1717, 2238));
        for (log, step_s) in [(&slow, 1.0 / 64.0), (&fast, 0.009_448_009)] {
            let mean_s = (log.time_s[log.time_s.len() - 1] - log.time_s[0]) / (log.time_s.len() - 1) as f64;
            assert!((mean_s - step_s).abs() <= 1e-7, "{mean_s}");
            assert!(log.midnight_s.is_some_and(|m| m <= log.time_s[0] && log.time_s[0] - m < 86_400.0));
        }
        assert!([&slow, &fast].iter().any(|log| noted(log, &["`#1`", "time_s"])), "the nameless column of dates");
    }
}
