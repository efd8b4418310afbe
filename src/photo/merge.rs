//! Results of several runs joined: maps made in parts equal those made at once.

use std::path::{Path, PathBuf};
use std::time::Instant;

use thiserror::Error;

use super::partial::{self, PartialFault};
use super::report::{NailTable, RunReport};
use super::results::{self, NAIL_COLUMNS};
use crate::files::{Staging, WriteError};
use crate::input;
use crate::stages::Stages;

/// Why results were not joined; nothing is written then.
#[derive(Debug, Error)]
pub enum MergeError {
    /// The parts don't fit.
    #[error(transparent)]
    Partial(#[from] PartialFault),
    /// A part's table of nails.
    #[error("{}: {why}; make that part anew", .file.display())]
    Nails {
        /// Which table.
        file: PathBuf,
        /// What is wrong with it.
        why: String,
    },
    /// The results can't be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// Stopped from outside.
    #[error("interrupted; nothing was written")]
    Interrupted,
}

/// Joins the sums and the tables of nails of `parts` (folders that `lunula photos` wrote) into `staging`. Normalized
/// pictures stay where they are.
///
/// # Errors
/// [`MergeError`].
pub fn merge(parts: &[PathBuf], staging: &Staging) -> Result<RunReport, MergeError> {
    let start = Instant::now();
    let stages = Stages::default();
    let partials = stages.time("join", || partial::join(parts))?;
    let mut rows = Vec::new();
    for part in parts {
        rows.extend(read_nails(&part.join("nails.csv"))?);
    }
    let nails = NailTable::of_parts(rows);
    results::write_maps(&partials, true, staging, &stages)?;
    results::write_nails(nails.rows(), staging)?;
    let warnings = partials
        .poses
        .iter()
        .filter(|(_, sums)| sums.subjects().len() == 1)
        .map(|(pose, _)| super::job::one_subject(pose))
        .collect();
    let report = RunReport::of_merge(parts, &partials, warnings, stages.list(), start.elapsed());
    report.write_html(&nails, staging)?;
    report.write_json(staging)?;
    Ok(report)
}

pub(super) fn read_nails(file: &Path) -> Result<Vec<Vec<String>>, MergeError> {
    let wrong = |why: String| MergeError::Nails { file: file.to_owned(), why };
    let mut table = csv::Reader::from_reader(input::open(file).map_err(|e| wrong(e.to_string()))?);
    if table.headers().map_err(|e| wrong(e.to_string()))?.iter().ne(NAIL_COLUMNS) {
        return Err(wrong(format!("its columns are not {}", NAIL_COLUMNS.join(","))));
    }
    let cells = |record: csv::StringRecord| record.iter().map(str::to_owned).collect();
    table.records().map(|record| record.map(cells).map_err(|e| wrong(e.to_string()))).collect()
}
