//! `lunula camera` on generated views of a chessboard: the lens and the plane against exact truth, and what is refused.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::OnceLock;

use image::{DynamicImage, GrayImage, ImageEncoder};
use lunula::video::{Encoder, Encoding, Format, Picture};

use crate::util::{Answer, Dir, Json, number};

/// Views of 640 x 480 px under `scene/`, with more options.
fn views(more: &[&str]) -> Dir {
    let dir = Dir::new();
    let usual = ["phantom", "board", "--out", "scene", "--size", "640x480", "--centre", "325,236", "--fy", "605"];
    dir.lunula(&[&usual, more].concat()).expect(0);
    dir
}

/// The first ones of twelve such views, drawn once for all tests.
fn first_views(count: usize) -> Dir {
    static ALL: OnceLock<BTreeMap<String, Vec<u8>>> = OnceLock::new();
    let all = ALL.get_or_init(|| views(&[]).bytes_of("scene"));
    let dir = Dir::new();
    let shown = all.iter().filter(|(name, _)| name.starts_with("views/")).take(count);
    for (name, bytes) in shown.chain(all.get_key_value("truth/corners.csv")) {
        dir.write(&format!("scene/{name}"), bytes);
    }
    dir
}

fn camera(dir: &Dir, inputs: &str, more: &[&str]) -> Answer {
    let usual = ["camera", inputs, "--board", "9x6", "--square-mm", "20", "--out", "camera.toml", "--json"];
    dir.lunula(&[&usual, more].concat())
}

/// All views of a folder, in the order of their names.
fn pictures(dir: &Dir, folder: &str) -> Vec<(String, GrayImage)> {
    let names = dir.bytes_of(folder).into_keys();
    names
        .map(|name| {
            let picture = image::open(dir.path(folder).join(&name)).expect("a picture").into_luma8();
            (name, picture)
        })
        .collect()
}

fn save(dir: &Dir, name: &str, picture: &GrayImage) {
    picture.save(dir.place(name)).expect("a picture");
}

/// What is refused says why, and leaves nothing behind.
#[track_caller]
fn refused(dir: &Dir, answer: Answer, words: &[&str]) {
    answer.refuses(words);
    assert!(!dir.path("camera.toml").exists() && !dir.path("camera.run.json").exists());
}

/// fx, fy, cx, cy of `--json`.
fn lens(answer: &Answer) -> [f64; 4] {
    let lens = &answer.json()["lens"];
    ["fx_px", "fy_px", "cx_px", "cy_px"].map(|name| lens[name].number())
}

/// Focal lengths, as a share, and the axis' place, pixels; measured 0.0003 and 0.25.
#[track_caller]
fn near(lens: [f64; 4], truth: [f64; 4]) {
    let focal = [0, 1].map(|k| (lens[k] / truth[k] - 1.0).abs());
    let centre = [2, 3].map(|k| (lens[k] - truth[k]).abs());
    assert!(focal.iter().all(|off| *off <= 0.002) && centre.iter().all(|off| *off <= 1.0), "{lens:?}");
}

const TRUTH: [f64; 4] = [600.0, 605.0, 325.0, 236.0];

#[test]
fn a_folder_gives_the_lens_and_the_same_bytes_on_any_threads() {
    let dir = first_views(12);
    let answer = camera(&dir, "scene/views", &[]).expect(0);
    near(lens(&answer), TRUTH);
    let report = answer.json();
    assert!(report["rms_px"].number() <= 0.05 && report["views"].list().len() == 12, "{report}");
    assert!(report["undistorted_sd_px"].number() <= 0.1 && report["covered"].number() >= 0.6, "{report}");
    let results = dir.on_any_threads("camera scene/views --board 9x6 --square-mm 20 --out {out}/camera.toml");
    assert_eq!(results.keys().collect::<Vec<_>>(), ["camera-corners.png", "camera-corners.svg", "camera.toml"]);
    // Planned as done.
    let plan = dir.words("camera scene/views --board 9x6 --square-mm 20 --plan").expect(0);
    plan.prints("photographs").prints("12, turned upright");
}

#[test]
fn distortion_that_is_held_is_not_said_to_be_known() {
    let dir = first_views(12);
    let held = camera(&dir, "scene/views", &["--coefficients", "0", "--no-figures"]).expect(0);
    let report = held.json();
    assert!(report["undistorted_sd_px"].is_null(), "{report}");
    // Measured: 0.919 and 0.029 px.
    assert!(report["rms_px"].number() > 0.5, "{report}");
    held.says("note: the distortion was not measured: it is held at 0")
        .says("--coefficients 0 leaves residuals of 0.9")
        .says("5 coefficients leave 0.0");
    let plain = ["camera", "scene/views", "--board", "9x6", "--square-mm", "20", "--coefficients", "0"];
    let plain = dir.lunula(&[&plain[..], &["--no-figures", "--out", "camera.toml"]].concat()).expect(0).stdout;
    assert!(plain.contains("the distortion was not measured") && plain.contains("0.00000 held"), "{plain}");
    assert!(!plain.contains("undistorted to"), "{plain}");
    // k3 of this lens is 0.
    let four = camera(&dir, "scene/views", &["--coefficients", "4", "--no-figures"]).expect(0);
    assert!(four.json()["undistorted_sd_px"].number() > 0.0);
    four.never_says("not measured").never_says("leaves residuals");
}

#[test]
fn the_lens_goes_into_a_marker_file_as_it_is() {
    let dir = views(&["--views", "8", "--plane", "30,90"]);
    camera(&dir, "scene/views", &["--plane", "scene/plane.png", "--no-figures"]).expect(0);
    dir.lunula(&["phantom", "video", "--out", "v", "--size", "640x360", "--seconds", "0.2"]).expect(0);
    let markers = dir.text("v/markers.toml");
    let measured = dir.text("camera.toml");
    let truth = dir.text("scene/truth/camera.toml");
    for lens in [measured, truth] {
        dir.write("markers.toml", format!("{markers}\n{lens}"));
        let plan = dir.lunula(&["posture", "v/video.mp4", "--markers", "markers.toml", "--plan"]).expect(0);
        for step in ["lens correction", "oblique plane"] {
            let line = plan.stdout.lines().find(|line| line.starts_with(step)).expect("the step");
            assert!(line.contains(" run "), "{line}");
        }
    }
}

/// Root mean square errors of J1, J2, J3, degrees; whether the view is doubted.
fn errors_deg(dir: &Dir, scene: &str, markers: &str) -> ([f64; 3], bool) {
    let video = format!("{scene}/video.mp4");
    let request = ["posture", &video, "--markers", markers, "--out", "joints.csv", "--no-figures"];
    let is_doubted = dir.lunula(&request).expect(0).stderr.contains("filmed obliquely, by 3");
    let (made, truth) = (dir.table("joints.csv"), dir.table(&format!("{scene}/truth/joints.csv")));
    assert_eq!(made.len(), truth.len());
    let errors_deg = ["J1_deg", "J2_deg", "J3_deg"].map(|joint| {
        let squares = made.iter().zip(&truth).map(|(made, truth)| (number(made, joint) - number(truth, joint)).powi(2));
        (squares.sum::<f64>() / made.len() as f64).sqrt()
    });
    (errors_deg, is_doubted)
}

/// Through a plane 30 degrees off straight, measured from a board in it, angles err by at most twice as much as seen
/// straight; without the plane they are degrees off, and said to be.
#[test]
fn angles_seen_obliquely_are_right() {
    let dir = Dir::new();
    let seen = ["--distortion=-0.2,0.05,0.001,-0.0005", "--plane", "30,60"];
    let size = ["--size", "960x540"];
    dir.lunula(&[&["phantom", "board", "--views", "8", "--out", "board"][..], &size, &seen].concat()).expect(0);
    camera(&dir, "board/views", &["--plane", "board/plane.png", "--no-figures"]).expect(0);
    let video = [&["phantom", "video", "--seconds", "2", "--bend-hz", "0.5", "--seed", "7"][..], &size].concat();
    dir.lunula(&[&video[..], &["--out", "straight"]].concat()).expect(0);
    dir.lunula(&[&video[..], &["--out", "oblique"], &seen].concat()).expect(0);
    let markers = dir.text("oblique/markers.toml");
    let (rest, of_truth) = markers.split_once("\n[camera]").expect("the true camera");
    let measured = dir.text("camera.toml");
    dir.write("measured.toml", format!("{rest}\n{measured}"));
    let (lens_only, _) = of_truth.split_once("\n[camera.plane]").expect("the true plane");
    dir.write("lens.toml", format!("{rest}\n[camera]{lens_only}"));
    let (straight, is_doubted) = errors_deg(&dir, "straight", "straight/markers.toml");
    assert!(!is_doubted);
    let (oblique, is_doubted) = errors_deg(&dir, "oblique", "measured.toml");
    assert!(!is_doubted);
    let (without, is_doubted) = errors_deg(&dir, "oblique", "lens.toml");
    assert!(is_doubted);
    println!("straight {straight:?}, oblique {oblique:?}, without the plane {without:?}");
    for joint in 0..3 {
        assert!(oblique[joint] <= 2.0 * straight[joint], "{straight:?}, {oblique:?}");
    }
    assert!(without[1] > 1.0, "{without:?}");
}

#[test]
fn a_video_is_looked_at_now_and_then() {
    let dir = first_views(6);
    let format = Format { width: 640, height: 480, subsampling: None, depth: 8 };
    let mut encoder =
        Encoder::create(&dir.path("board.mp4"), &Encoding { crf: 8, ..Encoding::new(format) }).expect("a video");
    for (k, (_, view)) in pictures(&dir, "scene/views").into_iter().enumerate() {
        for frame in 0..10 {
            let mut picture = Picture::new(format);
            let limited = |value: &u8| (16.0 + f64::from(*value) * 219.0 / 255.0).round() as u8;
            picture.planes[0] = view.as_raw().iter().map(limited).collect();
            encoder.push(&picture, (k as i64 * 10 + frame) * 50).expect("a picture");
        }
    }
    encoder.finish().expect("a video");
    let answer = camera(&dir, "board.mp4", &["--coefficients", "4"]).expect(0);
    assert_eq!(answer.json()["views"].list().len(), 6);
    near(lens(&answer), TRUTH);
}

#[test]
fn too_few_views_and_views_that_are_alike_are_refused() {
    let dir = first_views(2);
    refused(&dir, camera(&dir, "scene/views", &[]), &["2 view(s) show the board", "3 are the fewest", "10 to 20"]);
    let dir = first_views(3);
    let answer = camera(&dir, "scene/views", &["--coefficients", "4"]).expect(0).says("3 views only");
    near(lens(&answer), TRUTH);
    // A board that rests, in another frame's noise.
    let mut rests = image::open(dir.path("scene/views/01.png")).expect("a view").to_luma8();
    rests.pixels_mut().step_by(7).for_each(|pixel| pixel.0[0] = pixel.0[0].saturating_add(2));
    rests.save(dir.path("scene/views/05.png")).expect("a view");
    camera(&dir, "scene/views", &["--coefficients", "4"]).expect(0).says("4 views show 3 places of the board only");
    std::fs::remove_file(dir.path("scene/views/05.png")).expect("removed");
    // A copy is no other view.
    std::fs::copy(dir.path("scene/views/01.png"), dir.path("scene/views/04.png")).expect("a copy");
    let answer = camera(&dir, "scene/views", &["--coefficients", "4"]).expect(0).says("3 views only");
    answer.says("views/04.png: the same to the byte as scene/views/01.png, and not counted");
    // Nor is the plane's view, where it is among the views.
    let plane = ["--plane", "scene/views/01.png", "--coefficients", "4"];
    let answer =
        camera(&dir, "scene/views", &plane).expect(0).says("as scene/views/01.png of --plane, and not counted");
    assert!(answer.says("3 views only").json()["views"].list().len() == 3);
    for name in ["scene/views/02.png", "scene/views/04.png", "camera.toml", "camera.run.json"] {
        std::fs::remove_file(dir.path(name)).expect("removed");
    }
    refused(&dir, camera(&dir, "scene/views", &plane), &["2 view(s) show the board"]);
    let dir = views(&["--tilt", "0,0", "--views", "4"]);
    refused(&dir, camera(&dir, "scene/views", &[]), &["alike", "tilted by 20 to 40 degrees"]);
}

#[test]
fn what_shows_no_board_or_two_is_named_and_the_rest_is_done() {
    let dir = first_views(6);
    let all = pictures(&dir, "scene/views");
    let corners = dir.table("scene/truth/corners.csv");
    // A board half out of every view.
    for (name, view) in &all[..2] {
        let own = corners.iter().filter(|row| row["view"] == format!("views/{name}"));
        let right = own.map(|row| number(row, "x_px")).fold(f64::NEG_INFINITY, f64::max);
        // Its outermost corner is enough.
        let mut cut = view.clone();
        let from = right as u32 - 20;
        cut.enumerate_pixels_mut().filter(|(x, ..)| *x >= from).for_each(|(.., value)| value.0 = [115]);
        save(&dir, &format!("half/{name}"), &cut);
    }
    refused(&dir, camera(&dir, "half", &[]), &["no view shows the board", "half/01.png", "is seen whole"]);
    // Squares counted in place of inner corners; a row of corners forgotten.
    for size in ["10x7", "9x5"] {
        let request = ["camera", "scene/views", "--board", size, "--square-mm", "20", "--out", "camera.toml"];
        dir.lunula(&request)
            .expect(2)
            .says(&format!("no board of {size} inner corners is seen whole, but one of 9x6; all of it has to be"));
    }
    // Two boards side by side in every view.
    for (name, view) in &all[..2] {
        let twice = GrayImage::from_fn(1280, 480, |x, y| *view.get_pixel(x % 640, y));
        save(&dir, &format!("two/{name}"), &twice);
    }
    refused(&dir, camera(&dir, "two", &[]), &["shows two boards; cover one", "two/02.png"]);
    // One of either among good ones, a picture of another size, and a file that is no picture.
    for (name, view) in &all {
        save(&dir, &format!("mixed/{name}"), view);
    }
    std::fs::copy(dir.path("half/01.png"), dir.path("mixed/07.png")).expect("a copy");
    let (_, first) = &all[0];
    let larger = image::imageops::resize(first, 800, 600, image::imageops::FilterType::CatmullRom);
    save(&dir, "mixed/08.png", &larger);
    dir.write("mixed/09.png", "no picture");
    let answer = camera(&dir, "mixed", &["--coefficients", "4"]).expect(1).says_all(&[
        "mixed/07.png: no board",
        "mixed/08.png: is 800 x 600 px, most views are 640 x 480",
        "mixed/09.png: is not",
    ]);
    near(lens(&answer), TRUTH);
    // As many of one size as of another.
    for (name, view) in all.iter().take(3) {
        save(&dir, &format!("sizes/{name}"), view);
        let larger = image::imageops::resize(view, 800, 600, image::imageops::FilterType::CatmullRom);
        save(&dir, &format!("sizes/large-{name}"), &larger);
    }
    std::fs::remove_file(dir.path("camera.toml"))
        .and_then(|()| std::fs::remove_file(dir.path("camera.run.json")))
        .expect("gone");
    refused(&dir, camera(&dir, "sizes", &[]), &["different pictures", "640 x 480 px", "800 x 600 px"]);
}

#[test]
fn requests_that_are_wrong_say_what_to_write() {
    let dir = Dir::new();
    std::fs::create_dir(dir.path("empty")).expect("a folder");
    refused(&dir, camera(&dir, "empty", &[]), &["empty: holds no photographs"]);
    refused(&dir, camera(&dir, "nowhere", &[]), &["nowhere: is not there"]);
    dir.write("notes.mp4", "no video");
    refused(&dir, camera(&dir, "notes.mp4", &[]), &["notes.mp4", "a folder of photographs or a video is needed"]);
    let usual = ["camera", "empty", "--out", "camera.toml"];
    for (more, words) in [
        (&["--board", "9", "--square-mm", "20"][..], "as 9x6"),
        (&["--board", "2x6", "--square-mm", "20"], "3 to 50 inner corners"),
        (&["--board", "9x6", "--square-mm", "0"], "a length in millimetres"),
        (&["--board", "9x6", "--square-mm", "20", "--coefficients", "3"], "choose 5, 4 or 0"),
        (&["--square-mm", "20"], "--board"),
    ] {
        refused(&dir, dir.lunula(&[&usual, more].concat()), &[words]);
    }
    let dir = first_views(3);
    let own = ["camera", "scene/views", "--board", "9x6", "--square-mm", "20", "--out", "scene/views/01.png"];
    dir.lunula(&own).expect(2).says("is an input itself");
    refused(&dir, camera(&dir, "scene/views", &["--plane", "scene/views"]), &["one photograph or video"]);
}

/// A chessboard is its own mirror image: mirrored pictures give the lens that shows them.
#[test]
fn mirrored_and_turned_pictures_give_the_lens_of_the_upright_ones() {
    let dir = first_views(8);
    for (name, view) in pictures(&dir, "scene/views") {
        save(&dir, &format!("mirrored/{name}"), &image::imageops::flip_horizontal(&view));
        turned(&image::imageops::rotate270(&view), &dir.place(&format!("turned/{name}.jpg")));
    }
    let mirrored = camera(&dir, "mirrored", &[]).expect(0);
    near(lens(&mirrored), [TRUTH[0], TRUTH[1], 639.0 - TRUTH[2], TRUTH[3]]);
    let turned = camera(&dir, "turned", &[]).expect(0);
    near(lens(&turned), TRUTH);
    assert_eq!(turned.json()["picture_px"].list().iter().map(Json::number).collect::<Vec<_>>(), [640.0, 480.0]);
}

/// A JPEG whose EXIF says that it is to be turned by a quarter clockwise.
fn turned(picture: &GrayImage, path: &Path) {
    let mut exif = b"II*\0\x08\0\0\0\x01\0".to_vec();
    exif.extend(b"\x12\x01\x03\0\x01\0\0\0\x06\0\0\0\0\0\0\0");
    let mut bytes = Vec::new();
    let mut encoder = image::codecs::jpeg::JpegEncoder::new_with_quality(&mut bytes, 97);
    encoder.set_exif_metadata(exif).expect("EXIF");
    let picture = DynamicImage::from(picture.clone());
    encoder.write_image(picture.as_bytes(), picture.width(), picture.height(), picture.color().into()).expect("a JPEG");
    std::fs::write(path, bytes).expect("a file");
}

#[test]
fn a_pipeline_measures_the_lens() {
    let dir = Dir::new();
    dir.write(
        "pipeline.toml",
        r#"
name = "camera"
wanted = ["lens"]
[phantom]
board = { views = 6, size = "640x480" }
[inputs.views]
files = "{phantom}/board/views/{view}.png"
[stage.lens]
job = "camera"
views = "views"
board = "9x6"
square_mm = 20
coefficients = 4
"#,
    );
    dir.lunula(&["run", "pipeline.toml", "--out", "out", "--plan"]).expect(0);
    dir.lunula(&["run", "pipeline.toml", "--out", "out"]).expect(0);
    let results = dir.bytes_of("out");
    let (_, lens) =
        results.iter().find(|(name, _)| name.ends_with("camera.toml") && name.contains("lens")).expect("a lens");
    assert!(String::from_utf8_lossy(lens).contains("[camera]"));
}
