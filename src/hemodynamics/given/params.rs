//! The parameter file of a pipeline's stage.

use std::path::PathBuf;

use crate::job::{Foreseen, Role, Takes, Work};

pub(in crate::hemodynamics) const PARAMS: Role =
    Role::new("params", Takes::Optional, "parameters, as fit writes them [default: the thesis' table]");

pub(in crate::hemodynamics) fn of_task(role: &str, work: &Work<'_>) -> Option<PathBuf> {
    work.one(role).map(|at| at.path.clone())
}

/// The file that a role will have.
pub(in crate::hemodynamics) fn of_foreseen(role: &str, inputs: &[Foreseen]) -> Option<PathBuf> {
    Foreseen::of(inputs, role).map(|input| input.path.clone())
}

/// Whether all inputs exist, so that a plan can read them.
pub(in crate::hemodynamics) fn existing(inputs: &[Foreseen]) -> bool {
    inputs.iter().all(|input| input.exists)
}
