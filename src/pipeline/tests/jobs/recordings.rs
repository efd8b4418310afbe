//! `posture`, `align`, `join`.

use super::*;
use crate::align::{AlignJob, JoinJob};
use crate::job::Job as _;
use crate::phantom::Generated as _;
use crate::phantom::log::LogOptions;
use crate::phantom::screen::Clock;
use crate::phantom::trajectory::Trajectory;
use crate::phantom::video::VideoOptions;
use crate::posture::PostureJob;

const OF: [(&str, &str); 2] = [("subject", "S01"), ("session", "1")];

/// A second and a half of a bending finger with a clock.
fn filmed() -> TempDir {
    let dir = tempfile::tempdir().expect("a folder");
    let options = VideoOptions {
        seconds: 1.5,
        trajectory: Trajectory::Eq27 { hz: 0.5 },
        clock: Some(Clock::default()),
        ..VideoOptions::sized(640, 360)
    };
    options.write(dir.path()).expect("a video");
    dir
}

fn posture(root: &Path, options: &'static str, demand: Demand) -> Task<'static> {
    let inputs = ["video", "markers", "truth"].into_iter().zip(["video.mp4", "markers.toml", "truth/joints.csv"]);
    let inputs = inputs.map(|(role, name)| at(role, &OF, root, name)).collect();
    Task { kind: &PostureJob::KIND, options, demand, keys: keys(&OF), inputs }
}

#[test]
fn a_video_s_results_are_the_same_anywhere() {
    let dir = filmed();
    let parts = ["joints", "tracks", "overlay", "pictures"];
    let task = posture(dir.path(), "format = 'parquet'\nsmooth = true", wanting(&parts));
    let (folder, _) = is_the_same_anywhere(&task, dir.path());
    has_its_parts(&PostureJob::KIND, task.options, &task.demand, &folder);

    let task = posture(dir.path(), "joints = ['J2', 'J3']", wanting(&["joints"]));
    let (folder, made) = is_the_same_anywhere(&task, dir.path());
    assert_eq!(folder.names(), ["joints.csv"]);
    has_its_parts(&PostureJob::KIND, task.options, &task.demand, &folder);
    assert!(folder.text("joints.csv").starts_with("frame,time_s,clock_s,J2_deg,J2_sd_deg,J3_deg,"));
    let quality: Vec<(&str, bool)> = made.quality.iter().map(|q| (q.what.as_str(), q.against_truth)).collect();
    assert_eq!(quality, [("J2", true), ("J3", true)]);
    assert!(made.quality.iter().all(|q| q.value <= 0.5), "{:?}", made.quality);
}

#[test]
fn joints_and_clock_are_measured_as_far_as_they_are_needed() {
    let dir = filmed();
    let demand = Demand { joints: Some(["J2".to_owned()].into()), clock: false, ..wanting(&["joints"]) };
    let task = posture(dir.path(), "", demand.clone());
    let (folder, made) = task.run(2, None);
    assert!(folder.text("joints.csv").starts_with("frame,time_s,clock_s,J2_deg,J2_sd_deg,status\n"));
    assert!(made.left_out.iter().any(|what| what.starts_with("clock: ")), "{:?}", made.left_out);
    assert!(made.left_out.iter().any(|what| what.contains("no wanted joint needs")), "{:?}", made.left_out);

    let prepared = prepared(&PostureJob::KIND, "");
    assert_ne!(prepared.depends_on(&demand), prepared.depends_on(&wanting(&["joints"])));
    let seen = |stands| task.inputs.iter().map(|input| foreseen(input, stands, Facts::default())).collect::<Vec<_>>();
    for inputs in [seen(true), seen(false)] {
        let steps = prepared.steps(&inputs, &demand).unwrap();
        assert!(!step(&steps, "clock").0 && !step(&steps, "overlay").0 && !step(&steps, "figures").0);
        assert_eq!(prepared.facts(&inputs, &demand).clock, Some(false));
    }
    let steps = prepared.steps(&seen(true), &wanting(&["joints"])).unwrap();
    assert!(step(&steps, "clock").0 && !step(&steps, "lens correction").0);
    assert_eq!(prepared.facts(&seen(true), &wanting(&["joints"])).clock, Some(true));
    let straight = Facts { distorted: Some(false), clock: Some(false), ..Facts::default() };
    let to_be: Vec<_> = task.inputs.iter().map(|input| foreseen(input, false, straight)).collect();
    let steps = prepared.steps(&to_be, &wanting(&["joints"])).unwrap();
    assert_eq!(step(&steps, "clock"), (false, "no [clock]"));
    assert_eq!(step(&steps, "lens correction"), (false, "no [camera]"));
    let (memory, seconds) = prepared.cost(&seen(true));
    assert!(memory > 1 << 20 && seconds > 0.0);

    let unknown = posture(dir.path(), "joints = ['PIP']", wanting(&["joints"])).try_run(1, None).err().unwrap();
    assert!(unknown.to_string().contains("no joint `PIP`"), "{unknown}");
}

/// A log of twelve seconds with its exact angles.
fn logged(seed: u64, led: bool) -> TempDir {
    let dir = tempfile::tempdir().expect("a folder");
    let trajectory = Trajectory::Eq27 { hz: 0.3 };
    LogOptions { seed, led, trajectory, ..LogOptions::default() }.write(dir.path()).expect("a log");
    let tracks = "frame,marker,x_px,y_px,sd_px,status\n0,tip,10.5,20.25,0.02,ok\n";
    fs::write(dir.path().join("tracks.csv"), tracks).expect("a table");
    dir
}

fn align(root: &Path, options: &'static str, parts: &[&'static str]) -> Task<'static> {
    let roles = ["joints", "log", "tracks", "truth"];
    let names = ["truth/angles.csv", "log.csv", "tracks.csv", "truth/log.csv"];
    let inputs = roles.into_iter().zip(names).map(|(role, name)| at(role, &OF, root, name)).collect();
    Task { kind: &AlignJob::KIND, options, demand: wanting(parts), keys: keys(&OF), inputs }
}

#[test]
fn a_labelled_set_is_the_same_anywhere() {
    let dir = logged(1, true);
    let parts = ["training", "certificate", "mot", "bids", "dlc", "pictures"];
    for options in ["sync = 'offset=60+-0.01'", "format = 'parquet'"] {
        let task = align(dir.path(), options, &parts);
        let (folder, made) = is_the_same_anywhere(&task, dir.path());
        has_its_parts(&AlignJob::KIND, options, &task.demand, &folder);
        let truth: Vec<_> = made.quality.iter().filter(|q| q.against_truth).collect();
        assert_eq!(truth.iter().map(|q| q.what.as_str()).collect::<Vec<_>>(), ["J1", "J2", "J3"], "{options}");
        // The angles are exact; what is left is their interpolation between frames.
        assert!(truth.iter().all(|q| q.value <= 0.02), "{options}: {truth:?}");
    }
    let task = align(dir.path(), "", &["training"]);
    let (folder, _) = task.run(1, None);
    assert_eq!(folder.names(), ["training.csv", "training.sync.json"]);
    assert!(folder.text("training.csv").lines().nth(30).unwrap().ends_with(",ok,S01,1,ok"));
    let named = align(dir.path(), "subject = 'X'\nsession = 'Y'", &["training"]).run(1, None).0;
    assert!(named.text("training.csv").lines().nth(30).unwrap().ends_with(",ok,X,Y,ok"));
}

#[test]
fn an_offset_that_is_known_needs_no_clock_and_a_lag_all_joints() {
    let own = Demand { joints: Some(["J2".to_owned()].into()), ..wanting(&["training"]) };
    let of_joints = |options: &str| prepared(&AlignJob::KIND, options).demand("joints", &own);
    let clock = of_joints("");
    assert_eq!((clock.clock, &clock.joints, clock.parts.contains("joints")), (true, &own.joints, true));
    assert_eq!((of_joints("sync = 'offset=60'").clock, of_joints("sync = 'clock'").clock), (false, true));
    let lag = of_joints("sync = 'correlate'");
    assert_eq!((lag.clock, lag.joints), (false, None));
    let dlc = prepared(&AlignJob::KIND, "").demand("tracks", &wanting(&["dlc"]));
    assert!(dlc.parts.contains("tracks") && prepared(&AlignJob::KIND, "").demand("tracks", &own).parts.is_empty());
}

#[test]
fn the_plan_leaves_out_what_a_log_does_not_need() {
    let dir = logged(1, false);
    let task = align(dir.path(), "sync = 'offset=60'", &["training"]);
    let prepared = prepared(&AlignJob::KIND, task.options);
    let seen = |stands, facts| task.inputs.iter().map(|input| foreseen(input, stands, facts)).collect::<Vec<_>>();
    let unlit = Facts { led: Some(false), ..Facts::default() };
    for inputs in [seen(true, Facts::default()), seen(false, unlit)] {
        let steps = prepared.steps(&inputs, &task.demand).unwrap();
        assert!(!step(&steps, "ambient light subtracted").0);
        assert_eq!(step(&steps, "clock in the picture"), (false, "--sync names another tie"));
        assert!(!step(&steps, "figures").0 && !step(&steps, "DeepLabCut table").0);
    }
    let lit = seen(false, Facts { led: Some(true), clock: Some(true), forces: Some(true), ..Facts::default() });
    let steps = super::prepared(&AlignJob::KIND, "").steps(&lit, &task.demand).unwrap();
    assert!(step(&steps, "ambient light subtracted").0 && step(&steps, "clock in the picture").0);
    assert_eq!(prepared.facts(&lit, &task.demand).forces, Some(true));
    assert_eq!(prepared.facts(&seen(true, Facts::default()), &task.demand).forces, Some(true));
}

#[test]
fn a_stage_s_wrong_values_name_their_key() {
    for (kind, options, key, words) in [
        (&AlignJob::KIND, "sync = 'now'", "sync", "offset=SECONDS"),
        (&AlignJob::KIND, "columns = 'Q1=x'", "columns", "`Q1` is none of"),
        (&AlignJob::KIND, "max_gap = -1", "max_gap", "at least 0"),
        (&AlignJob::KIND, "format = 'xlsx'", "format", "csv, parquet"),
    ] {
        let fault = (kind.prepare)(&options.parse().unwrap()).err().unwrap();
        assert_eq!(fault.key, key);
        assert!(fault.what.contains(words), "{}", fault.what);
    }
}

#[test]
fn one_set_is_passed_on_and_several_are_joined() {
    let dir = tempfile::tempdir().unwrap();
    let (one, two) = (logged(1, true), logged(2, true));
    let first = align(one.path(), "sync = 'offset=60'", &["training"]).run(1, None).0;
    let second = align(two.path(), "sync = 'offset=60'\nsession = '2'", &["training"]).run(1, None).0;
    copy(first.path(), &dir.path().join("first"));
    copy(second.path(), &dir.path().join("second"));
    let set = |name: &str| at("sets", &OF, dir.path(), &format!("{name}/training.csv"));
    let task = |names: &[&str], options: &'static str| {
        let inputs = names.iter().map(|name| set(name)).collect();
        Task { kind: &JoinJob::KIND, options, demand: wanting(&["training"]), keys: keys(&OF), inputs }
    };
    let alone = task(&["first"], "");
    let (folder, made) = is_the_same_anywhere(&alone, dir.path());
    assert_eq!(folder.bytes()["training.csv"], first.bytes()["training.csv"]);
    assert_eq!(made.left_out, ["sets joined: one video, whose set is passed on"]);
    let (folder, _) = is_the_same_anywhere(&task(&["second", "first"], ""), dir.path());
    let rest = second.text("training.csv");
    let (_, rows) = rest.split_once('\n').unwrap();
    assert_eq!(folder.text("training.csv"), first.text("training.csv") + rows);
    let both = task(&["second", "first"], "format = 'parquet'");
    let (folder, _) = is_the_same_anywhere(&both, dir.path());
    has_its_parts(&JoinJob::KIND, both.options, &both.demand, &folder);
    let twice = task(&["first", "first"], "").try_run(1, None).err().unwrap().to_string();
    assert!(twice.contains("overlap"), "{twice}");

    let prepared = prepared(&JoinJob::KIND, "");
    let plan = |task: &Task| {
        let inputs: Vec<_> = task.inputs.iter().map(|input| foreseen(input, false, Facts::default())).collect();
        prepared.steps(&inputs, &task.demand).unwrap()
    };
    assert_eq!(step(&plan(&alone), "sets joined"), (false, "one video: its set is passed on"));
    assert_eq!(step(&plan(&both), "sets joined"), (true, "2 sets"));
}
