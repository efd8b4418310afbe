//! `lunula posture` on what goes wrong on a Monday morning: each case names file and place and says what to do.

use crate::util::{Answer, Dir};
use lunula::video::{Encoder, Encoding, Format, Picture};

const MARKERS: &str = r##"
flexion = "clockwise"
[markers]
a = "#1e6fd9"
b = "#1e6fd9"
c = "#e91e63"
d = "#e91e63"
[segments]
first = ["a", "b"]
second = ["c", "d"]
[joints]
J2 = ["first", "second"]
"##;

fn posture(dir: &Dir, video: &str) -> Answer {
    dir.lunula(&["posture", video, "--markers", "markers.toml", "--out", "joints.csv"])
}

/// A folder with the marker file above.
fn folder() -> Dir {
    let dir = Dir::new();
    dir.write("markers.toml", MARKERS);
    dir
}

/// A small video of a finger in `scene/`, and its marker file as `markers.toml`.
fn scene(more: &[&str]) -> Dir {
    let dir = Dir::new();
    let mut arguments = vec!["phantom", "video", "--out", "scene", "--seed", "7"];
    for usual in [["--size", "640x360"], ["--seconds", "1"]] {
        if !more.contains(&usual[0]) {
            arguments.extend(usual);
        }
    }
    dir.lunula(&[&arguments[..], more].concat()).expect(0);
    std::fs::copy(dir.path("scene/markers.toml"), dir.path("markers.toml")).expect("a copy");
    dir
}

/// A video of `frames` pictures of one grey.
fn blank(dir: &Dir, name: &str, format: Format, frames: i64) {
    let mut picture = Picture::new(format);
    picture.planes.iter_mut().for_each(|plane| plane.fill(128));
    let mut encoder = Encoder::create(&dir.place(name), &Encoding::new(format)).expect("a video");
    (0..frames).for_each(|k| encoder.push(&picture, 33 * k).expect("a picture"));
    encoder.finish().expect("a video");
}

const SMALL: Format = Format { width: 160, height: 120, subsampling: Some((2, 2)), depth: 8 };

/// What is refused leaves nothing behind.
#[track_caller]
fn refused(dir: &Dir, answer: Answer, words: &[&str]) {
    answer.refuses(words);
    assert!(!dir.path("joints.csv").exists() && !dir.path("joints.run.json").exists());
}

#[test]
fn what_is_no_video_is_named() {
    let dir = folder();
    dir.write("diary.mp4", "dear diary");
    dir.write("empty.mp4", "");
    for name in ["diary.mp4", "empty.mp4", "missing.mp4", "."] {
        refused(&dir, posture(&dir, name), &[name]);
    }
}

#[test]
fn a_file_cut_in_the_middle_gives_its_frames_and_status_1() {
    let dir = scene(&[]);
    posture(&dir, "scene/video.mp4").expect(0);
    let whole = dir.table("joints.csv");
    let bytes = std::fs::read(dir.path("scene/video.mp4")).expect("a file");
    dir.write("cut.mp4", &bytes[..bytes.len() * 3 / 5]);
    posture(&dir, "cut.mp4").expect(1).says("cut.mp4");
    let cut = dir.table("joints.csv");
    assert!(cut.len() > 3 && cut.len() < whole.len(), "{} of {} frames", cut.len(), whole.len());
    let same = cut.iter().zip(&whole).filter(|(a, b)| a["J2_deg"] == b["J2_deg"] && a["time_s"] == b["time_s"]).count();
    assert!(same + 4 >= cut.len(), "frames before the cut are as in the whole file: {same} of {}", cut.len());
}

#[test]
fn a_damaged_frame_keeps_the_index_right() {
    let dir = scene(&["--crf", "20"]);
    posture(&dir, "scene/video.mp4").expect(0);
    let whole = dir.table("joints.csv");
    let mut bytes = std::fs::read(dir.path("scene/video.mp4")).expect("a file");
    let at = bytes.len() / 2;
    bytes[at..at + 400].fill(0xff);
    dir.write("hurt.mp4", bytes);
    posture(&dir, "hurt.mp4").expect(1).says("hurt.mp4").says("could not be decoded");
    let hurt = dir.table("joints.csv");
    assert_eq!(hurt.len(), whole.len(), "a row a frame, decoded or not");
    let lost = hurt.iter().filter(|row| row["J2_deg"].is_empty()).count();
    assert!(lost > 0 && lost < whole.len(), "{lost} rows without an angle");
    for (a, b) in hurt.iter().zip(&whole) {
        assert_eq!((&a["frame"], &a["time_s"]), (&b["frame"], &b["time_s"]));
        if let (Ok(x), Ok(y)) = (a["J2_deg"].parse::<f64>(), b["J2_deg"].parse::<f64>()) {
            assert!((x - y).abs() < 1.0, "frame {}: {x} and {y}", a["frame"]);
        }
    }
}

#[test]
fn markers_that_are_never_seen_are_named() {
    let dir = folder();
    blank(&dir, "blank.mp4", SMALL, 10);
    refused(&dir, posture(&dir, "blank.mp4"), &["blank.mp4", "none of the markers is seen", "--suggest"]);
    dir.lunula(&["posture", "blank.mp4", "--suggest"]).expect(2).says("blank.mp4");
}

#[test]
fn one_frame_is_enough() {
    let dir = scene(&["--seconds", "0.03"]);
    posture(&dir, "scene/video.mp4").expect(0);
    let rows = dir.table("joints.csv");
    assert_eq!((rows.len(), rows[0]["status"].as_str(), rows[0]["time_s"].as_str()), (1, "ok", "0.000000"));
}

#[test]
fn one_marker_of_four_that_never_comes_leaves_the_other_joints() {
    let dir = scene(&["--colours", "distinct", "--hide", "distal_dist@0+60"]);
    posture(&dir, "scene/video.mp4").expect(0).says("distal_dist").says("warning");
    for row in dir.table("joints.csv") {
        assert!(!row["J1_deg"].is_empty() && !row["J2_deg"].is_empty() && row["J3_deg"].is_empty());
        assert_eq!(row["status"], "lost: distal_dist");
    }
}

#[test]
fn grey_video_of_coloured_markers_is_refused_or_right() {
    let dir = scene(&["--format", "grey"]);
    let answer = posture(&dir, "scene/video.mp4");
    assert!(answer.code == 0 || answer.code == 2, "{}", answer.stderr);
    if answer.code == 0 {
        let truth = dir.table("scene/truth/joints.csv");
        for (row, exact) in dir.table("joints.csv").iter().zip(&truth) {
            if let Ok(found) = row["J2_deg"].parse::<f64>() {
                assert!((found - exact["J2_deg"].parse::<f64>().expect("an angle")).abs() <= 3.0);
            }
        }
    } else {
        assert!(answer.stderr.contains("scene/video.mp4") && !dir.path("joints.csv").exists());
    }
}

#[test]
fn a_lens_of_other_pictures_is_refused_or_doubted() {
    let dir = scene(&[]);
    let markers = dir.text("markers.toml");
    let with = |camera: &str| {
        dir.write("markers.toml", format!("{markers}\n[camera]\n{camera}\n"));
        posture(&dir, "scene/video.mp4")
    };
    let larger = with("size = [1280, 720]\nfx = 1200.0");
    let words = ["measured on pictures of 1280 x 720 px, and these are 640 x 360", "multiply", "by 0.5"];
    refused(&dir, larger, &[&words[..], &["(c + 0.5) 0.5 - 0.5"]].concat());
    refused(&dir, with("size = [640, 480]\nfx = 600.0"), &["640 x 480", "lunula camera"]);
    refused(&dir, with("size = [640.5, 360]\nfx = 600.0"), &["`size` is no picture's"]);
    with("fx = 600.0\ncx = 100.0\ncy = 90.0").expect(0).says("far from the middle").says("`size = [640, 360]`");
    with("size = [640, 360]\nfx = 600.0\ncx = 330.0").expect(0);
}

#[test]
fn results_never_replace_the_input_or_one_another() {
    let dir = scene(&[]);
    let before = std::fs::read(dir.path("scene/video.mp4")).expect("a file");
    let given = ["posture", "scene/video.mp4", "--markers", "markers.toml"];
    for (more, words) in [
        (&["--out", "joints.csv", "--overlay", "scene/video.mp4"][..], "an input itself"),
        (&["--out", "joints.csv", "--tracks", "joints.csv"], "two results"),
        (&["--out", "joints.txt"], ".csv or .parquet"),
        (&["--out", "scene"], "scene"),
    ] {
        dir.lunula(&[&given[..], more].concat()).expect(2).says(words);
    }
    assert!(std::fs::read(dir.path("scene/video.mp4")).expect("a file") == before);
    assert!(!dir.path("joints.csv").exists());
}

mod real_data {
    use super::*;
    use crate::util::real_data::real_data;

    #[test]
    #[ignore = "needs real recordings: LUNULA_REAL_DATA"]
    fn hands_without_markers_give_no_angles() {
        let dir = folder();
        let answer = posture(&dir, real_data("hand/rotation_1.mp4").to_str().unwrap());
        refused(&dir, answer, &["rotation_1.mp4", "markers"]);
    }

    #[test]
    #[ignore = "needs real recordings: LUNULA_REAL_DATA"]
    fn nothing_on_real_hands_is_suggested_as_a_marker() {
        let dir = Dir::new();
        for name in ["rotation_1", "scale_1", "translation_2"] {
            let clip = real_data(&format!("hand/{name}.mp4"));
            dir.lunula(&["posture", clip.to_str().unwrap(), "--suggest"]).expect(2).says("looks like a marker");
        }
    }
}
