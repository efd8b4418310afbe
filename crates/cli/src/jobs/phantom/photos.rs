//! `lunula phantom photos`: photographs of nails.

use std::path::PathBuf;

use clap::Args;
use lunula::phantom::photos::write_watched;
use lunula::phantom::request::PhotosRequest;

use crate::jobs::phantom::{Common, Outcome, report, watched};

/// Photographs of nails of many shapes, sizes, skin tones and lights, in the eight poses of the thesis (4.2.3-4.2.6)
///
/// Writes OUT/photos/<pose>/<subject>.png with a LabelMe file beside each, which `lunula photos OUT/photos` reads, and
/// OUT/truth/: nails.csv, outlines/, normalized/*.npy and maps/*.npy, exact.
#[derive(Debug, Args)]
pub(super) struct PhotosArgs {
    /// Folder for photos/ and truth/
    #[arg(long)]
    out: PathBuf,
    #[command(flatten)]
    request: PhotosRequest,
    #[command(flatten)]
    common: Common,
}

pub(super) fn run(args: &PhotosArgs) -> anyhow::Result<Outcome> {
    let options = args.request.options();
    let summary = watched(&args.common, "photographs", "no synthetic photographs", |watch| {
        write_watched(&options, &args.out, watch)
    })?;
    let figures = serde_json::json!({
        "options": options,
        "photographs": summary.photographs.len(),
        "stages": summary.stages,
    });
    let made = format!("{} photographs in {}", summary.photographs.len(), args.out.join("photos").display());
    report(&args.common, "phantom photos", figures, &made, &args.out, summary.stages.total_s, &[])
}
