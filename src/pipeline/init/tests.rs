//! Pipelines for folders of files that are what their names and headers say.

use super::shape::{PlaceNames, shape};
use super::{InitError, Proposal, propose};
use crate::pipeline::tests::planned::folder_of as folder;
use crate::pipeline::{Plan, Spec, kinds};

const MARKERS: &str = "[markers]\na = \"#ff0000\"\n[segments]\n[joints]\nJ2 = [\"a\", \"b\"]\n";
const LOG: &str = "time_s,P1,P2,Fz_N\n0,1,2,-1\n";

/// What is proposed, after it was planned without fault.
fn proposed(files: &[(&str, &str)]) -> (String, Vec<String>) {
    let dir = folder(files);
    let text = propose(dir.path(), "").unwrap().text;
    let spec =
        Spec::parse(&text, &dir.path().join("pipeline.toml"), kinds()).unwrap_or_else(|why| panic!("{why}\n{text}"));
    let plan = Plan::new(&spec, &dir.path().join("out"), None).unwrap_or_else(|why| panic!("{why}\n{text}"));
    (text, plan.tasks.into_iter().map(|task| task.id).collect())
}

#[test]
fn photographs_that_the_pattern_does_not_fit_are_said() {
    let photos = [("nails/rest/S01.png", ""), ("nails/rest/S02.png", ""), ("nails/press/S01.png", "")];
    let left_out = |files: &[(&str, &str)]| propose(folder(files).path(), "").unwrap().left_out;
    assert_eq!(left_out(&photos), [""; 0]);
    let said = left_out(&[&photos[..], &[("nails/rest/S03.jpg", "")]].concat());
    assert_eq!(said.len(), 1, "{said:?}");
    let words = "photographs of nails of another folder, name or ending than nails/{pose}/{subject}.png, which are \
                 not used: nails/rest/S03.jpg; ";
    assert!(said[0].starts_with(words), "{said:?}");
    let (text, _) = proposed(&[&photos[..], &[("nails/rest/S03.jpg", "")]].concat());
    assert!(text.contains(&format!("#   {}\n", said[0])), "{text}");
}

#[test]
fn names_that_differ_become_places() {
    let of = |paths: &[&str], places: PlaceNames<'_>| {
        let paths: Vec<String> = paths.iter().map(|path| (*path).to_owned()).collect();
        shape(&paths, places).map(|shape| (shape.pattern, shape.others.len()))
    };
    let shaped = |paths: &[&str]| of(paths, PlaceNames::Nails);
    assert_eq!(shaped(&["p/rest/a.png", "p/press/b.png"]), Some(("p/{pose}/{subject}.png".into(), 0)));
    assert_eq!(shaped(&["a.png", "b.png", "deep/c.png"]), Some(("{subject}.png".into(), 1)));
    assert_eq!(shaped(&["one[1].png"]), Some(("one?1?.png".into(), 0)));
    assert_eq!(shaped(&["x/1/a/v.mp4", "x/2/b/v.mp4"]), Some(("x/{pose}/{subject}/v.mp4".into(), 0)));
    assert_eq!(shaped(&["1/2/a.x", "3/4/b.x"]), Some(("{part3}/{pose}/{subject}.x".into(), 0)));
    assert_eq!(shaped(&[]), None);
    // Folders of people.
    let people = ["p/s01/normal.png", "p/s01/flexion.png", "p/s02/normal.png", "p/s02/flexion.png"];
    assert_eq!(shaped(&people), Some(("p/{subject}/{pose}.png".into(), 0)));
    assert_eq!(shaped(&["a/normal/1.png", "b/flexion/2.png"]), Some(("{part3}/{pose}/{subject}.png".into(), 0)));
    // The outermost place of recordings is the person, whatever lies below.
    let recordings = |paths: &[&str]| of(paths, PlaceNames::Recordings).unwrap().0;
    assert_eq!(recordings(&["anna/1/v.mp4", "ben/2/v.mp4"]), "{subject}/{session}/v.mp4");
    assert_eq!(recordings(&["anna/1/a.csv", "ben/2/b.csv"]), "{subject}/{session}/{trial}.csv");
    assert_eq!(recordings(&["a/b/c/d.csv", "e/f/g/h.csv"]), "{subject}/{session}/{trial}/{part4}.csv");
    assert_eq!(recordings(&["S01/log.csv", "S02/log.csv"]), "{session}/log.csv");
}

#[test]
fn what_a_pattern_fits_as_well_is_left_out() {
    let (text, tasks) = proposed(&[
        ("S01.csv", LOG),
        ("S02.csv", LOG),
        ("participants.csv", "subject,age\nS01,31\n"),
        ("S01_training.csv", "time_s,P1,J2_deg,label_status\n0,1,2,ok\n"),
    ]);
    assert!(text.contains("files = \"{session}.csv\"\n# Only logs of photodiodes: the pattern fits"), "{text}");
    assert!(text.contains("where = { session = [\"S01\", \"S02\"] }"), "{text}");
    assert_eq!(tasks, ["force"]);
    assert!(!proposed(&[("S01.csv", LOG), ("S02.csv", LOG)]).0.contains("where ="));
}

#[test]
fn what_is_there_once_is_not_taken_for_all() {
    let three = |name: &'static str, text: &'static str| {
        ["S01", "S02", "S03"].map(|session| (format!("{session}/{name}"), text))
    };
    let proposed = |files: Vec<(String, &str)>| {
        proposed(&files.iter().map(|(name, text)| (name.as_str(), *text)).collect::<Vec<_>>())
    };
    let one = |name: &str, text: &'static str| (format!("S01/{name}"), text);
    // Videos that were not copied yet.
    let (text, tasks) =
        proposed([&three("markers.toml", MARKERS)[..], &three("log.csv", LOG), &[one("video.mp4", "")]].concat());
    assert!(text.contains("which marker file belongs to which video does not follow"), "{text}");
    assert_eq!(tasks, ["force"]);
    // Logs that were not.
    let (text, tasks) =
        proposed([&three("markers.toml", MARKERS)[..], &three("video.mp4", ""), &[one("log.csv", LOG)]].concat());
    assert!(text.contains("which log belongs to which video"), "{text}");
    assert_eq!(tasks, ["angles/S01", "angles/S02", "angles/S03", "force"]);
    // One marker file is for all.
    let all = [&three("video.mp4", "")[..], &three("log.csv", LOG), &[("markers.toml".to_owned(), MARKERS)]].concat();
    let (text, tasks) = proposed(all);
    assert_eq!(tasks.len(), 7, "{tasks:?}");
    assert!(text.contains("all logs are trained on as sessions of one person"), "{text}");
}

#[test]
fn photographs_become_maps() {
    let (text, tasks) =
        proposed(&[("nails/rest/S01.png", ""), ("nails/rest/S02.png", ""), ("nails/press/S01.png", "")]);
    assert!(text.contains("files = \"nails/{pose}/{subject}.png\""), "{text}");
    assert_eq!(tasks, ["normalized/S01", "normalized/S02", "maps"]);
}

#[test]
fn a_table_of_photographs_says_whose_they_are() {
    let files = [
        ("p/IMG_1.JPG", ""),
        ("p/IMG_2.JPG", ""),
        ("p/IMG_3.JPG", ""),
        ("p/photos.csv", "file;subject;pose\nIMG_1.JPG;anna;normal\nIMG_2.JPG;anna;flexion\nIMG_3.JPG;ben;normal\n"),
    ];
    let (text, tasks) = proposed(&files);
    assert!(text.contains("table = \"p/photos.csv\"\nkeys = [\"subject\", \"pose\"]"), "{text}");
    assert_eq!(tasks, ["normalized/anna", "normalized/ben", "maps"]);
    let left_out = |files: &[(&str, &str)]| propose(folder(files).path(), "").unwrap().left_out;
    assert_eq!(left_out(&files), [""; 0]);
    let said = left_out(&[&files[..], &[("q/IMG_4.JPG", "")]].concat());
    assert!(said[0].contains("doesn't name, which are not used: q/IMG_4.JPG"), "{said:?}");
    // Its outlines are no photographs.
    let drawn = "file,subject,pose,outline\nIMG_1.JPG,anna,normal,IMG_2.JPG\nIMG_3.JPG,ben,normal,\n";
    let drawn = [files[0], files[1], files[2], ("p/photos.csv", drawn)];
    let (text, _) = proposed(&drawn);
    assert!(text.contains("photo = \"photos.file\"\noutlines = \"photos.outline\"\n"), "{text}");
    assert_eq!(left_out(&drawn), [""; 0]);
    // One that can't be read is not silently passed over, nor is a second one.
    let said = left_out(&[files[0], files[1], ("p/photos.csv", "name,who\nIMG_1.JPG,anna\n")]);
    assert!(said[0].contains("it needs file,subject,pose"), "{said:?}");
    let second = [("q/IMG_1.JPG", ""), ("q/photos.csv", "file,subject,pose\nIMG_1.JPG,cleo,normal\n")];
    let said = left_out(&[&files[..], &second].concat());
    assert!(said[0].starts_with("q/photos.csv: one such table is used"), "{said:?}");
}

#[test]
fn logs_of_other_endings_are_logs() {
    let tabs = LOG.replace(',', "\t");
    for ending in ["txt", "tsv", "dat", "asc", "lvm"] {
        let names = ["anna", "ben"].map(|name| format!("{name}.{ending}"));
        let (text, tasks) = proposed(&[(&names[0], &tabs), (&names[1], &tabs), ("notes.txt", "as it went: well\n")]);
        assert!(text.contains(&format!("2 logs of photodiodes: {{session}}.{ending}")), "{text}");
        assert_eq!(tasks, ["force"]);
    }
    let mixed = [("a/1.csv", LOG), ("a/2.csv", LOG), ("b/1.txt", &tabs)];
    let said = propose(folder(&mixed).path(), "").unwrap().left_out;
    assert!(said.len() == 1 && said[0].contains("not used: b/1.txt"), "{said:?}");
}

#[test]
fn results_and_masks_are_no_photographs() {
    let photos = [("nails/rest/S01.png", ""), ("nails/rest/S02.png", ""), ("nails/press/S01.png", "")];
    let results = [
        ("maps/run.json", "{\"job\": \"photos\"}"),
        ("maps/normalized/rest/S01.png", ""),
        ("maps/figures/mean.png", ""),
        ("training.csv", "time_s,P1,J2_deg,label_status\n0,1,2,\n"),
        ("training.run.json", "{\"job\": \"align\"}"),
        ("training-tie.png", ""),
    ];
    let (plain, with) = (proposed(&photos), proposed(&[&photos[..], &results].concat()));
    assert_eq!(plain.1, with.1, "{}", with.0);
    assert!(with.0.contains("3 photographs of nails: nails/{pose}/{subject}.png"), "{}", with.0);
    // Masks in folders of the same names are used, and others named.
    let masks = [("masks/rest/S01.png", ""), ("masks/rest/S02.png", ""), ("masks/press/S01.png", "")];
    let drawn = proposed(&[&photos[..], &masks].concat());
    assert_eq!(plain.1, drawn.1, "{}", drawn.0);
    assert!(drawn.0.contains("outlines = \"masks\"\n") && drawn.0.contains("3 masks of nails"), "{}", drawn.0);
    let beside = proposed(&[&photos[..], &[("nails/rest/S01_mask.png", ""), ("nails/rest/S02_mask.png", "")]].concat());
    assert_eq!(plain.1, beside.1, "{}", beside.0);
    assert!(beside.0.contains("masks are not used"), "{}", beside.0);
}

#[test]
fn results_beside_own_files_are_none_and_hide_none() {
    let logs = [("anna/a.csv", LOG), ("anna/b.csv", LOG), ("ben/a.csv", LOG)];
    let evaluated = |folder: &str| {
        let names = ["scatter.png", "scatter.svg", "by-magnitude.png", "held-out.png", "predicted.csv"];
        let mut files: Vec<(String, &str)> = names.iter().map(|name| (format!("{folder}{name}"), "")).collect();
        files.push((format!("{folder}merit.csv"), "recording,rmse\nanna/a.csv,1\n"));
        files.push((format!("{folder}run.json"), "{\"job\": \"evaluate\", \"pictures\": []}"));
        files
    };
    let (plain, tasks) = proposed(&logs);
    assert!(plain.contains("3 logs of photodiodes: {subject}/{session}.csv"), "{plain}");
    for folder in ["", "anna/", "results/"] {
        let results = evaluated(folder);
        let results: Vec<(&str, &str)> = results.iter().map(|(name, text)| (name.as_str(), *text)).collect();
        let files = [&logs[..], &results].concat();
        let (text, with) = proposed(&files);
        assert_eq!(with, tasks, "{text}");
        assert!(text.contains("3 logs of photodiodes: {subject}/{session}.csv"), "{text}");
        assert!(
            text.contains(&format!("results of lunula, which are no recordings: {folder}by-magnitude.png")),
            "{text}"
        );
        assert_eq!(text.contains("where = { session = [\"a\", \"b\"] }"), folder == "anna/", "{text}");
        assert_eq!(propose(self::folder(&files).path(), "").unwrap().left_out, [""; 0], "{text}");
    }
}

#[test]
fn of_a_run_only_its_tasks_are_results() {
    let logs = [("anna/a.csv", LOG), ("anna/b.csv", LOG), ("ben/a.csv", LOG)];
    let report = "{\"pipeline\": \"p\", \"tasks\": [{\"task\": \"angles/anna\"}]}";
    let run = [("done/.lunula/lock", ""), ("done/run.json", report), ("done/angles/anna/x.csv", LOG)];
    let (text, tasks) = proposed(&[&logs[..], &run].concat());
    assert_eq!(tasks, proposed(&logs).1, "{text}");
    assert!(text.contains("results of `lunula run`, which are no recordings, in done\n"), "{text}");
    let (text, _) = proposed(&[&logs[..], &run, &[("done/c.csv", LOG)]].concat());
    assert!(text.contains("4 logs of photodiodes: {subject}/{session}.csv"), "{text}");
    let unknown = [&logs[..], &[run[0], run[2]]].concat();
    let said = propose(folder(&unknown).path(), "").unwrap().left_out;
    assert!(said.len() == 1 && said[0].starts_with("not looked at: done (`lunula run` worked there"), "{said:?}");
}

#[test]
fn folders_that_are_passed_over_are_named() {
    let logs = [("a.csv", LOG), ("b.csv", LOG)];
    let left_out = |more: &[(&str, &str)]| {
        let files = [&logs[..], more].concat();
        let Proposal { text, left_out } = propose(folder(&files).path(), "").unwrap();
        assert!(left_out.iter().all(|said| text.contains(said)), "{text}");
        (text, left_out)
    };
    let (text, said) = left_out(&[("truth/log.csv", LOG), ("truth/log.json", "{}")]);
    assert!(text.contains("not looked at: truth (the truth of generated recordings)"), "{text}");
    assert_eq!(said, [""; 0]);
    assert_eq!(left_out(&[("truth/a.csv", "frame,time_s,J2_deg\n0,0,1\n")]).1, [""; 0]);
    let (_, said) = left_out(&[("truth/c.csv", LOG)]);
    assert!(said.len() == 1 && said[0].starts_with("not looked at: truth (by its name"), "{said:?}");
    let (text, said) = left_out(&[("1/2/3/4/5/6/7/notes.docx", "")]);
    assert!(said.is_empty() && text.contains("not looked at: 1/2/3/4/5/6/7 (too many folders deep"), "{text}");
    let (_, said) = left_out(&[("1/2/3/4/5/6/7/8/c.csv", LOG), ("1/2/3/4/5/6/c.csv", LOG)]);
    assert!(said.iter().any(|said| said.starts_with("not looked at: 1/2/3/4/5/6/7 (too many")), "{said:?}");
    let nothing = propose(folder(&[("truth/c.csv", LOG)]).path(), "").unwrap_err().to_string();
    assert!(nothing.contains("1 file(s); not looked at: truth (by its name"), "{nothing}");
}

#[test]
fn names_of_several_parts_are_pointed_at() {
    let parts = proposed(&[("S01_rest.png", ""), ("S01_press.png", ""), ("S02_rest.png", ""), ("S02_press.png", "")]);
    assert!(parts.0.contains("write files = \"..{subject}_{pose}..\""), "{}", parts.0);
    let plain = proposed(&[("S_01.png", ""), ("S_02.png", ""), ("S_03.png", "")]);
    assert!(!plain.0.contains("seem to have parts"), "{}", plain.0);
}

#[test]
fn videos_and_logs_become_sets_and_models_of_force() {
    let (text, tasks) = proposed(&[
        ("v/S01.mp4", ""),
        ("v/S02.mp4", ""),
        ("markers.toml", MARKERS),
        ("l/S01.csv", LOG),
        ("l/S02.csv", LOG),
        ("notes.docx", ""),
    ]);
    assert!(text.contains("sync = \"correlate\"") && text.contains("not used: notes.docx"), "{text}");
    assert_eq!(tasks, ["angles/S01", "angles/S02", "sets/S01", "sets/S02", "force"]);
}

#[test]
fn a_table_of_sessions_is_taken_before_names() {
    let (text, tasks) = proposed(&[
        ("sessions.csv", "subject,kind,film,log\nS01,bending,a.mp4,a.csv\nS01,touch,,b.csv\n"),
        ("a.mp4", ""),
        ("markers.toml", &MARKERS.replace("[joints]", "[clock]\n[joints]")),
        ("a.csv", LOG),
        ("b.csv", LOG),
    ]);
    assert!(text.contains("video = \"recordings.film\"") && text.contains("keys = [\"subject\", \"kind\"]"), "{text}");
    assert!(!text.contains("correlate"), "{text}");
    assert_eq!(tasks, ["angles/S01/bending", "sets/S01/bending", "force/S01"]);
}

#[test]
fn logs_of_which_none_is_the_videos_by_name_are_not_labelled() {
    let (text, tasks) = proposed(&[
        ("finger/video.mp4", ""),
        ("finger/markers.toml", &MARKERS.replace("[joints]", "[clock]\n[joints]")),
        ("finger/log.csv", LOG),
        ("touch/log.csv", LOG),
    ]);
    assert!(text.contains("which log belongs to which video"), "{text}");
    assert_eq!(tasks, ["angles", "force"]);
    // Names of the same places, of which none is the same.
    let (text, tasks) = proposed(&[
        ("finger/video.mp4", ""),
        ("other/clip.mp4", ""),
        ("finger/markers.toml", MARKERS),
        ("finger/log.csv", LOG),
        ("anna/touch.csv", LOG),
    ]);
    assert!(text.contains("which log belongs to which video"), "{text}");
    assert!(tasks.iter().all(|task| !task.starts_with("sets")), "{tasks:?}");
}

#[test]
fn what_cannot_be_used_is_told() {
    let (text, tasks) = proposed(&[("v.mp4", ""), ("log.csv", LOG)]);
    assert!(text.contains("--suggest"), "{text}");
    assert_eq!(tasks, ["force"]);
    assert!(matches!(propose(folder(&[]).path(), ""), Err(InitError::Nothing { .. })));
    assert!(matches!(propose(folder(&[("x.docx", "")]).path(), ""), Err(InitError::Nothing { .. })));
    assert!(matches!(propose(&folder(&[]).path().join("none"), ""), Err(InitError::Unreadable { .. })));
}
