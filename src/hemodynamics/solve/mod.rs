//! The crate's solvers as the jobs ask for them.

mod equilibria;
mod transient;

pub(super) use equilibria::{Curve, along, rest, start_state, state_before};
pub use transient::{Run, RunSettings, respond};
