//! `lunula phantom study`: a whole experiment.

use std::path::PathBuf;

use anyhow::Context;
use clap::Args;
use lunula::phantom::Generated as _;
use lunula_thesis::phantom::{Study, StudyRequest, write_watched};

use crate::jobs::phantom::{Common, Outcome, watched};
use crate::print_line;

/// A whole experiment: photographs in eight poses, logs of three spirals, of bending and of random movement, posture
/// videos with a clock, the preliminary experiments of one person, presses (3.3, 4.2.2, 4.3.4, 5.3)
///
/// Writes OUT/photos/ as `lunula phantom photos` does, OUT/<subject>/<session>/ with log.csv and, where the finger only
/// bends, video.mp4 and markers.toml, OUT/presses/<subject>-<site>/ as `lunula fit` reads them, truth/ in each of
/// these, and OUT/tables/: sessions.csv, presses.csv, subjects.csv, study.json.
#[derive(Debug, Args)]
pub(super) struct StudyArgs {
    /// Folder for the study
    #[arg(long, required_unless_present = "plan")]
    out: Option<PathBuf>,
    #[command(flatten)]
    request: StudyRequest,
    /// Show what would be written, and write nothing
    #[arg(long)]
    plan: bool,
    #[command(flatten)]
    common: Common,
}

pub(super) fn run(args: &StudyArgs) -> anyhow::Result<Outcome> {
    let study = Study::new(args.request.options()).context("no synthetic study")?;
    if args.plan {
        return plan(args, &study);
    }
    let out = args.out.as_ref().context("--out is needed: a folder for the study")?;
    let none = "no synthetic study".to_owned();
    let summary = watched(&args.common, "recordings", none, |watch| write_watched(&study, out, watch))?;
    args.common.print_json(&serde_json::json!({
        "job": "phantom study",
        "version": env!("CARGO_PKG_VERSION"),
        "options": study.options(),
        "recordings": summary.recordings,
        "files": summary.files,
        "bytes": summary.bytes,
        "stages": summary.stages,
        "total_s": summary.total_s,
        "warnings": [],
    }))?;
    if args.common.verbose {
        args.common.say_stages(&summary.stages);
    }
    args.common.say(&format!(
        "{} recordings of {} people, {} files, {:.0} MB in {}; {:.2} s",
        summary.recordings,
        study.subjects().len(),
        summary.files,
        summary.bytes as f64 / 1e6,
        out.display(),
        summary.total_s
    ));
    Ok(Outcome::Done)
}

fn plan(args: &StudyArgs, study: &Study) -> anyhow::Result<Outcome> {
    let recordings = study.recordings();
    let files: usize = recordings.iter().map(|one| one.recording.files().len()).sum();
    let seconds: f64 = recordings.iter().map(|one| one.recording.cost().seconds).sum();
    if args.common.json {
        let each = recordings.iter().map(|one| {
            let cost_s = one.recording.cost().seconds;
            serde_json::json!({ "name": one.name, "files": one.recording.files(), "cost_s": cost_s })
        });
        args.common.print_json(&serde_json::json!({
            "job": "phantom study",
            "version": env!("CARGO_PKG_VERSION"),
            "options": study.options(),
            "files": files,
            "cost_s": seconds,
            "recordings": each.collect::<Vec<_>>(),
        }))?;
        return Ok(Outcome::Done);
    }
    for one in &recordings {
        let count = one.recording.files().len();
        print_line(&format!("{:<28} {count:>4} files  about {:>5.1} s", one.name, one.recording.cost().seconds));
    }
    print_line(&format!("{} recordings, {files} files, about {seconds:.0} s on one thread", recordings.len()));
    Ok(Outcome::Done)
}
