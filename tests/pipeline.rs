//! `lunula run` and `lunula init` from end to end, on small phantoms.

use std::fs;

use crate::util::{Dir, touch_pipeline, without_phantom};

/// Photographs of two poses to maps, generated on the way.
pub(crate) const COLORATION: &str = r#"name = "colours"
wanted = ["maps"]
[phantom]
photos = { seed = 3, subjects = 3, poses = ["normal"], grey = true }
[inputs.photos]
files = "{phantom}/photos/photos/{pose}/{subject}.png"
[stage.normalized]
job = "normalize"
photo = "photos"
[stage.maps]
job = "maps"
sums = "normalized"
"#;

/// Three generated logs to models of force, one person's each.
fn touch() -> String {
    touch_pipeline(&[("a", 1), ("b", 2), ("c", 3)], "seconds = 20")
}

#[test]
fn a_plan_writes_nothing_and_is_the_same_before_and_after_but_for_what_stands() {
    let dir = Dir::new();
    dir.write("p.toml", COLORATION);
    let before = dir.lunula(&["run", "p.toml", "--out", "out", "--plan", "--json"]).expect(0).json();
    assert!(!dir.path("out").exists());
    dir.lunula(&["run", "p.toml", "--out", "out", "--quiet"]).expect(0);
    let after = dir.lunula(&["run", "p.toml", "--out", "out", "--plan", "--json"]).expect(0).json();
    let counts = |plan: &serde_json::Value| (plan["run"].as_u64(), plan["done"].as_u64());
    let all = counts(&before).0;
    assert!(all > Some(3), "{before}");
    assert_eq!((counts(&before), counts(&after)), ((all, Some(0)), (Some(0), all)));
    let steps = |plan: &serde_json::Value| -> Vec<(String, String)> {
        let stages = plan["stages"].as_array().unwrap().iter();
        let lines = stages.flat_map(|stage| stage["steps"].as_array().unwrap());
        lines.map(|line| (line["step"].to_string(), line["reason"].to_string())).collect()
    };
    assert_eq!(steps(&before), steps(&after));
    dir.lunula(&["run", "p.toml", "--out", "out", "--plan"]).expect(0).prints("maps").prints("done").prints("left out");
}

#[test]
fn what_fails_fails_its_own_branch_and_is_a_table_at_the_end() {
    let dir = Dir::new();
    dir.words("phantom log --seed 1 --protocol touch --seconds 20 --out a --quiet").expect(0);
    let own = without_phantom(&touch());
    dir.write("p.toml", own.replace("{phantom}/log/{session}/log.csv", "{session}/log.csv"));
    dir.write("b/log.csv", "time_s,P1\n0,what\n");
    let answer = dir.lunula(&["run", "p.toml", "--out", "out", "--json"]).expect(1).says("failed: force/b");
    let report = answer.json();
    assert_eq!(
        (report["done"].as_u64(), report["failed"].as_u64(), report["not_done"].as_u64()),
        (Some(2), Some(1), Some(1))
    );
    assert!(dir.path("out/force/a/model.json").exists());
    let page = dir.text("out/report.html");
    assert!(page.contains("What failed") && page.contains("force/b"));
    let kept = dir.parsed("out/run.json");
    assert_eq!(kept["stages"], report["stages"]);
    let [share, time]: [f64; 2] = ["share", "task_s"]
        .map(|key| kept["stages"].as_array().unwrap().iter().map(|stage| stage[key].as_f64().unwrap()).sum());
    assert!((share - 1.0).abs() < 1e-9 && time > 0.0);
}

#[test]
fn faults_name_file_line_and_column_and_nothing_starts() {
    let dir = Dir::new();
    dir.write("p.toml", touch().replace("job = \"train\"", "job = \"trian\"").replace("\"how_good\"]", "\"how_god\"]"));
    dir.words("run p.toml --out out")
        .expect(2)
        .says("p.toml:1:20: `how_god` is wanted, and no stage makes it; did you mean `how_good`?")
        .says("p.toml:11:7: no job `trian`; did you mean `train`?");
    dir.lunula(&["run", "none.toml", "--out", "out"]).expect(2).says("none.toml: ");
    dir.write("q.toml", touch().replace("{session}/log.csv", "{session}/lgo.csv"));
    dir.lunula(&["run", "q.toml", "--out", "out"]).expect(2).says("q.toml:9:9: nothing matches");
    dir.write("r.toml", touch().replace("seconds = 20 }", "secnds = 20 }"));
    dir.lunula(&["run", "r.toml", "--out", "out"]).expect(2).says("r.toml:");
    assert!(!dir.path("out").exists());
}

#[test]
fn a_marker_file_of_each_subject_is_that_of_all_their_videos() {
    let dir = Dir::new();
    for subject in ["s01", "s02"] {
        for (from, to) in [("video.mp4", "video_1.mp4"), ("video.mp4", "video_2.mp4"), ("markers.toml", "markers.toml")]
        {
            let from = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/finger/").to_owned() + from;
            dir.write(&format!("lab/{subject}/{to}"), fs::read(from).expect("a fixture"));
        }
    }
    dir.lunula(&["init", "lab"]).expect(0);
    let text = dir.text("lab/pipeline.toml");
    assert!(text.contains("{subject}/{session}.mp4") && text.contains("{subject}/markers.toml"), "{text}");
    dir.lunula(&["run", "lab/pipeline.toml", "--plan"]).expect(0);
}

#[test]
fn what_init_writes_runs_as_it_stands_and_is_never_overwritten() {
    let dir = Dir::new();
    for (name, seed) in [("S01", "1"), ("S02", "2")] {
        dir.words(&format!("phantom log --seed {seed} --protocol touch --seconds 20 --out lab/{name} --quiet"))
            .expect(0);
    }
    dir.words("phantom photos --seed 5 --subjects 2 --poses normal --out lab/nails --quiet").expect(0);
    dir.lunula(&["init", "lab"]).expect(0);
    let text = dir.text("lab/pipeline.toml");
    assert!(text.contains("job = \"maps\"") && text.contains("job = \"train\""), "{text}");
    dir.lunula(&["init", "lab"]).expect(2).says("stands already");
    dir.lunula(&["init", "lab", "--out", "elsewhere.toml"]).expect(0);
    dir.words("run lab/pipeline.toml --out a --quiet").expect(0);
    dir.words("run elsewhere.toml --out b --quiet").expect(0);
    assert_eq!(dir.results_of("a").keys().collect::<Vec<_>>(), dir.results_of("b").keys().collect::<Vec<_>>());
    dir.lunula(&["init", "none"]).expect(2);
}
