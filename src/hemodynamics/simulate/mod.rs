//! `lunula simulate`: the model's response to loads over time.

mod job;
mod kind;
mod options;
mod report;
mod table;

pub use job::{plan as simulate_plan, simulate};
pub use options::{SimulateInputs, SimulateOptions};
pub use report::{Collapsed, SimulateFigures, SimulateReport};
