//! `lunula edit`: outlines corrected key by key, and what is in the files then.

use std::io::Read;

use image::{DynamicImage, Rgb, RgbImage, imageops};
use lunula::job::Watch;
use lunula::labelme::LabelMe;
use lunula::nail::Outline;
use lunula::outlines::{NOT_A_NAIL, Pressed};
use lunula::photo::Photograph;
use lunula::photo::outline::{Drawn, read_annotated};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::{Value, json};

use crate::photos_extremes::{save_turned, stored};
use crate::util::desk::Desk;
use crate::util::page::{ends, interrupts, until};
use crate::util::real_data::repository;
use crate::util::{Dir, Json, drawn_axis, drawn_nail, drawn_outline, labelme};

/// Files have hundredths of pixels.
const HUNDREDTH_PX: f64 = 0.0051;

impl Desk {
    #[track_caller]
    fn press(&self, key: Value) {
        assert_eq!(self.editor.key(key.to_string().as_bytes()), Pressed::Done, "{key}");
    }

    #[track_caller]
    fn keys(&self, keys: &[&str]) {
        keys.iter().for_each(|key| self.press(json!({ "key": key })));
    }

    fn photo(&self) -> String {
        self.sees()["nail"]["photo"].as_str().unwrap_or("none").to_owned()
    }

    fn points(&self) -> Vec<[f64; 2]> {
        serde_json::from_value(self.sees()["nail"]["points"].clone()).expect("corners")
    }
}

/// The drawn nail of a set, whose outline is doubtful and has no axis.
pub(crate) fn doubtful(dir: &Dir, name: &str) {
    dir.photo(name, drawn_nail(), labelme([160, 140], &[("nail?", "polygon", drawn_outline())]));
}

fn labels(dir: &Dir, name: &str) -> Vec<String> {
    let file = LabelMe::read(&dir.path(name)).expect("LabelMe");
    file.shapes.into_iter().map(|shape| shape.label).collect()
}

#[test]
fn doubtful_nails_come_first_and_enter_saves_what_the_next_run_uses() {
    let dir = Dir::new();
    dir.nail("set/a");
    doubtful(&dir, "set/b");
    dir.write("set/c.jpg", [0xff, 0xd8, 0xff, 0xe0, 0, 16]);
    let desk = Desk::at(&dir.path("set"));
    assert_eq!(desk.photo(), "b.png");
    assert_eq!(desk.sees()["doubtful_left"], 1);
    assert!(desk.sees()["failed"][0].words().starts_with("c.jpg: "), "{}", desk.sees());
    desk.press(json!({"key": "move", "by": [1, 0]}));
    desk.keys(&["accept"]);
    assert_eq!(labels(&dir, "set/b.json"), ["nail", "axis"]);
    assert_eq!((desk.photo().as_str(), desk.sees()["accepted"].clone()), ("a.png", json!(1)));
    desk.keys(&["next"]);
    assert!(desk.sees()["nail"].is_null());
    dir.lunula(&["photos", "set", "--out", "out"]).expect(1).says("c.jpg").never_says("failed: b.png");
    let used = dir.table("out/nails.csv").iter().filter(|row| row["used"] == "true").count();
    assert_eq!(used, 2);
}

#[test]
fn whatever_else_is_in_a_file_stays_and_undo_goes_back_to_the_beginning() {
    let dir = Dir::new();
    doubtful(&dir, "set/a");
    let mut file: Value = dir.parsed("set/a.json");
    file["lineColor"] = json!([0, 255, 0, 128]);
    file["flags"] = json!({"left hand": true});
    let lunula = json!({"label": "lunula", "points": [[1, 2], [3, 4], [5, 2]], "shape_type": "polygon", "colour": 7});
    file["shapes"].as_array_mut().unwrap().insert(0, lunula);
    dir.write("set/a.json", file.to_string());
    let read = |name: &str| serde_json::to_value(LabelMe::read(&dir.path(name)).expect("LabelMe")).unwrap();
    let before = read("set/a.json");
    let desk = Desk::at(&dir.path("set"));
    let first = desk.points();
    for key in [
        json!({"key": "grow", "by": [1, 0], "stride": "coarse"}),
        json!({"key": "turn", "by": 2}),
        json!({"key": "corner", "forwards": true}),
        json!({"key": "grow", "by": [1, 1]}),
        json!({"key": "insert"}),
        json!({"key": "drag", "gesture": 1, "corner": 5, "by_px": [3.0, 1.0]}),
        json!({"key": "drag", "gesture": 1, "corner": 5, "by_px": [4.0, 2.0]}),
        json!({"key": "flip"}),
    ] {
        desk.press(key);
    }
    desk.keys(&["accept"]);
    let after = read("set/a.json");
    assert_eq!((&after["lineColor"], &after["flags"]), (&before["lineColor"], &before["flags"]));
    assert_eq!(after["shapes"][0], before["shapes"][0]);
    assert_eq!((&after["shapes"][1]["label"], &after["shapes"][2]["label"]), (&json!("nail"), &json!("axis")));
    desk.keys(&["previous", "undo"]);
    assert_eq!(read("set/a.json"), before);
    desk.keys(&["undo"; 12]);
    assert!(desk.points() == first && desk.sees()["nail"]["can_undo"] == false);
}

#[test]
fn undo_takes_the_latest_back_and_what_was_only_detected_leaves_no_file() {
    let dir = Dir::new();
    std::fs::create_dir(dir.path("set")).expect("a folder");
    std::fs::copy(repository().join("fixtures/photos/normal/s01.png"), dir.path("set/a.png")).expect("a photograph");
    let desk = Desk::at(&dir.path("set"));
    let found = desk.points();
    for decision in ["accept", "reject"] {
        desk.keys(&[decision]);
        assert!(dir.path("set/a.json").exists(), "{decision}: {}", desk.sees());
        desk.keys(&["previous", "undo"]);
        assert!(!dir.path("set/a.json").exists() && desk.sees()["accepted"] == 0, "{decision}: {}", desk.sees());
    }
    // A change behind the decision goes first.
    desk.keys(&["accept", "previous"]);
    desk.press(json!({"key": "grow", "by": [1, 1], "stride": "coarse"}));
    assert_ne!(desk.points(), found);
    desk.keys(&["undo"]);
    assert!(desk.points() == found && desk.sees()["accepted"] == 1 && dir.path("set/a.json").exists());
    desk.keys(&["undo"]);
    assert!(desk.sees()["accepted"] == 0 && !dir.path("set/a.json").exists());
    assert_eq!(desk.editor.report(&Watch::nobody()).saved, Vec::<std::path::PathBuf>::new());
}

#[test]
fn a_file_that_another_program_has_changed_is_not_written_over() {
    let dir = Dir::new();
    doubtful(&dir, "set/a");
    let desk = Desk::at(&dir.path("set"));
    let theirs = labelme([160, 140], &[("nail", "polygon", drawn_outline()), ("axis", "line", drawn_axis())]);
    dir.write("set/a.json", &theirs);
    desk.keys(&["accept"]);
    assert_eq!(dir.text("set/a.json"), theirs);
    assert_eq!(labels(&dir, "set/a.edited.json"), ["nail", "axis"]);
    assert!(desk.sees()["is_fault"] == true && desk.sees()["said"].words().contains("changed by another program"));
    // From then on its outlines are in that file.
    desk.keys(&["previous", "reject"]);
    assert_eq!(labels(&dir, "set/a.edited.json"), [NOT_A_NAIL]);
    assert_eq!(dir.text("set/a.json"), theirs);
}

#[test]
fn a_change_that_nobody_accepted_is_named() {
    let dir = Dir::new();
    dir.nail("set/a");
    dir.nail("set/b");
    let desk = Desk::at(&dir.path("set"));
    let lost = || desk.editor.report(&Watch::nobody()).warnings;
    desk.keys(&["accept", "previous"]);
    assert_eq!((desk.sees()["nail"]["decision"].words(), lost()), ("accepted", vec![]));
    desk.press(json!({"key": "move", "by": [1, 0]}));
    assert!(desk.sees()["nail"]["decision"].is_null());
    assert_eq!(lost(), ["a.png: nail 1 was changed and not accepted since, so that the change is lost"]);
    desk.keys(&["accept"]);
    assert!(lost().is_empty());
}

#[test]
fn what_is_no_nail_is_no_run_s_nail() {
    let dir = Dir::new();
    dir.nail("set/a");
    let desk = Desk::at(&dir.path("set"));
    desk.keys(&["reject"]);
    assert_eq!(labels(&dir, "set/a.json"), [NOT_A_NAIL]);
    dir.words("photos set --out out").expect(2).says("whatever was found is rejected in it (`not a nail`)");
    // A nail that somebody finds after all.
    desk.keys(&["previous", "undo", "another"]);
    desk.press(json!({"key": "place", "to_px": [80.0, 70.0]}));
    desk.keys(&["accept"]);
    assert_eq!(labels(&dir, "set/a.json"), ["nail", "axis", "nail", "axis"]);
}

#[test]
fn keys_at_another_nail_or_of_no_meaning_do_nothing() {
    let dir = Dir::new();
    doubtful(&dir, "set/a");
    doubtful(&dir, "set/b");
    // Two pages at once: both are at the first nail, and one of them is quicker.
    let desk = Desk::at(&dir.path("set"));
    let nail = desk.sees()["nail"]["id"].clone();
    let accept = json!({"key": "accept", "nail": nail}).to_string();
    assert_eq!(desk.editor.key(accept.as_bytes()), Pressed::Done);
    assert_eq!(desk.editor.key(accept.as_bytes()), Pressed::Late);
    assert_eq!(labels(&dir, "set/b.json"), ["nail?"]);
    for no_key in ["", "{}", "[1]", r#"{"key":"dance"}"#, r#"{"key":"move","by":[1e300,0]}"#] {
        assert_eq!(desk.editor.key(no_key.as_bytes()), Pressed::Unknown, "{no_key}");
    }
}

#[test]
fn an_outline_is_where_it_was_drawn_however_the_picture_is_stored() {
    for (orientation, picture) in (1..).zip(&stored(&drawn_nail())) {
        let dir = Dir::new();
        save_turned(picture, orientation, dir.place("set/a.png"));
        let photo = Photograph::read(&dir.path("set/a.png")).expect("a picture");
        assert_eq!([photo.image.width(), photo.image.height()], [160, 140]);
        // Nobody has drawn anything: a new file, of the upright picture.
        let desk = Desk::at(&dir.path("set"));
        desk.press(json!({"key": "place", "to_px": [80.0, 70.0]}));
        let shown = desk.points();
        desk.keys(&["accept"]);
        let saved = || {
            let nails = read_annotated(&dir.path("set/a.json"), &photo, Drawn::Auto).expect("what was saved").nails;
            nails[0].outline.clone().expect("an outline").points()
        };
        let off = |one: &[[f64; 2]], other: &[[f64; 2]]| {
            let [one, other] = [one, other].map(|points| Outline::new(points).expect("an outline"));
            1.0 - one.iou(&other)
        };
        // Corners to hundredths of pixels.
        assert!(off(&shown, &saved()) <= 1e-3, "{orientation}");
        // The same again from the file.
        let desk = Desk::at(&dir.path("set"));
        desk.press(json!({"key": "move", "by": [2, 1]}));
        let shown = desk.points();
        desk.keys(&["accept"]);
        assert!(off(&shown, &saved()) <= 1e-3, "{orientation}");
    }
}

#[test]
fn an_annotation_of_the_stored_picture_stays_one() {
    let dir = Dir::new();
    // Stored lying on its side.
    save_turned(&imageops::rotate270(&drawn_nail()), 6, dir.place("set/a.png"));
    let drawn: Vec<[f64; 2]> = drawn_outline().iter().map(|&[x, y]| [y, 160.0 - x]).collect();
    dir.write("set/a.json", labelme([140, 160], &[("nail?", "polygon", drawn.clone())]));
    let desk = Desk::at(&dir.path("set"));
    let upright = drawn_outline();
    let shown = desk.points();
    assert!(upright.iter().zip(&shown).all(|(a, b)| (0..2).all(|k| (a[k] - 0.5 - b[k]).abs() <= HUNDREDTH_PX)));
    desk.keys(&["accept"]);
    let file = LabelMe::read(&dir.path("set/a.json")).expect("LabelMe");
    assert_eq!((file.size(), &file.shapes[0].points), (Some([140, 160]), &drawn));
}

#[test]
fn every_kind_of_picture_is_shown_and_what_is_none_is_said() {
    let dir = Dir::new();
    let colour = DynamicImage::from(drawn_nail());
    let kinds = [
        ("grey", DynamicImage::from(colour.to_luma8())),
        ("sixteen", DynamicImage::from(colour.to_rgb16())),
        ("grey-sixteen", DynamicImage::from(colour.to_luma16())),
        ("alpha", DynamicImage::from(colour.to_rgba8())),
    ];
    for (name, picture) in &kinds {
        picture.save(dir.place(&format!("set/{name}.png"))).expect("a picture");
        dir.write(&format!("set/{name}.json"), labelme([160, 140], &[("nail?", "polygon", drawn_outline())]));
    }
    RgbImage::from_pixel(1, 1, Rgb([200, 100, 100])).save(dir.place("set/tiny.png")).expect("a picture");
    let desk = Desk::at(&dir.path("set"));
    for _ in &kinds {
        for rough in [true, false] {
            let png = desk.editor.normalized(rough).expect("a normalized nail");
            let png = image::load_from_memory(&png).expect("a PNG");
            assert_eq!([png.width(), png.height()], [400, 400]);
        }
        let jpeg = image::load_from_memory(&desk.editor.photo().expect("a part")).expect("a JPEG");
        assert!(jpeg.width() >= 100, "{}", jpeg.width());
        desk.keys(&["accept"]);
        assert_eq!(desk.sees()["is_fault"], false, "{}", desk.sees());
    }
    // Of one pixel there is nothing to be drawn.
    assert_eq!(desk.photo(), "tiny.png");
    assert!(desk.editor.photo().is_some() && desk.editor.normalized(false).is_err());
    desk.keys(&["accept"]);
    assert!(desk.sees()["is_fault"] == true && !dir.path("set/tiny.json").exists(), "{}", desk.sees());
    desk.keys(&["snap", "zoom", "flip", "insert", "remove", "reject"]);
    assert!(desk.sees()["nail"].is_null() && !dir.path("set/tiny.json").exists());
}

#[test]
fn sixty_nails_on_one_photograph_are_gone_through_one_by_one() {
    let dir = Dir::new();
    let nail = drawn_nail();
    let (mut picture, mut shapes) = (RgbImage::new(1600, 840), Vec::new());
    for k in 0..60_u32 {
        let [x, y] = [160 * (k % 10), 140 * (k / 10)];
        imageops::replace(&mut picture, &nail, i64::from(x), i64::from(y));
        let moved = drawn_outline().iter().map(|p| [p[0] + f64::from(x), p[1] + f64::from(y)]).collect();
        shapes.push(("nail?", "polygon", moved));
    }
    dir.photo("set/hands", picture, labelme([1600, 840], &shapes));
    let desk = Desk::at(&dir.path("set"));
    assert_eq!(desk.sees()["nail"]["of"], 60);
    desk.keys(&["accept"; 60]);
    assert!(desk.sees()["nail"].is_null() && desk.sees()["accepted"] == 60);
    let (nails, axes) = labels(&dir, "set/hands.json").iter().fold((0, 0), |(nails, axes), label| {
        (nails + usize::from(label == "nail"), axes + usize::from(label == "axis"))
    });
    assert_eq!((nails, axes), (60, 60));
}

#[test]
fn snap_finds_the_border_from_where_the_outline_is() {
    let dir = Dir::new();
    let options = lunula::phantom::photos::PhotoOptions {
        truth_normalized: false,
        ..crate::util::small_set(1, &[lunula::phantom::nail::Pose::Nominal])
    };
    lunula::phantom::Generated::write(&options, &dir.path("scene")).expect("synthetic photographs");
    let path = dir.path("scene/photos/nominal/s01.json");
    let mut file = LabelMe::read(&path).expect("LabelMe");
    let truth = Outline::new(&file.shapes[0].points).expect("an outline");
    file.shapes[0].label = "nail?".to_owned();
    file.write(&path).expect("written");
    let desk = Desk::at(&dir.path("scene/photos"));
    desk.press(json!({"key": "move", "by": [3, 2]}));
    desk.press(json!({"key": "grow", "by": [3, -2]}));
    let overlap = || {
        let points: Vec<[f64; 2]> = desk.points().iter().map(|point| point.map(|v| v + 0.5)).collect();
        Outline::new(&points).expect("an outline").iou(&truth)
    };
    let before = overlap();
    desk.keys(&["snap"]);
    // Measured 0.83 and 0.98.
    assert!(before <= 0.9 && overlap() >= 0.95, "{before} {}", overlap());
}

#[test]
fn the_command_serves_until_it_is_interrupted_and_a_kill_loses_nothing_accepted() {
    let dir = Dir::new();
    doubtful(&dir, "set/a");
    doubtful(&dir, "set/b");
    let accepts = |page: &crate::util::page::Page| {
        until("a nail", || page.hears("edit/state")["nail"].is_object());
        assert!(page.posts("edit/key", r#"{"key":"accept"}"#).starts_with("HTTP/1.1 204"));
    };
    let (mut child, page) = dir.page(&["edit", "set"]);
    accepts(&page);
    child.kill().expect("it runs");
    child.wait().expect("it ran");
    assert_eq!(labels(&dir, "set/a.json"), ["nail", "axis"]);
    assert_eq!(labels(&dir, "set/b.json"), ["nail?"]);
    let (mut child, page) = dir.page(&["edit", "set", "--json"]);
    let url: Value = serde_json::from_str(&page.0).expect("JSON");
    let page = crate::util::page::Page(url["url"].words().to_owned());
    until("both photographs", || page.hears("edit/state")["open"] == 0);
    accepts(&page);
    assert!(page.posts("edit/key", "dance").starts_with("HTTP/1.1 400"));
    assert!(page.reads("edit/normalized").contains("PNG") && !page.reads("edit/photo").is_empty());
    assert_eq!(page.reads("pages"), r#"[{"name":"edit","title":"Outlines"}]"#);
    interrupts(&child);
    let mut report = String::new();
    child.stdout.take().expect("a pipe").read_to_string(&mut report).expect("text");
    assert_eq!(ends(child), 0);
    let report: Value = serde_json::from_str(&report).expect("a report");
    assert!(report["job"] == "edit" && report["accepted"] == 1 && report["nails"] == 2, "{report}");
    assert_eq!(dir.names_of("set"), ["a.json", "a.png", "b.json", "b.png"]);
}

#[test]
fn what_can_not_be_corrected_is_said_before_a_page_is_there() {
    let dir = Dir::new();
    dir.lunula(&["edit", "none"]).expect(2).says("none");
    doubtful(&dir, "set/a");
    dir.lunula(&["edit", "set", "--outline", "detect"]).expect(2).says("leave it out");
    let plan = dir.lunula(&["edit", "set", "--plan", "--json"]).expect(0).json();
    assert!(plan.to_string().contains("1 files, 1 with doubtful ones"), "{plan}");
    dir.lunula(&["edit", "set", "--results", "none"]).expect(2).says("none");
}

#[test]
fn results_are_on_the_same_port_where_they_are_asked_for() {
    let dir = Dir::new();
    doubtful(&dir, "set/a");
    dir.nail("other/a");
    dir.lunula(&["photos", "other", "--out", "out"]).expect(0);
    let (mut child, page) = dir.page(&["edit", "set", "--results", "out"]);
    let pages: Value = serde_json::from_str(&page.reads("pages")).expect("JSON");
    assert_eq!(pages[1], json!({"name": "results", "title": "Results"}));
    let runs: Value = serde_json::from_str(&page.reads("results")).expect("JSON");
    assert_eq!(runs["runs"][0]["job"], "photos");
    let _ = (child.kill(), child.wait());
}

#[test]
fn whatever_keys_are_pressed_undo_goes_back_to_the_beginning() {
    let dir = Dir::new();
    doubtful(&dir, "set/a");
    let file = std::fs::read(dir.path("set/a.json")).expect("a file");
    let desk = Desk::at(&dir.path("set"));
    let (first, axis) = (desk.points(), desk.sees()["nail"]["axis"].clone());
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let plain = ["flip", "insert", "remove", "reset", "zoom", "snap", "undo"];
    for round in 0..40 {
        let pressed = rng.random_range(1..30);
        for _ in 0..pressed {
            let by = [rng.random_range(-3..=3), rng.random_range(-3..=3)];
            let stride = ["fine", "usual", "coarse"][rng.random_range(0..3)];
            let keys = [
                json!({"key": "move", "by": by, "stride": stride}),
                json!({"key": "grow", "by": by, "stride": stride}),
                json!({"key": "turn", "by": by[0], "stride": stride}),
                json!({"key": "turn_axis", "by": by[1]}),
                json!({"key": "corner", "forwards": by[0] > 0}),
                json!({"key": "choose", "corner": if by[0] > 0 { json!(by[0]) } else { Value::Null }}),
                json!({"key": "drag", "gesture": rng.random_range(0..4), "corner": null, "by_px": by}),
                json!({"key": "place", "to_px": [80 + by[0], 70 + by[1]]}),
                json!({"key": plain[rng.random_range(0..plain.len())]}),
            ];
            desk.press(keys[rng.random_range(0..keys.len())].clone());
            assert!(desk.points().iter().flatten().all(|v| v.is_finite()), "{}", desk.sees());
        }
        desk.keys(&vec!["undo"; pressed + 1]);
        assert!(desk.points() == first && desk.sees()["nail"]["axis"] == axis, "{round}: {}", desk.sees());
    }
    // Nothing was accepted, so nothing was written.
    assert!(desk.sees()["nail"]["can_undo"] == false);
    assert_eq!(std::fs::read(dir.path("set/a.json")).expect("a file"), file);
}
