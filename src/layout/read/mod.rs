//! Inputs to a problem: candidates with their places, and second moments.

mod given;
mod maps;
mod places;
mod tables;

use super::error::LayoutError;
use super::options::{LayoutInputs, LayoutOptions};
use crate::words::twins;
pub(super) use given::Parts;
pub(super) use given::{Contrast, Given, Target, WithoutSubject, pairs};
pub use given::{LeftOutCandidates, PersonFigures};
pub(super) use maps::is_maps;
pub(super) use places::{Place, is_photodiode};

/// Reads tables and logs, or maps.
pub(super) fn read(inputs: &LayoutInputs, options: &LayoutOptions) -> Result<Given, LayoutError> {
    let mut given = match &inputs.data[..] {
        [] => Err(LayoutError::Request("no input is given; name tables, logs or a folder of maps".to_owned())),
        [one] if is_maps(&one.path) => maps::read(&one.path, options),
        several => match several.iter().find(|one| one.path.is_dir()) {
            Some(folder) if several.len() > 1 && is_maps(&folder.path) => {
                Err(LayoutError::input(&folder.path, "holds maps; give one folder of maps and nothing beside it"))
            }
            Some(folder) => {
                let what =
                    "is a folder without maps/POSE-mean.npy; name tables, logs or a folder that `lunula photos` wrote";
                Err(LayoutError::input(&folder.path, what))
            }
            None => tables::read(inputs, options),
        },
    }?;
    given.warnings.extend(twins("subjects", given.persons.iter().map(|person| person.name.as_str())));
    Ok(given)
}
