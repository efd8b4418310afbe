//! `lunula simulate`: the model's response to loads over time.

mod job;
mod options;
mod report;
mod table;

pub use job::{SimulateOutputs, outline as simulate_outline, plan as simulate_plan, simulate};
pub use options::SimulateOptions;
pub use report::{Collapsed, SimulateReport, Work};
