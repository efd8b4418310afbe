//! `lunula run` on photographs, videos and logs.

use lunula::phantom::Generated as _;
use lunula::phantom::log::LogOptions;
use lunula::phantom::nail::Pose;
use lunula::phantom::photos::PhotoOptions;
use lunula::phantom::screen::Clock;
use lunula::phantom::trajectory::Trajectory;
use lunula::phantom::video::VideoOptions;

use crate::util::{Answer, Dir};

const COLORATION: &str = r#"
wanted = ["coloration", "coloration.figures"]

[inputs.photos]
files = "photos/{pose}/{subject}.png"

[stage.nails]
job = "normalize"
photo = "photos"

[stage.coloration]
job = "maps"
sums = "nails"
"#;

/// Five subjects in two poses; all but the first `there` are put aside.
fn photographs(dir: &Dir, there: usize) {
    let options = PhotoOptions {
        subjects: 5,
        poses: vec![Pose::Nominal, Pose::Flexion],
        width: 320,
        height: 240,
        truth_normalized: false,
        ..PhotoOptions::default()
    };
    options.write(&dir.path("")).expect("photographs");
    (there + 1..=5).for_each(|subject| take(dir, subject, "photos", "aside"));
}

/// Moves the photographs of a subject.
fn take(dir: &Dir, subject: usize, from: &str, to: &str) {
    for pose in ["nominal", "flexion"] {
        for ending in ["png", "json"] {
            let name = format!("{pose}/s{subject:02}.{ending}");
            std::fs::rename(dir.path(&format!("{from}/{name}")), dir.place(&format!("{to}/{name}"))).expect("moved");
        }
    }
}

/// What a run did: done, kept, failed.
fn counts(answer: &Answer) -> [u64; 3] {
    let counted = answer.json();
    ["done", "kept", "failed"].map(|key| counted[key].as_u64().expect("a count"))
}

fn results(dir: &Dir, out: &str, stage: &str) -> std::collections::BTreeMap<String, Vec<u8>> {
    dir.bytes_of(&format!("{out}/{stage}"))
}

#[test]
fn one_subject_more_touches_that_subject_and_the_maps() {
    let dir = Dir::new();
    photographs(&dir, 4);
    dir.write("coloration.toml", COLORATION);
    let run = |out: &str| dir.lunula(&["run", "coloration.toml", "--out", out, "--json"]).expect(0);
    assert_eq!(counts(&run("out")), [5, 0, 0]);
    assert_eq!(counts(&run("out")), [0, 5, 0]);
    take(&dir, 5, "aside", "photos");
    let more = run("out");
    assert_eq!(counts(&more), [2, 4, 0]);
    let stands = more.json().to_string();
    assert!(stands.contains("sums: 8 are part of the maps made before"), "{stands}");
    assert_eq!(counts(&run("afresh")), [6, 0, 0]);
    for stage in ["nails", "coloration"] {
        let (added, afresh) = (results(&dir, "out", stage), results(&dir, "afresh", stage));
        assert!(added.len() > 5 && added == afresh, "{stage}");
    }
    // The very maps of the command.
    dir.lunula(&["photos", "photos", "--out", "at-once", "-q"]).expect(0);
    let at_once = dir.bytes_of("at-once/maps");
    let maps = results(&dir, "out", "coloration/maps");
    assert!(at_once.len() == 8 && at_once == maps, "{:?} {:?}", at_once.keys(), maps.keys());
}

#[test]
fn a_redrawn_outline_is_noticed() {
    let dir = Dir::new();
    photographs(&dir, 2);
    dir.write("coloration.toml", COLORATION);
    let run = || dir.lunula(&["run", "coloration.toml", "--out", "out", "--json"]).expect(0);
    assert_eq!(counts(&run()), [3, 0, 0]);
    let outline = dir.path("photos/nominal/s01.json");
    let text = std::fs::read_to_string(&outline).unwrap();
    std::fs::write(&outline, format!("{text} ")).unwrap();
    // The same nail: what comes after stands.
    assert_eq!(counts(&run()), [1, 2, 0]);
    std::fs::remove_file(&outline).unwrap();
    assert_eq!(counts(&run()), [2, 1, 0]);
    let nails = dir.text("out/coloration/nails.csv");
    assert_eq!(nails.matches(",detected,").count(), 1, "{nails}");
}

const TRAINING: &str = r#"
wanted = ["sets"]

[inputs.bending]
table = "sessions.csv"

[stage.angles]
job = "posture"
video = "bending.video"
markers = "bending.markers"
truth = "bending.truth"

[stage.labels]
job = "align"
joints = "angles"
log = "bending.log"

[stage.sets]
job = "join"
sets = "labels"
"#;

/// A filmed finger with a clock, and its log.
fn recording(dir: &Dir, name: &str, seed: u64) {
    let trajectory = Trajectory::Eq27 { hz: 0.4 };
    let clock = Clock { offset_s: 60.0 + 100.0 * seed as f64, ..Clock::default() };
    let log = LogOptions {
        seed,
        seconds: 2.0,
        trajectory: trajectory.clone(),
        clock_offset_s: clock.offset_s,
        ..LogOptions::default()
    };
    let video = VideoOptions { seed, seconds: 2.0, trajectory, clock: Some(clock), ..VideoOptions::sized(640, 360) };
    let folder = dir.path(name);
    video.write(&folder).expect("a video");
    log.write(&folder).expect("a log");
}

#[test]
fn videos_and_logs_become_labelled_sets() {
    let dir = Dir::new();
    let mut table = "subject,session,video,markers,log,truth,take\n".to_owned();
    for (k, name) in ["a", "b"].into_iter().enumerate() {
        recording(&dir, name, k as u64 + 1);
        table += &format!("S01,1,{name}/video.mp4,{name}/markers.toml,{name}/log.csv,{name}/truth/joints.csv,{name}\n");
    }
    dir.write("sessions.csv", table);
    dir.write("training.toml", TRAINING);
    let answer = dir.lunula(&["run", "training.toml", "--out", "out", "--json"]).expect(0);
    assert_eq!(counts(&answer), [5, 0, 0]);
    let stages = answer.json()["stages"].to_string();
    assert!(stages.contains("degrees RMS") && stages.contains("standard error of the label"), "{stages}");
    let sets = results(&dir, "out", "sets");
    assert_eq!(sets.len(), 1, "{:?}", sets.keys());
    let text = String::from_utf8(sets.into_values().next().unwrap()).unwrap();
    assert!(text.lines().filter(|line| line.contains(",ok,S01,1,ok")).count() > 40, "{text}");
}
