//! The jobs that pipelines know.

mod phantom;

use crate::align::{AlignJob, JoinJob};
use crate::job::{Job, Kind};
use crate::posture::PostureJob;

pub use phantom::phantom_catalogue;

/// All kinds of jobs, by name.
#[must_use]
pub fn kinds() -> &'static [&'static Kind] {
    KINDS
}

/// One line per kind, sorted by name.
static KINDS: &[&Kind] = &[&AlignJob::KIND, &JoinJob::KIND, &PostureJob::KIND];
