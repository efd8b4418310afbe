//! The commands of the hemodynamic model: simulate, fit.

pub(crate) mod fit;
pub(crate) mod simulate;
