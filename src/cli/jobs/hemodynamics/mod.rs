//! The commands of the hemodynamic model: simulate, fit.

mod fit;
mod simulate;

pub(in crate::cli) use crate::cli::jobs::hemodynamics::fit::FitArgs;
pub(in crate::cli) use crate::cli::jobs::hemodynamics::simulate::{SimulateArgs, run as simulate};
