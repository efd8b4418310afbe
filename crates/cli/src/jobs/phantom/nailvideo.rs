//! `lunula phantom nailvideo`: videos of a fingernail that is pressed, sheared and bent.

use std::path::PathBuf;

use anyhow::Context;
use clap::Args;
use lunula::phantom::nailvideo::{NailVideoRequest, Scene, write_watched};

use crate::jobs::phantom::{Common, Outcome, report, watched};

/// A video of a fingernail that is pressed, sheared and bent, with exact motion, colour and hidden photodiodes (4.2,
/// 4.3)
///
/// Writes OUT/video.mp4, which `lunula nailvideo` reads, OUT/outline.json (the nail in the first frame, LabelMe),
/// OUT/positions.toml (the photodiodes), OUT/log.csv (what a force transducer and a sensor that the same person wears
/// log, on the video's clock), and OUT/truth/: frames.csv, presses.csv, log.csv, nailvideo.json.
#[derive(Debug, Args)]
pub(super) struct NailVideoArgs {
    /// Folder for the video, what goes with it, and truth/
    #[arg(long)]
    out: PathBuf,
    #[command(flatten)]
    request: NailVideoRequest,
    #[command(flatten)]
    common: Common,
}

pub(super) fn run(args: &NailVideoArgs) -> anyhow::Result<Outcome> {
    let options = args.request.options().context("no synthetic nail video")?;
    let (scene, summary) = watched(&args.common, "frames", "no synthetic nail video", |watch| -> anyhow::Result<_> {
        let scene = Scene::new(options)?;
        let summary = write_watched(&scene, &args.out, watch)?;
        Ok((scene, summary))
    })?;
    let figures = serde_json::json!({
        "options": scene.options(),
        "frames": summary.frames,
        "gone": summary.gone,
        "log_rows": summary.log_rows,
        "bytes": summary.bytes,
        "total_s": summary.total_s,
    });
    let made = format!("{} frames in {}", summary.frames, args.out.join("video.mp4").display());
    report(&args.common, "phantom nailvideo", figures, &made, &args.out, summary.total_s, &[])
}
