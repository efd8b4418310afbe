//! Models in pipelines: the same as the commands make, nothing that is not wanted, and the same bytes anywhere.

use serde_json::Value;

use crate::util::Dir;

/// Two touch-like recordings and a third, of two people, and what is to be made of them.
const PIPELINE: &str = r#"
wanted = ["force", "known", "modes", "step", "spring", "again"]

[inputs.touch]
files = "logs/{subject}-{repetition}/log.csv"

[stage.force]
job = "train"
each = ["subject"]
data = { from = "touch", where = { repetition = ["1", "2"] } }
validate = { from = "touch", where = { repetition = "3" } }
target = "force"

[stage.known]
job = "evaluate"
model = "force"
data = { from = "touch", where = { repetition = "3" } }

[stage.modes]
job = "analyse"
model = "force"

[stage.step]
job = "simulate"
pf1 = "step:5000@0..1"
until = 2
every = 0.02
rtol = 1e-6
with_loads = true

[stage.spring]
job = "fit"
recordings = "step"
free = ["k_C"]
set = { k_C1_N_per_m = 8e4, k_C2_N_per_m = 8e4 }
starts = 1
between = "held"
unloaded_before = true

[stage.again]
job = "static"
params = "spring"
static = "0..4000/1000"
"#;

/// Recordings of two people under `name`, and the pipeline beside them.
fn scene(dir: &Dir, name: &str) {
    dir.write(&format!("{name}/models.toml"), PIPELINE);
    for subject in 1..=2 {
        for repetition in 1..=3 {
            let out = format!("{name}/logs/S{subject}-{repetition}");
            let seed = (10 * subject + repetition).to_string();
            let options =
                ["--subject", &subject.to_string(), "--force", "spiral", "--touch-from", "5", "--seconds", "40", "-q"];
            dir.lunula(&[&["phantom", "log", "--seed", &seed, "--out", &out][..], &options].concat()).expect(0);
        }
    }
}

fn run(dir: &Dir, name: &str, threads: &str) {
    let (pipeline, out) = (format!("{name}/models.toml"), format!("{name}/out"));
    dir.lunula(&["run", &pipeline, "--out", &out, "--threads", threads, "-q"]).expect(0);
}

/// What tasks made: neither records nor the page.
fn made(dir: &Dir, name: &str) -> std::collections::BTreeMap<String, Vec<u8>> {
    let mut found = dir.bytes_of(&format!("{name}/out"));
    found.retain(|file, _| file.contains('/') && !file.starts_with('.'));
    found
}

#[test]
fn models_in_a_pipeline_are_those_of_the_commands_and_the_same_anywhere() {
    let dir = Dir::new();
    scene(&dir, "one");
    run(&dir, "one", "1");
    let files = made(&dir, "one");
    let names: Vec<&str> = files.keys().map(String::as_str).collect();
    assert_eq!(
        names,
        [
            "again/static.csv",
            "force/S1/merit.csv",
            "force/S1/model.json",
            "force/S2/merit.csv",
            "force/S2/model.json",
            "known/S1/merit.csv",
            "known/S2/merit.csv",
            "modes/S1/modes.csv",
            "modes/S2/modes.csv",
            "spring/fit-estimates.csv",
            "spring/fit-fitted.csv",
            "spring/fit.toml",
            "step/trajectory.csv",
        ]
    );
    let log = |repetition: u32| format!("one/logs/S1-{repetition}/log.csv");
    let [first, second, third] = [1, 2, 3].map(log);
    let train = ["train", &first, &second, "--target", "force", "--validate", &third, "--out", "bare.json", "-q"];
    dir.lunula(&train).expect(0);
    let [own, bare] = [&files["force/S1/model.json"], &dir.bytes_of(".")["bare.json"]]
        .map(|bytes| serde_json::from_slice::<Value>(bytes).expect("JSON"));
    for part in ["model", "inputs", "targets", "intervals"] {
        assert_eq!(own[part], bare[part], "{part}");
    }
    assert_eq!(own["training"]["sha256"], bare["training"]["sha256"]);
    assert_eq!(own["training"]["recordings"][0]["name"], "logs/S1-1/log.csv");
    assert_eq!(own["training"]["recordings"][0]["subject"], "S1");
    let spring = String::from_utf8(files["spring/fit-estimates.csv"].clone()).expect("text");
    let stiffness =
        spring.lines().nth(1).and_then(|line| line.split(',').nth(3)).and_then(|value| value.parse::<f64>().ok());
    let (stiffness, thesis) = (stiffness.expect("a value"), 1e5);
    // The step was simulated to 1e-6.
    assert!((stiffness / thesis - 1.0).abs() <= 1e-3, "{spring}");

    scene(&dir, "another/place");
    run(&dir, "another/place", "4");
    let other = made(&dir, "another/place");
    assert_eq!(names, other.keys().map(String::as_str).collect::<Vec<_>>());
    for (name, bytes) in &files {
        assert!(other[name] == *bytes, "{name} differs");
    }
    run(&dir, "one", "2");
    assert!(made(&dir, "one") == files, "done again, nothing changes");
}
