//! `lunula phantom board`: photographs of a chessboard.

use std::path::PathBuf;

use clap::Args;
use lunula::phantom::board::{BoardOptions, Scene, write_watched};

use crate::jobs::phantom::{Common, Outcome, watched};

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
    args.common.print_json(&serde_json::json!({
        "job": "phantom board",
        "version": env!("CARGO_PKG_VERSION"),
        "options": args.options,
        "views": summary.views,
        "total_s": summary.total_s,
        "warnings": [],
    }))?;
    args.common.say(&format!(
        "{} views in {}, truth in {}; {:.2} s",
        summary.views,
        args.out.display(),
        args.out.join("truth").display(),
        summary.total_s
    ));
    Ok(Outcome::Done)
}
