//! `lunula doctor`, `lunula completions`, `lunula man`: what is installed, and what helps to type and to read.

use std::process::Command;

use crate::util::Dir;

/// The commands of `lunula --help`.
pub(crate) fn commands(dir: &Dir) -> Vec<String> {
    let help = dir.lunula(&["--help"]).expect(0).stdout;
    let listed = help.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
    // A command begins in the third column; what follows of its description stands further in.
    let names = listed.filter(|line| line.starts_with("  ") && !line.starts_with("   "));
    names.filter_map(|line| line.split_whitespace().next()).map(str::to_owned).collect()
}

#[test]
fn the_doctor_finds_this_machine_fit() {
    let dir = Dir::new();
    let answer = dir.lunula(&["doctor", "--out", "not/yet", "--json"]).expect(0);
    let report = answer.json();
    assert_eq!(report["failed"], serde_json::json!([]));
    let checks: Vec<&serde_json::Value> =
        report["groups"].as_array().unwrap().iter().flat_map(|group| group["checks"].as_array().unwrap()).collect();
    let found = |what: &str| {
        let check = checks.iter().find(|check| check["what"] == what).unwrap_or_else(|| panic!("{what}: {report}"));
        check["found"].as_str().unwrap().to_owned()
    };
    assert!(found("lunula").starts_with(env!("CARGO_PKG_VERSION")));
    assert!(found("FFmpeg").contains("libavcodec ") && found("OpenCV").starts_with('4'));
    for what in
        ["threads", "memory", "clock", "results", "locks", "room", "temporary files", "snakemake", "sbatch", "labelme"]
    {
        assert!(!found(what).is_empty());
    }
    for check in &checks {
        assert_eq!(check["remedy"] == "", check["state"] == "good", "{check}");
    }
    assert!(!dir.path("not").exists());
    dir.lunula(&["doctor"]).expect(0).prints("this program\n  ok    lunula ").never_prints("WRONG");
}

#[test]
fn the_doctor_says_what_is_wrong_and_what_to_do() {
    let dir = Dir::new();
    dir.write("file", "");
    dir.lunula(&["doctor", "--out", "file/results"])
        .expect(1)
        .prints("WRONG results")
        .prints("-> choose another --out")
        .says("results: ")
        .says("choose another --out");
}

#[test]
fn every_shell_completes_every_command() {
    let dir = Dir::new();
    let commands = commands(&dir);
    assert!(commands.len() >= 17 && commands.contains(&"photos".to_owned()), "{commands:?}");
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let text = dir.lunula(&["completions", shell]).expect(0).stdout;
        for command in &commands {
            assert!(text.contains(command.as_str()), "{shell}: {command}");
        }
        assert!(text.contains("threads"), "{shell}: options");
    }
    let script = dir.lunula(&["completions", "bash"]).expect(0).stdout;
    dir.write("lunula.bash", script);
    let ask = "source lunula.bash && COMP_WORDS=(lunula pos) COMP_CWORD=1 && _lunula lunula pos lunula && echo \
               ${COMPREPLY[@]}";
    let output = Command::new("bash").args(["-c", ask]).current_dir(dir.path(".")).output().unwrap();
    assert_eq!(
        String::from_utf8_lossy(&output.stdout).trim(),
        "posture",
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    dir.lunula(&["completions", "no-such-shell"]).expect(2);
}

#[test]
fn every_command_has_a_page_of_the_manual() {
    let dir = Dir::new();
    dir.lunula(&["man", "--out", "man"]).expect(0);
    let mut pages = commands(&dir).into_iter().filter(|command| command != "help").collect::<Vec<String>>();
    assert!(pages.len() >= 16, "{pages:?}");
    pages.extend(["photos-merge", "phantom-video", "trajectory-force"].map(str::to_owned));
    let all = dir.bytes_of("man");
    for command in &pages {
        let text = String::from_utf8(all[&format!("lunula-{command}.1")].clone()).unwrap();
        assert!(text.contains(".TH lunula-") && text.contains(".SH SYNOPSIS"), "{command}");
    }
    let first = String::from_utf8(all["lunula.1"].clone()).unwrap();
    assert!(first.contains("lunula\\-photos(1)") && first.contains("Exit status"), "{first}");
    for (name, page) in &all {
        assert!(page.len() > 300, "{name}");
    }
    // Where the system has one that checks them.
    let mut check = Command::new("mandoc");
    check.args(["-T", "lint", "-W", "error"]).args(all.keys().map(|name| dir.path("man").join(name)));
    if let Ok(output) = check.output() {
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
    }
}
