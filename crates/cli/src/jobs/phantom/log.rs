//! `lunula phantom log`: logs of photodiodes and forces.

use std::path::PathBuf;

use anyhow::Context;
use clap::Args;
use lunula::phantom::log::{LogScene, write};
use lunula::phantom::request::LogRequest;
use lunula::phantom::sensor::CHANNELS;

use crate::jobs::phantom::{Common, Outcome, report};

/// A log of eight photodiodes and three forces, with exact truth (3.1.2c, 3.3, 5.2.3)
///
/// Writes OUT/log.csv, which `lunula align` reads as it is, and OUT/truth/: log.csv, angles.csv, log.json, and of
/// --force contacts contacts.csv (--protocol contacts or rest: hours of a worn sensor, for switches). It belongs to the
/// video that `lunula phantom video` writes from the same seed, trajectory and --bend-hz; both may be written to the
/// same OUT. truth/angles.csv has the exact joint angles in the format of `lunula posture`, 30 a second, clock_s on the
/// log's clock:
/// `lunula align --joints OUT/truth/angles.csv --log OUT/log.csv --out training.csv --subject 1 --session 1` makes a
/// posture training set without a video.
#[derive(Debug, Args)]
pub(super) struct LogArgs {
    /// Folder for the log and truth/
    #[arg(long)]
    out: PathBuf,
    #[command(flatten)]
    request: LogRequest,
    #[command(flatten)]
    common: Common,
}

pub(super) fn run(args: &LogArgs) -> anyhow::Result<Outcome> {
    let options = args.request.options().context("no synthetic log")?;
    args.common.start()?;
    let begin = std::time::Instant::now();
    let scene = LogScene::new(options).context("no synthetic log")?;
    let summary = write(&scene, &args.out).context("no synthetic log")?;
    let mut warnings = Vec::new();
    if summary.rows == 0 {
        warnings.push("the log has no rows: all were lost".to_owned());
    }
    let total_s = begin.elapsed().as_secs_f64();
    let figures = serde_json::json!({
        "options": scene.options(),
        "rows": summary.rows,
        "lit": summary.lit,
        "photodiodes": CHANNELS,
        "stages": { "write_s": summary.write_s, "total_s": total_s },
    });
    let made = format!("{} rows in {}", summary.rows, args.out.join("log.csv").display());
    report(&args.common, "phantom log", figures, &made, &args.out, total_s, &warnings)
}
