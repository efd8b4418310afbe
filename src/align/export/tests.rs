use std::path::PathBuf;

use super::*;
use crate::align::{Posture, Tie, TieMethod};
use crate::files::Places;
use crate::timebase::Timebase;

/// Two joints, four frames, the second without J3, the third with nothing.
fn posture() -> Posture {
    let angles_deg = vec![vec![10.0, 11.5, f64::NAN, -0.000_001], vec![5.25, f64::NAN, f64::NAN, 7.0]];
    Posture {
        joints: vec!["J2".into(), "J3".into()],
        sds_deg: vec![vec![0.02, 0.03, f64::NAN, 0.02], vec![f64::NAN; 4]],
        ..Posture::of(vec![0.0, 0.033_367, 0.066_733, 0.1001], angles_deg, 0.0)
    }
}

fn tie() -> Tie {
    let timebase =
        Timebase { reference_s: 0.0, at_reference_s: 71.5, at_reference_sd_s: 1e-3, drift: 1e-3, drift_sd: 0.0 };
    Tie::of(TieMethod::Offset, timebase)
}

/// A folder to write to; one to look at, with other programs, under `LUNULA_LOOK` when that is set.
fn folder(name: &str) -> (tempfile::TempDir, PathBuf) {
    let dir = tempfile::tempdir().unwrap();
    let folder = std::env::var_os("LUNULA_LOOK").map_or_else(|| dir.path().to_owned(), PathBuf::from).join(name);
    std::fs::create_dir_all(&folder).unwrap();
    (dir, folder)
}

#[test]
fn a_motion_file_has_a_row_a_frame_on_the_logs_clock() {
    let (_dir, folder) = folder("mot");
    let path = folder.join("bend.mot");
    assert_eq!(mot(&path, &path, &posture(), &tie()).unwrap(), 2);
    assert_eq!(
        std::fs::read_to_string(&path).unwrap(),
        "bend\nversion=1\nnRows=2\nnColumns=3\ninDegrees=yes\n\nendheader\ntime\tJ2\tJ3\n71.500000\t10.00000\t5.25000\n\
         71.600200\t0.00000\t7.00000\n"
    );
    let spaced = Posture { joints: vec!["a b".into(), "a_b".into()], ..posture() };
    let error = mot(&path, &path, &spaced, &tie()).unwrap_err().to_string();
    assert!(error.contains("second column named `a_b`") && error.contains("bend.mot"), "{error}");
    let never = Posture {
        angles_deg: vec![vec![1.0, f64::NAN, 1.0, 1.0], vec![f64::NAN, 1.0, f64::NAN, f64::NAN]],
        ..posture()
    };
    assert!(
        mot(&path, &path, &never, &tie()).unwrap_err().to_string().contains("no frame has the angles of all joints")
    );
    let nowhere = folder.join("no/bend.mot");
    assert!(mot(&nowhere, &path, &posture(), &tie()).unwrap_err().to_string().contains("bend.mot: cannot be written"));
}

#[test]
fn a_bids_dataset_is_begun_and_continued() {
    let (_dir, folder) = folder("bids");
    let root = folder.join("set");
    let _ = std::fs::remove_dir_all(&root);
    let write_run = |subject: &str, session: Option<&str>, posture: &Posture, run: Option<u32>| {
        let names = BidsNames::new(Some(subject), session, "bend", "camera", run).unwrap();
        let mut places = Places::default();
        let files = bids(&mut places, &root, &names, posture, &tie())?;
        places.commit().unwrap();
        let names = files.iter().map(|f| f.strip_prefix(&root).unwrap().to_string_lossy().into_owned());
        Ok::<_, ExportError>(names.collect::<Vec<_>>())
    };
    let write =
        |subject: &str, session: Option<&str>, posture: &Posture| write_run(subject, session, posture, None).unwrap();
    let stem = "sub-01/motion/sub-01_task-bend_tracksys-camera_";
    let own = ["motion.json", "channels.tsv", "motion.tsv"];
    let mut all: Vec<String> = ["dataset_description.json", "README", "participants.tsv"].map(str::to_owned).to_vec();
    all.extend(own.map(|ending| format!("{stem}{ending}")));
    assert_eq!(write("01", None, &posture()), all);
    let text = |name: &str| std::fs::read_to_string(root.join(name)).unwrap();
    assert_eq!(
        text(&all[5]),
        "0.000000\t71.500000\t10.00000\t0.02000\t5.25000\n0.033400\t71.533400\t11.50000\t0.03000\tn/a\n\
         0.066800\t71.566800\tn/a\tn/a\tn/a\n0.100200\t71.600200\t0.00000\t0.02000\t7.00000\n"
    );
    let kinds: Vec<String> =
        text(&all[4]).lines().map(|line| line.split('\t').take(5).collect::<Vec<_>>().join(" ")).collect();
    assert_eq!(
        kinds,
        [
            "name component type tracked_point units",
            "time n/a LATENCY n/a s",
            "log_time n/a MISC n/a s",
            "J2 n/a JNTANG J2 deg",
            "J2_sd n/a MISC J2 deg",
            "J3 n/a JNTANG J3 deg"
        ]
    );
    let sidecar: serde_json::Value = serde_json::from_str(&text(&all[3])).unwrap();
    assert_eq!((&sidecar["TaskName"], &sidecar["SamplingFrequency"]), (&"bend".into(), &29.94.into()));
    assert_eq!((&sidecar["MotionChannelCount"], &sidecar["JNTANGChannelCount"]), (&5.into(), &2.into()));
    // Another participant is added to what somebody wrote meanwhile; the rest of the dataset stays.
    std::fs::write(root.join("participants.tsv"), "participant_id\tage\nsub-01\t31").unwrap();
    std::fs::write(root.join("dataset_description.json"), text("dataset_description.json").replace("finger", "thumb"))
        .unwrap();
    let second = write("02", Some("a"), &posture());
    assert_eq!(second[0], "participants.tsv");
    assert_eq!(second[3], "sub-02/ses-a/motion/sub-02_ses-a_task-bend_tracksys-camera_motion.tsv");
    assert_eq!(text("participants.tsv"), "participant_id\tage\nsub-01\t31\nsub-02\tn/a\n");
    // Angles of the same frames are written again, those of a second recording replace none.
    let other = Posture { time_s: vec![0.0, 0.05, 0.1, 0.15], ..posture() };
    let why = write_run("01", None, &other, None).unwrap_err().to_string();
    assert!(why.contains("_motion.tsv") && why.contains("--run 2"), "{why}");
    assert!(text(&all[5]).contains("\t10.00000\t"));
    let second = write_run("01", None, &other, Some(2)).unwrap();
    assert!(second.last().unwrap().ends_with("sub-01_task-bend_tracksys-camera_run-2_motion.tsv"), "{second:?}");
    // What a killed run left at the root goes, though nothing is written there.
    std::fs::write(root.join(".lunula-killed"), "half").unwrap();
    assert_eq!(write("01", None, &posture()).len(), 3, "written again: its own files only");
    assert!(!root.join(".lunula-killed").exists());
    assert!(text("dataset_description.json").contains("thumb"));
}

#[test]
fn what_bids_has_no_place_for_is_told_and_leaves_no_trace() {
    for (subject, session, entity) in [
        (Some("s 1"), None, "subject"),
        (None, None, "subject"),
        (Some("1"), Some("pre-test"), "session"),
        (Some(""), None, "subject"),
    ] {
        let error = BidsNames::new(subject, session, "bend", "camera", None).unwrap_err().to_string();
        assert!(error.contains(entity) && error.contains("letters and digits"), "{error}");
    }
    let dir = tempfile::tempdir().unwrap();
    let root = dir.path().join("a/set");
    let names = BidsNames::new(Some("01"), None, "bend", "camera", None).unwrap();
    let one = Posture { time_s: vec![0.0], ..posture() };
    let mut places = Places::default();
    let error = bids(&mut places, &root, &names, &one, &tie()).unwrap_err().to_string();
    assert!(error.contains("sampling frequency") && error.contains("sub-01"), "{error}");
    // A job that fails later.
    bids(&mut places, &root, &names, &posture(), &tie()).unwrap();
    drop(places);
    assert!(!dir.path().join("a").exists());
    std::fs::create_dir_all(&root).unwrap();
    std::fs::write(root.join("participants.tsv"), "id\n1\n").unwrap();
    let error = bids(&mut Places::default(), &root, &names, &posture(), &tie()).unwrap_err().to_string();
    assert!(error.contains("participants.tsv: has no column `participant_id`"), "{error}");
}

#[test]
fn markers_become_a_table_of_deeplabcut() {
    let (_dir, folder) = folder("dlc");
    let (tracks, path) = (folder.join("tracks.csv"), folder.join("markers.csv"));
    std::fs::write(
        &tracks,
        "frame,time_s,marker,x_px,y_px,sd_px,status\n0,0,tip,10.5,20.25,0.02,ok\n0,0,\"a, \
         b\",1,2,1,ok\n1,0.03,tip,,,,lost: hidden\n\
         1,0.03,\"a, b\",1.5,2,,ok\n5,0.2,tip,11,21,0.5,ok\n",
    )
    .unwrap();
    // A part of the angles is of the same video, a frame more is of another.
    let of_frames = |time_s: Vec<f64>| Posture { time_s, ..posture() };
    let posture = of_frames(vec![0.0, 0.03]);
    dlc(&path, &path, &tracks, &posture).unwrap();
    let error = dlc(&path, &path, &tracks, &of_frames(vec![0.0, 0.03, 0.1])).unwrap_err().to_string();
    assert!(error.contains("has no frame at 0.1 s, and joints.csv has"), "{error}");
    assert_eq!(
        std::fs::read_to_string(&path).unwrap(),
        "scorer,lunula,lunula,lunula,lunula,lunula,lunula\n\
         bodyparts,tip,tip,tip,\"a, b\",\"a, b\",\"a, b\"\n\
         coords,x,y,likelihood,x,y,likelihood\n\
         0,10.5000,20.2500,1.0000,1.0000,2.0000,0.3935\n\
         1,,,0.0000,1.5000,2.0000,\n\
         5,11.0000,21.0000,0.8647,,,0.0000\n"
    );
    let (tracks, path) = (folder.join("wrong.csv"), folder.join("none.csv"));
    for (text, words) in [
        ("frame,marker,x_px,y_px\n0,tip,1,2\n0,tip,1,3\n", "wrong.csv:3: column `marker`: `tip` is in frame 0 twice"),
        ("frame,marker,x_px,y_px\n,tip,1,2\n", "wrong.csv:2: column `frame`: is empty"),
        ("frame,x_px,y_px\n0,1,2\n", "has no column `marker`"),
    ] {
        std::fs::write(&tracks, text).unwrap();
        let error = dlc(&path, &path, &tracks, &posture).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
    std::fs::write(&tracks, "frame,marker,x_px,y_px\n").unwrap();
    dlc(&path, &path, &tracks, &posture).unwrap();
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "scorer\nbodyparts\ncoords\n");
}
