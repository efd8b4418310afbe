//! What a job is given: parameters, loads and a state to start from, out of options and files.

mod columns;
mod loads;
mod parameters;
mod start;

pub use loads::GivenLoads;
pub use parameters::GivenParameters;
pub use start::Start;

use std::path::{Path, PathBuf};

use super::HemodynamicsError;
use crate::files::is_same_file;

pub(super) use columns::{BLOOD, Columns, Knots, PRESSED, Rows, TIME, listed};
pub(super) use loads::ReadLoads;
pub(super) use start::{read_state, state_columns};

/// Refuses results that would replace what is read.
///
/// # Errors
/// [`HemodynamicsError::Options`] that names every input which is also a result.
pub(super) fn keep_inputs(
    inputs: impl IntoIterator<Item = impl AsRef<Path>>,
    results: &[PathBuf],
) -> Result<(), HemodynamicsError> {
    let inputs = inputs.into_iter().filter(|input| results.iter().any(|result| is_same_file(input.as_ref(), result)));
    let told = |input: &Path| format!("{}: is an input itself; choose another name for the result", input.display());
    let faults: Vec<String> = inputs.map(|input| told(input.as_ref())).collect();
    if faults.is_empty() { Ok(()) } else { Err(HemodynamicsError::Options(faults)) }
}
