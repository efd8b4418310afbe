//! The commands of the hemodynamic model: simulate, fit.

mod fit;
mod simulate;

pub(crate) use crate::jobs::hemodynamics::fit::FitArgs;
pub(crate) use crate::jobs::hemodynamics::simulate::{SimulateArgs, run as simulate};
