//! A model in a pipeline is the one that the command makes.

use serde_json::Value;

use crate::util::Dir;

/// A model for each of two people, of two recordings and judged on a third.
const PIPELINE: &str = r#"
wanted = ["force"]

[inputs.touch]
files = "logs/{subject}-{repetition}/log.csv"

[stage.force]
job = "train"
each = ["subject"]
data = { from = "touch", where = { repetition = ["1", "2"] } }
validate = { from = "touch", where = { repetition = "3" } }
target = "force"
"#;

#[test]
fn models_in_a_pipeline_are_those_of_the_command() {
    let dir = Dir::new();
    dir.write("models.toml", PIPELINE);
    for subject in 1..=2 {
        for repetition in 1..=3 {
            let out = format!("--seed {} --out logs/S{subject}-{repetition}", 10 * subject + repetition);
            let scene = "phantom log --force spiral --touch-from 5 --seconds 40 -q";
            dir.words(&format!("{scene} --subject {subject} {out}")).expect(0);
        }
    }
    dir.words("run models.toml --out out -q").expect(0);
    let first = "logs/S1-1/log.csv";
    let train = format!("train {first} logs/S1-2/log.csv --validate logs/S1-3/log.csv --target force");
    dir.words(&format!("{train} --out bare.json -q")).expect(0);
    let [own, bare] = ["out/force/S1/model.json", "bare.json"]
        .map(|name| serde_json::from_str::<Value>(&dir.text(name)).expect("JSON"));
    for part in ["model", "inputs", "targets", "intervals"] {
        assert_eq!(own[part], bare[part], "{part}");
    }
    assert_eq!(own["training"]["sha256"], bare["training"]["sha256"]);
    assert_eq!(own["training"]["recordings"][0]["name"], first);
    assert_eq!(own["training"]["recordings"][0]["subject"], "S1");
    assert!(dir.path("out/force/S2/model.json").exists());
}
