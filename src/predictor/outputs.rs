//! A folder for what evaluate, analyse, prune and compare write: tables, pictures and the report `run.json`.

use std::path::{Path, PathBuf};
use std::time::Instant;

use serde::Serialize;

use super::error::PredictorError;
use crate::files::Staging;
use crate::stages::{Stage, Stages, Step};

/// A folder for a job's results, and which of them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FolderOutputs {
    /// The folder.
    pub folder: PathBuf,
    /// Whether what is a row a row of the recordings is written: the table of predictions.
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
    pub(super) fn figures_step(outputs: Option<&Self>, what: &str) -> Step {
        match outputs {
            None => Step::new("figures", false, "no --out".to_owned()),
            Some(outputs) if outputs.figures => Step::new("figures", true, what.to_owned()),
            Some(_) => Step::new("figures", false, "not asked for".to_owned()),
        }
    }

    /// A step of plans for a table that is always written where there is a folder.
    pub(super) fn table_step(outputs: Option<&Self>, what: &str) -> Step {
        let there = outputs.is_some();
        Step::new("tables", there, if there { what } else { "no --out" }.to_owned())
    }
}

/// Draws a picture as PNG and SVG; tells where the PNG will stand.
pub(super) fn picture(
    staging: &Staging,
    out: &Path,
    name: &str,
    draw: impl FnOnce(&Path, &Path) -> anyhow::Result<()>,
) -> Result<std::path::PathBuf, PredictorError> {
    let [png, svg] = ["png", "svg"].map(|ending| format!("{name}.{ending}"));
    draw(&staging.place(&png)?, &staging.place(&svg)?).map_err(|why| staging.refused(&png, format!("{why:#}")))?;
    Ok(out.join(png))
}

/// Writes the report and puts everything into its place.
pub(super) fn finish<R: Serialize>(
    staging: Staging,
    out: &FolderOutputs,
    report: &mut R,
    timed: impl FnOnce(&mut R, Vec<Stage>, f64),
    stages: &Stages,
    start: Instant,
) -> Result<(), PredictorError> {
    timed(report, stages.list(), start.elapsed().as_secs_f64());
    if out.report {
        let text = serde_json::to_string_pretty(report).expect("plain data with names as keys") + "\n";
        staging.write("run.json", text.as_bytes())?;
    }
    staging.commit()?;
    Ok(())
}
