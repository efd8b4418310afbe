//! A folder for what evaluate, analyse and prune write: tables, pictures and the report `run.json`.

use std::path::Path;
use std::time::Instant;

use serde::Serialize;

use super::error::PredictorError;
use crate::files::Staging;
use crate::job::{Outputs, Report};
use crate::stages::Stages;

/// Draws a picture as PNG and SVG; returns where the PNG will be.
pub fn picture(
    staging: &Staging,
    out: &Path,
    name: &str,
    draw: impl FnOnce(&Path, &Path) -> anyhow::Result<()>,
) -> Result<std::path::PathBuf, PredictorError> {
    let [png, svg] = ["png", "svg"].map(|ending| format!("{name}.{ending}"));
    draw(&staging.place(&png)?, &staging.place(&svg)?).map_err(|why| staging.refused(&png, format!("{why:#}")))?;
    Ok(out.join(png))
}

/// Adds the times, writes tables, pictures and report where there is a folder, and puts them into their place.
pub fn end<F: Serialize>(
    mut report: Report<F>,
    out: Option<&Outputs>,
    write: impl FnOnce(&mut Report<F>, &Outputs) -> Result<Staging, PredictorError>,
    stages: &Stages,
    start: Instant,
) -> Result<Report<F>, PredictorError> {
    let Some(out) = out else { return Ok(report.timed(stages, start)) };
    let staging = write(&mut report, out)?;
    let mut report = report.timed(stages, start);
    report.warn_of_earlier(&out.out.join("run.json"));
    if out.report {
        staging.write("run.json", report.text().as_bytes())?;
    }
    staging.commit()?;
    Ok(report)
}
