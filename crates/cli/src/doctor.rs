//! `lunula doctor`: what is installed, what is missing and how to get it.

use std::path::PathBuf;
use std::time::Instant;

use clap::Args;
use lunula::doctor::{Check, State, examine};

use super::{Common, Outcome};

/// Check what is installed, what is missing and how to get it: this program, this machine, the results folder, other
/// programs
///
/// `ok` is as it should be, `note` misses something that only some jobs need, `WRONG` has to be fixed (exit status 1).
#[derive(Debug, Args)]
pub(super) struct DoctorArgs {
    /// The folder for results: whether it can be written to and locked; it need not exist
    #[arg(long, default_value = ".")]
    out: PathBuf,
    #[command(flatten)]
    common: Common,
}

pub(super) fn run(args: &DoctorArgs) -> anyhow::Result<Outcome> {
    let start = Instant::now();
    let groups = examine(&args.out, cfg!(debug_assertions));
    let bad = |check: &&Check| check.state == State::Bad;
    let wrong: Vec<&Check> = groups.iter().flat_map(|group| &group.checks).filter(bad).collect();
    for group in &groups {
        args.common.say(&group.about);
        for check in &group.checks {
            let state = match check.state {
                State::Good => "ok",
                State::Note => "note",
                State::Bad => "WRONG",
            };
            args.common.say(&format!("  {state:<5} {:<16} {}", check.what, check.found));
            if !check.remedy.is_empty() {
                args.common.say(&format!("  {:<22} -> {}", "", check.remedy));
            }
        }
    }
    wrong.iter().for_each(|check| eprintln!("{}: {}; {}", check.what, check.found, check.remedy));
    args.common.print_json(&serde_json::json!({
        "job": "doctor",
        "groups": groups,
        "failed": wrong,
        "wall_s": start.elapsed().as_secs_f64(),
    }))?;
    Ok(if wrong.is_empty() { Outcome::Done } else { Outcome::SomeFailed })
}
