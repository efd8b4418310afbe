//! `lunula photos --channels`: red, green and blue compared on photographs whose contrasts are known, and poses in the
//! thesis' order.

use std::collections::BTreeMap;

use image::{Rgb, RgbImage, Rgba};
use lunula::phantom::Generated as _;
use lunula::phantom::nail::{NailScene, Pose};
use lunula::phantom::photos::{LightKind, PhotoOptions};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::util::{Dir, Json, drawn_labels, drawn_nail, number, small_set};

const CELLS: usize = 40;
const CHANNELS: [&str; 3] = ["red", "green", "blue"];

/// Exact red, green and blue of a scene, cell by cell of the nail's box.
fn exact_cells(scene: &NailScene) -> Vec<[f64; 3]> {
    const SAMPLES: usize = 5;
    let field = scene.field();
    let place = |cell: usize, k: usize| (cell as f64 + (k as f64 + 0.5) / SAMPLES as f64) * 2.0 / CELLS as f64 - 1.0;
    let cell = |at: usize| {
        let mut sum = [0.0; 3];
        for k in 0..SAMPLES * SAMPLES {
            let (u, v) = (place(at % CELLS, k % SAMPLES), -place(at / CELLS, k / SAMPLES));
            let [x, y] = scene.picture_from_nail(u, v);
            sum.iter_mut().zip(field.colour(x, y)).for_each(|(sum, value)| *sum += value);
        }
        sum.map(|sum| sum / (SAMPLES * SAMPLES) as f64)
    };
    (0..CELLS * CELLS).map(cell).collect()
}

/// The definition in plain words, twin of the job's: contrasts in red, green and blue, means over subjects.
fn exact_contrasts(subjects: &[Vec<[f64; 3]>]) -> [f64; 3] {
    let middle = |k: usize| (2.0 * (k as f64 + 0.5) / CELLS as f64 - 1.0) / 0.8;
    let on_bed = |at: &usize| middle(at / CELLS).powi(4) + middle(at % CELLS).powi(4) <= 1.0;
    let bed: Vec<usize> = (0..CELLS * CELLS).filter(on_bed).collect();
    let neutral = |cells: &Vec<[f64; 3]>| -> Vec<f64> {
        let mean = |c: usize| bed.iter().map(|&at| cells[at][c]).sum::<f64>() / bed.len() as f64;
        let means = [mean(0), mean(1), mean(2)];
        bed.iter().map(|&at| (0..3).map(|c| cells[at][c] / means[c]).sum::<f64>()).collect()
    };
    let neutrals: Vec<Vec<f64>> = subjects.iter().map(neutral).collect();
    let mut contrasts = [0.0; 3];
    for (own, cells) in subjects.iter().enumerate() {
        let others = neutrals.iter().enumerate().filter(|(k, _)| *k != own);
        let sum = others.fold(vec![0.0; bed.len()], |sum, (_, n)| sum.iter().zip(n).map(|(a, b)| a + b).collect());
        let mut by_lightness: Vec<usize> = (0..bed.len()).collect();
        by_lightness.sort_by(|&a, &b| sum[a].total_cmp(&sum[b]));
        let quarter = bed.len() / 4;
        for (c, contrast) in contrasts.iter_mut().enumerate() {
            let mean = |of: &[usize]| of.iter().map(|&k| cells[bed[k]][c]).sum::<f64>() / quarter as f64;
            let of_subject = mean(&by_lightness[bed.len() - quarter..]) - mean(&by_lightness[..quarter]);
            *contrast += of_subject / subjects.len() as f64;
        }
    }
    contrasts
}

fn rows_of<'a>(
    rows: &'a [BTreeMap<String, String>],
    pose: &'a str,
    tone: &'a str,
) -> impl Iterator<Item = &'a BTreeMap<String, String>> {
    rows.iter().filter(move |row| row["pose"] == pose && row["tone"] == tone)
}

/// Of full scale, 0.3 of 255: what maps are held to.
const CONTRAST_ERROR: f64 = 0.0012;

#[test]
fn contrasts_of_phantoms_are_those_of_their_spectra() {
    let dir = Dir::new();
    let poses = [Pose::Normal, Pose::LateralNegative, Pose::Extension];
    let set = PhotoOptions { light: LightKind::Chamber, noise_sd: 2.0, ..small_set(6, &poses) };
    let set = PhotoOptions { width: 480, height: 360, ..set };
    set.write(&dir.path("set")).expect("synthetic photographs");
    let report = dir.lunula(&["photos", "set/photos", "--out", "out", "--channels", "--json"]).expect(0).json();
    let rows = dir.table("out/channels.csv");
    assert_eq!(rows.len(), 9);
    for pose in poses {
        let subjects: Vec<_> = (0..6).map(|subject| exact_cells(&set.scene(subject, pose))).collect();
        let exact = exact_contrasts(&subjects);
        for (row, (name, exact)) in rows_of(&rows, pose.name(), "").zip(CHANNELS.into_iter().zip(exact)) {
            assert_eq!((&row["channel"][..], &row["subjects"][..], &row["zones"][..]), (name, "6", "others"));
            let made = number(row, "contrast");
            assert!((made - exact).abs() <= CONTRAST_ERROR, "{pose} {name}: {made}, exactly {exact}");
            assert!((number(row, "white") - number(row, "red") - made).abs() <= 2e-6);
            // Of light: 2 to 2.4 times that of values, as sRGB's curve is as steep.
            let relative = number(row, "relative");
            assert!(relative > 1.8 * made / number(row, "white") && relative < 2.6 * made / number(row, "red"));
            assert!(number(row, "low") < made && made < number(row, "high"));
        }
        // The phantom's zones change green by 1, blue by 0.35, red by 0.10; shade and lunula change all.
        assert!(exact[1] > 1.5 * exact[2] && exact[2] > exact[0], "{exact:?}");
    }
    let differences = report["channels"]["differences"].list();
    assert_eq!(differences.len(), 9);
    assert!(differences.iter().filter(|d| d["of"] == "green").all(|d| d["difference"]["low"].number() > 0.0));
    let html = dir.text("out/report.html");
    assert!(html.contains("Why the green channel?") && html.contains("In 3 of 3 pose(s) green has more contrast"));
    assert!(dir.path("out/figures/channels.png").exists() && dir.path("out/figures/channels.svg").exists());
}

/// A nail that is lighter on its right by `contrast` in every channel, with noise of its own in each, up to `noise`.
fn equal_contrast(contrast: f64, noise: [f64; 3], rng: &mut ChaCha8Rng) -> RgbImage {
    RgbImage::from_fn(160, 140, |x, _| {
        let right = if x >= 80 { 0.5 } else { -0.5 };
        Rgb([0, 1, 2].map(|c| {
            let noise = noise[c] * rng.random_range(-1.0..1.0);
            (255.0 * (0.5 + contrast * right + noise)).round().clamp(0.0, 255.0) as u8
        }))
    })
}

#[test]
fn no_channel_is_favoured_where_all_have_the_same_contrast() {
    let dir = Dir::new();
    let rng = &mut ChaCha8Rng::seed_from_u64(2);
    for subject in 0..8 {
        let contrast = 0.06 + 0.005 * f64::from(subject);
        dir.photo(&format!("set/s{subject}"), equal_contrast(contrast, [0.02, 0.3, 0.02], rng), drawn_labels());
    }
    let report = dir.lunula(&["photos", "set", "--out", "out", "--channels", "--json"]).expect(0).json();
    for difference in report["channels"]["differences"].list() {
        let [low, high] = ["low", "high"].map(|end| difference["difference"][end].number());
        assert!(low <= 0.0 && 0.0 <= high, "{difference}");
    }
    let html = dir.text("out/report.html");
    assert!(html.contains("In 1 of 1 pose(s) green is not clearly ahead"), "green is not said to lead");
}

#[test]
fn comparing_adds_its_files_and_changes_no_other_whatever_the_threads() {
    let dir = Dir::new();
    small_set(4, &[Pose::Nominal, Pose::Flexion]).write(&dir.path("set")).expect("synthetic photographs");
    dir.words("photos set/photos --out plain").expect(0);
    let plain = dir.results_of("plain");
    let one = dir.on_any_threads("photos set/photos --channels --out {out}");
    let added: Vec<&String> = one.keys().filter(|name| !plain.contains_key(*name)).collect();
    assert_eq!(added, ["channels.csv", "figures/channels.png", "figures/channels.svg"]);
    assert!(plain.iter().all(|(name, bytes)| one[name] == *bytes));
    let run = dir.parsed("plain/run.json");
    assert!(run["channels"].is_null() && !run.to_string().contains("compare"));
}

/// The drawn nail, lighter on its right the more, the higher `step` is.
fn shaded(step: u8) -> RgbImage {
    let mut nail = drawn_nail();
    nail.enumerate_pixels_mut().for_each(|(x, _, pixel)| pixel.0[1] = pixel.0[1].saturating_add(step * (x as u8 / 40)));
    nail
}

#[test]
fn grey_transparent_and_single_ones_and_tones() {
    let dir = Dir::new();
    let mut manifest = "file,subject,pose,tone\n".to_owned();
    for (k, tone) in ["white", "Asian", "white", "black", ""].into_iter().enumerate() {
        dir.photo(&format!("set/press-{k}"), shaded(k as u8), drawn_labels());
        manifest += &format!("press-{k}.png,s{k},normal,{tone}\n");
    }
    // The photograph of s5 does not show the nail's right half, that of s6 is grey, and rest has one subject.
    let hidden = image::RgbaImage::from_fn(160, 140, |x, y| {
        let [r, g, b] = shaded(2).get_pixel(x, y).0;
        Rgba([r, g, b, if x < 80 { 255 } else { 0 }])
    });
    dir.photo("set/press-5", hidden, drawn_labels());
    dir.photo("set/press-6", image::DynamicImage::from(shaded(1)).to_luma8(), drawn_labels());
    dir.photo("set/rest-0", shaded(3), drawn_labels());
    manifest += "press-5.png,s5,normal,Asian\npress-6.png,s6,normal,Asian\nrest-0.png,s0,rest,black\n";
    dir.write("set/photos.csv", manifest);
    let plan = dir.lunula(&["photos", "set", "--out", "out", "--plan", "--channels"]).expect(0).stdout;
    assert!(plan.contains("7 colour photograph(s); 1 grey one(s) have none and are left out"), "{plan}");
    let report = dir.lunula(&["photos", "set", "--out", "out", "--channels", "--json"]).expect(0).json();
    assert!(report["left_out"].to_string().contains("channels compared: 1 grey photograph(s) have none"));
    let notes = report["notes"].to_string();
    assert!(notes.contains("`s5` left out") && notes.contains("pose `rest`: one subject"), "{notes}");
    let warnings = report["warnings"].to_string();
    assert!(warnings.contains("subject `s0` has more than one tone: `black`, `white`"), "{warnings}");
    assert_eq!(report["channels"]["photographs"], 7);

    let rows = dir.table("out/channels.csv");
    let green = |pose: &'static str, tone: &'static str| rows_of(&rows, pose, tone).nth(1).expect("a row of green");
    assert_eq!(green("normal", "")["subjects"], "5");
    let groups: Vec<_> = rows.iter().filter(|r| r["pose"] == "normal" && r["channel"] == "green").collect();
    assert_eq!(groups.iter().map(|r| r["tone"].as_str()).collect::<Vec<_>>(), ["", "Asian", "black", "white"]);
    assert_eq!((&green("normal", "white")["subjects"][..], &green("normal", "Asian")["subjects"][..]), ("2", "1"));
    assert!(!green("normal", "white")["low"].is_empty());
    for alone in [green("normal", "Asian"), green("rest", ""), green("rest", "black")] {
        assert!(number(alone, "contrast") > 0.0);
        assert_eq!((&alone["low"][..], &alone["high"][..]), ("", ""), "missing, not zero");
    }
    assert_eq!((&green("rest", "")["zones"][..], &green("normal", "Asian")["zones"][..]), ("own", "others"));
}

#[test]
fn grey_photographs_alone_have_no_channels_to_compare() {
    let dir = Dir::new();
    for subject in ["set/a", "set/b"] {
        dir.photo(subject, image::DynamicImage::from(drawn_nail()).to_luma8(), drawn_labels());
    }
    let report = dir.lunula(&["photos", "set", "--out", "out", "--channels", "--json"]).expect(0).json();
    assert!(report["left_out"].to_string().contains("channels compared: every photograph is grey and has none"));
    assert!(report["channels"].is_null() && !dir.path("out/channels.csv").exists());
}

#[test]
fn a_pipeline_s_stage_of_one_subject_refuses_to_compare() {
    let dir = Dir::new();
    dir.nail("photos/normal/a");
    let stage = "[stage.nails]\njob = \"normalize\"\nphoto = \"photos\"\nchannels = true\n";
    let inputs = "[inputs.photos]\nfiles = \"photos/{pose}/{subject}.png\"\n";
    dir.write("pipeline.toml", format!("wanted = [\"nails\"]\n{inputs}{stage}"));
    dir.lunula(&["run", "pipeline.toml", "--out", "out"]).expect(2).says("compared over all subjects at once");
}

#[test]
fn poses_are_listed_in_the_thesis_order() {
    let dir = Dir::new();
    for pose in ["flexion", "nominal", "arching", "normal", "Zigzag"] {
        dir.nail(&format!("set/{pose}/a"));
    }
    let answer = dir.lunula(&["photos", "set", "--out", "out", "--channels"]).expect(0);
    let expected = ["nominal", "normal", "flexion", "Zigzag", "arching"];
    let in_order = |text: &str| {
        let places: Vec<Option<usize>> = expected.iter().map(|pose| text.find(pose)).collect();
        assert!(places.iter().all(Option::is_some) && places.is_sorted(), "{places:?} in\n{text}");
    };
    in_order(&(answer.stdout.clone() + &answer.stderr).replace("normalized", "").replace("out/", ""));
    let run = dir.parsed("out/run.json");
    assert_eq!(run["poses"].list().iter().map(|pose| pose["pose"].words()).collect::<Vec<_>>(), expected);
    let of_table = |name: &str| {
        let mut poses: Vec<String> = dir.table(name).into_iter().map(|row| row["pose"].clone()).collect();
        poses.dedup();
        poses
    };
    assert_eq!(
        (of_table("out/nails.csv"), of_table("out/channels.csv")),
        (expected.map(str::to_owned).to_vec(), expected.map(str::to_owned).to_vec())
    );
    let sheet = dir.text("out/figures/mean.svg");
    in_order(&sheet);
}

mod real_data {
    use super::*;
    use crate::util::real_data::real_data;

    /// Hands at rest under household light: all one pose.
    #[test]
    #[ignore = "needs real recordings: LUNULA_REAL_DATA"]
    fn channels_of_real_hands_are_compared() {
        let hands = real_data("nail/vpapenko_cc0");
        let dir = Dir::new();
        let [images, masks] = ["images", "masks"].map(|name| hands.join(name).display().to_string());
        dir.lunula(&["photos", &images, "--masks", &masks, "--out", "out", "--channels"]).expect(1);
        let rows = dir.table("out/channels.csv");
        assert_eq!(rows.iter().map(|row| row["channel"].as_str()).collect::<Vec<_>>(), CHANNELS);
        for row in &rows {
            assert!(number(row, "subjects") >= 24.0 && number(row, "low") < number(row, "high"), "{row:?}");
        }
    }
}
