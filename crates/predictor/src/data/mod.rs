//! Measured rows, voltages of earlier rows as further inputs, which recordings follow one path, and whether their
//! columns are on one clock.

pub(crate) mod dataset;
pub(crate) mod delay;
pub(crate) mod lags;
pub(crate) mod path;
