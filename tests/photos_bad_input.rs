//! `lunula photos` on what goes wrong on a Monday morning: each case names file and place, says what to do, and costs
//! no more than itself.

use std::process::Command;

use crate::photos_extremes::save_turned;
use crate::util::page::until;
use crate::util::{Dir, drawn_axis, drawn_labels, drawn_nail, drawn_outline, labelme};

/// A set of three good photographs.
fn good_set() -> Dir {
    let dir = Dir::new();
    for subject in ["a", "b", "c"] {
        dir.nail(&format!("set/{subject}"));
    }
    dir
}

/// Subjects whose nails were used.
fn used(dir: &Dir) -> Vec<String> {
    dir.table("out/nails.csv").into_iter().filter(|r| r["used"] == "true").map(|r| r["subject"].clone()).collect()
}

/// Runs on the set and expects its good photographs done, one failure named with `words`.
#[track_caller]
fn costs_only_itself(dir: &Dir, words: &[&str]) {
    let answer = dir.lunula(&["photos", "set", "--out", "out"]).expect(1);
    let failed: Vec<&str> = answer.stderr.lines().filter(|l| l.starts_with("failed: ")).collect();
    assert_eq!(failed.len(), 1, "{}", answer.stderr);
    for words in words {
        assert!(failed[0].contains(words), "`{words}` is not in {}", failed[0]);
    }
    assert_eq!(used(dir), ["a", "b", "c"]);
}

#[test]
fn several_files_where_one_is_taken_are_answered_with_the_way_to_batches() {
    let dir = good_set();
    let photographs = ["photos", "set/a.png", "set/b.png", "--out", "out"];
    let cases: [(&[&str], &str, &str); 4] = [
        (&photographs, "'set/b.png'", "lunula photos FOLDER --out RESULTS"),
        (&["photos", "set", "--write-outlines", "drawn", "--out", "out"], "'drawn'", "--write-outlines"),
        (&["edit", "set/a.png", "set/b.png"], "'set/b.png'", "lunula edit FOLDER"),
        (&["posture", "--quiet", "a.mp4", "b.mp4", "--out", "a.csv"], "'b.mp4'", "lunula init FOLDER"),
    ];
    for (arguments, extra, tip) in cases {
        dir.lunula(arguments).refuses(&[&format!("unexpected argument {extra} found"), tip, "Usage: lunula "]);
    }
    dir.lunula(&["phantom", "photos", "set", "--out", "out"]).expect(2).never_says("FOLDER");
    // An option that isn't there is no file.
    dir.lunula(&["posture", "a.mp4", "--makers", "m.toml"]).expect(2).says("'--markers'").never_says("init");
}

/// Cut files, an empty one, text, formats and samples that are not read.
#[test]
fn a_file_that_is_no_picture_is_named() {
    let folder = Dir::new();
    let whole = |name: &str, picture: image::DynamicImage| {
        let path = folder.place(name);
        picture.save(&path).expect("a picture");
        std::fs::read(path).expect("a file")
    };
    let cut = |name: &str, length: usize| whole(name, drawn_nail().into())[..length].to_vec();
    let jpeg = whole("d.jpg", drawn_nail().into());
    let float = image::Rgb32FImage::from_pixel(160, 140, image::Rgb([0.5; 3])).into();
    for (name, bytes, words) in [
        ("d.jpg", jpeg[..jpeg.len() * 2 / 3].to_vec(), &["truncated JPEG", "copy the file again"][..]),
        ("d.png", b"dear diary".to_vec(), &["not a PNG, JPEG, TIFF or BMP"]),
        ("d.png", cut("d.png", 200), &[]),
        ("d.png", cut("d.png", 0), &[]),
        ("d.tif", cut("d.tif", 300), &[]),
        ("d.bmp", cut("d.bmp", 500), &[]),
        ("d.HEIC", b"ftypheic".to_vec(), &["export it as PNG"]),
        ("d.tiff", whole("d.tiff", float), &["8 or 16 bits"]),
    ] {
        let dir = good_set();
        dir.write(&format!("set/{name}"), bytes);
        dir.write("set/d.json", drawn_labels());
        costs_only_itself(&dir, &[&[name], words].concat());
    }
}

#[test]
fn outlines_that_are_none_are_named_with_their_shape() {
    let nowhere = |points: Vec<[f64; 2]>| points.into_iter().map(|[x, y]| [x + 500.0, y]).collect::<Vec<_>>();
    let crossing = vec![[10.0, 10.0], [90.0, 90.0], [90.0, 10.0], [10.0, 90.0]];
    let speck = vec![[10.0, 10.0], [12.0, 10.0], [12.0, 12.0], [10.0, 12.0]];
    let cases = [
        (vec![("nail", "polygon", vec![[10.0, 10.0], [90.0, 90.0]])], "shape 1: the outline has 2 different point(s)"),
        (
            vec![("other", "polygon", drawn_outline()), ("nail", "polygon", crossing)],
            "shape 2: the outline crosses itself",
        ),
        (vec![("nail", "rectangle", vec![[10.0, 10.0], [90.0, 90.0]])], "draw it as a polygon"),
        (
            vec![("nail", "polygon", nowhere(drawn_outline())), ("axis", "line", nowhere(drawn_axis()))],
            "lies outside of the photograph",
        ),
        (
            vec![("nail", "polygon", speck.clone()), ("axis", "line", vec![[11.0, 12.0], [11.0, 10.0]])],
            "at least 4 are needed",
        ),
        (vec![("finger", "polygon", drawn_outline())], "no polygon labelled `nail`"),
        (
            vec![("nail", "polygon", drawn_outline()), ("axis", "line", nowhere(drawn_axis()))],
            "shape 2 is labelled axis and belongs to no nail",
        ),
        (
            vec![
                ("nail", "polygon", drawn_outline()),
                ("axis", "linestrip", [drawn_axis(), vec![[80.0, 1.0]]].concat()),
            ],
            "shape 2 is labelled axis and belongs to no nail",
        ),
    ];
    for (shapes, words) in cases {
        let dir = good_set();
        dir.photo("set/d", drawn_nail(), labelme([160, 140], &shapes));
        costs_only_itself(&dir, &["d.png", words]);
    }
    let dir = good_set();
    dir.photo("set/d", drawn_nail(), "{\n \"shapes\": [\n".to_owned());
    costs_only_itself(&dir, &["set/d.json", "line 3"]);
}

#[test]
fn one_bad_outline_of_a_photograph_leaves_its_others() {
    let dir = Dir::new();
    let shapes = [
        ("nail", "polygon", vec![[1.0, 1.0], [9.0, 9.0]]),
        ("nail", "polygon", drawn_outline()),
        ("axis", "line", drawn_axis()),
    ];
    dir.photo("set/a", drawn_nail(), labelme([160, 140], &shapes));
    dir.lunula(&["photos", "set", "--out", "out"]).expect(0);
    let rows = dir.table("out/nails.csv");
    assert_eq!(rows.iter().map(|r| r["used"].as_str()).collect::<Vec<_>>(), ["false", "true"]);
    assert!(rows[0]["reason"].contains("2 different point(s)") && rows[0]["length_px"].is_empty());
    assert!(dir.path("out/normalized/set/a-2.png").exists());
}

#[test]
fn an_annotation_or_mask_of_another_picture_is_refused() {
    let dir = good_set();
    dir.photo("set/d", drawn_nail(), labelme([1600, 1400], &[("nail", "polygon", drawn_outline())]));
    costs_only_itself(&dir, &["d.json", "[1600, 1400] px", "[160, 140] px"]);
    std::fs::remove_file(dir.path("set/d.json")).expect("removed");
    image::GrayImage::from_pixel(80, 70, image::Luma([255])).save(dir.place("masks/d.png")).expect("a mask");
    let answer = dir.words("photos set --out out --masks masks").expect(1);
    answer.says("masks/d.png: was drawn on a picture of [80, 70] px");
}

#[test]
fn a_turn_that_the_size_does_not_tell_is_refused_until_it_is_said() {
    let dir = good_set();
    save_turned(&image::imageops::rotate180(&drawn_nail()), 3, dir.place("set/d.png"));
    dir.write("set/d.json", drawn_labels());
    costs_only_itself(&dir, &["d.png", "--annotations upright"]);
    dir.lunula(&["photos", "set", "--out", "out", "--annotations", "upright"]).expect(0);
    let bytes = dir.bytes_of("out");
    assert!(bytes["normalized/set/d.png"] == bytes["normalized/set/a.png"]);
}

#[test]
fn a_subject_twice_in_a_pose_counts_for_none() {
    let dir = good_set();
    drawn_nail().save(dir.place("set/d.png")).expect("a picture");
    drawn_nail().save(dir.place("set/d.bmp")).expect("a picture");
    dir.write("set/d.json", drawn_labels());
    costs_only_itself(&dir, &["d.bmp, d.png", "subject `d` is there 2 times in pose `set`", "remove all but one"]);
}

#[test]
fn a_photograph_under_several_names_is_warned_of() {
    let dir = good_set();
    let answer = dir.lunula(&["photos", "set", "--out", "out"]).expect(0);
    answer.says("warning: a.png, b.png, c.png: the same to the byte, and counted 3 times");
    assert_eq!(used(&dir), ["a", "b", "c"], "which one it is nobody knows");
}

/// The drawn nail at a share of its brightness, with a pattern and a background of its own, so that no two are alike.
fn shaded(share: f64, seed: u32) -> image::RgbImage {
    let mut nail = drawn_nail();
    let beside = |x: u32, y: u32| x < 30 && y / 14 == seed || x > 130 && y / 14 == 3 * seed % 10;
    nail.enumerate_pixels_mut().filter(|(x, y, _)| beside(*x, *y)).for_each(|(.., pixel)| pixel.0 = [90, 50, 40]);
    for (x, y, pixel) in nail.enumerate_pixels_mut() {
        let own = ((x * 7 + y * 13 + seed * 31) % 11) as u8;
        pixel.0 = pixel.0.map(|level| (share * f64::from(level)) as u8 + own);
    }
    nail
}

#[test]
fn photographs_that_may_be_of_another_pose_are_named() {
    let dir = Dir::new();
    let mut rows = Vec::new();
    for (k, (pose, subject)) in ["p", "q"].iter().flat_map(|pose| ["a", "b", "c"].map(|who| (*pose, who))).enumerate() {
        // Each nail was drawn by hand: no two are alike.
        let moved = |points: Vec<[f64; 2]>| points.iter().map(|[x, y]| [x + 0.05 * k as f64, *y]).collect::<Vec<_>>();
        let shapes = [("nail", "polygon", moved(drawn_outline())), ("axis", "line", drawn_axis())];
        dir.photo(&format!("set/{pose}/{subject}"), shaded(1.0, k as u32), labelme([160, 140], &shapes));
        rows.push([format!("{pose}/{subject}.png"), subject.to_owned(), pose.to_owned()]);
    }
    let of = |rows: &[[String; 3]]| {
        let rows: String = rows.iter().map(|row| row.join(",") + "\n").collect();
        dir.write("set/photos.csv", format!("file,subject,pose\n{rows}"));
        dir.lunula(&["photos", "set", "--out", "out"]).expect(0)
    };
    of(&rows).never_says("warning");
    let mut sorted = rows.clone();
    sorted[2][2] = "q".to_owned();
    sorted[5][2] = "p".to_owned();
    of(&sorted).says("q/c.png as c of p, p/c.png as c of q; was a column sorted by itself?");
    of(&rows[..5]).says("1 photograph(s) beside those that photos.csv names are not used");
    let mut misspelt = rows.clone();
    misspelt[..3].iter_mut().for_each(|row| row[2] = "flexion".to_owned());
    misspelt.push(["q/a.png".to_owned(), "d".to_owned(), "flexoin".to_owned()]);
    of(&misspelt)
        .says("pose `flexoin` has 1 photograph(s), and `flexion` 3: is it misspelt?")
        .says("counted more than once: q/a.png as d of flexoin and q/a.png as a of q");
    // An outline that was copied, a photograph that is far too dark, one that was cut off and made darker.
    std::fs::copy(dir.path("set/p/b.json"), dir.path("set/q/b.json")).expect("a copy");
    shaded(0.05, 7).save(dir.place("set/q/c.png")).expect("a picture");
    let mut flat = shaded(1.0, 8);
    flat.pixels_mut().for_each(|pixel| pixel.0 = pixel.0.map(|level| level.min(125)));
    flat.save(dir.place("set/p/a.png")).expect("a picture");
    let mut bgr = shaded(1.0, 9);
    bgr.pixels_mut().for_each(|pixel| pixel.0.reverse());
    bgr.save(dir.place("set/q/a.png")).expect("a picture");
    of(&rows).says_all(&[
        "share one outline to the last digit: p/b.png and q/b.png",
        "far brighter or darker than usual",
        "q/c.png (4.",
        "nail and skin are bluer than red in q/a.png: were red and blue exchanged",
        "1 of 6 nails are flat at their brightest, below full scale (p/a.png first",
    ]);
}

#[test]
fn one_mask_for_two_poses_is_named_though_each_picture_has_its_own_axis() {
    let dir = Dir::new();
    let mask = |moved: f64| {
        image::GrayImage::from_fn(160, 140, |x, y| {
            let (u, v) = ((f64::from(x) - 80.0 - moved) / 30.0, (f64::from(y) - 70.0) / 40.0);
            image::Luma([if u.powi(4) + v.powi(4) <= 1.0 { 255 } else { 0 }])
        })
    };
    for (k, pose) in ["p", "q"].into_iter().enumerate() {
        // A finger that the axis is found by, another one each time.
        let shade = |x: u32| if x.abs_diff(80 + 3 * k as u32) < 36 { 1.0 } else { 0.3 };
        let mut nail = shaded(1.0, k as u32);
        nail.enumerate_pixels_mut().filter(|(_, y, _)| *y > 112).for_each(|(x, _, pixel)| {
            pixel.0 = pixel.0.map(|level| (f64::from(level) * shade(x)) as u8);
        });
        nail.save(dir.place(&format!("set/{pose}/a.png"))).expect("a picture");
    }
    let run = ["photos", "set", "--masks", "masks", "--distal", "up", "--out", "out"];
    mask(0.0).save(dir.place("masks/a.png")).expect("a mask");
    dir.lunula(&run).expect(0).says_all(&[
        "share one outline to the last digit: p/a.png and q/a.png",
        "a mask of each pose is MASKS/<pose>/<subject>.png",
    ]);
    mask(0.0).save(dir.place("masks/p/a.png")).expect("a mask");
    mask(1.0).save(dir.place("masks/q/a.png")).expect("a mask");
    dir.lunula(&run).expect(0).never_says("share one outline");
}

#[test]
fn names_that_only_look_the_same_are_named() {
    let dir = Dir::new();
    let (typed, of_a_mac) = ("Zo\u{eb}", "Zoe\u{308}");
    dir.nail(&format!("set/p/{typed}"));
    dir.nail(&format!("set/q/{of_a_mac}"));
    let run = ["photos", "set", "--out", "out"];
    dir.lunula(&run).expect(0).says("differ in case, spaces or the encoding of accents only, and count apart");
    let beside = dir.path(&format!("set/q/{of_a_mac}.json"));
    std::fs::rename(&beside, dir.path(&format!("set/q/{typed}.json"))).expect("moved");
    let not_found = "1 outline(s) are not found (set/q/Zo\u{eb}.json first): their names look like their photographs'";
    dir.lunula(&run).says(not_found);
    std::fs::rename(dir.path(&format!("set/q/{typed}.json")), beside).expect("moved");
    dir.write("set/photos.csv", format!("file,subject,pose\np/{typed}.png,a,p\nq/{typed}.png,a,q\n"));
    dir.lunula(&run).expect(1).says("line 3: q/Zo\u{eb}.png does not exist beside photos.csv; one is there whose name");
}

#[test]
fn folders_of_people_and_folders_within_poses_are_named() {
    let dir = Dir::new();
    for nail in ["anna/normal", "anna/flexion", "ben/normal", "ben/flexion"] {
        dir.nail(&format!("people/{nail}"));
    }
    let people = dir.lunula(&["photos", "people", "--out", "of-people"]).expect(0);
    people.says("the subjects are called flexion, normal, which are poses, and the poses anna, ben");
    for nail in ["normal/a", "normal/b", "normal/retake/c"] {
        dir.nail(&format!("posed/{nail}"));
    }
    let deeper = dir.lunula(&["photos", "posed", "--out", "of-posed"]).expect(0);
    deeper.says("folders within a pose's are not looked into: 1 picture(s) in normal/retake");
}

#[test]
fn a_manifest_s_faults_are_named_by_line() {
    let dir = good_set();
    let rows = "a.png,a,p\nmissing.png,x,p\n,y,p\nb.png,b,p\nc.png,../up,p\nc.png,c,p\n";
    for end in ["\n", "\r\n"] {
        dir.write("set/photos.csv", format!("file,subject,pose\n{rows}").replace('\n', end));
        dir.words("photos set --out out").expect(1).says_all(&[
            "line 3: missing.png does not exist",
            "line 4: the cell `file` is empty",
            "line 6: `../up`",
        ]);
        assert_eq!(used(&dir), ["a", "b", "c"]);
    }
    dir.write("set/photos.csv", "name;who\na.png;a\n");
    dir.lunula(&["photos", "set", "--out", "out"]).expect(2).says("it needs file,subject,pose");
    dir.write("set/photos.csv", "file,subject,pose\nmissing.png,x,p\n");
    dir.lunula(&["photos", "set", "--out", "out"]).expect(2).says("looked for those that photos.csv names");
    dir.write("set/photos.csv", b"file,subject,pose\na.png,J\xfcrgen,p\n");
    dir.lunula(&["photos", "set", "--out", "out"]).expect(2).says("save it as CSV in UTF-8");
    dir.write("set/photos.csv", "file;subject;pose\na.png;a;p\n");
    dir.lunula(&["photos", "set", "--out", "out"]).expect(0);
}

#[test]
fn a_column_that_is_nearly_one_of_the_manifest_s_is_not_passed_over() {
    let dir = good_set();
    for (own, meant) in [
        ("Outline", "outline"),
        ("outlines", "outline"),
        ("outlnie", "outline"),
        ("outline_file", "outline"),
        ("mask", "outline"),
        ("tones", "tone"),
        ("Skin tone", "tone"),
    ] {
        dir.write("set/photos.csv", format!("file,subject,pose,{own}\na.png,a,p,b.json\n"));
        let answer = dir.lunula(&["photos", "set", "--out", "out"]).expect(2);
        answer.says(&format!("line 1: the column `{own}`")).says(&format!("did you mean `{meant}`?"));
    }
    assert!(!dir.path("out").exists());
    // A laboratory's own, and another name beside the one that is read.
    let own = "age,sex,toe,zone,outlier,online,acetone";
    dir.write("set/photos.csv", format!("file,subject,pose,outline,mask,{own}\na.png,a,p,a.json,old,1,2,3,4,5,6,7\n"));
    dir.lunula(&["photos", "set", "--out", "out"]).expect(0);
    dir.write("set/photos.csv", format!("file,subject,pose,{own}\na.png,a,p,1,2,3,4,5,6,7\n"));
    dir.lunula(&["photos", "set", "--out", "out"]).expect(0);
}

#[test]
fn colour_and_grey_in_a_pose_are_warned_of() {
    let dir = good_set();
    dir.photo("set/d", image::DynamicImage::from(drawn_nail()).to_luma8(), drawn_labels());
    dir.lunula(&["photos", "set", "--out", "out"]).expect(0).says("pose `set` mixes 3 colour and 1 grey photograph(s)");
    // Made in parts as well.
    std::fs::create_dir_all(dir.path("grey/set")).expect("a folder");
    for name in ["d.png", "d.json"] {
        std::fs::rename(dir.path(&format!("set/{name}")), dir.path(&format!("grey/set/{name}"))).expect("moved");
    }
    let parts = [["photos", "set", "--out", "colour"], ["photos", "grey/set", "--out", "green"]];
    parts.iter().for_each(|part| drop(dir.lunula(part).expect(0)));
    let merged = dir.lunula(&["photos", "merge", "colour", "green", "--out", "merged"]).expect(0);
    merged.says("pose `set` mixes 3 colour and 1 grey photograph(s)");
}

/// A nail with a colour profile: its samples are the same as without.
fn nail_with(dir: &Dir, subject: &str, profile: &moxcms::ColorProfile) {
    let file = std::fs::File::create(dir.place(&format!("set/{subject}.png"))).expect("a file");
    let mut encoder = image::codecs::png::PngEncoder::new(file);
    let bytes = profile.encode().expect("a profile");
    image::ImageEncoder::set_icc_profile(&mut encoder, bytes).expect("PNG holds profiles");
    image::DynamicImage::from(drawn_nail()).write_with_encoder(encoder).expect("a picture");
    dir.write(&format!("set/{subject}.json"), drawn_labels());
}

#[test]
fn photographs_of_several_colour_profiles_are_warned_of() {
    let dir = good_set();
    let mixed = "the set mixes colour profiles";
    nail_with(&dir, "d", &moxcms::ColorProfile::new_srgb());
    dir.lunula(&["photos", "set", "--out", "out"]).expect(0).never_says(mixed);
    nail_with(&dir, "e", &moxcms::ColorProfile::new_display_p3());
    let answer = dir.lunula(&["photos", "set", "--out", "out"]).expect(0);
    answer.says(mixed).says("4 photograph(s) of sRGB or none (a.png first)").says("1 photograph(s) of Display P3");
    let bytes = dir.bytes_of("out");
    assert!(bytes["normalized/set/e.png"] == bytes["normalized/set/a.png"], "values are as the file encodes them");
}

#[test]
fn a_curve_that_is_not_srgb_s_is_not_undone() {
    let dir = good_set();
    nail_with(&dir, "d", &moxcms::ColorProfile::new_pro_photo_rgb());
    nail_with(&dir, "e", &moxcms::ColorProfile::new_display_p3());
    let answer = dir.lunula(&["photos", "set", "--linear", "--out", "out"]).expect(1);
    answer.says("failed: d.png: has the colour profile `ProPhoto RGB`, whose curve is not sRGB's");
    assert_eq!(used(&dir), ["a", "b", "c", "e"]);
}

#[test]
fn nothing_to_do_is_said_with_what_was_looked_for() {
    let dir = Dir::new();
    dir.write("empty/readme.txt", "nothing here");
    dir.lunula(&["photos", "empty", "--out", "out"]).expect(2).says("no photographs here");
    dir.lunula(&["photos", "nowhere", "--out", "out"]).expect(2).says("nowhere");
    dir.lunula(&["photos", "empty", "--out", "out", "--size", "3"]).expect(2).says("8 to 4096");
    dir.lunula(&["photos", "empty", "--out", "out", "--margin", "nan"]).expect(2).says("1 to 5");
    dir.lunula(&["photos", "empty", "--out", "out", "--masks", "nowhere"]).expect(2).says("--masks nowhere");
    dir.lunula(&["photos", "empty"]).expect(2).says("--out");
    assert!(!dir.path("out").exists());
}

#[test]
fn a_run_that_fails_leaves_what_stood() {
    let dir = good_set();
    dir.lunula(&["photos", "set", "--out", "out"]).expect(0);
    let before = dir.bytes_of("out");
    for subject in ["a", "b", "c"] {
        dir.write(&format!("set/{subject}.png"), "no picture");
    }
    dir.words("photos set --out out").refuses(&["not one nail could be used", "b.png"]);
    assert!(dir.bytes_of("out") == before);
}

#[test]
fn a_place_that_can_t_be_written_is_said_before_any_work() {
    let dir = good_set();
    dir.write("file", "not a folder");
    dir.lunula(&["photos", "set", "--out", "file/out"]).expect(2).says("choose another --out");
    if cfg!(target_os = "linux") {
        // Nobody can write there, not even root.
        dir.lunula(&["photos", "set", "--out", "/proc/lunula"]).expect(2).says("/proc/lunula");
    }
}

#[test]
fn a_result_s_place_taken_by_a_folder_changes_nothing() {
    let dir = good_set();
    dir.write("out/maps/set-mean.npy/mine.txt", "mine");
    dir.write("out/nails.csv", "mine");
    dir.lunula(&["photos", "set", "--out", "out"]).expect(2).says("is a folder");
    assert_eq!(dir.bytes_of("out").keys().collect::<Vec<_>>(), ["maps/set-mean.npy/mine.txt", "nails.csv"]);
}

#[test]
fn a_photograph_without_an_outline_is_left_out_where_none_may_be_found() {
    let dir = good_set();
    drawn_nail().save(dir.place("set/d.png")).expect("a picture");
    dir.lunula(&["photos", "set", "--out", "out", "--outline", "annotated"]).expect(1).says("d.png: has no outline");
}

#[test]
fn hostile_names_stay_words() {
    let dir = Dir::new();
    dir.nail("set/a & <b>");
    dir.nail("set/c");
    dir.nail("set/c-2");
    dir.words("photos set --out out").expect(1).says("subject `c-2` could be taken for a nail of subject `c`");
    let html = dir.text("out/report.html");
    assert!(html.contains("a &amp; &lt;b&gt;") && !html.contains("<b>"));
}

#[test]
fn what_is_found_but_not_trusted_is_kept_for_a_person_even_where_nothing_else_is() {
    use lunula::phantom::Generated as _;
    use lunula::phantom::nail::Pose;
    let dir = Dir::new();
    // Dim, noisy and small: searched for a scene in which detection doubts.
    let doubted = (0..40).find(|&seed| {
        let mut options = crate::util::small_set(1, &[Pose::Nominal]);
        (options.seed, options.width, options.height, options.noise_sd, options.annotate) =
            (seed, 160, 120, 12.0, false);
        options.grey = true;
        // Another seed's scene may have been found, and its outline is somebody's own.
        for folder in ["set", "out"] {
            let _ = std::fs::remove_dir_all(dir.path(folder));
        }
        options.write(&dir.path("set")).expect("a synthetic photograph");
        let answer = dir.lunula(&["photos", "set/photos", "--out", "out", "--write-outlines"]);
        let drawn = dir.path("set/photos/nominal/s01.json");
        // The outlines were saved, and there is a report: 2 would say that nothing was changed.
        answer.code == 1 && answer.stderr.contains("is not trusted") && drawn.exists()
    });
    assert!(doubted.is_some(), "no doubted nail in forty scenes");
    let drawn = lunula::labelme::LabelMe::read(&dir.path("set/photos/nominal/s01.json")).expect("LabelMe");
    assert!(drawn.shapes.iter().any(|s| s.label == "nail?") && drawn.shapes.iter().all(|s| s.label != "nail"));
    // The report shows it; there are no maps.
    assert_eq!(
        dir.bytes_of("out").into_keys().collect::<Vec<_>>(),
        ["figures/outlines-1.png", "nails.csv", "report.html", "run.json"]
    );
    let report = dir.parsed("out/run.json");
    assert_eq!((&report["counts"]["nails_used"], report["failed"].as_array().map(Vec::len)), (&0.into(), Some(1)));
    let html = dir.text("out/report.html");
    assert!(html.contains("Not one nail could be used") && html.contains("is not trusted"));
}

/// Ctrl-C while photographs are being read.
#[cfg(target_os = "linux")]
#[test]
fn an_interrupted_run_leaves_what_stood() {
    let dir = Dir::new();
    for subject in ["b", "c", "d"] {
        dir.nail(&format!("set/{subject}"));
    }
    dir.write("out/nails.csv", "mine");
    let pipe = dir.path("set/a.png");
    assert!(Command::new("mkfifo").arg(&pipe).status().expect("mkfifo").success());
    // Where a folder is searched it is passed over.
    dir.lunula(&["photos", "set", "--out", "others"]).expect(0);
    assert_eq!(dir.table("others/nails.csv").len(), 3);
    dir.lunula(&["init", "set", "--out", "set.toml"]).expect(0);
    // Some seconds of work, from when its folder is there.
    for subject in 0..400 {
        std::fs::copy(dir.path("set/b.png"), dir.path(&format!("set/s{subject}.png"))).expect("copied");
        std::fs::copy(dir.path("set/b.json"), dir.path(&format!("set/s{subject}.json"))).expect("copied");
    }
    let hidden = || {
        let entries = std::fs::read_dir(dir.path("out")).expect("a folder").flatten();
        entries.filter(|entry| entry.file_name().to_string_lossy().starts_with('.')).count()
    };
    let before = hidden();
    let mut child = Command::new(env!("CARGO_BIN_EXE_lunula"))
        .args(["photos", "set", "--out", "out", "--threads", "1"])
        .current_dir(dir.path(""))
        .stderr(std::process::Stdio::piped())
        .spawn()
        .expect("the binary runs");
    until("work", || hidden() > before);
    // The shell's own `kill`: a small system has no other.
    let interrupt = format!("kill -INT {}", child.id());
    assert!(Command::new("sh").args(["-c", &interrupt]).status().expect("a shell").success());
    let mut stderr = String::new();
    std::io::Read::read_to_string(&mut child.stderr.take().expect("piped"), &mut stderr).expect("text");
    assert_eq!(child.wait().expect("it ends").code(), Some(130), "{stderr}");
    assert!(stderr.contains("interrupted; nothing was written"), "{stderr}");
    assert_eq!(dir.bytes_of("out").keys().collect::<Vec<_>>(), ["nails.csv"]);
}

#[test]
fn pictures_of_other_channels_values_or_axes_than_the_others_are_named() {
    let dir = Dir::new();
    let scene = "phantom photos --subjects 5 --light chamber --poses nominal --no-normalized --seed 3 --out s -q";
    dir.words(scene).expect(0);
    let file = |k: usize, ending: &str| dir.path(&format!("s/photos/nominal/s0{k}.{ending}"));
    let good: Vec<image::RgbImage> =
        (1..=5).map(|k| image::open(file(k, "png")).expect("a picture").to_rgb8()).collect();
    let said = |change: &dyn Fn(usize, &mut [u8; 3])| {
        for (k, picture) in (1..).zip(&good) {
            let mut picture = picture.clone();
            picture.pixels_mut().for_each(|pixel| change(k, &mut pixel.0));
            picture.save(file(k, "png")).expect("a picture");
        }
        let answer = dir.words("photos s/photos --out out").expect(0).stderr;
        answer.lines().filter(|line| line.starts_with("warning: ")).map(str::to_owned).collect::<Vec<_>>()
    };
    let only = |said: Vec<String>, words: &str| {
        assert!(said.len() == 1 && said[0].contains(words), "{words}: {said:?}");
    };
    assert_eq!(said(&|_, _| ()), [""; 0]);
    let linear = |[r, g, b]: [u8; 3]| [r, g, b].map(|v| (255.0 * (f64::from(v) / 255.0).powf(2.2)).round() as u8);
    type Change<'a> = &'a dyn Fn([u8; 3]) -> [u8; 3];
    let changes: [(&[usize], Change<'_>, &str); 3] = [
        (
            &[2],
            &|[r, g, b]| [g, r, b],
            "nail and skin are greener than red in nominal/s02.png: were red and green exchanged? Maps are of",
        ),
        (
            &[4],
            &|colour| colour.map(|value| 255 - value),
            "nail and skin are bluer than green, and greener than red in nominal/s04.png: is it a negative? Maps are",
        ),
        (
            &[2, 4],
            &linear,
            "the photographs of s02, s04 are darker and more coloured than the others': have they linear values",
        ),
    ];
    for (which, change, words) in changes {
        only(said(&|k, colour| *colour = if which.contains(&k) { change(*colour) } else { *colour }), words);
    }
    assert_eq!(said(&|_, colour| *colour = linear(*colour)), [""; 0], "all alike");
    // An axis that was drawn aslant by 30 degrees, counterclockwise.
    let mut drawn: serde_json::Value =
        serde_json::from_slice(&std::fs::read(file(3, "json")).expect("an annotation")).expect("JSON");
    let shapes = drawn["shapes"].as_array_mut().expect("shapes");
    let axis = shapes.iter_mut().find(|shape| shape["label"] == "axis").expect("an axis");
    let end = |k: usize| [0, 1].map(|place| axis["points"][k][place].as_f64().expect("a number"));
    let [[from_x, from_y], [x, y]] = [end(0), end(1)];
    let (sin, cos) = 30f64.to_radians().sin_cos();
    let (dx, dy) = (x - from_x, y - from_y);
    axis["points"][1] = serde_json::json!([from_x + cos * dx + sin * dy, from_y - sin * dx + cos * dy]);
    std::fs::write(file(3, "json"), drawn.to_string()).expect("an annotation");
    let slants = said(&|_, _| ());
    only(slants.clone(), "the drawn axis is not the finger's direction in nominal/s03.png (by the picture it is ");
    assert!(slants[0].contains("degrees further clockwise"), "{slants:?}");
}

#[test]
fn empty_rows_and_the_slashes_of_windows_cost_no_photograph() {
    let dir = Dir::new();
    for photo in ["set/normal/a", "set/normal/b", "set/extension/a"] {
        dir.nail(photo);
    }
    let rows = "normal\\a.png;a;normal\nnormal/b.png;b;normal\n;;\nextension\\a.png;a;extension\n;;\n";
    dir.write("set/photos.csv", format!("file;subject;pose\n{rows}"));
    dir.lunula(&["photos", "set", "--out", "out"]).expect(0).never_says("failed").never_says("beside those");
    let files: Vec<String> = dir.table("out/nails.csv").into_iter().map(|row| row["file"].clone()).collect();
    assert_eq!(files, ["normal/a.png", "normal/b.png", "extension/a.png"]);
    // A row that has something, and a name that really has a backslash.
    dir.nail("set/normal/c\\d");
    dir.write("set/photos.csv", format!("file;subject;pose\n{rows};x;\nnormal/c\\d.png;c;normal\n"));
    dir.lunula(&["photos", "set", "--out", "out"]).expect(1).says("photos.csv, line 7: the cell `file` is empty");
    assert_eq!(dir.table("out/nails.csv").len(), 4);
}

#[test]
fn outlines_of_no_photograph_and_drawn_nails_left_out_are_said() {
    let dir = Dir::new();
    for photo in ["set/normal/a", "set/normal/b", "set/normal/c", "set/extension/a", "set/extension/b"] {
        dir.nail(photo);
    }
    dir.write("set/normal/settings.json", "{\"camera\": 3}");
    dir.write("set/extension/other.json", labelme([320, 240], &[("finger", "polygon", drawn_outline())]));
    let job = ["photos", "set", "--out", "out"];
    dir.lunula(&job).expect(0).never_says("LabelMe file(s)").never_says("left out").never_says("annotations of");
    std::fs::copy(dir.path("set/normal/a.png"), dir.path("set/normal/a_mask.png")).expect("copied");
    dir.lunula(&job).expect(1).says("normal/a_mask.png: looks like the mask of a.png; put masks into a folder");
    std::fs::remove_file(dir.path("set/normal/a_mask.png")).expect("removed");
    // One file of another program for the whole set.
    dir.write("set/instances.json", "{\"images\": [], \"annotations\": [], \"categories\": []}");
    dir.write("set/annotations.xml", "<?xml version=\"1.0\"?>\n<annotations><version>1.1</version></annotations>");
    for (file, program) in [("instances.json", "COCO"), ("annotations.xml", "CVAT")] {
        let said =
            format!("warning: {file} holds annotations of {program}, which are not read; export them as LabelMe");
        dir.lunula(&job).expect(0).says(&said);
        dir.lunula(&[&job[..], &["--outline", "detected"]].concat()).never_says("annotations of");
        std::fs::remove_file(dir.path(&format!("set/{file}"))).expect("removed");
    }
    dir.write("set/normal/c.json", "{\"filename\": \"c.png\", \"size\": 9, \"regions\": []}");
    dir.lunula(&job).expect(1).says("c.json: holds annotations of VIA, which are not read; export them as LabelMe");
    dir.nail("set/normal/c");
    for (from, to) in [("normal/a", "normal/x"), ("extension/b", "extension/y")] {
        let path = |name: &str| dir.path(&format!("set/{name}.png"));
        std::fs::rename(path(from), path(to)).expect("renamed");
    }
    let said = "warning: 2 LabelMe file(s) with nails are not used, as no photograph beside them is called so \
                (extension/b.json first)";
    let answer = dir.lunula(&job);
    assert!(answer.stderr.contains(said), "{}", answer.stderr);
    // Where a manifest names it, it is used.
    dir.write("set/photos.csv", "file,subject,pose,outline\nnormal/x.png,x,normal,normal/a.json\n");
    dir.lunula(&job).expect(0).never_says("LabelMe file(s)");
    // A second nail that is drawn as a rectangle.
    let nails = [
        ("nail", "polygon", drawn_outline()),
        ("axis", "line", drawn_axis()),
        ("nail", "rectangle", vec![[3.0, 3.0], [30.0, 40.0]]),
    ];
    let size = image::image_dimensions(dir.path("set/normal/x.png")).expect("a picture");
    dir.write("set/normal/a.json", labelme(size.into(), &nails));
    dir.lunula(&job).expect(0).says(
        "warning: 1 drawn nail(s) are left out, others of their photographs being used: normal/x.png, nail 2 first: \
         a.json: shape 3 is a rectangle labelled nail",
    );
}

#[test]
fn pictures_of_an_earlier_run_are_no_copies_in_a_merge() {
    let dir = Dir::new();
    for photo in ["one/normal/a", "one/normal/b", "two/normal/b"] {
        dir.nail(photo);
    }
    dir.lunula(&["photos", "one", "--out", "first"]).expect(0);
    std::fs::remove_file(dir.path("one/normal/b.png")).expect("removed");
    std::fs::remove_file(dir.path("one/normal/b.json")).expect("removed");
    dir.lunula(&["photos", "one", "--out", "first"]).expect(0);
    dir.lunula(&["photos", "two", "--out", "second"]).expect(0);
    assert!(dir.path("first/normalized/normal/b.png").exists());
    let answer = dir.lunula(&["photos", "merge", "first", "second", "--out", "all"]).expect(0);
    assert!(!answer.stderr.contains("first/normalized/normal/b.png"), "{}", answer.stderr);
}

#[test]
fn parts_of_one_nail_in_a_mask_are_said() {
    let dir = Dir::new();
    for subject in ["a", "b", "c"] {
        drawn_nail().save(dir.place(&format!("set/normal/{subject}.png"))).expect("a picture");
    }
    let said = |value: &dyn Fn(u32, u32) -> u8| {
        let mask = image::GrayImage::from_fn(160, 140, |x, y| {
            let (u, v) = ((f64::from(x) - 80.0) / 30.0, (f64::from(y) - 70.0) / 40.0);
            image::Luma([if u.powi(4) + v.powi(4) <= 1.0 { value(x, y) } else { 0 }])
        });
        for subject in ["a", "b", "c"] {
            mask.save(dir.place(&format!("masks/normal/{subject}.png"))).expect("a mask");
        }
        dir.words("photos set --masks masks --distal up --out out").stderr
    };
    let words = "regions of one mask touch along a long border: normal/a.png, nail 2 beside nail 1, ";
    let bed_and_lunula = said(&|_, y| if y > 92 { 1 } else { 2 });
    assert!(bed_and_lunula.contains(words), "{bed_and_lunula}");
    let cut = said(&|_, y| if (69..71).contains(&y) { 0 } else { 255 });
    assert!(cut.contains(words), "{cut}");
    // Two nails a tenth of their width apart; one nail.
    let two = said(&|x, _| if (78..=81).contains(&x) { 0 } else { 255 });
    let one = said(&|_, _| 255);
    assert!(!(two + &one).contains("regions of one mask"), "{one}");
}
