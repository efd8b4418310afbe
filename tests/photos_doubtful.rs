//! `lunula photos` on what looks right and is not: axes and outlines that the picture contradicts, masks that are
//! pictures, bits that are missing; and on names and sizes that would cost more than their own photograph.

use image::{DynamicImage, GrayImage, ImageBuffer, Luma};
use lunula::labelme::LabelMe;
use lunula::phantom::Generated as _;
use lunula::phantom::nail::Pose;
use lunula::phantom::photos::LightKind;

use crate::util::desk::Desk;
use crate::util::{Dir, drawn_axis, drawn_nail, drawn_outline, labelme, number, small_set};

/// Eight close-ups, annotated; of all of them the picture is sure of its axis.
fn close_ups() -> Dir {
    let dir = Dir::new();
    let mut options = small_set(8, &[Pose::Nominal]);
    (options.light, options.seed, options.truth_normalized) = (LightKind::Varied, 3, false);
    options.write(&dir.path("scene")).expect("synthetic photographs");
    dir
}

/// Changes LabelMe files of the close-ups.
fn redraw(dir: &Dir, subjects: std::ops::RangeInclusive<usize>, change: impl Fn(&mut LabelMe)) {
    for subject in subjects {
        let path = dir.path(&format!("scene/photos/nominal/s0{subject}.json"));
        let mut file = LabelMe::read(&path).expect("LabelMe");
        change(&mut file);
        file.write(&path).expect("written");
    }
}

/// Reasons of the nails that are left out, and how many are used.
fn left_out(dir: &Dir) -> (Vec<String>, usize) {
    let rows = dir.table("out/nails.csv");
    let used = rows.iter().filter(|row| row["used"] == "true").count();
    (rows.iter().filter(|row| row["used"] != "true").map(|row| row["reason"].clone()).collect(), used)
}

#[test]
fn a_reversed_axis_is_doubted_unless_it_is_said_twice() {
    let dir = close_ups();
    dir.lunula(&["photos", "scene/photos", "--out", "out"]).expect(0);
    assert_eq!(left_out(&dir), (vec![], 8));
    redraw(&dir, 1..=8, |file| file.shapes.iter_mut().filter(|s| s.label == "axis").for_each(|s| s.points.reverse()));
    let answer = dir.lunula(&["photos", "scene/photos", "--out", "out"]);
    assert_eq!(answer.code, 1, "{}", answer.stderr);
    let (reasons, used) = left_out(&dir);
    // Measured: 7 of 8 here, 187 of 240 in all.
    assert!(used <= 2, "{used} reversed ones used");
    for reason in &reasons {
        assert!(reason.contains("its drawn axis is at") && reason.contains("by the picture at"), "{reason}");
    }
    dir.lunula(&["photos", "scene/photos", "--out", "out", "--distal", "down"]).expect(0);
    assert_eq!(left_out(&dir).1, 8);
}

#[test]
fn outlines_drawn_beside_the_nail_are_warned_of_where_that_is_requested() {
    let dir = close_ups();
    let job = ["photos", "scene/photos", "--out", "out"];
    let check = [&job[..], &["--check-outlines"]].concat();
    dir.lunula(&check).expect(0).never_says("by the network");
    // A fifth of the length too far distal, which is up in these.
    let length_px = number(&dir.table("out/nails.csv")[2], "length_px");
    redraw(&dir, 3..=3, |file| {
        file.shapes.iter_mut().flat_map(|shape| &mut shape.points).for_each(|point| point[1] -= 0.2 * length_px);
    });
    dir.lunula(&job).expect(0).never_says("by the network");
    let plan = [&job[..], &["--plan"]].concat();
    dir.lunula(&plan).expect(0).prints("--check-outlines looks at them");
    let asked = dir.lunula(&check).expect(0);
    asked
        .says("1 of 8 outlines are not where the nail is: nominal/s03.png, nail 1 (the nail is seen 0.")
        .says("proximal");
    let desk = Desk::at(&dir.path("scene/photos"));
    // The first photograph is shown while others are looked at.
    assert_eq!(desk.sees()["nail"]["photo"], "nominal/s01.png");
    desk.editor.key(br#"{"key":"next"}"#);
    let nail = desk.sees()["nail"].clone();
    assert_eq!(nail["photo"], "nominal/s03.png", "{nail}");
    assert!(nail["why"].as_str().is_some_and(|why| why.contains("further proximal")), "{nail}");
}

#[test]
fn labelme_files_without_a_size_are_noted_and_warned_of_where_they_do_not_fit() {
    let dir = close_ups();
    let job = ["photos", "scene/photos", "--out", "out"];
    redraw(&dir, 1..=7, |file| (file.image_width, file.image_height) = (None, None));
    let fitting = dir.lunula(&job).expect(0);
    let what = "7 LabelMe file(s) don't say the size of the picture they were drawn on (imageWidth, imageHeight";
    fitting.says(&format!("note: {what}; nominal/s01.png first)")).never_says("warning");
    let check = [&job[..], &["--check-outlines"]].concat();
    dir.lunula(&check).expect(0).never_says("LabelMe file(s)");
    // As drawn on a picture three times as large.
    redraw(&dir, 3..=3, |file| {
        file.shapes.iter_mut().flat_map(|shape| &mut shape.points).for_each(|point| *point = point.map(|at| 3.0 * at));
    });
    dir.lunula(&job)
        .expect(1)
        .says(&format!("warning: {what}), and on 1 of these photographs (nominal/s03.png first)"));
}

#[test]
fn a_nail_that_is_drawn_twice_is_named() {
    let dir = close_ups();
    let job = ["photos", "scene/photos", "--out", "out"];
    dir.lunula(&job).expect(0).never_says("over one another");
    // Smaller and a little to the side, as by a second hand; beside the first, as a neighbour that touches it.
    let twice = |scale: f64, aside: f64| {
        redraw(&dir, 2..=3, |file| {
            file.shapes.truncate(2);
            let mut again = file.shapes.iter().find(|shape| shape.label == "nail").expect("a nail").clone();
            let width = 2.0 * again.points.iter().map(|point| (point[0] - 160.0).abs()).fold(0.0, f64::max);
            again.points.iter_mut().for_each(|point| *point = point.map(|at| scale * at + (1.0 - scale) * 140.0));
            again.points.iter_mut().for_each(|point| point[0] += aside * width);
            again.group_id = None;
            file.shapes.push(again);
        });
        dir.lunula(&job)
    };
    twice(0.9, 0.0).says("nominal/s02.png, nail 2 over nail 1, nominal/s03.png, nail 2 over nail 1; a nail that is");
    twice(1.0, 0.9).never_says("over one another");
}

#[test]
fn distal_against_the_picture_is_doubted() {
    let dir = close_ups();
    redraw(&dir, 1..=8, |file| file.shapes.retain(|s| s.label != "axis"));
    dir.lunula(&["photos", "scene/photos", "--out", "out", "--distal", "up"]).expect(0);
    assert_eq!(left_out(&dir), (vec![], 8));
    dir.lunula(&["photos", "scene/photos", "--out", "out", "--distal", "down"]).expect(1);
    let (reasons, used) = left_out(&dir);
    assert!(used <= 2, "{used} reversed ones used");
    assert!(reasons.iter().all(|reason| reason.contains("by --distal its axis is at")), "{reasons:?}");
}

#[test]
fn a_picture_turned_after_it_was_drawn_on_is_doubted() {
    let dir = close_ups();
    for subject in 1..=8 {
        let path = dir.path(&format!("scene/photos/nominal/s0{subject}.png"));
        image::open(&path).expect("a picture").rotate180().save(&path).expect("written");
    }
    let answer = dir.lunula(&["photos", "scene/photos", "--out", "out"]);
    assert!(matches!(answer.code, 1 | 2), "{}", answer.stderr);
    // A nail in the middle of its picture, as here, fits a mirrored picture as well.
    let says =
        |line: &&str| line.contains("by the picture at") || line.contains("the annotation fits the picture better");
    let doubted = answer.stderr.lines().filter(says).count();
    assert!(doubted >= 6, "{doubted} of 8: {}", answer.stderr);
}

#[test]
fn coordinates_that_a_program_wrote_as_row_and_column_are_doubted() {
    let dir = close_ups();
    redraw(&dir, 1..=8, |file| {
        file.shapes.iter_mut().flat_map(|shape| &mut shape.points).for_each(|point| point.reverse());
    });
    let answer = dir.lunula(&["photos", "scene/photos", "--out", "out"]);
    assert!(matches!(answer.code, 1 | 2), "{}", answer.stderr);
    let doubted = answer.stderr.lines().filter(|line| line.contains("with x and y exchanged")).count();
    assert!(doubted >= 6, "{doubted} of 8: {}", answer.stderr);
}

/// Two nails painted white on a hand in grey, the ground black.
fn painted_hand(skin: u8) -> GrayImage {
    let within = |x: u32, y: u32, centre: [f64; 2], half: [f64; 2]| {
        ((f64::from(x) - centre[0]) / half[0]).powi(2) + ((f64::from(y) - centre[1]) / half[1]).powi(2) <= 1.0
    };
    GrayImage::from_fn(160, 140, |x, y| {
        let nail = within(x, y, [50.0, 60.0], [12.0, 16.0]) || within(x, y, [110.0, 60.0], [12.0, 16.0]);
        let finger = within(x, y, [50.0, 80.0], [22.0, 50.0]) || within(x, y, [110.0, 80.0], [22.0, 50.0]);
        let shade = skin + (x % 7) as u8;
        Luma([if nail {
            255
        } else if finger {
            shade
        } else {
            0
        }])
    })
}

#[test]
fn a_grey_picture_is_no_mask_unless_its_values_are_said() {
    let dir = Dir::new();
    drawn_nail().save(dir.place("set/a.png")).expect("a picture");
    painted_hand(150).save(dir.place("masks/a.png")).expect("a mask");
    let run = ["photos", "set", "--out", "out", "--masks", "masks", "--distal", "up"];
    dir.lunula(&run).refuses(&["masks/a.png", "a grey picture rather than a mask", "--mask-value 250..255"]);
    dir.lunula(&[&run[..], &["--mask-value", "250..255"]].concat()).expect(0);
    let rows = dir.table("out/nails.csv");
    let widths: Vec<f64> = rows.iter().map(|row| row["width_px"].parse().expect("a number")).collect();
    assert!(widths.len() == 2 && widths.iter().all(|width| (width - 24.0).abs() <= 2.0), "{widths:?}");
    assert_eq!(dir.parsed("out/run.json")["options"]["mask_value"], "250..255");
    dir.lunula(&[&run[..], &["--mask-value", "10..12"]].concat())
        .expect(2)
        .says("no pixel of the mask has a value of 10..12");
    dir.lunula(&[&run[..], &["--mask-value", "9..1"]].concat()).expect(2).says("250..255");
    // A JPEG's grey lies along edges.
    let two_valued =
        GrayImage::from_fn(160, 140, |x, y| Luma([if painted_hand(0).get_pixel(x, y).0[0] == 255 { 255 } else { 0 }]));
    two_valued.save(dir.place("masks/a.jpg")).expect("a mask");
    std::fs::remove_file(dir.path("masks/a.png")).expect("removed");
    dir.lunula(&run).expect(0);
}

/// A photograph whose mask has two nails and a region as large as a finger.
pub(crate) fn finger_beside_nails() -> Dir {
    let dir = Dir::new();
    drawn_nail().save(dir.place("set/a.png")).expect("a picture");
    let mask = GrayImage::from_fn(160, 140, |x, y| {
        let nails = (60..72).contains(&y) && [10, 40].iter().any(|from| (*from..from + 10).contains(&x));
        let finger = (90..120).contains(&x) && (10..130).contains(&y);
        Luma([if nails || finger { 255 } else { 0 }])
    });
    mask.save(dir.place("masks/a.png")).expect("a mask");
    dir
}

#[test]
fn a_region_as_large_as_a_finger_is_doubted() {
    let dir = finger_beside_nails();
    let run = ["photos", "set", "--out", "out", "--masks", "masks", "--distal", "up"];
    dir.lunula(&run).expect(0);
    let (reasons, used) = left_out(&dir);
    assert!(
        used == 2 && reasons.len() == 1 && reasons[0].contains("times as long as the mask's others"),
        "{reasons:?}"
    );
    // Of two regions nobody knows which is the nail: a slip of the brush is the smaller one.
    let slip = GrayImage::from_fn(160, 140, |x, y| {
        let dab = (10..20).contains(&x) && (60..72).contains(&y);
        Luma([if dab || (60..100).contains(&x) && (30..110).contains(&y) { 255 } else { 0 }])
    });
    slip.save(dir.place("masks/a.png")).expect("a mask");
    dir.lunula(&run).expect(2).says("one of them is none, and it isn't known which");
    let inverted = GrayImage::from_fn(160, 140, |x, y| Luma([255 - painted_hand(0).get_pixel(x, y).0[0]]));
    inverted.save(dir.place("masks/a.png")).expect("a mask");
    dir.lunula(&run).expect(2).says("is the mask inverted");
}

#[test]
fn a_photograph_without_a_mask_is_named_where_masks_are_given() {
    let dir = finger_beside_nails();
    let run = ["photos", "set", "--out", "out", "--masks", "masks", "--distal", "up"];
    dir.lunula(&run).expect(0).never_says("have no mask");
    drawn_nail().save(dir.place("set/b.png")).expect("a picture");
    std::fs::copy(dir.path("masks/a.png"), dir.path("masks/b_mask.png")).expect("a copy");
    dir.lunula(&run)
        .expect(1)
        .says("1 of 2 photographs have no mask in masks (b.png first), and their nails are sought")
        .says("masks/b.png or masks/set/b.png");
}

/// The drawn nail in 16 bits of which `white` is full scale.
fn few_bits(white: u32) -> DynamicImage {
    let pixels = drawn_nail();
    ImageBuffer::from_fn(160, 140, |x, y| {
        image::Rgb(pixels.get_pixel(x, y).0.map(|v| ((u32::from(v) * white + 127) / 255) as u16))
    })
    .into()
}

#[test]
fn twelve_bits_in_sixteen_are_noted_and_mended() {
    let dir = Dir::new();
    for (set, white) in [("twelve", 4095), ("sixteen", 65_535)] {
        for subject in ["a", "b"] {
            dir.photo(&format!("{set}/p/{subject}"), few_bits(white), crate::util::drawn_labels());
        }
    }
    let answer = dir.lunula(&["photos", "twelve", "--out", "dark"]).expect(0);
    assert_eq!(answer.stderr.matches("--white 4095").count(), 1, "{}", answer.stderr);
    answer.says("of 65535, as of 12 bits kept in 16");
    dir.lunula(&["photos", "sixteen", "--out", "right"]).expect(0).never_says("--white");
    dir.lunula(&["photos", "twelve", "--out", "mended", "--white", "4095"]).expect(0).never_says("--white");
    let [dark, right, mended] = ["dark", "right", "mended"].map(|out| dir.array(&format!("{out}/maps/p-mean.npy")));
    for ((dark, right), mended) in dark.iter().zip(&right).zip(&mended) {
        assert!(
            (mended - right).abs() <= 1.0 / 4095.0 && (dark * 16.0 - right).abs() <= 1e-2,
            "{dark} {right} {mended}"
        );
    }
    let report = dir.parsed("mended/run.json");
    assert_eq!((&report["normalization"]["white"], &report["options"]["white"]), (&4095.into(), &"4095".into()));
    // Parts made with another white don't add up.
    dir.lunula(&["photos", "merge", "dark", "mended", "--out", "both"]).expect(2).says("\"white\":4095");
    dir.lunula(&["photos", "twelve", "--out", "out", "--white", "3000"]).expect(2).says("above --white 3000");
    dir.nail("eight/a");
    dir.lunula(&["photos", "eight", "--out", "out", "--white", "4095"]).expect(2).says("has 8 bits a channel");
    dir.lunula(&["photos", "twelve", "--out", "out", "--white", "7"]).expect(2).says("255 to 65535");
    assert!(!dir.path("out").exists());
}

#[test]
fn an_outline_mostly_outside_of_the_picture_is_left_out() {
    let dir = Dir::new();
    dir.nail("set/a");
    for (subject, [dx, dy]) in [("b", [85.0, 0.0]), ("c", [101.0, 0.0]), ("d", [69.9, -80.0])] {
        let moved = |points: Vec<[f64; 2]>| points.into_iter().map(|[x, y]| [x + dx, y + dy]).collect::<Vec<_>>();
        let shapes = [("nail", "polygon", moved(drawn_outline())), ("axis", "line", moved(drawn_axis()))];
        dir.photo(&format!("set/{subject}"), drawn_nail(), labelme([160, 140], &shapes));
    }
    let answer = dir.lunula(&["photos", "set", "--out", "out"]).expect(1);
    for (subject, words) in [("b", "59 % of its box lies outside"), ("c", "86 % of its box"), ("d", "75 % of its box")]
    {
        let line = answer.stderr.lines().find(|line| line.contains(&format!("{subject}.png"))).unwrap_or_default();
        assert!(line.contains(words), "{subject}: {}", answer.stderr);
    }
    assert_eq!(left_out(&dir).1, 1);
}

/// Masks of another photograph, and people and poses of two spellings.
#[test]
fn outlines_around_which_no_finger_is_seen_are_warned_of() {
    let dir = Dir::new();
    dir.nail("set/rest/ben");
    for subject in ["Anna", "anna"] {
        for pose in ["rest", "press"] {
            let skin = image::RgbImage::from_pixel(160, 140, image::Rgb([170, 90, 80]));
            skin.save(dir.place(&format!("set/{pose}/{subject}.png"))).expect("a picture");
            let mask = GrayImage::from_fn(160, 140, |x, y| {
                let (u, v) = ((f64::from(x) - 80.0) / 30.0, (f64::from(y) - 70.0) / 40.0);
                Luma([if u * u + v * v <= 1.0 { 255 } else { 0 }])
            });
            mask.save(dir.place(&format!("masks/{pose}/{subject}.png"))).expect("a mask");
        }
    }
    let photos = |more: &[&str]| dir.lunula(&[&["photos", "set", "--masks", "masks", "--out", "out"], more].concat());
    let answer =
        photos(&[]).expect(1).says("around 4 of 5 outlines no finger's direction is clear (press/Anna.png first)");
    answer.says("subjects `Anna` and `anna` differ in case or spaces only, and count apart");
    photos(&["--distal", "up"]).expect(0).never_says("no finger's direction");
}

#[test]
fn giant_sizes_cost_only_their_own_photograph() {
    let dir = Dir::new();
    dir.nail("set/a");
    for (subject, far) in [("b", 1e10), ("c", -1e300), ("d", 5000.0)] {
        let mut points = drawn_outline();
        points[7][0] = far;
        dir.photo(&format!("set/{subject}"), drawn_nail(), labelme([160, 140], &[("nail", "polygon", points)]));
    }
    GrayImage::new(1200, 1000).save(dir.place("set/e.png")).expect("a picture");
    let answer = dir.lunula(&["photos", "set", "--out", "out", "--max-megapixels", "1"]).expect(1);
    let far = answer.stderr.matches("lies far outside of the photograph (160 x 140 px)").count();
    assert_eq!(far, 3, "{}", answer.stderr);
    answer.says("e.png: has 1200 x 1000 px, 1.2 megapixels, more than the 1");
    assert_eq!(left_out(&dir).1, 1);
}

#[test]
fn a_name_too_long_for_files_of_results_costs_only_itself() {
    let dir = Dir::new();
    dir.nail("set/a");
    dir.nail("set/b");
    let long = "s".repeat(300);
    dir.write("set/photos.csv", format!("file,subject,pose,outline\na.png,a,p,a.json\nb.png,{long},p,b.json\n"));
    dir.lunula(&["photos", "set", "--out", "out"]).expect(1).says("photos.csv, line 3: a subject of 300 bytes");
    assert_eq!(left_out(&dir).1, 1);
    dir.nail(&format!("folder/{}", "é".repeat(120)));
    dir.nail("folder/a");
    dir.lunula(&["photos", "folder", "--out", "out"]).expect(1).says("a subject of 240 bytes");
}

#[test]
fn results_are_not_put_among_the_photographs() {
    let dir = Dir::new();
    for name in ["flat/a", "flat/b", "set/p/a", "set/p/b"] {
        dir.nail(name);
    }
    for (set, out) in [("flat", "flat"), ("set", "set"), ("set", "set/p"), ("set", "set/../set/p/")] {
        let before = dir.bytes_of(set);
        dir.lunula(&["photos", set, "--out", out]).expect(2).says("choose another --out");
        assert!(dir.bytes_of(set) == before);
    }
    // A folder of its own within the set is not taken for photographs, this time and the next.
    for out in ["flat/out", "flat/again"] {
        let report = dir.lunula(&["photos", "flat", "--out", out, "--json"]).expect(0).json();
        assert_eq!((&report["counts"]["photographs"], report["failed"].as_array().map(Vec::len)), (&2.into(), Some(0)));
    }
}

#[cfg(unix)]
#[test]
fn control_characters_of_names_are_escaped() {
    let dir = Dir::new();
    dir.nail("set/a");
    dir.write("set/d\u{1b}[2J\rb\n.png", "no picture");
    let answer = dir.lunula(&["photos", "set", "--out", "out", "--json"]).expect(1);
    assert!(answer.stderr.contains("failed: d\\u{1b}[2J\\rb\\n.png: is not a PNG"), "{:?}", answer.stderr);
    assert!(!answer.stderr.contains(['\u{1b}', '\r']));
    let failed = answer.json()["failed"][0].as_str().expect("words").to_owned();
    assert!(failed.starts_with("d\\u{1b}[2J\\rb\\n.png: is not a PNG"), "{failed:?}");
    std::fs::remove_file(dir.path("set/a.png")).expect("removed");
    dir.words("photos set --out other").expect(2).says("\n  d\\u{1b}[2J\\rb\\n.png: ").never_says("\u{1b}");
}

#[test]
fn an_overexposed_nail_is_warned_of() {
    let dir = close_ups();
    let file = dir.path("scene/photos/nominal/s02.png");
    let picture = image::open(&file).expect("a picture").to_rgb16();
    let [largest, median] = {
        let mut green: Vec<u16> = picture.pixels().map(|pixel| pixel.0[1]).collect();
        green.sort_unstable();
        [green[green.len() - 1], green[green.len() / 2]].map(f64::from)
    };
    let exposed = |times: f64| {
        let mut picture = picture.clone();
        let brighter = |value: &mut u16| *value = (f64::from(*value) * times).min(65535.0) as u16;
        picture.pixels_mut().for_each(|pixel| pixel.0.iter_mut().for_each(brighter));
        image::DynamicImage::ImageRgb16(picture).to_rgb8().save(&file).expect("a picture");
        dir.lunula(&["photos", "scene/photos", "--out", "out"]).expect(0).stderr
    };
    assert_eq!(exposed(0.98 * 65535.0 / largest), "");
    let warned = exposed(1.2 * 65535.0 / median);
    assert!(warned.contains("nails are overexposed (nominal/s02.png first; up to "), "{warned}");
    let nails = dir.table("out/nails.csv");
    let reason = |file: &str| nails.iter().find(|row| row["file"] == file).expect("a row")["reason"].clone();
    assert!(reason("nominal/s02.png").ends_with("% of it is at full scale (overexposed)"), "{nails:?}");
    assert_eq!(reason("nominal/s03.png"), "");
}

#[test]
fn outlines_of_another_photograph_are_warned_of_and_renamed_photographs_are_not() {
    let dir = close_ups();
    // Some of the mixed-up outlines are refused besides, as the picture contradicts their axes.
    let said = |dir: &Dir| dir.lunula(&["photos", "scene/photos", "--out", "out"]).stderr;
    assert_eq!(said(&dir), "");
    let at = |name: &str| dir.path(&format!("scene/photos/nominal/{name}"));
    let swap = |a: &str, b: &str| {
        std::fs::rename(at(a), at("kept")).expect("moved");
        std::fs::rename(at(b), at(a)).expect("moved");
        std::fs::rename(at("kept"), at(b)).expect("moved");
    };
    swap("s02.json", "s03.json");
    let mixed = said(&dir);
    let expected = "warning: nominal/s02.png: its outline says that it was drawn on another photograph, ";
    assert!(mixed.contains(expected) && mixed.contains("s03.png (imagePath), and so do those of 1 more"), "{mixed}");
    // One that was renamed with its photograph names what is there no more.
    swap("s02.json", "s03.json");
    std::fs::rename(at("s04.png"), at("anna.png")).expect("moved");
    std::fs::rename(at("s04.json"), at("anna.json")).expect("moved");
    assert!(!said(&dir).contains("another photograph"));
}
