//! What a job is given: parameters, loads and a state to start from, out of options and files.

mod columns;
mod loads;
mod model;
mod params;
mod start;

pub use loads::{BloodOptions, LoadOptions};
pub use model::ModelOptions;
pub use start::Start;

pub(super) use columns::{BLOOD, Columns, Knots, PRESSED, Rows, TIME, listed};
pub(super) use loads::{ReadLoads, SUCTION, hardly_flows, hardly_pressed};
pub(super) use model::read_parameters;
pub(super) use params::{PARAMS, existing, of_foreseen, of_task};
pub(super) use start::{read_state, state_columns};
