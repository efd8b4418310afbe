//! Results of several runs joined: maps made in parts equal those made at once.

use std::path::{Path, PathBuf};

use super::partial;
use crate::files::{Places, Staging};
use crate::input::copies;
use crate::job::Watch;
use crate::photo::error::MergeError;
use crate::photo::results::{NailTable, write_maps};
use crate::photo::run::report::{PhotosReport, of_merge};
use crate::stages::{Stages, Step};

/// Joins the sums and the tables of nails of `parts` (folders that `lunula photos` wrote), and puts the results in
/// `out`, which is none of the parts. Normalized pictures stay where they are.
///
/// # Errors
/// [`MergeError`]; nothing is written then.
pub fn merge(parts: &[PathBuf], out: &Path, watch: &Watch<'_>) -> Result<PhotosReport, MergeError> {
    let stages = Stages::default();
    Places::not_over(parts).check([out])?;
    let staging = Staging::new(out)?;
    let partials = stages.time("join", || partial::join(parts))?;
    let nails = NailTable::of_parts(parts)?;
    let sheets = write_maps(&partials, true, &staging, &stages)?;
    nails.write(&staging)?;
    let mut report = of_merge(parts, &partials, watch).timed(&stages);
    // Of one run its own report says it.
    let pictures: Vec<(String, PathBuf)> = nails.pictures(parts).map(|at| (at.display().to_string(), at)).collect();
    report.warnings.extend(copies(pictures.iter().map(|(name, at)| (name.clone(), at.as_path()))));
    report.write(&nails, &sheets, &[], &staging)?;
    watch.go_on()?;
    staging.commit()?;
    Ok(report)
}

/// What joining would do, and what it leaves out.
#[must_use]
pub fn merge_plan(parts: &[PathBuf]) -> Vec<Step> {
    vec![
        Step::new("photographs", false, "not read again, their sums are joined".to_owned()),
        Step::new("sums joined", true, format!("of {} folders", parts.len())),
        Step::figures(true, "by pose, and sheets"),
    ]
}
