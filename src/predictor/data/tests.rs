use std::fmt::Write as _;

use super::*;
use crate::log::{AmbientOptions, Columns, Log, LogReading, samples};
use crate::trial::Folder;

fn plain() -> RowOptions {
    RowOptions::default()
}

fn dropping() -> RowOptions {
    RowOptions { drop_invalid: true, ..plain() }
}

fn forces() -> Wanted {
    Wanted { targets: ["Fx_N", "Fy_N", "Fz_N"].map(str::to_owned).to_vec(), ..Wanted::default() }
}

fn only(target: &str) -> Wanted {
    Wanted { targets: vec![target.to_owned()], ..Wanted::default() }
}

fn angle() -> Wanted {
    only("J2_deg")
}

fn read(text: impl AsRef<[u8]>, wanted: &Wanted) -> Result<Read, DataError> {
    let folder = Folder::new();
    read_data(&[folder.file("a.csv", text)], wanted)
}

fn refusal(text: impl AsRef<[u8]>, wanted: &Wanted) -> String {
    read(text, wanted).unwrap_err().to_string()
}

/// What became of the rows: all, used, empty, invalid, faults.
fn counts(read: &Read) -> [usize; 5] {
    let f = &read.files[0];
    [f.rows, f.used, f.empty, f.invalid, f.faults]
}

#[test]
fn cells_of_another_grid_are_warned_of() {
    let cells = |from: usize, to: usize| -> Vec<String> {
        (from..to).flat_map(|row| (from..to).map(move |column| format!("C_{row:02}_{column:02}"))).collect()
    };
    // Of 8 x 8 the outermost show no nail.
    let said = columns::other_grid(&cells(1, 7), &cells(0, 10)).unwrap();
    assert!(said.contains("10 x 10") && said.contains("--cells 8"), "{said}");
    assert_eq!(columns::other_grid(&cells(1, 7), &cells(0, 8)), None);
    assert_eq!(columns::other_grid(&cells(0, 8), &cells(0, 8)), None);
    for chosen in [&["C_04_08", "C_06_02"][..], &["C_04_04", "C_05_05"], &["C_02_02", "C_03_03", "C_08_08"]] {
        let chosen: Vec<String> = chosen.iter().map(|&name| name.to_owned()).collect();
        assert_eq!(columns::other_grid(&chosen, &cells(0, 12)), None, "{chosen:?}");
    }
    let photodiodes = ["P1", "P2"].map(str::to_owned);
    assert_eq!(columns::other_grid(&photodiodes, &photodiodes), None);
    let table = |side: usize| {
        let names = cells(0, side);
        format!("{}\n{}\n", names.join(","), vec!["0.5"; names.len()].join(","))
    };
    let folder = Folder::new();
    let inputs = |side: usize| read_inputs(&folder.file("c.csv", table(side)), &cells(1, 7), &plain()).unwrap();
    assert!(inputs(10).warnings.concat().contains("other places"), "{:?}", inputs(10).warnings);
    assert_eq!(inputs(8).warnings, Vec::<String>::new());
}

#[test]
fn columns_are_found_by_name_whatever_their_order_and_dialect() {
    for text in [
        "time_s,P1,P2,P10,J2_deg\n0,1,2,10,5\n0.04,1.5,2.5,10.5,6\n",
        "\u{feff}J2_deg,note,P10,\"P2\",P1,time_s\r\n5,\"a, b\",10,2,1,0\r\n\r\n6,,10.5,2.5,1.5,0.04\r\n",
        "P2 , P10,J2_deg,time_s,P1,P01,Px\n2,10,5,0, 1,x,nan\n2.5,10.5,6,0.04, 1.5,,",
    ] {
        let read = read(text, &angle()).unwrap();
        assert_eq!(read.data.inputs(), ["P1", "P2", "P10"], "{text}");
        assert_eq!(read.data.x(), &ndarray::array![[1.0, 2.0, 10.0], [1.5, 2.5, 10.5]]);
        assert_eq!((read.data.y(), read.data.time_s()), (&ndarray::array![[5.0], [6.0]], &[0.0, 0.04][..]));
        assert_eq!((counts(&read), read.warnings.len()), ([2, 2, 0, 0, 0], 0), "{:?}", read.warnings);
    }
}

#[test]
fn photodiodes_may_be_chosen_and_time_may_lack() {
    let wanted = Wanted { inputs: Some(vec!["P3".into(), "P1".into()]), ..angle() };
    let read = read("P1,P2,P3,J2_deg\n1,x,3,0\n4,,6,1\n", &wanted).unwrap();
    assert_eq!(read.data.inputs(), ["P3", "P1"]);
    assert_eq!(read.data.x(), &ndarray::array![[3.0, 1.0], [6.0, 4.0]]);
    assert!(read.data.time_s().iter().all(|t| t.is_nan()));
}

#[test]
fn rows_are_left_out_and_counted_once() {
    let text = "P1,P2,J2_deg,sensor_status\n1,2,3,ok\n,2,3,ok\n1,2,,\nnan,2,3,ok\n1,inf,,ok\n1,2,x,saturated: \
                P2\n1,2,4,no ambient: P9\n2,1,5,ok\n";
    let first = refusal(text, &angle());
    assert!(
        first.contains("a.csv:5: column `P1`: `NaN` is no finite number") && first.contains("--drop-invalid"),
        "{first}"
    );
    let read = |wanted: &Wanted| read(text, wanted).unwrap();
    assert_eq!(counts(&read(&Wanted { rows: dropping(), ..angle() })), [8, 3, 2, 2, 1]);
    let kept = read(&Wanted { rows: RowOptions { keep_faults: true, ..dropping() }, ..angle() });
    assert_eq!(counts(&kept), [8, 3, 2, 3, 0]);
    assert_eq!(kept.data.y(), &ndarray::array![[3.0], [4.0], [5.0]]);
    let other = Wanted { rows: dropping(), inputs: Some(vec!["P1".into()]), ..angle() };
    assert_eq!(counts(&read(&other)), [8, 3, 3, 2, 0]);
}

#[test]
fn rows_without_targets_are_the_past_of_the_next_row_of_their_part() {
    let text = "time_s,P1,J2_deg,session,sensor_status\n0,1,,a,ok\n1,2,5,a,ok\n2,3,,a,ok\n3,4,,b,ok\n4,5,,b,saturated: \
                P1\n5,,,b,ok\n6,7,x,b,ok\n7,8,6,b,ok\n8,9,,b,ok\n";
    let read = read(text, &Wanted { rows: dropping(), ..angle() }).unwrap();
    let lags = lunula_predictor::Lags::new(vec![1.0], 4.0).unwrap();
    let wide = lags.expand(&read.data).unwrap().data;
    // The last row of `a` is no past of `b`'s, a saturated one nobody's.
    assert_eq!(wide.x(), &ndarray::array![[2.0, 1.0], [8.0, 7.0]]);
    let three = lunula_predictor::Lags::new(vec![3.5], 4.0).unwrap().expand(&read.data).unwrap();
    assert_eq!((three.data.x(), three.kept), (&ndarray::array![[8.0, 4.5]], vec![1]));
    assert!(lunula_predictor::Lags::new(vec![4.5], 4.0).unwrap().expand(&read.data).is_err());
}

#[test]
fn the_first_wrong_cell_by_line_is_told() {
    let said = refusal("P1,J2_deg,time_s\n1,2,3\n2,3,soon\nx,3,4\n", &angle());
    assert!(said.contains("a.csv:3: column `time_s`: `soon`"), "{said}");
    for wrong in ["1e999", "-inf", "NaN", "1 V", "0x1", "1,5e", "\"1,5\""] {
        let said = refusal(format!("P1,J2_deg\n1,2\n3,{wrong}\n").replace("1,5e", "\"1.5e\""), &angle());
        assert!(said.contains("a.csv:3: column `J2_deg`"), "{said}");
    }
}

#[test]
fn missing_columns_are_told_with_the_nearest_and_all() {
    let said = refusal("time_s,P1,fz_n,Fx_N,Fy_N\n0,1,2,3,4\n", &forces());
    assert!(said.contains("a.csv: has no column `Fz_N`; is it `fz_n`? Its columns are time_s, P1, fz_n"), "{said}");
    let said = refusal("time_s,P1,Fz_kgf,Fx_N,Fy_N\n0,1,2,3,4\n", &forces());
    assert!(said.contains("no column `Fz_N`; `Fz_kgf` is in another unit: write newtons. Its columns"), "{said}");
    let said = refusal("time_s,ch1,J2_deg\n0,1,2\n", &angle());
    assert!(said.contains("has no photodiode `P1`") && said.contains("time_s, ch1, J2_deg"), "{said}");
    let wanted = Wanted { inputs: Some(vec!["P8".into()]), ..angle() };
    assert!(refusal("P1,J2_deg\n0,1\n", &wanted).contains("no column `P8`"));
    assert_eq!(read("time_s;P1;J2_deg\n0;1,5;2\n", &angle()).unwrap().data.x()[[0, 0]], 1.5);
    assert!(refusal("P1,P1,J2_deg\n0,1,2\n", &angle()).contains("two columns are named `P1`"));
}

#[test]
fn empty_and_damaged_files_are_told() {
    for (text, words) in [
        ("", "a.csv: is empty"),
        ("\n\r\n", "a.csv: is empty"),
        ("P1,J2_deg\n", "a.csv: there is no row below the names"),
        ("P1,J2_deg\n1,\n,2\n", "of 2 rows 2 have an empty cell"),
        ("P1,J2_deg\n1,2\n1\n", "line 3 has 1 cells and the first line 2"),
    ] {
        assert!(refusal(text, &angle()).contains(words), "{text:?}: {}", refusal(text, &angle()));
    }
    let wanted = Wanted { rows: dropping(), ..angle() };
    let said = refusal("P1,J2_deg,sensor_status\nnan,1,\n2,2,saturated: P1\n", &wanted);
    assert!(said.contains("1 have a cell that is no finite number") && said.contains("1 are saturated"), "{said}");
    assert!(read_data(&[], &angle()).unwrap_err().to_string().contains("no DATA"));
    assert!(read_data(&["nothing.csv".into()], &angle()).unwrap_err().to_string().contains("nothing.csv"));
}

#[test]
fn one_row_and_huge_and_tiny_values_are_rows() {
    let read = read("P1,P2,J2_deg\n1e300,-1e-300,5e-324\n", &angle()).unwrap();
    assert_eq!((read.data.x(), read.data.y()), (&ndarray::array![[1e300, -1e-300]], &ndarray::array![[5e-324]]));
    assert_eq!((read.data.recordings().len(), read.warnings.len()), (1, 0));
}

#[test]
fn recordings_follow_session_subject_trajectory_and_time() {
    let text = "time_s,P1,J2_deg,session,subject,trajectory\n\
                0,1,0,s1,anna,spiral1\n1,2,0,s1,anna,spiral1\n0,3,0,s1,anna,spiral2\n\
                1,4,0,,anna,\n0.5,5,0,,anna,\n,6,0,,anna,\n2,7,0,s2,bert,\n";
    let folder = Folder::new();
    let path = folder.file("a.csv", text);
    let read = read_data(std::slice::from_ref(&path), &angle()).unwrap();
    let file = path.display().to_string();
    let seen: Vec<(String, String, String, std::ops::Range<usize>)> = read
        .data
        .recordings()
        .iter()
        .map(|r| (r.name.replace(&file, "f"), r.session.replace(&file, "f"), r.subject.clone(), r.rows.clone()))
        .collect();
    let row = |name: &str, session: &str, subject: &str, rows| {
        (name.to_owned(), session.to_owned(), subject.to_owned(), rows)
    };
    assert_eq!(
        seen,
        [
            row("f (spiral1)", "s1", "anna", 0..2),
            row("f (spiral2)", "s1", "anna", 2..3),
            row("f #3", "f", "anna", 3..4),
            row("f #4", "f", "anna", 4..6),
            row("f #5", "s2", "bert", 6..7),
        ]
    );
    assert_eq!(read.warnings.len(), 1, "{:?}", read.warnings);
    assert!(read.warnings[0].contains("goes back once from 1 to 0.5 s"), "{:?}", read.warnings);
    // Given as another's, as by a pipeline whose folder is another subject's.
    let given = |subject: &str| {
        let file = DataFile { subject: Some(subject.to_owned()), ..DataFile::from(path.clone()) };
        read_files(&[file], &angle()).unwrap().warnings
    };
    assert!(given("zoe").iter().any(|said| said.contains("column `subject` says `anna`, which is taken")));
    assert_eq!(given("anna").iter().filter(|said| said.contains("says `bert`")).count(), 1, "{:?}", given("anna"));
}

#[test]
fn a_row_left_out_divides_nothing_and_a_recording_without_rows_is_none() {
    let text = "time_s,P1,J2_deg,session\n0,1,0,a\n9,2,,a\n1,3,0,a\n2,4,,b\n3,5,0,c\n";
    let read = read(text, &angle()).unwrap();
    let seen: Vec<_> = read.data.recordings().iter().map(|r| (r.session.as_str(), r.rows.clone())).collect();
    assert_eq!((seen, read.warnings.len()), (vec![("a", 0..2), ("c", 2..3)], 0));
}

#[test]
fn files_follow_each_other_and_have_to_agree() {
    let folder = Folder::new();
    let a = folder.file("a.csv", "P1,P2,J2_deg\n1,2,3\n4,5,6\n");
    let b = folder.file("b.csv", "J2_deg,P2,P1\n7,8,9\n");
    let c = folder.file("c.csv", "J2_deg,P3,P1\n7,8,9\n");
    let read = read_data(&[b.clone(), a.clone()], &angle()).unwrap();
    assert_eq!(read.data.x(), &ndarray::array![[9.0, 8.0], [1.0, 2.0], [4.0, 5.0]]);
    assert_eq!(read.data.recordings().iter().map(|r| r.rows.clone()).collect::<Vec<_>>(), [0..1, 1..3]);
    let again = read_data(&[a.clone(), a.clone()], &angle()).unwrap();
    assert!(again.warnings.len() == 1 && again.warnings[0].contains("given twice"), "{:?}", again.warnings);
    let said = read_data(&[a.clone(), c], &angle()).unwrap_err().to_string();
    assert!(
        said.contains("c.csv: has other photodiodes than") && said.contains("lacks P2") && said.contains("lacks P3"),
        "{said}"
    );
    assert!(read_data(&[a, folder.file("d.csv", "P1,P2,J2_deg\n")], &angle()).unwrap().files[1].rows == 0);
}

/// A modulated log: lit and unlit samples of three photodiodes, with forces.
fn modulated(rows: usize) -> String {
    let mut text = "time_s,led,P1,P2,P3,Fx_N,Fy_N,Fz_N\n".to_owned();
    for k in 0..rows {
        let (t, lit) = (k as f64 * 0.01, k % 2);
        let p = [1.0, 1.3, 0.7].map(|a| a * lit as f64 * (1.5 + 0.3 * (a * t).sin()) + 0.2 + 0.01 * (7.0 * t).sin());
        let p3 = if k % 50 == 5 { String::new() } else { format!("{:.4}", p[2]) };
        writeln!(text, "{t:.3},{lit},{:.4},{:.4},{p3},{:.3},{:.3},{:.3}", p[0], p[1], t.sin(), t.cos(), -t).unwrap();
    }
    text
}

#[test]
fn a_modulated_log_is_what_align_makes_of_it() {
    let folder = Folder::new();
    let path = folder.file("log.csv", modulated(400));
    let read = read_data(std::slice::from_ref(&path), &forces()).unwrap();
    let same = samples(&Log::read(&path, &Columns::default()).unwrap(), &AmbientOptions::default()).unwrap();
    let whole: Vec<usize> = (0..same.time_s.len())
        .filter(|&k| same.photodiodes.iter().all(|c| !c.values[k].is_nan()) && same.faults[k].is_empty())
        .collect();
    assert_eq!((read.files[0].rows, read.files[0].used), (200, whole.len()));
    assert!(whole.len() > 180 && whole.len() < 200, "{}", whole.len());
    for (row, &k) in whole.iter().enumerate() {
        assert_eq!(read.data.time_s()[row].to_bits(), same.time_s[k].to_bits());
        for (column, channel) in same.photodiodes.iter().enumerate() {
            assert_eq!(read.data.x()[[row, column]].to_bits(), channel.values[k].to_bits());
        }
        for (column, channel) in same.forces.iter().enumerate() {
            assert_eq!(read.data.y()[[row, column]].to_bits(), channel.values[k].to_bits());
        }
    }
    let notes = &read.files[0].notes;
    assert!(notes.iter().any(|note| note.contains("log.csv: ambient light taken away")), "{notes:?}");
    let said = read_data(&[path], &angle()).unwrap_err().to_string();
    assert!(said.contains("is a raw log and has no column `J2_deg`") && said.contains("lunula align"), "{said}");
    let newtons = folder.file("mn.csv", modulated(400).replacen("Fx_N", "Fx_mN", 1));
    let said = read_data(&[newtons], &forces()).unwrap_err().to_string();
    assert!(
        said.contains("has no column `Fx_N`") && said.contains("`Fx_mN` is a force that is not in newtons"),
        "{said}"
    );
}

#[test]
fn dead_and_saturated_photodiodes_are_warned_of() {
    let mut text = "P1,P2,P3,J2_deg\n".to_owned();
    for k in 0..600 {
        let wave = 2.5 + 3.0 * (k as f64 * 0.05).sin();
        writeln!(text, "{:.4},2.5,{wave:.4},30", wave.min(4.0)).unwrap();
    }
    let read = read(text, &angle()).unwrap();
    let [saturated, dead] = &read.warnings[..] else { panic!("{:?}", read.warnings) };
    assert!(saturated.contains("P1 stays at exactly 4 V, its greatest value, in") && saturated.contains("of 600 rows"));
    assert!(dead.contains("P2 is 2.5 V in all 600 rows: dead"), "{dead}");
}

#[test]
fn photodiodes_that_are_counted_from_0_are_not_shifted_by_one() {
    let wanted = Wanted { inputs: Some(["P1", "P2"].map(str::to_owned).to_vec()), ..angle() };
    let said = refusal("P0,P1,J2_deg\n1,2,3\n", &wanted);
    assert!(said.contains("no column `P2`. Photodiodes are counted from 1") && !said.contains("is it"), "{said}");
}

#[test]
fn labels_that_were_filled_in_count_as_empty() {
    let of = |labels: [&str; 3]| {
        let [before, gap, other] = labels;
        let text = format!(
            "P1,J2_deg,label_status\n\
             1,{before},before the video\n2,3,ok\n3,{gap},gap: J1 J2\n4,{other},gap: J3\n5,4,ok\n"
        );
        read(&text, &angle()).unwrap()
    };
    let filled = of(["0", "0", "2"]);
    assert_eq!((filled.files[0].used, filled.files[0].empty), (3, 2));
    assert!(filled.warnings.iter().any(|said| said.contains("J2_deg stands in 2 row(s)")), "{:?}", filled.warnings);
    let empty = of(["", "", "2"]);
    assert_eq!((empty.data.y(), empty.warnings.len()), (filled.data.y(), filled.warnings.len() - 1));
}

#[test]
fn an_unknown_status_is_warned_of_and_used() {
    let read = read("P1,J2_deg,sensor_status\n1,2,loose\n2,3,loose\n3,4,ok\n", &angle()).unwrap();
    assert_eq!(counts(&read)[1], 3);
    assert!(read.warnings.len() == 1 && read.warnings[0].contains("in 2 rows, first `loose`"), "{:?}", read.warnings);
}

#[test]
fn voltages_alone_keep_every_row() {
    let folder = Folder::new();
    let path = folder.file("a.csv", "time_s,P2,P1,sensor_status\n0,2,1,ok\n1,,1,ok\n2,x,1,saturated: P1\n");
    let inputs = ["P1", "P2"].map(str::to_owned);
    assert!(read_inputs(&path, &inputs, &plain()).unwrap_err().to_string().contains("a.csv:4: column `P2`"));
    let read = read_inputs(&path, &inputs, &dropping()).unwrap();
    assert_eq!((read.x.dim(), read.x[[0, 1]], read.x[[2, 0]]), ((3, 2), 2.0, 1.0));
    assert!(read.x[[1, 1]].is_nan() && read.x[[2, 1]].is_nan());
    assert_eq!((read.faulty, read.time_s), (vec![false, false, true], vec![0.0, 1.0, 2.0]));
    assert_eq!(read.recordings[0].rows, 0..3);
    let none = read_inputs(&folder.file("b.csv", "P1,P2\n"), &inputs, &plain()).unwrap();
    assert_eq!((none.x.dim(), none.recordings.len()), ((0, 2), 0));
    assert!(read_inputs(&path, &[], &plain()).is_err());
}

#[test]
fn columns_named_twice_are_told_with_where() {
    let twice = Wanted { inputs: Some(vec!["P1".into(), "P1".into()]), ..angle() };
    assert!(refusal("P1,J2_deg\n1,2\n", &twice).contains("P1 is named twice among the inputs"));
    let time = Wanted { inputs: Some(vec!["time_s".into(), "P1".into()]), ..angle() };
    assert!(refusal("time_s,P1,J2_deg\n1,2,3\n", &time).contains("time_s is when a row was measured"));
    let both = Wanted { inputs: Some(vec!["P1".into(), "J2_deg".into()]), ..angle() };
    assert!(refusal("P1,J2_deg\n1,2\n", &both).contains("is both an input and a target"));
    let said = refusal("0.1,0.2\n1,2\n", &Wanted { inputs: Some(vec!["P1".into()]), ..angle() });
    assert!(said.contains("holds numbers where the names"), "{said}");
    let same = |rows: usize| read(format!("P1,J2_deg\n{}", "1e-300,20\n".repeat(rows)), &angle()).unwrap().warnings;
    assert!(same(10)[0].contains("P1 is 1e-300 V in all 10 rows"), "{:?}", same(10));
    assert_eq!(same(9), Vec::<String>::new(), "by chance");
}

fn called(columns: &str) -> LogReading {
    LogReading { columns: Columns::parse(columns).unwrap(), ..LogReading::default() }
}

#[test]
fn a_log_is_one_whatever_its_led_and_columns_are_called() {
    let folder = Folder::new();
    let of = |name: &str, from: &str, to: &str| folder.file(name, modulated(400).replacen(from, to, 1));
    let same = read_data(&[folder.file("log.csv", modulated(400))], &forces()).unwrap();
    // Unlit rows are light of the room in all of them.
    let capital = read_data(&[of("a.csv", "led", "LED")], &forces()).unwrap();
    assert_eq!((capital.data.x(), capital.files[0].rows), (same.data.x(), 200));
    let other = of("b.csv", "time_s,led,P1,P2,P3,Fx_N,Fy_N,Fz_N", "stamp,lamp,ch_3,ch_4,ch_5,fx,fy,load");
    let log = called("time_s=stamp,led=lamp,P1=ch_3,P2=ch_4,P3=ch_5,Fz_N=load");
    let rows = RowOptions { log, ..plain() };
    let inputs = ["P1", "P3"].map(str::to_owned);
    let alone = read_inputs(&other, &inputs, &rows).unwrap();
    let named = read_data(&[other], &Wanted { rows, ..forces() }).unwrap();
    assert_eq!((named.data.x(), named.data.y()), (same.data.x(), same.data.y()));
    assert_eq!(alone.time_s.len(), 200);
    let rule = "interpolated between the unlit samples";
    assert!(alone.notes.iter().any(|note| note.contains(rule)), "{:?}", alone.notes);
}

#[test]
fn a_file_that_cant_be_read_costs_itself_where_that_is_asked_for() {
    let folder = Folder::new();
    let good = folder.file("good.csv", "P1,J2_deg\n1,2\n2,3\n");
    let bad = folder.file("bad.csv", "P1,J2_deg\n1,x\n");
    let all = [bad.clone(), good.clone(), folder.path("lost.csv")];
    assert!(read_data(&all, &angle()).unwrap_err().to_string().contains("bad.csv:2"));
    let wanted = Wanted { skip_failed: true, ..angle() };
    let read = read_data(&all, &wanted).unwrap();
    assert_eq!((read.data.rows(), read.files.len(), read.failed.len()), (2, 1, 2));
    assert!(read.failed[0].why.contains("bad.csv:2: column `J2_deg`") && read.failed[1].name.ends_with("lost.csv"));
    assert_eq!(read.data.recordings()[0].name, good.display().to_string());
    assert!(read_data(&[bad], &wanted).unwrap_err().to_string().contains("bad.csv:2"));
}

#[test]
fn a_hundred_thousand_columns_are_read_in_time_that_grows_with_them() {
    // Looked up one by one they took 12 s, and minutes without optimization.
    const COLUMNS: usize = 100_000;
    let names: Vec<String> = (1..=COLUMNS).map(|k| format!("P{k}")).collect();
    let header = names.join(",");
    let row = "0.5,".repeat(COLUMNS);
    let table = read(format!("{header},J2_deg\n{row}1\n{row}2\n"), &angle()).unwrap();
    assert_eq!((table.data.inputs().len(), table.data.rows()), (COLUMNS, 2));
    let folder = Folder::new();
    let log = folder.file("log.csv", format!("time_s,led,{header},Fz_N\n0,1,{row}-1\n1,0,{row}-1\n2,1,{row}-1\n"));
    let wanted = Wanted { rows: RowOptions { keep_faults: true, ..plain() }, ..only("Fz_N") };
    assert!(read_data(&[log], &wanted).unwrap_err().to_string().contains("no row can be used"));
}

#[test]
fn photodiodes_that_answer_before_a_finger_moves_are_warned_of() {
    let moved = |t: f64| (0.9 * t).sin() + (0.37 * t + 1.0).sin();
    let recorded = |late_s: f64| {
        let mut text = "time_s,P1,P2,Fz_N\n".to_owned();
        for row in 0..1500 {
            let t = 0.04 * f64::from(row);
            let volts = 2.0 - 0.1 * moved(t - 0.1);
            writeln!(text, "{t},{volts},{},{}", 3.0 + 0.1 * (0.2 * t).sin(), moved(t - late_s) - 2.0).unwrap();
        }
        text
    };
    let wanted = only("Fz_N");
    let said = |late_s: f64| read(recorded(late_s), &wanted).unwrap().warnings.join("; ");
    // Nearly a second is a nail's that refills slowly.
    assert_eq!([0.0, 0.2, -0.8].map(said), ["", "", ""]);
    let [before, after] = [said(1.1), said(-3.1)];
    assert!(before.contains("a.csv: the photodiodes answer 1.0 s before Fz_N, as in no finger"), "{before}");
    assert!(
        after.contains("answer 3.2 s after Fz_N, and blood takes 0.1 to 0.4 s")
            && after.contains(" 0.0 % of the variance"),
        "{after}"
    );
    let folder = Folder::new();
    let files = [0.0, 1.1, 1.1].map(recorded).into_iter().enumerate();
    let files: Vec<PathBuf> = files.map(|(k, text)| folder.file(&format!("{k}.csv"), text)).collect();
    let warnings = read_data(&files, &wanted).unwrap().warnings;
    let alike = warnings.iter().filter(|one| one.contains("1.csv") && one.ends_with("(1 more recording(s) alike)"));
    assert_eq!(alike.count(), 1, "{warnings:?}");
}

#[test]
fn what_other_programs_write_above_the_names_is_not_read() {
    let wanted = only("Fz_N");
    let rows = |per_second: f64| -> String {
        let row = |k: u32| format!("{},{},{},{}\n", f64::from(k) * 0.04 * per_second, 2.0, f64::from(k), -f64::from(k));
        (0..8).map(row).collect()
    };
    let plain = read(format!("time_s,P1,P2,Fz_N\n{}", rows(1.0)), &wanted).unwrap();
    let above = "Logger 7\nRate,25 Hz\n\nTime,P1,P2,Fz\n(ms),V,V,N\n";
    let below = read(format!("{above}{}", rows(1000.0)), &wanted).unwrap();
    assert_eq!((below.data.x(), below.data.y()), (plain.data.x(), plain.data.y()));
    assert_eq!(below.data.x().nrows(), 8);
    let notes = below.files[0].notes.join("; ");
    assert!(notes.contains("line 4") && notes.contains("units"), "{notes}");
    let error = read(format!("Logger 7\nfor the nail\n{}", rows(1.0)), &wanted).unwrap_err().to_string();
    assert!(error.contains("a.csv"), "{error}");
}

#[test]
fn a_photodiode_that_is_anothers_copy_is_named() {
    let of = |copied: bool| {
        let mut text = "P1,P2,P3,J2_deg\n".to_owned();
        for k in 0..60 {
            let p = [1, 2].map(|p| 2.0 + 0.01 * f64::from((7 * k * p) % 31));
            let third = if copied { p[1] } else { p[0] + p[1] };
            let _ = writeln!(text, "{},{},{third},{k}", p[0], p[1]);
        }
        read(&text, &angle()).unwrap().warnings
    };
    assert_eq!(of(false), Vec::<String>::new());
    let said = of(true);
    assert!(said.len() == 1 && said[0].contains("P3 is P2 in all rows: is one of them a copy"), "{said:?}");
}
