//! `lunula phantom video`: videos of a finger with coloured markers.

use std::path::PathBuf;

use anyhow::Context;
use clap::Args;
use lunula::phantom::request::VideoRequest;
use lunula::phantom::video::{Scene, write_watched};

use crate::jobs::phantom::{Common, Outcome, report, watched};

/// A video of a finger with coloured markers, with exact joint angles and marker centres (3.2.3, 3.3.5)
///
/// Writes OUT/video.mp4 and OUT/markers.toml, which `lunula posture` reads as they are, and OUT/truth/: joints.csv,
/// tracks.csv, clock.csv, scene.json. A scene sets all that follows; each option changes one thing of it.
#[derive(Debug, Args)]
pub(super) struct VideoArgs {
    /// Folder for the video, the marker file and truth/
    #[arg(long)]
    out: PathBuf,
    #[command(flatten)]
    request: VideoRequest,
    #[command(flatten)]
    common: Common,
}

pub(super) fn run(args: &VideoArgs) -> anyhow::Result<Outcome> {
    let options = args.request.options().context("no synthetic video")?;
    let wanted = options.distractors;
    // A lens is worked out side by side: threads are counted first.
    let (scene, summary) = watched(&args.common, "frames", "no synthetic video", |watch| -> anyhow::Result<_> {
        let scene = Scene::new(options)?;
        let summary = write_watched(&scene, &args.out, watch)?;
        Ok((scene, summary))
    })?;
    let mut warnings = Vec::new();
    if summary.distractors < wanted {
        warnings
            .push(format!("only {} of {wanted} distractors found a place apart from the finger", summary.distractors));
    }
    let figures = serde_json::json!({
        "options": scene.options(),
        "frames": summary.frames,
        "seconds": summary.seconds,
        "bytes": summary.bytes,
        "stages": summary.stages,
    });
    let made = format!("{} frames in {}", summary.frames, args.out.join("video.mp4").display());
    report(&args.common, "phantom video", figures, &made, &args.out, summary.stages.total_s, &warnings)
}
