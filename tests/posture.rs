//! `lunula posture` from end to end on generated videos: tables, times, names, accuracy, and what is left out.

use std::collections::BTreeMap;

use crate::util::{Answer, Dir, Json, known};

type Rows = Vec<BTreeMap<String, String>>;

/// A video of `lunula phantom video` in `scene/`: 640 x 360, 2 s of bending at 0.5 Hz.
fn scene(more: &[&str]) -> Dir {
    scene_of("2", more)
}

fn scene_of(seconds: &str, more: &[&str]) -> Dir {
    let dir = Dir::new();
    let few = "phantom video --out scene --seed 5 --size 640x360 --bend-hz 0.5 --seconds";
    dir.lunula(&[&few.split(' ').collect::<Vec<_>>()[..], &[seconds], more].concat()).expect(0);
    dir
}

fn posture(dir: &Dir, more: &[&str]) -> Answer {
    let given = ["posture", "scene/video.mp4", "--markers", "scene/markers.toml", "--out", "joints.csv"];
    dir.lunula(&[&given[..], more].concat())
}

/// Root mean square of a joint's error over the rows that have its angle, and how many these are.
fn rms(found: &Rows, truth: &Rows, joint: &str) -> (f64, usize) {
    assert_eq!(found.len(), truth.len(), "a row a frame");
    let column = format!("{joint}_deg");
    let errors: Vec<f64> =
        found.iter().zip(truth).filter_map(|(f, t)| Some(known(f, &column)? - known(t, &column)?)).collect();
    ((errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt(), errors.len())
}

/// The largest RMS error that a small clean scene may have, degrees; the book has the figures of the large
/// ones.
const CLEAN_RMS_DEG: [(&str, f64); 3] = [("J1", 0.15), ("J2", 0.25), ("J3", 0.5)];

#[track_caller]
fn is_accurate(dir: &Dir, joints: &[&str]) {
    let (found, truth) = (dir.table("joints.csv"), dir.table("scene/truth/joints.csv"));
    for (joint, bound) in CLEAN_RMS_DEG.iter().filter(|(joint, _)| joints.contains(joint)) {
        let (error, count) = rms(&found, &truth, joint);
        assert_eq!(count, truth.len(), "{joint} in every frame");
        assert!(error <= *bound, "{joint}: {error} degrees RMS");
    }
}

#[test]
fn a_clean_scene_gives_every_angle_with_its_time() {
    let dir = scene(&[]);
    let report = posture(&dir, &["--tracks", "tracks.csv", "--json"]).expect(0).json();
    is_accurate(&dir, &["J1", "J2", "J3"]);
    let header = dir.text("joints.csv");
    assert_eq!(
        header.lines().next(),
        Some("frame,time_s,clock_s,J1_deg,J1_sd_deg,J2_deg,J2_sd_deg,J3_deg,J3_sd_deg,status")
    );
    let (found, truth) = (dir.table("joints.csv"), dir.table("scene/truth/joints.csv"));
    for (index, (row, exact)) in found.iter().zip(&truth).enumerate() {
        assert_eq!(row["frame"], index.to_string());
        assert!((known(row, "time_s").unwrap() - known(exact, "time_s").unwrap()).abs() <= 1e-4);
        assert_eq!((row["clock_s"].as_str(), row["status"].as_str()), ("", "ok"));
    }
    let tracks = dir.table("tracks.csv");
    assert_eq!(tracks.len(), 8 * found.len(), "eight markers a frame");
    assert_eq!(report["frames"]["all"], found.len());
    assert_eq!(report["frames"]["complete"], found.len());
    assert!(report["decoding_share"].as_f64().is_some_and(|share| share > 0.0 && share < 1.0));
    for name in
        ["joints.run.json", "joints-angles.png", "joints-angles.svg", "joints-coupling.png", "joints-coupling.svg"]
    {
        assert!(dir.path(name).is_file(), "{name}");
    }
}

#[test]
fn markers_of_one_colour_keep_their_names() {
    for more in [["--colours", "red"], ["--colours", "distinct"], ["--layout", "joints"]] {
        let dir = scene(&more);
        posture(&dir, &["--tracks", "tracks.csv"]).expect(0);
        is_accurate(&dir, &["J1", "J2", "J3"]);
        let (found, truth) = (dir.table("tracks.csv"), dir.table("scene/truth/tracks.csv"));
        for (row, exact) in found.iter().zip(&truth) {
            assert_eq!((&row["frame"], &row["marker"]), (&exact["frame"], &exact["marker"]));
            let off = ["x_px", "y_px"].map(|c| known(row, c).unwrap() - known(exact, c).unwrap());
            assert!(off[0].hypot(off[1]) <= 1.0, "{more:?}: frame {} {}: {off:?}", row["frame"], row["marker"]);
        }
    }
}

#[test]
fn a_joint_alone_is_as_good_and_its_own_markers_only_are_tracked() {
    let dir = scene(&[]);
    let report = posture(&dir, &["--no-figures", "--json"]).expect(0).json();
    assert!(report["coupling"]["slope"].as_f64().is_some(), "the line is reported without its picture: {report}");
    let report = posture(&dir, &["--joints", "J2", "--tracks", "tracks.csv", "--json"]).expect(0).json();
    is_accurate(&dir, &["J2"]);
    let rows = dir.table("joints.csv");
    assert!(!rows[0].contains_key("J1_deg") && !rows[0].contains_key("J3_deg"));
    assert_eq!(dir.table("tracks.csv").len(), 4 * rows.len());
    let left_out = report["left_out"].to_string();
    for marker in ["hand_prox", "distal_dist"] {
        assert!(left_out.contains(marker), "{left_out}");
    }
}

#[test]
fn a_hidden_marker_gives_no_angle() {
    let dir = scene(&["--hide", "middle_dist@20+8"]);
    posture(&dir, &["--tracks", "tracks.csv"]).expect(0);
    let (found, tracks) = (dir.table("joints.csv"), dir.table("scene/truth/tracks.csv"));
    let mut hidden = 0;
    for exact in tracks.iter().filter(|t| t["status"] == "hidden") {
        let row = &found[exact["frame"].parse::<usize>().unwrap()];
        assert_eq!((row["J2_deg"].as_str(), row["J3_deg"].as_str(), row["J3_sd_deg"].as_str()), ("", "", ""));
        assert_eq!(row["status"], "lost: middle_dist");
        assert_ne!(row["J1_deg"], "", "no marker of J1 is hidden");
        hidden += 1;
    }
    assert!(hidden >= 8, "the scene hides it for eight frames");
    assert_eq!(found[59]["status"], "ok", "it is found again");
}

#[test]
fn times_are_the_containers_at_a_variable_rate() {
    let dir = scene(&["--vfr"]);
    posture(&dir, &[]).expect(0);
    let (found, truth) = (dir.table("joints.csv"), dir.table("scene/truth/joints.csv"));
    assert_eq!(found.len(), truth.len());
    let times: Vec<f64> = found.iter().map(|row| known(row, "time_s").unwrap()).collect();
    for (time, exact) in times.iter().zip(&truth) {
        assert!((time - known(exact, "time_s").unwrap()).abs() <= 1e-4);
    }
    let intervals: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    assert!(intervals.iter().any(|i| (i - intervals[0]).abs() > 1e-3), "the rate varies");
}

/// Angles with the marker file as it is, and with that of a person who leaves these lines out.
fn with_and_without(dir: &Dir, key: &str) -> [Rows; 2] {
    posture(dir, &["--no-figures"]).expect(0);
    let as_it_is = dir.table("joints.csv");
    let file = dir.text("scene/markers.toml");
    assert!(file.contains(key), "{file}");
    let left: Vec<&str> = file.lines().filter(|line| !line.starts_with(key)).collect();
    dir.write("scene/markers.toml", left.join("\n"));
    posture(dir, &["--no-figures"]).expect(0);
    [as_it_is, dir.table("joints.csv")]
}

#[test]
fn a_rolling_shutter_is_undone_also_where_the_picture_is_turned() {
    for rotate in ["0", "90", "180"] {
        let dir = scene_of("1", &["--trajectory", "random", "--readout", "25", "--rotate", rotate]);
        let truth = dir.table("scene/truth/joints.csv");
        let [undone, left] = with_and_without(&dir, "readout_ms");
        assert_eq!((undone[1]["status"].starts_with("lost"), undone[2]["status"].as_str()), (true, "ok"));
        for (joint, bound) in CLEAN_RMS_DEG {
            let [(undone, count), (left, _)] = [&undone, &left].map(|found| rms(found, &truth, joint));
            assert_eq!(count, truth.len() - 2, "{joint}: the first two frames have none before");
            assert!(undone <= bound && left > 2.0 * undone, "{rotate} {joint}: {undone}, left {left} degrees RMS");
        }
    }
}

#[test]
fn how_long_a_shutter_rolls_is_measured_and_warned_of_where_the_file_does_not_say() {
    let dir = scene_of("5", &["--trajectory", "random", "--readout", "16"]);
    let measured = || {
        let answer = posture(&dir, &["--no-figures", "--json"]).expect(0);
        let all: Vec<f64> = answer.json()["readout_ms"].list().iter().map(Json::number).collect();
        (all[0], all[1], answer.stderr.contains("as under a rolling shutter") || answer.stderr.contains("does not fit"))
    };
    let (ms, sd_ms, warned) = measured();
    assert!((ms - 16.0).abs() <= 2.0 && sd_ms <= 2.0 && !warned, "{ms} {sd_ms} {warned}");
    let file = dir.text("scene/markers.toml");
    dir.write("scene/markers.toml", file.replace("readout_ms = 16.0\n", ""));
    let (ms, sd_ms, warned) = measured();
    assert!((ms - 16.0).abs() <= 2.0 && sd_ms <= 2.0 && warned, "{ms} {sd_ms} {warned}");
    dir.write("scene/markers.toml", file.replace("readout_ms = 16.0\n", "readout_ms = 30\n"));
    let (ms, _, warned) = measured();
    assert!((ms - 16.0).abs() <= 2.0 && warned, "{ms} {warned}");
}

#[test]
fn a_clock_in_lower_rows_and_on_a_late_display_counts_as_it_does() {
    let clock =
        ["--vfr", "--clock", "mm:ss.tt", "--clock-roi", "20,300,150,40", "--readout", "20", "--clock-delay", "45"];
    let dir = scene(&clock);
    let truth = dir.table("scene/truth/joints.csv");
    let worst = |found: &Rows| {
        let off = found
            .iter()
            .zip(&truth)
            .map(|(row, exact)| known(row, "clock_s").unwrap() - known(exact, "clock_s").unwrap());
        off.fold(0.0, |worst: f64, off| if off.abs() > worst.abs() { off } else { worst })
    };
    let [known_delay, left] = with_and_without(&dir, "delay_ms");
    assert!(worst(&known_delay).abs() <= 0.005, "{}", worst(&known_delay));
    assert!((worst(&left) + 0.045).abs() <= 0.005, "a display's delay is not seen: {}", worst(&left));
    // Between two numbers: the middle, and both ends in the interval.
    let file = dir.text("scene/markers.toml").replace("[clock]", "[clock]\ndelay_ms = [30, 60]");
    dir.write("scene/markers.toml", file);
    let [between, left] = with_and_without(&dir, "readout_ms");
    // The clock's middle is in row 319.5 of 0 to 359.
    assert!((worst(&left) - 0.0178).abs() <= 0.005, "later than the first row: {}", worst(&left));
    for (row, exact) in between.iter().zip(&truth) {
        let [low, exact, high] = [known(row, "clock_low_s"), known(exact, "clock_s"), known(row, "clock_high_s")];
        assert!(low < exact && exact < high && high.unwrap() - low.unwrap() >= 0.03, "{low:?} {exact:?} {high:?}");
        let sd_s = known(row, "clock_sd_s").unwrap();
        assert!((0.0086..0.0105).contains(&sd_s), "{sd_s}: 30 ms of a uniform distribution");
    }
}

#[test]
fn hdr_has_the_angles_and_colours_of_ordinary_video() {
    let suggested = |more: &[&str]| {
        let dir = scene_of("1", &[&["--colours", "distinct"], more].concat());
        let suggested = dir.lunula(&["posture", "scene/video.mp4", "--suggest"]).expect(0).stdout;
        let colour = |line: &str| line.split_once(" = \"#").map(|(_, hex)| hex[..6].to_owned());
        let colours: Vec<_> = suggested.lines().filter_map(colour).collect();
        (dir, colours)
    };
    let (_, ordinary) = suggested(&[]);
    // Measured 0.13, 0.22, 0.41 and 0.22, 0.32, 0.56 degrees.
    for (matrix, name, bounds) in
        [("hlg", "HDR (hybrid log-gamma)", [0.15, 0.35, 0.55]), ("pq", "HDR (perceptual quantizer)", [0.28, 0.45, 0.7])]
    {
        let (dir, colours) = suggested(&["--matrix", matrix, "--depth", "10"]);
        // The marker file has the colours of ordinary video.
        posture(&dir, &["--overlay", "drawn.mp4", "--json"]).expect(0).prints(name);
        let (found, truth) = (dir.table("joints.csv"), dir.table("scene/truth/joints.csv"));
        for (joint, bound) in ["J1", "J2", "J3"].into_iter().zip(bounds) {
            // Cyan paint, as bright as skin, is lost in two frames of hybrid log-gamma: HDR's chroma is coarser.
            let (error, count) = rms(&found, &truth, joint);
            println!("{matrix} {joint}: {error} degrees in {count} of {} frames", truth.len());
            assert!(error <= bound && count + 2 >= truth.len(), "{matrix} {joint}: {error}, {count} frames");
        }
        let level = |hex: &str, k: usize| i32::from_str_radix(&hex[2 * k..2 * k + 2], 16).expect("a colour");
        let is_near = |a: &str, b: &str| (0..3).all(|k| (level(a, k) - level(b, k)).abs() <= 24);
        println!("{matrix}: {colours:?} {ordinary:?}");
        assert_eq!(colours.len(), ordinary.len(), "{matrix}: {colours:?} {ordinary:?}");
        for colour in &colours {
            assert!(ordinary.iter().any(|one| is_near(one, colour)), "{matrix}: {colour} {ordinary:?}");
        }
        // What is drawn on is ordinary video.
        let info = |name: &str| lunula::video::Video::open(&dir.path(name), 1).expect("a video").info().clone();
        let (drawn, filmed) = (info("drawn.mp4"), info("scene/video.mp4"));
        assert!(drawn.hdr.is_none() && filmed.hdr.is_some());
        assert_eq!(drawn.matrix, filmed.matrix);
    }
}

#[test]
fn an_overlay_has_a_frame_for_each_frame() {
    let dir = scene(&["--vfr"]);
    posture(&dir, &["--overlay", "drawn.mp4"]).expect(0);
    let times = |name: &str| -> Vec<f64> {
        let mut video = lunula::video::Video::open(&dir.path(name), 2).expect("a video");
        let mut times = Vec::new();
        while let Some(item) = video.next_item().expect("frames") {
            let lunula::video::Item::Frame(frame) = item else { panic!("every frame is there") };
            times.push(frame.time_s);
        }
        times
    };
    let (drawn, given) = (times("drawn.mp4"), times("scene/video.mp4"));
    assert_eq!(drawn.len(), given.len());
    assert!(drawn.iter().zip(&given).all(|(a, b)| (a - b).abs() <= 1e-3));
}

#[test]
fn smoothing_fills_nothing_and_does_better() {
    let dir = scene(&["--noise", "6", "--crf", "28", "--hide", "proximal_dist@30+6"]);
    let truth = dir.table("scene/truth/joints.csv");
    posture(&dir, &[]).expect(0);
    let raw = dir.table("joints.csv");
    posture(&dir, &["--smooth"]).expect(0);
    let smooth = dir.table("joints.csv");
    for (a, b) in raw.iter().zip(&smooth) {
        assert_eq!(a["J2_deg"].is_empty(), b["J2_deg"].is_empty(), "frame {}", a["frame"]);
    }
    assert!(rms(&smooth, &truth, "J3").0 < rms(&raw, &truth, "J3").0);
}

#[test]
fn reversed_flexion_is_warned_of_before_all_else() {
    let dir = scene(&[]);
    let report = posture(&dir, &["--no-figures", "--json"]).expect(0).json();
    assert!(!report["warnings"].to_string().contains("can't have"), "{report}");
    assert!(report["joints"].as_array().is_some_and(|joints| joints.iter().all(|joint| joint["outside"] == 0)));
    let markers = dir.text("scene/markers.toml");
    // A note of the marker file, which comes after.
    let markers = markers.replace("\n[segments]", "spare = \"#000000\"\n\n[segments]");
    dir.write("scene/markers.toml", markers.replace("\"clockwise\"", "\"counterclockwise\""));
    let report = posture(&dir, &["--no-figures", "--json"]).expect(0).says("can't have").json();
    let first = report["warnings"][0].as_str().expect("a warning");
    for words in ["J2 is outside of -20 to 120 degrees", "flexion = \"clockwise\"", "mirrored"] {
        assert!(first.contains(words), "`{words}` is not in: {first}");
    }
    assert!(report["joints"][1]["outside"].as_u64().is_some_and(|count| count > 30), "{report}");
}

/// Marks of paint at half the size of a real recording's are this near to their places; measured up to 0.9 px.
const PAINT_OFF_PX: f64 = 2.5;
/// Their angles' median error, degrees; measured 0.2 to 0.3 (segments of 30 to 75 px).
const PAINT_MEDIAN_DEG: f64 = 0.5;

/// A small video of paint on thumb and index finger in `scene/`.
fn painted(more: &[&str]) -> Dir {
    let dir = Dir::new();
    let few = ["phantom", "video", "--out", "scene", "--layout", "paint", "--size", "640x360", "--bend-hz", "0.5"];
    dir.lunula(&[&few[..], more].concat()).expect(0);
    dir
}

/// Every mark seen is at its own place; returns how many were seen of those in view.
#[track_caller]
fn is_rightly_named(dir: &Dir) -> (usize, usize) {
    let (mut seen, mut in_view) = (0, 0);
    let (found, truth) = (dir.table("tracks.csv"), dir.table("scene/truth/tracks.csv"));
    assert_eq!(found.len(), truth.len());
    for (row, exact) in found.iter().zip(&truth) {
        assert_eq!((&row["frame"], &row["marker"]), (&exact["frame"], &exact["marker"]));
        in_view += usize::from(exact["status"] == "ok");
        if let (Some(x), Some(y)) = (known(row, "x_px"), known(row, "y_px")) {
            let off = (x - known(exact, "x_px").expect("a place")).hypot(y - known(exact, "y_px").expect("a place"));
            assert!(off <= PAINT_OFF_PX, "frame {} {}: {off} px off", row["frame"], row["marker"]);
            seen += 1;
        }
    }
    (seen, in_view)
}

#[test]
fn marks_of_one_paint_on_thumb_and_index_have_the_names_of_their_starts() {
    let dir = painted(&["--seconds", "2", "--seed", "11"]);
    posture(&dir, &["--tracks", "tracks.csv", "--no-figures"]).expect(0);
    let (seen, in_view) = is_rightly_named(&dir);
    assert!(100 * seen >= 98 * in_view, "{seen} of {in_view} marks");
    let (found, truth) = (dir.table("joints.csv"), dir.table("scene/truth/joints.csv"));
    let (mut errors, mut all) = (Vec::new(), 0);
    for joint in ["J1_deg", "J2_deg", "J3_deg", "T1_deg", "T2_deg"] {
        for (row, exact) in found.iter().zip(&truth) {
            all += 1;
            errors.extend(known(row, joint).map(|deg| (deg - known(exact, joint).unwrap()).abs()));
        }
    }
    assert!(100 * errors.len() >= 98 * all, "{} of {all} angles", errors.len());
    errors.sort_by(f64::total_cmp);
    let median = errors[errors.len() / 2];
    assert!(median <= PAINT_MEDIAN_DEG, "{median} degrees");

    // Without their places nothing says which finger is which.
    let markers = dir.text("scene/markers.toml");
    let (without, _) = markers.split_once("[start]").expect("the scene's own places");
    dir.write("without.toml", without);
    dir.words("posture scene/video.mp4 --markers without.toml --out none.csv")
        .expect(2)
        .says("can't tell on which finger")
        .says("thumb_tip");

    // What is suggested has all eight marks and no skin, and runs.
    let suggested = dir.lunula(&["posture", "scene/video.mp4", "--suggest"]).expect(0).stdout;
    dir.write("suggested.toml", &suggested);
    let given =
        ["posture", "scene/video.mp4", "--markers", "suggested.toml", "--out", "s.csv", "--tracks", "s-tracks.csv"];
    let report = dir.lunula(&[&given[..], &["--no-figures", "--json"]].concat()).expect(0).json();
    assert_eq!(report["markers"].as_array().map(Vec::len), Some(8), "{suggested}");
    let exact = dir.table("scene/truth/tracks.csv");
    for row in dir.table("s-tracks.csv") {
        let (Some(x), Some(y)) = (known(&row, "x_px"), known(&row, "y_px")) else { continue };
        let near = exact
            .iter()
            .filter(|t| t["frame"] == row["frame"])
            .map(|t| (x - known(t, "x_px").unwrap()).hypot(y - known(t, "y_px").unwrap()));
        let off = near.fold(f64::INFINITY, f64::min);
        assert!(off <= PAINT_OFF_PX, "frame {} {}: {off} px from any mark\n{suggested}", row["frame"], row["marker"]);
    }
}

#[test]
fn a_single_marker_has_tracks_and_no_angles() {
    let dir = scene(&["--colours", "distinct"]);
    let markers = dir.text("scene/markers.toml");
    let line = |line: &&str| line.starts_with("distal_dist = ") || line.starts_with("hand_prox = ");
    let two: Vec<&str> = markers.lines().filter(line).collect();
    for count in [1, 2] {
        dir.write("scene/markers.toml", format!("[markers]\n{}\n", two[..count].join("\n")));
        posture(&dir, &["--tracks", "tracks.csv"]).expect(0);
        assert_eq!(
            dir.table("joints.csv")[0].keys().cloned().collect::<Vec<_>>(),
            ["clock_s", "frame", "status", "time_s"]
        );
        let truth = dir.table("scene/truth/tracks.csv");
        let tracks = dir.table("tracks.csv");
        assert_eq!(tracks.len(), count * dir.table("joints.csv").len());
        for row in &tracks {
            let exact =
                truth.iter().find(|t| t["frame"] == row["frame"] && t["marker"] == row["marker"]).expect("truth");
            let off = ["x_px", "y_px"].map(|c| known(row, c).unwrap() - known(exact, c).unwrap());
            assert!(off[0].hypot(off[1]) <= 1.0, "frame {} {}: {off:?}", row["frame"], row["marker"]);
        }
    }
}

#[test]
fn the_tradeoff_has_every_setting_and_other_programs_on_it() {
    let dir = scene(&[]);
    dir.write(
        "peers.csv",
        "stage,choice,scene,setting,error,error_unit,run_s,run_low_s,run_high_s,repeats,work,machine,version,date\n\
         posture,tracking,scene,OpenCV: BGR,0.29,\"J3, degrees RMS\",6e-3,,,,,a laptop,OpenCV 5.0,2026-11-22\n",
    );
    let scene = ["tradeoff", "posture", "--input", "scene", "--truth", "scene/truth", "--repeats", "1", "--out", "t"];
    dir.lunula(&[&scene[..], &["--peers", "peers.csv"]].concat()).expect(0);
    let rows = dir.table("t/tradeoff.csv");
    let error = |setting: &str| -> f64 {
        let row = rows.iter().find(|row| row["setting"].starts_with(setting) && row["error_unit"].starts_with("J3"));
        row.unwrap_or_else(|| panic!("`{setting}` is in the table"))["error"].parse().expect("a number")
    };
    for setting in ["luma only", "chroma only", "centroid", "one round", "two rounds", "whole frames searched"] {
        assert!(error(setting).is_finite());
    }
    let default = "fitted to a standstill";
    assert!(error(default) < error("centroid"), "the fit is better than the centroid");
    assert_eq!(error("OpenCV"), 0.29);
    for row in &rows {
        assert_eq!(row["default"] == "true", row["setting"] == default);
        assert_eq!(row["peer"] == "true", row["setting"].starts_with("OpenCV"));
    }
    // One knee for each joint and for all together.
    assert_eq!(rows.iter().filter(|row| row["knee"] == "true").count(), 4);
    assert!(dir.path("t/tradeoff.png").is_file() && dir.path("t/tradeoff.svg").is_file());
}
