//! `lunula doctor`: what is installed, what is missing and how to get it.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use clap::Args;
use lunula::doctor::{Check, Group, Libraries, Linked, Program, State, examine, is_ill, libraries};

use super::{Common, Outcome, print_line, programs};

/// What is installed, what is missing and how to get it: this program, this machine, the folder for results, programs beside it
///
/// `ok` is as it should be, `note` misses something that only some jobs need, `WRONG` is to be mended (exit status 1).
#[derive(Debug, Args)]
pub(super) struct DoctorArgs {
    /// The folder that results are to go to: can it be written to, locked; it need not exist
    #[arg(long, default_value = ".")]
    out: PathBuf,
    /// Only which libraries this program has, for the other one to read
    #[arg(long, hide = true)]
    linked: bool,
    #[command(flatten)]
    common: Common,
}

pub(super) fn run<const VIDEO: bool>(args: &DoctorArgs) -> anyhow::Result<Outcome> {
    let (path, with_video) = programs()?;
    let linked = if VIDEO { Linked::Runs(libraries()) } else { ask(&with_video) };
    if args.linked {
        if let Linked::Runs(libraries) = &linked {
            print_line(&serde_json::to_string(libraries)?);
        }
        return Ok(Outcome::Done);
    }
    let start = Instant::now();
    let groups = examine(&Program { path, with_video }, &linked, &args.out);
    let bad = |check: &&Check| check.state == State::Bad;
    let wrong: Vec<&Check> = groups.iter().flat_map(|group| &group.checks).filter(bad).collect();
    if !args.common.json {
        groups.iter().for_each(|group| say(group, &args.common));
    }
    wrong.iter().for_each(|check| eprintln!("{}: {}; {}", check.what, check.found, check.remedy));
    args.common.print_json(&serde_json::json!({
        "job": "doctor",
        "groups": groups,
        "failed": wrong,
        "wall_s": start.elapsed().as_secs_f64(),
    }))?;
    Ok(if is_ill(&groups) { Outcome::SomeFailed } else { Outcome::Done })
}

/// What the program with FFmpeg's libraries says of itself.
fn ask(other: &Path) -> Linked {
    let output = match Command::new(other).args(["doctor", "--linked"]).output() {
        Ok(output) => output,
        Err(why) => return Linked::Fails(why.to_string()),
    };
    match serde_json::from_slice::<Libraries>(&output.stdout) {
        Ok(libraries) => Linked::Runs(libraries),
        Err(_) => {
            let said = String::from_utf8_lossy(&output.stderr);
            let said = said.lines().next().unwrap_or("it is of another version").to_owned();
            Linked::Fails(said)
        }
    }
}

fn say(group: &Group, common: &Common) {
    common.say(&group.about);
    for check in &group.checks {
        let state = match check.state {
            State::Good => "ok",
            State::Note => "note",
            State::Bad => "WRONG",
        };
        common.say(&format!("  {state:<5} {:<16} {}", check.what, check.found));
        if !check.remedy.is_empty() {
            common.say(&format!("  {:<22} -> {}", "", check.remedy));
        }
    }
}
