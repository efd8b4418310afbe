//! A stage's name and job.

use super::Place;
use crate::job::Kind;

/// A stage's name and job, before its references can be read.
pub(super) struct Header {
    pub(super) name: String,
    pub(super) at: Place,
    pub(super) kind: Option<&'static Kind>,
}
