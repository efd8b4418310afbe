//! `lunula photos` with detection on extremes: pictures without a nail, every way of storing one picture, a nail that
//! fills its photograph, forty nails. Real hands, polish, gloves: see `docs/src/jobs/photos.md`.

use std::collections::BTreeMap;

use image::{DynamicImage, Rgb, RgbImage, imageops};
use lunula::labelme::LabelMe;
use lunula::phantom::Generated as _;
use lunula::phantom::nail::Pose;
use lunula::phantom::photos::{LightKind, PhotoOptions};

use crate::util::{Answer, Dir, number, small_set};

type Row = BTreeMap<String, String>;

/// Phantoms as `scene/photos/nominal/sNN.png`, each with its LabelMe file.
fn phantoms(dir: &Dir, count: u32, [width, height]: [u32; 2], seed: u64) {
    let options = small_set(count, &[Pose::Nominal]);
    let options = PhotoOptions { width, height, seed, light: LightKind::Varied, truth_normalized: false, ..options };
    options.write(&dir.path("scene")).expect("synthetic photographs");
}

fn phantom(dir: &Dir, subject: u32) -> RgbImage {
    image::open(dir.path(&format!("scene/photos/nominal/s{subject:02}.png"))).expect("a picture").to_rgb8()
}

/// The corners of the box around a phantom's nail.
fn nail_box(dir: &Dir, subject: u32) -> [[f64; 2]; 2] {
    let file = LabelMe::read(&dir.path(&format!("scene/photos/nominal/s{subject:02}.json"))).expect("LabelMe");
    let nail = file.shapes.iter().find(|shape| shape.label == "nail").expect("a nail");
    let ends =
        |pick: fn(f64, f64) -> f64, start: f64| [0, 1].map(|k| nail.points.iter().map(|p| p[k]).fold(start, pick));
    [ends(f64::min, f64::INFINITY), ends(f64::max, f64::NEG_INFINITY)]
}

fn detect(dir: &Dir, set: &str) -> Answer {
    dir.lunula(&["photos", set, "--out", "out", "--outline", "detect"])
}

fn used(dir: &Dir) -> Vec<Row> {
    dir.table("out/nails.csv").into_iter().filter(|row| row["used"] == "true").collect()
}

#[test]
fn pictures_without_a_nail_give_none_and_the_others_go_on() {
    let dir = Dir::new();
    phantoms(&dir, 1, [480, 360], 1);
    phantom(&dir, 1).save(dir.place("set/good.png")).expect("a picture");
    for (name, colour) in [("black", [0; 3]), ("white", [255; 3]), ("skin", [220, 170, 150])] {
        RgbImage::from_pixel(640, 480, Rgb(colour)).save(dir.place(&format!("set/{name}.png"))).expect("a picture");
    }
    for (name, [width, height]) in [("pixel", [1, 1]), ("line", [1, 2000]), ("strip", [2000, 24])] {
        let picture = RgbImage::from_pixel(width, height, Rgb([220, 170, 150]));
        picture.save(dir.place(&format!("set/{name}.png"))).expect("a picture");
    }
    let answer = detect(&dir, "set").expect(1);
    for (name, words) in [
        ("black", "nothing on the picture looks like a nail; draw its outline"),
        ("white", "nothing on the picture"),
        ("skin", "nothing on the picture"),
        ("strip", "nothing on the picture"),
        ("pixel", "it needs at least 24 x 24 pixels"),
        ("line", "it needs at least 24 x 24 pixels"),
    ] {
        let line = answer.stderr.lines().find(|line| line.starts_with(&format!("failed: {name}.png: ")));
        assert!(line.is_some_and(|line| line.contains(words)), "{name}: {}", answer.stderr);
    }
    let rows = used(&dir);
    assert!(rows.len() == 1 && rows[0]["file"] == "good.png", "{rows:?}");
    assert!(dir.path("out/figures/outlines-1.png").is_file());
    // Without the good one there are no maps, and the sheet all the same.
    std::fs::remove_file(dir.path("set/good.png")).expect("removed");
    std::fs::remove_dir_all(dir.path("out")).expect("removed");
    detect(&dir, "set").expect(1).says("not one nail could be used, so there are no maps; out/report.html shows");
    assert!(dir.path("out/figures/outlines-1.png").is_file() && !dir.path("out/maps").exists());
}

/// As PNG with EXIF that says how it is to be turned.
pub(crate) fn save_turned(picture: &RgbImage, orientation: u8, place: std::path::PathBuf) {
    let mut tiff = *b"II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0\x00\0\0\0\0\0\0\0";
    tiff[18] = orientation;
    let mut encoder = image::codecs::png::PngEncoder::new(std::fs::File::create(place).expect("a file"));
    image::ImageEncoder::set_exif_metadata(&mut encoder, tiff.to_vec()).expect("PNG holds EXIF");
    let [width, height] = [picture.width(), picture.height()];
    let colour = image::ExtendedColorType::Rgb8;
    image::ImageEncoder::write_image(encoder, picture, width, height, colour).expect("a picture");
}

/// What a camera stores with orientations 1 to 8, so that each one's turn makes the picture upright again.
pub(crate) fn stored(upright: &RgbImage) -> [RgbImage; 8] {
    let (turned, turned_back) = (imageops::rotate90(upright), imageops::rotate270(upright));
    [
        upright.clone(),
        imageops::flip_horizontal(upright),
        imageops::rotate180(upright),
        imageops::flip_vertical(upright),
        imageops::flip_horizontal(&turned),
        turned_back.clone(),
        imageops::flip_horizontal(&turned_back),
        turned,
    ]
}

#[test]
fn however_a_picture_is_stored_the_same_nail_is_found() {
    let dir = Dir::new();
    phantoms(&dir, 1, [480, 360], 1);
    let upright = phantom(&dir, 1);
    for (orientation, picture) in (1..).zip(&stored(&upright)) {
        save_turned(picture, orientation, dir.place(&format!("set/colour/exif{orientation}.png")));
    }
    let colour = DynamicImage::from(upright);
    let grey = DynamicImage::from(colour.to_luma8());
    for (name, picture) in [
        ("colour/alpha", DynamicImage::from(colour.to_rgba8())),
        ("colour/sixteen", DynamicImage::from(colour.to_rgb16())),
        ("grey/plain", grey.clone()),
        ("grey/alpha", DynamicImage::from(grey.to_luma_alpha8())),
        ("grey/sixteen", DynamicImage::from(grey.to_luma16())),
    ] {
        picture.save(dir.place(&format!("set/{name}.png"))).expect("a picture");
    }
    detect(&dir, "set");
    let rows = dir.table("out/nails.csv");
    assert_eq!(rows.iter().filter(|row| row["pose"] == "colour").count(), 10, "{rows:?}");
    assert_eq!(rows.iter().filter(|row| row["pose"] == "grey").count(), 3, "{rows:?}");
    let figures = |row: &Row| {
        ["confidence", "center_x_px", "center_y_px", "length_px", "width_px", "axis_deg"].map(|name| row[name].clone())
    };
    for of_pose in rows.chunk_by(|a, b| a["pose"] == b["pose"]) {
        for row in of_pose {
            assert_eq!(figures(row), figures(&of_pose[0]), "{}", row["file"]);
        }
    }
    assert!(rows.iter().any(|row| row["pose"] == "colour" && row["used"] == "true"));
}

#[test]
fn a_nail_that_fills_its_photograph_is_right_or_not_used() {
    /// The photograph's size over the nail's.
    const LOOSE: f64 = 1.3;
    /// Relative, of centre and size. Measured 0.02.
    const MOST_OFF: f64 = 0.1;
    let dir = Dir::new();
    phantoms(&dir, 4, [1200, 900], 5);
    let mut truths = BTreeMap::new();
    for subject in 1..=4 {
        let [low, high] = nail_box(&dir, subject);
        let half = [0, 1].map(|k| 0.5 * LOOSE * (high[k] - low[k]));
        let corner = [0, 1].map(|k| (0.5 * (low[k] + high[k]) - half[k]).max(0.0));
        let [x, y, width, height] = [corner[0], corner[1], 2.0 * half[0], 2.0 * half[1]].map(|v| v as u32);
        let name = format!("s{subject}.png");
        imageops::crop_imm(&phantom(&dir, subject), x, y, width, height)
            .to_image()
            .save(dir.place(&format!("set/{name}")))
            .expect("a picture");
        let length = (high[0] - low[0]).max(high[1] - low[1]);
        truths.insert(name, ([0, 1].map(|k| 0.5 * (low[k] + high[k]) - f64::from([x, y][k])), length));
    }
    detect(&dir, "set");
    let rows = used(&dir);
    // Measured 4 of 4.
    assert!(rows.len() >= 2, "{} of 4 used", rows.len());
    for row in &rows {
        let (centre, length) = truths[&row["file"]];
        let off = (number(row, "center_x_px") - centre[0]).hypot(number(row, "center_y_px") - centre[1]) / length;
        assert!(off <= MOST_OFF, "{}: {off:.3} of its length off", row["file"]);
    }
}

#[test]
fn of_forty_nails_none_is_found_twice_or_elsewhere() {
    let dir = Dir::new();
    phantoms(&dir, 40, [160, 120], 9);
    let mut group = RgbImage::new(8 * 160, 5 * 120);
    let mut places = Vec::new();
    for subject in 1..=40 {
        let corner = [(subject - 1) % 8 * 160, (subject - 1) / 8 * 120];
        imageops::replace(&mut group, &phantom(&dir, subject), corner[0].into(), corner[1].into());
        places.push(nail_box(&dir, subject).map(|end| [0, 1].map(|k| end[k] + f64::from(corner[k]))));
    }
    group.save(dir.place("set/group.png")).expect("a picture");
    detect(&dir, "set").expect(0);
    let rows = used(&dir);
    // Measured 30.
    assert!(rows.len() >= 20, "{} of 40 found", rows.len());
    let mut found = std::collections::BTreeSet::new();
    for row in &rows {
        let at = [number(row, "center_x_px"), number(row, "center_y_px")];
        let within = |[low, high]: &[[f64; 2]; 2]| (0..2).all(|k| low[k] <= at[k] && at[k] <= high[k]);
        let place = places.iter().position(within);
        assert!(place.is_some_and(|place| found.insert(place)), "{at:?} is no nail, or one found before");
    }
}

/// The pixels of this colour, about: thin lines are blended with what is below.
fn count_of(picture: &RgbImage, colour: [u8; 3]) -> usize {
    picture.pixels().filter(|pixel| (0..3).all(|k| pixel.0[k].abs_diff(colour[k]) <= 60)).count()
}

#[test]
fn what_is_left_out_of_drawn_outlines_is_red_on_the_sheet() {
    let dir = crate::photos_doubtful::finger_beside_nails();
    dir.lunula(&["photos", "set", "--out", "out", "--masks", "masks", "--distal", "up"]).expect(0);
    let sheet = image::open(dir.path("out/figures/outlines-1.png")).expect("a sheet").to_rgb8();
    // The legend has about 100 and 50 of each.
    let [green, red] = [[0, 205, 60], [255, 70, 60]].map(|colour| count_of(&sheet, colour));
    assert!(green >= 150 && red >= 250, "{green} green, {red} red");
}
