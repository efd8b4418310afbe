//! The commands of the hemodynamic model: simulate, fit.

mod fit;
mod simulate;

pub(super) use fit::FitArgs;
pub(super) use simulate::{SimulateArgs, run as simulate};
