//! The crate's solvers as the jobs ask for them.

mod equilibria;
mod transient;

pub use equilibria::{Curve, along, state_before};
pub(super) use equilibria::{rest, start_state};
pub use transient::{Run, RunSettings, respond};
