//! The state that a run starts from.

use std::path::{Path, PathBuf};

use lunula_hemodynamics::{Parameters, Site, State};

use super::Rows;
use crate::hemodynamics::HemodynamicsError;

/// Another state to start from than the equilibrium of the loads just before t = 0.
#[derive(Debug, Clone, PartialEq)]
pub enum Start {
    /// With all displacements and velocities zero, which is not rest.
    Zero,
    /// In the last row of a trajectory.
    File(PathBuf),
}

impl From<PathBuf> for Start {
    fn from(path: PathBuf) -> Self {
        if path.as_os_str() == "zero" { Self::Zero } else { Self::File(path) }
    }
}

/// Names of the columns of displacements, m, and of velocities, m/s.
pub(in crate::hemodynamics) fn state_columns(units: usize) -> [Vec<String>; 2] {
    let sites = || (0..=units).map(|j| Site::of_wall(j, units));
    [sites().map(|site| format!("x{site}_m")).collect(), sites().map(|site| format!("v{site}_mps")).collect()]
}

/// The state in the last row of a trajectory's table.
///
/// # Errors
/// A table that is not of this model, or a state that can't be.
pub(in crate::hemodynamics) fn read_state(path: &Path, parameters: &Parameters) -> Result<State, HemodynamicsError> {
    let [x, v] = state_columns(parameters.units().len());
    let names: Vec<&str> = x.iter().chain(&v).map(String::as_str).collect();
    let next = format!("x{}_m", Site::Capillary(parameters.units().len()));
    let columns = Rows::table(path)?.numbers(&names, &[&next], "")?;
    if columns.get(&next).is_some() {
        let what = format!(
            "has a column {next}, of a nail with more than {} units: --units says how many",
            parameters.units().len()
        );
        return Err(HemodynamicsError::table(path, what));
    }
    let last =
        |names: &[String]| -> Vec<f64> { names.iter().filter_map(|name| columns.get(name)?.last().copied()).collect() };
    State::from_metres(parameters, &last(&x), &last(&v))
        .map_err(|why| HemodynamicsError::Start { path: path.to_owned(), why })
}
