//! The page on parts that are made here.

use std::f64::consts::TAU;
use std::fmt::Write as _;

use ndarray::Array2;
use ndarray_npy::WriteNpyExt;

use super::*;
use crate::film::tests::{pair, pressed};
use crate::film::{film, rising};
use crate::phantom::presses::{self, PressOptions};
use crate::phantom::trials::trials;
use crate::responses::{ResponsesOptions, responses};
use crate::section::presses::{PressFile, read_presses};
use crate::section::{section_presses, section_simulations};
use lunula::hemodynamics::Pressed;
use lunula::job::{Outputs, defaults, read};
use lunula::live::performance::{self, PerformanceOptions};
use lunula::phantom::nail::Pose;
use lunula::predictor::DataFile;

fn part(at: &Path, part: Part, subject: &str, files: &[(&str, &[u8])]) -> PartFolder {
    let folder = at.join(part.word()).join(subject);
    fs::create_dir_all(&folder).unwrap();
    files.iter().for_each(|(name, bytes)| fs::write(folder.join(name), bytes).unwrap());
    PartFolder { part, folder, subject: subject.to_owned() }
}

#[test]
fn what_there_is_is_shown_and_the_rest_is_said_to_be_lacking() {
    let folder = tempfile::tempdir().unwrap();
    let (at, png) = (folder.path(), lunula::figure::png(&image::DynamicImage::new_luma8(2, 2)).unwrap());
    let numbers = br#"{"P7.phase_deg": 10.0, "P5.phase_deg": 10.0}"#;
    let parts = [
        part(at, Part::Lateral, "S02", &[("numbers.json", b"{}")]),
        part(
            at,
            Part::Lateral,
            "S01",
            &[("numbers.json", numbers), ("averages.png", &png), ("responses.csv", b"a\n1\n")],
        ),
        part(at, Part::Normal, "S01", &[("numbers.json", b"nothing")]),
    ];
    let options = PageOptions { title: "A study".to_owned(), phantom: true, subject: None };
    let report = study_page(&parts, &options, &at.join("out"), &Watch::nobody()).unwrap();
    assert_eq!((report.figures.figures, report.agree, report.do_not), (1, 1, 1 + 1));
    let kinds: Vec<[usize; 2]> = report.by_kind.iter().map(|one| [one.agree, one.do_not]).collect();
    assert_eq!(kinds, [[1, 2], [0, 0], [0, 0]]);
    assert_eq!(report.figures_lacking.len(), SECTIONS.iter().map(|one| one.figures.len()).sum::<usize>() - 1);
    assert!(report.warnings.len() == 1 && report.warnings[0].starts_with("normal: "), "{:?}", report.warnings);
    let html = fs::read_to_string(at.join("out/study.html")).unwrap();
    for words in [
        "A phantom is no people",
        "Agree: put in 1 of ",
        "<th>kind</th>",
        "Fig. 28",
        "Subject S01",
        "tables/lateral-responses.csv",
        "can&#39;t be judged",
    ] {
        assert!(html.contains(words), "{words}");
    }
    assert!(!html.contains(&at.display().to_string()));
    let table = fs::read_to_string(at.join("out/statements.csv")).unwrap();
    assert!(table.contains("lateral-p7,3.3.3,27,") && table.lines().count() > 100);
}

#[test]
fn an_empty_study_has_a_page_that_judges_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let report = study_page(&[], &defaults(), folder.path(), &Watch::nobody()).unwrap();
    assert_eq!((report.figures.figures, report.agree, report.do_not), (0, 0, 0));
    assert!(report.cannot_tell > 100 && report.by_kind.is_empty());
    let html = fs::read_to_string(folder.path().join("study.html")).unwrap();
    assert!(!html.contains("A phantom") && !html.contains("<th>kind</th>"));
}

#[test]
fn every_statement_is_in_a_section_of_the_page() {
    let statements = Statements::of_the_thesis().unwrap();
    let judged = statements.judge(&Numbers::default());
    let shown: Vec<usize> = SECTIONS.iter().map(|section| own(section, &judged).len()).collect();
    assert!(shown.iter().sum::<usize>() == judged.len() && shown.iter().all(|count| *count > 0), "{shown:?}");
}

/// Five cycles of `drive`, everything else at rest, and what eight photodiodes make of it.
fn cycled(path: &Path, drive: &str, [low, high]: [f64; 2]) {
    let names = ["Fx_N", "Fy_N", "Fz_N", "J2_deg", "J3_deg"];
    let mut text = format!("time_s,{},P1,P2,P3,P4,P5,P6,P7,P8\n", names.join(","));
    for k in 0..1250 {
        let angle = TAU * f64::from(k) / 250.0;
        let value = 0.5 * (low + high) - 0.5 * (high - low) * angle.cos();
        let moves = names.map(|name| match name {
            _ if name == drive => value,
            "Fz_N" => -3.0 + 0.1 * angle.sin(),
            "J3_deg" => 0.6 * value,
            _ => 0.01 * angle.sin(),
        });
        let outputs: Vec<f64> = (1..=8).map(|p| 1.0 + 0.1 * f64::from(p) * value + 0.01 * angle.sin()).collect();
        let cells: Vec<String> = moves.iter().chain(&outputs).map(f64::to_string).collect();
        writeln!(text, "{},{}", 0.08 * f64::from(k), cells.join(",")).unwrap();
    }
    fs::write(path, text).unwrap();
}

/// The tables of evaluate, analyse and compare, as they write them.
fn tables_of(part: Part) -> Vec<(&'static str, String)> {
    let forces = ["Fx_N", "Fy_N", "Fz_N"];
    let evaluation = |targets: &[&str]| {
        let mut merit = "of,name,session,subject,target,rows,rmse,bias,r2,mae,within\n".to_owned();
        targets.iter().for_each(|target| writeln!(merit, "all,,,,{target},4,0.5,0,0.9,0.4,").unwrap());
        let pairs: Vec<String> = targets.iter().map(|target| format!("{target},{target}_predicted")).collect();
        let row = |pair: &str| vec![pair; targets.len()].join(",");
        let predicted = format!("time_s,{}\n0,{}\n1,{}\n", pairs.join(","), row("0,0.2"), row("-2,-2.1"));
        vec![("merit.csv", merit), ("predicted.csv", predicted)]
    };
    match part {
        Part::TouchTraining | Part::TouchValidation | Part::TouchTest => evaluation(&forces),
        Part::PostureTraining | Part::PostureValidation => evaluation(&["J2_deg"]),
        Part::Modes => {
            vec![("modes.csv", "mode,singular_value,Fx_N,Fz_N,P1,P2\n1,10,1,0,0.6,0.8\n2,5,0,1,0.8,-0.6\n".to_owned())]
        }
        Part::Compare => {
            let mut text = "figure,group,series,unit,rmse_mean,rmse_sd,people\n".to_owned();
            let models = ["linear", "quadratic", "network of 8"];
            let sets = ["set 1", "set 2", "both sets"];
            let bending = ["with bending", "without bending"];
            let figures: [(u32, &[&str], &[&str]); 8] = [
                (105, &forces, &sets),
                (106, &forces, &sets),
                (107, &forces, &sets),
                (108, &forces, &models),
                (109, &forces, &models),
                (110, &forces, &models),
                (111, &forces, &bending),
                (112, &["training", "validation"], &models),
            ];
            let removed = ["none", "P1", "P2", "P3", "P4", "P5", "P6", "P7", "P8"];
            for (figure, groups, series) in figures.into_iter().chain([(113, &removed[..], &forces[..])]) {
                for (group, own) in groups.iter().flat_map(|group| series.iter().map(move |own| (group, own))) {
                    writeln!(text, "{figure},{group},{own},N,0.4,0.1,7").unwrap();
                }
            }
            vec![("comparisons.csv", text)]
        }
        _ => Vec::new(),
    }
}

#[test]
fn every_quantity_of_the_statements_is_computed() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let parts: Vec<PartFolder> = Part::all().map(|of| part(at, of, "", &[])).collect();
    for PartFolder { part, folder, .. } in &parts {
        tables_of(*part).iter().for_each(|(name, text)| fs::write(folder.join(name), text).unwrap());
        let write = |numbers: Numbers| fs::write(folder.join("numbers.json"), numbers.to_text()).unwrap();
        let cycle = |drive, range| {
            let path = at.join("recording.csv");
            cycled(&path, drive, range);
            let files = [DataFile { name: "recording.csv".to_owned(), ..path.into() }];
            let options = ResponsesOptions { drive: String::from(drive), bins: 16, places: Vec::new() };
            responses(&files, &options, folder, &Watch::nobody()).unwrap();
        };
        match part {
            Part::Normal => cycle("Fz_N", [-4.0, 0.0]),
            Part::Lateral => cycle("Fx_N", [-2.0, 2.0]),
            Part::Longitudinal => cycle("Fy_N", [-2.0, 2.0]),
            Part::Bending => cycle("J2_deg", [-10.0, 75.0]),
            Part::Photos => {
                fs::create_dir_all(folder.join("maps")).unwrap();
                let open = |name: String| fs::File::create(folder.join("maps").join(name)).unwrap();
                for (k, pose) in (0_u16..).zip(Pose::ALL) {
                    let value = |(row, column): (usize, usize)| 0.01 * (row + usize::from(k) * column) as f32;
                    for what in ["mean", "sd"] {
                        Array2::from_shape_fn((40, 40), value).write_npy(open(format!("{pose}-{what}.npy"))).unwrap();
                    }
                    Array2::from_elem((40, 40), 16_u32).write_npy(open(format!("{pose}-count.npy"))).unwrap();
                }
            }
            Part::Rising => {
                let [frames, photodiodes, log] = pressed(at, 40);
                rising(&frames, &photodiodes, &log, folder).unwrap();
            }
            Part::FilmGreen | Part::FilmRatio => {
                film(&[pair(at, "a", 0.0, 1e-3)], &[pair(at, "b", 30.0, 1e-3)], folder).unwrap();
            }
            Part::Performance => {
                fs::write(at.join("trials.csv"), trials(1)).unwrap();
                let course = "path_m = 1.42\nspeed_mps = 0.025\ndecisions = 27".parse().unwrap();
                let options = read::<PerformanceOptions>(&course, "").unwrap().options;
                let outputs = Outputs { out: folder.clone(), rows: false, figures: false, report: false };
                performance::run(&at.join("trials.csv"), "trials.csv", &options, &outputs, &Watch::nobody()).unwrap();
            }
            Part::Section => write(section_simulations(folder).unwrap().numbers),
            Part::Presses => {
                let mut files = Vec::new();
                for site in [Pressed::Proximal, Pressed::Distal] {
                    let out = at.join(format!("{site:?}"));
                    presses::write(&PressOptions { name: "s01".to_owned(), seed: 1, site }, &out).unwrap();
                    files.extend(["slow.csv", "quick.csv"].map(|name| out.join(name)));
                }
                let files: Vec<PressFile<'_>> =
                    files.iter().map(|path| PressFile { path, name: "press", subject: "s01" }).collect();
                write(section_presses(&read_presses(&files).unwrap(), folder).unwrap().numbers);
            }
            _ => {}
        }
    }
    let report = study_page(&parts, &defaults(), &at.join("out"), &Watch::nobody()).unwrap();
    let numbers = Numbers::read(&at.join("out/numbers.json")).unwrap();
    let statements = Statements::of_the_thesis().unwrap();
    let lacking: Vec<&str> =
        statements.quantities.iter().map(|one| one.name.as_str()).filter(|name| numbers.get(name).is_none()).collect();
    assert_eq!((lacking, report.cannot_tell), (Vec::new(), 0), "{:?}", report.warnings);
}
