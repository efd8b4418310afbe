//! A synthetic study: what it will write is known before, every job reads it as it stands, and its parts agree.

use std::collections::BTreeMap;
use std::sync::OnceLock;
use std::sync::atomic::AtomicBool;

use crate::util::{Dir, number};
use lunula::job::Work;
use lunula::pipeline::{Catalogue, phantom_catalogue};
use lunula_thesis::experiments;

/// Two people, one of whom wears the sensor; four seconds of each video.
const SMALL: &str =
    "phantom study --seed 3 --subjects 2 --sensors 1 --presses 1 --video-size 480x270 --seconds 4 --out study";
const SMALL_BLOCK: &str =
    "study = { seed = 3, subjects = 2, sensors = 1, presses = 1, video_size = \"480x270\", seconds = 4 }";

/// What it says of itself and its files, made once for all tests.
fn small() -> &'static (serde_json::Value, BTreeMap<String, Vec<u8>>) {
    static MADE: OnceLock<(serde_json::Value, BTreeMap<String, Vec<u8>>)> = OnceLock::new();
    MADE.get_or_init(|| {
        let dir = Dir::new();
        let report = dir.words(&format!("{SMALL} --json")).expect(0).json();
        (report, dir.bytes_of("study"))
    })
}

/// The same where a test may change it.
fn small_in(dir: &Dir) {
    small().1.iter().for_each(|(name, bytes)| dir.write(&format!("study/{name}"), bytes));
}

fn small_catalogue() -> Catalogue {
    let block = SMALL_BLOCK.parse().expect("TOML");
    phantom_catalogue(&block, experiments()).map_err(|fault| fault.what).expect("a catalogue")
}

#[test]
fn a_study_is_what_its_catalogue_says_and_what_a_pipelines_tasks_make() {
    let dir = Dir::new();
    small_in(&dir);
    let (report, written) = small();
    let catalogue = small_catalogue();
    let foreseen: Vec<&str> = catalogue.files.iter().map(|file| file.path.as_str()).collect();
    assert_eq!(written.keys().map(String::as_str).collect::<Vec<_>>(), foreseen);
    assert_eq!(report["files"], written.len());
    for (name, text) in &catalogue.tables {
        assert_eq!(written[name], text.as_bytes(), "{name}");
    }
    let stop = AtomicBool::new(false);
    for task in &catalogue.tasks {
        let folder = dir.path("tasks").join(&task.name);
        std::fs::create_dir_all(&folder).expect("a folder");
        let work = Work { inputs: Vec::new(), folder: &folder, before: None, threads: 1, stop: &stop };
        task.job.run(&work).unwrap_or_else(|why| panic!("{}: {why:#}", task.name));
    }
    let made = dir.bytes_of("tasks");
    assert_eq!(made.keys().collect::<Vec<_>>(), written.keys().collect::<Vec<_>>());
    let differ: Vec<&String> =
        made.iter().filter(|(name, bytes)| written[*name] != **bytes).map(|(name, _)| name).collect();
    assert!(differ.is_empty(), "{differ:?}");
    // Another one in the same place replaces it, and so does the same one a second time; and nothing else.
    let other =
        "phantom study --subjects 1 --sensors 1 --presses 0 --video-size 160x96 --fps 5 --seconds 1 --out study";
    dir.words(other).expect(0);
    let replaced = dir.bytes_of("study");
    assert!(dir.path("study/s01/bending/log.csv").is_file() && !dir.path("study/presses").exists());
    assert!(!replaced.keys().any(|name| name.contains("s02")), "{:?}", replaced.keys());
    dir.words(other).expect(0);
    assert_eq!(dir.bytes_of("study"), replaced);
    dir.write("study/s01/bending/joints.csv", "mine");
    dir.words(other).expect(2).says("study/s01/bending/joints.csv stands already");
    assert_eq!(dir.bytes_of("study").len(), replaced.len() + 1);
    dir.write("other/s01/mine.txt", "mine");
    let elsewhere = SMALL.replace("--out study", "--out other");
    dir.words(&elsewhere).expect(2).says("other/s01 stands already");
}

#[test]
fn every_job_reads_a_study_as_it_stands() {
    let dir = Dir::new();
    small_in(&dir);
    let sessions = dir.table("study/tables/sessions.csv");
    assert_eq!(sessions.len(), 10);
    let of =
        |kind: &str| -> Vec<&BTreeMap<String, String>> { sessions.iter().filter(|row| row["kind"] == kind).collect() };
    assert_eq!(of("touch").iter().map(|row| row["repetition"].as_str()).collect::<Vec<_>>(), ["1", "2", "3"]);
    let file = |row: &BTreeMap<String, String>, column: &str| {
        let place = format!("study/tables/{}", row[column]);
        assert!(dir.path(&place).is_file(), "{place}");
        place
    };
    for row in &sessions {
        let filmed = row["kind"].contains("bending");
        for column in ["video", "markers", "truth"] {
            assert_eq!(filmed, !row[column].is_empty(), "{column} of {}", row["session"]);
            let _ = filmed.then(|| file(row, column));
        }
        let _ = (file(row, "log"), file(row, "truth_log"));
    }

    let photos = dir.lunula(&["photos", "study/photos/photos", "--out", "maps", "--json"]);
    let photos = photos.expect(0).json();
    assert_eq!(photos["counts"]["nails_used"], 16);
    assert!(dir.table("maps/nails.csv").iter().all(|nail| nail["outline"] == "annotated"));

    for kind in ["bending", "bending-random", "free-bending"] {
        posture_and_log_agree(&dir, kind, [&file(of(kind)[0], "video"), &file(of(kind)[0], "markers")]);
    }

    let touch: Vec<String> = of("touch").into_iter().map(|row| file(row, "log")).collect();
    let train = ["train", &touch[0], &touch[1], "--validate", &touch[2], "--target", "force", "--model", "linear"];
    dir.lunula(&[&train[..], &["--out", "force.json", "--json"]].concat()).expect(0);
    let evaluated = dir.lunula(&["evaluate", "force.json", &file(of("random")[0], "log"), "--json"]).expect(0).json();
    let rmse = evaluated["rmse"]["Fx_N"].as_f64().expect("a figure");
    assert!(rmse > 0.0 && rmse <= 1.0, "{rmse}");

    let presses = dir.table("study/tables/presses.csv");
    assert_eq!(presses.len(), 4);
    for row in &presses {
        let (recording, out) = (file(row, "recording"), format!("{}-{}.json", row["site"], row["kind"]));
        let fit = ["fit", &recording, "--free", "k_C", "--params", &file(row, "truth"), "--collapse", "contact"];
        let fitted = dir.lunula(&[&fit[..], &["--no-figures", "--out", &out, "--json"]].concat()).expect(0).json();
        let text = dir.bytes_of("study/presses")[&format!("s01-{}/truth/parameters.toml", row["site"])].clone();
        let truth: toml::Table = String::from_utf8(text).expect("text").parse().expect("TOML");
        let truth = truth["k_C1_N_per_m"].as_float().expect("a number");
        let of = |what: &str| fitted["free"][0][what][0].as_f64().unwrap_or_else(|| panic!("{what}: {fitted:#}"));
        let (value, error) = (of("values"), of("standard_errors"));
        assert!((value - truth).abs() <= 4.0 * error, "{out}: {value} +- {error} and not {truth}");
    }
}

/// What the video shows is what the log's finger did, by the clock in the picture.
fn posture_and_log_agree(dir: &Dir, kind: &str, [video, markers]: [&str; 2]) {
    let of = |name: &str| format!("study/s01/{kind}/{name}");
    // The same movement twice: at the video's frames and, 30 a second, in the log's truth. Frames' times are whole
    // ticks.
    let (shown, done) = (dir.table(&of("truth/joints.csv")), dir.table(&of("truth/angles.csv")));
    assert_eq!((shown.len(), done.len()), (120, 120));
    for (shown, done) in shown.iter().zip(&done) {
        assert!((number(shown, "time_s") - number(done, "time_s")).abs() <= 1e-5);
        assert!((number(shown, "clock_s") - number(done, "clock_s")).abs() <= 1e-5);
        for joint in ["J1_deg", "J2_deg", "J3_deg"] {
            assert!((number(shown, joint) - number(done, joint)).abs() <= 2e-3, "{kind} {joint}");
        }
    }
    let joints = format!("{kind}.csv");
    dir.lunula(&["posture", video, "--markers", markers, "--out", &joints, "--json"]).expect(0);
    let squares: Vec<f64> = dir
        .table(&joints)
        .iter()
        .zip(&shown)
        .filter(|(row, _)| row["status"] == "ok")
        .map(|(row, truth)| (number(row, "J2_deg") - number(truth, "J2_deg")).powi(2))
        .collect();
    let rms = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
    assert!(squares.len() >= 100 && rms <= 0.6, "{kind}: {rms} degrees of {} frames", squares.len());
    let training = format!("{kind}-training.csv");
    let log = of("log.csv");
    dir.lunula(&["align", "--joints", &joints, "--log", &log, "--out", &training, "--json"]).expect(0);
    let record: serde_json::Value =
        serde_json::from_slice(&dir.bytes_of("study/s01")[&format!("{kind}/truth/log.json")]).expect("JSON");
    let offset_s = record["options"]["clock_offset_s"].as_f64().expect("a number");
    let certificate: serde_json::Value =
        serde_json::from_slice(&dir.bytes_of(".")[&format!("{kind}-training.sync.json")]).expect("JSON");
    let found_s = certificate["offset_s"].as_f64().expect("a number");
    assert!((found_s - offset_s).abs() <= 0.05, "{kind}: {found_s} and not {offset_s}");
}

#[test]
fn a_plan_writes_nothing_and_bad_requests_are_refused_at_once() {
    let dir = Dir::new();
    let plan = dir.words("phantom study --plan --json").expect(0).json();
    let recordings = plan["recordings"].as_array().expect("a list");
    // Photographs, six sessions of seven people and four more of one, two places of eight people, the tables.
    assert_eq!(recordings.len(), 1 + 7 * 6 + 4 + 8 * 2 + 1);
    assert_eq!(plan["options"]["subjects"], 16);
    assert!(dir.bytes_of(".").is_empty());
    dir.words("phantom study --out x --subjects 2 --sensors 3").expect(2).says("--sensors 3: there are 2");
    dir.words("phantom study --out x --video-size 3x4 --fps 0").expect(2).says("--size 3x4").says("--fps 0");
    assert!(dir.bytes_of(".").is_empty());
}
