//! `lunula phantom board`: photographs of a chessboard.

use std::path::PathBuf;

use clap::Args;
use lunula::phantom::board::{BoardOptions, Scene, write_watched};

use crate::jobs::phantom::{Common, Outcome, report, watched};

/// Photographs of a chessboard through a known lens, with the exact lens, corners and poses
///
/// Writes OUT/views/01.png .., which `lunula camera OUT/views` reads, with --plane OUT/plane.png, and OUT/truth/:
/// camera.toml, corners.csv, views.csv, board.json.
#[derive(Debug, Args)]
pub(super) struct BoardArgs {
    /// Folder for views/ and truth/
    #[arg(long)]
    out: PathBuf,
    #[command(flatten)]
    options: BoardOptions,
    #[command(flatten)]
    common: Common,
}

pub(super) fn run(args: &BoardArgs) -> anyhow::Result<Outcome> {
    let summary = watched(&args.common, "views", "no synthetic board", |watch| -> anyhow::Result<_> {
        Ok(write_watched(&Scene::new(args.options.clone())?, &args.out, watch)?)
    })?;
    let figures = serde_json::json!({
        "options": args.options,
        "views": summary.views,
        "total_s": summary.total_s,
    });
    let made = format!("{} views in {}", summary.views, args.out.display());
    report(&args.common, "phantom board", figures, &made, &args.out, summary.total_s, &[])
}
