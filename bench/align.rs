//! How long `lunula align` takes for an hour of log at 100 Hz (eight photodiodes, three forces, LED on and off) and as
//! much video at 30 frames a second, as a ratio in one run with what a user of Python would write. Whole processes, in
//! turn; medians.
//!
//! `cargo bench --bench align`. The peer needs `python3` with pandas; where it is missing that is said.

mod util;

use lunula::phantom::Generated as _;
use lunula::phantom::log::LogOptions;
use lunula::table::{Column, Table, TableWriter, Value};
use util::{Run, compare, seconds};

const ROUNDS: usize = 5;
const SECONDS: f64 = 3600.0;

fn main() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let place = |name: &str| folder.path().join(name).display().to_string();
    let options = LogOptions { seconds: SECONDS, rate_hz: 100.0, ..LogOptions::default() };
    let (offset_s, trajectory) = (options.clock_offset_s, options.trajectory.clone());
    options.write(folder.path()).expect("a log");
    let joints = folder.path().join("joints.csv");
    let names = ["J1_deg", "J2_deg", "J3_deg"];
    let columns = ["time_s", "clock_s"].into_iter().chain(names).map(|name| Column::rounded(name, 6)).collect();
    let mut table = TableWriter::create(&joints, &joints, columns, &[]).expect("a table");
    for frame in 0..(30.0 * SECONDS) as u32 {
        let time_s = f64::from(frame) / 30.0;
        let [j1, j2, j3] = trajectory.angles_rad(time_s).map(|angle| Value::Number(angle.to_degrees()));
        table.write(&[Value::Number(time_s), Value::Number(offset_s + time_s), j1, j2, j3]).expect("a row");
    }
    table.finish().expect("a table");
    let rows = Table::read(&folder.path().join("log.csv")).expect("the log").rows();
    let (joints, log, out, theirs) =
        (place("joints.csv"), place("log.csv"), place("training.csv"), place("theirs.csv"));
    let lunula = env!("CARGO_BIN_EXE_lunula");
    let job = ["align", "--joints", &joints, "--log", &log, "--out", &out, "--quiet"];
    let bare = [&[lunula][..], &job, &["--no-figures"]].concat();
    let drawn = [&[lunula][..], &job].concat();
    let parquet = place("training.parquet");
    let to_parquet = bare.iter().map(|&argument| if argument == out { parquet.as_str() } else { argument }).collect();
    let mut runs: Vec<Run<'_>> =
        vec![("lunula align", bare.clone()), ("the same with pictures", drawn), ("the same to Parquet", to_parquet)];
    let peer = concat!(env!("CARGO_MANIFEST_DIR"), "/../../bench/peers/align.py");
    if seconds(&["python3", "-c", "import numpy, pandas"]).is_some() {
        runs.push(("Python, pandas: interp, to_csv", vec!["python3", peer, &joints, &log, &theirs]));
    } else {
        println!("Python, pandas: left out, python3 has no pandas");
    }
    println!("{rows} rows of log, medians of {ROUNDS} whole processes:");
    compare(&runs, ROUNDS, || {});
}
