//! `lunula align` from end to end on generated recordings: from nothing to a labelled set whose certificate agrees with
//! the truth.

use std::collections::BTreeMap;

use crate::util::{Answer, Dir, known};

type Row = BTreeMap<String, String>;

/// What the log's clock says at the first frame of every scene here.
const OFFSET_S: f64 = 77.7123;

/// A video, its log and its table of angles: 640 x 360, 4 s of bending at 0.25 Hz, irregular frames, a tenths clock.
fn scene(video: &[&str], log: &[&str]) -> Dir {
    let dir = Dir::new();
    let both = ["--out", "s", "--seed", "5", "--seconds", "4", "--bend-hz", "0.25", "--clock-offset", "77.7123"];
    let few = ["--size", "640x360", "--vfr", "--clock", "mm:ss.t", "-q"];
    dir.lunula(&[&["phantom", "video"], &both[..], &few, video].concat()).expect(0);
    dir.lunula(&[&["phantom", "log"], &both[..], &["-q"], log].concat()).expect(0);
    dir
}

fn posture(dir: &Dir) -> Answer {
    dir.lunula(&["posture", "s/video.mp4", "--markers", "s/markers.toml", "--out", "joints.csv", "--no-figures"])
}

fn align(dir: &Dir, more: &[&str]) -> Answer {
    dir.lunula(&[&["align", "--joints", "joints.csv", "--log", "s/log.csv", "--out", "training.csv"], more].concat())
}

fn certificate(dir: &Dir) -> serde_json::Value {
    dir.parsed("training.sync.json")
}

/// The exact angle of each sample of the log, by the log's own stamp.
fn truth(dir: &Dir, joint: &str) -> BTreeMap<String, f64> {
    let (log, truth) = (dir.table("s/log.csv"), dir.table("s/truth/log.csv"));
    let column = format!("{joint}_deg");
    log.iter()
        .zip(&truth)
        .map(|(row, exact)| (row["time_s"].clone(), exact[&column].parse().expect("a number")))
        .collect()
}

/// Labels of a small scene err by no more, degrees RMS; the book has the figures of large ones.
const LABEL_RMS_DEG: [(&str, f64); 3] = [("J1", 0.15), ("J2", 0.3), ("J3", 0.5)];

#[track_caller]
fn labels_are_right(dir: &Dir, set: &[Row]) {
    for (joint, bound) in LABEL_RMS_DEG {
        let exact = truth(dir, joint);
        let column = format!("{joint}_deg");
        let errors: Vec<f64> =
            set.iter().filter_map(|row| Some((known(row, &column)? - exact[&row["time_s"]]).powi(2))).collect();
        assert!(!errors.is_empty(), "{joint} has labels");
        let rms = (errors.iter().sum::<f64>() / errors.len() as f64).sqrt();
        assert!(rms <= bound, "{joint}: {rms} degrees RMS over {}", errors.len());
    }
}

#[test]
fn from_nothing_to_a_set_whose_certificate_agrees_with_the_truth() {
    let dir = scene(&["--hide", "middle_dist@40+14"], &[]);
    let report = posture(&dir).expect(0);
    assert!(report.stderr.is_empty(), "{}", report.stderr);
    let header = dir.text("joints.csv");
    assert!(
        header.starts_with(
            "frame,time_s,clock_s,J1_deg,J1_sd_deg,J2_deg,J2_sd_deg,J3_deg,J3_sd_deg,status,\
             clock_read_s,clock_sd_s,clock_low_s,clock_high_s\n"
        ),
        "{header:.200}"
    );
    let shown = dir.table("s/truth/clock.csv");
    let angles = dir.table("joints.csv");
    let read: Vec<(f64, f64)> = angles
        .iter()
        .zip(&shown)
        .filter_map(|(row, exact)| Some((known(row, "clock_read_s")?, known(exact, "shown_s")?)))
        .collect();
    assert!(read.len() * 20 >= angles.len() * 19, "{} of {} frames read", read.len(), angles.len());
    assert!(read.iter().all(|(read, exact)| (read - exact).abs() <= 1e-6), "none wrong");

    let json = align(&dir, &["--subject", "S1", "--session", "2", "--json"]).expect(0).json();
    let certificate = certificate(&dir);
    assert_eq!(json["certificate"], certificate);
    let of = |key: &str| certificate[key].as_f64().unwrap_or_else(|| panic!("{key}: {}", certificate[key]));
    assert_eq!(certificate["method"], "clock");
    // Sixty readings of irregular frames leave a few milliseconds.
    assert!((of("offset_s") - OFFSET_S).abs() <= 6e-3, "{certificate}");
    let ends = &certificate["offset_interval_s"];
    assert!(ends[0].as_f64().unwrap() <= OFFSET_S && OFFSET_S <= ends[1].as_f64().unwrap(), "{ends}");
    assert!(of("offset_sd_s") > 0.0 && of("residual_rms_s") > 0.01 && of("drift_sd_ppm") > 0.0);
    assert_eq!(of("frames_read") + of("frames_abstained"), angles.len() as f64);

    let set = dir.table("training.csv");
    let header = dir.text("training.csv");
    assert_eq!(
        header.lines().next(),
        Some(
            "time_s,P1,P2,P3,P4,P5,P6,P7,P8,Fx_N,Fy_N,Fz_N,J1_deg,J2_deg,J3_deg,J1_sd_deg,J2_sd_deg,J3_sd_deg,\
             label_status,subject,session,sensor_status"
        )
    );
    labels_are_right(&dir, &set);
    assert!(set.iter().all(|row| row["subject"] == "S1" && row["session"] == "2"));
    let labelled = set.iter().filter(|row| row["label_status"] == "ok").count();
    assert_eq!((of("rows_labelled"), of("rows_unlabelled")), (labelled as f64, (set.len() - labelled) as f64));
    // Half of the log's rows are unlit.
    let lit = dir.table("s/log.csv").iter().filter(|row| row["led"] == "1").count();
    assert_eq!(set.len(), lit);
    // The log begins a second before the video and ends a second after.
    for why in ["before the video", "after the video"] {
        let rows: Vec<&Row> = set.iter().filter(|row| row["label_status"] == why).collect();
        assert!((10..=14).contains(&rows.len()), "{why}: {}", rows.len());
        assert!(rows.iter().all(|row| row["J2_deg"].is_empty() && row["J2_sd_deg"].is_empty()));
    }
    // Nothing is labelled where the marker was hidden; J1 does not need it.
    let seen = |frame: usize| OFFSET_S + known(&shown[frame], "time_s").unwrap();
    let (from, to) = (seen(41), seen(52));
    let hidden: Vec<&Row> = set.iter().filter(|row| (from..to).contains(&known(row, "time_s").unwrap())).collect();
    assert!(hidden.len() >= 3, "{}", hidden.len());
    for row in hidden {
        assert_eq!((row["J2_deg"].as_str(), row["label_status"].as_str()), ("", "gap: J2 J3"));
        assert!(!row["J1_deg"].is_empty());
    }
    let gap = &certificate["gaps"][0];
    assert!(gap["from_s"].as_f64().unwrap() <= from && gap["to_s"].as_f64().unwrap() >= to, "{gap}");
    for picture in ["training-tie.png", "training-tie.svg", "training-labels.png", "training-labels.svg"] {
        assert!(dir.path(picture).is_file(), "{picture}");
    }
}

#[test]
fn a_set_of_parquet_has_its_facts() {
    let dir = scene(&[], &[]);
    posture(&dir).expect(0);
    dir.words("align --joints joints.csv --log s/log.csv --out set.parquet -q").expect(0);
    let parquet = lunula::table::Table::read(&dir.path("set.parquet")).unwrap();
    let fact =
        |key: &str| parquet.facts().iter().find(|(name, _)| name == key).map(|(_, value)| value.clone()).unwrap();
    assert!(fact("forces").contains("negative Fz_N") && fact("certificate").contains("\"offset_s\""));
}

#[test]
fn a_clock_that_is_looked_for_says_the_same() {
    let dir = scene(&["--clock-roi-auto", "--clock-font", "segments"], &[]);
    posture(&dir).expect(0);
    align(&dir, &[]).expect(0);
    let offset_s = certificate(&dir)["offset_s"].as_f64().unwrap();
    assert!((offset_s - OFFSET_S).abs() <= 6e-3, "{offset_s}");
}

#[test]
fn without_a_clock_an_offset_is_needed() {
    let dir = scene(&[], &[]);
    let markers = dir.text("s/markers.toml");
    dir.write("s/markers.toml", markers.split("\n[clock]").next().unwrap());
    let report = posture(&dir).expect(0);
    let header = dir.text("joints.csv");
    assert!(
        header.lines().next().unwrap().ends_with(",status"),
        "no clock's columns: {report:?}",
        report = report.stderr
    );
    align(&dir, &[]).expect(2).says("--sync offset=SECONDS");
    align(&dir, &["--sync", "clock"]).expect(2).says("clock_s");
    assert!(!dir.path("training.csv").exists() && !dir.path("training.sync.json").exists());

    let unused = ["--max-lag", "3", "--clock-zero", "1"];
    let answer = align(&dir, &[&["--sync", "offset=77.7123"], &unused[..]].concat()).expect(0);
    answer.says("--max-lag is of no use here: only --sync correlate").says("--clock-zero is of no use here");
    let set = dir.table("training.csv");
    labels_are_right(&dir, &set);
    // How well the offset is known was not said, so no label's error is known.
    assert!(set.iter().all(|row| row["J2_sd_deg"].is_empty()));
    assert!(certificate(&dir)["offset_sd_s"].is_null());
    align(&dir, &["--sync", "offset=77.7123+-0.005"]).expect(0);
    let set = dir.table("training.csv");
    assert!(set.iter().filter(|row| row["label_status"] == "ok").all(|row| known(row, "J2_sd_deg").unwrap() > 0.0));
    align(&dir, &["--sync", "offset=soon"]).expect(2).says("offset=60.25");
}

#[test]
fn midnight_in_the_picture_and_dates_in_the_log() {
    let clock = ["--clock", "hh:mm:ss.t", "--clock-offset", "86398.3"];
    let dir = scene(&[], &[]);
    let both = ["--out", "s", "--seed", "5", "--seconds", "4", "--bend-hz", "0.25", "-q"];
    dir.lunula(&[&["phantom", "video", "--size", "640x360", "--vfr"], &both[..], &clock].concat()).expect(0);
    dir.lunula(&[&["phantom", "log", "--stamps", "datetime", "--clock-offset", "86398.3"], &both[..]].concat())
        .expect(0);
    posture(&dir).expect(0);
    let read: Vec<f64> = dir.table("joints.csv").iter().filter_map(|row| known(row, "clock_read_s")).collect();
    assert!(read.windows(2).all(|pair| pair[1] >= pair[0]), "counted on over midnight");
    align(&dir, &[]).expect(0);
    let rows = certificate(&dir)["rows_labelled"].as_u64().unwrap();
    assert!((45..=51).contains(&rows), "{rows} rows of 25 Hz, every second one lit, in 4 s");
}

#[test]
fn a_clock_that_is_hidden_half_of_the_time_ties_and_one_that_stops_or_jumps_does_not() {
    let hidden = scene(&["--clock-hide", "20+60"], &[]);
    posture(&hidden).expect(0);
    align(&hidden, &[]).expect(0);
    let offset_s = certificate(&hidden)["offset_s"].as_f64().unwrap();
    assert!((offset_s - OFFSET_S).abs() <= 1e-2, "{offset_s}");
    for (option, at, words) in [("--clock-stop", "60", "stand"), ("--clock-jump", "60+5", "jump")] {
        let dir = scene(&[option, at], &[]);
        posture(&dir).expect(1).says("clock").says(words);
        // The angles are there all the same.
        assert!(dir.table("joints.csv").iter().all(|row| row["clock_s"].is_empty() && row["status"] == "ok"));
        align(&dir, &[]).expect(2).says("no clock");
        assert!(!dir.path("training.csv").exists());
    }
}

#[test]
fn exports_for_other_tools() {
    let dir = scene(&[], &[]);
    dir.words("posture s/video.mp4 --markers s/markers.toml --out joints.csv --tracks tracks.csv -q").expect(0);
    let all =
        ["--mot", "a.mot", "--bids", "bids", "--dlc", "dlc.csv", "--tracks", "tracks.csv", "--subject", "S1", "-q"];
    align(&dir, &all).expect(0);
    let mot = dir.text("a.mot");
    assert!(mot.contains("inDegrees=yes") && mot.contains("endheader"), "{mot:.200}");
    let motion = dir.path("bids/sub-S1/motion/sub-S1_task-bending_tracksys-lunula_motion.tsv");
    let frames = dir.table("joints.csv").len();
    assert_eq!(std::fs::read_to_string(motion).unwrap().lines().count(), frames);
    assert_eq!(dir.text("dlc.csv").lines().count(), frames + 3);
    align(&dir, &["--bids", "other"]).expect(2).says("subject");
    assert!(!dir.path("other").exists());
}

#[test]
fn the_plan_changes_nothing() {
    let dir = scene(&[], &["--no-led"]);
    posture(&dir).expect(0);
    let plan = dir.lunula(&["align", "--joints", "joints.csv", "--log", "s/log.csv", "--plan"]).expect(0).stdout;
    for words in ["ambient light subtracted", "left out", "no column `led`", "only --sync correlate"] {
        assert!(plan.contains(words), "`{words}` in:\n{plan}");
    }
    // What is drawn and exported is known before it is said where the set goes.
    let step = |options: &str, name: &str| {
        let plan = dir.words(&format!("align --joints joints.csv --log s/log.csv --plan {options}")).expect(0).stdout;
        let step = plan.lines().find(|line| line.starts_with(name)).expect("a step").to_owned();
        step.contains(" run ")
    };
    assert!(step("", "figures") && !step("--no-figures", "figures"));
    assert!(step("--mot j.mot", "OpenSim") && !step("", "OpenSim"));
    let stands = dir.bytes_of(".");
    dir.words("align --joints joints.csv --log s/log.csv --out t/training.csv --plan").expect(0);
    assert_eq!(dir.bytes_of("."), stands);
}

#[test]
fn the_trade_off_measures_the_clock_read_in_fewer_and_fewer_frames() {
    let dir = scene(&[], &[]);
    let report = dir.words("tradeoff align --input s --truth s/truth --out t --repeats 1 --json").expect(0).json();
    let rows = report["rows"].as_array().unwrap();
    let of = |setting: &str| rows.iter().find(|row| row["setting"] == setting).unwrap_or_else(|| panic!("{report}"));
    let [every, few] = ["clock in every frame", "clock in 1 of 20 frames"].map(of);
    // The first second and a half is read in any case.
    assert!(every["error"].as_f64().unwrap() <= 6e-3 && few["error"].as_f64().unwrap() <= 0.1, "{report}");
    assert!(few["work"].as_u64().unwrap() * 2 <= every["work"].as_u64().unwrap());
    // Where nothing ties, the report says which and why.
    let warned = report["warnings"].as_array().unwrap().len();
    let labels = rows.iter().filter(|row| row["choice"] == "bridging").count();
    assert_eq!(rows.len() + warned, 6 + labels, "{report}");
    assert_eq!(labels, 4, "{report}");
    // Angles over longer gaps label more rows.
    let [few, many] = ["no frame bridged", "gaps of twenty frames"].map(of);
    assert!(few["work"].as_u64().unwrap() < many["work"].as_u64().unwrap(), "{report}");
    assert_eq!(report["curves"][0]["default"]["setting"], "clock in every frame");
    let others = &report["peers"][0];
    assert!(others["measured"] == false && others["what"].as_str().unwrap().contains("--peers"), "{report}");
    for file in ["t/tradeoff.csv", "t/tradeoff.png", "t/tradeoff.svg"] {
        assert!(dir.path(file).is_file(), "{file}");
    }
}
