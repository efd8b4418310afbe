//! A folder for what evaluate, analyse and prune write: tables, pictures and the report `run.json`.

use serde::Serialize;

use super::error::PredictorError;
use crate::files::Staging;
use crate::job::{Outputs, Report};
use crate::stages::Stages;

/// Adds the times, writes tables, pictures and report where there is a folder, and puts them into their place.
pub fn end<F: Serialize>(
    mut report: Report<F>,
    out: Option<&Outputs>,
    write: impl FnOnce(&mut Report<F>, &Outputs) -> Result<Staging, PredictorError>,
    stages: &Stages,
) -> Result<Report<F>, PredictorError> {
    let Some(out) = out else { return Ok(report.timed(stages)) };
    let staging = write(&mut report, out)?;
    let mut report = report.timed(stages);
    report.warn_of_earlier(&out.out.join("run.json"));
    if out.report {
        staging.write("run.json", report.text().as_bytes())?;
    }
    staging.commit()?;
    Ok(report)
}
