//! A folder for what evaluate, analyse and prune write: tables, pictures and the report `run.json`.

use std::path::{Path, PathBuf};
use std::time::Instant;

use serde::Serialize;

use super::error::PredictorError;
use crate::files::Staging;
use crate::job::Report;
use crate::stages::{Stages, Step};

/// A folder for a job's results, and which of them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FolderOutputs {
    /// The folder.
    pub folder: PathBuf,
    /// Whether the table with one row per row of the recordings is written: that of predictions.
    pub rows: bool,
    /// Whether pictures are drawn.
    pub figures: bool,
    /// Whether the report is written, with its times and the files' places.
    pub report: bool,
}

impl FolderOutputs {
    /// All there is.
    #[must_use]
    pub fn all(folder: PathBuf) -> Self {
        Self { folder, rows: true, figures: true, report: true }
    }

    /// A step of plans for the pictures; `what` they show.
    pub fn figures_step(outputs: Option<&Self>, what: &str) -> Step {
        match outputs {
            None => Step::new("figures", false, "no --out".to_owned()),
            Some(outputs) if outputs.figures => Step::new("figures", true, what.to_owned()),
            Some(_) => Step::new("figures", false, "not asked for".to_owned()),
        }
    }

    /// A step of plans for a table that is always written where there is a folder.
    pub fn table_step(outputs: Option<&Self>, what: &str) -> Step {
        let there = outputs.is_some();
        Step::new("tables", there, if there { what } else { "no --out" }.to_owned())
    }
}

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
    out: Option<&FolderOutputs>,
    write: impl FnOnce(&mut Report<F>, &FolderOutputs) -> Result<Staging, PredictorError>,
    stages: &Stages,
    start: Instant,
) -> Result<Report<F>, PredictorError> {
    let Some(out) = out else { return Ok(report.timed(stages, start)) };
    let staging = write(&mut report, out)?;
    let mut report = report.timed(stages, start);
    report.warn_of_earlier(&out.folder.join("run.json"));
    if out.report {
        staging.write("run.json", report.text().as_bytes())?;
    }
    staging.commit()?;
    Ok(report)
}
