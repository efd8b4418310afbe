//! What the predictor commands say of tables and model files that are not as they should be: which file, where in it,
//! what to do.

use crate::util::sensor::{Recording, near};
use crate::util::{Dir, Json};
use serde_json::{Value, json};

fn sensor() -> Dir {
    let dir = Dir::new();
    dir.recording("a.csv", &Recording::of(0..60));
    dir.recording("b.csv", &Recording::of(100..160));
    dir
}

#[track_caller]
fn refused(dir: &Dir, words: &[&str]) {
    dir.train("a.csv", "force", "m.json", &[]).refuses(words);
    assert!(!dir.path("m.json").exists());
}

#[test]
fn the_first_wrong_cell_of_the_first_wrong_file_is_reported() {
    let dir = sensor();
    dir.recording("a.csv", &Recording::of(0..60).cell(30, "P1", "x").cell(12, "Fy_N", "y"));
    dir.recording("b.csv", &Recording::of(0..60).cell(1, "P1", "z"));
    for threads in ["1", "4"] {
        let all = ["b.csv", "--target", "force", "--out", "m.json", "--threads", threads];
        dir.lunula(&[&["train", "a.csv"], &all[..]].concat()).expect(2).says("a.csv:14: column `Fy_N`: `y`");
    }
    // Those to validate and to stop on as well, and in the other commands.
    dir.recording("a.csv", &Recording::of(0..60));
    for option in ["--validate", "--stop-on"] {
        dir.train("a.csv", "force", "m.json", &[option, "b.csv"]).expect(2).says("b.csv:3: column `P1`: `z`");
    }
    dir.train("a.csv", "force", "m.json", &["-q"]).expect(0);
    for command in [
        "evaluate m.json b.csv",
        "predict m.json b.csv --out p.csv",
        "prune a.csv --validate b.csv",
        "prune b.csv --validate a.csv",
    ] {
        dir.words(command).expect(2).says("b.csv:3: column `P1`: `z`");
        let dropped: Vec<&str> = command.split(' ').chain(["--drop-invalid"]).collect();
        dir.lunula(&dropped).expect(0);
    }
}

#[test]
fn empty_cells_are_left_out_and_counted() {
    let dir = sensor();
    dir.recording("a.csv", &Recording::of(0..60).cell(3, "P4", "").cell(9, "Fz_N", "").cell(20, "time_s", ""));
    dir.train("a.csv", "force", "m.json", &[]).expect(0).prints("a.csv: 58 of 60 rows used (2 lack a cell, 0 invalid");
}

#[test]
fn missing_columns_are_reported_by_each_command() {
    let all = Recording::of(0..60);
    let dir = sensor();
    dir.recording("a.csv", &all.clone().renamed("Fz_N", "Fz"));
    refused(&dir, &["a.csv: has no column `Fz_N`; is it `Fz`?"]);
    // Files have to agree; those given later name what they lack.
    dir.recording("a.csv", &all);
    dir.recording("b.csv", &all.without("P7"));
    dir.train("a.csv b.csv", "force", "m.json", &[]).expect(2).says("b.csv lacks P7");
    dir.train("a.csv b.csv", "force", "m.json", &["--inputs", "P1,P2"]).expect(0);
    dir.train("a.csv", "force", "m.json", &["--inputs", "P1,P11"]).expect(2).says("has no column `P11`");
    dir.train("a.csv", "force", "m.json", &["--validate", "b.csv"]).expect(2).says("b.csv: has no column `P7`");
    dir.train("a.csv", "force", "m.json", &[]).expect(0);
    dir.lunula(&["evaluate", "m.json", "b.csv"]).expect(2).says("b.csv: has no column `P7`");
    dir.recording("b.csv", &all.clone().renamed("P7", "p7"));
    let predict = ["predict", "m.json", "b.csv", "--out", "p.csv"];
    dir.lunula(&predict).expect(2).says("b.csv: has no column `P7`; is it `p7`?");
    assert!(!dir.path("p.csv").exists());
    dir.recording("b.csv", &all.without("Fx_N"));
    dir.lunula(&["evaluate", "m.json", "b.csv"]).expect(2).says("has no column `Fx_N`");
    dir.lunula(&predict).expect(0);
}

#[test]
fn files_that_are_no_tables() {
    let dir = sensor();
    dir.write("a.csv", [0x89, b'P', b'N', b'G', 0, 0xff, 0xfe, b'\n', 1, 2]);
    refused(&dir, &["a.csv"]);
    std::fs::remove_file(dir.path("a.csv")).unwrap();
    std::fs::create_dir(dir.path("a.csv")).unwrap();
    refused(&dir, &["a.csv"]);
}

#[test]
fn a_run_that_fails_leaves_the_model_that_stood_there() {
    let dir = sensor();
    dir.train("a.csv", "force", "m.json", &["-q"]).expect(0);
    let before = dir.text("m.json");
    dir.recording("bad.csv", &Recording::of(0..60).cell(4, "P1", "x"));
    dir.recording("few.csv", &Recording::of(0..5));
    for arguments in
        [&["bad.csv"][..], &["few.csv"], &["a.csv", "--validate", "bad.csv"], &["a.csv", "--friction", "nan"]]
    {
        let train = ["--target", "force", "--out", "m.json"];
        dir.lunula(&[&["train"], arguments, &train].concat()).expect(2);
        assert_eq!(dir.text("m.json"), before);
    }
    for input in ["a.csv", "./b.csv"] {
        let over =
            dir.lunula(&["train", "a.csv", "--validate", "b.csv", "--target", "force", "--out", input]).expect(2);
        over.says("is an input itself; choose another name");
    }
    assert_eq!(dir.text("a.csv"), Recording::of(0..60).csv());
    dir.train("a.csv", "force", "nowhere/m.json", &["-q"]).expect(0);
    assert_eq!(dir.text("nowhere/m.json"), before);
    dir.train("a.csv", "force", "a.csv/m.json", &[]).expect(2).says("a.csv");
    dir.lunula(&["train", "a.csv", "--target", "force"]).expect(2).says("--out");
    dir.lunula(&["train", "a.csv", "--out", "m.json"]).expect(2).says("--target");
    let both = ["--validate", "b.csv", "--learning-curve", "m.json"];
    dir.train("a.csv", "force", "m.json", &both).expect(2);
    assert_eq!(dir.text("m.json"), before);
    // Nothing half-written is left beside.
    let mut left: Vec<String> = dir.bytes_of("").into_keys().collect();
    left.sort();
    assert_eq!(left, ["a.csv", "b.csv", "bad.csv", "few.csv", "m.json", "nowhere/m.json"]);
}

/// Trains a model of `kind`, changes its file, and returns what `evaluate` says of it.
#[track_caller]
fn edited(dir: &Dir, change: impl FnOnce(&mut Value)) -> crate::util::Answer {
    let mut model = dir.parsed("m.json");
    change(&mut model);
    dir.write("edited.json", serde_json::to_string_pretty(&model).expect("JSON"));
    dir.lunula(&["evaluate", "edited.json", "b.csv", "--json"])
}

#[test]
fn a_model_file_that_does_not_fit_is_refused_with_the_reason() {
    let dir = sensor();
    dir.train("a.csv", "force", "m.json", &["--validate", "b.csv", "-q"]).expect(0);
    type Change = fn(&mut Value);
    let changes: [(Change, &str); 22] = [
        (|m| m["version"] = json!(2), "is a model file of version 2, and this program reads version 1"),
        (|m| m["version"] = json!("1"), "version \"1\""),
        (|m| drop(m.as_object_mut().unwrap().remove("version")), "version missing"),
        (|m| m["format"] = json!("sklearn"), "is no model of lunula (its \"format\" is \"sklearn\")"),
        (|m| m["colour"] = json!(1), "unknown field `colour`"),
        (|m| m["model"]["colour"] = json!(1), "colour"),
        (|m| m["inputs"][0]["colour"] = json!(1), "unknown field `colour`"),
        (|m| drop(m["model"].as_object_mut().unwrap().remove("offset")), "missing field `offset`"),
        (|m| drop(m.as_object_mut().unwrap().remove("training")), "missing field `training`"),
        (|m| m["model"]["kind"] = json!("cubic"), "cubic"),
        (|m| m["model"]["kind"] = json!("quadratic"), "missing field"),
        (|m| m["model"]["jacobian"][1][2] = Value::Null, "null"),
        (|m| m["model"]["centre"][0] = json!("2.5"), "2.5"),
        (|m| drop(m["model"]["jacobian"].as_array_mut().unwrap().pop()), "does not fit together"),
        (|m| drop(m["model"]["jacobian"][0].as_array_mut().unwrap().pop()), "jacobian: 7 where 8 are needed"),
        (|m| m["model"]["offset"].as_array_mut().unwrap().push(json!(1.0)), "does not fit together"),
        (|m| drop(m["inputs"].as_array_mut().unwrap().pop()), "inputs of the model: 8 where 7 are needed"),
        (|m| drop(m["targets"].as_array_mut().unwrap().pop()), "targets of the model: 3 where 2 are needed"),
        (|m| m["inputs"][3]["name"] = json!("P1"), "two columns are named P1"),
        (|m| m["inputs"][3]["low"] = json!(9.0), "the range of P4 is upside down"),
        (|m| drop(m["intervals"]["half_width"].as_array_mut().unwrap().pop()), "2 intervals for 3 targets"),
        (|m| m["intervals"]["half_width"][1] = json!(-0.5), "half width"),
    ];
    for (change, words) in changes {
        edited(&dir, change).expect(2).says("edited.json: ").says(words);
    }
    let more: [(Change, &str); 4] = [
        (|m| m["intervals"]["level"] = json!(1.5), "share"),
        (|m| m["training"]["recipe"]["kind"] = json!("quadratic"), "the recipe is of another kind"),
        (|m| m["training"]["recipe"]["lags_s"] = json!([0.1]), "the lags are not the recipe's"),
        (|m| m["training"]["recipe"]["friction_mu"] = json!(-1.0), "coefficient of friction of -1"),
    ];
    for (change, words) in more {
        edited(&dir, change).expect(2).says(words);
    }
    // The same fault is refused by every command.
    edited(&dir, |m| m["version"] = json!(2)).expect(2);
    for command in ["predict edited.json b.csv --out p.csv", "predict edited.json -", "analyse edited.json"] {
        dir.words(command).expect(2).says("edited.json: is a model file of version 2");
    }
}

#[test]
fn quadratic_and_network_files_are_checked_as_well() {
    let dir = sensor();
    let few = ["--hidden", "3", "--restarts", "1", "--epochs", "3", "-q"];
    type Change = fn(&mut Value);
    let of_quadratic: [(Change, &str); 3] = [
        (|m| m["model"]["scale"][0] = json!(0.0), "scale"),
        (|m| drop(m["model"]["jacobian"][0].as_array_mut().unwrap().pop()), "jacobian: 43 where 44 are needed"),
        (|m| drop(m["model"]["centre"].as_array_mut().unwrap().pop()), "does not fit together"),
    ];
    let of_network: [(Change, &str); 6] = [
        (|m| m["model"]["scale"][0] = json!(0.0), "scale"),
        (|m| drop(m["model"]["hidden_biases"].as_array_mut().unwrap().pop()), "does not fit together"),
        (
            |m| drop(m["model"]["hidden_weights"][1].as_array_mut().unwrap().pop()),
            "hidden_weights: 7 where 8 are needed",
        ),
        (|m| drop(m["model"]["output_weights"].as_array_mut().unwrap().pop()), "does not fit together"),
        (|m| drop(m["model"]["target_scale"].as_array_mut().unwrap().pop()), "target scales: 2 where 3 are needed"),
        (|m| m["training"]["recipe"]["kind"]["network"]["hidden"] = json!(5), "hidden"),
    ];
    dir.recording("a.csv", &Recording::of(0..120));
    for (kind, changes) in [("quadratic", &of_quadratic[..]), ("network", &of_network)] {
        dir.train("a.csv", "force", "m.json", &[&["--model", kind], &few[..]].concat()).expect(0);
        edited(&dir, |_| ()).expect(0);
        for (change, words) in changes {
            edited(&dir, change).expect(2).says("edited.json: ").says(words);
        }
    }
}

#[test]
fn a_file_that_is_cut_or_none_is_refused() {
    let dir = sensor();
    dir.train("a.csv", "force", "m.json", &["-q"]).expect(0);
    let whole = dir.text("m.json");
    for (text, words) in [
        (&whole[..whole.len() / 2], "is not a model file: EOF"),
        (&whole[..1], "is not a model file: EOF"),
        ("", "is no model"),
        ("[]", "is no model of lunula"),
        ("{}", "its \"format\" is missing"),
        ("null", "is no model of lunula"),
        ("time_s,P1\n0,1\n", "name a file that `lunula train` wrote"),
    ] {
        dir.write("cut.json", text);
        dir.lunula(&["analyse", "cut.json"]).expect(2).says("cut.json: ").says(words);
    }
    let twice = whole.replacen("\"version\": 1,", "\"version\": 1,\n  \"version\": 1,", 1);
    dir.write("cut.json", twice);
    dir.lunula(&["analyse", "cut.json"]).expect(2).says("duplicate field `version`");
    dir.write("cut.json", whole.replacen("0.3125", "1e999", 1));
    dir.lunula(&["analyse", "cut.json"]).expect(2).says("number out of range");
    dir.write("cut.json", whole.replacen("0.3125", "NaN", 1));
    dir.lunula(&["analyse", "cut.json"]).expect(2).says("cut.json: is not a model file");
    dir.write("cut.json", [0xff, 0xfe, 0x00]);
    dir.lunula(&["analyse", "cut.json"]).expect(2).says("cut.json: is not UTF-8 text");
    std::fs::create_dir(dir.path("folder.json")).unwrap();
    dir.lunula(&["analyse", "folder.json"]).expect(2).says("folder.json: is a folder; name a file in it");
    dir.lunula(&["analyse", "nowhere.json"]).expect(2).says("nowhere.json: is not there");
}

#[test]
fn an_edited_coefficient_is_used_and_reported() {
    let dir = sensor();
    dir.train("a.csv", "force", "m.json", &["-q"]).expect(0);
    let honest = dir.lunula(&["evaluate", "m.json", "b.csv", "--json"]).expect(0);
    assert!(honest.stderr.is_empty(), "{}", honest.stderr);
    let answer = edited(&dir, |m| m["model"]["offset"][2] = json!(m["model"]["offset"][2].number() + 0.5)).expect(0);
    near(&[answer.json()["bias"]["Fz_N"].number()], &[0.5], 1e-14);
    assert!(answer.json()["warnings"][0].words().contains("was edited after it was trained"));
    answer.says("edited.json: was edited after it was trained");
    dir.lunula(&["predict", "edited.json", "b.csv", "--out", "p.csv"]).expect(0).says("was edited");
    // Another layout of the same numbers is no edit; a checksum taken away is.
    let compact: Value = dir.parsed("m.json");
    dir.write("compact.json", serde_json::to_string(&compact).unwrap());
    assert_eq!(dir.lunula(&["evaluate", "compact.json", "b.csv", "-q"]).expect(0).stderr, "");
    dir.lunula(&["evaluate", "compact.json", "b.csv"]).expect(0).never_says("was edited");
    edited(&dir, |m| drop(m.as_object_mut().unwrap().remove("sha256"))).expect(0).says("was edited");
}

#[test]
fn a_recording_that_cant_be_read_is_skipped_only_where_that_is_asked_for() {
    let dir = sensor();
    dir.write("bad.csv", "time_s;P1\n");
    let all = ["train", "bad.csv", "a.csv", "b.csv", "--target", "force", "--out", "m.json"];
    dir.lunula(&all).expect(2).says("bad.csv");
    assert!(!dir.path("m.json").exists());
    let answer = dir.lunula(&[&all[..], &["--skip-failed", "--json"]].concat()).expect(1).says("failed: bad.csv: ");
    let report = answer.json();
    assert!(report["failed"][0].as_str().is_some_and(|why| why.starts_with("bad.csv: ")), "{report}");
    assert_eq!(report["data"].list().len(), 2);
    let model = dir.parsed("m.json");
    assert_eq!((&model["training"]["failed"], &model["training"]["rows"]), (&json!(["bad.csv"]), &json!(120)));
    dir.lunula(&["evaluate", "m.json", "a.csv"]).expect(0);
    dir.words("train bad.csv --target force --out n.json --skip-failed").expect(2).says("bad.csv");
}
