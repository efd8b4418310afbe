//! Results of several runs joined: maps made in parts equal those made at once.

use std::path::{Path, PathBuf};
use std::time::Instant;

use super::partial;
use crate::files::Staging;
use crate::photo::error::MergeError;
use crate::photo::options::Watch;
use crate::photo::report::PhotosReport;
use crate::photo::results::{NailTable, write_maps};
use crate::stages::Stages;

/// Joins the sums and the tables of nails of `parts` (folders that `lunula photos` wrote), and puts the results in
/// `out`. Normalized pictures stay where they are.
///
/// # Errors
/// [`MergeError`]; nothing is written then.
pub fn merge(parts: &[PathBuf], out: &Path, watch: &Watch) -> Result<PhotosReport, MergeError> {
    let start = Instant::now();
    let staging = Staging::new(out)?;
    let stages = Stages::default();
    let partials = stages.time("join", || partial::join(parts))?;
    let nails = NailTable::of_parts(parts)?;
    let sheets = write_maps(&partials, true, &staging, &stages)?;
    nails.write(&staging)?;
    let mut report = PhotosReport::of_merge(parts, &partials, stages.list(), start.elapsed());
    report.write(&nails, &sheets, &[], &staging)?;
    if watch.is_stopped() {
        return Err(MergeError::Interrupted);
    }
    staging.commit()?;
    Ok(report)
}
