//! `lunula layout` from the command line: maps of `lunula photos` to places that other commands read.

use lunula::nail::Positions;

use crate::util::{Dir, Json, repository};

#[test]
fn photographs_to_maps_to_a_layout() {
    let dir = Dir::new();
    let scene = ["phantom", "photos", "--seed", "1", "--subjects", "6", "--size", "160x120", "--out", "scene", "-q"];
    dir.lunula(&scene).expect(0);
    dir.lunula(&["photos", "scene/photos", "--out", "set", "--size", "96", "-q"]).expect(0);
    let answer = dir.lunula(&["layout", "set", "--k", "1..4", "--proof", "0.01", "--out", "laid", "--json"]).expect(0);
    let report = answer.json();
    assert_eq!(report["persons"].list().len(), 6);
    let k = report["chosen"]["k"].number() as usize;
    let positions = Positions::from_json(&dir.text("laid/layout.json")).unwrap();
    assert_eq!(positions.photodiodes.len(), k);
    let rows = dir.table("laid/layout.csv");
    let error = |k: &str, method: &str| {
        let row = rows.iter().find(|row| row["k"] == k && row["method"] == method).expect("a row");
        row["error"].parse::<f64>().expect("a number")
    };
    // Poses of a phantom are separated; each further place helps, and choosing by the poses beats not knowing them.
    assert!(error("4", "best") < error("1", "best") && error("4", "best") < error("4", "qr"));
    assert!(error("4", "best") <= error("4", "greedy") && error("1", "best") <= 0.5);
    for picture in ["layout.png", "layout.svg", "error-against-k.png", "error-against-k.svg", "run.json"] {
        assert!(dir.path("laid").join(picture).exists(), "{picture}");
    }
    dir.lunula(&["layout", "set", "--plan"]).expect(0).prints("branch and bound");
    // What maps have no use for is named.
    let unused = ["layout", "set", "--k", "1", "--out", "unused", "--targets", "Fx_N", "--positions", "p.toml"];
    dir.lunula(&unused).expect(0).says("--targets is of no use here").says("--positions is of no use here");
    dir.lunula(&["layout", "scene", "--out", "none"]).expect(2).says("a folder without maps");
    assert!(!dir.path("none").exists());
}

#[test]
fn what_an_earlier_run_left_among_maps_is_left_out() {
    let dir = Dir::new();
    let scene = ["phantom", "photos", "--seed", "2", "--subjects", "4", "--size", "160x120", "--out", "scene", "-q"];
    dir.lunula(&scene).expect(0);
    let photos = |out: &str| dir.lunula(&["photos", "scene/photos", "--out", out, "--size", "64"]).expect(0);
    photos("set");
    std::fs::remove_dir_all(dir.path("scene/photos/flexion")).expect("removed");
    for ending in ["png", "json"] {
        std::fs::remove_file(dir.path(&format!("scene/photos/normal/s03.{ending}"))).expect("removed");
    }
    photos("set");
    photos("fresh");
    let layout = |set: &str, out: &str| dir.lunula(&["layout", set, "--k", "1..2", "--out", out]);
    layout("set", "of-set").expect(0).says("maps/flexion-mean.npy and 1 more: not in nails.csv, so of an earlier run");
    layout("fresh", "of-fresh").expect(0).never_says("has no run.json");
    assert_eq!(dir.text("of-set/layout.csv"), dir.text("of-fresh/layout.csv"));
    // The report beside the maps is theirs.
    layout("set", "set").expect(2).says("is an input itself");
    dir.write("set/run.json", dir.text("of-set/run.json"));
    layout("set", "no").expect(2).says("set/run.json").says("run `lunula photos` again");
    assert!(!dir.path("no").exists());
    std::fs::remove_file(dir.path("set/run.json")).expect("removed");
    layout("set", "bare").expect(0).says("note: set has no run.json").says("1.25 times the nail's box is assumed");
}

#[test]
fn photodiodes_of_a_log_are_laid_out_as_they_are() {
    let dir = Dir::new();
    dir.lunula(&["phantom", "log", "--seed", "1", "--out", "log", "-q"]).expect(0);
    let answer = dir.lunula(&["layout", "log/log.csv", "--k", "1..8", "--out", "laid", "--json"]).expect(0);
    let report = answer.json();
    assert_eq!((report["candidates"].number(), report["persons"].list().len()), (8.0, 1));
    // All eight are the thesis' eight, and all there are.
    let error = |method: &str, k: f64| {
        let methods = report["methods"].list();
        let own = methods.iter().find(|one| one["method"] == method && one["k"].number() == k).expect("a method");
        own["error"].number()
    };
    assert!((error("best", 8.0) - error("thesis", 8.0)).abs() <= 1e-12);
    assert!((error("best", 8.0) - error("all", 8.0)).abs() <= 1e-12);
    answer.says("no intervals");
    // A copy is no second person, and a transducer's other sign is no note.
    let text = std::fs::read_to_string(repository().join("fixtures/touch/log.csv")).expect("a log");
    dir.write("anna.csv", &text);
    dir.write("copy.csv", &text);
    dir.write("up.csv", text.replace(",-", ","));
    let answer = dir.lunula(&["layout", "anna.csv", "copy.csv", "up.csv", "--k", "1", "--out", "two", "--grid", "9"]);
    answer
        .expect(0)
        .says("note: --grid is of no use here: the candidates are photodiodes")
        .says("have the same readings and targets, row by row, and count as 2 persons")
        .says("warning: anna.csv, copy.csv: the same to the byte, and counted 2 times")
        .says("warning: up.csv: Fz_N goes from");
}
