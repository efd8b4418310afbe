//! Standard output that can't be written to: a full disk is an error, a reader that went away is none. All commands.

use std::fs::{File, OpenOptions};
use std::process::{Command, Stdio};

use crate::doctor::commands;
use crate::util::{Dir, paths_below, repository};

const PIPELINE: &str = r#"
[inputs.photos]
files = "ph/photos/{pose}/{subject}.png"

[stage.rest]
job = "normalize"
photo = "photos"
"#;

/// Requests that say something on standard output; those that put results into their places have one of `--out`.
const REQUESTS: &[&str] = &[
    "--help",
    "--version",
    "photos ph/photos --out photos",
    "photos ph/photos --out none --plan",
    "photos merge whole --out merged --json",
    "posture v/video.mp4 --suggest",
    "posture v/video.mp4 --suggest --json",
    "posture v/video.mp4 --markers v/markers.toml --plan",
    "posture v/video.mp4 --markers v/markers.toml --out joints.csv --no-figures",
    "align --joints v/truth/joints.csv --log lg/log.csv --sync offset=0 --plan",
    "align --joints v/truth/joints.csv --log lg/log.csv --sync offset=60 --out set.csv --no-figures --json",
    "train lg/log.csv --target force --out other.json",
    "evaluate m.json lg/log.csv",
    "evaluate m.json lg/log.csv --json",
    "predict m.json -",
    "predict m.json lg/log.csv --out predicted.csv",
    "live --source lg/log.csv --model m.json",
    "live --source lg/log.csv --model m.json --plan",
    "record --source lg/log.csv --out recorded.csv --replace",
    "prompt --simulate --out prompted.csv --plan",
    "mouse --source lg/log.csv --model m.json --plan",
    "switch evaluate sw.toml lg/log.csv --model m.json --contact Fz_N<-0.2 --out judged --json",
    "analyse m.json",
    "prune lg/log.csv --validate lg/log.csv --target force --json",
    "simulate --print-params",
    "layout lg/log.csv --k 1..2 --out laid --json",
    "camera b/views --board 5x4 --square-mm 20 --plan",
    "simulate --plan",
    "simulate --until 0.1 --out s.csv --json",
    "fit pressed.csv --free b_C --plan",
    "performance trials.csv --path-m 1.42 --speed-mps 0.025 --decisions 27 --out performed --json",
    "skill lg/log.csv --out skilled",
    "merge part --out both",
    "phantom log --seed 1 --out log",
    "phantom photos --help",
    "tradeoff all --help",
    "trajectory force --plan",
    "run p.toml --plan --json",
    "run p.toml --out run",
    "init . --out new.toml",
    "ui --help",
    "edit ph/photos --plan",
    "nailvideo --help",
    "doctor",
    "doctor --json",
    "completions bash",
    "man --out man",
];

fn bench() -> Dir {
    let dir = Dir::new();
    dir.write("p.toml", PIPELINE);
    dir.write("sw.toml", "on_N = 0.5\noff_N = 0.3\n");
    dir.write("trials.csv", "operator,method,trial,time_s\nA,pendant,1,200\nA,virtual,1,100\n");
    for request in [
        "phantom video --seed 1 --seconds 0.2 --size 320x240 --x264 medium --out v -q",
        "phantom board --board 5x4 --views 1 --size 160x120 --out b -q",
        "phantom log --seed 1 --out lg -q",
        "phantom photos --seed 1 --subjects 2 --poses extension --size 320x240 --out ph -q",
        "train lg/log.csv --target force --out m.json -q",
        "simulate --pf1 step:5000@0..0.05 --until 0.1 --with-loads --out pressed.csv -q",
        "photos ph/photos --out whole -q",
        "run p.toml --shard 1/1 --out part -q",
    ] {
        dir.words(request).expect(0);
    }
    dir
}

/// The exit status and what was said on standard error, with this as standard output.
fn answer(dir: &Dir, request: &str, to: impl Into<Stdio>) -> (Option<i32>, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_lunula"));
    command.args(request.split(' ')).current_dir(dir.path(".")).stdout(to);
    if request.ends_with(" -") {
        command.stdin(File::open(dir.path("lg/log.csv")).expect("a log"));
    }
    let output = command.output().expect("it runs");
    (output.status.code(), String::from_utf8(output.stderr).expect("text"))
}

#[test]
fn on_a_full_disk_every_command_fails_and_a_reader_that_went_away_is_no_error() {
    let dir = bench();
    for request in REQUESTS {
        let full = OpenOptions::new().write(true).open("/dev/full").unwrap();
        let (code, said) = answer(&dir, request, full);
        // What was done before is done: 2 would say that nothing was.
        let done =
            request.split(' ').skip_while(|word| *word != "--out").nth(1).is_some_and(|out| dir.path(out).exists());
        assert_eq!(code, Some(if done { 1 } else { 2 }), "{request}: {said}");
        assert!(said.contains("error: standard output: cannot be written (No space left"), "{request}: {said}");
        assert_eq!(done, request.contains("--out") && !request.contains("--plan"), "{request}");
        let new = if request.starts_with("init") { "init . --out newer.toml" } else { request };
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let (code, said) = answer(&dir, new, writer);
        assert!(code == Some(0) && !said.contains("standard output"), "{new}: {code:?} {said}");
    }
    for command in commands(&dir).iter().filter(|command| *command != "help") {
        assert!(REQUESTS.iter().any(|request| request.starts_with(command)), "{command} is not tried");
    }
}

#[test]
fn nothing_but_one_file_writes_to_standard_output() {
    let files = ["src", "crates/cli/src"].map(|folder| paths_below(&repository().join(folder), ".rs")).concat();
    let mut read = 0;
    for path in
        files.iter().filter(|path| !path.ends_with("cli/src/out.rs") && !path.to_string_lossy().contains("tests"))
    {
        read += 1;
        let text = std::fs::read_to_string(path).unwrap().replace("eprint", "");
        // Unit tests, at a file's end, may print what they measure.
        let text = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
        for call in ["println!(", "print!(", "stdout()"] {
            assert!(!text.contains(call), "{}: {call}", path.display());
        }
    }
    assert!(read > 300, "{read}");
}
