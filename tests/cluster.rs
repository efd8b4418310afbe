//! `pipelines/cluster/array.sbatch` as Slurm would run it, without Slurm. (Its test.sh has one, and Snakemake.)

use std::process::{Command, Output};

use crate::util::{Dir, repository};

const SCRIPT: &str = "pipelines/cluster/array.sbatch";
const PIPELINE: &str = r#"
wanted = ["normalized", "maps"]

[inputs.photos]
files = "set/{pose}/{subject}.png"

[stage.normalized]
job = "normalize"
photo = "photos"

[stage.maps]
job = "maps"
sums = "normalized"
"#;

/// A folder with the pipeline and five photographs.
fn bench() -> Dir {
    let dir = Dir::new();
    dir.write("pipeline.toml", PIPELINE);
    for name in ["rest/S1", "rest/S2", "rest/S3", "pressed/S1", "pressed/S2"] {
        dir.nail(&format!("set/{name}"));
    }
    dir
}

/// Calls the script in `dir` with what Slurm would set.
fn script(dir: &Dir, arguments: &[&str], set: &[(&str, &str)]) -> Output {
    let mut command = Command::new("bash");
    command
        .arg(repository().join(SCRIPT))
        .args(arguments)
        .current_dir(dir.path("."))
        .env("LUNULA", env!("CARGO_BIN_EXE_lunula"));
    for name in ["SLURM_JOB_ID", "SLURM_ARRAY_TASK_ID"] {
        command.env_remove(name);
    }
    command.env("SLURM_CPUS_PER_TASK", "2").env("SLURM_MEM_PER_NODE", "2000").envs(set.iter().copied());
    command.output().expect("bash runs")
}

#[test]
fn an_array_s_parts_and_its_merge_make_the_bytes_of_one_run() {
    let dir = bench();
    dir.lunula(&["run", "pipeline.toml", "--out", "whole", "-q"]).expect(0);
    for part in ["1", "2", "3"] {
        let set = [("SLURM_JOB_ID", "7"), ("SLURM_ARRAY_TASK_ID", part)];
        let output = script(&dir, &["pipeline.toml", "out", "3"], &set);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }
    let output = script(&dir, &["pipeline.toml", "out", "3"], &[("SLURM_JOB_ID", "8")]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let whole = dir.results_of("whole");
    assert!(whole.len() > 10, "{:?}", whole.keys());
    assert!(dir.results_of("out") == whole, "{:?}", dir.results_of("out").keys());
}

#[test]
fn by_hand_it_hands_both_to_slurm_or_says_how_it_is_called() {
    let dir = bench();
    dir.write("bin/sbatch", "#!/bin/sh\necho \"$@\" >> calls\necho 41\n");
    let allowed = Command::new("chmod").arg("+x").arg(dir.path("bin/sbatch")).status().unwrap();
    assert!(allowed.success());
    let path = format!("{}:{}", dir.path("bin").display(), std::env::var("PATH").unwrap());
    let output = script(&dir, &["pipeline.toml", "out", "3"], &[("PATH", &path)]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let calls = dir.text("calls");
    let calls: Vec<&str> = calls.lines().collect();
    assert_eq!(calls.len(), 2, "{calls:?}");
    assert!(calls[0].contains("--array=1-3") && calls[0].ends_with("pipeline.toml out 3"), "{calls:?}");
    assert!(calls[1].contains("--dependency=afterany:41") && calls[1].ends_with("pipeline.toml out 3"), "{calls:?}");
    // A node of one processor can run them, and whoever has more says so: no #SBATCH line, which nothing overrides,
    // asks for any.
    assert!(calls.iter().all(|call| call.contains("--cpus-per-task=1 ") && call.contains("--mem=4000M ")), "{calls:?}");
    let output =
        script(&dir, &["pipeline.toml", "out", "3"], &[("PATH", &path), ("LUNULA_CPUS", "2"), ("LUNULA_TIME", "10")]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let calls = dir.text("calls");
    let last: Vec<&str> = calls.lines().skip(2).collect();
    assert!(last.iter().all(|call| call.contains("--cpus-per-task=2 ") && call.contains("--time=10 ")), "{last:?}");
    let asked = std::fs::read_to_string(repository().join(SCRIPT)).unwrap();
    assert!(!asked.lines().any(|line| line.starts_with("#SBATCH --cpus") || line.starts_with("#SBATCH --mem")));
    let output = script(&dir, &["pipeline.toml"], &[]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("PIPELINE.toml OUT N"));
}
