//! Measured rows, voltages of earlier rows as further inputs, and which recordings follow one path.

pub(crate) mod dataset;
pub(crate) mod lags;
pub(crate) mod path;
